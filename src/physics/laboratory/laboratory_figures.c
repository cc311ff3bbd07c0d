/* SPDX-License-Identifier: Apache-2.0 */
/* A model of one axis as a list of figures. */
#include "laboratory_internal.h"

#include <math.h>

typedef struct list {
    imk_laboratory_figure *figure;
    size_t count;
} list;

static void add(list *l, const char *key, const char *si, const char *unit, double value,
                double sigma)
{
    l->figure[l->count++] = (imk_laboratory_figure){key, si, unit, value, sigma};
}

static void add_axes(list *l, const char *key, const char *si, const char *unit,
                     const imk_axes *axes)
{
    add(l, key, si, unit, axes->value[0], axes->sigma[0]);
}

/* A constant that differs from run to run by the repeatability. */
static void add_constant(list *l, const char *key, const char *si, const char *unit,
                         const imk_axes *fixed, const imk_axes *repeatability, double wander)
{
    const double sigma = fixed->sigma[0], spread = repeatability->value[0];
    add(l, key, si, unit, fixed->value[0], sqrt(sigma * sigma + spread * spread + wander * wander));
}

/* What an instrument shows of an input across its axis: geometry and response together, which no
 * experiment on one axis can tell apart. */
static void add_cross_axis(list *l, const imk_triad *t)
{
    static const char *const keys[] = {"misalignment.y", "misalignment.z"};
    for (int k = 0; k < 2; k++) {
        const double a = t->misalignment.sigma[0][1 + k], b = t->cross_axis.sigma[0][1 + k];
        add(l, keys[k], "1", "%", t->misalignment.value[0][1 + k] + t->cross_axis.value[0][1 + k],
            sqrt(a * a + b * b));
    }
}

static void gyro_figures(list *l, const imk_triad *t)
{
    static const char *const g[] = {"g_sensitivity.x", "g_sensitivity.y", "g_sensitivity.z"};
    static const char *const g2[] = {"g2_sensitivity.xx", "g2_sensitivity.yy", "g2_sensitivity.zz",
                                     "g2_sensitivity.xy", "g2_sensitivity.yz", "g2_sensitivity.zx"};
    add_constant(l, "bias.fixed", "rad/s", "deg/h", &t->bias.fixed, &t->bias.repeatability,
                 t->noise.bias_instability.value[0]);
    add_axes(l, "bias.temperature", "rad/s/K", "deg/h/K", &t->bias.temperature.coefficient[0]);
    add_axes(l, "bias.temperature_rate", "rad/s/(K/s)", "deg/h/(K/min)", &t->bias.temperature_rate);
    add_constant(l, "scale_factor.fixed", "1", "ppm", &t->scale_factor.fixed,
                 &t->scale_factor.repeatability, 0.0);
    add_axes(l, "scale_factor.temperature", "1/K", "ppm/K",
             &t->scale_factor.temperature.coefficient[0]);
    add_axes(l, "nonlinearity.k2", "1/(rad/s)", "ppm/(deg/s)", &t->nonlinearity.k2);
    add_axes(l, "nonlinearity.koq", "1/(rad/s)", "ppm/(deg/s)", &t->nonlinearity.koq);
    add_axes(l, "nonlinearity.k3", "1/(rad/s)^2", "ppm/(deg/s)^2", &t->nonlinearity.k3);
    add_axes(l, "nonlinearity.asymmetry", "1", "ppm", &t->nonlinearity.asymmetry);
    add_cross_axis(l, t);
    for (int k = 0; k < 3; k++)
        add(l, g[k], "rad/s/(m/s^2)", "deg/h/g", t->g_sensitivity.value[0][k],
            t->g_sensitivity.sigma[0][k]);
    for (int k = 0; k < 6; k++)
        add(l, g2[k], "rad/s/(m/s^2)^2", "deg/h/g^2", t->g2_sensitivity.value[0][k],
            t->g2_sensitivity.sigma[0][k]);
    add_axes(l, "dead_band", "rad/s", "deg/h", &t->dead_band);
    add_axes(l, "bandwidth", "Hz", "Hz", &t->bandwidth);
    add_axes(l, "noise.quantization", "rad", "arcsec", &t->noise.quantization);
    add_axes(l, "noise.angle_random_walk", "rad/s/sqrt(Hz)", "deg/sqrt(h)", &t->noise.white);
    add_axes(l, "noise.bias_instability", "rad/s", "deg/h", &t->noise.bias_instability);
    add_axes(l, "noise.rate_random_walk", "rad/s/sqrt(s)", "deg/h/sqrt(h)", &t->noise.random_walk);
}

static void accel_figures(list *l, const imk_triad *t)
{
    static const char *const products[] = {"cross_products.kip", "cross_products.kio",
                                           "cross_products.kpo"};
    add_constant(l, "bias.fixed", "m/s^2", "mg", &t->bias.fixed, &t->bias.repeatability,
                 t->noise.bias_instability.value[0]);
    add_axes(l, "bias.temperature", "m/s^2/K", "mg/K", &t->bias.temperature.coefficient[0]);
    add_axes(l, "bias.temperature_rate", "m/s^2/(K/s)", "mg/(K/min)", &t->bias.temperature_rate);
    add_constant(l, "scale_factor.fixed", "1", "ppm", &t->scale_factor.fixed,
                 &t->scale_factor.repeatability, 0.0);
    add_axes(l, "scale_factor.temperature", "1/K", "ppm/K",
             &t->scale_factor.temperature.coefficient[0]);
    add_axes(l, "nonlinearity.k2", "1/(m/s^2)", "ppm/g", &t->nonlinearity.k2);
    add_axes(l, "nonlinearity.koq", "1/(m/s^2)", "ppm/g", &t->nonlinearity.koq);
    add_axes(l, "nonlinearity.k3", "1/(m/s^2)^2", "ppm/g^2", &t->nonlinearity.k3);
    add_axes(l, "nonlinearity.asymmetry", "1", "ppm", &t->nonlinearity.asymmetry);
    add_cross_axis(l, t);
    for (int k = 0; k < 3; k++)
        add(l, products[k], "1/(m/s^2)", "ppm/g", t->nonlinearity.cross_products.value[0][k],
            t->nonlinearity.cross_products.sigma[0][k]);
    add_axes(l, "dead_band", "m/s^2", "ug", &t->dead_band);
    add_axes(l, "bandwidth", "Hz", "Hz", &t->bandwidth);
    add_axes(l, "noise.quantization", "m/s", "mm/s", &t->noise.quantization);
    add_axes(l, "noise.velocity_random_walk", "m/s^2/sqrt(Hz)", "ug/sqrt(Hz)", &t->noise.white);
    add_axes(l, "noise.bias_instability", "m/s^2", "ug", &t->noise.bias_instability);
    add_axes(l, "noise.acceleration_random_walk", "m/s^2/sqrt(s)", "ug/sqrt(h)",
             &t->noise.random_walk);
}

size_t imk_laboratory_figures(const imk_model *model, int sensor, imk_laboratory_figure *figures)
{
    list l = {figures, 0};
    if (sensor == IMK_GYRO)
        gyro_figures(&l, &model->gyro);
    else
        accel_figures(&l, &model->accel);
    return l.count;
}
