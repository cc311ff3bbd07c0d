/* SPDX-License-Identifier: Apache-2.0 */
/* One step of the strapdown mechanisation in Earth-fixed axes.
 *
 * Over the step the rate is (a0 + a1 P1 + a2 P2 + a3 P3)/dt and the force (u0 + u1 P1 + ...)/dt, P
 * Legendre's polynomials on the step, so that a0 and u0 are the increments of angle and velocity.
 * With w the Earth's rate, h = w dt, C and q the attitude at the start, < > a mean over s = 0 ...
 * 1:
 *
 *     p  = a0 + a0 x a1/6 + a1 x a2/30 + a2 x a3/70               body's rotation vector, coning
 *     q' = q(-h) q q(p)                                           attitude
 *     c  = (a0 x u1 - a1 x u0)/6 + (a1 x u2 - a2 x u1)/30 + (a2 x u3 - a3 x u2)/70      sculling
 *     F  = R(-h/2) C [<R(s p)> u0 + c + (p x c)/2]                force
 *     k  = a0 x (u1/6 + u2/15) + a1 x (u3/70 - u1/30) - a2 x (u0/30 + u2/210)
 *          - a3 x (u1/105 + u3/630)
 *     S  = C {[<(1-s) R(s p)> - <R(s p)>/2] u0 - u1/6 - k/2}      scrolling
 *     v' - v = F - h x S - h x (h x F)/8 + g dt - h x (v' + v)
 *     r' = r + dt [(v' + v)/2 + S + h x (3 F + 2 g dt)/12]
 *
 * Attitude is exact for a constant rate; the force for a constant rate and force, but for third
 * powers of h. The rest are the integrals of second order for these polynomials, to the end: of
 * (angle x rate)/2 for coning, of angle x force for sculling, of (1/2 - s) times that for scrolling
 * [SAVAGE1998a, SAVAGE1998b]. What is of third order is left out, but for the turn by half of p
 * into the middle of the step, where c belongs: an error of fourth order in dt. Gravity is that
 * half-way through the step.
 *
 * The terms in h: the Earth turns half-way through the step until the force acts, on the mean
 * (R(-h/2)), for longer for what acts early (h x S), and by varying amounts, h x (h x F)/24.
 * Coriolis acts on the way gone, -2 h x [(v' + v)/2 + b]; b, what this way has besides the
 * trapezium of velocities, is S, the force's turning back with the Earth, h x F/12, and the growth
 * of Coriolis, 2 h x (F + g dt)/12, the last too small to act on the velocity again. At rest S and
 * the rest of b cancel, and so do the terms of the velocity. The equation for v' is linear and
 * solved as it stands. */
#include "strapdown_internal.h"

#include <math.h>

typedef double real;

static inline real square_root(real a)
{
    return sqrt(a);
}

#include "motion/gravity_kernel.h"

imk_strapdown imk_strapdown_start(const imk_navigation_state *state)
{
    imk_strapdown strapdown = {.state = *state};
    strapdown.state.attitude = imk_quaternion_normalise(state->attitude);
    strapdown.height = imk_geodetic_from_ecef(state->position).height;
    strapdown.samples = 3;
    return strapdown;
}

/* Rate and force over the step, times dt: coefficients of Legendre's polynomials of order 1 to 3.
 * Those of order 0 are the increments. */
typedef struct growth {
    imk_vector3 angle[4], velocity[4];
    int order; /* of the highest that is not zero */
} growth;

/* Weights of the divided differences of first to third order in the coefficients. The integral of
 * the rate is known at the ends of the samples, at dt, 0, -last, ...; Newton's polynomial through
 * these points has, with y the time from the middle of the step, l = last + dt/2 and
 * m = l + before, the derivative
 *
 *     mean + 2 d1 y + d2 (3 y^2 + 2 l y - dt^2/4) + d3 [4 y^3 + 3 (l + m) y^2 + ...]
 *          = mean + dt [d1 + l d2 + (l m + dt^2/20) d3] P1 + dt^2/2 [d2 + (l + m) d3] P2
 *            + dt^3/5 d3 P3                                                              */
