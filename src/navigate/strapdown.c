/* SPDX-License-Identifier: Apache-2.0 */
/* One step of the strapdown mechanisation in Earth-fixed axes.
 *
 * With a and u the increments of angle and velocity over dt, da and du their growth within the
 * step, w the Earth's rate, h = w dt, C and q the attitude at the start:
 *
 *     p  = a + (a x da)/12                                        body's rotation vector, coning
 *     q' = q(-h) q q(p)                                           attitude
 *     c  = (a x du - da x u)/12                                   sculling
 *     F  = R(-h/2) C [mean R(s p) u + c + (p x c)/2]              force
 *     S  = C {[mean (1-s) R(s p) - mean R(s p)/2] u - (du + (p x du)/2)/12}     scrolling
 *     v' - v = F - h x S - h x (h x F)/8 + g dt - h x (v' + v)
 *     r' = r + dt [(v' + v)/2 + S + h x (3 F + 2 g dt)/12]
 *
 * Attitude is exact for a constant rate; the force for a constant rate and force, but for third
 * powers of h. The terms in da and du [SAVAGE1998a, SAVAGE1998b] are made for rates and forces that
 * are parabolas in time: they belong to the middle of the step, so they are turned by half of p,
 * which leaves an error of fourth order in dt. Gravity is that half-way through the step.
 *
 * The terms in h: the Earth turns half-way through the step until the force acts, on the mean
 * (R(-h/2)), for longer for what acts early (h x S), and by varying amounts, h x (h x F)/24.
 * Coriolis acts on the way gone, -2 h x [(v' + v)/2 + b]; b, what this way has besides the
 * trapezium of velocities, is S, the force's turning back with the Earth, h x F/12, and the growth
 * of Coriolis, 2 h x (F + g dt)/12, the last too small to act on the velocity again. At rest S and
 * the rest of b cancel, and so do the terms of the velocity. The equation for v' is linear and
 * solved as it stands. */
#include "strapdown_internal.h"

imk_strapdown imk_strapdown_start(const imk_navigation_state *state)
{
    imk_strapdown strapdown = {.state = *state};
    strapdown.state.attitude = imk_quaternion_normalise(state->attitude);
    strapdown.height = imk_geodetic_from_ecef(state->position).height;
    return strapdown;
}

/* The growth of the increments within the step, dt^2 times the slope of rate and force in its
 * middle, from the parabola that has the means of this sample and the two before; a straight line
 * while only one is known. With d a divided difference of the means over the times between the
 * ends of samples,
 *
 *     slope = 2 [d1 + (d1 - d1_before)/(dt + last + before) (last + dt/2)]                     */
static inline void growth(imk_strapdown *s, double dt, imk_vector3 angle, imk_vector3 velocity,
                          imk_vector3 *angle_growth, imk_vector3 *velocity_growth)
{
    const double last = s->last_step, two = dt + last;
    const double now = 1.0 / (dt * two), before = 1.0 / (last * two);
    const double bend = s->has_slope ? (last + 0.5 * dt) / (two + s->step_before) : 0.0;
    const double square = 2.0 * dt * dt;
    for (int i = 0; i < 3; i++) {
        const double a = now * angle.v[i] - before * s->last_angle.v[i];
        const double u = now * velocity.v[i] - before * s->last_velocity.v[i];
        angle_growth->v[i] = square * (a + bend * (a - s->last_angle_slope.v[i]));
        velocity_growth->v[i] = square * (u + bend * (u - s->last_velocity_slope.v[i]));
        s->last_angle_slope.v[i] = a;
        s->last_velocity_slope.v[i] = u;
    }
    s->step_before = last;
    s->has_slope = true;
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
 * digits, and what rounding takes from the sum is carried on. q/2 (1 - |q|^2) keeps the length. */
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
    add(&q->w, &low->w, b.w + (e * m.z - k * m.w) + length * q->w);
    add(&q->x, &low->x, b.x + (e * m.y - k * m.x) + length * q->x);
    add(&q->y, &low->y, b.y - (e * m.x + k * m.y) + length * q->y);
    add(&q->z, &low->z, b.z - (e * m.w + k * m.z) + length * q->z);
}

