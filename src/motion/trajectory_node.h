/* SPDX-License-Identifier: Apache-2.0 */
/* What sensors on a trajectory read at one instant. No include guard; trajectory_kernel.h says what
 * to define first.
 *
 * With q the polynomial of the quaternion, n = |q|^2, C = C_be and e = C w_ie,
 *
 *     u = 2 vec(q* q')/n,   u' = 2 vec(q* q'')/n - u 2 (q.q')/n         relative to the axes
 *     w = u + e,            w' = u' - u x e                             in inertial space
 *     f = C (r'' + 2 w_ie x r' - g)
 *
 * and with a displacement d of vibration in body axes, v = d' + u x d its velocity,
 *
 *     r' + C^T v                                      instead of r'
 *     f + d'' + u' x d + u x (d' + v) + 2 e x v       instead of f
 *
 * Its rotation C_v = Rx Ry Rz acts last: one axis k after the other, by the angle a,
 *
 *     f <- R^T f,   w <- R^T w + a' k,   w' <- R^T w' - a' k x R^T w + a'' k */
#include "gravity_kernel.h"
#include "trajectory_internal.h"

#ifndef KERNEL
#define KERNEL static inline __attribute__((always_inline))
#endif

typedef double real_in_array __attribute__((vector_size(8 * LANES), aligned(8), may_alias));
typedef int64_t word __attribute__((vector_size(8 * LANES)));

typedef struct vector {
    real v[3];
} vector;

/* Vibration at one instant: displacements, then rotations, and their derivatives. */
typedef struct tremor {
    real value[6], rate[6], change[6];
} tremor;

/* Everything at one instant. What a caller does not use is never computed. */
typedef struct node {
    vector rate, acceleration, force;
    vector position, velocity, gravity;
    vector rotation;
} node;

/* Where coefficients come from: one piece for all lanes, or gathered lane by lane. */
typedef struct coefficients {
    bool same;
    bool cubic; /* the powers above the third are 0 and left out */
    const double *position, *quaternion;
    real gathered_position[21], gathered_quaternion[24];
} coefficients;

KERNEL real spread(double x)
{
    return x - (real){0.0};
}

KERNEL real load(const double *x)
{
    return *(const real_in_array *)x;
}

KERNEL void store(double *x, real value)
{
    *(real_in_array *)x = value;
}

KERNEL vector zero_vector(void)
{
    return (vector){{spread(0.0), spread(0.0), spread(0.0)}};
}

KERNEL vector sum(vector a, vector b)
{
    return (vector){{a.v[0] + b.v[0], a.v[1] + b.v[1], a.v[2] + b.v[2]}};
}

KERNEL vector difference(vector a, vector b)
{
    return (vector){{a.v[0] - b.v[0], a.v[1] - b.v[1], a.v[2] - b.v[2]}};
}

KERNEL vector scaled(real factor, vector a)
{
    return (vector){{factor * a.v[0], factor * a.v[1], factor * a.v[2]}};
}

KERNEL vector cross(vector a, vector b)
{
    return (vector){{a.v[1] * b.v[2] - a.v[2] * b.v[1], a.v[2] * b.v[0] - a.v[0] * b.v[2],
                     a.v[0] * b.v[1] - a.v[1] * b.v[0]}};
}

/* ---- polynomials ----------------------------------------------------------------------------- */

KERNEL real position_coefficient(const coefficients *from, size_t axis, size_t power)
{
    return from->same ? spread(from->position[7 * axis + power])
                      : from->gathered_position[7 * axis + power];
}

KERNEL real quaternion_coefficient(const coefficients *from, size_t part, size_t power)
{
    return from->same ? spread(from->quaternion[6 * part + power])
                      : from->gathered_quaternion[6 * part + power];
}

/* The derivative of s^power is this times s^(power - order), order <= 2. */
KERNEL double derivative_factor(int power, int order)
{
    return order == 0 ? 1.0 : order == 1 ? power : (double)(power * (power - 1));
}

/* The derivative of the order given: p = c[n] n!/(n - order)!, p = p s + ... Leaving out powers
 * whose coefficients are 0 does not change a bit of what is not itself 0. */
KERNEL vector position_derivative(const coefficients *from, real s, int order)
{
    const int top = from->cubic ? 3 : 6;
    vector result;
    for (size_t axis = 0; axis < 3; axis++) {
        real p = spread(0.0);
        for (int power = top; power >= order; power--) {
            const real term =
                derivative_factor(power, order) * position_coefficient(from, axis, (size_t)power);
            p = power == top ? term : p * s + term;
        }
        result.v[axis] = p;
    }
    return result;
}

KERNEL void quaternion_derivative(const coefficients *from, real s, int order, real result[4])
{
    const int top = from->cubic ? 3 : 5;
    for (size_t part = 0; part < 4; part++) {
        real p = spread(0.0);
        for (int power = top; power >= order; power--) {
            const real term =
                derivative_factor(power, order) * quaternion_coefficient(from, part, (size_t)power);
            p = power == top ? term : p * s + term;
        }
        result[part] = p;
    }
}

