/* SPDX-License-Identifier: Apache-2.0 */
/* Slow dynamics of a shell gyro: the averaged equations with the loops for amplitude, quadrature
 * and phase in their steady state, one step to a sample.
 *
 * Force to rebalance, w_b the bandwidth of the loop: the reading r and the pickoff's noise e behind
 * the same filter obey
 *
 *     r' = w_b (bias + gain W - r) + w_b N white,     e' = -w_b e + w_b sqrt(2) n/(a k) white
 *     reading = mean over the sample of  r + e/tau + e'
 *
 * solved exactly with their integrals: two normals each for a sample.
 *
 * Whole angle:
 *
 *     theta' = -k W + d(theta) + k N white,   d = d0 + d2 cos 2 theta + e2 sin 2 theta + (4 theta)
 *
 * N of Brownian motion and, where electrodes push along the measured direction, of its error: the
 * drive turns the pattern to that at 1/tau. d by the steady state of the loops at eight angles.
 * Over a step h it is averaged along theta_0 - k W s, exactly for the rate, and corrected by h d
 * d'/2 for the turn by d itself; what is left out is a part (D h)^2/6 of d. The reading is the
 * difference of measured angles, distorted and noisy as the pickoff's are. */
#include "base/algebra/linear_system_internal.h"
#include "imukit/elementary.h"
#include "shell_gyro_internal.h"

#include <math.h>
#include <string.h>

static double bandwidth(const imk_shell_gyro *design)
{
    return 2.0 * IMKI_PI * design->control.rebalance_bandwidth;
}

/* One step of  x' = -w x + w white,  X = integral of x, from the covariance of (x, X): the root
 * (l00, l10, l11). */
static void lag_root(double w, double h, double root[3])
{
    const double a[4] = {-w, 0.0, 1.0, 0.0}, density[4] = {w * w, 0.0, 0.0, 0.0};
    double q[4];
    imki_step_covariance(2, a, density, h, q);
    imki_covariance_root(2, q, q);
    root[0] = q[0];
    root[1] = q[2];
    root[2] = q[3];
}

static void follow_temperature(imki_shell_state *state, double temperature)
{
    imki_shell_slow *slow = &state->slow;
    const imk_shell_gyro *design = &state->design;
    const imki_shell_resonator r = imki_shell_resonator_at(design, temperature);
    double at[8];
    slow->temperature = temperature;
    slow->thermal =
        sqrt(temperature / IMKI_DESIGN_TEMPERATURE * r.decay * imk_shell_gyro_decay_time(design));
    if (design->mode == IMK_SHELL_REBALANCE) {
        const double angle = design->pattern.angle;
        const double still = imki_shell_balance_at(design, temperature, 0.0, angle).rebalance;
        const double moving = imki_shell_balance_at(design, temperature, 1.0, angle).rebalance;
        slow->bias = still / state->assumed;
        slow->gain = (moving - still) / state->assumed;
        return;
    }
    /* by the actual angle: the balance is asked at a measured one, the small difference is that of
     * a direction and of what a direction is seen as */
    memset(slow->drift, 0, sizeof slow->drift);
    for (int i = 0; i < 8; i++) {
        const double wanted = IMKI_PI / 8.0 * i;
        double angle = wanted;
        imki_shell_balance balance = imki_shell_balance_at(design, temperature, 0.0, angle);
        for (int round = 0; round < 4; round++) { /* gains a factor of the error each */
            angle += wanted - balance.actual;
            balance = imki_shell_balance_at(design, temperature, 0.0, angle);
        }
        at[i] = balance.precession;
    }
    for (int i = 0; i < 8; i++) {
        const double two = IMKI_PI / 4.0 * i, four = IMKI_PI / 2.0 * i;
        slow->drift[0] += at[i] / 8.0;
        slow->drift[1] += at[i] / 4.0 * imk_cos(two);
        slow->drift[2] += at[i] / 4.0 * imk_sin(two);
        slow->drift[3] += at[i] / 4.0 * imk_cos(four);
        slow->drift[4] += at[i] / 4.0 * imk_sin(four);
    }
}

