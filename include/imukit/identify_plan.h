/* SPDX-License-Identifier: Apache-2.0 */
/** @file identify_plan.h
 *  How accurately a planned record will determine each noise term, and how long it must be.
 *
 *  The information of Whittle's likelihood [WHITTLE1953] about the parameters p of a spectrum S,
 *
 *      I_ij = 1/2 sum_k (dS/dp_i)(dS/dp_j)/S^2,    f_k = k/(2 n dt),  k = 1 ... n - 1,
 *
 *  with the expectations of a finite record at the lowest k, is inverted: no unbiased estimate has
 *  a smaller covariance (Cramer-Rao). imk_identify_channel() comes within some per cent of it. */
#ifndef IMUKIT_IDENTIFY_PLAN_H
#define IMUKIT_IDENTIFY_PLAN_H

#include "imukit/identify.h"

IMK_BEGIN_C

/** The noise expected on one axis. Sinusoids are left out: identification finds and subtracts them
 *  with almost no loss. */
typedef struct imk_expected_noise {
    double term[IMK_NOISE_TERMS]; /**< Q, N, B, K, R, each in its unit; 0: absent. Q with white
                                     noise of the integral: imk_noise_reading() */
    imk_low_pass filter;          /**< bandwidth 0: none */
    int gauss_markov_count, resonance_count;
    imk_gauss_markov gauss_markov[IMK_TERMS_MAX];
    imk_resonance resonance[IMK_TERMS_MAX];
} imk_expected_noise;

/** What identification finds of a model's noise where it does not see the output filter. */
typedef struct imk_identify_seen {
    double white;   /**< N [unit/sqrt(Hz)] */
    double reading; /**< 1 sigma of a reading of the integral [unit s] */
} imk_identify_seen;

/** The white noise and the errors of the readings that an estimate without a filter tends to, in
 *  records of this duration [s] and of samples dt [s] apart of this axis: those of the model if the
 *  axis has no bandwidth; for a bandwidth beyond half the sample rate some percent less
 *  [WHITE1982]. Takes about 10 ms.
 *  @param readings  errors of the readings are part of the estimate; if not, white noise has them
 */
IMK_API imk_identify_seen imk_identify_seen_of(const imk_triad *triad, int axis, double dt,
                                               double duration, bool readings);

/** The noise of one axis of a model, sampled at intervals dt [s]. Terms of strength 0 are left out.
 */
IMK_API imk_expected_noise imk_expected_noise_of(const imk_triad *triad, int axis, double dt);

typedef struct imk_bounds_settings {
    uint32_t cookie;
    double dt;                  /**< sample interval [s] */
    double significance;        /**< false-alarm rate at which a term is called present, see
                                   imk_identify_settings; default 0.01 */
    bool free[IMK_NOISE_TERMS]; /**< terms estimated even if the noise has none of them; default
                                   white noise, bias instability and random walk. Terms that the
                                   noise has are always estimated */
    bool shape; /**< correlation times, filter and resonances are estimated from the record too;
                   default true */
} imk_bounds_settings;

/** The defaults stated above; dt must be set. */
IMK_API imk_bounds_settings imk_bounds_default(void);

/** Smallest possible error of one parameter. */
typedef struct imk_bound {
    double value;        /**< value of the parameter */
    double square_sigma; /**< standard deviation of the estimate of its square [unit^2] */
    double sigma;     /**< of the estimate itself: square_sigma/(2 value); infinite for value 0 */
    double relative;  /**< sigma/value; infinite for value 0 */
    double detection; /**< probability that the term is called present; 0 for value 0 */
} imk_bound;

typedef struct imk_identification_bounds {
    imk_bound term[IMK_NOISE_TERMS]; /**< of a ramp square_sigma is 2 |R| sigma */
    /** Covariance of Q^2, N^2, B^2, K^2 and R; 0 where not estimated. */
    double covariance[IMK_NOISE_TERMS][IMK_NOISE_TERMS];
    imk_bound sigma[IMK_TERMS_MAX];            /**< of the Gauss-Markov terms */
    imk_bound correlation_time[IMK_TERMS_MAX]; /**< detection is that of the term's sigma */
} imk_identification_bounds;

/** Bytes of workspace for the two functions below: some 700 KiB. */
IMK_API size_t imk_bounds_workspace_size(void);

/** Bounds for a record of a given duration [s].
 *
 *  Detection compares the likelihood with and without the term. Without it, the other terms take
 *  its place as well as they can and give a spectrum S'. The signed root of twice the gain in
 *  likelihood is nearly normal about sqrt(L), L = sum [log(S'/S) + S/S' - 1], with the variance sum
 *  (S/S' - 1)^2/(2 L), and must exceed the normal quantile of 1 - significance. Takes about 1 ms.
 *  @return IMK_ERROR_RANGE for a duration below 256 dt or above 1e12 dt, or noise out of range;
 *          IMK_ERROR_SINGULAR when the record cannot tell the parameters apart */
IMK_API imk_status imk_identify_bounds(const imk_expected_noise *noise,
                                       const imk_bounds_settings *settings, double duration,
                                       imk_identification_bounds *bounds, void *workspace,
                                       size_t workspace_size, imk_error *error);

/** A requirement on one parameter. */
typedef struct imk_identify_requirement {
    int term;        /**< imk_noise_term, or IMK_NOISE_TERMS + i for Gauss-Markov term i */
    bool time;       /**< true: the correlation time of a Gauss-Markov term, not its sigma */
    double relative; /**< required sigma/value; 0: no such requirement */
    /** Required probability of being called present, < 1; 0: no such requirement. */
    double detection;
} imk_identify_requirement;

/** Find the shortest record that meets a requirement, to 0.1 %. Takes about 50 ms.
 *  @param duration  receives its length [s]
 *  @return errors of imk_identify_bounds(); IMK_ERROR_NO_CONVERGENCE when no record of up to 1e12
 *          samples meets it */
IMK_API imk_status imk_identify_duration(const imk_expected_noise *noise,
                                         const imk_bounds_settings *settings,
                                         const imk_identify_requirement *requirement,
                                         double *duration, void *workspace, size_t workspace_size,
                                         imk_error *error);

IMK_END_C
#endif
