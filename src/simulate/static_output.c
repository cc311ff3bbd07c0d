/* SPDX-License-Identifier: Apache-2.0 */
/* The deterministic terms at rest: what an axis puts out on average,
 *
 *     f_r = f + w x (w x r)                                        at the sensor's own place r
 *     y = b + u + s u + (A + X) . input + n(u) + G1 . f + G2 . q(f),   u = e . input
 *     n(u) = K2 u^2 + Koq u|u| + K3 u^3 + asymmetry |u|/2
 *
 * input being f_r for an accelerometer and the angular rate w for a gyro, q(f) the six products of
 * components; b and s hold this run's repeatabilities. The body is at rest on the Earth: w is
 * constant and there is no angular acceleration. */
#include "simulate/simulate_internal.h"

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* w x (w x r) = w (w.r) - r (w.w), added to f */
static void force_at(const double rate[3], const double force[3], const double place[3],
                     double out[3])
{
    double along = dot(rate, place), square = dot(rate, rate);
    for (int i = 0; i < 3; i++)
        out[i] = force[i] + (rate[i] * along - place[i] * square);
}

/* One draw for the whole run. */
static double repeatability(const imk_axes *sigma, imki_axis axis, uint8_t instance,
                            imk_random random, uint32_t run)
{
    double normal;
    imk_random_normals(random, imk_stream(run, IMK_TERM_REPEATABILITY, instance, axis.stream_axis),
                       0, 1, &normal);
    return sigma->value[axis.axis] * normal;
}

double imki_static_output(imki_axis axis, const double angular_rate[3],
                          const double specific_force[3], imk_random random, uint32_t run)
{
    const imk_triad *triad = axis.triad;
    int i = axis.axis;
    double local[3];
    force_at(angular_rate, specific_force, triad->lever_arm.value[i], local);
    bool gyro = axis.stream_axis < IMK_AXES_MAX;
    const double *input = gyro ? angular_rate : local;

    double u = dot(triad->direction[i], input), size = u < 0.0 ? -u : u;
    const imk_nonlinearity *shape = &triad->nonlinearity;
    double nonlinear = shape->k2.value[i] * u * u + shape->koq.value[i] * u * size +
                       shape->k3.value[i] * u * u * u + 0.5 * shape->asymmetry.value[i] * size;
    double scale = triad->scale_factor.fixed.value[i] +
                   repeatability(&triad->scale_factor.repeatability, axis, 1, random, run);
    double bias = triad->bias.fixed.value[i] +
                  repeatability(&triad->bias.repeatability, axis, 0, random, run);
    double other =
        dot(triad->misalignment.value[i], input) + dot(triad->cross_axis.value[i], input);
    if (gyro) {
        const double *f = specific_force;
        const double product[6] = {f[0] * f[0], f[1] * f[1], f[2] * f[2],
                                   f[0] * f[1], f[1] * f[2], f[2] * f[0]};
        other += dot(triad->g_sensitivity.value[i], f);
        for (int j = 0; j < 6; j++)
            other += triad->g2_sensitivity.value[i][j] * product[j];
    }
    return bias + u + scale * u + other + nonlinear;
}