typedef struct growth_weights {
    double now, before;      /* first difference: of this increment and the one before */
    double second, third;    /* of differences in the next higher one */
    double p1[3], p2[2], p3; /* of the three differences */
} growth_weights;

static inline growth_weights weights_of(const imk_strapdown *s, double dt, int order)
{
    const double last = s->last_step, two = dt + last;
    growth_weights w = {.now = 1.0 / (dt * two), .before = 1.0 / (last * two)};
    w.p1[0] = dt * dt;
    if (order > 1) {
        const double three = two + s->step_before[0], l = last + 0.5 * dt;
        w.second = 1.0 / three;
        w.p1[1] = dt * dt * l;
        w.p2[0] = 0.5 * dt * dt * dt;
        if (order > 2) {
            const double m = l + s->step_before[0], square = dt * dt;
            w.third = 1.0 / (three + s->step_before[1]);
            w.p1[2] = square * (l * m + (1.0 / 20) * square);
            w.p2[1] = w.p2[0] * (l + m);
            w.p3 = (1.0 / 5) * square * square;
        }
    }
    return w;
}

/* One axis: differences of this sample in place of those of the last, and the coefficients. */
static inline void grow(const growth_weights *w, double now, double last, double *first,
                        double *second, imk_vector3 out[4], int axis)
{
    const double d1 = w->now * now - w->before * last;
    const double d2 = w->second * (d1 - *first), d3 = w->third * (d2 - *second);
    *first = d1;
    *second = d2;
    out[1].v[axis] = w->p1[0] * d1 + w->p1[1] * d2 + w->p1[2] * d3;
    out[2].v[axis] = w->p2[0] * d2 + w->p2[1] * d3;
    out[3].v[axis] = w->p3 * d3;
}

/* How the rate and the force change within the step, from the samples before as far as they are
 * known and wanted. */
static inline void growth_within(imk_strapdown *s, double dt, imk_vector3 angle,
                                 imk_vector3 velocity, growth *g)
{
    const int known = s->has_last ? s->differences + 1 : 0;
    const int order = s->samples - 1 < known ? s->samples - 1 : known;
    g->order = order;
    g->angle[0] = angle;
    g->velocity[0] = velocity;
    if (order > 0) {
        const growth_weights w = weights_of(s, dt, order);
        for (int i = 0; i < 3; i++) {
            grow(&w, angle.v[i], s->last_angle.v[i], &s->angle_difference[0].v[i],
                 &s->angle_difference[1].v[i], g->angle, i);
            grow(&w, velocity.v[i], s->last_velocity.v[i], &s->velocity_difference[0].v[i],
                 &s->velocity_difference[1].v[i], g->velocity, i);
        }
    } else
        for (int k = 1; k < 4; k++)
            g->angle[k] = g->velocity[k] = (imk_vector3){{0.0, 0.0, 0.0}};
    s->differences = order < 1 ? 0 : order < 2 ? order : 2;
    s->step_before[1] = s->step_before[0];
    s->step_before[0] = s->last_step;
    s->last_angle = angle;
    s->last_velocity = velocity;
    s->last_step = dt;
    s->has_last = true;
}

/* The v' that solves v' + h x v' = v - h x v + gain, h along the axis of the Earth: with
 * m = (v + v')/2,  m + h x m = v + gain/2. */
static inline imk_vector3 mean_velocity(double h, imk_vector3 v, imk_vector3 gain)
{
    const double x = v.v[0] + 0.5 * gain.v[0], y = v.v[1] + 0.5 * gain.v[1];
    const double scale = 1.0 / (1.0 + h * h);
    return (imk_vector3){{scale * (x + h * y), scale * (y - h * x), v.v[2] + 0.5 * gain.v[2]}};
}

/* sum += step, what is lost to rounding carried to the next step [HIGHAM2002, alg. 4.2]. */
static inline void add(double *sum, double *low, double step)
{
    const double all = step + *low, next = *sum + all;
    *low = all - (next - *sum);
    *sum = next;
}

