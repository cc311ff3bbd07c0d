/* SPDX-License-Identifier: Apache-2.0 */
/* The electrostatically suspended gyro in motion.
 *
 * In inertial space the angular momentum H s turns with the torques, dH s/dt = M, and the axis of
 * figure goes round it at H/A on a cone whose angle dies away: exactly, as a free symmetric body
 * does. Torques are slow against that (the cone that a constant torque makes has the angle
 * M A/H^2, 1e-12 rad), so the axis of figure is carried along with s, and what depends on it
 * is averaged over its turns: harmonic n of the shape is weakened by P_n(cos cone).
 *
 * A step is half of the torque's turn, the turn of the case, the other half. s and the direction n
 * across it, from which the phase of the cone counts, are kept in case axes; every turn is a
 * rotation of both, so nothing but rounding changes |s| = 1. */
#include "suspended_rotor_internal.h"

#include "base/algebra/vector_internal.h"
#include "imukit/elementary.h"
#include "imukit/units.h"

#include <math.h>

/* The error of a step goes with the square of the turn of the case within it, times the drift. */
#define LONGEST_STEP 0.01
#define STEP_LIMIT 0.1

double imki_suspended_step_length(const void *design, const imk_physics_settings *settings)
{
    const double sample = 1.0 / settings->rate;
    (void)design;
    return sample < LONGEST_STEP ? sample : LONGEST_STEP;
}

/* The readout sees the axis of figure. */
static void read_axis(imki_suspended_state *state, double reading[3])
{
    const double *s = state->axis, *n = state->across;
    const double sine = imk_sin(state->cone), cosine = imk_cos(state->cone);
    const double phase = 2.0 * IMKI_PI * state->turns;
    const double first = sine * imk_cos(phase), second = sine * imk_sin(phase);
    for (int k = 0; k < 3; k++) {
        const int l = (k + 1) % 3, m = (k + 2) % 3;
        const double figure = cosine * s[k] + first * n[k] + second * (s[l] * n[m] - s[m] * n[l]);
        const double noise =
            state->reading_noise > 0.0 ? state->reading_noise * imki_draw(&state->readout[k]) : 0.0;
        reading[k] = imki_quantised(figure + noise, state->resolution);
    }
}

/* A direction across s: the case axis that is farthest from s, less its part along s. */
static void choose_across(const double s[3], double n[3])
{
    const int k = fabs(s[0]) <= fabs(s[1]) && fabs(s[0]) <= fabs(s[2]) ? 0
                  : fabs(s[1]) <= fabs(s[2])                           ? 1
                                                                       : 2;
    const double length = sqrt(1.0 - s[k] * s[k]);
    for (int i = 0; i < 3; i++)
        n[i] = ((i == k ? 1.0 : 0.0) - s[k] * s[i]) / length;
}

static void start_random(const imk_suspended_rotor *design, const imk_physics_settings *settings,
                         imki_suspended_state *state)
{
    for (int k = 0; k < 3; k++) {
        imki_draws_start(&state->white[k], settings, (uint8_t)(IMKI_SUSPENDED_ROTOR_TORQUE + k));
        imki_draws_start(&state->readout[k], settings, (uint8_t)(IMKI_SUSPENDED_ROTOR_READING + k));
        imki_wander_start(&state->error[k], settings, (uint8_t)(IMKI_SUSPENDED_ROTOR_TORQUE + k),
                          design->torque_repeatability, design->torque_instability);
    }
    state->torque_sigma = settings->noise ? design->torque_noise / sqrt(state->step) : 0.0;
    state->reading_noise = settings->noise ? design->readout_noise : 0.0;
}

