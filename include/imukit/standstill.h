/* SPDX-License-Identifier: Apache-2.0 */
/** @file standstill.h
 *  Detector of the times at which a unit is stationary, from the readings of its gyros and
 *  accelerometers. Theory: docs/theory/navigation-filter.md. */
#ifndef IMUKIT_STANDSTILL_H
#define IMUKIT_STANDSTILL_H

#include "imukit/attitude.h"
#include "imukit/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

IMK_BEGIN_C

/** Mean readings of a stationary unit, biases included, body axes; and their 1 sigma, as root sum
 *  of squares of the axes. */
typedef struct imk_rest_readings {
    imk_vector3 rate, force; /**< [rad/s], [m/s^2] */
    double rate_sigma, force_sigma;
} imk_rest_readings;

enum { IMK_STANDSTILL_FIGURES = 4 };

/** Detects whether the unit is stationary or moves, by four figures of each window of samples: the
 *  scatter of the force, the scatter of the rate, and the distances of the mean force and rate from
 *  those of a stationary unit. Their values at rest, with usual disturbances, are learnt while the
 *  unit is known to be stationary. Steady motion on a straight line shows only by its vibration;
 *  the filter's test of the innovation is a second safeguard. Plain data. */
typedef struct imk_standstill {
    double window;      /**< length of a window [s] */
    double false_alarm; /**< probability that a window at rest is taken for motion */
    uint64_t learnt;    /**< number of windows learnt */
    double sum[IMK_STANDSTILL_FIGURES], square_sum[IMK_STANDSTILL_FIGURES];
    double limit[IMK_STANDSTILL_FIGURES]; /**< set by imk_standstill_ready() */
    imk_vector3 turn_sum, speed_sum;      /**< of all windows */
    double time_sum;
    /** The present window: */
    size_t count;
    double time;
    imk_vector3 turn, speed; /**< sums of the increments */
    imk_vector3 first_rate, first_force, rate_off, force_off;
    double rate_square[3], force_square[3]; /**< about the first sample */
} imk_standstill;

/** Start a detector.
 *  @param window       length of a window [s], > 0, at least four samples; 1 s is usual
 *  @param false_alarm  probability that a window at rest is taken for motion, 0 < … < 1 */
IMK_API imk_standstill imk_standstill_start(double window, double false_alarm);
/** Learn from one sample while the unit is known to be stationary. */
IMK_API void imk_standstill_learn(imk_standstill *detector, double dt, imk_vector3 angle,
                                  imk_vector3 velocity);
/** End the learning. Each figure is modelled as a multiple of a chi-square variable with the mean
 *  and variance found; its limit is the quantile of that.
 *  @return IMK_ERROR_TOO_SHORT (fewer than 10 windows) */
IMK_API imk_status imk_standstill_ready(imk_standstill *detector, imk_error *error);

typedef enum imk_standstill_verdict {
    IMK_STANDSTILL_UNDECIDED = 0, /**< the window is not full yet */
    IMK_STANDSTILL_MOVES,
    IMK_STANDSTILL_STANDS
} imk_standstill_verdict;
/** Take one sample; the verdict comes when a window is full.
 *  @param rest  such as from imk_navigation_filter_rest(), used when the window is full. Four times
 *               its sigmas are added to the limits of the two distances */
IMK_API imk_standstill_verdict imk_standstill_add(imk_standstill *detector, double dt,
                                                  imk_vector3 angle, imk_vector3 velocity,
                                                  const imk_rest_readings *rest);

IMK_END_C
#endif
