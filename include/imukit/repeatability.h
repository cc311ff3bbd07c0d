/* SPDX-License-Identifier: Apache-2.0 */
/** @file repeatability.h
 *  How much bias and scale factor differ from one power cycle to the next.
 *
 *  Each run gives a value with its own uncertainty, y_k = mean + u_k + e_k. The standard deviation
 *  of u is the repeatability; that of e is known from within each run and must not be counted as
 *  well. One-way random effects with unequal variances:
 *
 *      Q(t) = sum of w_k (y_k - sum(w y)/sum(w))^2,   w_k = 1/(sigma_k^2 + t)
 *
 *  is chi-square with K - 1 degrees of freedom at the true t = variance of u. The estimate is where
 *  Q has its mean [PAULE1982], the interval where it has its quantiles [VIECHTBAUER2007]; both are
 *  exact however few the runs are, when the sigmas are. Where a sigma has few degrees of freedom
 *  itself, Q is scaled and compared with an F distribution [WELCH1951]. A difference that the runs
 *  do not show is never negative: the value is then 0, with an upper bound. */
#ifndef IMUKIT_REPEATABILITY_H
#define IMUKIT_REPEATABILITY_H

#include "imukit/calibration.h"
#include "imukit/static_detection.h"

IMK_BEGIN_C

enum { IMK_RUNS_MAX = 1024 };

/** One quantity over all runs. */
typedef struct imk_repeatability {
    size_t runs;             /**< 0: not looked at */
    double mean, mean_sigma; /**< over the runs, and 1 sigma with what lies between them */
    double value;            /**< 1 sigma from run to run; root of the estimated variance, which for
                                  few runs is low on the average: by 6 % of itself with 5 */
    double sigma;            /**< of value, to first order; rely on the interval */
    double lower, upper;     /**< interval of value; lower 0: runs do not differ significantly */
    double within;           /**< root mean square of the runs' own sigmas */
    double probability; /**< that runs without any difference between them scatter so much or more
                         */
} imk_repeatability;

/** Analyse values of 2 … IMK_RUNS_MAX runs.
 *  @param sigma       of each, >= 0, all of it that is not from run to run: noise and instability
 *                     within a run
 *  @param freedom     degrees of freedom of each sigma, > 0, infinite: exact; NULL: all are
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

/** The runs of a log: every stretch of one section, or the whole of it when it has none. Ends are
 *  left out: `trim` at both, `settle` at the beginning besides [s].
 *  @param count  how many there are, also beyond the capacity
 *  @return IMK_ERROR_TOO_SHORT (a run shorter than `minimum` [s] is no error; none at all is) */
IMK_API imk_status imk_repeatability_runs(const imk_test_record *record, double trim, double settle,
                                          double minimum, size_t capacity, imk_static_interval *run,
                                          size_t *count, imk_error *error);

/** Bias from run to run by one hold a run, all in the same attitude and, for gyros, the same
 *  heading. What a change of attitude does to accelerometers looks like a change of bias: keep the
 *  unit fixed, or state how well it is put back; result->attitude tells how far the forces differ.
 *  @param model           nominal sensitivities of readings in counts, axes
 *  @param counts          gyros, accelerometers read counts
 *  @param attitude_sigma  1 sigma of the attitude about each level axis from run to run [rad], not
 *                         counted as bias; 0: the unit stays where it is
 *  @return as imk_repeatability_estimate(), IMK_ERROR_UNIT_MISSING (counts without sensitivity) */
IMK_API imk_status imk_repeatability_of_holds(const imk_model *model, const bool counts[2],
                                              size_t runs, const imk_static_interval *run,
                                              double attitude_sigma, double confidence,
                                              imk_repeatability_result *result, imk_error *error);

/** Bias and scale factor from run to run by a whole calibration each. Parameters that one of them
 *  does not state are not looked at. Their frames should agree.
 *  @return as imk_repeatability_estimate() */
IMK_API imk_status imk_repeatability_of_calibrations(size_t runs,
                                                     const imk_calibration_result *const *run,
                                                     double confidence,
                                                     imk_repeatability_result *result,
                                                     imk_error *error);

/** Into a model: bias.repeatability and scale_factor.repeatability of the axes looked at, with
 *  sigmas, and their intervals as evidence (as long as there is room). */
IMK_API void imk_repeatability_to_model(const imk_repeatability_result *result, imk_model *model);

IMK_END_C
#endif
