/* SPDX-License-Identifier: Apache-2.0 */
/** @file allan.h
 *  The Allan family of deviations with confidence intervals. */
#ifndef IMUKIT_ALLAN_H
#define IMUKIT_ALLAN_H

#include "imukit/executor.h"
#include "imukit/status.h"

#include <stdbool.h>

IMK_BEGIN_C

/** The statistics, what each estimates, and its range of averaging factors m for a record of n rate
 *  samples. docs/theory/allan-deviation.md says which to use for what; equations of [RILEY2008]. */
typedef enum imk_allan_statistic {
    IMK_ALLAN_OVERLAPPING = 0, /**< OADEV, 1 … n/2 */
    IMK_ALLAN_PLAIN,           /**< ADEV: non-overlapping clusters, 1 … n/2 */
    IMK_ALLAN_MODIFIED,        /**< MDEV: tells white from flicker phase noise, 1 … (n+1)/3 */
    IMK_ALLAN_TIME,            /**< TDEV = tau MDEV/sqrt(3) [unit of the rate times the interval] */
    IMK_ALLAN_HADAMARD,        /**< OHDEV, overlapping: blind to a ramp of the rate, 1 … n/3 */
    IMK_ALLAN_HADAMARD_PLAIN,  /**< HDEV: non-overlapping, 1 … n/3 */
    IMK_ALLAN_TOTAL,           /**< TOTDEV: ADEV of the record reflected at its ends, 1 … n/2 */
    IMK_ALLAN_MODIFIED_TOTAL,  /**< MTOT: MDEV of reflected stretches, 1 … (n+1)/3 */
    IMK_ALLAN_HADAMARD_TOTAL,  /**< HTOT: HDEV of reflected stretches, 1 … n/3 */
    IMK_ALLAN_THEO1,           /**< Theo1: ADEV at tau = 0.75 m dt; m even, 10 … n */
    IMK_ALLAN_PARABOLIC,       /**< PDEV: of least-squares slopes, 1 … (n+1)/2 [VERNOTTE2016] */
    IMK_ALLAN_HAAR,            /**< Haar wavelet deviation at scale 2 m: OADEV/sqrt(2), 1 … n/2 */
    IMK_ALLAN_STATISTICS       /**< how many there are */
} imk_allan_statistic;

/** Short name of a statistic, "oadev"; NULL for a value that is not a statistic. */
IMK_API const char *imk_allan_name(imk_allan_statistic statistic);
/** Title of a statistic, "overlapping Allan deviation"; NULL for a value that is not a statistic.
 */
IMK_API const char *imk_allan_title(imk_allan_statistic statistic);

/** Lowest and highest averaging factor of a statistic, and the step between valid ones (2 for
 * Theo1, which takes even ones, 1 for all others). highest < lowest: the record is too short. */
IMK_API void imk_allan_range(imk_allan_statistic statistic, size_t n, size_t *lowest,
                             size_t *highest, size_t *step);

/** Averaging time in samples: m, and 0.75 m for Theo1. */
IMK_API double imk_allan_averaging(imk_allan_statistic statistic, size_t m);

/** Grids of averaging factors: powers of two, ten per decade, all, or many (all up to 64, then 32
 *  per octave). */
typedef enum imk_allan_grid {
    IMK_ALLAN_OCTAVE = 0,
    IMK_ALLAN_DECADE,
    IMK_ALLAN_ALL,
    IMK_ALLAN_MANY
} imk_allan_grid;
/** Averaging factors m (tau = m dt), ascending from 1 to n/2, for n rate samples.
 *  @param factors  NULL to count only
 *  @return how many */
IMK_API size_t imk_allan_factors(imk_allan_grid grid, size_t n, size_t *factors);
/** As imk_allan_factors(), limited to the range of a statistic. Theo1, which needs even factors,
 *  takes twice the factors of the grid from 5 on. */
IMK_API size_t imk_allan_factors_for(imk_allan_statistic statistic, imk_allan_grid grid, size_t n,
                                     size_t *factors);

/** Running sums of a rate record: sums[i] = sum over j < i of (rate[j] - mean), n + 1 values.
 *
 *  The mean is taken first, and the sums carry their rounding error along, so that a large constant
 *  (gravity on an accelerometer) costs no digits. In place is allowed: `sums` may be the memory of
 *  `rate` when that has room for n + 1.
 *  @param executor NULL for serial; the result does not depend on it */
IMK_API void imk_allan_sums(size_t n, const double *rate, double *sums,
                            const imk_executor *executor);

