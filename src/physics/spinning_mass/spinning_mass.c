/* SPDX-License-Identifier: Apache-2.0 */
/* Drifts by torque, and what gyros with a wheel put into the error model. */
#include "spinning_mass_internal.h"

#include <math.h>

double imk_unbalance_drift(double mass, double offset, double momentum)
{
    return mass * offset / momentum;
}

double imk_anisoelastic_drift(double mass, double compliance_difference, double momentum)
{
    return mass * mass * compliance_difference / momentum;
}

double imk_thermal_torque(double damping)
{
    return sqrt(2.0 * IMKI_BOLTZMANN * IMKI_DESIGN_TEMPERATURE * damping);
}

imki_gimbal imki_gimbal_of(double momentum, double inertia, double inertia_difference,
                           const imk_balance *b)
{
    return (imki_gimbal){.momentum = momentum,
                         .inertia = inertia,
                         .inertia_difference = inertia_difference,
                         .moment_x = b->mass * b->offset_input,
                         .moment_z = b->mass * b->offset_spin,
                         .anisoelastic =
                             b->mass * b->mass * (b->compliance_spin - b->compliance_input)};
}

bool imki_inertias_possible(double a, double b, double c)
{
    return a <= b + c && b <= c + a && c <= a + b;
}

void imki_reduce_temperature(double per_kelvin, imk_temperature_polynomial *polynomial)
{
    if (per_kelvin == 0.0)
        return;
    polynomial->order = 1;
    polynomial->coefficient[0].value[0] = per_kelvin;
    polynomial->reference = IMKI_DESIGN_TEMPERATURE;
    polynomial->minimum = 213.15; /* -60 … 100 degC, beyond which no such gyro is stated */
    polynomial->maximum = 373.15;
}

void imki_reduce_scale_temperature(double relative, imk_triad *triad)
{
    const double of_bias = triad->bias.temperature.coefficient[0].value[0];
    imki_reduce_temperature((1.0 + triad->scale_factor.fixed.value[0]) * relative,
                            &triad->scale_factor.temperature);
    imki_reduce_temperature(of_bias + triad->bias.fixed.value[0] * relative,
                            &triad->bias.temperature);
}

void imki_reduce_torques(const imk_error_torque *torque, const imki_gimbal *gimbal,
                         double per_torque, imk_triad *triad)
{
    triad->bias.fixed.value[0] = torque->fixed * per_torque;
    triad->bias.repeatability.value[0] = torque->repeatability * fabs(per_torque);
    triad->noise.bias_instability.value[0] = torque->instability * fabs(per_torque);
    imki_reduce_temperature(torque->temperature * per_torque, &triad->bias.temperature);
    triad->g_sensitivity.value[0][0] = -gimbal->moment_z * per_torque;
    triad->g_sensitivity.value[0][2] = gimbal->moment_x * per_torque;
    triad->g2_sensitivity.value[0][5] = gimbal->anisoelastic * per_torque; /* fz fx */
}

/* ---- a response as a low-pass filter --------------------------------------------------------- */

/* The last crossing of half the power, from above, by bisection of w over 12 octaves about the
 * scale. */
double imki_response_edge(double (*power)(const void *, double), const void *design, double scale)
{
    double high = scale * 4096.0, low = high;
    while (low > scale / 4096.0 && power(design, low) < 0.5) {
        high = low;
        low /= 1.25;
    }
    for (int i = 0; i < 60; i++) {
        const double middle = 0.5 * (low + high);
        if (power(design, middle) < 0.5)
            high = middle;
        else
            low = middle;
    }
    return low;
}

void imki_reduce_response(double (*power)(const void *design, double w), const void *design,
                          double scale, imk_triad *triad)
{
    const double edge = imki_response_edge(power, design, scale);
    double peak = 1.0;
    for (int i = 1; i <= 1000; i++) {
        const double here = power(design, edge * i / 1000.0);
        peak = here > peak ? here : peak;
    }
    /* |G|^2 of second order peaks at 1/(4 z^2 (1 - z^2)) */
    const double z = sqrt(0.5 * (1.0 - sqrt(1.0 - 1.0 / peak)));
    triad->bandwidth.value[0] = edge / (2.0 * IMKI_PI);
    triad->damping.value[0] = z < 0.05 ? 0.05 : z;
}
