/* SPDX-License-Identifier: Apache-2.0 */
/** @file drift_models.h
 *  The job of `imukit drift`: what the errors of models make of a position, which of their terms
 *  are to blame, and how good they must become for what is wanted (drift.h). */
#ifndef IMUKIT_DRIFT_MODELS_H
#define IMUKIT_DRIFT_MODELS_H

#include "imukit/drift.h"
#include "imukit/job.h"
#include "imukit/model.h"
#include "imukit/units.h"

IMK_BEGIN_C

/** @name When to look
 *  @{ */
enum { IMK_DRIFT_ROWS_MAX = 64 };

/** Times of samples, in order: those of a table, and those between for curves. */
typedef struct imk_drift_times {
    size_t count;
    double *time; /**< [s] */
    size_t row_count;
    size_t *row; /**< of the table: positions in `time` */
    imk_allocator allocator;
} imk_drift_times;

/** Choose them.
 *  @param duration  of a table with round times up to it, where `count` is 0 [s]
 *  @param count     of stated times, in any order; with `wanted` up to IMK_DRIFT_ROWS_MAX
 *  @param wanted    one more; 0: none
 *  @param rate      of the samples [Hz]
 *  @param curves    as many in every decade, and close enough for Schuler's period of 84 min
 *  @return IMK_ERROR_MEMORY, IMK_ERROR_RANGE (too many) */
IMK_API imk_status imk_drift_times_choose(double duration, size_t count, const double *stated,
                                          double wanted, double rate, bool curves,
                                          const imk_allocator *allocator, imk_drift_times *times,
                                          imk_error *error);
/** Free its arrays. */
IMK_API void imk_drift_times_free(imk_drift_times *times);
/** @} */

/** A figure that is to be no larger than so much at a time, which is one of the table. */
typedef struct imk_drift_wanted {
    bool asked;
    imk_drift_requirement figure;
    double goal;   /**< SI */
    imk_unit unit; /**< of the goal, as it was asked */
    double time;   /**< [s] */
} imk_drift_wanted;

/** Settings of the job. Start from imk_drift_models_default(). */
typedef struct imk_drift_models_settings {
    uint32_t cookie;
    imk_drift_settings drift; /**< its times are those of `times`; its `compensated` is not used */
    bool calibrated; /**< known values taken out; of one model beside it before; default false */
    imk_drift_wanted want;
} imk_drift_models_settings;

/** As imk_drift_default(), nothing wanted. */
IMK_API imk_drift_models_settings imk_drift_models_default(void);

enum { IMK_DRIFT_MODELS_MAX = 8 };

/** One line of a budget: a source at one time. */
typedef struct imk_drift_share {
    size_t source;
    double share;                    /**< of the variance of what is looked at, 0 … 1 */
    double shift;                    /**< size of the mean [SI] */
    imk_drift_figures random, whole; /**< of this source alone: without and with its mean */
} imk_drift_share;

/** A model and what its errors grow to. */
typedef struct imk_drift_case {
    const char *name;
    char label[120]; /**< "tactical, compensated" */
    const imk_model *model;
    imk_drift_settings settings;
    imk_drift_analysis *analysis;
    imk_drift_figures *figures; /**< at all times */
    /** Position among all times of what the budget is made of: the time that is wanted, else the
     *  last row that is a position still (the first when none is). */
    size_t time;
    size_t share_count; /**< sources that have a share or a shift then, the largest share first */
    imk_drift_share *share;
} imk_drift_case;

/** A device of the catalogue as an answer. */
typedef struct imk_drift_candidate {
    const imk_device *device;
    imk_drift_figures figures;
    bool usable;  /**< gyros and accelerometers are there, and the analysis worked */
    bool no_bias; /**< its source states no run-to-run bias of one of them */
    bool no_memory;
} imk_drift_candidate;

/** Factors from here to 1 are no improvement. */
#define IMK_DRIFT_SAME 0.9995

/** What would do what is wanted. */
typedef struct imk_drift_answer {
    imk_drift_allocation allocation;
    size_t order_count;                  /**< of the terms that must become better */
    size_t order[IMK_DRIFT_SOURCES_MAX]; /**< the one that needs most first */
    bool alone;                          /**< one of them would do alone */
    size_t candidate_count;
    imk_drift_candidate *candidate; /**< sorted, the best first */
} imk_drift_answer;

/** What was found. */
typedef struct imk_drift_models {
    imk_drift_models_settings settings;
    const imk_drift_times *times;
    size_t model_count;
    const imk_model *model[IMK_DRIFT_MODELS_MAX];
    const char *name[IMK_DRIFT_MODELS_MAX];
    size_t case_count; /**< after a failure the last one is where */
    imk_drift_case cases[IMK_DRIFT_MODELS_MAX + 1];
    imk_drift_answer *answer; /**< NULL: nothing is wanted */
    /** Monte Carlo of the last case, at the rows of the table; NULL: none. */
    uint64_t run_count;
    imk_drift_figures *found, *low, *high;
    size_t *used;
} imk_drift_models;

/** Analyse models, which outlive the result, as do their names and the times.
 *  @param count   up to IMK_DRIFT_MODELS_MAX; one where something is wanted; 0: none, for runs from
 *                 elsewhere
 *  @param job     NULL: one thread, no progress, the memory of the C library
 *  @param result  free it with imk_drift_models_free(), also after a failure; NULL if there was no
 *                 memory for it
 *  @return as imk_drift_covariance(); IMK_ERROR_MEMORY */
IMK_API imk_status imk_drift_models_run(size_t count, const imk_model *const *models,
                                        const char *const *names, const imk_drift_times *times,
                                        const imk_drift_models_settings *settings,
                                        const imk_job *job, imk_drift_models **result,
                                        imk_error *error);
/** Statistics of runs of the last case at the rows of the table (imk_drift_runs()).
 *  @param errors  [run][row][state]
 *  @return IMK_ERROR_MEMORY */
IMK_API imk_status imk_drift_models_take_runs(imk_drift_models *models, size_t runs,
                                              const double *errors, imk_error *error);
/** Free it and all it holds; NULL is allowed. */
IMK_API void imk_drift_models_free(imk_drift_models *result);

IMK_END_C
#endif
