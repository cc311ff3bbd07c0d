/* SPDX-License-Identifier: Apache-2.0 */
/** @file repeatability.h
 *  Repeatability: variation of bias and scale factor from one power cycle to the next.
 *
 *  Each run gives a value with its own uncertainty, y_k = mean + u_k + e_k. The standard deviation
 *  of u is the repeatability; that of e is known from within each run and must not be included.
 *  One-way random effects with unequal variances:
 *
 *      Q(t) = sum of w_k (y_k - sum(w y)/sum(w))^2,   w_k = 1/(sigma_k^2 + t)
 *
 *  is chi-square with K - 1 degrees of freedom at the true t = variance of u. The estimate is the t
 *  at which Q equals its mean [PAULE1982]; the interval ends where Q equals its quantiles
 *  [VIECHTBAUER2007]. Both are exact for any number of runs if the sigmas are exact. If a sigma has
 *  few degrees of freedom itself, Q is scaled and compared with an F distribution [WELCH1951]. If
 *  the runs show no variation, the value is 0, with an upper bound. */
#ifndef IMUKIT_REPEATABILITY_H
#define IMUKIT_REPEATABILITY_H

#include "imukit/calibration.h"
#include "imukit/static_detection.h"

IMK_BEGIN_C

enum { IMK_RUNS_MAX = 1024 };

/** One quantity over all runs. */
typedef struct imk_repeatability {
    size_t runs;             /**< number of runs; 0: not analysed */
    double mean, mean_sigma; /**< mean over the runs, and its 1 sigma, including the variation
                                between runs */
    double value; /**< 1 sigma from run to run: root of the estimated variance. For few runs it is
                     too low on average, by 6 % with 5 runs */
    double sigma; /**< 1 sigma of value, to first order; the interval is more reliable */
    double lower, upper; /**< interval of value; lower 0: runs do not differ significantly */
    double within;       /**< root mean square of the runs' own sigmas */
    double probability;  /**< probability that runs without any variation between them scatter so
                            much or more */
} imk_repeatability;

/** Analyse values of 2 … IMK_RUNS_MAX runs.
 *  @param sigma       1 sigma of each value, >= 0, without the variation from run to run: noise and
 *                     instability within a run
 *  @param freedom     degrees of freedom of each sigma, > 0, infinite: exact; NULL: all are exact
 *  @param confidence  of the interval, such as 0.95
 *  @return IMK_ERROR_TOO_SHORT (fewer than two; value, limit), IMK_ERROR_NOT_FINITE (index),
 *          IMK_ERROR_RANGE (a sigma, a freedom, the confidence; index: the run) */
IMK_API imk_status imk_repeatability_estimate(size_t runs, const double *value, const double *sigma,
                                              const double *freedom, double confidence,
                                              imk_repeatability *result, imk_error *error);

/** All axes. */
typedef struct imk_repeatability_result {
    int axis_count[2];
    imk_repeatability bias[2][IMK_AXES_MAX];         /**< [rad/s], [m/s^2] */
    imk_repeatability scale_factor[2][IMK_AXES_MAX]; /**< [1] */
    double attitude; /**< largest angle between the mean forces of two runs [rad]; NaN: not known */
} imk_repeatability_result;

/** Find the runs of a log: each stretch of one section, or the whole log if it has no sections.
 *  Ends are left out: `trim` at both ends, and `settle` also at the beginning [s].
 *  @param count  number of runs found, also beyond the capacity
 *  @return IMK_ERROR_TOO_SHORT (there is no run at all; runs shorter than `minimum` [s] are left
 *          out) */
IMK_API imk_status imk_repeatability_runs(const imk_test_record *record, double trim, double settle,
                                          double minimum, size_t capacity, imk_static_interval *run,
                                          size_t *count, imk_error *error);

/** Repeatability of the bias from one hold a run, all in the same attitude and, for gyros, the same
 *  heading. A change of attitude looks like a change of accelerometer bias: keep the unit fixed, or
 *  state attitude_sigma; result->attitude tells how much the directions of the forces differ.
 *  @param model           gives the axes, and nominal sensitivities of readings in counts
 *  @param counts          true: readings of gyros, of accelerometers are in counts
 *  @param attitude_sigma  1 sigma of the attitude about each level axis from run to run [rad],
 *                         whose effect is not counted as bias; 0: the unit is not moved
 *  @return errors of imk_repeatability_estimate(), IMK_ERROR_UNIT_MISSING (counts without
 *          sensitivity) */
IMK_API imk_status imk_repeatability_of_holds(const imk_model *model, const bool counts[2],
                                              size_t runs, const imk_static_interval *run,
                                              double attitude_sigma, double confidence,
                                              imk_repeatability_result *result, imk_error *error);

/** Repeatability of bias and scale factor from one whole calibration a run. Parameters that a
 *  calibration does not state are not analysed. The frames of the calibrations should agree.
 *  @return errors of imk_repeatability_estimate() */
IMK_API imk_status imk_repeatability_of_calibrations(size_t runs,
                                                     const imk_calibration_result *const *run,
                                                     double confidence,
                                                     imk_repeatability_result *result,
                                                     imk_error *error);

/** Write the result into a model: bias.repeatability and scale_factor.repeatability of the analysed
 *  axes, with sigmas, and their intervals as evidence (as far as there is room). */
IMK_API void imk_repeatability_to_model(const imk_repeatability_result *result, imk_model *model);

IMK_END_C
#endif
