/* SPDX-License-Identifier: Apache-2.0 */
/** @file motion.h
 *  True motion and temperature: trajectories, and the readings of perfect sensors on them.
 *
 *  A trajectory is a chain of pieces, each a polynomial in time of the position in Earth-fixed axes
 *  and of the attitude quaternion. Everything else follows by differentiation, so the truth is
 *  consistent by construction: position, velocity, attitude, angular rate, angular acceleration and
 *  specific force belong to one motion,
 *
 *      w = C_be w_ie + 2 vec(q* q')/|q|^2,       f = C_be (r'' + 2 w_ie x r' - g(r)),
 *
 *  where q is q_eb up to its norm and g is the normal gravity of earth.h. Scripts (motion_script.h)
 *  and tables of poses compile into pieces; a body at rest is one piece.
 *
 *  Functions of time have no state: samples may be taken at any times, in any order, on any thread,
 *  with the same bits. Only + - * / sqrt (and imk_sin, imk_cos for vibration) are used. */
#ifndef IMUKIT_MOTION_H
#define IMUKIT_MOTION_H

#include "imukit/attitude.h"
#include "imukit/earth.h"
#include "imukit/random.h"

#include <stdbool.h>

IMK_BEGIN_C

/* ---- trajectories ---------------------------------------------------------------------------- */

/** Polynomials in s = time - start, 0 <= s <= length. Pieces follow one another without gap or
 *  overlap; position is continuous with its first and second, the quaternion with its first
 *  derivative at least. */
typedef struct imk_trajectory_piece {
    double start, length;    /**< [s]; the last piece may be infinitely long */
    double position[3][7];   /**< Earth-fixed, relative to the origin: coefficient of s^i [m/s^i] */
    double quaternion[4][6]; /**< w, x, y, z of q_eb up to its norm: coefficient of s^i [1/s^i] */
} imk_trajectory_piece;

enum { IMK_VIBRATION_LINES_MAX = 512 };

/** Frequencies of lines [Hz]. */
#define IMK_VIBRATION_FREQUENCY_MIN 1e-6
#define IMK_VIBRATION_FREQUENCY_MAX 1e9
/** Largest sum of the displacement amplitudes along an axis [m]. */
#define IMK_VIBRATION_DISPLACEMENT_MAX 1e4

/** One line of a vibration: displacement or rotation of the body about its smooth trajectory,
 *  amplitude sin(2 pi (frequency t + phase)) along one body axis. The displacement is along the
 *  axes of the smooth attitude; the rotations follow it, about x, then the new y, then the new z.
 */
typedef struct imk_vibration_line {
    int axis;         /**< 0 … 2: displacement along x, y, z; 3 … 5: rotation about x, y, z */
    double amplitude; /**< [m] or [rad]; displacements along an axis to 10 km together, rotations to
                         0.1 rad, all about an axis to 1 rad */
    double frequency; /**< [Hz], 1e-6 … 1e9 */
    double phase;     /**< [cycles] */
} imk_vibration_line;

/** A motion known at all times. Arrays belong to the caller. */
typedef struct imk_trajectory {
    bool earth;       /**< false: no Earth rate, no gravity; axes and origin are inertial then */
    double origin[3]; /**< Earth-fixed [m] */
    size_t piece_count;
    const imk_trajectory_piece *piece; /**< in order of time */
    size_t line_count;
    const imk_vibration_line *line;
} imk_trajectory;

/** Everything about the body at one instant. */
typedef struct imk_motion_state {
    double time;
    imk_geodetic place;       /**< of the reference point (zeros without Earth) */
    imk_vector3 position;     /**< Earth-fixed, without the origin when there is no Earth [m] */
    imk_vector3 velocity;     /**< relative to the Earth, Earth-fixed axes [m/s] */
    imk_vector3 velocity_ned; /**< the same in north-east-down axes [m/s] */
    imk_quaternion attitude;  /**< q_eb: body to Earth-fixed axes */
    imk_matrix3 c_nb;         /**< body to north-east-down */
    imk_vector3 angular_rate; /**< body in inertial space, body axes [rad/s] */
    imk_vector3 angular_acceleration; /**< its derivative in body axes [rad/s^2] */
    imk_vector3 specific_force;       /**< body axes [m/s^2] */
} imk_motion_state;

