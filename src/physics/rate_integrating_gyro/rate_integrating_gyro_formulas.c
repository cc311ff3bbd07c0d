/* SPDX-License-Identifier: Apache-2.0 */
/* The floated rate-integrating gyro by closed forms, and its error model. */
#include "rate_integrating_gyro_internal.h"

#include <math.h>

imki_gimbal imki_rate_integrating_gyro_gimbal(const imk_rate_integrating_gyro *d)
{
    return imki_gimbal_of(d->momentum * (1.0 + d->momentum_error), d->output_inertia,
                          d->spin_inertia - d->input_inertia, &d->balance);
}

/* ---- closed forms ---------------------------------------------------------------------------- */

double imk_rate_integrating_gyro_gain(const imk_rate_integrating_gyro *d)
{
    return d->momentum * (1.0 + d->momentum_error) / d->damping;
}

double imk_rate_integrating_gyro_time_constant(const imk_rate_integrating_gyro *d)
{
    return d->output_inertia / d->damping;
}

double imk_rate_integrating_gyro_range(const imk_rate_integrating_gyro *d)
{
    return d->torquer_limit / d->momentum;
}

double imk_rate_integrating_gyro_pulse(const imk_rate_integrating_gyro *d)
{
    return d->torquer_limit / (d->momentum * d->pulse_frequency);
}

void imk_rate_integrating_gyro_loop(const imk_rate_integrating_gyro *d, double *proportional,
                                    double *integral)
{
    const double w = 2.0 * IMKI_PI * d->loop_frequency;
    *proportional = 2.0 * d->loop_damping * w * d->damping;
    *integral = w * w * d->damping;
}

/* What the reading has more than the torques on the float, as a factor. */
static double torquer_gain(const imk_rate_integrating_gyro *d)
{
    return d->rebalance == IMK_REBALANCE_OPEN ? 1.0 : 1.0 / (1.0 + d->torquer_error);
}

double imk_rate_integrating_gyro_random_walk(const imk_rate_integrating_gyro *d)
{
    const double thermal = imk_thermal_torque(d->damping);
    return sqrt(thermal * thermal + d->torque.noise * d->torque.noise) / d->momentum *
           torquer_gain(d);
}

/* ---- error model ----------------------------------------------------------------------------- */

/* |T/(H w)|^2 at the frequency w. */
static double closed_loop_power(const void *design, double w)
{
    const imk_rate_integrating_gyro *d = design;
    double k1, k2;
    imk_rate_integrating_gyro_loop(d, &k1, &k2);
    k1 *= 1.0 + d->torquer_error;
    k2 *= 1.0 + d->torquer_error;
    const double real = k2 - d->damping * w * w;
    const double imaginary = (k1 + d->stiffness - d->output_inertia * w * w) * w;
    return (k2 * k2 + k1 * k1 * w * w) / (real * real + imaginary * imaginary);
}

double imki_rate_integrating_gyro_bandwidth(const imk_rate_integrating_gyro *d)
{
    if (d->rebalance == IMK_REBALANCE_OPEN)
        return 1.0 / (2.0 * IMKI_PI * imk_rate_integrating_gyro_time_constant(d));
    if (d->rebalance != IMK_REBALANCE_ANALOG)
        return 0.0;
    const double scale = 2.0 * IMKI_PI * d->loop_frequency;
    return imki_response_edge(closed_loop_power, d, scale) / (2.0 * IMKI_PI);
}

void imki_rate_integrating_gyro_reduce(const imk_rate_integrating_gyro *d, imk_triad *triad)
{
    const imki_gimbal gimbal = imki_rate_integrating_gyro_gimbal(d);
    const double gain = torquer_gain(d), scale = (1.0 + d->momentum_error) * gain;
    const bool open = d->rebalance == IMK_REBALANCE_OPEN;
    double step = 0.0;
    imki_reduce_torques(&d->torque, &gimbal, gain / d->momentum, triad);
    triad->scale_factor.fixed.value[0] = scale - 1.0;
    if (!open) /* 1/(1 + e + a dT): -a/(1 + e) relative */
        imki_reduce_scale_temperature(-gain * d->torquer_temperature, triad);
    triad->noise.white.value[0] = imk_rate_integrating_gyro_random_walk(d);
    if (open) {
        step = d->pickoff_resolution * d->damping / d->momentum;
        triad->bandwidth.value[0] = imki_rate_integrating_gyro_bandwidth(d);
    } else {
        triad->range.value[0] = imk_rate_integrating_gyro_range(d);
    }
    if (d->rebalance == IMK_REBALANCE_ANALOG)
        imki_reduce_response(closed_loop_power, d, 2.0 * IMKI_PI * d->loop_frequency, triad);
    else if (!open)
        step =
            imk_rate_integrating_gyro_pulse(d) * (d->rebalance == IMK_REBALANCE_BINARY ? 2.0 : 1.0);
    triad->noise.quantization.value[0] = step / sqrt(12.0);
}
