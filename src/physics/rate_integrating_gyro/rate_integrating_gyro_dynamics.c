/* SPDX-License-Identifier: Apache-2.0 */
/* The motion of a float in its liquid and its loop. With x = (th, th', Z, integral of Z),
 * Z = integral of (th + n), n the error of the pickoff, the analog loop
 *
 *     I th'' + C th' + k th + K1 (th + n) + K2 Z = N(th)
 *
 * is linear but for N, and exact between the ends of a step; its torque over a step is
 * K1 times the change of Z plus K2 times the change of the integral of Z. A torquer at its limit,
 * and the pulses, are a constant torque on the float without a loop, Z at rest. N is taken at both
 * ends of the step, as in rate_gyro_dynamics.c.
 *
 * Pulses: C th + I th' = H (angle of the case - angle of the pulses) when nothing else acts, so
 * that a logic that looks at th + (I/C) th' leaves an angle within half a pulse uncounted. */
#include "rate_integrating_gyro_internal.h"

#include "base/algebra/linear_system_internal.h"

#include <math.h>
#include <string.h>

/* Sources of randomness; fixed for ever. */
enum { TORQUE_NOISE = 0, PICKOFF_NOISE = 1, TORQUE_WANDER = 0 };
enum { N = IMKI_FLOAT_STATES, M = IMKI_FLOAT_INPUTS, ITERATIONS = 2 };

typedef imki_rate_integrating_gyro_state gyro;

/* Of the analog loop: its step must follow the rise of the torque to the limit; of the open float:
 * nothing but the torque's weak dependence on the angle is not exact. */
static const double steps_per_cycle = 100.0, fewest_steps = 10.0;

static bool is_pulsed(imk_rebalance rebalance)
{
    return rebalance == IMK_REBALANCE_TERNARY || rebalance == IMK_REBALANCE_BINARY;
}

static double cycle(const imk_rate_integrating_gyro *d)
{
    if (is_pulsed(d->rebalance))
        return steps_per_cycle / d->pulse_frequency;
    if (d->rebalance == IMK_REBALANCE_ANALOG)
        return 1.0 / d->loop_frequency;
    return steps_per_cycle * imk_rate_integrating_gyro_time_constant(d);
}

static double longest_step(const imk_rate_integrating_gyro *d, const imk_physics_settings *settings)
{
    return settings->level == IMK_LEVEL_SLOW ? 1.0 / settings->rate : cycle(d) / steps_per_cycle;
}

double imki_rate_integrating_gyro_step_length(const void *design,
                                              const imk_physics_settings *settings)
{
    size_t count;
    double step = 0.0;
    const double longest = longest_step(design, settings);
    imk_physics_settings own = *settings;
    own.step = 0.0;
    imki_divide_sample(&own, longest, longest, "", &count, &step, NULL);
    return step;
}

/* Steps, whole pulses in a sample and whole steps in a pulse. */
static imk_status divide(gyro *s, const imk_rate_integrating_gyro *d,
                         const imk_physics_settings *settings, imk_error *error)
{
    const double longest = longest_step(d, settings);
    const bool slow = settings->level == IMK_LEVEL_SLOW, pulsed = is_pulsed(d->rebalance);
    const double limit = slow     ? (double)INFINITY
                         : pulsed ? longest * (1.0 + 1e-9)
                                  : cycle(d) / fewest_steps;
    const imk_status status =
        imki_divide_sample(settings, longest, limit,
                           pulsed ? "at least one step to a pulse"
                                  : "at least 10 steps to a cycle of the loop, or a tenth of I/C",
                           &s->count, &s->step, error);
    if (status != IMK_OK || slow || !pulsed)
        return status;
    const double pulses = d->pulse_frequency / settings->rate;
    const double whole = floor(pulses + 0.5);
    if (!(whole >= 1.0 && fabs(pulses - whole) <= 1e-9 * whole))
        return imki_refuse(error, IMK_ERROR_RANGE, "rate", settings->rate, d->pulse_frequency,
                           "a whole number of torquer pulses to a sample");
    const double parts = ceil((double)s->count / whole * (1.0 - 1e-9));
    s->steps_per_pulse = (size_t)parts;
    s->count = s->steps_per_pulse * (size_t)whole;
    s->step = 1.0 / (settings->rate * (double)s->count);
    return IMK_OK;
}

/* The float over a step; k1 and k2 of the loop are 0 without it. */
static void start_float(imki_float_step *f, const gyro *s, double k1, double k2, bool integrates,
                        double density)
{
    const double inertia = s->inertia, on = integrates ? 1.0 : 0.0;
    const double a[N * N] = {0.0,
                             1.0,
                             0.0,
                             0.0,
                             -(s->stiffness + k1) / inertia,
                             -s->damping / inertia,
                             -k2 / inertia,
                             0.0,
                             on,
                             0.0,
                             0.0,
                             0.0,
                             0.0,
                             0.0,
                             1.0,
                             0.0};
    const double b[N * M] = {0.0, 0.0, 1.0 / inertia, -k1 / inertia, 0.0, on, 0.0, 0.0};
    const double w[N * N] = {[N + 1] = density / (inertia * inertia)};
    imki_discretise(N, M, a, b, s->step, f->phi, f->gamma);
    imki_step_covariance(N, a, w, s->step, f->root);
    imki_covariance_root(N, f->root, f->root);
}

