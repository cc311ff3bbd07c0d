/* SPDX-License-Identifier: Apache-2.0 */
/* What the display of one log and of several have in common. */
#ifndef IMUKI_ALLAN_SHOW_INTERNAL_H
#define IMUKI_ALLAN_SHOW_INTERNAL_H

#include "show_internal.h"

/* Unit a person reads the deviation in. */
imk_unit imki_allan_readable_unit(const imk_allan_log *allan, size_t channel,
                                  imk_allan_statistic statistic, double magnitude);

typedef struct imki_allan_judgement {
    imk_usability usability;
    const char *text; /* of the result */
} imki_allan_judgement;
imki_allan_judgement imki_allan_judge(const imk_allan_log *allan, imk_result *result);

/* Into the object of the data that is open. */
void imki_show_allan_record(const imk_allan_log *allan, const char *name, imk_result *result);
void imki_show_allan_settings(const imk_allan_log_settings *settings, imk_result *result);
void imki_show_allan_channels(const imk_allan_log *allan, imk_result *result);

/* Points with their intervals as a band. */
void imki_show_allan_curve(const imk_allan_curve *curve, const char *name, int color, double scale,
                           imk_figure_builder *figure);

#endif
