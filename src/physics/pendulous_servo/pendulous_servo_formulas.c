/* SPDX-License-Identifier: Apache-2.0 */
/* The pendulous servo accelerometer by closed forms: what a designer computes, and the error model.
 */
#include "pendulous_servo_internal.h"

#include "base/algebra/linear_system_internal.h"

#include <math.h>

typedef imk_pendulous_servo design_type;

double imk_pendulous_servo_scale(const imk_pendulous_servo *d)
{
    return d->pendulosity / d->torquer_constant;
}

double imk_pendulous_servo_frequency(const imk_pendulous_servo *d)
{
    return sqrt(imki_servo_stiffness(d) / d->inertia) / (2.0 * IMKI_PI);
}

typedef struct complex_number {
    double re, im;
} complex_number;

static double magnitude(complex_number z)
{
    return sqrt(z.re * z.re + z.im * z.im);
}

/* K_c(jw), times jw so that 0 is allowed: (K - J w^2) jw - b w^2 + K_i. */
static complex_number captured_stiffness(const design_type *d, double w)
{
    return (complex_number){d->integral - d->damping * w * w,
                            (imki_servo_stiffness(d) - d->inertia * w * w) * w};
}

double imk_pendulous_servo_gain(const imk_pendulous_servo *d, double frequency)
{
    const double w = 2.0 * IMKI_PI * frequency;
    if (w <= 0.0)
        return d->integral > 0.0 ? 1.0 : d->proportional / imki_servo_stiffness(d);
    const complex_number controller = {d->integral, d->proportional * w};
    return magnitude(controller) / magnitude(captured_stiffness(d, w));
}

double imk_pendulous_servo_bandwidth(const imk_pendulous_servo *d)
{
    const double limit = imk_pendulous_servo_gain(d, 0.0) / sqrt(2.0);
    double low = 0.0, high = imk_pendulous_servo_frequency(d);
    while (imk_pendulous_servo_gain(d, high) > limit)
        high *= 2.0;
    for (int i = 0; i < 100; i++) {
        const double middle = 0.5 * (low + high);
        if (imk_pendulous_servo_gain(d, middle) > limit)
            low = middle;
        else
            high = middle;
    }
    return 0.5 * (low + high);
}

double imk_pendulous_servo_rectification(const imk_pendulous_servo *d, double frequency)
{
    const double w = 2.0 * IMKI_PI * frequency;
    if (w <= 0.0)
        return d->integral > 0.0 ? 0.0 : 0.5 * d->pendulosity / imki_servo_stiffness(d);
    /* 1/K_c = jw/(K_c jw); its real part is w Im(K_c jw)/|K_c jw|^2 */
    const complex_number k = captured_stiffness(d, w);
    return 0.5 * d->pendulosity * w * k.im / (k.re * k.re + k.im * k.im);
}

double imk_pendulous_servo_noise(const imk_pendulous_servo *d)
{
    const double held = d->integral > 0.0 ? 1.0 : d->proportional / imki_servo_stiffness(d);
    const double share = held / (1.0 + d->torquer_error);
    const double brownian = 2.0 * IMKI_BOLTZMANN * d->temperature * d->damping;
    const double pickoff = d->hinge_stiffness * d->pickoff_noise;
    const double readout = d->readout_noise * d->torquer_constant;
    return sqrt(share * share * (brownian + pickoff * pickoff) + readout * readout) /
           d->pendulosity;
}

/* The loop without its output: (phi, phi', z), or (phi, phi') where there is no integral action,
 * under its noise. A step of many time constants gives the stationary covariance. */
