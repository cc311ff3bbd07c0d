/* SPDX-License-Identifier: Apache-2.0 */
/* Parts of imukit evaluate: what was asked, the channels with their tables, and what was found. */
#ifndef IMUKIT_EVALUATE_PARTS_H
#define IMUKIT_EVALUATE_PARTS_H

#include "calibrate/calibrate_parts.h"
#include "shell/show.h"

#include "imukit/evaluate_log.h"
#include "imukit/show.h"

typedef struct evaluate_options {
    calibrate_options session; /* how logs are read and what is said of their reference */
    const char *rest;          /* --static */
    const char *full_scale, *level_width, *sensitivity, *zero, *limit;
    const char *unit, *serial, *operator_name, *laboratory, *date, *temperature;
    const char *plot, *report;
    double confidence;
    bool levels, json, strict, keep_delay;
} evaluate_options;

typedef struct evaluation {
    const evaluate_options *options;
    size_t path_count;
    const char *path[IMK_EVALUATION_RUNS_MAX];
    imk_evaluate_log *log;
    size_t limit_count;
    imk_evaluate_limit limit[IMK_EVALUATE_LIMITS];
    bool missed;             /* a limit */
    imk_motion_file *motion; /* of --motion; NULL until a log asks for it */
} evaluation;

/* All return -1 or the exit code, the message printed, where nothing else is said. */

/* evaluate_input.c: files as channels; --static. */
int evaluate_load(evaluation *v);
int evaluate_load_rest(evaluation *v);

/* evaluate_limits.c */
int evaluate_read_limits(evaluation *v);
/* Assess the figures, warn of those beyond their limits, and refuse limits of nothing. */
int evaluate_check_limits(evaluation *v);
#endif
