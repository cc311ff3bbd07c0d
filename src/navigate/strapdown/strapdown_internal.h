/* SPDX-License-Identifier: Apache-2.0 */
/* What the strapdown step and its inverse have in common: a turn at constant rate, the Earth's turn
 * during a step, and gravity and Coriolis in its middle. Inline, since a step costs less than the
 * calls it would make. */
#ifndef IMUKIT_NAVIGATE_STRAPDOWN_INTERNAL_H
#define IMUKIT_NAVIGATE_STRAPDOWN_INTERNAL_H

#include "base/algebra/vector_internal.h"
#include "imukit/earth.h"
#include "imukit/elementary.h"
#include "imukit/navigate.h"

static inline imk_vector3 imki_sum(imk_vector3 a, imk_vector3 b)
{
    return (imk_vector3){{a.v[0] + b.v[0], a.v[1] + b.v[1], a.v[2] + b.v[2]}};
}

static inline imk_vector3 imki_difference(imk_vector3 a, imk_vector3 b)
{
    return (imk_vector3){{a.v[0] - b.v[0], a.v[1] - b.v[1], a.v[2] - b.v[2]}};
}

static inline imk_vector3 imki_scaled(double factor, imk_vector3 a)
{
    return (imk_vector3){{factor * a.v[0], factor * a.v[1], factor * a.v[2]}};
}

static inline imk_vector3 imki_cross(imk_vector3 a, imk_vector3 b)
{
    return (imk_vector3){{a.v[1] * b.v[2] - a.v[2] * b.v[1], a.v[2] * b.v[0] - a.v[0] * b.v[2],
                          a.v[0] * b.v[1] - a.v[1] * b.v[0]}};
}

/* A turn at constant rate by the rotation vector p of length x, with [p] the matrix of p x:
 *
 *     quaternion        (1 - cosine_to_one, half_sine p)
 *     matrix R(p)       I + sin(x)/x [p] + first [p]^2
 *     mean of R(s p)    I + first [p] + second [p]^2                    0 <= s <= 1
 *     mean (1-s) R(s p) I/2 + second [p] + third [p]^2
 *
 *     half_sine = sin(x/2)/x,   first = (1 - cos x)/x^2 = 2 half_sine^2,
 *     second = (x - sin x)/x^3, third = (x^2/2 - 1 + cos x)/x^4                       */
typedef struct imki_turn {
    double square;        /* x^2 */
    double cosine_to_one; /* 1 - cos(x/2) */
    double half_sine, first, second, third;
} imki_turn;

/* Below half a radian the Taylor series, whose next term is below 1e-18 of the sum; beyond it the
 * differences lose at most two digits of `third`, and `third` is a correction. */
static inline imki_turn imki_turn_from(imk_vector3 p)
{
    imki_turn turn;
    const double x2 = imki_dot3(p.v, p.v), y = 0.25 * x2;
    turn.square = x2;
    if (x2 < 0.25) {
        /* 1/(2n)!, 1/(2n + 1)!, 1/(2n + 3)!, 1/(2n + 4)! with alternating signs */
        turn.cosine_to_one =
            y * (1.0 / 2 - y * (1.0 / 24 -
                                y * (1.0 / 720 - y * (1.0 / 40320 - y * (1.0 / 3628800 -
                                                                         y * (1.0 / 479001600))))));
        turn.half_sine =
            0.5 - y * (1.0 / 12 -
                       y * (1.0 / 240 - y * (1.0 / 10080 - y * (1.0 / 725760 - y / 79833600.0))));
        turn.second =
            1.0 / 6 -
            x2 * (1.0 / 120 - x2 * (1.0 / 5040 - x2 * (1.0 / 362880 -
                                                       x2 * (1.0 / 39916800 - x2 / 6227020800.0))));
        turn.third =
            1.0 / 24 -
            x2 * (1.0 / 720 - x2 * (1.0 / 40320 - x2 * (1.0 / 3628800 - x2 * (1.0 / 479001600))));
    } else {
        const double x = imk_vector3_norm(p), cosine = imk_cos(0.5 * x);
        turn.cosine_to_one = 1.0 - cosine;
        turn.half_sine = imk_sin(0.5 * x) / x;
        turn.second = (1.0 - 2.0 * turn.half_sine * cosine) / x2;
        turn.third = (0.5 - 2.0 * turn.half_sine * turn.half_sine) / x2;
    }
    turn.first = 2.0 * turn.half_sine * turn.half_sine;
    return turn;
}

