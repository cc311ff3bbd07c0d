/* SPDX-License-Identifier: Apache-2.0 */
/** @file record_screen.h
 *  Faults of one channel of a static record, found and removed before a noise model is fitted:
 *  missing, repeated, stuck, saturated and outlying samples, steps in the level, warm-up, and
 *  dependence on temperature (docs/records-with-faults.md, docs/theory/gaps.md). */
#ifndef IMUKIT_RECORD_SCREEN_H
#define IMUKIT_RECORD_SCREEN_H

#include "imukit/status.h"

#include <stdbool.h>

IMK_BEGIN_C

/** Number of samples with one kind of fault. */
typedef struct imk_screen_count {
    size_t count; /**< samples */
    size_t runs;  /**< stretches of such samples */
    size_t first; /**< index of the first sample; n when there is none */
} imk_screen_count;

/** Settings of the search for faults. Start from imk_screen_default(), then change fields. */
typedef struct imk_screen_settings {
    uint32_t cookie;
    double dt;           /**< sample interval [s]; must be set */
    double false_alarm;  /**< chance that an outlier is found in Gaussian noise without faults;
                            default 1e-3 */
    double significance; /**< false-alarm rate of warm-up, temperature slope and steps, each;
                            default 0.001 */
    const double *temperature; /**< n values [K or degC], NaN where missing; NULL: none */
} imk_screen_settings;

/** The defaults stated above, no temperature; dt must be set. */
IMK_API imk_screen_settings imk_screen_default(void);

/** Result for one channel. Values are in the channel's unit. */
typedef struct imk_screen {
    size_t n, present;        /**< number of samples, and of finite samples */
    imk_screen_count missing; /**< samples that are not finite; `runs` counts the gaps */
    size_t longest_hole;      /**< samples */

    imk_screen_count outliers; /**< far from the level around them */
    double outlier_threshold;  /**< distance from the level from which a sample is an outlier */
    double largest_outlier;    /**< largest distance of an outlier from the level */
    imk_screen_count stuck; /**< samples in runs of one value that are longer than the noise allows,
                               without the first sample of each run */
    size_t longest_stuck;   /**< samples in the longest run */
    size_t stuck_limit;     /**< longest run of one value that the noise allows [samples] */
    imk_screen_count saturated; /**< samples at an extreme value that occurs too often */
    /** These extreme values; infinite where there is none. */
    double saturation_low, saturation_high;
    double repeated;   /**< share of samples equal to the one before */
    double resolution; /**< smallest step between values; 0 when none is detected */
    double deviation;  /**< of the samples about their mean */
    double noise;      /**< standard deviation about the local level, by the median */

    imk_screen_count steps; /**< sudden lasting changes of the level; first: index of the largest */
    double largest_step;

    /** Mean = level + warm_up_amplitude exp(-t/warm_up_time) */
    bool warm_up;
    double warm_up_amplitude, warm_up_amplitude_sigma; /**< at t = 0 */
    double warm_up_time, warm_up_time_sigma;           /**< [s] */
    double warm_up_probability; /**< probability that slow noise alone looks like this, 0 … 1 */

    /** Mean = level + slope (T - reference) + curvature (T - reference)^2 */
    int temperature_degree;       /**< 0: no dependence on temperature; else 1 or 2 */
    double temperature_reference; /**< mean temperature */
    double temperature_slope, temperature_slope_sigma;         /**< [unit/K] */
    double temperature_curvature, temperature_curvature_sigma; /**< [unit/K^2] */
    double temperature_probability;

    int degrees_taken; /**< number of parameters fitted to the mean; they take as many degrees of
                          freedom from the lowest frequencies */
} imk_screen;

/** Bytes of workspace for n samples (8 n and 64 kB). */
IMK_API size_t imk_screen_workspace_size(size_t n);

/** Search one channel for faults.
 *  @param samples  on an even grid, NaN (or infinite) where missing; not changed
 *  @return IMK_ERROR_UNINITIALISED, IMK_ERROR_RANGE (settings), IMK_ERROR_TOO_SHORT (fewer than 64
 *          finite samples), IMK_ERROR_CONSTANT, IMK_ERROR_WORKSPACE */
IMK_API imk_status imk_screen_channel(const imk_screen_settings *settings, size_t n,
                                      const double *samples, imk_screen *found, void *workspace,
                                      size_t workspace_size, imk_error *error);

/** Faults that imk_screen_apply() can take out. */
enum {
    IMK_SCREEN_OUTLIERS = 1 << 0,
    IMK_SCREEN_STUCK = 1 << 1,
    IMK_SCREEN_SATURATED = 1 << 2,
    IMK_SCREEN_WARM_UP = 1 << 3,
    IMK_SCREEN_TEMPERATURE = 1 << 4,
    IMK_SCREEN_ALL = (1 << 5) - 1
};

/** Take out faults in place: outliers, stuck and saturated samples become NaN; the warm-up and the
 *  dependence on temperature are subtracted (a sample without temperature becomes NaN).
 *  @param settings  as for imk_screen_channel()
 *  @param what      IMK_SCREEN_… bits
 *  @return number of samples that became NaN */
IMK_API size_t imk_screen_apply(const imk_screen_settings *settings, const imk_screen *found,
                                unsigned what, size_t n, double *samples);

IMK_END_C
#endif