/* Noise across the pattern, of that at D = 0: damping and Brownian force belong together. */
static double across_noise(const imk_shell_gyro *design)
{
    const double ratio = 0.5 * design->anisotropy.damping_difference *
                         imk_shell_gyro_decay_time(design) *
                         imk_cos(2.0 * (design->pattern.angle - design->anisotropy.damping_angle));
    return sqrt(1.0 - ratio);
}

static void set_double_angle(imki_shell_slow *slow)
{
    slow->double_cosine = imk_cos(2.0 * slow->angle);
    slow->double_sine = imk_sin(2.0 * slow->angle);
}

void imki_shell_slow_start(imki_shell_state *state)
{
    imki_shell_slow *slow = &state->slow;
    const imk_shell_gyro *design = &state->design;
    const double h = state->sample / (double)slow->count;
    const double thermal = imk_shell_gyro_thermal_random_walk(design, IMKI_DESIGN_TEMPERATURE);
    const double pickoff =
        sqrt(2.0) * design->pickoff.noise / (design->pattern.amplitude * state->gain);
    follow_temperature(state, IMKI_DESIGN_TEMPERATURE);
    slow->reading = slow->bias;
    slow->angle =
        imki_shell_balance_at(design, IMKI_DESIGN_TEMPERATURE, 0.0, design->pattern.angle).actual;
    slow->last = design->pattern.angle;
    set_double_angle(slow);
    if (design->mode == IMK_SHELL_REBALANCE) {
        const double w = bandwidth(design);
        slow->fade = imk_exp(-w * h);
        slow->fade_integral = -imk_expm1(-w * h) / w;
        slow->decay = state->decay;
        lag_root(w, h, slow->thermal_root);
        for (int i = 0; i < 3; i++) {
            slow->pickoff_root[i] = slow->thermal_root[i] * pickoff;
            slow->thermal_root[i] *= thermal * across_noise(design);
        }
    } else {
        const double pointing =
            design->forcer.drive == IMK_SHELL_DIRECTIONAL ? pickoff * state->decay : 0.0;
        slow->thermal_angle = thermal * state->gain * sqrt(state->sample);
        slow->pointing_angle = pointing * state->gain * sqrt(state->sample);
        slow->angle_noise = imki_shell_angle_noise(design);
    }
}

static double rebalance_step(imki_shell_state *state, double rate, double h)
{
    imki_shell_slow *slow = &state->slow;
    const double e = slow->fade, f = slow->fade_integral;
    const double n0 = imki_draw(&state->thermal) * slow->thermal;
    const double n1 = imki_draw(&state->thermal) * slow->thermal;
    const double p0 = imki_draw(&state->pickoff), p1 = imki_draw(&state->pickoff);
    const double *t = slow->thermal_root, *p = slow->pickoff_root;
    const double wander =
        0.5 / state->assumed *
        (state->damping[1] * slow->double_cosine - state->damping[0] * slow->double_sine);
    const double target = slow->bias + slow->gain * rate + wander;
    const double before = slow->reading - target, noise = slow->noise;
    const double integral = target * h + before * f + t[1] * n0 + t[2] * n1;
    const double noise_integral = noise * f + p[1] * p0 + p[2] * p1;
    slow->reading = target + before * e + t[0] * n0;
    slow->noise = noise * e + p[0] * p0;
    return integral + noise_integral * slow->decay + (slow->noise - noise);
}

/* sin x/x and cos x for |x| <= 1/2, to 1e-13 */
static double sine_ratio(double x)
{
    const double y = x * x;
    return 1.0 + y * (-1.0 / 6.0 + y * (1.0 / 120.0 + y * (-1.0 / 5040.0 +
                                                           y * (1.0 / 362880.0 - y / 39916800.0))));
}