static void start_constants(gyro *s, const imk_rate_integrating_gyro *d,
                            const imk_physics_settings *settings)
{
    const double thermal = imk_thermal_torque(d->damping);
    const double density = thermal * thermal + d->torque.noise * d->torque.noise;
    s->level = settings->level;
    s->rebalance = d->rebalance;
    s->rate = settings->rate;
    s->gimbal = imki_rate_integrating_gyro_gimbal(d);
    s->momentum = d->momentum;
    s->inertia = d->output_inertia;
    s->damping = d->damping;
    s->stiffness = d->stiffness;
    s->stop = d->stop;
    s->fixed_torque = d->torque.fixed;
    s->torque_temperature = d->torque.temperature;
    s->torque_sigma = sqrt(density * settings->rate);
    s->pickoff_sigma = settings->noise ? d->pickoff_noise / sqrt(s->step) : 0.0;
    s->pickoff_resolution = d->pickoff_resolution;
    s->limit = d->torquer_limit;
    s->torquer_error = d->torquer_error;
    s->torquer_temperature = d->torquer_temperature;
    s->lead = d->pulse_lead;
    s->pulse_angle = imk_rate_integrating_gyro_pulse(d);
    s->threshold = 0.5 * s->pulse_angle * d->momentum / d->damping;
    if (d->rebalance == IMK_REBALANCE_ANALOG)
        imk_rate_integrating_gyro_loop(d, &s->proportional, &s->integral);
    /* The loop is discretised at the design temperature; torquer_temperature acts on its torque as
     * a correction in advance(). */
    const double gain = 1.0 + s->torquer_error;
    start_float(&s->closed, s, s->proportional * gain, s->integral * gain, true, density);
    start_float(&s->open, s, 0.0, 0.0, false, density);
}

imk_status imki_rate_integrating_gyro_init(const void *design, const imk_physics_settings *settings,
                                           void *state, imk_error *error)
{
    const imk_rate_integrating_gyro *d = design;
    gyro *s = state;
    imk_status status = divide(s, d, settings, error);
    if (status != IMK_OK)
        return status;
    start_constants(s, d, settings);
    imki_draws_start(&s->torque_draws, settings, TORQUE_NOISE);
    imki_draws_start(&s->pickoff_draws, settings, PICKOFF_NOISE);
    imki_wander_start(&s->wander, settings, TORQUE_WANDER, d->torque.repeatability,
                      d->torque.instability);
    return IMK_OK;
}

/* ---- full dynamics --------------------------------------------------------------------------- */

static void propagate(const gyro *s, const imki_float_step *f, double torque, double pickoff,
                      double next[N])
{
    for (int i = 0; i < N; i++) {
        next[i] = f->gamma[M * i] * torque + f->gamma[M * i + 1] * pickoff;
        for (int j = 0; j < N; j++)
            next[i] += f->phi[N * i + j] * s->x[j];
    }
}

/* One step under the constant torque `held` on top of what the angle decides. */
static void advance(gyro *s, const imki_float_step *f, const imk_exposure *exposure, double held,
                    double pickoff)
{
    double next[N], draw[N];
    const double first = imki_gimbal_torque(&s->gimbal, exposure, s->x[0]);
    propagate(s, f, first + held, pickoff, next);
    for (int i = 0; i < ITERATIONS; i++)
        propagate(s, f, 0.5 * (first + imki_gimbal_torque(&s->gimbal, exposure, next[0])) + held,
                  pickoff, next);
    for (int i = 0; i < N; i++)
        draw[i] = imki_draw(&s->torque_draws);
    for (int i = 0; i < N; i++) {
        s->x[i] = next[i];
        for (int j = 0; j <= i; j++)
            s->x[i] += f->root[N * i + j] * draw[j];
    }
    if (fabs(s->x[0]) > s->stop) {
        s->x[0] = s->x[0] > 0.0 ? s->stop : -s->stop;
        s->x[1] = 0.0;
    }
}

