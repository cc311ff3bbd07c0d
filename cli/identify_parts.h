/* SPDX-License-Identifier: Apache-2.0 */
/* The parts of `imukit identify`: what was asked, what was found, and the ways to show it. */
#ifndef IMUKIT_IDENTIFY_PARTS_H
#define IMUKIT_IDENTIFY_PARTS_H

#include "allan_curve.h"
#include "channel_units.h"
#include "log_input.h"
#include "text_table.h"

#include "imukit/identify.h"
#include "imukit/model_file.h"

typedef struct identify_options {
    log_input log;
    const char *output, *into, *name, *report, *plot, *truth;
    double confidence;
    uint64_t seed, threads;
    bool twin, json, strict;
} identify_options;

/* A sentence of the verdict. */
typedef enum verdict_level { VERDICT_GOOD = 0, VERDICT_NOTE, VERDICT_WARNING } verdict_level;
typedef struct verdict_sentence {
    verdict_level level;
    char code[40];
    char text[900];
} verdict_sentence;
enum { VERDICTS_MAX = 24 };

/* Everything found on a log. */
typedef struct identification {
    const identify_options *options;
    const char *path;
    log_channels channels;
    imk_identification result[IMK_LOG_COLUMNS_MAX];
    allan_curve curve[IMK_LOG_COLUMNS_MAX]; /* of the log, octaves */
    allan_curve twin[IMK_LOG_COLUMNS_MAX];  /* of the simulated model; count 0 without --twin */
    size_t verdict_count;
    verdict_sentence verdict[VERDICTS_MAX];
    imk_model model; /* as written: into another one with --into */
    imk_model truth; /* of --truth */
} identification;

/* identify_channels.c: all channels on the threads of the executor. @return -1 or the exit code */
int identify_channels(identification *i, const imk_executor *executor);

/* verdict_sentences.c: sentences on the record; warnings also go to standard error. */
void identify_judge(identification *i);
bool identify_is_bad(const identification *i);

/* identify_model.c */
/* Noise model of the log: nothing but what was identified. */
imk_model identify_noise_model(const identification *i);
/* identify_rounding.c: to the digits the values have, in the units of the model file. */
void identify_round_model(imk_model *model);
/* Fill i->model, print what --into changes, and write it to -o. @return -1 or the exit code */
int identify_write_model(identification *i);
/* Simulate the noise model over the length of the log and take its Allan deviations. */
int identify_twin(identification *i, const imk_executor *executor);

/* identify_table.c */
typedef struct term_display {
    char key[40];  /* as in the model file */
    char name[40]; /* as people say it */
    imk_unit unit; /* readable */
    char si[40];   /* unit of the SI value */
} term_display;
term_display identify_term(const imk_log_column *column, imk_noise_term term);
/* Table of the channels of one kind; no rows when there are none. */
text_table identify_table(const identification *i, channel_kind kind);
/* Truth beside the estimates, and whether the intervals cover it. */
text_table identify_truth_table(const identification *i, size_t *covered, size_t *stated);

/* identify_figure.c: one panel per channel. Free with identify_figure_free(). */
typedef struct identify_figure {
    imk_figure figure;
    imk_panel panel[IMK_LOG_COLUMNS_MAX];
    imk_curve curve[IMK_LOG_COLUMNS_MAX][9];
    char label[IMK_LOG_COLUMNS_MAX][80];
    double *memory[IMK_LOG_COLUMNS_MAX];
} identify_figure;
/* False when memory is exhausted. */
bool identify_figure_make(const identification *i, identify_figure *figure);
void identify_figure_free(identify_figure *figure);

/* identify_report.c. @return -1 or the exit code */
int identify_report(const identification *i, const char *path);
int identify_json(const identification *i, int code);

#endif
