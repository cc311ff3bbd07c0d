/* SPDX-License-Identifier: Apache-2.0 */
/** @file drift_models.h
 *  The job of `imukit drift`: how the errors of models make a position drift, which of their terms
 *  contribute most, and how small these must become to meet a requirement (drift.h). */
#ifndef IMUKIT_DRIFT_MODELS_H
#define IMUKIT_DRIFT_MODELS_H

#include "imukit/drift.h"
#include "imukit/job.h"
#include "imukit/model.h"
#include "imukit/model_unstated.h"
#include "imukit/units.h"

IMK_BEGIN_C

/** @name Times of the analysis
 *  @{ */
enum { IMK_DRIFT_ROWS_MAX = 64 };

/** Times at which the errors are computed, ascending: the rows of a table, and times between them
 *  for curves. */
typedef struct imk_drift_times {
    size_t count;
    double *time; /**< [s] */
    size_t row_count;
    size_t *row; /**< indices in `time` of the rows of the table */
    imk_allocator allocator;
} imk_drift_times;

/** Choose the times.
 *  @param duration  if `count` is 0, the table has round times up to this one [s]
 *  @param count     number of `stated` times; with `wanted` up to IMK_DRIFT_ROWS_MAX
 *  @param stated    times of the table in any order [s]
 *  @param wanted    one more time of the table [s]; 0: none
 *  @param rate      sampling rate [Hz]
 *  @param curves    true: add times for curves, evenly in every decade and close enough to show
 *                   Schuler's period of 84 min
 *  @param origin    from which the curves count [s]: 0, or the end of the aids (imk_drift_outage())
 *  @return IMK_ERROR_MEMORY, IMK_ERROR_RANGE (too many) */
IMK_API imk_status imk_drift_times_choose(double duration, size_t count, const double *stated,
                                          double wanted, double rate, bool curves, double origin,
                                          const imk_allocator *allocator, imk_drift_times *times,
                                          imk_error *error);
/** Free its arrays. */
IMK_API void imk_drift_times_free(imk_drift_times *times);
/** @} */

/** A requirement: a figure must not exceed a goal at a time of the table. */
typedef struct imk_drift_wanted {
    bool asked; /**< false: there is no requirement */
    imk_drift_requirement figure;
    double goal;   /**< SI */
    imk_unit unit; /**< unit in which the goal was stated */
    double time;   /**< [s] */
    /** Of an aided navigator. false: its filter keeps the gains that it has; true: it is made anew
     *  for terms that are improved. */
    bool retuned;
} imk_drift_wanted;

/** Read a requirement: a figure, its largest value and a time, such as "CEP 1 nmi @ 1h"; with
 *  "after" in place of "@" the time counts from the end of the aids (imk_drift_outage()).
 *  @param want   set to it; with `after`, add the end of the aids to its time
 *  @param after  set to true where the time counts from there
 *  @return IMK_ERROR_SYNTAX, _EMPTY (no limit or no time), _RANGE (the limit) */
IMK_API imk_status imk_drift_wanted_parse(const char *text, imk_drift_wanted *want, bool *after,
                                          imk_error *error);

/** When to look at a drift. Zeros are defaults. */
typedef struct imk_drift_when {
    /** Length of the navigation [s], up to 1e8. Default: the time of the requirement, else the
     *  length of the motion, at rest 24 h. */
    double duration;
    size_t time_count;
    const double *time; /**< times of the table instead, in any order [s] */
    size_t outage_count;
    /** Or times after the end of the aids [s]. Default, where aids end and neither a duration nor
     *  times are stated: 10 s, 60 s and 300 s, as far as the motion goes. */
    const double *outage;
    double motion; /**< length of the motion [s], infinite if it has no end; 0: at rest */
    bool curves;   /**< add times for curves */
} imk_drift_when;

