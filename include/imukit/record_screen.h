/* SPDX-License-Identifier: Apache-2.0 */
/** @file record_screen.h
 *  Faults of one channel of a static record, found and removed before a noise model is fitted:
 *  missing, repeated, stuck, saturated and outlying samples, steps in the level, warm-up, and
 *  dependence on temperature (docs/records-with-faults.md, docs/theory/gaps.md). */
#ifndef IMUKIT_RECORD_SCREEN_H
#define IMUKIT_RECORD_SCREEN_H

#include "imukit/identify.h"
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
    double dt;                 /**< sample interval [s]; must be set */
    double false_alarm;        /**< chance that an outlier is found in 1e9 samples of Gaussian noise
                                  without faults; default 1e-3 */
    double significance;       /**< false-alarm rate of warm-up, temperature slope and steps, each;
                                  default 0.001 */
    const double *temperature; /**< n values [K or degC], NaN where missing; NULL: none */
} imk_screen_settings;

/** The defaults stated above, no temperature; dt must be set. */
IMK_API imk_screen_settings imk_screen_default(void);

/** Places in the list of steps. */
enum { IMK_SCREEN_STEPS = 16, IMK_SCREEN_MOVES = 16 };

/** Result for one channel. Values are in the channel's unit. */
typedef struct imk_screen {
    size_t n, present;        /**< number of samples, and of finite samples */
    imk_screen_count missing; /**< samples that are not finite; `runs` counts the gaps */
    size_t longest_hole;      /**< samples */

    imk_screen_count outliers; /**< far from the level around them */
    double outlier_threshold;  /**< distance from the level from which a sample is an outlier, on
                                  average over the record: it follows the noise */
    double largest_outlier;    /**< largest distance of an outlier from the level */
    /** More than 0.5 % of the samples are outliers, or many are nearly outliers: the tails of the
     *  noise itself, which imk_screen_apply() leaves in. */
    bool heavy_tails;
    bool clustered; /**< eight times as many samples are beyond 5 standard deviations of most as
                       from 3.5 to 5, as faults are and tails that go on evenly are not */
    double core; /**< standard deviation within 32 samples by the median, which tails do not move,
                    over that by the mean square; 1 for normal noise */
    double noise_scatter;  /**< relative standard deviation of the variance within 32 samples over
                              the record, by its scatter between batches, without
                            outliers that are none of the noise; 0: too short */
    imk_screen_count lost; /**< zeros, or another value that comes again and again, outside the
                              noise, as loggers write them for lost rows; taken out with the stuck
                              samples, but none of them */
    double lost_value;     /**< this value, the last one found */
    double zeros;  /**< share of the samples by which zeros among the noise are more than their
                      neighbours tell: small values were put to zero, or all were cut off toward it;
                      0: they are not */
    double filled; /**< share of the samples by which one value is more frequent than those beside
                      it tell, as where a mean is written for missing samples; 0: none is */
    double filled_value; /**< this value */
    double held;         /**< share of samples that repeat the one before beyond those that noise
                            repeats by chance; 0: none */
    double straight;     /**< the same of samples that are the mean of their neighbours */
    double gap; /**< widest gap among the values, as a stuck bit of the converter leaves it; 0: none
                   of more than a third of the noise */
    bool uneven; /**< frequent values are at uneven distances, or unevenly frequent, as where the
                    output is rounded twice; this changes the distribution of the noise */
    imk_screen_count stuck; /**< samples in runs of one value that are longer than the noise allows,
                               without the first sample of each run */
    size_t longest_stuck;   /**< samples in the longest run */
    size_t stuck_limit;     /**< longest run of one value that the noise allows [samples] */
    imk_screen_count saturated; /**< samples at an extreme value that occurs too often */
    /** These extreme values; infinite where there is none. */
    double saturation_low, saturation_high;
    double clipped_deviation; /**< standard deviation of normal noise over that of the samples with
                                 everything beyond these values put onto them; 1: none is */
    double clipped_gain;   /**< how far a slow change, smaller than the noise, shows: the share of
                              samples between these values */
    double clipped_misfit; /**< relative difference of the deviation from that of such noise */
    /** The values end abruptly at `end_low` or `end_high`: more of them are near it than noise
     *  has, but not on it. Where the noise is not white, tones and resonances do so too. */
    bool ends_low, ends_high;
    double end_low, end_high;
    bool interpolated; /**< the noise is stronger and weaker in a cycle of some samples, as between
                          the samples of a slower sensor */
    double sensor_rate[2]; /**< its rate over that of the log, 0 if the noise alternates from row to
                              row; the second is 0, or another one if coarse steps hide which it is
                            */
    double repeated;       /**< share of samples equal to the one before */
    double resolution;     /**< smallest step between values; 0 when none is detected */
    double deviation;      /**< of the samples about their mean */
    double noise;          /**< standard deviation within 32 samples, by the median range */

    imk_screen_count steps; /**< sudden lasting changes of the level, at most IMK_SCREEN_STEPS;
                               first: index of the largest */
    double largest_step;
    size_t step_place[IMK_SCREEN_STEPS]; /**< index of the first sample behind each, to 1/1024 of
                                            the record */
    double step_size[IMK_SCREEN_STEPS];
    double possible_step; /**< the likeliest further change of the level, which is not significant;
                             0: none is worth a look */
    size_t possible_step_place;
    double possible_step_square; /**< its size over its standard deviation, squared */

    imk_screen_count moved; /**< samples in stretches in which the sensor was moved; then steps,
                               warm-up and temperature are not looked for */
    /** These stretches, moved.runs of them: samples first … end - 1. The IMK_SCREEN_MOVES-th
     *  holds the rest of the record. */
    size_t move_first[IMK_SCREEN_MOVES], move_end[IMK_SCREEN_MOVES];

    double cycle_amplitude; /**< of a level that goes up and down regularly; 0: it does not */
    double cycle_period;    /**< [s] */

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

/** Bytes of workspace for a record of any length: 0.6 MB. */
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

/** Take out faults in place: outliers (but not heavy tails), stuck and saturated samples become
 *  NaN; the warm-up and the dependence on temperature are subtracted (a sample without temperature
 *  becomes NaN). White noise without its saturated samples is underestimated: leave them in and use
 *  imk_screen_adjust() instead.
 *  @param settings  as for imk_screen_channel()
 *  @param what      IMK_SCREEN_… bits
 *  @param lost      set to the number of samples that became NaN
 *  @return IMK_ERROR_UNINITIALISED, IMK_ERROR_RANGE, IMK_ERROR_WORKSPACE */
IMK_API imk_status imk_screen_apply(const imk_screen_settings *settings, const imk_screen *found,
                                    unsigned what, size_t n, double *samples, size_t *lost,
                                    void *workspace, size_t workspace_size, imk_error *error);

/** Screening of a record that passes by, in constant memory. imk_screen_channel() does the same
 *  with a record in memory, and finds the same. */
typedef struct imk_screener imk_screener;

/** Receives samples of the record in order, some thousand after they were added.
 *  @param loose  `count` samples, without stuck ones if these are to be taken out
 *  @param clean  also without outliers if these are to be taken out; may be `loose` */
typedef void (*imk_screen_sink)(void *context, size_t count, const double *loose,
                                const double *clean);

/** Bytes of memory for a screener: 0.6 MB. */
IMK_API size_t imk_screener_size(void);
/** Start a screening in `memory`.
 *  @param what  IMK_SCREEN_OUTLIERS and IMK_SCREEN_STUCK: what the sink does not get; others are
 *               ignored
 *  @param sink  NULL: none
 *  @return errors of imk_screen_channel() about settings and memory */
IMK_API imk_status imk_screener_begin(const imk_screen_settings *settings, unsigned what,
                                      imk_screen_sink sink, void *context, imk_screener **screener,
                                      void *memory, size_t memory_size, imk_error *error);
/** Add samples in order, in blocks of any size: the result does not depend on how the record is
 *  divided.
 *  @param temperature  of each sample, NaN where missing; NULL: none. settings.temperature is not
 *                      used */
IMK_API void imk_screener_add(imk_screener *screener, size_t count, const double *samples,
                              const double *temperature);
/** May the outliers so far be the tails of the noise? While false, imk_screen.heavy_tails would be
 *  false too. */
IMK_API bool imk_screener_suspects_tails(const imk_screener *screener);
/** Pass the last samples to the sink and state what was found; may be called once.
 *  @return IMK_ERROR_TOO_SHORT, IMK_ERROR_CONSTANT */
IMK_API imk_status imk_screener_finish(imk_screener *screener, imk_screen *found, imk_error *error);
/** Warm-up and effect of the temperature at a time [s] from the first sample, after
 *  imk_screener_finish().
 *  @param what  IMK_SCREEN_WARM_UP, IMK_SCREEN_TEMPERATURE: parts to add up */
IMK_API double imk_screener_trend(const imk_screener *screener, unsigned what, double time);

/** Allow for what screening leaves in. Clipped noise: values and intervals are those of the noise
 *  before it was clipped, and wider. Heavy tails: the interval of white noise is as wide as the
 *  scatter of the noise between batches says.
 *  @param what        IMK_SCREEN_SATURATED: correct clipped noise
 *  @param confidence  of the intervals */
IMK_API void imk_screen_adjust(const imk_screen *found, unsigned what, double confidence,
                               imk_identification *result);

IMK_END_C
#endif
