/* SPDX-License-Identifier: Apache-2.0 */
/* The tuned gyro sample by sample. A step: read the tilts, filter them, command torques, turn
 * everything that acts into the axes of the shaft, propagate the rotor (tuned_gyro_rotor.c).
 *
 * The rotor follows the rate c when T_x = H c_y and T_y = -H c_x; so the commanded c is the
 * reading, and an error torque T reads as T_y/H about x and -T_x/H about y. */
#include "tuned_gyro_internal.h"

#include <math.h>
#include <string.h>

/* Sources of randomness; fixed for ever. */
enum { TORQUE_NOISE = 0, PICKOFF_NOISE = 2, TORQUE_WANDER = 0 };
enum { ROTOR = IMKI_ROTOR_STATES, FORCES = IMKI_ROTOR_FORCES };

typedef imki_tuned_gyro_state gyro;

double imki_tuned_gyro_step_length(const void *design, const imk_physics_settings *settings)
{
    size_t count;
    double step = 0.0;
    const double longest = settings->level == IMK_LEVEL_SLOW ? 1.0 / settings->rate
                                                             : imki_tuned_gyro_longest_step(design);
    imk_physics_settings own = *settings;
    own.step = 0.0;
    imki_divide_sample(&own, longest, longest, "", &count, &step, NULL);
    return step;
}

static void start_constants(gyro *s, const imk_tuned_gyro *d, const imk_physics_settings *settings)
{
    const double speed = imk_tuned_gyro_speed(d), thermal = imk_thermal_torque(d->hinge_damping);
    const double density = sqrt(thermal * thermal + d->torque.noise * d->torque.noise);
    s->level = settings->level;
    s->captured = d->captured;
    s->rate = settings->rate;
    s->true_momentum = imk_tuned_gyro_momentum(d, speed);
    s->momentum = imk_tuned_gyro_momentum(d, speed / (1.0 + d->speed_error));
    s->turn_cosine = imk_cos(speed * s->step);
    s->turn_sine = imk_sin(speed * s->step);
    s->cosine = 1.0;
    s->limit = d->torquer_limit / s->momentum;
    s->offset[0] = d->pickoff_offset_x;
    s->offset[1] = d->pickoff_offset_y;
    for (int axis = 0; axis < 2; axis++)
        s->last_tilt[axis] = s->offset[axis];
    s->pickoff_range = d->pickoff_range;
    s->axial_moment = d->mass * d->axial_offset;
    s->quadrature_moment = d->mass * d->quadrature_offset;
    s->anisoelastic = d->mass * d->mass * (d->axial_compliance - d->radial_compliance);
    s->residual_spring = imk_tuned_gyro_residual_spring(d);
    s->drag = speed * d->hinge_damping;
    s->speed = speed;
    s->fixed_torque = d->torque.fixed;
    s->torque_temperature = d->torque.temperature;
    s->torque_noise = density / sqrt(s->step);
    s->pickoff_noise = d->pickoff_noise / sqrt(s->step);
    s->torquer_error = d->torquer_error;
    s->torquer_temperature = d->torquer_temperature;
    imki_rotor_start(&s->rotor, d, s->step);
    imki_capture_loop_start(&s->loop, d, s->step);
}

static imk_status divide(gyro *s, const imk_tuned_gyro *d, const imk_physics_settings *settings,
                         imk_error *error)
{
    const bool slow = settings->level == IMK_LEVEL_SLOW;
    const double longest = slow ? 1.0 / settings->rate : imki_tuned_gyro_longest_step(d);
    const imk_status status = imki_divide_sample(
        settings, longest, slow ? (double)INFINITY : 2.0 * imki_tuned_gyro_longest_step(d),
        "at least 8 steps to a turn of the shaft", &s->count, &s->step, error);
    if (status == IMK_OK && !slow && d->captured && !imki_capture_loop_stable(d, s->step))
        return imki_refuse(error, IMK_ERROR_RANGE, "step", s->step, longest,
                           "a shorter step: the loop works once a step");
    return status;
}

