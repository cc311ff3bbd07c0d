/* SPDX-License-Identifier: Apache-2.0 */
/* Error model of a shell gyro.
 *
 *     bias     -(D/2k) sin 2(theta - theta_d), leaks of drive and quadrature: the steady state
 *     N^2      kB T (1 - (D tau/2) cos 2(theta - theta_d))/(m w Q k^2 a^2) + 2 n^2/(k a tau)^2
 *     Q        sqrt(2) n/(k a) sqrt(w_b/2) held, sqrt(2) n/(k a sqrt(T)) whole angle
 *     B        of the components of D, /2k
 *
 * n is the pickoff's noise. Its part of N is that of a pattern which is held, and of one that is
 * driven along the direction measured, which errs; a parametric drive has none. Q is the same noise
 * as an error of the angle: behind the loop, of bandwidth w_b/4 Hz, or fitted over an update T. It
 * applies to samples much longer than 1/w_b, or of a whole number of updates (others interpolate,
 * and Q is down to sqrt(2/3) of it).
 *
 * The loop of a held pattern is of first order. Its scale factor is that of amplitude, forcer and
 * frequency; that of a whole-angle gyro is k alone. */
#include "shell_gyro_internal.h"

#include "imukit/elementary.h"

#include <math.h>

/* Reading at rest, or its slope. */
static double reading(const imk_shell_gyro *design, double temperature, double rate)
{
    const imki_shell_balance balance =
        imki_shell_balance_at(design, temperature, rate, design->pattern.angle);
    const double k = imki_shell_assumed_gain(design);
    return design->mode == IMK_SHELL_REBALANCE ? balance.rebalance / k : -balance.precession / k;
}

/* Second-order polynomial through three temperatures: exact for the products of two linear
 * functions that biases are. */
static void temperature_polynomial(imk_temperature_polynomial *polynomial, const double at[3],
                                   double span)
{
    const double first = (at[2] - at[0]) / (2.0 * span);
    const double second = (at[2] - 2.0 * at[1] + at[0]) / (2.0 * span * span);
    polynomial->reference = IMKI_DESIGN_TEMPERATURE;
    polynomial->minimum = -40.0 + 273.15;
    polynomial->maximum = 378.15; /* 105 degC */
    polynomial->coefficient[0].value[0] = first;
    /* rounding of the difference is no term */
    const bool curved = fabs(second) * span > 1e-9 * fabs(first);
    polynomial->coefficient[1].value[0] = curved ? second : 0.0;
    polynomial->order = curved ? 2 : first != 0.0 ? 1 : 0;
}

static void add_temperature(const imk_shell_gyro *design, imk_triad *triad)
{
    const double span = 50.0;
    double bias[3], slope[3];
    for (int i = 0; i < 3; i++) {
        const double temperature = IMKI_DESIGN_TEMPERATURE + span * (i - 1);
        bias[i] = reading(design, temperature, 0.0);
        slope[i] = reading(design, temperature, 1.0) - bias[i];
    }
    triad->bias.fixed.value[0] = bias[1];
    triad->scale_factor.fixed.value[0] = slope[1] - 1.0;
    if (design->resonator.damping_temperature != 0.0 ||
        design->resonator.frequency_temperature != 0.0 || design->forcer.gain_temperature != 0.0) {
        temperature_polynomial(&triad->bias.temperature, bias, span);
        if (design->mode == IMK_SHELL_REBALANCE)
            temperature_polynomial(&triad->scale_factor.temperature, slope, span);
    }
}

static void add_noise(const imk_shell_gyro *design, imk_triad *triad, double gain)
{
    const bool held = design->mode == IMK_SHELL_REBALANCE;
    const bool felt = held || design->forcer.drive == IMK_SHELL_DIRECTIONAL;
    const double decay = 1.0 / imk_shell_gyro_decay_time(design);
    const double k = imk_shell_gyro_modal_gain(design);
    const double thermal = imk_shell_gyro_thermal_random_walk(design, IMKI_DESIGN_TEMPERATURE);
    const double cosine = imk_cos(2.0 * (design->pattern.angle - design->anisotropy.damping_angle));
    const double across = 1.0 - 0.5 * design->anisotropy.damping_difference / decay * cosine;
    const double pickoff = sqrt(2.0) * design->pickoff.noise / (design->pattern.amplitude * k);
    const double white =
        thermal * thermal * across + (felt ? pickoff * pickoff * decay * decay : 0.0);
    const double bandwidth = 2.0 * IMKI_PI * design->control.rebalance_bandwidth;
    triad->noise.white.value[0] = gain * sqrt(white);
    triad->noise.reading_noise.value[0] =
        gain * pickoff * (held ? sqrt(0.5 * bandwidth) : sqrt(1.0 / imki_shell_update(design)));
    triad->noise.bias_instability.value[0] =
        gain * design->anisotropy.damping_instability / (2.0 * k);
    triad->bias.repeatability.value[0] =
        gain * design->anisotropy.damping_repeatability / (2.0 * k);
}

void imki_shell_gyro_reduce(const imk_shell_gyro *design, imk_triad *triad)
{
    add_temperature(design, triad);
    const double gain = 1.0 + triad->scale_factor.fixed.value[0];
    add_noise(design, triad, gain);
    triad->misalignment.value[0][1] = design->package.misalignment_y * gain;
    triad->misalignment.value[0][2] = design->package.misalignment_z * gain;
    if (design->mode == IMK_SHELL_REBALANCE) {
        triad->bandwidth.value[0] = imki_shell_loop_bandwidth(design);
        if (design->forcer.limit > 0.0)
            triad->range.value[0] =
                imki_shell_command_limit(design) / imki_shell_assumed_gain(design);
    }
}
