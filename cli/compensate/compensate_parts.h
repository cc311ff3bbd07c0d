/* SPDX-License-Identifier: Apache-2.0 */
/* Parts of imukit compensate: a corrected log, or the correction as code. */
#ifndef IMUKIT_COMPENSATE_PARTS_H
#define IMUKIT_COMPENSATE_PARTS_H

#include "log/log_input.h"
#include "shell/show.h"
#include "shell/term_selection.h"

#include "imukit/firmware_file.h"
#include "imukit/model_file.h"

/* Code instead of a log. */
typedef struct compensate_emission {
    const char *directory, *prefix;
    int arithmetic; /* imk_firmware_arithmetic */
    option_integer vectors;
} compensate_emission;
enum { COMPENSATE_EMIT_OPTIONS = 4 };
extern const option compensate_emit_options[COMPENSATE_EMIT_OPTIONS];

typedef struct compensate_options {
    log_input log;
    const char *output;
    imk_unit to_gyro_unit, to_accel_unit; /* scale 0: not given */
    double temperature, temperature_time, powered_for, rate_limit, force_limit;
    option_integer decimals, threads;
    bool flags, json, strict;
    term_selection terms;
    compensate_emission emission;
} compensate_options;

/* The model of an operand, whole, and with the terms that the options name.
 * @return -1 or the exit code, the message printed */
int compensate_models(const compensate_options *o, const char *name, imk_model *whole,
                      imk_model *terms);
/* --emit-c: the model of the first operand as C code. @return the exit code */
int compensate_emit(const compensate_options *o, const char *const *operands);
/* Print the log's or the code's result, by the options. @return the exit code */
int compensate_end(const compensate_options *o, imk_result *result);

#endif
