/* SPDX-License-Identifier: Apache-2.0 */
/* Parts of imukit evaluate: what was asked, the channels with their tables, and what was found. */
#ifndef IMUKIT_EVALUATE_PARTS_H
#define IMUKIT_EVALUATE_PARTS_H

#include "calibrate/calibrate_parts.h"
#include "shell/show.h"

#include "imukit/evaluate.h"
#include "imukit/identify.h"

enum { EVALUATE_CHANNELS = 16, EVALUATE_ROWS = 16, EVALUATE_LIMITS = 24, EVALUATE_NAME = 64 };

typedef struct evaluate_options {
    calibrate_options bench; /* how logs are read and what is said of their reference */
    const char *rest;        /* --static */
    const char *full_scale, *level_width, *sensitivity, *zero, *limit;
    const char *unit, *serial, *operator_name, *laboratory, *date, *temperature;
    const char *plot, *report;
    double confidence;
    bool levels, json, strict;
} evaluate_options;

typedef enum evaluate_verdict {
    VERDICT_NONE = 0, /* no limit */
    VERDICT_MET,      /* the whole interval is within */
    VERDICT_DOUBTFUL, /* the value is, the interval is not, or is not known */
    VERDICT_NOT_MET,
    VERDICT_UNKNOWN /* the figure is not determined */
} evaluate_verdict;

/* One figure, as it is shown. */
typedef struct evaluate_row {
    const char *key, *title, *definition;
    imk_evaluation_figure figure; /* SI */
    imk_unit unit;                /* to show in */
    char si[80];                  /* unit of the SI value */
    bool is_signed;               /* a limit is of its amount */
    int level;                    /* where it is; -1: no such place */
    evaluate_verdict verdict;
    const char *limit; /* as it was given; "": none */
} evaluate_row;

/* The figures of a channel in their order. */
typedef struct evaluate_sheet {
    size_t count;
    evaluate_row row[EVALUATE_ROWS];
} evaluate_sheet;

/* What one axis read, and what it should have. SI, counts as they are. */
typedef struct evaluate_channel {
    char name[EVALUATE_NAME];
    imk_unit reference_unit, reading_unit; /* to show in */
    size_t count, capacity;
    double *reference, *reading, *sigma; /* sigma NULL: not known */
    signed char *direction;              /* NULL: from the order */
    int *run;
    size_t left_out; /* stretches that turn about other axes */
    bool of_log;     /* means of stretches: references are measured */
    imk_evaluation_settings settings;
    imk_evaluation result;
    imk_evaluation_level *level;
    evaluate_sheet sheet;
} evaluate_channel;

/* A channel of the log at rest. */
typedef struct evaluate_rest {
    char name[EVALUATE_NAME];
    imk_unit unit; /* to show in */
    bool identified;
    imk_identification result;
    evaluate_sheet sheet;
} evaluate_rest;

typedef struct evaluate_limit {
    char key[40];
    char text[60];     /* the quantity as it was given */
    char problem[300]; /* why it is no limit of the figure */
    bool used;
} evaluate_limit;

typedef struct evaluation {
    const evaluate_options *options;
    size_t path_count;
    const char *path[IMK_EVALUATION_RUNS_MAX];
    size_t run_count;
    size_t channel_count, rest_count;
    evaluate_channel channel[EVALUATE_CHANNELS];
    evaluate_rest rest[EVALUATE_CHANNELS];
    size_t limit_count;
    evaluate_limit limit[EVALUATE_LIMITS];
    bool has_log;            /* a file is one, and no table */
    bool missed;             /* a limit */
    imk_motion_file *motion; /* of --motion; NULL until a log asks for it */
} evaluation;

/* All return -1 or the exit code, the message printed, where nothing else is said. */

/* evaluate_input.c: files as channels, one run each unless they say more; --static. */
int evaluate_load(evaluation *v);
int evaluate_load_rest(evaluation *v);

/* evaluate_figures.c: fill the sheets. */
void evaluate_channel_figures(evaluate_channel *channel);
void evaluate_rest_figures(evaluate_rest *rest);
/* The keys of figures that may have a limit. @return how many */
size_t evaluate_limit_keys(const char *key[EVALUATE_ROWS]);

/* evaluate_limits.c */
int evaluate_read_limits(evaluation *v);
/* Judge the figures, warn of those beyond their limits, and refuse limits of nothing. */
int evaluate_check_limits(evaluation *v);
const char *evaluate_verdict_text(evaluate_verdict verdict);

/* evaluate_show.c: what was found, as data, text and the test report. */
void evaluate_show(const evaluation *v, imk_result *result);
/* evaluate_figure.c: deviations and hysteresis of a channel. */
void evaluate_show_panels(const evaluate_channel *channel, imk_figure_builder *figure);

#endif
