/* SPDX-License-Identifier: Apache-2.0 */
/* The spring-restrained rate gyro by closed forms, and its error model. */
#include "rate_gyro_internal.h"

#include <math.h>

imki_gimbal imki_rate_gyro_gimbal(const imk_rate_gyro *d)
{
    return imki_gimbal_of(d->momentum * (1.0 + d->momentum_error), d->output_inertia,
                          d->spin_inertia - d->input_inertia, &d->balance);
}

double imki_rate_gyro_stiffness(const imk_rate_gyro *d)
{
    return d->stiffness * (1.0 + d->stiffness_error);
}

/* ---- closed forms ---------------------------------------------------------------------------- */

double imk_rate_gyro_sensitivity(const imk_rate_gyro *d)
{
    return d->momentum * (1.0 + d->momentum_error) / imki_rate_gyro_stiffness(d);
}

double imk_rate_gyro_natural_frequency(const imk_rate_gyro *d)
{
    return sqrt(imki_rate_gyro_stiffness(d) / d->output_inertia);
}

double imk_rate_gyro_damping_ratio(const imk_rate_gyro *d)
{
    return 0.5 * d->damping / sqrt(imki_rate_gyro_stiffness(d) * d->output_inertia);
}

double imk_rate_gyro_bandwidth(const imk_rate_gyro *d)
{
    const double z = imk_rate_gyro_damping_ratio(d), m = 1.0 - 2.0 * z * z;
    const double root = sqrt(m * m + 1.0);
    const double ratio = m > 0.0 ? m + root : 1.0 / (root - m); /* no cancellation either way */
    return imk_rate_gyro_natural_frequency(d) / (2.0 * IMKI_PI) * sqrt(ratio);
}

double imk_rate_gyro_cubic(const imk_rate_gyro *d)
{
    const double s = imk_rate_gyro_sensitivity(d);
    return (d->spin_inertia - d->input_inertia) / imki_rate_gyro_stiffness(d) - 0.5 * s * s;
}

static double torque_noise(const imk_rate_gyro *d)
{
    const double thermal = imk_thermal_torque(d->damping);
    return sqrt(thermal * thermal + d->torque.noise * d->torque.noise);
}

double imk_rate_gyro_random_walk(const imk_rate_gyro *d)
{
    const double reading = d->stiffness / d->momentum; /* per angle */
    const double torque = torque_noise(d) / imki_rate_gyro_stiffness(d);
    return reading * sqrt(torque * torque + d->pickoff_noise * d->pickoff_noise);
}

/* ---- error model ----------------------------------------------------------------------------- */

void imki_rate_gyro_reduce(const imk_rate_gyro *d, imk_triad *triad)
{
    const imki_gimbal gimbal = imki_rate_gyro_gimbal(d);
    const double reading = d->stiffness / d->momentum; /* per angle [rad/s/rad] */
    const double stiffness = imki_rate_gyro_stiffness(d), per_torque = reading / stiffness;
    const double gain = (1.0 + d->momentum_error) / (1.0 + d->stiffness_error);
    imki_reduce_torques(&d->torque, &gimbal, per_torque, triad);
    triad->scale_factor.fixed.value[0] = gain - 1.0;
    imki_reduce_scale_temperature(-d->stiffness_temperature, triad);
    /* With th0 = M/k the angle is th0 + s w (1 - (th0 + s w)^2/2) + D w^2 (th0 + s w)/k,
     * D = Iz - Ix. */
    const double s = imk_rate_gyro_sensitivity(d), th0 = d->torque.fixed / stiffness;
    triad->cross_axis.value[0][2] = -gain * th0; /* the input axis turns away with the gimbal */
    triad->nonlinearity.k3.value[0] = gain * imk_rate_gyro_cubic(d);
    triad->nonlinearity.k2.value[0] =
        reading * th0 * (gimbal.inertia_difference / stiffness - s * s);
    triad->noise.white.value[0] = imk_rate_gyro_random_walk(d);
    triad->bandwidth.value[0] = imk_rate_gyro_bandwidth(d);
    const double z = imk_rate_gyro_damping_ratio(d);
    triad->damping.value[0] = z < 0.05 ? 0.05 : z > 50.0 ? 50.0 : z;
    triad->range.value[0] = reading * d->stop;
    triad->dead_band.value[0] = d->friction * per_torque;
    triad->resolution.value[0] = reading * d->pickoff_resolution;
}