imk_status imki_suspended_init(const void *given, const imk_physics_settings *settings,
                               void *memory, imk_error *error)
{
    const imk_suspended_rotor *design = given;
    imki_suspended_state *state = memory;
    size_t steps = 0;
    double step = 0.0;
    imk_status status =
        imki_divide_sample(settings, LONGEST_STEP, STEP_LIMIT,
                           "at most 0.1 s: the case turns between steps", &steps, &step, error);
    if (status != IMK_OK)
        return status;
    const bool full = settings->level == IMK_LEVEL_FULL;
    *state = (imki_suspended_state){
        .cone = full ? design->start_wobble : 0.0,
        .decay = imk_exp(-step / design->wobble_time),
        .turns_per_step = imk_suspended_rotor_wobble(design) * step,
        .momentum = imk_suspended_rotor_momentum(design),
        .initial_momentum = imk_suspended_rotor_momentum(design),
        .spin_rate = design->spin_rate,
        .radius = 0.5 * design->diameter,
        .ball = imki_suspended_ball_of(design),
        .cavity = imki_suspended_cavity_of(design),
        .sample = 1.0 / settings->rate,
        .step = step,
        .steps = steps,
        .level = settings->level,
        .torque_temperature = design->torque_temperature,
        .resolution = design->readout_resolution,
    };
    for (int k = 0; k < 3; k++)
        state->torque[k] = design->torque[k];
    imki_suspended_start(design, state->axis);
    choose_across(state->axis, state->across);
    start_random(design, settings, state);
    read_axis(state, state->reading);
    return IMK_OK;
}

/* ---- motion ---------------------------------------------------------------------------------- */

/* v turned by the rotation vector angle n (Rodrigues), given sin and 1 - cos of the angle. */
static void turn(double v[3], const double n[3], double sine, double versed)
{
    const double along = imki_dot3(n, v);
    double next[3];
    for (int k = 0; k < 3; k++) {
        const int l = (k + 1) % 3, m = (k + 2) % 3;
        next[k] = v[k] + sine * (n[l] * v[m] - n[m] * v[l]) - versed * (v[k] - along * n[k]);
    }
    for (int k = 0; k < 3; k++)
        v[k] = next[k];
}

static void turn_both(imki_suspended_state *state, const double rotation[3])
{
    const double angle = imki_norm3(rotation);
    double n[3];
    if (!(angle > 0.0))
        return;
    for (int k = 0; k < 3; k++)
        n[k] = rotation[k] / angle;
    const double sine = imk_sin(angle), half = imk_sin(0.5 * angle);
    turn(state->axis, n, sine, 2.0 * half * half);
    turn(state->across, n, sine, 2.0 * half * half);
}

/* ds/dt = (s x grad G + M)/H turns s by the rotation vector s x ds/dt h
 *
 *     s x (s x grad G) + s x M = s (s.g) - g + s x M */
static void turn_by_torque(imki_suspended_state *state, const double force[3],
                           const double torque[3], double h)
{
    const double x = imk_cos(state->cone), *s = state->axis;
    const double weak[3] = {x, 1.5 * x * x - 0.5, x * (2.5 * x * x - 1.5)};
    double g[3], rotation[3];
    imki_suspended_gradient(&state->ball, weak, s, force, g);
    const double along = imki_dot3(s, g);
    for (int k = 0; k < 3; k++) {
        const int l = (k + 1) % 3, m = (k + 2) % 3;
        rotation[k] =
            h * state->ball.per_h * (s[k] * along - g[k] + (s[l] * torque[m] - s[m] * torque[l]));
    }
    turn_both(state, rotation);
}

/* Rounding grows as a random walk: bring |s| back to 1 and n across it. */
static void straighten(imki_suspended_state *state)
{
    double *s = state->axis, *n = state->across;
    const double length = imki_norm3(s);
    double along = 0.0, square = 0.0;
    for (int k = 0; k < 3; k++) {
        s[k] /= length;
        along += s[k] * n[k];
    }
    for (int k = 0; k < 3; k++) {
        n[k] -= along * s[k];
        square += n[k] * n[k];
    }
    for (int k = 0; k < 3; k++)
        n[k] /= sqrt(square);
}

/* The ball that has lost its spin stands still in the case: below this part of H. */
#define STOPPED 1e-6