/** Workspace [bytes] that imk_allan_compute() needs for these factors and threads; 0 for all
 *  statistics but MTOT, HTOT and Theo1. For these, about 280 m bytes a thread (m is the largest
 *  factor), at most 40 n; for Theo1 600 m, at most 75 n, and 0 if no m is above 800. Also 0 when a
 *  factor is out of range. */
IMK_API size_t imk_allan_workspace_size(imk_allan_statistic statistic, size_t n,
                                        size_t factor_count, const size_t *factors, size_t threads);

/** Variances of a statistic from running sums (or phase data divided by dt).
 *
 *      OAVAR(m) = 1/(2 m^2 (n - 2m + 1)) sum_j (s[j+2m] - 2 s[j+m] + s[j])^2   [RILEY2008, (11)]
 *
 *  The other statistics follow their definitions; their bias is not removed. TVAR is in units of
 *  the rate times the sample interval: multiply the deviation by dt. Time per factor: O(n), for
 *  Theo1 O(n log^2 m).
 *  @param n          rate samples; sums has n + 1 values
 *  @param factors    averaging factors in the statistic's range; also those for which the variance
 *                    is defined, but has no interval: TOTDEV up to n, Theo1 from 2
 *  @param variances,counts  factor_count values; counts (may be NULL): number of squares, or
 *                    stretches, averaged
 *  @param workspace  imk_allan_workspace_size() bytes for executor->threads threads; any address
 *  @param executor   NULL for serial. Summation order is fixed: the result does not depend on it
 *  @return IMK_ERROR_RANGE, IMK_ERROR_TOO_SHORT, IMK_ERROR_WORKSPACE */
IMK_API imk_status imk_allan_compute(imk_allan_statistic statistic, size_t n, const double *sums,
                                     size_t factor_count, const size_t *factors, double *variances,
                                     size_t *counts, const imk_executor *executor, void *workspace,
                                     size_t workspace_size);

/** As imk_allan_compute(), for the statistics that need no workspace. */
IMK_API imk_status imk_allan_variances(imk_allan_statistic statistic, size_t n, const double *sums,
                                       size_t factor_count, const size_t *factors,
                                       double *variances, size_t *counts,
                                       const imk_executor *executor);

/** Power-law type of a noise, S_y(f) ~ f^alpha: 2 white phase (quantization), 1 flicker phase,
 *  0 white rate, -1 flicker rate, -2 random-walk rate; the Hadamard family converges for -3 flicker
 *  walk and -4 random run too. */
typedef enum imk_power_law {
    IMK_WHITE_PHASE = 2,
    IMK_FLICKER_PHASE = 1,
    IMK_WHITE_RATE = 0,
    IMK_FLICKER_RATE = -1,
    IMK_RANDOM_WALK_RATE = -2,
    IMK_FLICKER_WALK_RATE = -3,
    IMK_RANDOM_RUN_RATE = -4
} imk_power_law;

/** Noise type at averaging factor m, 2 to -2: the one whose lag-1 autocorrelation of (differenced)
 *  means is next to the record's, as in [RILEY2004]. @return
 *  IMK_ERROR_TOO_SHORT unless n/m >= 30; IMK_ERROR_NOT_FINITE when squares of the samples overflow
 */
IMK_API imk_status imk_allan_noise_type(size_t n, const double *sums, size_t m,
                                        imk_power_law *type);

/** As imk_allan_noise_type(), down to the lowest type for which a statistic converges: -4 for the
 *  Hadamard family. */
IMK_API imk_status imk_allan_noise_type_for(imk_allan_statistic statistic, size_t n,
                                            const double *sums, size_t m, imk_power_law *type);

/** Equivalent degrees of freedom, 2 E^2/var, at factor m; NaN outside the range of m.
 *
 *  ADEV, OADEV, MDEV, TDEV, HDEV, OHDEV, PDEV, Haar: exact ones of the sampled process: independent
 *  rate samples for white rate noise (666.2 for OADEV at m = 1, n = 1000, where the continuous
 *  process gives 782.0), independent sums for white phase noise. Flicker laws by their continuous
 *  form. Beyond m = 256 (PDEV: 32) evaluated there with the record in proportion, good to 1e-3.
 *
 *  TOTDEV, MTOT, HTOT, Theo1: from tables of the exact degrees of freedom of their quadratic forms
 *  over n/m; good to 5 % for types 0 and below, 20 % for phase noises. */
