/* SPDX-License-Identifier: Apache-2.0 */
/** @file allan.h
 *  Allan deviation with confidence intervals. */
#ifndef IMUKIT_ALLAN_H
#define IMUKIT_ALLAN_H

#include "imukit/executor.h"
#include "imukit/status.h"

#include <stdbool.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum imk_allan_statistic {
    IMK_ALLAN_OVERLAPPING = 0, /**< OADEV */
    IMK_ALLAN_PLAIN            /**< ADEV: non-overlapping clusters */
} imk_allan_statistic;

/** Which averaging factors: powers of two, ten per decade, or every one. */
typedef enum imk_allan_grid {
    IMK_ALLAN_OCTAVE = 0,
    IMK_ALLAN_DECADE,
    IMK_ALLAN_ALL
} imk_allan_grid;
/** Averaging factors m (tau = m dt), ascending from 1 to n/2, for n rate samples.
 *  @param factors  NULL to count only
 *  @return how many */
IMK_API size_t imk_allan_factors(imk_allan_grid grid, size_t n, size_t *factors);

/** Running sums of a rate record: sums[i] = sum over j < i of (rate[j] - mean), n + 1 values.
 *
 *  The mean is taken first, and the sums carry their rounding error along, so that a large constant
 *  (gravity on an accelerometer) costs no digits. In place is allowed: `sums` may be the memory of
 *  `rate` when that has room for n + 1.
 *  @param executor NULL for serial; the result does not depend on it */
IMK_API void imk_allan_sums(size_t n, const double *rate, double *sums,
                            const imk_executor *executor);

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

/** Exact equivalent degrees of freedom, 2 E^2/var, of the sampled process: independent rate samples
 *  for white rate noise (666.2 at m = 1, n = 1000, where the continuous process gives 782.0),
 *  independent sums for white phase noise. Flicker laws by their continuous form. Beyond m = 256
 *  evaluated at m = 256 with the record in proportion, good to 1e-3. Same arguments as above. */
IMK_API double imk_allan_edf_exact(imk_allan_statistic statistic, imk_power_law type, size_t n,
                                   size_t m);

/** Interval of the deviation at two-sided confidence (0.683, 0.95, …) for a variance with edf
 *  degrees of freedom: deviation * sqrt(edf / chi2 quantile). */
IMK_API void imk_allan_interval(double deviation, double edf, double confidence, double *lower,
                                double *upper);

/** How to evaluate Allan deviations. Start from imk_allan_default(), then change fields. */
typedef struct imk_allan_settings {
    uint32_t cookie;
    imk_allan_statistic statistic;
    double confidence;    /**< two-sided, of the intervals; 0.95 */
    bool greenhall_riley; /**< degrees of freedom of the continuous process; false: exact ones */
} imk_allan_settings;

/** 95 % intervals of the overlapping deviation, with the exact degrees of freedom. */
IMK_API imk_allan_settings imk_allan_default(void);

/** One point of an Allan plot. */
typedef struct imk_allan_point {
    size_t m;                       /**< averaging factor, tau = m dt */
    double deviation, lower, upper; /**< [unit of the rate] */
    double edf;                     /**< equivalent degrees of freedom */
    size_t count;                   /**< squares averaged */
    imk_power_law
        type; /**< noise type used for edf; that of the last factor with enough clusters */
} imk_allan_point;

/** Deviations with intervals at each factor (ascending, 1 … n/2).
 *  @param sums    n + 1 running sums, imk_allan_sums()
 *  @param points  factor_count values
 *  @return IMK_ERROR_RANGE, IMK_ERROR_UNINITIALISED, IMK_ERROR_TOO_SHORT */
IMK_API imk_status imk_allan_points(const imk_allan_settings *settings, size_t n,
                                    const double *sums, size_t factor_count, const size_t *factors,
                                    imk_allan_point *points, const imk_executor *executor);

#ifdef __cplusplus
}
#endif
#endif
