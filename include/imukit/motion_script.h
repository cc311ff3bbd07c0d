/* SPDX-License-Identifier: Apache-2.0 */
/** @file motion_script.h
 *  Motion in the words people use, accelerate, turn, climb, hold, rotate, pose, compiled into the
 *  pieces of a trajectory.
 *
 *  The body moves like a vehicle: it has a speed along its path, a heading and a climb angle, and
 *  its attitude is yaw = heading, pitch = climb angle, roll = bank, turned further by the mounting
 *  and by the steps that turn the body only (rotate, pose, coning, swing). Every rate and
 *  acceleration builds up and dies away over the smoothing time by S(x) = 10 x^3 - 15 x^4 + 6 x^5,
 *  so that the angular acceleration and the jerk are continuous; the stated angle, speed or length
 *  of a step is reached exactly (when it is too small for the stated rate, the rate is lower; the
 *  smoothing time stays).
 *
 *  Speed, heading and climb angle are those in the north-east-down axes of wherever the body is: on
 *  a constant heading it follows a rhumb line, and level means at constant height.
 *
 *  The pieces depart from that by at most about 1e-9 rad/s + 1e-10 of the rate and 1e-7 m/s^2
 *  (within two degrees of a pole a few times that), and they are the truth: position, velocity and
 *  attitude are exactly what the pieces' rates and forces integrate to. A ramp takes about 15 to 40
 *  pieces, a steady turn or spin one every 0.2 rad, travel one every 10 s, a swing or coning 20
 *  to 80 a cycle, rest a single one. Compiling takes about 5 us a piece, as long as counting.
 *
 *  Method: docs/theory/motion.md. Only + - * / sqrt and elementary.h: the same bits everywhere. */
#ifndef IMUKIT_MOTION_SCRIPT_H
#define IMUKIT_MOTION_SCRIPT_H

#include "imukit/motion.h"

IMK_BEGIN_C

/** What a step does. All angles in [rad], rates in [rad/s]. Amounts may be negative. */
typedef enum imk_step_kind {
    IMK_STEP_HOLD,       /**< go on as it is: duration */
    IMK_STEP_ACCELERATE, /**< amount: change of speed [m/s], down to rest at most; rate:
                              acceleration [m/s^2] > 0. At rest the body stops to the last bit */
    IMK_STEP_TURN,       /**< amount: change of heading, + is to the right; rate > 0. At rest it
                              turns on the spot */
    IMK_STEP_CLIMB,      /**< amount: change of the climb angle, + is up; rate > 0. Past 90 deg it
                              is a loop */
    IMK_STEP_ROTATE,     /**< about body axis `axis`: amount, rate > 0: a rate table; many turns are
                              a steady spin */
    IMK_STEP_POSE,       /**< turn the body to angle[] = roll, pitch, yaw relative to
                              north-east-down, about one axis, in `duration`, the angle going by S
                              (peak rate: 15/8 of the mean) */
    IMK_STEP_SWING,      /**< amount sin(2 pi frequency t) about body axis `axis` for `duration`, at
                              least two cycles; grows and dies away by S over whole cycles, as many
                              as the smoothing time takes and at least one; within `duration` */
    IMK_STEP_CONING,     /**< the body axis `axis` describes a cone of half angle `amount` at
                              `frequency` for `duration`; grows and dies away likewise. The body
                              does not go round with it: mean rate about the axis
                              -2 (2 pi frequency) sin^2(amount/2) */
} imk_step_kind;

/** A step; fields that its kind does not name are ignored. */
typedef struct imk_motion_step {
    imk_step_kind kind;
    int axis;         /**< 0 x, 1 y, 2 z, of the body */
    double amount;    /**< speeds up to 1e5 m/s, angles to 1e6 rad, of swing and coning to pi */
    double rate;      /**< > 0, up to 1e6 */
    double duration;  /**< [s], 1e-6 … 1e9 */
    double frequency; /**< [Hz], > 0, up to 1e6 */
    double angle[3];  /**< roll, pitch, yaw [rad] */
    bool banked;      /**< a turn leans into the curve: roll = atan(v heading rate/g), rolling in
                           and out within the ramps: give it a smoothing time to do so */
} imk_motion_step;

/** Start from imk_motion_script_default(), then change fields. */
typedef struct imk_motion_script {
    uint32_t cookie;
    bool earth;         /**< default true; without Earth north, east and down are fixed axes */
    imk_geodetic place; /**< default 45 deg north, sea level; latitude within 89.9 deg while
                             the body travels */
    double heading, climb, speed; /**< at the start [rad], [rad], [m/s]; climb within 90 deg, speed
                                       >= 0 */
    double mounting[3];           /**< roll, pitch, yaw of the body in the vehicle [rad] */
    double smoothing;             /**< [s], 1e-3 … 1e3; default 0.5 */
    size_t step_count;
    const imk_motion_step *step; /**< the caller's */
} imk_motion_script;
/** At rest, level, heading north, without steps. */
IMK_API imk_motion_script imk_motion_script_default(void);

/** More pieces than this are refused (they would take 3.8 GB). */
enum { IMK_MOTION_PIECES_MAX = 10000000 };

/** Length of step `index` [s], smoothing included: of a change by `amount` at `rate`, |amount|/rate
 * + smoothing, at least twice the smoothing time. 0 for a step that there is not. */
IMK_API double imk_motion_step_duration(const imk_motion_script *script, size_t index);

/** Pieces the script compiles into; 0 for a script that is not valid (error says why: field
 *  "step.rate" or the like, index the step). Takes as long as compiling.
 *  @return IMK_OK, IMK_ERROR_UNINITIALISED, _RANGE, _NOT_FINITE, _TOO_SHORT (no step) */
IMK_API imk_status imk_motion_script_pieces(const imk_motion_script *script, size_t *piece_count,
                                            imk_error *error);

/** Compile. A body at rest after the last step stays there: the last piece is endless. One that is
 *  still moving has a trajectory that ends with its last step.
 *  @param piece       imk_motion_script_pieces() of them, which the trajectory points to; not
 *                     meaningful after an error
 *  @param trajectory  without vibration; untouched on error
 *  @return as imk_motion_script_pieces(), and IMK_ERROR_WORKSPACE (too few pieces) */
IMK_API imk_status imk_motion_script_compile(const imk_motion_script *script,
                                             imk_trajectory_piece *piece, size_t piece_count,
                                             imk_trajectory *trajectory, imk_error *error);

IMK_END_C
#endif
