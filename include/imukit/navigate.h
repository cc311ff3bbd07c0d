/* SPDX-License-Identifier: Apache-2.0 */
/** @file navigate.h
 *  Strapdown mechanisation: attitude, velocity and position from increments of angle and velocity.
 *  It works in Earth-fixed (ECEF) axes, so that it has no singular place, such as a pole.
 *
 *  One step over dt, from increments of angle and of velocity:
 *  - the rotation vector of the body with its coning correction; attitude q_eb <- q(-w_ie dt) q_eb
 *    q(phi), exact for both rotations [SAVAGE1998a];
 *  - the velocity increment turned by the exact mean of the rotating frame over the step, with the
 *    sculling correction [SAVAGE1998b];
 *  - gravity and Coriolis in the middle of the step; position by the trapezium of velocities with
 *    the scrolling term.
 *  The corrections assume that rates and forces are polynomials in time through the last one to
 *  four samples (`samples`), which may differ in length. With three samples (a parabola) errors are
 *  of fourth order in dt: below a micrometre on a drive of 10 minutes at 100 Hz with perfect
 *  sensors. Rotations that the samples do not resolve cause larger errors: of coning with phase x
 *  per sample, the part missed is 0.20 x^2 with two samples, 0.32 x^2 with three, 0.29 x^4 with
 *  four, and all with one.
 *
 *  Gravity is imk_gravity_ecef(), as in motion.h. Only + - * / sqrt and elementary.h are used, so
 *  the bits are the same everywhere. Equations: docs/theory/navigation.md. */
#ifndef IMUKIT_NAVIGATE_H
#define IMUKIT_NAVIGATE_H

#include "imukit/attitude.h"
#include "imukit/earth.h"
#include "imukit/random.h"

#include <stdbool.h>

IMK_BEGIN_C

/** Position, velocity and attitude of a body, in Earth-fixed axes. */
typedef struct imk_navigation_state {
    double time;             /**< [s] */
    imk_vector3 position;    /**< [m] */
    imk_vector3 velocity;    /**< relative to the Earth [m/s] */
    imk_quaternion attitude; /**< q_eb */
} imk_navigation_state;

/** State from geodetic place, north-east-down velocity and C_nb. */
IMK_API imk_navigation_state imk_navigation_state_ned(double time, imk_geodetic place,
                                                      imk_vector3 velocity_ned, imk_matrix3 c_nb);
/** Geodetic place, north-east-down velocity and C_nb of a state; any output may be NULL. */
IMK_API void imk_navigation_state_to_ned(const imk_navigation_state *state, imk_geodetic *place,
                                         imk_vector3 *velocity_ned, imk_matrix3 *c_nb);
/** Difference a - b of two positions in north-east-down axes at b [m], without loss of digits. */
IMK_API imk_vector3 imk_navigation_difference_ned(const imk_navigation_state *a,
                                                  const imk_navigation_state *b);

/** Beyond 89 deg of latitude [rad] the heading is that of the grid: relative to the direction that
 *  the meridian of longitude 0 has at the pole. North turns there by more than it is worth. */
#define IMK_GRID_LATITUDE 1.5533430342749532

/** What an error of the position turns the local level by, to first order: north, east and down
 *  [rad] from north, east and down [m]. Beyond IMK_GRID_LATITUDE of the level with grid heading. */
IMK_API imk_matrix3 imk_level_turn(imk_geodetic place);
/** Error of the displayed attitude [rad]: that relative to the local level at the estimated
 *  position, against the true one relative to the level at the true position. 0 and 1: rotation
 *  vector about north and east by which the displayed vertical is wrong; 2: the heading, in
 *  (-pi, pi]. For small errors psi - imk_level_turn() (position error), with psi of C_eb
 *  (estimated) = exp([psi x]) C_eb (true). */
IMK_API imk_vector3 imk_displayed_attitude_error(const imk_navigation_state *estimate,
                                                 const imk_navigation_state *truth);
/** The attitude q_eb that at an estimated position has the error phi: the inverse of
 *  imk_displayed_attitude_error(). */
IMK_API imk_quaternion imk_displayed_attitude(const imk_navigation_state *truth,
                                              imk_vector3 position, imk_vector3 phi);

enum {
    IMK_STRAPDOWN_BLOCK = 32,  /**< samples of a block of imk_strapdown_run(), at most */
    IMK_STRAPDOWN_CARRIED = 45 /**< numbers carried from sample to sample */
};

/** Progress of a mechanisation within a block. Its fields are internal. */
typedef struct imk_strapdown_block {
    double step, last_step, step_before; /**< dt of this block; of the two samples before, when they
                                              are not of this length [s] */
    uint32_t taken;                      /**< samples of the block under way */
    uint32_t known;                      /**< samples before the next, 0 … 2 */
} imk_strapdown_block;

/** A mechanisation in progress. Plain data: a copy continues from the same point. Start with
 *  imk_strapdown_start(), then set hold_height or samples if wanted. */