/* Friction takes of H what is across the contact's normal n: with the impulse J
 *
 *     H s += -friction radius J (s - n (s.n))/|s - n (s.n)|
 *
 * and leaves the rest, which turns about n without sliding. */
static void drag(imki_suspended_state *state, const imki_suspended_push *push)
{
    double *s = state->axis, after[3], rotation[3], across = 0.0;
    const double along = imki_dot3(s, push->normal);
    for (int k = 0; k < 3; k++) {
        after[k] = s[k] - along * push->normal[k];
        across += after[k] * after[k];
    }
    across = sqrt(across);
    state->contact += push->impulse / state->sample;
    const double lost = state->cavity.friction * state->radius * push->impulse;
    if (!(lost > 0.0 && across > 0.0 && state->momentum > 0.0))
        return;
    const double left = fmax(0.0, 1.0 - lost / (state->momentum * across));
    for (int k = 0; k < 3; k++)
        after[k] = left * after[k] + along * push->normal[k];
    const double length = imki_norm3(after);
    state->momentum *= length;
    if (!(state->momentum > STOPPED * state->initial_momentum)) {
        state->momentum = 0.0;
        return;
    }
    state->ball.per_h = 1.0 / state->momentum;
    imki_cross3(s, after, rotation);
    const double sine = imki_norm3(rotation), angle = imk_atan2(sine, imki_dot3(s, after));
    for (int k = 0; k < 3; k++)
        rotation[k] *= sine > 0.0 ? angle / sine : 0.0;
    turn_both(state, rotation);
}

/* The ball beyond what the suspension carries, and until it is back. */
static void fall(imki_suspended_state *state, const double force[3], double begin)
{
    static const double none[3] = {0.0, 0.0, 0.0};
    imki_suspended_cavity *cavity = &state->cavity;
    if (state->level == IMK_LEVEL_SLOW) {
        const imki_suspended_push push = imki_suspended_rest(cavity, force, state->step, begin);
        drag(state, &push);
        return;
    }
    const size_t count = imki_suspended_steps(cavity, force, state->step);
    const double h = state->step / (double)count;
    for (size_t i = 0; i < count && !imki_suspended_held(cavity, force); i++) {
        const imki_suspended_push push =
            imki_suspended_move(cavity, force, state->momentum > 0.0 ? state->axis : none, h,
                                begin + (double)(i + 1) * h);
        if (push.impulse > 0.0)
            drag(state, &push);
    }
}

/* A torque turns a ball that spins; the case turns round one that spins, and takes along one that
 * does not. */
static void turn_step(imki_suspended_state *state, const double carried[3], const double acting[3],
                      const double turned[3])
{
    const double h = state->step;
    if (!(state->momentum > 0.0))
        return;
    turn_by_torque(state, carried, acting, 0.5 * h);
    turn_both(state, turned);
    turn_by_torque(state, carried, acting, 0.5 * h);
    if (state->level == IMK_LEVEL_FULL) {
        state->cone *= state->decay;
        state->turns += state->turns_per_step * (state->momentum / state->initial_momentum);
        state->turns -= floor(state->turns);
    }
}

/* The force that the electrodes carry, or all that they can. */
static void carry(const imki_suspended_state *state, const double force[3], double carried[3])
{
    for (int k = 0; k < 3; k++)
        carried[k] = imki_clamped(force[k], state->cavity.limit);
}

static void advance(imki_suspended_state *state, const imk_exposure *exposure,
                    const double torque[3])
{
    const double h = state->step, *force = exposure->specific_force;
    const double begin = (double)state->samples * state->sample;
    double carried[3];
    carry(state, force, carried);
    state->contact = 0.0;
    for (size_t i = 0; i < state->steps; i++) {
        const double time = ((double)i + 0.5) * h - 0.5 * state->sample;
        double turned[3], acting[3];
        for (int k = 0; k < 3; k++) {
            turned[k] = -h * (exposure->angular_rate[k] + time * exposure->angular_acceleration[k]);
            acting[k] = torque[k];
            if (state->torque_sigma > 0.0)
                acting[k] += state->torque_sigma * imki_draw(&state->white[k]);
        }
        turn_step(state, carried, acting, turned);
        if (!imki_suspended_held(&state->cavity, force))
            fall(state, force, begin + (double)i * h);
    }
    state->samples++;
    straighten(state);
}