static inline void advance(imk_vector3 *position, imk_vector3 *low, imk_vector3 step)
{
    for (int i = 0; i < 3; i++)
        add(&position->v[i], &low->v[i], step.v[i]);
}

/* q' = q(-h) q q(p), as q + [q (q(p) - 1)] + (q(-h) - 1) [...]: what changes is small and keeps its
 * digits, and what rounding takes from the sum is carried on. m/2 (1 - |q|^2), m being q turned by
 * the body, keeps the length. */
static inline void turn_attitude(imk_strapdown *s, const imki_earth_turn *earth,
                                 const imki_turn *turn, imk_vector3 p)
{
    imk_quaternion *q = &s->state.attitude, *low = &s->attitude_low;
    const imk_quaternion body = {-turn->cosine_to_one, turn->half_sine * p.v[0],
                                 turn->half_sine * p.v[1], turn->half_sine * p.v[2]};
    const imk_quaternion b = imki_quaternion_product(*q, body);
    const imk_quaternion m = {q->w + b.w, q->x + b.x, q->y + b.y, q->z + b.z};
    const double k = earth->cosine_to_one, e = earth->sine;
    const double length = 0.5 * (1.0 - (q->w * q->w + q->x * q->x + q->y * q->y + q->z * q->z));
    add(&q->w, &low->w, b.w + (e * m.z - k * m.w) + length * m.w);
    add(&q->x, &low->x, b.x + (e * m.y - k * m.x) + length * m.x);
    add(&q->y, &low->y, b.y - (e * m.x + k * m.y) + length * m.y);
    add(&q->z, &low->z, b.z - (e * m.w + k * m.z) + length * m.z);
}

/* To the height that is held, along the vertical, with the climb that is held. */
static inline void slave_height(imk_strapdown *s)
{
    const double x = s->state.position.v[0], y = s->state.position.v[1];
    const double z = s->state.position.v[2], pp = x * x + y * y;
    const slope vertical = vertical_at(pp, z);
    const imk_vector3 up = {{vertical.k * x, vertical.k * y, vertical.s}};
    const double climb = s->climb - imki_dot3(up.v, s->state.velocity.v);
    s->state.velocity = imki_sum(s->state.velocity, imki_scaled(climb, up));
    const double rise = s->height - height_along(vertical, pp, z);
    advance(&s->state.position, &s->position_low, imki_scaled(rise, up));
}

/* S + h x (3 F + 2 g dt)/12 */
static inline imk_vector3 beside_trapezium(double h, imk_vector3 scrolling, imk_vector3 force,
                                           imk_vector3 fall)
{
    const double x = 3.0 * force.v[0] + 2.0 * fall.v[0], y = 3.0 * force.v[1] + 2.0 * fall.v[1];
    const double k = h * (1.0 / 12);
    return (imk_vector3){{scrolling.v[0] - k * y, scrolling.v[1] + k * x, scrolling.v[2]}};
}

/* The integrals over a step in body axes at its start. */
typedef struct body_step {
    imki_turn turn;
    imk_vector3 rotation, force, scrolling;
} body_step;

/* weight a + other b */
static inline imk_vector3 blend(double weight, imk_vector3 a, double other, imk_vector3 b)
{
    return imki_sum(imki_scaled(weight, a), imki_scaled(other, b));
}

/* The integrals of second order of a polynomial rate and force: coning, sculling c, and the k of
 * scrolling. */
