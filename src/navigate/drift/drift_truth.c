/* SPDX-License-Identifier: Apache-2.0 */
/* Truth and errors of a run. With C the north-east-down axes at the true place, as columns in
 * Earth-fixed axes, errors e (estimate minus truth) are
 *
 *     r^ - r = C e_r,   v^ - v = C e_v,   q^ = q(C e_a) q
 *
 * q(.) being the quaternion of a rotation vector, if the attitude is compared in Earth-fixed axes;
 * else e_a is that of the displayed attitude (displayed_attitude.c). */
#include "drift_runs_internal.h"

#include "imukit/noise.h"
#include "motion/trajectory_internal.h"

#include <math.h>
#include <string.h>

typedef double real;

static inline real square_root(real a)
{
    return sqrt(a);
}

#include "motion/gravity_kernel.h"

/* Position, relative to the origin, and velocity: the polynomials alone where nothing vibrates. */
static void moving_point(const imk_trajectory *trajectory, const imk_trajectory_piece *piece,
                         double time, double position[3], double velocity[3])
{
    if (trajectory->line_count > 0) {
        imki_instant at;
        imki_instant_of(trajectory, piece, time, &at);
        memcpy(position, at.position, sizeof at.position);
        memcpy(velocity, at.velocity, sizeof at.velocity);
        return;
    }
    const double s = time - piece->start;
    for (int i = 0; i < 3; i++) {
        double p = piece->position[i][6], v = 0.0;
        for (int power = 5; power >= 0; power--) {
            v = v * s + p;
            p = p * s + piece->position[i][power];
        }
        position[i] = p;
        velocity[i] = v;
    }
}

void imki_drift_heights(const imk_trajectory *trajectory, size_t count, const size_t *row,
                        const double *time, double *height, double *climb)
{
    imki_cursor cursor;
    imki_cursor_start(&cursor, trajectory, time[0]);
    for (size_t k = 0; k < count; k++) {
        double p[3], v[3];
        moving_point(trajectory, imki_cursor_at(&cursor, time[k]), time[k], p, v);
        const double x = trajectory->origin[0] + p[0], y = trajectory->origin[1] + p[1];
        const double z = trajectory->origin[2] + p[2], pp = x * x + y * y;
        const slope vertical = vertical_at(pp, z);
        height[row[k]] = height_along(vertical, pp, z);
        climb[row[k]] = vertical.k * (x * v[0] + y * v[1]) + vertical.s * v[2];
    }
}

imk_navigation_state imki_drift_truth(const imk_trajectory *trajectory, double time, double stamp)
{
    imk_motion_state at;
    imk_trajectory_state(trajectory, time, &at);
    return (imk_navigation_state){
        .time = stamp, .position = at.position, .velocity = at.velocity, .attitude = at.attitude};
}

static imk_matrix3 axes_at(const imk_navigation_state *truth)
{
    const imk_geodetic place = imk_geodetic_from_ecef(truth->position);
    return imk_ned_axes(place.latitude, place.longitude);
}

/* State i is normal 0 of the stream (run, IMK_TERM_INITIAL, 0, i). */
imk_navigation_state imki_drift_displaced(const imk_navigation_state *truth,
                                          const imk_drift_settings *settings, imk_random random,
                                          uint32_t run)
{
    const double *sigma = settings->initial_sigma;
    const bool slaved = settings->vertical == IMK_VERTICAL_SLAVED;
    const bool given = settings->alignment == IMK_ALIGNED_GIVEN;
    imk_vector3 error[3] = {{{0.0}}};
    bool any = false;
    for (int i = 0; i < IMK_DRIFT_STATES; i++) {
        if (sigma[i] == 0.0 || (slaved && (i == 2 || i == 5)) || (!given && i >= 6))
            continue;
        double normal;
        imk_random_normals(random, imk_stream(run, IMK_TERM_INITIAL, 0, (uint8_t)i), 0, 1, &normal);
        error[i / 3].v[i % 3] = sigma[i] * normal;
        any = any || i < 3 || i >= 6;
    }
    const imk_matrix3 axes = axes_at(truth);
    imk_navigation_state state = *truth;
    state.position = imk_vector3_add(truth->position, imk_matrix3_apply(axes, error[0]));
    state.velocity = imk_vector3_add(truth->velocity, imk_matrix3_apply(axes, error[1]));
    if (any && given && settings->attitude_errors == IMK_ATTITUDE_LOCAL)
        state.attitude = imk_displayed_attitude(truth, state.position, error[2]);
    else
        state.attitude = imk_quaternion_multiply(
            imk_quaternion_from_rotation_vector(imk_matrix3_apply(axes, error[2])),
            truth->attitude);
    return state;
}

void imki_drift_errors(const imk_navigation_state *estimate, const imk_navigation_state *truth,
                       imk_attitude_errors stated, double errors[IMK_DRIFT_STATES])
{
    const imk_matrix3 to_ned = imk_matrix3_transpose(axes_at(truth));
    const imk_quaternion turn =
        imk_quaternion_multiply(estimate->attitude, imk_quaternion_conjugate(truth->attitude));
    const imk_vector3 difference[3] = {
        imk_vector3_subtract(estimate->position, truth->position),
        imk_vector3_subtract(estimate->velocity, truth->velocity),
        imk_quaternion_to_rotation_vector(turn),
    };
    for (int part = 0; part < 3; part++) {
        const imk_vector3 ned = imk_matrix3_apply(to_ned, difference[part]);
        for (int i = 0; i < 3; i++)
            errors[3 * part + i] = ned.v[i];
    }
    if (stated == IMK_ATTITUDE_LOCAL) {
        const imk_vector3 phi = imk_displayed_attitude_error(estimate, truth);
        memcpy(errors + 6, phi.v, sizeof phi.v);
    }
}