typedef struct imk_strapdown {
    imk_navigation_state state;
    imk_vector3 last_angle, last_velocity; /**< increments of the sample before */
    bool has_last;
    bool hold_height; /**< true: the vertical channel is given, as by a barometer: after each step
                         the height is set to `height` and the upward velocity to `climb` */
    double height;    /**< above the ellipsoid [m]; initially that of the start */
    double climb; /**< [m/s]; initially 0. If the unit moves vertically, set height and climb before
                     each step */
    int samples; /**< number of samples, 1 … 4, for coning, sculling and scrolling. Rate and force
                    over the last one are 1: constant (exact for such inputs); 2: the straight line
                    through two; 3: the parabola through three, at the start; 4: the cubic */
    imk_vector3 position_low;    /**< rounding error of the position */
    imk_quaternion attitude_low; /**< rounding error of the attitude */
    double last_step;            /**< dt of the sample before [s], when has_last */
    double step_before[2];       /**< dt of the two samples before that, as far as known [s] */
    int differences; /**< how many of the differences below the sample before has, 0 … 2 */
    imk_vector3 angle_difference[2], velocity_difference[2]; /**< its divided differences of rate
                                                                  and force, of first and second
                                                                  order: half the slope, a sixth of
                                                                  the bend */
    /** Internal to imk_strapdown_run(): values carried from call to call, the state at the end of
     *  the last call, and hold_height then. */
    imk_strapdown_block block;
    double carried[IMK_STRAPDOWN_CARRIED];
    imk_navigation_state reported;
    bool held;
} imk_strapdown;

/** Start at a state; the attitude is normalised. For a body that is already moving, you may set the
 *  sample before the start: last_angle, last_velocity, last_step and has_last. */
IMK_API imk_strapdown imk_strapdown_start(const imk_navigation_state *state);

/** Take one sample: increments of angle [rad] and velocity [m/s] over dt > 0 [s], in body axes. */
IMK_API void imk_strapdown_step(imk_strapdown *strapdown, double dt, imk_vector3 angle,
                                imk_vector3 velocity);

/** Increments of the sample that leads from one state to another in attitude and velocity, if rate
 *  and force are constant over it: the exact inverse of imk_strapdown_step() with `samples` 1, to
 *  rounding, for steps up to 10 s and turns below half a revolution. dt is the difference of the
 *  times. The position of `to` is not used. */
IMK_API void imk_strapdown_invert(const imk_navigation_state *from, const imk_navigation_state *to,
                                  imk_vector3 *angle, imk_vector3 *velocity);

/* ---- many samples at once ----------------------------------------------------------------------
 *
 * The computation has two speeds [SAVAGE1998a, SAVAGE1998b]. Samples are gathered into blocks of 2
 * to 32 samples, up to 0.4 s where that is two or more. Within a block, the axes are those of the
 * body at the block's start. In these axes the rotation and the integrals of the force are computed
 * for each pair of samples, with exact rotations, and with the coning and sculling of straight
 * lines through the two samples: of coning with phase x per sample, x^2/20 is missed. The Earth
 * (gravity, Coriolis, its rotation, the vertical channel) acts once per block. Errors are of fourth
 * order in a pair and of third in a block: on the drive of 10 minutes at 100 Hz some micrometres,
 * and 1e-6 of the effect of the sensors' errors. */

/** Take `count` samples of equal length at once, in blocks; if `samples` is not 3, by
 *  imk_strapdown_step(). On return `state` is that after the last sample. The bits do not depend on
 *  how samples are divided among calls, unless state, hold_height or dt are changed in between,
 *  because a new block then begins.
 *  @param channel       means over the samples of angular rate x, y, z [rad/s] and specific force
 *                       x, y, z [m/s^2]: six arrays of `count`
 *  @param height,climb  at the end of each sample, with hold_height; NULL: they do not change */
IMK_API void imk_strapdown_run(imk_strapdown *strapdown, size_t count, double dt,
                               const double *const channel[6], const double *height,
                               const double *climb);

/* ---- many runs of one motion side by side ------------------------------------------------------
 */

enum { IMK_STRAPDOWN_LANES = 8 };

/** Eight mechanisations that take samples at the same time, each with samples of its own. Plain
 *  data; a copy continues from the same point. Its fields are internal. */
typedef struct imk_strapdown_lanes {
    double carried[IMK_STRAPDOWN_CARRIED][IMK_STRAPDOWN_LANES];
    imk_strapdown_block block;
    bool hold_height;
} imk_strapdown_lanes;

/** Start one lane (0 … 7) at a state; the attitude is normalised, and no sample precedes. Start all
 *  lanes before samples are given, unused ones at any state; to restart one later, restart all.
 *  hold_height is common to all lanes; the height held is that of the state, the climb is 0. */
IMK_API void imk_strapdown_lanes_start(imk_strapdown_lanes *lanes, size_t lane,
                                       const imk_navigation_state *state, bool hold_height);
/** State of a lane. */
IMK_API imk_navigation_state imk_strapdown_lanes_state(const imk_strapdown_lanes *lanes,
                                                       size_t lane);
/** Take `count` samples of equal length in every lane. Each lane has the same bits as
 *  imk_strapdown_run() from the same state and samples, for every kernel and division of `count`
 *  (except the sign of NaN in a lane whose state is lost). A change of dt begins a new block. On
 *  AVX-512 some 3 ns per lane and sample at 80 Hz or more; slower samples make smaller blocks.
 *  @param kernel        of imk_random_seeded(), or IMK_KERNEL_SCALAR
 *  @param channel       [lane][rate x, y, z, force x, y, z]: as in imk_strapdown_run(); lanes may
 *                       share arrays
 *  @param height,climb  as in imk_strapdown_run(), common to all lanes */
IMK_API void imk_strapdown_lanes_run(imk_strapdown_lanes *lanes, imk_kernel kernel, size_t count,
                                     double dt, const double *const channel[][6],
                                     const double *height, const double *climb);

IMK_END_C
#endif
