/* SPDX-License-Identifier: Apache-2.0 */
/** @file tune_model.h
 *  The job of `imukit tune`: the noise that makes a filter consistent on motions
 *  (filter_tuning.h), and a Monte Carlo of it. */
#ifndef IMUKIT_TUNE_MODEL_H
#define IMUKIT_TUNE_MODEL_H

#include "imukit/filter_tuning.h"
#include "imukit/job.h"
#include "imukit/model_unstated.h"

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

/** Choose the rate of the readings: recorded motions state theirs.
 *  @param stated  the rate asked for [Hz]; 0: that of the recorded motions, else the default
 *  @return IMK_ERROR_CONFLICT: a recorded motion (error.index) has another rate (error.value) than
 *          the one stated or that of another motion (error.limit) */
IMK_API imk_status imk_tune_model_rate(double stated, imk_filter_tuning_settings *tuning,
                                       imk_error *error);

/** Terms that a model does not state and that tuning takes as zero: those of imk_model_unstated()
 *  but the bias from run to run, which the filter knows when a time begins. */
IMK_API void imk_tune_model_unstated(const imk_model *model, imk_unstated *unstated);

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
