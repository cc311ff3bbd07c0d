/* SPDX-License-Identifier: Apache-2.0 */
/** @file navigate.h
 *  Strapdown mechanisation: from increments of angle and velocity to attitude, velocity and
 *  position, in Earth-fixed (ECEF) axes, so that no place on Earth is special.
 *
 *  One step over dt, from increments of angle a and of velocity u:
 *    - the rotation vector of the body with its coning correction, phi = a + (a x da)/12; attitude
 *      q_eb <- q(-w_ie dt) q_eb q(phi), exact for both rotations [SAVAGE1998a];
 *    - the velocity increment turned by the exact mean of the rotating frame over the step, with
 *      the sculling correction (a x du - da x u)/12 [SAVAGE1998b];
 *    - gravity and Coriolis in the middle of the step; position by the trapezium of velocities with
 *      the scrolling term.
 *  da and du, the growth of a and u within the step, come from the parabola through this sample and
 *  the two before it, whatever their lengths. Errors are then of fourth order in dt: on a drive of
 *  10 minutes at 100 Hz with perfect sensors below a micrometre. Rotations faster than the samples
 *  resolve leave more: of coning with phase x per sample about 0.3 x^2 is missed.
 *
 *  Gravity is imk_gravity_ecef(), as in motion.h. Only + - * / sqrt and elementary.h: the same bits
 *  everywhere. Equations: docs/theory/navigation.md. */
#ifndef IMUKIT_NAVIGATE_H
#define IMUKIT_NAVIGATE_H

#include "imukit/attitude.h"
#include "imukit/earth.h"

#include <stdbool.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Where a body is, how fast, and how it stands; Earth-fixed axes. */
typedef struct imk_navigation_state {
    double time;             /**< [s] */
    imk_vector3 position;    /**< [m] */
    imk_vector3 velocity;    /**< relative to the Earth [m/s] */
    imk_quaternion attitude; /**< q_eb */
} imk_navigation_state;

/** State from geodetic place, north-east-down velocity and C_nb. */
IMK_API imk_navigation_state imk_navigation_state_ned(double time, imk_geodetic place,
                                                      imk_vector3 velocity_ned, imk_matrix3 c_nb);
/** The reverse; any output may be NULL. */
IMK_API void imk_navigation_state_to_ned(const imk_navigation_state *state, imk_geodetic *place,
                                         imk_vector3 *velocity_ned, imk_matrix3 *c_nb);
/** Difference a - b of two positions in north-east-down axes at b [m], without loss of digits. */
IMK_API imk_vector3 imk_navigation_difference_ned(const imk_navigation_state *a,
                                                  const imk_navigation_state *b);

/** A mechanisation under way. Plain data: a copy goes on from the same point. Start with
 *  imk_strapdown_start(), then set hold_height or simple if wanted. */
typedef struct imk_strapdown {
    imk_navigation_state state;
    imk_vector3 last_angle, last_velocity; /**< increments of the sample before */
    bool has_last;
    bool hold_height; /**< keep the height at the start: the vertical channel slaved */
    double height;    /**< that height, above the ellipsoid [m] */
    bool simple;      /**< no coning, sculling and scrolling between samples: the rate and force
                           are taken as constant over each (exact for such inputs) */
    imk_vector3 position_low;    /**< what rounding has taken from the position */
    imk_quaternion attitude_low; /**< and from the attitude */
    double last_step;            /**< dt of the sample before [s], when has_last */
    bool has_slope;              /**< two samples before are known */
    double step_before;          /**< dt of the one before the last [s] */
    imk_vector3 last_angle_slope, last_velocity_slope; /**< half the slope of rate [rad/s^2] and
                                                            force [m/s^3] between the two */
} imk_strapdown;

/** Start at a state; the attitude is made a unit quaternion. A body that is moving already may be
 *  given the sample before the start: last_angle, last_velocity, last_step and has_last. */
IMK_API imk_strapdown imk_strapdown_start(const imk_navigation_state *state);

/** One sample: increments of angle [rad] and velocity [m/s] over dt > 0 [s], in body axes. */
IMK_API void imk_strapdown_step(imk_strapdown *strapdown, double dt, imk_vector3 angle,
                                imk_vector3 velocity);

/** The increments between two states for which a step with constant rate and force over the sample
 *  (`simple`) leads from one to the other in attitude and velocity: the exact inverse of that step,
 *  to rounding, for steps up to 10 s and turns below half a revolution. dt is the difference of
 *  their times. The position of `to` is not used. */
IMK_API void imk_strapdown_invert(const imk_navigation_state *from, const imk_navigation_state *to,
                                  imk_vector3 *angle, imk_vector3 *velocity);

#ifdef __cplusplus
}
#endif
#endif
