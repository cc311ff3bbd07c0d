/* SPDX-License-Identifier: Apache-2.0 */
/** @file record_screen.h
 *  What is wrong with one channel of a static record before any noise model, and taking it out:
 *  missing, repeated, stuck, saturated and outlying samples, steps in the level, the warm-up, and
 *  what follows the temperature (docs/records-with-faults.md, docs/theory/gaps.md). */
#ifndef IMUKIT_RECORD_SCREEN_H
#define IMUKIT_RECORD_SCREEN_H

#include "imukit/status.h"

#include <stdbool.h>

IMK_BEGIN_C

/** Samples of one kind. */
typedef struct imk_screen_count {
    size_t count; /**< samples */
    size_t runs;  /**< stretches of them */
    size_t first; /**< index of the first sample; n when there is none */
} imk_screen_count;

/** How to look. Start from imk_screen_default(), then change fields. */
typedef struct imk_screen_settings {
    uint32_t cookie;
    double dt;           /**< sample interval [s]; must be set */
    double false_alarm;  /**< chance that a sound record of Gaussian noise shows an outlier; 1e-3 */
    double significance; /**< false-alarm rate of warm-up, temperature slope and steps, each;
                            default 0.001 */
    const double *temperature; /**< n values [K or degC], NaN where missing; NULL: none */
} imk_screen_settings;

/** 1e-3 false alarms, no temperature; dt must be set. */
IMK_API imk_screen_settings imk_screen_default(void);

/** What was found on one channel. Values in the channel's unit. */
typedef struct imk_screen {
    size_t n, present;        /**< samples; those that are finite */
    imk_screen_count missing; /**< not finite; runs are holes */
    size_t longest_hole;      /**< samples */

    imk_screen_count outliers;  /**< far from the level around them */
    double outlier_threshold;   /**< distance from the level at which a sample is one */
    double largest_outlier;     /**< largest distance */
    imk_screen_count stuck;     /**< runs of one value longer than the noise allows, but the first
                                     sample of each */
    size_t longest_stuck;       /**< samples in the longest run */
    size_t stuck_limit;         /**< samples in a row that the noise allows */
    imk_screen_count saturated; /**< at an extreme value where samples pile up */
    double saturation_low, saturation_high; /**< that value; infinite where there is none */
    double repeated;                        /**< share of samples equal to the one before */
    double resolution; /**< smallest step between values, 0 when none is seen */
    double deviation;  /**< of the samples about their mean */
    double noise;      /**< standard deviation about the level around, by the median */

    imk_screen_count steps; /**< sudden lasting changes of the level; first: index of the largest */
    double largest_step;

    /** Mean = level + warm_up_amplitude exp(-t/warm_up_time) */
    bool warm_up;
    double warm_up_amplitude, warm_up_amplitude_sigma; /**< at t = 0 */
    double warm_up_time, warm_up_time_sigma;           /**< [s] */
    double warm_up_probability; /**< that slow noise alone looks so, 0 … 1 */

    /** Mean = level + slope (T - reference) + curvature (T - reference)^2 */
    int temperature_degree;       /**< 0: does not follow the temperature; 1, 2 */
    double temperature_reference; /**< mean temperature */
    double temperature_slope, temperature_slope_sigma;         /**< [unit/K] */
    double temperature_curvature, temperature_curvature_sigma; /**< [unit/K^2] */
    double temperature_probability;

    int degrees_taken; /**< parameters fitted to the mean: what the lowest frequencies lose */
} imk_screen;

/** Bytes of workspace for n samples (8 n and 64 kB). */
IMK_API size_t imk_screen_workspace_size(size_t n);

/** Look at one channel.
 *  @param samples  on an even grid, NaN (or infinite) where missing; not changed
 *  @return IMK_ERROR_UNINITIALISED, IMK_ERROR_RANGE (settings), IMK_ERROR_TOO_SHORT (fewer than 64
 *          samples are there), IMK_ERROR_CONSTANT, IMK_ERROR_WORKSPACE */
IMK_API imk_status imk_screen_channel(const imk_screen_settings *settings, size_t n,
                                      const double *samples, imk_screen *found, void *workspace,
                                      size_t workspace_size, imk_error *error);

/** What of it to take out. */
enum {
    IMK_SCREEN_OUTLIERS = 1 << 0,
    IMK_SCREEN_STUCK = 1 << 1,
    IMK_SCREEN_SATURATED = 1 << 2,
    IMK_SCREEN_WARM_UP = 1 << 3,
    IMK_SCREEN_TEMPERATURE = 1 << 4,
    IMK_SCREEN_ALL = (1 << 5) - 1
};

/** Take out what was found, in place: outliers, stuck and saturated samples become NaN; the warm-up
 *  and what follows the temperature are subtracted (a sample without temperature becomes NaN).
 *  @param settings  as of imk_screen_channel()
 *  @param what      IMK_SCREEN_… bits
 *  @return samples that became NaN */
IMK_API size_t imk_screen_apply(const imk_screen_settings *settings, const imk_screen *found,
                                unsigned what, size_t n, double *samples);

IMK_END_C
#endif
