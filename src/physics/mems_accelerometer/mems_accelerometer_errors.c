/* SPDX-License-Identifier: Apache-2.0 */
/* What a MEMS accelerometer reads wrong at rest, and its white noise.
 *
 * Open loop: a1 x + a2 x^2 + a3 x^3 = -a is turned round, with u = -a/a1,
 *
 *     x = u - (a2/a1) u^2 + (2 (a2/a1)^2 - a3/a1) u^3
 *
 * and the reading is -a1 (x + p2 x^2 + p3 x^3). Analog loop with its mass held at the null:
 * a = b1 u + b2 u^2 read as b1 u. */
#include "mems_accelerometer_internal.h"

#include <math.h>

static double square(double x)
{
    return x * x;
}

/* Force of the plates, Taylor coefficients 0 … 3 of c [(V - u)^2 P(z) - (V + u)^2 M(z)] at the
 * operating point along the line u = u_0 + a x + b x^2 + c x^3 in `line`. */
static void force_along(const imk_mems_accelerometer *d, const imki_mems_point *p,
                        const double line[4], double force[4])
{
    const double c = 0.5 * IMKI_PERMITTIVITY * d->area / d->mass;
    const double near = 1.0 / (d->gap - p->z), far = -1.0 / (d->gap + p->z);
    double squares[2][4] = {{0.0}}, plates[2][4];
    for (int i = 0; i < 4; i++)
        for (int j = 0; i + j < 4; j++)
            for (int side = 0; side < 2; side++) {
                const double sign = side == 0 ? -1.0 : 1.0;
                squares[side][i + j] += ((i == 0 ? d->voltage : 0.0) + sign * line[i]) *
                                        ((j == 0 ? d->voltage : 0.0) + sign * line[j]);
            }
    plates[0][0] = near * near;
    plates[1][0] = far * far;
    for (int k = 1; k < 4; k++) { /* 1/(g - z)^2 = sum of (k + 1) x^k/g^(k + 2) */
        plates[0][k] = plates[0][k - 1] * near * (k + 1.0) / k;
        plates[1][k] = plates[1][k - 1] * far * (k + 1.0) / k;
    }
    for (int k = 0; k < 4; k++) {
        force[k] = 0.0;
        for (int j = 0; j <= k; j++)
            force[k] += c * (squares[0][j] * plates[0][k - j] - squares[1][j] * plates[1][k - j]);
    }
}

/* Analog loop without integral part: the mass leaves the null, u = u_0 - (kp/b1) (x + p2 x^2 + p3
 * x^3), and the forces of plates and springs along that line balance the input,
 * f = g1 x + g2 x^2 + g3 x^3, which is turned round; the reading is -kp (x + p2 x^2 + p3 x^3). */
static void deflected_loop(const imk_mems_accelerometer *d, const imki_mems_point *p,
                           imki_mems_static *e)
{
    const imki_series spring = imki_mems_spring(d, p->spring);
    const double kp = imk_mems_accelerometer_gains(d).proportional;
    const double p2 = p->pickoff.second / p->pickoff.first;
    const double p3 = p->pickoff.third / p->pickoff.first;
    const double per_voltage = -kp / p->b1;
    const double line[4] = {p->control, per_voltage, per_voltage * p2, per_voltage * p3};
    double force[4];
    force_along(d, p, line, force);
    const double g1 = force[1] - spring.first, g2 = (force[2] - spring.second) / g1;
    const double g3 = (force[3] - spring.third) / g1;
    const double seen = -kp / g1, soft = spring.first - p->a1; /* electrostatic */
    e->scale = seen - 1.0;
    e->k2 = seen * (p2 - g2) / g1;
    e->k3 = seen * (p3 - 2.0 * p2 * g2 + 2.0 * g2 * g2 - g3) / square(g1);
    /* seen = kp/(a1 + kp), of which the voltages' parts grow by 2 g and the springs' by s */
    e->scale_temperature =
        seen * (spring.first * d->spring_temperature + 2.0 * (kp - soft) * d->voltage_temperature) /
        g1;
}

imki_mems_static imki_mems_static_errors(const imk_mems_accelerometer *d, const imki_mems_point *p)
{
    const imki_series spring = imki_mems_spring(d, p->spring);
    imki_mems_static e = {
        .scale_temperature = -2.0 * d->voltage_temperature,
        /* the force that holds the springs away from their rest */
        .bias_temperature = d->bias_temperature +
                            spring.value * (d->spring_temperature - 2.0 * d->voltage_temperature)};
    if (d->loop == IMK_MEMS_OPEN) {
        const double second = -p->a2 / p->a1, third = 2.0 * second * second - p->a3 / p->a1;
        const double p2 = p->pickoff.second / p->pickoff.first;
        const double p3 = p->pickoff.third / p->pickoff.first;
        e.k2 = -(second + p2) / p->a1;
        e.k3 = (third + 2.0 * p2 * second + p3) / square(p->a1);
        e.scale_temperature = -(spring.first * d->spring_temperature -
                                2.0 * (spring.first - p->a1) * d->voltage_temperature) /
                              p->a1;
    } else if (d->loop == IMK_MEMS_ANALOG) {
        e.k2 = -p->b2 / square(p->b1);
        e.k3 = 2.0 * square(e.k2);
        if (!(d->reset > 0.0))
            deflected_loop(d, p, &e);
    } else if (!(d->integral > 0.0) && !imki_mems_locked(d)) {
        e.scale = -1.0 / (1.0 + imk_mems_accelerometer_quantizer(d).gain);
        e.bias = -e.scale * p->rest;
    }
    return e;
}

double imki_mems_white(const imk_mems_accelerometer *d, const imki_mems_point *p)
{
    const double seen = 1.0 + imki_mems_static_errors(d, p).scale;
    const double brownian = 2.0 * IMKI_BOLTZMANN * d->temperature * p->damping / d->mass;
    const double pickoff = 0.5 * square(p->a1 * d->pickoff_noise);
    const bool dithered = d->loop == IMK_MEMS_SIGMA_DELTA && !imki_mems_locked(d);
    const double quantization = dithered ? imk_mems_accelerometer_quantizer(d).quantization : 0.0;
    return sqrt(square(seen) * (brownian + pickoff) + square(quantization));
}

double imk_mems_accelerometer_rectification(const imk_mems_accelerometer *d, double frequency)
{
    const imki_mems_point p = imki_mems_operating_point(d);
    const double w = 2.0 * IMKI_PI * frequency;
    const double gain = p.a1 * p.a1 / (square(p.a1 - w * w) + square(p.damping * w));
    return imki_mems_static_errors(d, &p).k2 * gain;
}
