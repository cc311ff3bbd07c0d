/* SPDX-License-Identifier: Apache-2.0 */
/* Pendulous servo accelerometer in motion. The captured pendulum and its controller are linear in
 * the state (phi, phi', z, c), where z integrates the pickoff's reading and c the control torque:
 *
 *     J phi'' = T - b phi' - (K_h + K_p) phi - K_i z - K_p n
 *     z'      = phi + n
 *     c'      = K_p phi + K_i z + K_p n                    mean torque of a step: its change / h
 *
 * What is not linear, P (f_x (cos phi - 1) + f_z sin phi), kicks phi' by half a step before and
 * behind each exact step of the rest. */
#include "pendulous_servo_internal.h"

#include "base/algebra/linear_system_internal.h"
#include "imukit/elementary.h"

#include <math.h>
#include <string.h>

enum {
    STATES = IMKI_SERVO_STATES,
    PHI = IMKI_SERVO_ANGLE,
    OMEGA = IMKI_SERVO_RATE,
    INTEGRAL = IMKI_SERVO_INTEGRAL,
    CONTROL = IMKI_SERVO_CONTROL
};

/* Sources of randomness, fixed for ever. */
enum { SOURCE_LOOP = 0, SOURCE_READOUT = 1 };
enum { WANDER_HINGE = 0, WANDER_TORQUER = 1 };

typedef imk_pendulous_servo design_type;
typedef imki_servo servo;

double imki_servo_step_length(const void *design, const imk_physics_settings *settings)
{
    return settings->level == IMK_LEVEL_SLOW ? 1.0 / settings->rate
                                             : 1.0 / (32.0 * imk_pendulous_servo_frequency(design));
}

static void linear_loop(const design_type *d, double h, servo *s)
{
    const double j = d->inertia, k = imki_servo_stiffness(d);
    const double a[STATES * STATES] = {
        0.0,         1.0, 0.0, 0.0, -k / j, -d->damping / j, -d->integral / j,
        0.0,         1.0, 0.0, 0.0, 0.0,    d->proportional, 0.0,
        d->integral, 0.0};
    const double b[STATES] = {0.0, 1.0 / j, 0.0, 0.0};
    const double pickoff[STATES] = {0.0, -d->proportional / j, 1.0, d->proportional};
    const double brownian = 2.0 * IMKI_BOLTZMANN * d->temperature * d->damping / (j * j);
    const double density = d->pickoff_noise * d->pickoff_noise;
    double w[STATES * STATES];
    for (int i = 0; i < STATES * STATES; i++)
        w[i] = density * pickoff[i / STATES] * pickoff[i % STATES];
    w[OMEGA * STATES + OMEGA] += brownian;
    imki_discretise(STATES, 1, a, b, h, s->phi, s->gamma);
    imki_step_covariance(STATES, a, w, h, s->root);
    imki_covariance_root(STATES, s->root, s->root);
}

imk_status imki_servo_init(const void *design, const imk_physics_settings *settings, void *state,
                           imk_error *error)
{
    servo *s = state;
    const design_type *d = design;
    s->slow = settings->level == IMK_LEVEL_SLOW;
    const double longest = imki_servo_step_length(d, settings);
    imk_status status = imki_divide_sample(
        settings, longest, s->slow ? longest * 1.000001 : 4.0 * longest,
        "at least 8 steps to a cycle of the captured pendulum", &s->steps, &s->h, error);
    if (status != IMK_OK)
        return status;
    s->d = *d;
    linear_loop(d, s->h, s);
    s->readout_deviation = settings->noise ? d->readout_noise * sqrt(settings->rate) : 0.0;
    imki_draws_start(&s->loop, settings, SOURCE_LOOP);
    imki_draws_start(&s->readout, settings, SOURCE_READOUT);
    s->constant_torquer = imki_run_constant(settings, WANDER_TORQUER, d->torquer_repeatability);
    imki_wander_start(&s->hinge, settings, WANDER_HINGE, d->hinge_torque_repeatability,
                      d->hinge_torque_instability);
    return IMK_OK;
}

static double angle_torque(const servo *s, double fx, double fz)
{
    return s->d.pendulosity * (fx * (imk_cos(s->x[PHI]) - 1.0) + fz * imk_sin(s->x[PHI]));
}