/* Reading of a sample in the analog loop: mean of the commanded torque over H. */
static double run_analog(gyro *s, const imk_exposure *exposure)
{
    double impulse = 0.0;
    const double change = s->torquer_gain - (1.0 + s->torquer_error); /* by temperature */
    for (size_t i = 0; i < s->count; i++) {
        const double pickoff = s->pickoff_sigma * imki_draw(&s->pickoff_draws);
        const double wanted = s->proportional * (s->x[0] + pickoff) + s->integral * s->x[2];
        if (fabs(wanted) <= s->limit) {
            const double z = s->x[2];
            s->x[3] = 0.0;
            s->torque = wanted;
            advance(s, &s->closed, exposure, s->error_torque - change * wanted, pickoff);
            impulse += s->proportional * (s->x[2] - z) + s->integral * s->x[3];
        } else {
            s->torque = wanted > 0.0 ? s->limit : -s->limit;
            advance(s, &s->open, exposure, s->error_torque - s->torquer_gain * s->torque, 0.0);
            impulse += s->torque * s->step;
        }
    }
    return impulse * s->rate / s->momentum;
}

/* The pulse that the logic asks for: -1, 0, 1. */
static int pulse_of(const gyro *s, double seen)
{
    if (s->rebalance == IMK_REBALANCE_BINARY)
        return seen < 0.0 ? -1 : 1;
    return seen > s->threshold ? 1 : seen < -s->threshold ? -1 : 0;
}

static double run_pulsed(gyro *s, const imk_exposure *exposure)
{
    long sum = 0;
    for (size_t done = 0; done < s->count; done += s->steps_per_pulse) {
        const double error = s->pickoff_sigma * imki_draw(&s->pickoff_draws);
        const int pulse = pulse_of(s, s->x[0] + s->lead * s->x[1] + error);
        sum += pulse;
        s->torque = pulse * s->limit;
        for (size_t i = 0; i < s->steps_per_pulse; i++)
            advance(s, &s->open, exposure, s->error_torque - s->torquer_gain * s->torque, 0.0);
    }
    return (double)sum * s->pulse_angle * s->rate;
}

/* The pickoff as it is read: with its noise, in steps. */
static double read_angle(gyro *s)
{
    const double th = s->x[0] + s->pickoff_sigma * imki_draw(&s->pickoff_draws);
    return imki_quantised(th, s->pickoff_resolution);
}

static double change_of_angle(gyro *s)
{
    const double angle = read_angle(s), change = angle - s->last_angle;
    s->last_angle = angle;
    return change * s->damping / s->momentum * s->rate;
}

static double run_open(gyro *s, const imk_exposure *exposure)
{
    for (size_t i = 0; i < s->count; i++)
        advance(s, &s->open, exposure, s->error_torque, 0.0);
    return change_of_angle(s);
}

/* ---- without inertia and delay --------------------------------------------------------------- */

static double run_slow(gyro *s, const imk_exposure *exposure)
{
    const double noise = s->torque_sigma * imki_draw(&s->torque_draws);
    const double range = s->limit / s->momentum;
    const double torque =
        imki_gimbal_torque(&s->gimbal, exposure, s->x[0]) + s->error_torque + noise;
    if (s->rebalance == IMK_REBALANCE_OPEN) {
        s->x[0] += (torque - s->stiffness * s->x[0]) / (s->damping * s->rate);
        s->x[0] = s->x[0] > s->stop ? s->stop : s->x[0] < -s->stop ? -s->stop : s->x[0];
        return change_of_angle(s);
    }
    double rate = torque / (s->momentum * s->torquer_gain);
    rate = rate > range ? range : rate < -range ? -range : rate;
    s->torque = rate * s->momentum;
    if (s->rebalance == IMK_REBALANCE_ANALOG)
        return rate;
    const double unit = s->pulse_angle * (s->rebalance == IMK_REBALANCE_BINARY ? 2.0 : 1.0);
    s->carried += rate / s->rate;
    const double counted = unit * floor(s->carried / unit + 0.5);
    s->carried -= counted;
    return counted * s->rate;
}

void imki_rate_integrating_gyro_step(void *state, const imk_exposure *exposure, double *outputs)
{
    gyro *s = state;
    const double warmer = exposure->temperature - IMKI_DESIGN_TEMPERATURE;
    s->error_torque =
        s->fixed_torque + s->torque_temperature * warmer + imki_wander_next(&s->wander);
    s->torquer_gain = 1.0 + s->torquer_error + s->torquer_temperature * warmer;
    if (s->level == IMK_LEVEL_SLOW)
        outputs[0] = run_slow(s, exposure);
    else if (s->rebalance == IMK_REBALANCE_OPEN)
        outputs[0] = run_open(s, exposure);
    else if (s->rebalance == IMK_REBALANCE_ANALOG)
        outputs[0] = run_analog(s, exposure);
    else
        outputs[0] = run_pulsed(s, exposure);
}

void imki_rate_integrating_gyro_observe(const void *state, double *signals)
{
    const gyro *s = state;
    signals[0] = s->x[0];
    signals[1] = s->x[1];
    signals[2] = s->error_torque;
    signals[3] = s->torque;
    signals[4] = (s->damping * s->x[0] + s->inertia * s->x[1]) / s->momentum;
}
