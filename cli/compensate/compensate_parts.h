/* SPDX-License-Identifier: Apache-2.0 */
/* Parts of imukit compensate: what a model says about a log's columns, what is taken out of them, a
 * log on its way through a compensator, and what is shown of it. */
#ifndef IMUKIT_COMPENSATE_PARTS_H
#define IMUKIT_COMPENSATE_PARTS_H

#include "log/log_input.h"
#include "shell/show.h"
#include "shell/term_selection.h"

#include "imukit/compensate.h"
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
    const char *output, *to_gyro_unit, *to_accel_unit;
    double temperature, temperature_time, powered_for, rate_limit, force_limit;
    option_integer decimals, threads;
    bool flags, json, strict;
    term_selection terms;
    compensate_emission emission;
} compensate_options;

/* How columns of a log and axes of a model belong together, and which columns are written. */
typedef struct compensate_columns {
    int axis[2][IMK_AXES_MAX]; /* of the log: the column of each axis of the model */
    int temperature, time;     /* or -1 */
    size_t count;              /* written */
    imk_log_column column[IMK_LOG_COLUMNS_MAX];
    struct {
        int source;            /* column of the log that is copied, or -1 */
        int sensor, component; /* else what is corrected; sensor 2: the flags */
    } content[IMK_LOG_COLUMNS_MAX];
} compensate_columns;

/* Find the columns of the model's axes; sensors that the log has not, and on which nothing else
 * depends, are taken out of the model. @return -1 or the exit code, the message printed */
int compensate_match(const compensate_options *o, const imk_log_reader *reader, const char *log,
                     const char *name, imk_model *model, compensate_columns *columns);
/* Columns of the corrected log. @return -1 or the exit code, the message printed */
int compensate_describe(const compensate_options *o, const imk_log_reader *reader,
                        const imk_compensator *compensator, compensate_columns *columns);

/* Take out the terms that the options name. What the output stage does (range, resolution,
 * quantization) is not a matter of taking out, but tells which readings are saturated: it stays.
 * @return -1 or the exit code, the message printed */
int compensate_select(const compensate_options *o, imk_model *model);
/* What compensation takes out. */
imk_firmware_keys compensate_taken_out(const imk_model *model);
/* What it leaves in the log: of the terms of the whole model, as far as the sensors are there. */
imk_firmware_keys compensate_left_in(const imk_model *model, const imk_model *whole);
/* --emit-c: the model of the first operand as C code. @return the exit code */
int compensate_emit(const compensate_options *o, const char *const *operands);
/* Whether a term needs a temperature, and the name of the first. */
bool compensate_temperature_term(const imk_model *model, char *name, size_t size);

/* ---- compensate_stream.c ---- */

/* What was met on the way; rows count from 1. */
typedef struct compensate_counts {
    uint64_t rows, any_flag, stretches, first_gap, temperatures_held;
    uint64_t times_missing, first_time_missing; /* whose time is no number */
    uint64_t flagged[IMK_FLAG_COUNT], first_flagged[IMK_FLAG_COUNT];
} compensate_counts;

typedef struct compensation {
    const char *log, *name; /* the operands */
    imk_model model;        /* what is taken out */
    imk_model whole;        /* the same before terms were selected */
    imk_log_reader *reader;
    compensate_columns columns;
    imk_compensator compensator;
    compensate_counts counts;
} compensation;

/* Read, correct, write. @return -1 or the exit code, the message printed */
int compensate_stream(const compensate_options *o, compensation *c);

/* ---- compensate_show.c ---- */

/* Warn of samples that are not what they should be. */
void compensate_warn(const compensate_counts *counts);
void compensate_show(const compensation *c, imk_result *result);
/* Terms as an array of the data, and as a line. */
void compensate_show_keys(const char *key, const char *label, const imk_firmware_keys *keys,
                          imk_result *result);
/* Print either, by the options. @return the exit code */
int compensate_end(const compensate_options *o, imk_result *result);

#endif
