/* SPDX-License-Identifier: Apache-2.0 */
/** @file static_detection.h
 *  Detection of the times at rest in a log, by a threshold that follows from the log's own noise.
 *
 *  The scatter within short windows is compared with that of the quietest part of the log, on every
 *  axis; the threshold is the quantile of its distribution for a stated rate of false alarms, with
 *  the effective number of independent samples, so coloured and quantized noise do not shift it.
 *  Gyros with a steady rate count as turning. But a change of the force since the rest before may
 *  change the rate by a g-sensitivity of 3e-4 rad/s/(m/s^2): MEMS gyros have 0.1 deg/s/g (1.8e-4
 *  rad/s/(m/s^2)) and more, and would otherwise seem to turn on every other face. This needs the
 *  unit of the gyros' readings; it is not done for counts without a sensitivity. The threshold, the
 *  share of the log at rest, and the reasons why stretches were left out are reported. Method:
 *  docs/theory/calibration.md. */
#ifndef IMUKIT_STATIC_DETECTION_H
#define IMUKIT_STATIC_DETECTION_H

#include "imukit/test_record.h"

IMK_BEGIN_C

/** Settings of the detection. Start from imk_static_default(), then change fields. */
typedef struct imk_static_settings {
    uint32_t cookie;
    double window;      /**< length of a window [s]; 0 (default): chosen from the log */
    double false_alarm; /**< probability that a window at rest is called moving; default 1e-4 */
    double minimum;     /**< shortest interval that counts [s]; default 1 */
    double guard; /**< time left out at both ends of an interval [s]; -1 (default): one window */
    double initial_rest; /**< length of a rest at the start of the log, from which the noise is
                            learnt [s]; 0 (default): the quietest part of the log is used */
} imk_static_settings;
/** The defaults stated above. */
IMK_API imk_static_settings imk_static_default(void);

/** One interval at rest. */
typedef struct imk_static_interval {
    size_t begin, end;               /**< samples begin … end - 1, without the guard */
    double mean[2][IMK_AXES_MAX];    /**< mean readings */
    double sigma[2][IMK_AXES_MAX];   /**< 1 sigma of the mean, from the scatter within, with
                                        correlation of neighbours */
    double scatter[2][IMK_AXES_MAX]; /**< standard deviation of a sample */
    /** Part of sigma: what the rounding of readings to steps leaves in the mean, 1 sigma, where
     * their noise does not carry them over the steps. */
    double rounding[2][IMK_AXES_MAX];
    double temperature;      /**< mean [K]; NaN: not known */
    double temperature_rate; /**< slope [K/s] */
    int section;             /**< section at its middle; -1: none */
} imk_static_interval;

/** Findings of the detection about the log. */
typedef struct imk_static_findings {
    double window;                     /**< length of the windows used [s] */
    size_t rest_begin, rest_end;       /**< samples from which the noise was learnt */
    double noise[2][IMK_AXES_MAX];     /**< their standard deviation [unit of the reading] */
    double effective[2][IMK_AXES_MAX]; /**< independent samples among those of a window */
    double threshold[2][IMK_AXES_MAX]; /**< threshold for the standard deviation within a window */
    double standing;                   /**< share of the log at rest [1] */
    /** Number of intervals, and of stretches shorter than `minimum`. */
    size_t intervals, too_short;
    size_t saturated, not_finite; /**< samples left out for these reasons */
    /** Smallest and largest ratio of a window's scatter to the threshold. If both are near 1 or
     *  both below 1, the unit never moves or is never at rest. */
    double quietest, loudest;
} imk_static_findings;

/** Bytes of workspace. */
IMK_API size_t imk_static_workspace_size(const imk_test_record *record,
                                         const imk_static_settings *settings);

/** Detect the intervals at rest. The time is linear in the length of the record.
 *  @param model     its ranges tell which readings are saturated; NULL: none
 *  @param interval  room for `capacity`
 *  @param count     number found, also beyond the capacity
 *  @param activity  record->count values or NULL: for each sample, scatter of the window around it
 *                   over the threshold, on the worst axis, for a plot
 *  @return IMK_ERROR_TOO_SHORT, _NOT_FINITE (no usable sample), _RANGE (settings), _WORKSPACE,
 *          _UNINITIALISED; no interval is no error: count is 0 */
IMK_API imk_status imk_static_detect(const imk_test_record *record,
                                     const imk_static_settings *settings, const imk_model *model,
                                     imk_static_interval *interval, size_t capacity, size_t *count,
                                     double *activity, imk_static_findings *findings,
                                     void *workspace, size_t workspace_size, imk_error *error);

/** Mean, sigma and scatter of any stretch of samples, as in an interval that was detected. */
IMK_API imk_static_interval imk_static_summary(const imk_test_record *record, size_t begin,
                                               size_t end);

/** Why a stretch between turns that looks like a rest is none. */
typedef enum imk_lost_reason {
    IMK_LOST_NOISY = 0, /**< the noise of an axis is `value` times that of the rests */
    IMK_LOST_SLIDES,    /**< the vertical moves by the angle `value` [rad] */
    IMK_LOST_SHORT,     /**< shorter than the settings' minimum */
    IMK_LOST_OTHER_RATE /**< the gyros read another rate than before */
} imk_lost_reason;

/** A stretch that looks like a rest, but is not among the intervals. */
typedef struct imk_static_lost {
    size_t begin, end; /**< samples begin … end - 1 */
    imk_lost_reason reason;
    int sensor, axis; /**< that is the noisiest */
    double value;
} imk_static_lost;

/** Find stretches between turns, at least half as long as the mean interval, in which the unit
 *  hardly moves and which the detection did not take. It needs three gyros and three accelerometers
 *  whose units are known.
 *  @param interval  found by imk_static_detect() with these settings
 *  @param lost      room for `capacity`
 *  @return their number, also beyond the capacity */
IMK_API size_t imk_static_lost_rests(const imk_test_record *record,
                                     const imk_static_settings *settings, const imk_model *model,
                                     const imk_static_findings *findings, size_t interval_count,
                                     const imk_static_interval *interval, size_t capacity,
                                     imk_static_lost *lost);

IMK_END_C
#endif