double imk_pendulous_servo_reading_noise(const imk_pendulous_servo *d)
{
    const double j = d->inertia, k = imki_servo_stiffness(d), b = d->damping;
    const int n = d->integral > 0.0 ? 3 : 2;
    const double a[9] = {0.0, 1.0, 0.0, -k / j, -b / j, -d->integral / j, 1.0, 0.0, 0.0};
    const double pickoff[3] = {0.0, -d->proportional / j, 1.0};
    const double density = d->pickoff_noise * d->pickoff_noise;
    double system[9], w[9], covariance[9];
    if (b <= 0.0)
        return 0.0; /* nothing holds the noise */
    for (int r = 0; r < n; r++)
        for (int c = 0; c < n; c++) {
            system[r * n + c] = a[r * 3 + c];
            w[r * n + c] = density * pickoff[r] * pickoff[c];
        }
    w[IMKI_SERVO_RATE * n + IMKI_SERVO_RATE] += 2.0 * IMKI_BOLTZMANN * d->temperature * b / (j * j);
    const double slowest = 2.0 * j / b + b / k + (d->integral > 0.0 ? k / d->integral : 0.0);
    imki_step_covariance(n, system, w, 40.0 * slowest, covariance);
    const double variance = j * j * covariance[IMKI_SERVO_RATE * n + IMKI_SERVO_RATE] +
                            2.0 * j * b * covariance[IMKI_SERVO_ANGLE * n + IMKI_SERVO_RATE] +
                            b * b * covariance[IMKI_SERVO_ANGLE * n + IMKI_SERVO_ANGLE];
    return sqrt(variance) / (d->pendulosity * (1.0 + d->torquer_error));
}

/* ---- reduction ------------------------------------------------------------------------------- */

/* Without integral action the pendulum stays deflected by (P f + M)/K, M the hinge's torque, and
 * the torque of the angle is P f_z (P f_x + M)/K - P f_x (P f_x)^2/(2 K^2). `seen`: reading per
 * specific force. */
static void deflected(const design_type *d, double seen, imk_triad *triad)
{
    const double k = imki_servo_stiffness(d), angle = d->pendulosity / k;
    triad->nonlinearity.cross_products.value[0][0] = seen * angle;
    triad->cross_axis.value[0][2] = seen * d->hinge_torque / k;
    triad->nonlinearity.k3.value[0] -= 0.5 * seen * angle * angle;
}

void imki_pendulous_servo_reduce(const imk_pendulous_servo *d, imk_triad *triad)
{
    const double p = d->pendulosity, scale = imk_pendulous_servo_scale(d);
    const double gain = 1.0 / (1.0 + d->torquer_error);
    const double seen =
        gain * (d->integral > 0.0 ? 1.0 : d->proportional / imki_servo_stiffness(d));
    triad->bias.temperature.order = triad->scale_factor.temperature.order = 1;
    triad->scale_factor.fixed.value[0] = seen - 1.0;
    triad->scale_factor.repeatability.value[0] = seen * gain * d->torquer_repeatability;
    triad->scale_factor.temperature.coefficient[0].value[0] = -seen * gain * d->torquer_temperature;
    imki_temperature_range(&triad->bias.temperature, d->temperature);
    imki_temperature_range(&triad->scale_factor.temperature, d->temperature);
    /* i (1 + a i) = M/K_t:  i = M/K_t - a (M/K_t)^2 … */
    triad->nonlinearity.k2.value[0] = -d->torquer_quadratic * seen * seen * scale;
    triad->nonlinearity.k3.value[0] =
        2.0 * d->torquer_quadratic * d->torquer_quadratic * seen * seen * seen * scale * scale;
    if (d->integral <= 0.0)
        deflected(d, seen, triad);
    const double shows =
        imki_reduction_offset(triad, d->hinge_torque / p, d->hinge_torque_temperature / p);
    triad->bias.repeatability.value[0] = shows * d->hinge_torque_repeatability / p;
    triad->noise.bias_instability.value[0] = shows * d->hinge_torque_instability / p;
    triad->misalignment.value[0][1] = seen * d->misalignment_y;
    triad->misalignment.value[0][2] = seen * d->misalignment_z;
    triad->lever_arm.value[0][2] = d->inertia / p;
    triad->noise.white.value[0] = imk_pendulous_servo_noise(d);
    if (d->readout_step > 0.0)
        triad->resolution.value[0] = d->readout_step / scale;
    triad->noise.reading_noise.value[0] = imk_pendulous_servo_reading_noise(d);
    triad->bandwidth.value[0] = imk_pendulous_servo_bandwidth(d);
    triad->damping.value[0] =
        imki_model_damping(d->damping / (2.0 * sqrt(d->inertia * imki_servo_stiffness(d))));
    triad->range.value[0] = d->largest_current / scale;
}