/** A body at rest at a place, with attitude roll, pitch, yaw [rad] in north-east-down axes: one
 *  endless piece, which the caller keeps. Without Earth the place does not matter, and the axes of
 *  the trajectory stand for north, east and down.
 *  @return IMK_ERROR_RANGE (error names the argument) */
IMK_API imk_status imk_trajectory_standstill(imk_geodetic place, const double roll_pitch_yaw[3],
                                             bool earth, imk_trajectory_piece *piece,
                                             imk_trajectory *trajectory, imk_error *error);

/** Check numbers, order and continuity of pieces, and lines. The jumps allowed where pieces meet
 *  are far above rounding errors and below the resolution of sensors: 1e-7 rad, 1e-6 m, m/s and
 *  rad/s, 1e-4 m/s^2, and a part of 1e-9 (position, velocity), 1e-6 or 1e-4 of the quantity.
 *  @return IMK_ERROR_EMPTY, _NOT_FINITE, _RANGE, _TIME_ORDER, _CONFLICT (a jump), _ARGUMENT (too
 *          many lines); error.index is the piece or line */
IMK_API imk_status imk_trajectory_validate(const imk_trajectory *trajectory, imk_error *error);

/** First and last instant of a trajectory [s]; an endless trajectory ends at infinity. */
IMK_API void imk_trajectory_span(const imk_trajectory *trajectory, double *first, double *last);

/** State at one instant. Before the start and after the end the body goes on as it is there: at
 *  constant velocity in Earth-fixed axes, at an angular rate that falls as 1/(1 + (angle/2)^2) of
 *  the angle it would have turned by; a body at rest stays. So a row whose time is past the end by
 *  an error of a clock has no other velocity. At the end itself, and later by what rounding may do
 *  (a millionth of the last piece and 16 units in the last place of the time), its accelerations
 *  are still those of the last piece. Without Earth, place is zero and c_nb,
 *  velocity_ned are in the axes of the trajectory. About 0.4 us. */
IMK_API void imk_trajectory_state(const imk_trajectory *trajectory, double time,
                                  imk_motion_state *state);

/** Readings of perfect sensors over intervals: means of angular rate and specific force, and of the
 *  angular acceleration (the difference of the rates at the ends, divided by the interval).
 *
 *  Integrated by Gauss-Lobatto quadrature with five nodes between the ends of intervals and pieces:
 *  the relative error is below 1e-12 when in an interval the body turns less than 0.3 rad, travels
 *  less than 1 km and vibrates less than a sixteenth of a cycle (imk_trajectory_substeps(); at a
 *  quarter it is 3e-8). A constant is met exactly: a body at rest reads what imk_trajectory_state()
 *  says, to the bit. The bits of a sample do not depend on the other samples of the call. Before
 *  the start and after the end the motion goes on as in imk_trajectory_state(), and vibration
 *  continues.
 *
 *  Cost at 2.7 GHz: 50 ns a sample with AVX-512, 75 with AVX2, 155 scalar, and 40, 60, 125 where no
 *  power is above the third, as in tables of poses; about twice that where each sample has its own
 *  piece, 2 ns a line and node of vibration; at rest next to nothing. Calls with many samples are
 *  best, at least 8.
 *
 *  @param boundary  count + 1 increasing times [s]; sample k covers boundary[k] … boundary[k+1]
 *  @param kernel    of imk_random_seeded(), or IMK_KERNEL_SCALAR; the bits do not depend on it
 *  @param rate,acceleration,force  3 arrays of count doubles each; acceleration may be NULL */
IMK_API void imk_trajectory_means(const imk_trajectory *trajectory, imk_kernel kernel, size_t count,
                                  const double *boundary, double *const rate[3],
                                  double *const acceleration[3], double *const force[3]);

/** Number of equal parts into which an interval `dt` must be divided to resolve each vibration: at
 *  least 16 per cycle of the highest line, 1 without vibration. */
IMK_API size_t imk_trajectory_substeps(const imk_trajectory *trajectory, double dt);

/* ---- tables of poses --------------------------------------------------------------------------
 */

