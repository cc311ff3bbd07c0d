/* SPDX-License-Identifier: Apache-2.0 */
/** @file motion_script.h
 *  Motion as a script of steps (accelerate, turn, climb, hold, rotate, pose …), compiled into the
 *  pieces of a trajectory.
 *
 *  The body moves like a vehicle, with a speed along its path, a heading and a climb angle. Its
 *  attitude is yaw = heading, pitch = climb angle, roll = bank, then turned by the mounting and by
 *  steps that turn only the body (rotate, pose, coning, swing). Every rate and acceleration rises
 *  and falls over the smoothing time by S(x) = 10 x^3 - 15 x^4 + 6 x^5, so the angular acceleration
 *  and the jerk are continuous. The stated angle, speed or length of a step is reached exactly (if
 *  it is too small for the stated rate, the rate is lower; the smoothing time is kept).
 *
 *  Speed, heading and climb angle refer to the north-east-down axes at the present place of the
 *  body: on a constant heading it follows a rhumb line, and level motion keeps the height constant.
 *
 *  The pieces deviate from this motion by at most about 1e-9 rad/s + 1e-10 of the rate and 1e-7
 *  m/s^2 (a few times more within two degrees of a pole). The pieces are the truth: position,
 *  velocity and attitude are exactly the integrals of their rates and forces. A ramp takes about 15
 *  to 40 pieces, a steady turn or spin one every 0.2 rad, travel one every 10 s, a swing or coning
 *  20 to 80 a cycle, rest a single one. Compiling takes about 5 us a piece, and so does counting
 *  the pieces.
 *
 *  Method: docs/theory/motion.md. Only + - * / sqrt and elementary.h are used, so the bits are the
 *  same everywhere. */
#ifndef IMUKIT_MOTION_SCRIPT_H
#define IMUKIT_MOTION_SCRIPT_H

#include "imukit/motion.h"

IMK_BEGIN_C

/** Kinds of steps, with the fields that each uses. Angles are in [rad], rates in [rad/s]. Amounts
 *  may be negative. */
typedef enum imk_step_kind {
    IMK_STEP_HOLD,       /**< continue unchanged: duration */
    IMK_STEP_ACCELERATE, /**< amount: change of speed [m/s], at most down to rest; rate:
                            acceleration [m/s^2] > 0. After braking to rest the speed is exactly 0
                          */
    IMK_STEP_TURN,  /**< amount: change of heading, + is to the right; rate > 0. At rest the body
                       turns on the spot */
    IMK_STEP_CLIMB, /**< amount: change of the climb angle, + is up; rate > 0. More than 90 deg make
                       a loop */
    IMK_STEP_ROTATE, /**< turn about body axis `axis`, as on a rate table: amount, rate > 0; many
                        turns are a steady spin */
    IMK_STEP_POSE,   /**< turn the body to angle[] = roll, pitch, yaw relative to north-east-down,
                        about one axis, in `duration`; the angle follows S (peak rate: 15/8 of the
                        mean) */
    IMK_STEP_SWING,  /**< amount sin(2 pi frequency t) about body axis `axis` for `duration`, at
                        least two cycles. It rises and falls by S over whole cycles, as many as fill
                        the smoothing time and at least one, within `duration` */
    IMK_STEP_CONING, /**< the body axis `axis` describes a cone of half angle `amount` at
                        `frequency` for `duration`; it rises and falls as a swing. The body does not
                        turn about the cone's axis with it; the mean rate about the axis is -2 (2 pi
                        frequency) sin^2(amount/2) */
} imk_step_kind;

/** A step; fields that its kind does not name are ignored. */
typedef struct imk_motion_step {
    imk_step_kind kind;
    int axis;      /**< 0 x, 1 y, 2 z, of the body */
    double amount; /**< speeds up to 1e5 m/s, angles up to 1e6 rad, for swing and coning up to pi */
    double rate;   /**< > 0, up to 1e6 */
    double duration;  /**< [s], 1e-6 … 1e9 */
    double frequency; /**< [Hz], > 0, up to 1e6 */
    double angle[3];  /**< roll, pitch, yaw [rad] */
    bool banked; /**< true: the body banks in a turn, roll = atan(v heading rate/g). It rolls in and
                    out during the ramps, so choose a suitable smoothing time */
} imk_motion_step;

/** Start from imk_motion_script_default(), then change fields. */
typedef struct imk_motion_script {
    uint32_t cookie;
    bool earth; /**< default true; false: no Earth, and north, east and down are fixed axes */
    imk_geodetic place; /**< default 45 deg north, sea level; latitude within 89.9 deg while
                             the body travels */
    double heading, climb, speed; /**< at the start [rad], [rad], [m/s]; climb within 90 deg, speed
                                       >= 0 */
    double mounting[3];           /**< roll, pitch, yaw of the body in the vehicle [rad] */
    double smoothing;             /**< [s], 1e-3 … 1e3; default 0.5 */
    size_t step_count;
    const imk_motion_step *step; /**< steps; the array belongs to the caller */
} imk_motion_script;
/** At rest, level, heading north, without steps. */
IMK_API imk_motion_script imk_motion_script_default(void);

/** More pieces than this are refused (they would take 3.8 GB). */
enum { IMK_MOTION_PIECES_MAX = 10000000 };

/** Length of step `index` [s], smoothing included; 0 if there is no such step. For a change by
 *  `amount` at `rate` it is |amount|/rate + smoothing, and at least twice the smoothing time. */
IMK_API double imk_motion_step_duration(const imk_motion_script *script, size_t index);

/** Count the pieces of a script; 0 for a script that is not valid (the error's field is "step.rate"
 *  or similar, its index the step). Takes as long as compiling.
 *  @return IMK_OK, IMK_ERROR_UNINITIALISED, _RANGE, _NOT_FINITE, _TOO_SHORT (no step) */
IMK_API imk_status imk_motion_script_pieces(const imk_motion_script *script, size_t *piece_count,
                                            imk_error *error);

/** Compile a script. If the body is at rest after the last step, it stays there: the last piece is
 *  endless. If it still moves, the trajectory ends with the last step.
 *  @param piece       imk_motion_script_pieces() pieces, to which the trajectory points; undefined
 *                     after an error
 *  @param trajectory  without vibration; untouched on error
 *  @return errors of imk_motion_script_pieces(); IMK_ERROR_WORKSPACE (room for too few pieces) */
IMK_API imk_status imk_motion_script_compile(const imk_motion_script *script,
                                             imk_trajectory_piece *piece, size_t piece_count,
                                             imk_trajectory *trajectory, imk_error *error);

IMK_END_C
#endif