/* Back to the height at the start, along the vertical, and no vertical velocity. */
static void slave_height(imk_strapdown *s)
{
    const imk_geodetic place = imk_geodetic_from_ecef(s->state.position);
    const imk_matrix3 axes = imk_ned_axes(place.latitude, place.longitude);
    const imk_vector3 down = {{axes.m[0][2], axes.m[1][2], axes.m[2][2]}};
    const double descent = imki_dot(down, s->state.velocity);
    s->state.velocity = imki_difference(s->state.velocity, imki_scaled(descent, down));
    advance(&s->state.position, &s->position_low, imki_scaled(place.height - s->height, down));
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

static inline body_step integrate_body(imk_vector3 angle, imk_vector3 velocity,
                                       imk_vector3 angle_growth, imk_vector3 velocity_growth)
{
    body_step step;
    const imk_vector3 p = imki_sum(angle, imki_scaled(1.0 / 12, imki_cross(angle, angle_growth)));
    const imki_turn turn = imki_turn_from(p);
    const imk_vector3 pu = imki_cross(p, velocity), ppu = imki_cross(p, pu);
    const imk_vector3 sculling =
        imki_difference(imki_cross(angle, velocity_growth), imki_cross(angle_growth, velocity));
    const imk_vector3 turned_sculling = imki_cross(p, sculling);
    const imk_vector3 turned_growth = imki_cross(p, velocity_growth);
    for (int i = 0; i < 3; i++) {
        step.force.v[i] = velocity.v[i] + turn.first * pu.v[i] + turn.second * ppu.v[i] +
                          (1.0 / 12) * (sculling.v[i] + 0.5 * turned_sculling.v[i]);
        step.scrolling.v[i] = (turn.second - 0.5 * turn.first) * pu.v[i] +
                              (turn.third - 0.5 * turn.second) * ppu.v[i] -
                              (1.0 / 12) * (velocity_growth.v[i] + 0.5 * turned_growth.v[i]);
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
    const imk_vector3 gravity = imki_gravity_midway(state, dt);

    imk_vector3 angle_growth = {{0}}, velocity_growth = {{0}};
    if (strapdown->has_last && !strapdown->simple)
        growth(strapdown, dt, angle, velocity, &angle_growth, &velocity_growth);
    else
        strapdown->has_slope = false;
    const body_step body = integrate_body(angle, velocity, angle_growth, velocity_growth);

    const imki_earth_turn earth = imki_earth_turn_from(dt);
    const imk_vector3 force =
        imki_earth_half_turn(&earth, 1.0, imki_rotated(state->attitude, body.force));
    const imk_vector3 scrolling = imki_rotated(state->attitude, body.scrolling);
    const imk_vector3 fall = imki_scaled(dt, gravity);
    const imk_vector3 turning = imki_earth_turn_of_force(earth.angle, scrolling, force);
    const imk_vector3 gain = imki_sum(imki_sum(force, turning), fall);
    const imk_vector3 mean = mean_velocity(earth.angle, state->velocity, gain);

    turn_attitude(strapdown, &earth, &body.turn, body.rotation);
    const imk_vector3 beside = beside_trapezium(earth.angle, scrolling, force, fall);
    advance(&state->position, &strapdown->position_low, imki_scaled(dt, imki_sum(mean, beside)));
    for (int i = 0; i < 3; i++)
        state->velocity.v[i] = 2.0 * mean.v[i] - state->velocity.v[i];
    state->time += dt;

    strapdown->last_angle = angle;
    strapdown->last_velocity = velocity;
    strapdown->last_step = dt;
    strapdown->has_last = true;
    if (strapdown->hold_height)
        slave_height(strapdown);
}