imk_status imki_tuned_gyro_init(const void *design, const imk_physics_settings *settings,
                                void *state, imk_error *error)
{
    const imk_tuned_gyro *d = design;
    gyro *s = state;
    imk_status status = divide(s, d, settings, error);
    if (status != IMK_OK)
        return status;
    start_constants(s, d, settings);
    for (int axis = 0; axis < 2; axis++) {
        imki_draws_start(&s->torque_draws[axis], settings, (uint8_t)(TORQUE_NOISE + axis));
        imki_draws_start(&s->pickoff_draws[axis], settings, (uint8_t)(PICKOFF_NOISE + axis));
        imki_wander_start(&s->wander[axis], settings, (uint8_t)(TORQUE_WANDER + axis),
                          d->torque.repeatability, d->torque.instability);
    }
    return IMK_OK;
}

/* ---- what acts ------------------------------------------------------------------------------- */

/* Error torques without noise, as they read: along x and y [N m]. */
static void read_torques(gyro *s, const imk_exposure *e, double torque[2])
{
    const double warmer = e->temperature - IMKI_DESIGN_TEMPERATURE, *f = e->specific_force;
    for (int axis = 0; axis < 2; axis++)
        s->error_torque[axis] =
            s->fixed_torque + s->torque_temperature * warmer + imki_wander_next(&s->wander[axis]);
    torque[0] = s->error_torque[0] - s->axial_moment * f[0] + s->quadrature_moment * f[1] +
                s->anisoelastic * f[2] * f[0];
    torque[1] = s->error_torque[1] - s->axial_moment * f[1] - s->quadrature_moment * f[0] +
                s->anisoelastic * f[1] * f[2];
}

/* ---- full dynamics --------------------------------------------------------------------------- */

static void find_tilt(gyro *s)
{
    s->tilt[0] = s->x[0] * s->cosine - s->x[2] * s->sine;
    s->tilt[1] = s->x[0] * s->sine + s->x[2] * s->cosine;
}

/* The rate that the loop asks for about an axis; the integral waits while the torquer is at its
 * limit. */
static double command(gyro *s, int axis)
{
    const imki_capture_loop *loop = &s->loop;
    double *f = s->filtered[axis];
    const double seen = imki_clamped(s->tilt[axis] + s->offset[axis], s->pickoff_range) +
                        s->pickoff_noise * imki_draw(&s->pickoff_draws[axis]);
    const double f0 = loop->filter[0][0] * f[0] + loop->filter[0][1] * f[1] + loop->input[0] * seen;
    f[1] = loop->filter[1][0] * f[0] + loop->filter[1][1] * f[1] + loop->input[1] * seen;
    f[0] = f0;
    const double integral = s->integral[axis] + loop->step * f0;
    const double wanted = -(loop->proportional * f0 + loop->integral * integral);
    if (fabs(wanted) <= s->limit)
        s->integral[axis] = integral;
    return imki_clamped(wanted, s->limit);
}

/* Components of a vector of the case along axes 1 and 2 of the shaft. */
static void into_shaft(const gyro *s, double x, double y, double v[2])
{
    v[0] = x * s->cosine + y * s->sine;
    v[1] = y * s->cosine - x * s->sine;
}

/* The stops, twice as far as the pickoffs see: a rotor that is there stays behind no further and
 * rests in the case, which in the axes of the shaft is a vector that turns backwards. */
static void meet_stops(gyro *s)
{
    const double size = sqrt(s->tilt[0] * s->tilt[0] + s->tilt[1] * s->tilt[1]);
    const double stop = 2.0 * s->pickoff_range;
    double v[2];
    if (size <= stop)
        return;
    for (int axis = 0; axis < 2; axis++)
        s->tilt[axis] *= stop / size;
    into_shaft(s, s->tilt[0], s->tilt[1], v);
    s->x[0] = v[0];
    s->x[1] = s->speed * v[1];
    s->x[2] = v[1];
    s->x[3] = -s->speed * v[0];
}