/* The linear loop under a torque, and its noise; the control torque of the step. */
static double captured_step(servo *s, double torque)
{
    double next[STATES], normal[STATES];
    for (int i = 0; i < STATES; i++)
        normal[i] = imki_draw(&s->loop);
    for (int i = 0; i < STATES; i++) {
        double sum = s->gamma[i] * torque;
        for (int k = 0; k < STATES; k++)
            sum += s->phi[i * STATES + k] * s->x[k];
        for (int k = 0; k <= i; k++)
            sum += s->root[i * STATES + k] * normal[k];
        next[i] = sum;
    }
    const double mean = next[CONTROL] / s->h;
    memcpy(s->x, next, sizeof next);
    s->x[CONTROL] = 0.0;
    return mean;
}

/* The torquer is at its limit: the pendulum falls under the rest of the torque until a stop holds
 * it, and the integrator waits. Damping and hinge act as they are at the step's middle. */
static double saturated_step(servo *s, double torque, double limit)
{
    const design_type *d = &s->d;
    const double half = 0.5 * s->h;
    s->x[PHI] += half * s->x[OMEGA];
    const double rest = torque - limit - d->hinge_stiffness * s->x[PHI];
    s->x[OMEGA] = (s->x[OMEGA] + s->h * rest / d->inertia) / (1.0 + s->h * d->damping / d->inertia);
    s->x[PHI] += half * s->x[OMEGA];
    return limit;
}

static void hold_at_stop(servo *s)
{
    if (fabs(s->x[PHI]) <= s->d.stop)
        return;
    s->x[PHI] = s->x[PHI] > 0.0 ? s->d.stop : -s->d.stop;
    s->x[OMEGA] = 0.0;
}

/* i of  torque = K_t i (1 + a i), the root that vanishes with the torque. */
static double current_of(const servo *s, double torque, double constant)
{
    const double linear = torque / constant;
    const double under_root = 1.0 + 4.0 * s->d.torquer_quadratic * linear;
    return 2.0 * linear / (1.0 + sqrt(under_root > 0.0 ? under_root : 0.0));
}

static double internal_step(servo *s, double torque, double fx, double fz, double constant)
{
    const design_type *d = &s->d;
    const double demand = d->proportional * s->x[PHI] + d->integral * s->x[INTEGRAL];
    if (!s->slow)
        s->x[OMEGA] += 0.5 * s->h / d->inertia * angle_torque(s, fx, fz);
    const double current = demand > 0.0 ? d->largest_current : -d->largest_current;
    const double limit = constant * current * (1.0 + d->torquer_quadratic * current);
    const double control =
        fabs(demand) < fabs(limit) ? captured_step(s, torque) : saturated_step(s, torque, limit);
    if (!s->slow)
        s->x[OMEGA] += 0.5 * s->h / d->inertia * angle_torque(s, fx, fz);
    hold_at_stop(s);
    return control;
}

void imki_servo_step(void *state, const imk_exposure *exposure, double *outputs)
{
    servo *s = state;
    const design_type *d = &s->d;
    const double *f = exposure->specific_force, *w = exposure->angular_rate;
    const double warm = exposure->temperature - d->temperature;
    const double constant = d->torquer_constant * (1.0 + d->torquer_error + s->constant_torquer +
                                                   d->torquer_temperature * warm);
    const double fx = f[0] + d->misalignment_y * f[1] + d->misalignment_z * f[2];
    const double torque =
        d->pendulosity * fx + d->inertia * (exposure->angular_acceleration[1] + w[0] * w[2]) +
        d->hinge_torque + d->hinge_torque_temperature * warm + imki_wander_next(&s->hinge);
    double sum = 0.0;
    for (size_t i = 0; i < s->steps; i++) {
        s->torque = internal_step(s, torque, fx, f[2], constant);
        s->current = current_of(s, s->torque, constant);
        sum += s->current;
    }
    double mean = sum / (double)s->steps + s->readout_deviation * imki_draw(&s->readout);
    if (!(fabs(mean) <= d->largest_current))
        mean = mean > 0.0 ? d->largest_current : -d->largest_current;
    mean = imki_quantised(mean, d->readout_step);
    outputs[0] = mean / imk_pendulous_servo_scale(d);
    outputs[1] = mean;
}

void imki_servo_observe(const void *state, double *signals)
{
    const servo *s = state;
    signals[0] = s->x[PHI];
    signals[1] = s->torque;
    signals[2] = s->current;
}
