/* SPDX-License-Identifier: Apache-2.0 */
/* The parts of `imukit identify`: what was asked, what was found, and the ways to show it. */
#ifndef IMUKIT_IDENTIFY_PARTS_H
#define IMUKIT_IDENTIFY_PARTS_H

#include "log/allan_curve.h"
#include "log/channel_units.h"
#include "log/log_input.h"
#include "shell/text_table.h"

#include "imukit/identify.h"
#include "imukit/identify_joint.h"
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
    log_channels channels;
    double duration; /* [s] of all logs together; 0: of the rows */
    imk_identification result[IMK_LOG_COLUMNS_MAX];
    bool summarised; /* keep what a joint estimate needs */
    imk_spectral_summary *summary[IMK_LOG_COLUMNS_MAX];
    bool joint;        /* the result of several logs: what concerns samples is not known */
    unsigned take_out; /* IMK_SCREEN_… bits, by --keep */
    bool screened;     /* a log that is never in memory is not */
    imk_screen screen[IMK_LOG_COLUMNS_MAX];
    allan_curve curve[IMK_LOG_COLUMNS_MAX]; /* of the log, octaves */
    allan_curve twin[IMK_LOG_COLUMNS_MAX];  /* of the simulated model; count 0 without --twin */
    size_t verdict_count;
    verdict_sentence verdict[VERDICTS_MAX];
    imk_model model; /* as written: into another one with --into */
    imk_model truth; /* of --truth */
} identification;

/* identify_channels.c: all channels on the threads of the executor. @return -1 or the exit code */
int identify_channels(identification *i, const imk_executor *executor);
/* The sentence on a channel that could not be identified. @return the exit code */
int identify_explain(const identification *i, size_t channel, imk_status status,
                     const imk_error *error);

/* Settings of a channel's estimate; with a summary to be filled where it is wanted.
 * @return false: memory is exhausted */
bool identify_settings_for(identification *i, size_t channel, imk_identify_settings *settings);
/* Everything that was allocated for a log. */
void identify_free(identification *i);

/* identify_stream.c: all channels of a long log in one pass over it. `taken` is false, and nothing
 * done, where the log is to be loaded: it is short, or its rows are not evenly spaced. @return -1
 * or the exit code */
int identify_stream(identification *i, const imk_executor *executor, bool *taken);

/* identify_screen.c: the samples themselves. */
/* What --keep leaves of everything that can be taken out. @return -1 or the exit code */
int identify_parse_keep(const char *text, unsigned *take_out);
/* Look at a channel's samples and take out what is wrong with them. */
imk_status identify_screen_channel(identification *i, size_t channel, imk_error *error);
void identify_judge_samples(identification *i);
json_t *identify_screen_json(const identification *i, size_t channel);

/* identify_allan.c: replace the terms by those of a generalised least-squares fit to the Allan
 * deviations, with the lines, resonances and filter found before. @return -1 or the exit code */
int identify_by_allan(identification *i);

/* verdict_sentences.c: sentences on the record; warnings also go to standard error. */
void identify_judge(identification *i);
/* The warnings among the sentences to standard error and into the JSON. */
void identify_warn(const identification *i);
bool identify_is_bad(const identification *i);
void identify_add_sentence(identification *i, verdict_level level, const char *code,
                           const char *format, ...) __attribute__((format(printf, 4, 5)));

/* identify_model.c */
/* [s] recorded */
double identify_duration(const identification *i);
/* The last part of a path. */
const char *identify_base_name(const char *path);
/* Noise model of the log: nothing but what was identified. */
void identify_noise_model(const identification *i, imk_model *model);
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
