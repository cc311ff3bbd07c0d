/* SPDX-License-Identifier: Apache-2.0 */
/* Motions known in closed form, and the increments perfect sensors give on them, by Gauss-Legendre
 * quadrature of rate and specific force. Positions are in the north-east-down axes of a fixed
 * origin, l, attitudes relative to the same axes:
 *
 *     w = w_lb + C_bl C_le w_ie,     f = C_bl [a + 2 C_le w_ie x v - C_le g(r)]             */
#ifndef IMUKIT_TESTS_EXACT_MOTION_H
#define IMUKIT_TESTS_EXACT_MOTION_H

#include "imukit/elementary.h"
#include "imukit/navigate.h"

/* A motion at one instant: in axes l, w_lb in body axes. */
typedef struct exact_instant {
    imk_vector3 position, velocity, acceleration;
    imk_quaternion attitude;
    imk_vector3 rate;
} exact_instant;

typedef struct exact_motion {
    imk_geodetic origin;
    exact_instant (*at)(double time);
} exact_motion;

/* Amplitude and derivatives of a sin(w t) + b (1 - cos(w t)). */
static inline void exact_wave(double a, double b, double w, double t, double out[3])
{
    const double sine = imk_sin(w * t), cosine = imk_cos(w * t);
    out[0] += a * sine + b * (1.0 - cosine);
    out[1] += w * (a * cosine + b * sine);
    out[2] += w * w * (b * cosine - a * sine);
}

/* Body rate of Euler angles, yaw first. */
static inline imk_vector3 exact_euler_rate(const double angle[3], const double rate[3])
{
    const double sr = imk_sin(angle[0]), cr = imk_cos(angle[0]);
    const double sp = imk_sin(angle[1]), cp = imk_cos(angle[1]);
    return (imk_vector3){{rate[0] - sp * rate[2], cr * rate[1] + sr * cp * rate[2],
                          cr * cp * rate[2] - sr * rate[1]}};
}

/* q_el */
static inline imk_quaternion exact_axes(const exact_motion *motion)
{
    return imk_quaternion_from_matrix(
        imk_ned_axes(motion->origin.latitude, motion->origin.longitude));
}

static inline imk_navigation_state exact_state(const exact_motion *motion, double time)
{
    const exact_instant now = motion->at(time);
    const imk_matrix3 c_el = imk_ned_axes(motion->origin.latitude, motion->origin.longitude);
    const imk_vector3 origin = imk_ecef_from_geodetic(motion->origin);
    return (imk_navigation_state){
        .time = time,
        .position = imk_vector3_add(origin, imk_matrix3_apply(c_el, now.position)),
        .velocity = imk_matrix3_apply(c_el, now.velocity),
        .attitude = imk_quaternion_multiply(exact_axes(motion), now.attitude)};
}

/* Rate and specific force at one instant. */
static inline void exact_inputs(const exact_motion *motion, const imk_matrix3 *c_le,
                                imk_vector3 origin, double time, imk_vector3 *rate,
                                imk_vector3 *force)
{
    const exact_instant now = motion->at(time);
    const imk_vector3 earth = imk_matrix3_apply(*c_le, (imk_vector3){{0, 0, IMK_EARTH_RATE}});
    const imk_vector3 place =
        imk_vector3_add(origin, imk_matrix3_apply(imk_matrix3_transpose(*c_le), now.position));
    const imk_vector3 gravity = imk_matrix3_apply(*c_le, imk_gravity_ecef(place));
    const imk_vector3 coriolis = imk_vector3_scale(imk_vector3_cross(earth, now.velocity), 2.0);
    const imk_quaternion back = imk_quaternion_conjugate(now.attitude);
    *rate = imk_vector3_add(now.rate, imk_quaternion_rotate(back, earth));
    *force = imk_quaternion_rotate(
        back, imk_vector3_subtract(imk_vector3_add(now.acceleration, coriolis), gravity));
}

/* Increments from one time to another. Five points leave (step/time scale)^10/1e9: nothing for
 * the motions here. */
static inline void exact_increments(const exact_motion *motion, double from, double to,
                                    imk_vector3 *angle, imk_vector3 *velocity)
{
    static const double point[5] = {0.0, -0.5384693101056831, 0.5384693101056831,
                                    -0.9061798459386640, 0.9061798459386640};
    static const double weight[5] = {0.5688888888888889, 0.4786286704993665, 0.4786286704993665,
                                     0.2369268850561891, 0.2369268850561891};
    const imk_matrix3 c_le =
        imk_matrix3_transpose(imk_ned_axes(motion->origin.latitude, motion->origin.longitude));
    const imk_vector3 origin = imk_ecef_from_geodetic(motion->origin);
    const double middle = 0.5 * (from + to), half = 0.5 * (to - from);
    *angle = *velocity = (imk_vector3){{0, 0, 0}};
    for (int i = 0; i < 5; i++) {
        imk_vector3 rate, force;
        exact_inputs(motion, &c_le, origin, middle + half * point[i], &rate, &force);
        *angle = imk_vector3_add(*angle, imk_vector3_scale(rate, half * weight[i]));
        *velocity = imk_vector3_add(*velocity, imk_vector3_scale(force, half * weight[i]));
    }
}

/* The mechanisation `seconds` along a motion at `rate` [Hz], with corrections from `samples`, all
 * of which it knows at the start. `spread` moves every other sampling instant by that fraction of
 * the interval. */
static inline imk_strapdown exact_run_of(const exact_motion *motion, double seconds, double rate,
                                         double spread, int samples)
{
    const imk_navigation_state start = exact_state(motion, 0.0);
    const int count = (int)(seconds * rate + 0.5);
    imk_strapdown strapdown = imk_strapdown_start(&start);
    strapdown.samples = samples;
    double from = (1 - samples) / rate;
    for (int k = 2 - samples; k <= count; k++) {
        const double shift = k > 0 && k % 2 == 1 && k < count ? spread : 0.0;
        const double to = ((double)k + shift) / rate;
        imk_vector3 angle, velocity;
        exact_increments(motion, from, to, &angle, &velocity);
        imk_strapdown_step(&strapdown, to - from, angle, velocity);
        from = to;
        if (k == 0) { /* the samples are known now, and the run begins */
            strapdown.state = imk_strapdown_start(&start).state;
            strapdown.position_low = (imk_vector3){{0}};
            strapdown.attitude_low = (imk_quaternion){0};
        }
    }
    return strapdown;
}

/* That of three samples. */
static inline imk_strapdown exact_run(const exact_motion *motion, double seconds, double rate,
                                      double spread)
{
    return exact_run_of(motion, seconds, rate, spread, 3);
}

/* What a run has missed. */
typedef struct exact_error {
    double position, velocity, attitude; /* [m], [m/s], [rad] */
} exact_error;

static inline exact_error exact_compare(const imk_navigation_state *state,
                                        const imk_navigation_state *truth)
{
    const imk_quaternion off =
        imk_quaternion_multiply(imk_quaternion_conjugate(truth->attitude), state->attitude);
    return (exact_error){
        .position = imk_vector3_norm(imk_vector3_subtract(state->position, truth->position)),
        .velocity = imk_vector3_norm(imk_vector3_subtract(state->velocity, truth->velocity)),
        .attitude = 2.0 * imk_vector3_norm((imk_vector3){{off.x, off.y, off.z}})};
}

#endif
