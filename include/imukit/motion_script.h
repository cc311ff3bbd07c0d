/* SPDX-License-Identifier: Apache-2.0 */
/** @file motion_script.h
 *  Motion in the words people use, accelerate, turn, climb, hold, rotate, pose, compiled into the
 *  pieces of a trajectory.
 *
 *  The body moves like a vehicle: it has a speed along its path, a heading and a climb angle, and
 *  its attitude is yaw = heading, pitch = climb angle, roll = bank, turned further by the steps
 * that turn the body only (rotate, pose, coning, swing). Every rate and acceleration builds up and
 * dies away over the smoothing time by S(x) = 10 x^3 - 15 x^4 + 6 x^5, so that the angular
 * acceleration and the jerk are continuous; the stated angle, speed or length of a step is reached
 * exactly (when it is too small for the stated rate, the rate is lower; the smoothing time stays).
 */
#ifndef IMUKIT_MOTION_SCRIPT_H
#define IMUKIT_MOTION_SCRIPT_H

#include "imukit/motion.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum imk_step_kind {
    IMK_STEP_HOLD,       /**< go on as it is: duration */
    IMK_STEP_ACCELERATE, /**< amount: change of speed [m/s], rate: acceleration [m/s^2] > 0 */
    IMK_STEP_TURN,   /**< amount: change of heading [rad], + is to the right; rate [rad/s] > 0 */
    IMK_STEP_CLIMB,  /**< amount: change of the climb angle [rad], + is up; rate [rad/s] */
    IMK_STEP_ROTATE, /**< about body axis `axis`: amount [rad], rate [rad/s]: a rate table */
    IMK_STEP_POSE,   /**< turn the body to angle[] = roll, pitch, yaw relative to
                          north-east-down, about one axis, in `duration` */
    IMK_STEP_SWING,  /**< amount sin(2 pi frequency t) about body axis `axis` for `duration`;
                          grows and dies away over whole cycles */
    IMK_STEP_CONING, /**< the body axis `axis` describes a cone of half angle `amount` at
                          `frequency` for `duration`; grows and dies away likewise */
} imk_step_kind;

typedef struct imk_motion_step {
    imk_step_kind kind;
    int axis; /**< 0 x, 1 y, 2 z */
    double amount, rate, duration, frequency;
    double angle[3];
    bool banked; /**< a turn leans into the curve: roll = atan(v heading rate/g) */
} imk_motion_step;

/** Start from imk_motion_script_default(), then change fields. */
typedef struct imk_motion_script {
    uint32_t cookie;
    bool earth;         /**< default true */
    imk_geodetic place; /**< default 45 deg north, sea level; latitude within 89.9 deg when
                             the body travels */
    double heading, climb, speed; /**< at the start [rad], [rad], [m/s] */
    double mounting[3];           /**< roll, pitch, yaw of the body in the vehicle [rad] */
    double smoothing;             /**< [s], 1e-3 … 1e3; default 0.5 */
    size_t step_count;
    const imk_motion_step *step;
} imk_motion_script;
IMK_API imk_motion_script imk_motion_script_default(void);

/** Length of step `index` [s], smoothing included. */
IMK_API double imk_motion_step_duration(const imk_motion_script *script, size_t index);

/** Pieces the script compiles into; 0 for a script that is not valid (error says why: index is the
 *  step). @return IMK_OK, IMK_ERROR_UNINITIALISED, _RANGE, _NOT_FINITE, _TOO_SHORT (no step) */
IMK_API imk_status imk_motion_script_pieces(const imk_motion_script *script, size_t *piece_count,
                                            imk_error *error);

/** Compile. After the last step the body goes on as it is (endless when it is at rest).
 *  @param piece  imk_motion_script_pieces() of them, which the trajectory points to */
IMK_API imk_status imk_motion_script_compile(const imk_motion_script *script,
                                             imk_trajectory_piece *piece, size_t piece_count,
                                             imk_trajectory *trajectory, imk_error *error);

#ifdef __cplusplus
}
#endif
#endif