/** Make the pieces of a trajectory through a table of poses: C2 cubic splines of the Earth-fixed
 *  position (relative to the first one, so no digits are lost) and of the quaternion components,
 *  natural ends ("not-a-knot" from four poses on).
 *
 *  @param time      count increasing times [s], 1e-9 … 1e9 apart
 *  @param position  3 arrays, Earth-fixed relative to `origin` [m]
 *  @param attitude  count unit quaternions q_eb; signs do not matter
 *  @param piece     count - 1 pieces
 *  @return IMK_ERROR_TOO_SHORT (fewer than two), IMK_ERROR_TIME_ORDER (error.index: the row),
 *          IMK_ERROR_NOT_FINITE, IMK_ERROR_WORKSPACE, IMK_ERROR_RANGE (a time step; or two
 *          successive attitudes differ by more than 120 deg, so the turn between them is not known)
 */
IMK_API imk_status imk_trajectory_from_poses(size_t count, const double *time,
                                             const double *const position[3],
                                             const imk_quaternion *attitude,
                                             imk_trajectory_piece *piece, void *workspace,
                                             size_t workspace_size, imk_error *error);
/** Bytes of workspace for `count` poses. */
IMK_API size_t imk_trajectory_poses_workspace_size(size_t count);

/* ---- vibration ---------------------------------------------------------------------------------
 */

/** Make vibration lines that represent a random vibration. Its one-sided acceleration density is
 *  given at corner frequencies, with straight lines between them on log-log axes (as in
 *  MIL-STD-810). The band is cut into parts of equal power; each part is one line at a random
 *  frequency within it, with random phase, so the record never repeats, and its density is as
 *  given, at the resolution of the parts.
 *
 *  @param axis        0 … 2
 *  @param corners     >= 2; frequency [Hz] increasing, 1e-6 … 1e9; density [(m/s^2)^2/Hz], 1e-100 …
 *                     1e100
 *  @param line_count  how many lines to make, 8 … IMK_VIBRATION_LINES_MAX
 *  @param stream      stream of the random source: each stream is another draw */
IMK_API imk_status imk_vibration_from_density(int axis, size_t corners, const double *frequency,
                                              const double *density, imk_random random,
                                              uint64_t stream, size_t line_count,
                                              imk_vibration_line *line, imk_error *error);

/* ---- temperature --------------------------------------------------------------------------------
 */

/** Temperature of a unit. The temperature of the surroundings is linear between points and constant
 *  before the first and after the last one. The unit follows with a time constant, T' =
 *  (surroundings - T)/time_constant, or at once when it is 0. It starts in equilibrium with the
 *  first point. */
typedef struct imk_temperature_profile {
    size_t point_count;        /**< >= 1 */
    const double *time;        /**< increasing [s]; equal times are a step */
    const double *temperature; /**< [K], > 0 */
    double time_constant;      /**< [s], 0 or >= 1e-9 */
    const double *carried;     /**< result of imk_temperature_carry(), for long profiles; or NULL */
} imk_temperature_profile;

/** Check numbers and order of the points. */
IMK_API imk_status imk_temperature_validate(const imk_temperature_profile *profile,
                                            imk_error *error);
/** Compute the temperature of the unit at each point, point_count values, for `carried`. It makes
 *  imk_temperature_at() faster, with the same values. */
IMK_API void imk_temperature_carry(const imk_temperature_profile *profile, double *carried);

/** Temperature [K] and its rate [K/s] at `count` increasing times. The solution is exact from point
 *  to point; each call starts at the first point, unless the profile has `carried`. At the time of
 *  a step, the surroundings are those after the step. @param rate  may be NULL */
IMK_API void imk_temperature_at(const imk_temperature_profile *profile, size_t count,
                                const double *time, double *temperature, double *rate);

/* ---- input of the simulator --------------------------------------------------------------------
 */

/** True rates and forces from another source: means over equal intervals. */
typedef struct imk_recorded_motion {
    size_t count;
    double rate; /**< [Hz] */
    const double *angular_rate[3], *specific_force[3];
    const double *angular_acceleration[3]; /**< NULL: differences of the neighbours' rates */
} imk_recorded_motion;

typedef struct imk_motion {
    const imk_trajectory *trajectory;    /**< or NULL */
    const imk_recorded_motion *recorded; /**< or NULL: exactly one of the two */
} imk_motion;

IMK_END_C
#endif