/* ---- attitude -------------------------------------------------------------------------------- */

typedef struct orientation {
    vector row[3];      /* of n C_eb */
    real inverse;       /* 1/n */
    vector turn;        /* u */
    vector turn_change; /* u' */
} orientation;

/* vec(q* p) */
KERNEL vector turned_back(const real q[4], const real p[4])
{
    return (vector){{
        q[0] * p[1] - p[0] * q[1] - (q[2] * p[3] - q[3] * p[2]),
        q[0] * p[2] - p[0] * q[2] - (q[3] * p[1] - q[1] * p[3]),
        q[0] * p[3] - p[0] * q[3] - (q[1] * p[2] - q[2] * p[1]),
    }};
}

KERNEL orientation orientation_at(const coefficients *from, real s)
{
    real q[4], rate[4], change[4];
    quaternion_derivative(from, s, 0, q);
    quaternion_derivative(from, s, 1, rate);
    quaternion_derivative(from, s, 2, change);
    const real ww = q[0] * q[0], xx = q[1] * q[1], yy = q[2] * q[2], zz = q[3] * q[3];
    const real xy = q[1] * q[2], xz = q[1] * q[3], yz = q[2] * q[3];
    const real wx = q[0] * q[1], wy = q[0] * q[2], wz = q[0] * q[3];
    const real inverse = 1.0 / ((ww + xx) + (yy + zz));
    const real twice = 2.0 * inverse;
    const real growth =
        twice * ((q[0] * rate[0] + q[1] * rate[1]) + (q[2] * rate[2] + q[3] * rate[3]));
    orientation at;
    at.row[0] = (vector){{(ww + xx) - (yy + zz), 2.0 * (xy - wz), 2.0 * (xz + wy)}};
    at.row[1] = (vector){{2.0 * (xy + wz), (ww - xx) + (yy - zz), 2.0 * (yz - wx)}};
    at.row[2] = (vector){{2.0 * (xz - wy), 2.0 * (yz + wx), (ww - xx) - (yy - zz)}};
    at.inverse = inverse;
    at.turn = scaled(twice, turned_back(q, rate));
    at.turn_change = difference(scaled(twice, turned_back(q, change)), scaled(growth, at.turn));
    return at;
}

/* C_be a */
KERNEL vector to_body(const orientation *at, vector a)
{
    vector result;
    for (int i = 0; i < 3; i++)
        result.v[i] =
            ((at->row[0].v[i] * a.v[0] + at->row[1].v[i] * a.v[1]) + at->row[2].v[i] * a.v[2]) *
            at->inverse;
    return result;
}

/* C_eb a */
KERNEL vector from_body(const orientation *at, vector a)
{
    vector result;
    for (int i = 0; i < 3; i++)
        result.v[i] =
            ((at->row[i].v[0] * a.v[0] + at->row[i].v[1] * a.v[1]) + at->row[i].v[2] * a.v[2]) *
            at->inverse;
    return result;
}

/* ---- vibration ------------------------------------------------------------------------------- */

/* Sine and cosine of c turns, |c| < 2^49: the nearest quarter is taken off exactly, and the
 * polynomials of elementary.c are taken of the rest. */
KERNEL void sine_cosine_of_turns(real c, real *sine, real *cosine)
{
    const real shifted = 4.0 * c + 0x1.8p52;
    const word quarters = (word)shifted;
    const real r = (c - 0.25 * (shifted - 0x1.8p52)) * 6.283185307179586;
    const real w = r * r;
    real p = w * 1.58968283229245e-10 - 2.5050758660138353e-08;
    p = p * w + 2.755731369527243e-06;
    p = p * w - 0.00019841269829817102;
    p = p * w + 0.008333333333322425;
    p = p * w - 0.16666666666666632;
    const word s = (word)(r + r * w * p);
    p = w * -1.1359669464417574e-11 + 2.087572367640147e-09;
    p = p * w - 2.75573143551828e-07;
    p = p * w + 2.4801587289491637e-05;
    p = p * w - 0.0013888888888874138;
    p = p * w + 0.0416666666666666;
    const word k = (word)(1.0 - (0.5 * w - w * w * p));
    const word odd = -(quarters & 1);
    *sine = (real)(((s & ~odd) | (k & odd)) ^ ((quarters & 2) << 62));
    *cosine = (real)(((k & ~odd) | (s & odd)) ^ (((quarters + 1) & 2) << 62));
}

/* Sine and cosine of |x| < 1 by their series; the next terms are below 1e-19. */
KERNEL void small_sine_cosine(real x, real *sine, real *cosine)
{
    static const double s[] = {-1.0 / 121645100408832000.0,
                               1.0 / 355687428096000.0,
                               -1.0 / 1307674368000.0,
                               1.0 / 6227020800.0,
                               -1.0 / 39916800.0,
                               1.0 / 362880.0,
                               -1.0 / 5040.0,
                               1.0 / 120.0,
                               -1.0 / 6.0};
    static const double c[] = {
        -1.0 / 6402373705728000.0, 1.0 / 20922789888000.0, -1.0 / 87178291200.0, 1.0 / 479001600.0,
        -1.0 / 3628800.0,          1.0 / 40320.0,          -1.0 / 720.0,         1.0 / 24.0};
    const real w = x * x;
    real p = spread(s[0]), k = spread(c[0]);
    for (int i = 1; i < 9; i++)
        p = p * w + s[i];
    for (int i = 1; i < 8; i++)
        k = k * w + c[i];
    *sine = x + x * w * p;
    *cosine = 1.0 - (0.5 * w - w * w * k);
}

