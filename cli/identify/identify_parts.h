/* SPDX-License-Identifier: Apache-2.0 */
/* The parts of `imukit identify`: what was asked, what was found, and the ways to show it. */
#ifndef IMUKIT_IDENTIFY_PARTS_H
#define IMUKIT_IDENTIFY_PARTS_H

#include "log/channel_units.h"
#include "log/log_input.h"
#include "shell/text_table.h"

#include "imukit/identify.h"
#include "imukit/identify_joint.h"
#include "imukit/identify_log.h"
#include "imukit/model_file.h"
#include "imukit/record_screen.h"

#include <jansson.h>

/* Where the estimate comes from: the spectrum's likelihood, or the Allan deviations. */
typedef enum identify_method { METHOD_LIKELIHOOD = 0, METHOD_ALLAN } identify_method;

typedef struct identify_options {
    log_input log;
    const char *output, *into, *name, *report, *plot, *truth, *keep, *plan, *want;
    double confidence, significance, duration, tolerance;
    option_integer seed, threads, gauss_markov;
    int method; /* identify_method */
    bool twin, json, strict, runs, devices, curve, plain;
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
    const char *label; /* before each sentence, where there are several logs; NULL */
    imk_identify_log *found;
    bool joint; /* the result of several logs: what concerns samples is not known */
    imk_allan_curve twin[IMK_LOG_COLUMNS_MAX]; /* of the model; count 0 without --twin */
    size_t verdict_count;
    verdict_sentence verdict[VERDICTS_MAX];
    imk_model model; /* as written: into another one with --into */
    imk_model truth; /* of --truth */
} identification;

/* identify_run.c: identify the log, or say why not. @return -1 or the exit code */
int identify_run(identification *i, const imk_identify_log_settings *settings,
                 const imk_executor *executor);
/* Everything that was allocated for a log. */
void identify_free(identification *i);
/* The settings of the job. @return -1 or the exit code */
int identify_settings(const identify_options *options, imk_identify_log_settings *settings);

/* identify_screen.c: the samples themselves. */
void identify_judge_samples(identification *i);
json_t *identify_screen_json(const identification *i, size_t channel);

/* verdict_sentences.c: sentences on the record; warnings also go to standard error. */
void identify_judge(identification *i);
/* The warnings among the sentences to standard error and into the JSON. */
void identify_warn(const identification *i);
bool identify_is_bad(const identification *i);
void identify_add_sentence(identification *i, verdict_level level, const char *code,
                           const char *format, ...) __attribute__((format(printf, 4, 5)));

/* identify_model.c */
/* The last part of a path. */
const char *identify_base_name(const char *path);
/* Fill i->model, print what --into changes, and write it to -o. @return -1 or the exit code */
int identify_write_model(identification *i);
/* Simulate the noise model over the length of the log and take its Allan deviations. */
int identify_twin(identification *i, const imk_executor *executor);

/* identify_table.c */
#define term_display imk_term_display
#define identify_term imk_channel_term
/* Table of the channels of one kind; no rows when there are none. */
text_table identify_table(const identification *i, channel_kind kind);
/* Truth beside the estimates, and whether the intervals cover it. */
text_table identify_truth_table(const identification *i, size_t *covered, size_t *stated);

/* identify_figure.c: one panel per channel, and with `misfit` one below it: measured over model.
 * Free with identify_figure_free(). */
typedef struct identify_figure {
    imk_figure figure;
    size_t channels;
    imk_panel panel[2 * IMK_LOG_COLUMNS_MAX];
    imk_curve curve[IMK_LOG_COLUMNS_MAX][9];
    imk_curve misfit[IMK_LOG_COLUMNS_MAX][3];
    char label[IMK_LOG_COLUMNS_MAX][80];
    double *memory[IMK_LOG_COLUMNS_MAX];
} identify_figure;
/* False when memory is exhausted. */
void identify_figure_make(const identification *i, bool misfit, identify_figure *figure);
/* Make it and draw it where --plot says. @return -1 or the exit code */
int identify_draw(const identification *i, const char *plot);
void identify_figure_free(identify_figure *figure);

/* identify_report.c. @return -1 or the exit code */
int identify_report(const identification *i, const char *path);
int identify_json(const identification *i, int code);
json_t *identify_channel_json(const identification *i, size_t channel);
json_t *identify_verdict_json(const identification *i);

#endif
