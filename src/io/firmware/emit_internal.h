/* SPDX-License-Identifier: Apache-2.0 */
/* C code from a plan: three texts. */
#ifndef IMUKI_EMIT_INTERNAL_H
#define IMUKI_EMIT_INTERNAL_H

#include "io/foreign/parameter_internal.h"

#include "imukit/firmware_file.h"

typedef struct imki_emission {
    const imk_firmware *plan;
    const imk_model *model; /* with the terms that are left in */
    const char *name;
    imki_text *out;
    uint32_t vectors;
    /* Names of operations, and how often they are used. */
    int uses[IMK_FIRMWARE_OPERATIONS_MAX];
} imki_emission;

/* The first line of each file, by which one made here is known. */
#define IMKI_EMIT_MARK "/* Made by imukit compensate --emit-c"

void imki_emit_header(imki_emission *emission);
void imki_emit_source(imki_emission *emission);
/* @return IMK_ERROR_MEMORY or what imk_correction_start() says */
imk_status imki_emit_test(imki_emission *emission, imk_error *error);

/* "gyro", "accel"; "rate", "force"; "rad/s", "m/s^2". */
extern const char *const imki_emit_sensor[2], *const imki_emit_motion[2], *const imki_emit_unit[2];
/* Type of the numbers of the arithmetic, and of a sensor's readings. */
const char *imki_emit_type(const imk_firmware *plan);
const char *imki_emit_reading_type(const imk_firmware *plan, int sensor);
/* The declaration of the function, without the semicolon. */
void imki_emit_prototype(const imki_emission *emission);
/* A number of the arithmetic as C has it: hexadecimal, so that it is exact. */
void imki_emit_number(imki_text *out, imk_firmware_arithmetic arithmetic, double value);
/* A decimal of `digits` significant digits. */
void imki_emit_decimal(imki_text *out, double value, int digits);
/* Text for a comment: no control characters, no end of the comment. */
void imki_emit_plain(imki_text *out, const char *text);
/* NAME in capitals, for macros. */
void imki_emit_capitals(imki_text *out, const char *name);

#endif
