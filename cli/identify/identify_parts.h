/* SPDX-License-Identifier: Apache-2.0 */
/* The parts of `imukit identify`: what was asked, and what was found. */
#ifndef IMUKIT_IDENTIFY_PARTS_H
#define IMUKIT_IDENTIFY_PARTS_H

#include "log/log_input.h"
#include "shell/show.h"

#include "imukit/show.h"

/* Where the estimate comes from: the spectrum's likelihood, or the Allan deviations. */
typedef enum identify_method { METHOD_LIKELIHOOD = 0, METHOD_ALLAN } identify_method;

typedef struct identify_options {
    log_input log;
    const char *output, *into, *name, *report, *plot, *truth, *keep, *plan, *want;
    double confidence, significance, duration, tolerance;
    option_integer seed, threads, gauss_markov;
    int method;        /* identify_method */
    unsigned take_out; /* IMK_SCREEN_… bits: all but --keep */
    bool twin, json, strict, verbose, runs, devices, curve, plain;
} identify_options;

/* Everything found on a log, or on several together. */
typedef struct identification {
    const identify_options *options;
    imk_identify_shown shown;
    imk_allan_curve twin[IMK_LOG_COLUMNS_MAX]; /* of the model */
    imk_model model;                           /* as written: into another one with --into */
    imk_model truth;                           /* of --truth */
} identification;

/* identify_run.c: identify a log, or a table of Allan deviations, or say why not. Free *log in any
 * case. @return -1 or the exit code */
int identify_run(const identify_options *o, const char *path, const imk_executor *executor,
                 imk_identify_log **log);

/* identify_write.c */
/* The last part of a path. */
const char *identify_base_name(const char *path);
/* With --twin simulate the model over the length of the log; fill i->model, print what --into
 * changes, and write it to -o. @return -1 or the exit code */
int identify_make_model(identification *i, const imk_executor *executor);

/* identify_compare.c: several logs, from reading them to the result. @return the exit code */
int identify_several(identification *joint, size_t count, const char *const *paths,
                     const imk_executor *executor);

/* identify_plan.c: --plan. @return the exit code */
int identify_plan(const identify_options *o);

/* verb_identify.c */
/* The warnings of a verdict to standard error, in a few words, and into the JSON. */
void identify_warn(const identify_options *o, const imk_verdict *verdict);
/* Where the files are, and what to do next; then everything is shown. @return the exit code */
int identify_end(const identification *i, imk_result *result, bool warns);

#endif
