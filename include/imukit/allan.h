/* SPDX-License-Identifier: Apache-2.0 */
/** @file allan.h
 *  Allan deviation with confidence intervals. */
#ifndef IMUKIT_ALLAN_H
#define IMUKIT_ALLAN_H

#include "imukit/executor.h"
#include "imukit/status.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum imk_allan_statistic {
    IMK_ALLAN_OVERLAPPING = 0, /**< OADEV */
    IMK_ALLAN_PLAIN            /**< ADEV: non-overlapping clusters */
} imk_allan_statistic;

/** Averaging factors m (tau = m dt), ascending, for n rate samples: octaves, a number of points per
 *  decade, or all; the largest is (n - 1)/2, or n/9 when `trustworthy`.
 *  @param factors  NULL to count only
 *  @return how many */
typedef enum imk_allan_grid {
    IMK_ALLAN_OCTAVE = 0,
    IMK_ALLAN_DECADE,
    IMK_ALLAN_ALL
} imk_allan_grid;
IMK_API size_t imk_allan_factors(imk_allan_grid grid, size_t n, size_t *factors);

/** Running sums of a rate record: sums[i] = sum over j < i of (rate[j] - mean), n + 1 values.
 *
 *  The mean is taken first, and the sums carry their rounding error along, so that a large constant
 *  (gravity on an accelerometer) costs no digits. In place is allowed: `sums` may be the memory of
 *  `rate` when that has room for n + 1. */
IMK_API void imk_allan_sums(size_t n, const double *rate, double *sums);

/** Allan variances from running sums (or phase data divided by dt).
 *
 *      OAVAR(m) = 1/(2 m^2 (n - 2m + 1)) sum_j (s[j+2m] - 2 s[j+m] + s[j])^2       [RILEY2008,
 * (11)]
 *
 *  @param n        rate samples; sums has n + 1 values
 *  @param factors  averaging factors, 1 … n/2
 *  @param variances,counts  factor_count values; counts: squares averaged
 *  @param executor NULL for serial. Summation order is fixed: the result does not depend on it */
IMK_API imk_status imk_allan_variances(imk_allan_statistic statistic, size_t n, const double *sums,
                                       size_t factor_count, const size_t *factors,
                                       double *variances, size_t *counts,
                                       const imk_executor *executor);

/** Power-law type of a noise, S_y(f) ~ f^alpha: 2 white phase (quantization), 1 flicker phase,
 *  0 white rate, -1 flicker rate, -2 random-walk rate. */
typedef enum imk_power_law {
    IMK_WHITE_PHASE = 2,
    IMK_FLICKER_PHASE = 1,
    IMK_WHITE_RATE = 0,
    IMK_FLICKER_RATE = -1,
    IMK_RANDOM_WALK_RATE = -2
} imk_power_law;

/** Noise type at averaging factor m by the lag-1 autocorrelation [RILEY2004]. Needs (n+1)/m >= 30
 * points; IMK_ERROR_TOO_SHORT otherwise. */
IMK_API imk_status imk_allan_noise_type(size_t n, const double *sums, size_t m,
                                        imk_power_law *type);

/** Equivalent degrees of freedom of OADEV or ADEV at factor m by Greenhall and Riley
 *  [GREENHALL2003] (simplified and full forms as their table says). */
IMK_API double imk_allan_edf_greenhall_riley(imk_allan_statistic statistic, imk_power_law type,
                                             size_t n, size_t m);

/** Exact equivalent degrees of freedom, 2 E^2/var, for a *sampled* Gaussian process given by the
 *  structure of its spectrum: `second` are the expected Allan variances at this process's
 *  generalised autocovariance... see allan.c. For independent rate samples (white rate noise):
 *  666.2 at m = 1, n = 999. */
IMK_API double imk_allan_edf_exact(imk_allan_statistic statistic, imk_power_law type, size_t n,
                                   size_t m);

/** Interval of the deviation at two-sided confidence (0.683, 0.95, …) for a variance with edf
 *  degrees of freedom: deviation * sqrt(edf / chi2 quantile). */
IMK_API void imk_allan_interval(double deviation, double edf, double confidence, double *lower,
                                double *upper);

#ifdef __cplusplus
}
#endif
#endif
