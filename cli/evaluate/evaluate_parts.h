/* SPDX-License-Identifier: Apache-2.0 */
/* Parts of imukit evaluate: what was asked, the channels with their tables, what was found, and the
 * ways to show it. */
#ifndef IMUKIT_EVALUATE_PARTS_H
#define IMUKIT_EVALUATE_PARTS_H

#include "calibrate/calibrate_parts.h"

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
} evaluate_channel;

/* A channel of the log at rest. */
typedef struct evaluate_rest {
    char name[EVALUATE_NAME];
    imk_unit unit; /* to show in */
    bool identified;
    imk_identification result;
} evaluate_rest;

/* One figure of a channel, as it is shown. */
typedef struct evaluate_row {
    const char *key, *title, *definition;
    imk_evaluation_figure figure; /* SI */
    imk_unit unit;                /* to show in */
    char si[80];                  /* unit of the SI value */
    bool is_signed;               /* a limit is of its amount */
    int level;                    /* where it is; -1: no such place */
} evaluate_row;

typedef enum evaluate_verdict {
    VERDICT_NONE = 0, /* no limit */
    VERDICT_MET,      /* the whole interval is within */
    VERDICT_DOUBTFUL, /* the value is, the interval is not, or is not known */
    VERDICT_NOT_MET,
    VERDICT_UNKNOWN /* the figure is not determined */
} evaluate_verdict;

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

/* evaluate_input.c: files as channels, one run each unless they say more. */
int evaluate_load(evaluation *v);
/* The channel of this name, made when there is none; NULL after a message. */
evaluate_channel *evaluate_channel_of(evaluation *v, const char *name, imk_unit reference,
                                      imk_unit reading);
/* Append a reading. @return false when memory is exhausted */
bool evaluate_add(evaluate_channel *channel, double reference, double reading, double sigma,
                  int direction, int run);
/* evaluate_log.c: a log with a reference: its stretches. */
int evaluate_load_log(evaluation *v, const char *path);
/* evaluate_rest.c: --static. */
int evaluate_load_rest(evaluation *v);

/* evaluate_figures.c: the figures of a channel in their order. @return how many */
size_t evaluate_figures(const evaluation *v, const evaluate_channel *channel,
                        evaluate_row row[EVALUATE_ROWS]);
size_t evaluate_rest_figures(const evaluate_rest *rest, evaluate_row row[EVALUATE_ROWS]);

/* evaluate_limits.c */
int evaluate_read_limits(evaluation *v);
/* How a figure stands to its limit. @param text  the limit as it was given */
evaluate_verdict evaluate_judge(const evaluation *v, const evaluate_row *row, const char **text);
const char *evaluate_verdict_text(evaluate_verdict verdict);
/* Warn of limits that are not met, and refuse those of nothing. */
int evaluate_check_limits(evaluation *v);

/* evaluate_tables.c */
text_table evaluate_figure_table(const evaluation *v, const char *name, size_t count,
                                 const evaluate_row *row);
text_table evaluate_level_table(const evaluation *v, const evaluate_channel *channel);
/* "84 readings at 21 levels …": what the figures rest on. */
void evaluate_basis(const evaluate_channel *channel, char *text, size_t size);
void evaluate_print(const evaluation *v);
/* What a reader should know beside the numbers: `line` of it; false beyond the last. */
bool evaluate_remark(const evaluate_channel *channel, size_t line, char *text, size_t size);
/* evaluate_json.c */
int evaluate_json(const evaluation *v, int code);

/* evaluate_figure.c */
int evaluate_draw(const evaluation *v, const char *path);
/* Panels of one channel on a page. */
void evaluate_put_figure(const evaluate_channel *channel, imk_page *page);
/* evaluate_report.c */
int evaluate_report(const evaluation *v, const char *path);

#endif