static void find_drift(imki_suspended_state *state, const double force[3])
{
    static const double whole[3] = {1.0, 1.0, 1.0};
    const double *s = state->axis;
    double g[3], square = 0.0;
    imki_suspended_gradient(&state->ball, whole, s, force, g);
    for (int k = 0; k < 3; k++) {
        const int l = (k + 1) % 3, m = (k + 2) % 3;
        const double across = s[l] * g[m] - s[m] * g[l];
        square += across * across;
    }
    state->drift = state->momentum > 0.0 ? sqrt(square) * state->ball.per_h : 0.0;
}

/* -(s0 x s1)/|s0 x s1| angle(s0, s1)/dt. The readings need not be of unit length. */
static void rate_of(const double before[3], const double now[3], double dt, double rate[3])
{
    double square = 0.0;
    for (int k = 0; k < 3; k++) {
        const int l = (k + 1) % 3, m = (k + 2) % 3;
        rate[k] = before[l] * now[m] - before[m] * now[l];
        square += rate[k] * rate[k];
    }
    const double sine = sqrt(square);
    const double cosine = imki_dot3(before, now);
    const double factor = sine > 0.0 ? -imk_atan2(sine, cosine) / (sine * dt) : 0.0;
    for (int k = 0; k < 3; k++)
        rate[k] *= factor;
}

void imki_suspended_step(void *memory, const imk_exposure *exposure, double *out)
{
    imki_suspended_state *state = memory;
    const double thermal =
        state->torque_temperature * (exposure->temperature - IMKI_DESIGN_TEMPERATURE);
    double torque[3], reading[3], rate[3], carried[3];
    for (int k = 0; k < 3; k++)
        torque[k] = state->torque[k] + thermal + imki_wander_next(&state->error[k]);
    advance(state, exposure, torque);
    carry(state, exposure->specific_force, carried);
    find_drift(state, carried);
    read_axis(state, reading);
    rate_of(state->reading, reading, state->sample, rate);
    out[0] = rate[0];
    out[1] = rate[1];
    for (int k = 0; k < 3; k++)
        out[2 + k] = state->reading[k] = reading[k];
}

void imki_suspended_observe(const void *memory, double *values)
{
    const imki_suspended_state *state = memory;
    for (int k = 0; k < 3; k++)
        values[IMKI_SUSPENDED_AXIS_X + k] = state->axis[k];
    values[IMKI_SUSPENDED_DRIFT] = state->drift;
    values[IMKI_SUSPENDED_WOBBLE] = state->cone;
    values[IMKI_SUSPENDED_FALLEN] = state->cavity.touched ? 1.0 : 0.0;
    for (int k = 0; k < 3; k++)
        values[IMKI_SUSPENDED_DISPLACEMENT_X + k] = state->cavity.x[k];
    values[IMKI_SUSPENDED_CONTACT] = state->contact;
    values[IMKI_SUSPENDED_SPIN] = state->spin_rate * (state->momentum / state->initial_momentum);
}

bool imki_suspended_happened(const void *memory, imk_instrument_event *event)
{
    const imki_suspended_cavity *cavity = &((const imki_suspended_state *)memory)->cavity;
    if (!cavity->touched)
        return false;
    *event = (imk_instrument_event){
        .code = "physics:touched",
        .name = cavity->axis,
        .count = 6,
        .number = {cavity->time, cavity->force, cavity->force / IMK_STANDARD_GRAVITY, cavity->limit,
                   cavity->limit / IMK_STANDARD_GRAVITY, cavity->speed},
    };
    return true;
}