static void advance(gyro *s, const imk_exposure *e, const double error[2], double gain)
{
    const double *w = e->angular_rate, *a = e->angular_acceleration;
    double force[FORCES], next[ROTOR], noise[2];
    for (int axis = 0; axis < 2; axis++)
        noise[axis] = s->torque_noise * imki_draw(&s->torque_draws[axis]);
    into_shaft(s, w[0] - w[2] * s->tilt[1], w[1] + w[2] * s->tilt[0], force);
    into_shaft(s, gain * s->command[1] - error[1] - noise[1],
               -gain * s->command[0] + error[0] + noise[0], force + 2);
    into_shaft(s, a[0], a[1], force + 4);
    for (int i = 0; i < ROTOR; i++) {
        next[i] = 0.0;
        for (int j = 0; j < ROTOR; j++)
            next[i] += s->rotor.phi[i][j] * s->x[j];
        for (int j = 0; j < FORCES; j++)
            next[i] += s->rotor.gamma[i][j] * force[j];
    }
    for (int i = 0; i < ROTOR; i++)
        s->x[i] = next[i];
    const double c = s->cosine * s->turn_cosine - s->sine * s->turn_sine;
    const double n = s->sine * s->turn_cosine + s->cosine * s->turn_sine;
    const double grown = 1.5 - 0.5 * (c * c + n * n); /* Newton's step to a length of 1 */
    s->cosine = c * grown;
    s->sine = n * grown;
    find_tilt(s);
    meet_stops(s);
}

static void run_captured(gyro *s, const imk_exposure *e, const double error[2], double *outputs)
{
    const double warmer = e->temperature - IMKI_DESIGN_TEMPERATURE;
    const double gain = s->momentum * (1.0 + s->torquer_error + s->torquer_temperature * warmer);
    double sum[2] = {0.0, 0.0};
    for (size_t i = 0; i < s->count; i++) {
        for (int axis = 0; axis < 2; axis++) {
            s->command[axis] = command(s, axis);
            sum[axis] += s->command[axis];
        }
        advance(s, e, error, gain);
    }
    outputs[0] = sum[0] / (double)s->count;
    outputs[1] = sum[1] / (double)s->count;
}

static void run_free(gyro *s, const imk_exposure *e, const double error[2], double *outputs)
{
    for (size_t i = 0; i < s->count; i++)
        advance(s, e, error, 0.0);
    for (int axis = 0; axis < 2; axis++) {
        const double seen = imki_clamped(s->tilt[axis] + s->offset[axis], s->pickoff_range) +
                            s->pickoff_noise * imki_draw(&s->pickoff_draws[axis]);
        outputs[axis] = (s->last_tilt[axis] - seen) * s->rate;
        s->last_tilt[axis] = seen;
    }
}

/* ---- mean over a turn ------------------------------------------------------------------------ */

static void run_slow(gyro *s, const imk_exposure *e, const double error[2], double *outputs)
{
    const double warmer = e->temperature - IMKI_DESIGN_TEMPERATURE, *w = e->angular_rate;
    const double gain = s->momentum * (1.0 + s->torquer_error + s->torquer_temperature * warmer);
    const double h = s->true_momentum, k = s->residual_spring, drag = s->drag;
    double rate[2]; /* with which the free rotor falls behind */
    if (s->captured)
        for (int axis = 0; axis < 2; axis++)
            s->tilt[axis] = -s->offset[axis];
    const double x = s->tilt[0], y = s->tilt[1];
    rate[0] = w[0] - w[2] * y + (error[0] - k * y + drag * x) / h;
    rate[1] = w[1] + w[2] * x + (error[1] + k * x + drag * y) / h;
    for (int axis = 0; axis < 2; axis++) {
        rate[axis] += s->torque_noise * imki_draw(&s->torque_draws[axis]) / h;
        if (!s->captured)
            s->tilt[axis] =
                imki_clamped(s->tilt[axis] - rate[axis] / s->rate, 2.0 * s->pickoff_range);
        s->command[axis] = imki_clamped(rate[axis] * h / gain, s->limit);
        outputs[axis] = s->captured ? s->command[axis] : rate[axis];
    }
}

void imki_tuned_gyro_step(void *state, const imk_exposure *exposure, double *outputs)
{
    gyro *s = state;
    double error[2];
    read_torques(s, exposure, error);
    if (s->level == IMK_LEVEL_SLOW)
        run_slow(s, exposure, error, outputs);
    else if (s->captured)
        run_captured(s, exposure, error, outputs);
    else
        run_free(s, exposure, error, outputs);
}

void imki_tuned_gyro_observe(const void *state, double *signals)
{
    const gyro *s = state;
    signals[0] = s->tilt[0];
    signals[1] = s->tilt[1];
    signals[2] = s->x[0];
    signals[3] = s->x[2];
    signals[4] = s->command[0];
    signals[5] = s->command[1];
}