IMK_API double imk_allan_edf_exact(imk_allan_statistic statistic, imk_power_law type, size_t n,
                                   size_t m);

/** Expected ratio of a variance to the one it stands for (AVAR for TOTDEV and Theo1, MVAR for MTOT,
 *  HVAR for HTOT): for TOTDEV and Theo1 the exact one of the sampled process, in O(m) up to m =
 *  4096; for MTOT and HTOT its limit for large m, good to 1 % from m = 8. 1 for the others. */
IMK_API double imk_allan_bias(imk_allan_statistic statistic, imk_power_law type, size_t n,
                              size_t m);

/** As imk_allan_bias(), by the published fits [RILEY2008, 5.12 to 5.16], which printed tables use.
 *  For MTOT they are up to 6 % off: 0.73 with white rate noise, where the ratio is 0.771. */
IMK_API double imk_allan_bias_published(imk_allan_statistic statistic, imk_power_law type, size_t n,
                                        size_t m);

/** Treatment of the bias of TOTDEV, MTOT, HTOT and Theo1. */
typedef enum imk_allan_bias_removal {
    IMK_ALLAN_BIAS_REMOVED = 0, /**< the variance is divided by imk_allan_bias() for the noise type
                                   found, and HTOT at m = 1 is OHDEV */
    IMK_ALLAN_BIAS_PUBLISHED,   /**< the variance is divided by imk_allan_bias_published() */
    IMK_ALLAN_BIAS_LEFT         /**< the bias is not removed */
} imk_allan_bias_removal;

/** Interval of the deviation at two-sided confidence (0.683, 0.95, …) for a variance with edf
 *  degrees of freedom: deviation * sqrt(edf / chi2 quantile). Above a confidence of 0.999999999 the
 *  lower end loses accuracy; at the last number below 1 it is NaN. */
IMK_API void imk_allan_interval(double deviation, double edf, double confidence, double *lower,
                                double *upper);

/** How to evaluate Allan deviations. Start from imk_allan_default(), then change fields. */
typedef struct imk_allan_settings {
    uint32_t cookie;
    imk_allan_statistic statistic;
    double confidence; /**< two-sided, of the intervals; default 0.95 */
    /** true: degrees of freedom of the continuous process, by the general formula of Greenhall and
     *  Riley [GREENHALL2003] for ADEV, OADEV, MDEV, TDEV, HDEV, OHDEV and Haar, its sum for PDEV;
     *  the published fits for TOTDEV, MTOT, HTOT [RILEY2008, 5.4] and Theo1 [HOWE2003], which are
     *  up to 20 % off below n/m = 6 (Theo1 with random-walk rate noise: of no use below n/m = 3).
     *  false: those of imk_allan_edf_exact(). */
    bool greenhall_riley;
    imk_allan_bias_removal bias;
    /** Point of the next shorter averaging factor, if it was computed in an earlier call; its type
     *  is where the types of this call start. NULL (default): there is none. */
    const struct imk_allan_point *before;
    void *workspace; /**< MTOT, HTOT and Theo1 only: imk_allan_workspace_size() */
    size_t workspace_size;
} imk_allan_settings;

/** 95 % intervals of the overlapping deviation, with the exact degrees of freedom. */
IMK_API imk_allan_settings imk_allan_default(void);

/** One point of an Allan plot. */
typedef struct imk_allan_point {
    size_t m;                       /**< averaging factor, tau = imk_allan_averaging() dt */
    double deviation, lower, upper; /**< [unit of the rate]; TDEV: times the interval */
    double edf;                     /**< equivalent degrees of freedom */
    size_t count;                   /**< squares averaged */
    /** Noise type used for edf. Below 30 clusters (n/m) it is that of the factor before, below 100
     *  clusters no bluer than that; phase noise is not found behind noise of the rate. */
    imk_power_law type;
} imk_allan_point;

/** Compute deviations with intervals at each factor (ascending, in the statistic's range).
 *  @param sums    n + 1 running sums, imk_allan_sums()
 *  @param points  factor_count values
 *  @return IMK_ERROR_RANGE, IMK_ERROR_UNINITIALISED, IMK_ERROR_TOO_SHORT, IMK_ERROR_WORKSPACE,
 *          IMK_ERROR_NOT_FINITE (a sample is not finite, or squares overflow) */
IMK_API imk_status imk_allan_points(const imk_allan_settings *settings, size_t n,
                                    const double *sums, size_t factor_count, const size_t *factors,
                                    imk_allan_point *points, const imk_executor *executor);

IMK_END_C
#endif