/** Choose the times of an analysis by what is asked (imk_drift_times_choose()).
 *  @param settings  motion, rate and aids are used
 *  @param want      its time is one of the table; NULL: none
 *  @return IMK_ERROR_MEMORY; IMK_ERROR_RANGE (error.field: "duration", "times", "outage",
 *          "want.time" beyond the duration, "motion" shorter than the last time), _CONFLICT (more
 *          than one of duration, time and outage), _EMPTY ("outage": no aid ends; no times) */
IMK_API imk_status imk_drift_times_ask(const imk_drift_when *when,
                                       const imk_drift_settings *settings,
                                       const imk_drift_wanted *want, const imk_allocator *allocator,
                                       imk_drift_times *times, imk_error *error);

/** Settings of the job. Start from imk_drift_models_default(). */
typedef struct imk_drift_models_settings {
    uint32_t cookie;
    imk_drift_settings drift; /**< settings of the analysis; its times are replaced by `times`, and
                                 its `compensated` is not used */
    bool calibrated; /**< true: analyse each model with its known values taken out; a single model
                        also without; default false */
    imk_drift_wanted want;
    /** Of an aided navigator, with no drift.filter_model: [model], the models that the filters are
     *  made for, such as those of which terms were left out; NULL: the models themselves. They must
     *  outlive the result. */
    const imk_model *const *filter_models;
    /** true: devices of the catalogue are analysed with typical values for what their sources leave
     *  out (imk_model_assume_class() with `assumed_class`). It does not concern the models, for
     *  which the caller does the same; default false */
    bool assume;
    imk_grade assumed_class;
} imk_drift_models_settings;

/** As imk_drift_default(), without a requirement. */
IMK_API imk_drift_models_settings imk_drift_models_default(void);

enum { IMK_DRIFT_MODELS_MAX = 8 };

/** Terms that a model does not state are material above this share of the mean square error. */
#define IMK_DRIFT_MATERIAL 0.05

/** A term that the model does not state and that would matter: with typical values for all that is
 *  not stated, it has more than IMK_DRIFT_MATERIAL of the mean square of a figure. */
typedef struct imk_drift_missing {
    imk_unstated_term term;
    double share;                 /**< its largest share at the times looked at, 0 … 1 */
    double time;                  /**< the time of this share [s] */
    imk_drift_requirement figure; /**< the figure: DRMS, height, velocity, tilt or heading */
} imk_drift_missing;

/** One line of an error budget: one source at one time. */
typedef struct imk_drift_share {
    size_t source;
    double share; /**< its share of the variance of the figure assessed, 0 … 1 */
    double shift; /**< size of its mean [SI] */
    imk_drift_figures random, whole; /**< figures of this source alone, without and with its mean */
} imk_drift_share;

/** A model and the growth of its errors. */
typedef struct imk_drift_case {
    const char *name;
    char label[120]; /**< "tactical, compensated" */
    const imk_model *model;
    imk_drift_settings settings;
    imk_drift_analysis *analysis;
    imk_drift_figures *figures; /**< one for each time */
    /** Index of the time for which the budget is made: the required time, else the last row of the
     *  table at which the error still describes a position (the first row if there is none). */
    size_t time;
    size_t share_count; /**< number of sources with a share or a shift at that time, the largest
                           share first */
    imk_drift_share *share;
    /** Share that correlations between terms have of the same variance, beyond the terms by
     *  themselves (imk_drift_cross): it may be negative; 0: there are none. */
    double correlation_share;
    /** Terms that the model does not state and that would matter at the rows of the table, the
     *  largest share first. If there are any, all figures are lower bounds. */
    size_t missing_count;
    imk_drift_missing missing[IMK_UNSTATED_MAX];
} imk_drift_case;

/** A device of the catalogue that may meet the requirement. */
typedef struct imk_drift_candidate {
    const imk_device *device;
    imk_drift_figures figures;
    bool usable; /**< it has gyros and accelerometers, and the analysis succeeded */
    /** Terms that its source does not state and that would matter for the figure wanted: if there
     *  are any, the figures are lower bounds. */
    size_t missing_count;
    imk_drift_missing missing[IMK_UNSTATED_MAX];
    bool no_memory;
} imk_drift_candidate;

