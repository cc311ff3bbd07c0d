/* SPDX-License-Identifier: Apache-2.0 */
/* A message of the verdict of a calibration, made of its parts. */
#ifndef IMUKI_CALIBRATE_MESSAGE_INTERNAL_H
#define IMUKI_CALIBRATE_MESSAGE_INTERNAL_H

#include "calibrate_show_internal.h"

typedef struct imki_calibrate_message {
    imk_finding_level level;
    const char *code;
    char text[1200];
} imki_calibrate_message;

/* 1 sigma of placements and turns to a mark from which on they are something else [rad]: 1 deg. */
static const double imki_placement_most = 0.017453292519943295;

/* calibrate_log_text.c */
imki_calibrate_message imki_calibrate_say(imk_finding_level level, const char *code,
                                          const char *format, ...)
    __attribute__((format(printf, 3, 4)));
void imki_calibrate_add(imk_verdict *verdict, imki_calibrate_message message);
/* A diagnostic of a log: what was found, what is expected, what mends it. */
imki_calibrate_message imki_message_on_log(const imk_calibrate_log *b,
                                           const imk_calibrate_record *log,
                                           const imk_diagnostic_finding *d);

#endif
