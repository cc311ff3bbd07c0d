/* SPDX-License-Identifier: Apache-2.0 */
/** @file navigate.h
 *  Strapdown mechanisation: from increments of angle and velocity to attitude, velocity and
 *  position, in Earth-fixed (ECEF) axes, so that no place on Earth is special.
 *
 *  One step over dt:
 *    - the rotation vector of the body from the angle increments, with the coning correction of the
 *      last interval, phi = a + (1/12) a_last x a; attitude q_eb <- q(-w_ie dt) q_eb q(phi), exact
 *      for both rotations [SAVAGE1998a];
 *    - the velocity increment with rotation and sculling corrections, turned by the exact mean of
 *      the rotating frame over the step [SAVAGE1998b];
 *    - gravity and Coriolis in the middle of the step; position by the trapezium of velocities with
 *      the scrolling term.
 *  Gravity is imk_gravity_ecef(), as in motion.h. */
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

/** A mechanisation under way. Plain data. */
typedef struct imk_strapdown {
    imk_navigation_state state;
    imk_vector3 last_angle, last_velocity; /**< increments of the sample before */
    bool has_last;
    bool hold_height; /**< keep the height at the start: the vertical channel slaved */
    double height;
    bool simple; /**< no coning, sculling and scrolling between samples: the rate and force
                      are taken as constant over each (exact for such inputs) */
    imk_vector3 position_low; /**< what rounding has taken from the position */
} imk_strapdown;

/** Start at a state. */
IMK_API imk_strapdown imk_strapdown_start(const imk_navigation_state *state);

/** One sample: increments of angle [rad] and velocity [m/s] over dt [s], in body axes. */
IMK_API void imk_strapdown_step(imk_strapdown *strapdown, double dt, imk_vector3 angle,
                                imk_vector3 velocity);

/** The increments between two states for which a step with constant rate and force over the sample
 *  (`simple`) leads from one to the other in attitude and velocity: the exact inverse of that step.
 *  dt is the difference of their times. The position of `to` is not used. */
IMK_API void imk_strapdown_invert(const imk_navigation_state *from, const imk_navigation_state *to,
                                  imk_vector3 *angle, imk_vector3 *velocity);

#ifdef __cplusplus
}
#endif
#endif