/** A factor between this and 1 counts as no improvement. */
#define IMK_DRIFT_SAME 0.9995

/** Ways to meet the requirement. */
typedef struct imk_drift_answer {
    imk_drift_allocation allocation;
    size_t order_count; /**< number of terms that must improve */
    /** Their indices, the term that must improve most first. */
    size_t order[IMK_DRIFT_SOURCES_MAX];
    bool alone; /**< true: improving only one of them can be enough */
    /** With `retuned`, the figure found with the factors of the allocation: the goal, within 0.2 %,
     *  or more if it cannot be met. */
    double reached;
    size_t candidate_count;
    imk_drift_candidate *candidate; /**< the best first */
} imk_drift_answer;

/** Result of the job. */
typedef struct imk_drift_models {
    imk_drift_models_settings settings;
    const imk_drift_times *times;
    size_t model_count;
    const imk_model *model[IMK_DRIFT_MODELS_MAX];
    const char *name[IMK_DRIFT_MODELS_MAX];
    size_t case_count; /**< after a failure, the last case is the one that failed */
    imk_drift_case cases[IMK_DRIFT_MODELS_MAX + 1];
    imk_drift_answer *answer; /**< NULL: there is no requirement */
    /** Monte Carlo of the last case, at the rows of the table; NULL: none. */
    uint64_t run_count;
    imk_drift_figures *found, *low, *high; /**< figures and their 95 % intervals */
    size_t *used;                          /**< number of runs used */
    /** Of an aided navigator: mean over the runs of the errors squared, normalised by the filter's
     *  own covariance, and its degrees of freedom; 0: none. */
    int nees_degrees;
    double *nees;
} imk_drift_models;

/** Analyse models. The models, their names and the times must outlive the result.
 *  @param count   number of models, up to IMK_DRIFT_MODELS_MAX; 1 if there is a requirement; 0:
 *                 only show runs that come from elsewhere
 *  @param job     NULL: one thread, no progress, the memory of the C library
 *  @param result  free it with imk_drift_models_free(), also after a failure; NULL if there was no
 *                 memory for it
 *  @return errors of imk_drift_covariance(); IMK_ERROR_MEMORY */
IMK_API imk_status imk_drift_models_run(size_t count, const imk_model *const *models,
                                        const char *const *names, const imk_drift_times *times,
                                        const imk_drift_models_settings *settings,
                                        const imk_job *job, imk_drift_models **result,
                                        imk_error *error);
/** Add statistics of Monte Carlo runs of the last case at the rows of the table (imk_drift_runs(),
 *  imk_drift_aided_runs()).
 *  @param degrees  of the normalised errors squared (imk_drift_nees_degrees()); 0: there are none
 *  @param errors   [run][row][state], IMK_DRIFT_STATES or, with degrees, IMK_DRIFT_AIDED_STATES
 *                  states
 *  @return IMK_ERROR_MEMORY */
IMK_API imk_status imk_drift_models_take_runs(imk_drift_models *models, size_t runs, int degrees,
                                              const double *errors, imk_error *error);
/** Simulate runs of the last case on the threads of the job, and take their statistics
 *  (imk_drift_models_take_runs()). They are the runs 0 … runs - 1 of imk_drift_runs() or
 *  imk_drift_aided_runs(), whatever the number of threads.
 *  @param errors  set to [run][row][state]: IMK_DRIFT_STATES, with aids IMK_DRIFT_AIDED_STATES
 *                 states; memory of the result. NULL: not wanted
 *  @return errors of these; IMK_ERROR_MEMORY, IMK_ERROR_RANGE (no runs, or more than 2^32 - 1) */
IMK_API imk_status imk_drift_models_simulate(imk_drift_models *models, uint64_t seed, uint64_t runs,
                                             const imk_job *job, const double **errors,
                                             imk_error *error);
/** Free it and all it holds; NULL is allowed. */
IMK_API void imk_drift_models_free(imk_drift_models *result);

IMK_END_C
#endif