static double short_cosine(double x)
{
    const double y = x * x;
    return 1.0 + y * (-1.0 / 2.0 +
                      y * (1.0 / 24.0 + y * (-1.0 / 720.0 + y * (1.0 / 40320.0 - y / 3628800.0))));
}

/* double_cosine and double_sine are of the angle at the beginning; those of the middle follow. */
static void whole_angle_step(imki_shell_state *state, double rate, double h)
{
    imki_shell_slow *slow = &state->slow;
    const double turn = state->gain * rate * h;
    const double two = sine_ratio(turn), four = sine_ratio(2.0 * turn);
    const double tc = short_cosine(turn), ts = turn * two;
    const double c = slow->double_cosine * tc + slow->double_sine * ts;
    const double s = slow->double_sine * tc - slow->double_cosine * ts;
    const double dc = slow->drift[1] - 0.5 * state->damping[1];
    const double ds = slow->drift[2] + 0.5 * state->damping[0];
    const double drift = slow->drift[0] + two * (dc * c + ds * s) +
                         four * (slow->drift[3] * (c * c - s * s) + slow->drift[4] * 2.0 * c * s);
    const double slope = 2.0 * two * (ds * c - dc * s); /* dd/dtheta; (4 theta) is far smaller */
    slow->angle += drift * h * (1.0 + 0.5 * h * slope) - turn;
}

/* Direction that the pickoff gives the pattern. With G its matrix and u the direction,
 * u x G u and u . G u are functions of twice the angle; their ratio is the tangent of the error. */
static double seen_angle(const imki_shell_state *state)
{
    const imki_shell_slow *slow = &state->slow;
    const imki_shell_axes g = state->pickoff_axes;
    const double mean = 0.5 * (g.xx + g.yy), half = 0.5 * (g.xx - g.yy);
    const double t = (g.xy * slow->double_cosine - half * slow->double_sine) /
                     (mean + half * slow->double_cosine + g.xy * slow->double_sine);
    if (fabs(t) > 0.03)
        return slow->angle + imk_atan2(t, 1.0);
    const double y = t * t; /* to 1e-15 */
    return slow->angle +
           t * (1.0 + y * (-1.0 / 3.0 + y * (1.0 / 5.0 + y * (-1.0 / 7.0 + y / 9.0))));
}

void imki_shell_slow_step(imki_shell_state *state, const imk_exposure *exposure, double *outputs)
{
    imki_shell_slow *slow = &state->slow;
    const imk_shell_gyro *design = &state->design;
    const double rate = imki_shell_input(design, exposure->angular_rate);
    const double turn = fabs(state->gain * rate) * state->sample;
    for (int i = 0; i < 2; i++)
        state->damping[i] = imki_wander_next(&state->wander[i]);
    if (exposure->temperature != slow->temperature)
        follow_temperature(state, exposure->temperature);
    if (design->mode == IMK_SHELL_REBALANCE) {
        const double limit = state->limit / state->assumed;
        double integral = 0.0;
        for (size_t i = 0; i < slow->count; i++)
            integral += rebalance_step(state, rate, state->sample / (double)slow->count);
        outputs[0] = imki_clamped(integral / state->sample, limit);
        outputs[1] = design->pattern.angle / design->resonator.mode_number;
        return;
    }
    /* at most a quarter of a radian at a time */
    const size_t count = slow->count + (size_t)(4.0 * turn);
    for (size_t i = 0; i < count; i++) {
        whole_angle_step(state, rate, state->sample / (double)count);
        if (i + 1 == count)
            slow->angle += slow->thermal_angle * slow->thermal * imki_draw(&state->thermal) +
                           slow->pointing_angle * imki_draw(&state->pickoff);
        set_double_angle(slow);
    }
    const double angle = seen_angle(state) + slow->angle_noise * imki_draw(&state->pickoff);
    outputs[0] = (slow->last - angle) / (state->assumed * state->sample);
    outputs[1] = angle / design->resonator.mode_number;
    slow->last = angle;
}