static inline void second_order(const growth *g, imk_vector3 *coning, imk_vector3 *sculling,
                                imk_vector3 *scrolling)
{
    const imk_vector3 *a = g->angle, *u = g->velocity;
    *coning = imki_cross(a[1], blend(1.0 / 30, a[2], -1.0 / 6, a[0]));
    *sculling = imki_sum(imki_scaled(1.0 / 6, imki_cross(a[0], u[1])),
                         imki_cross(a[1], blend(1.0 / 30, u[2], -1.0 / 6, u[0])));
    *scrolling = imki_cross(a[0], blend(1.0 / 6, u[1], 1.0 / 15, u[2]));
    if (g->order > 1) {
        *sculling = imki_difference(*sculling, imki_scaled(1.0 / 30, imki_cross(a[2], u[1])));
        *scrolling =
            imki_difference(*scrolling, imki_cross(a[2], blend(1.0 / 30, u[0], 1.0 / 210, u[2])));
    }
    *scrolling = imki_difference(*scrolling, imki_scaled(1.0 / 30, imki_cross(a[1], u[1])));
    if (g->order > 2) {
        *coning = imki_sum(*coning, imki_scaled(1.0 / 70, imki_cross(a[2], a[3])));
        *sculling = imki_sum(
            *sculling,
            imki_scaled(1.0 / 70, imki_difference(imki_cross(a[2], u[3]), imki_cross(a[3], u[2]))));
        const imk_vector3 late = imki_scaled(1.0 / 70, imki_cross(a[1], u[3]));
        *scrolling = imki_sum(
            *scrolling,
            imki_difference(late, imki_cross(a[3], blend(1.0 / 105, u[1], 1.0 / 630, u[3]))));
    }
}

static inline body_step integrate_body(const growth *g)
{
    body_step step;
    imk_vector3 coning = {{0}}, sculling = {{0}}, scrolling = {{0}};
    const imk_vector3 velocity = g->velocity[0];
    if (g->order > 0)
        second_order(g, &coning, &sculling, &scrolling);
    const imk_vector3 p = imki_sum(g->angle[0], coning);
    const imki_turn turn = imki_turn_from(p);
    const imk_vector3 pu = imki_cross(p, velocity), ppu = imki_cross(p, pu);
    const imk_vector3 turned_sculling = imki_cross(p, sculling);
    for (int i = 0; i < 3; i++) {
        step.force.v[i] = velocity.v[i] + turn.first * pu.v[i] + turn.second * ppu.v[i] +
                          (sculling.v[i] + 0.5 * turned_sculling.v[i]);
        step.scrolling.v[i] = (turn.second - 0.5 * turn.first) * pu.v[i] +
                              (turn.third - 0.5 * turn.second) * ppu.v[i] -
                              ((1.0 / 6) * g->velocity[1].v[i] + 0.5 * scrolling.v[i]);
    }
    step.rotation = p;
    step.turn = turn;
    return step;
}

void imk_strapdown_step(imk_strapdown *strapdown, double dt, imk_vector3 angle,
                        imk_vector3 velocity)
{
    imk_navigation_state *state = &strapdown->state;
    /* First, since everything up to its use can be computed while its square roots are. */
    const imk_vector3 midway = imki_sum(state->position, imki_scaled(0.5 * dt, state->velocity));
    imk_vector3 gravity;
    gravity_at(midway.v, gravity.v);

    growth within;
    growth_within(strapdown, dt, angle, velocity, &within);
    const body_step body = integrate_body(&within);

    const imki_earth_turn earth = imki_earth_turn_from(dt);
    const imk_vector3 force =
        imki_earth_half_turn(&earth, 1.0, imki_rotated(state->attitude, body.force));
    const imk_vector3 scrolling = imki_rotated(state->attitude, body.scrolling);
    const imk_vector3 fall = imki_scaled(dt, gravity);
    const imk_vector3 turning = imki_earth_turn_of_force(earth.angle, scrolling, force);
    const imk_vector3 gain = imki_sum(imki_sum(force, turning), fall);
    const imk_vector3 mean = mean_velocity(earth.angle, state->velocity, gain);

    const imk_vector3 beside = beside_trapezium(earth.angle, scrolling, force, fall);
    advance(&state->position, &strapdown->position_low, imki_scaled(dt, imki_sum(mean, beside)));
    for (int i = 0; i < 3; i++)
        state->velocity.v[i] = 2.0 * mean.v[i] - state->velocity.v[i];
    state->time += dt;
    if (strapdown->hold_height)
        slave_height(strapdown);
    /* Last, since the next step's gravity does not wait for it. */
    turn_attitude(strapdown, &earth, &body.turn, body.rotation);
}