static void add_up_lines(const imk_trajectory *trajectory, real time, tremor *shaking)
{
    for (int i = 0; i < 6; i++)
        shaking->value[i] = shaking->rate[i] = shaking->change[i] = spread(0.0);
    for (size_t i = 0; i < trajectory->line_count; i++) {
        const imk_vibration_line line = trajectory->line[i];
        const double frequency = 6.283185307179586 * line.frequency;
        const double rate = line.amplitude * frequency;
        real sine, cosine;
        sine_cosine_of_turns(line.frequency * time + line.phase, &sine, &cosine);
        shaking->value[line.axis] += line.amplitude * sine;
        shaking->rate[line.axis] += rate * cosine;
        shaking->change[line.axis] -= (rate * frequency) * sine;
    }
}

/* Turn forward about one axis, which leads from `second` to `third`. */
KERNEL void turn_about(node *body, const tremor *shaking, int axis)
{
    const int second = (axis + 1) % 3, third = (axis + 2) % 3;
    real sine, cosine;
    small_sine_cosine(shaking->value[3 + axis], &sine, &cosine);
    vector *const turned[] = {&body->rate, &body->acceleration, &body->force};
    for (int i = 0; i < 3; i++) {
        const real a = turned[i]->v[second], b = turned[i]->v[third];
        turned[i]->v[second] = cosine * a + sine * b;
        turned[i]->v[third] = cosine * b - sine * a;
    }
    const real rate = shaking->rate[3 + axis];
    body->acceleration.v[second] += rate * body->rate.v[third];
    body->acceleration.v[third] -= rate * body->rate.v[second];
    body->acceleration.v[axis] += shaking->change[3 + axis];
    body->rate.v[axis] += rate;
    body->rotation.v[axis] = shaking->value[3 + axis];
}

/* ---- one instant ----------------------------------------------------------------------------- */

KERNEL vector gravity_of(const imk_trajectory *trajectory, vector position)
{
    if (!trajectory->earth)
        return zero_vector();
    vector gravity;
    for (int i = 0; i < 3; i++)
        position.v[i] = trajectory->origin[i] + position.v[i];
    gravity_at(position.v, gravity.v);
    return gravity;
}

/* On the smooth trajectory. */
KERNEL vector smooth_gravity(const imk_trajectory *trajectory, const coefficients *from, real s)
{
    return gravity_of(trajectory, position_derivative(from, s, 0));
}

/* `gravity` is NULL unless it is known already. */
KERNEL node node_at(const imk_trajectory *trajectory, bool shaken, const coefficients *from,
                    real time, real s, const vector *gravity)
{
    const double earth_rate = trajectory->earth ? IMK_EARTH_RATE : 0.0;
    const orientation at = orientation_at(from, s);
    node result;
    result.position = position_derivative(from, s, 0);
    result.velocity = position_derivative(from, s, 1);
    result.rotation = zero_vector();
    vector acceleration = position_derivative(from, s, 2);
    acceleration.v[0] -= 2.0 * earth_rate * result.velocity.v[1];
    acceleration.v[1] += 2.0 * earth_rate * result.velocity.v[0];
    const vector earth = scaled(earth_rate * at.inverse, at.row[2]);
    tremor shaking;
    vector shaken_force = zero_vector();
    if (shaken) {
        add_up_lines(trajectory, time, &shaking);
        const vector shift = {{shaking.value[0], shaking.value[1], shaking.value[2]}};
        const vector rate = {{shaking.rate[0], shaking.rate[1], shaking.rate[2]}};
        const vector change = {{shaking.change[0], shaking.change[1], shaking.change[2]}};
        const vector sweep = cross(at.turn, shift), velocity = sum(rate, sweep);
        shaken_force = sum(change, cross(at.turn_change, shift));
        shaken_force = sum(shaken_force, cross(at.turn, sum(rate, velocity)));
        shaken_force = sum(shaken_force, scaled(spread(2.0), cross(earth, velocity)));
        result.position = sum(result.position, from_body(&at, shift));
        result.velocity = sum(result.velocity, from_body(&at, velocity));
    }
    result.gravity = gravity ? *gravity : gravity_of(trajectory, result.position);
    result.force = to_body(&at, difference(acceleration, result.gravity));
    result.rate = sum(at.turn, earth);
    result.acceleration = difference(at.turn_change, cross(at.turn, earth));
    if (shaken) {
        result.force = sum(result.force, shaken_force);
        for (int axis = 0; axis < 3; axis++)
            turn_about(&result, &shaking, axis);
    }
    return result;
}
