/* SPDX-License-Identifier: Apache-2.0 */
/** @file tune_model.h
 *  The job of `imukit tune`: the noise that makes a filter consistent on motions
 *  (filter_tuning.h), and a Monte Carlo of it. */
#ifndef IMUKIT_TUNE_MODEL_H
#define IMUKIT_TUNE_MODEL_H

#include "imukit/filter_tuning.h"
#include "imukit/job.h"

IMK_BEGIN_C

/** Settings. Start from imk_tune_model_default(). */
typedef struct imk_tune_model_settings {
    uint32_t cookie;
    imk_filter_tuning_settings tuning;
    const char *motion[IMK_TUNING_MOTIONS_MAX]; /**< names of the motions; for what is shown */
    uint32_t run_count;                         /**< runs of Monte Carlo, 0 (default) or 3 … */
    uint64_t seed;                              /**< of the runs; default 1 */
} imk_tune_model_settings;

/** As imk_filter_tuning_default(), without runs. */
IMK_API imk_tune_model_settings imk_tune_model_default(void);

/** NEES found by the runs at one time, and its 99 % interval, which holds for all times of an
 *  answer together (Student, Bonferroni). */
typedef struct imk_tune_found {
    double nees, lower, upper;
} imk_tune_found;

/** Result of the job. */
typedef struct imk_tune_model {
    imk_tune_model_settings settings;
    const imk_model *model;
    const char *name;
    const imk_filter_tuning *tuning;
    /** [answer * time_count + time]; NULL: no runs. */
    const imk_tune_found *found;
} imk_tune_model;

/** Tune a filter to a model, which must outlive the result, as its motions must.
 *  @param name    of the model
 *  @param job     NULL: one thread, no progress, the memory of the C library
 *  @param result  free it with imk_tune_model_free(), also after a failure; NULL if there was no
 *                 memory for it
 *  @return errors of imk_filter_tuning_run() and imk_filter_tuning_simulate(); IMK_ERROR_RANGE
 *          (fewer than three runs), IMK_ERROR_MEMORY */
IMK_API imk_status imk_tune_model_run(const imk_model *model, const char *name,
                                      const imk_tune_model_settings *settings, const imk_job *job,
                                      imk_tune_model **result, imk_error *error);
/** Free it and all it holds; NULL is allowed. */
IMK_API void imk_tune_model_free(imk_tune_model *result);

/** A model that states the numbers of an answer, for a file: white noise, and random walk or
 *  Gauss-Markov process; the bias at the beginning as its repeatability; scale factors of the
 *  filter as theirs.
 *  @param made  the model
 *  @return IMK_ERROR_EMPTY: the answer was not found */
IMK_API imk_status imk_tune_model_answer(const imk_tune_model *tune, imk_filter_answer_kind kind,
                                         imk_model *made, imk_error *error);

IMK_END_C
#endif