/* The Earth turns by `angle` during a step. 1 - cosine and the sine are of half that: of the
 * quaternion of the whole turn, and of the matrix of half of it. */
typedef struct imki_earth_turn {
    double angle, cosine_to_one, sine;
} imki_earth_turn;

static inline imki_earth_turn imki_earth_turn_from(double dt)
{
    imki_earth_turn turn = {.angle = IMK_EARTH_RATE * dt};
    const double half = 0.5 * turn.angle, square = half * half;
    if (square < 1e-6) { /* up to 27 s; the next terms are below 1e-20 */
        turn.cosine_to_one = square * (0.5 - square * (1.0 / 24));
        turn.sine = half * (1.0 - square * (1.0 / 6 - square * (1.0 / 120)));
    } else {
        turn.cosine_to_one = 1.0 - imk_cos(half);
        turn.sine = imk_sin(half);
    }
    return turn;
}

/* To Earth axes of the middle of a step, from those of its start (sign 1), or back (sign -1). */
static inline imk_vector3 imki_earth_half_turn(const imki_earth_turn *turn, double sign,
                                               imk_vector3 v)
{
    const double sine = sign * turn->sine, cosine = 1.0 - turn->cosine_to_one;
    return (imk_vector3){
        {cosine * v.v[0] + sine * v.v[1], cosine * v.v[1] - sine * v.v[0], v.v[2]}};
}

static inline imk_quaternion imki_quaternion_product(imk_quaternion a, imk_quaternion b)
{
    return (imk_quaternion){a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z,
                            a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
                            a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
                            a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w};
}

/* q v q* = v + 2 w (u x v) + 2 u x (u x v), u the vector part. */
static inline imk_vector3 imki_rotated(imk_quaternion q, imk_vector3 v)
{
    const imk_vector3 u = {{q.x, q.y, q.z}};
    const imk_vector3 t = imki_cross(u, v), tt = imki_cross(u, t);
    return (imk_vector3){{v.v[0] + 2.0 * (q.w * t.v[0] + tt.v[0]),
                          v.v[1] + 2.0 * (q.w * t.v[1] + tt.v[1]),
                          v.v[2] + 2.0 * (q.w * t.v[2] + tt.v[2])}};
}

/* -h x S - h x (h x F)/8, h along the axis of the Earth. */
static inline imk_vector3 imki_earth_turn_of_force(double h, imk_vector3 scrolling,
                                                   imk_vector3 force)
{
    const double eighth = h * (1.0 / 8);
    return (imk_vector3){{h * (scrolling.v[1] + eighth * force.v[0]),
                          h * (eighth * force.v[1] - scrolling.v[0]), 0.0}};
}

/* Gravity where the body is half-way through a step. */
static inline imk_vector3 imki_gravity_midway(const imk_navigation_state *state, double dt)
{
    return imk_gravity_ecef(imki_sum(state->position, imki_scaled(0.5 * dt, state->velocity)));
}

/* Which of `count` samples of one dt imk_strapdown_lanes_run() would take a height and a climb
 * from: those at which a block ends, and the last.
 * @param sample  room for count
 * @return how many */
size_t imki_lanes_heights(const imk_strapdown_lanes *lanes, double dt, size_t count,
                          size_t *sample);

#endif
