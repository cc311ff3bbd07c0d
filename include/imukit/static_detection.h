/* SPDX-License-Identifier: Apache-2.0 */
/** @file static_detection.h
 *  Where a unit stands still in a log, by a threshold that follows from the log's own noise.
 *
 *  The scatter within short windows is compared with that of the quietest part of the log, on every
 *  axis; the threshold is the quantile of its distribution for a stated rate of false alarms, with
 *  the effective number of independent samples, so that coloured and quantized noise do not move
 *  it. Gyros that read a steady rate turn, but for what a g-sensitivity of 3e-4 rad/s/(m/s^2) makes
 *  of the change of the force since the rest before: MEMS gyros have 0.1 deg/s/g and more, 1.8e-4
 *  rad/s/(m/s^2), and would otherwise seem to turn on every other face. That takes the unit of the
 *  gyros' readings; of counts without a sensitivity nothing is allowed for. What the threshold is,
 *  what share of the log stands, and why a stretch was left out is all reported: nothing fails
 *  silently. Method: docs/theory/calibration.md. */
#ifndef IMUKIT_STATIC_DETECTION_H
#define IMUKIT_STATIC_DETECTION_H

#include "imukit/test_record.h"

IMK_BEGIN_C

/** How to detect. Start from imk_static_default(), then change fields. */
typedef struct imk_static_settings {
    uint32_t cookie;
    double window;       /**< [s]; 0 (default): chosen from the log */
    double false_alarm;  /**< probability that a standing window is called moving; 1e-4 */
    double minimum;      /**< shortest interval that counts [s]; default 1 */
    double guard;        /**< left out at both ends of an interval [s]; -1 (default): a window */
    double initial_rest; /**< the log begins with so long a rest, from which the noise is learnt
                              [s]; 0 (default): the quietest part is searched for */
} imk_static_settings;
/** The values named above. */
IMK_API imk_static_settings imk_static_default(void);

/** One stretch of standing still. */
typedef struct imk_static_interval {
    size_t begin, end;               /**< samples begin … end - 1, guard left out */
    double mean[2][IMK_AXES_MAX];    /**< of the readings */
    double sigma[2][IMK_AXES_MAX];   /**< of the mean, from the scatter within, correlation of
                                          neighbours taken into account */
    double scatter[2][IMK_AXES_MAX]; /**< standard deviation of a sample */
    double temperature;              /**< mean [K]; NaN: not known */
    double temperature_rate;         /**< slope [K/s] */
    int section;                     /**< of its middle; -1: none */
} imk_static_interval;

/** What the detection found out about the log. */
typedef struct imk_static_findings {
    double window;                     /**< used [s] */
    size_t rest_begin, rest_end;       /**< samples the noise was learnt from */
    double noise[2][IMK_AXES_MAX];     /**< their standard deviation [unit of the reading] */
    double effective[2][IMK_AXES_MAX]; /**< independent samples among those of a window */
    double threshold[2][IMK_AXES_MAX]; /**< on the standard deviation within a window */
    double standing;                   /**< share of the log [1] */
    size_t intervals, too_short;  /**< stretches that count, and that were shorter than minimum */
    size_t saturated, not_finite; /**< samples left out for it */
    double quietest, loudest;     /**< smallest and largest ratio of a window's scatter to the
                                       threshold: both near 1 or both below it: nothing moves, or
                                       nothing stands */
} imk_static_findings;

/** Bytes of workspace. */
IMK_API size_t imk_static_workspace_size(const imk_test_record *record,
                                         const imk_static_settings *settings);

/** Detect. Linear in the length of the record.
 *  @param model      whose ranges tell saturation; NULL: none
 *  @param interval   room for `capacity`
 *  @param count      how many there are, also beyond the capacity
 *  @param activity   record->count values or NULL: scatter of the window around each sample over
 *                    its threshold, the worst axis: for a plot
 *  @return IMK_ERROR_TOO_SHORT, _NOT_FINITE (no usable sample), _RANGE (settings), _WORKSPACE,
 *          _UNINITIALISED; none standing is no error here: count is 0 */
IMK_API imk_status imk_static_detect(const imk_test_record *record,
                                     const imk_static_settings *settings, const imk_model *model,
                                     imk_static_interval *interval, size_t capacity, size_t *count,
                                     double *activity, imk_static_findings *findings,
                                     void *workspace, size_t workspace_size, imk_error *error);

/** Mean, sigma and scatter of any stretch of samples, as in an interval that was detected. */
IMK_API imk_static_interval imk_static_summary(const imk_test_record *record, size_t begin,
                                               size_t end);

IMK_END_C
#endif
