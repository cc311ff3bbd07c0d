/* SPDX-License-Identifier: Apache-2.0 */
/* Closed forms of the free gyro, and its error model. From the precession of its spin axis
 *
 *     a' = -wx + r tan b - Mi/(H c),    b' = -q + Mo/(H c)
 *
 * the reading -a' has the bias Mi/(H c); a friction torque -D b' about the inner axis adds
 * D q/(H c), and -D a' about the outer one comes back by way of b' as -(D/(H c))^2 wx. */
#include "free_gyro_internal.h"
#include "imukit/elementary.h"

#include <math.h>

/* Range of the polynomial: that of aircraft equipment, -40 ... 85 degC [K]. */
#define LOWEST_TEMPERATURE 233.15
#define HIGHEST_TEMPERATURE 358.15

static double outer_inertia(const imki_free_gyro_parts *parts, double cosine)
{
    return parts->j_least + parts->a_c * cosine * cosine;
}

double imk_free_gyro_nutation(const imk_free_gyro *design, double inner)
{
    const imki_free_gyro_parts parts = imki_free_gyro_parts_of(design);
    const double c = imk_cos(inner);
    return parts.h * c / (2.0 * IMKI_PI * sqrt(outer_inertia(&parts, c) * parts.b));
}

double imk_free_gyro_gimbal_walk(const imk_free_gyro *design, double inner, double amplitude)
{
    const imki_free_gyro_parts parts = imki_free_gyro_parts_of(design);
    const double j = outer_inertia(&parts, imk_cos(inner));
    return -amplitude * amplitude * parts.h * imk_sin(inner) * parts.j_least / (2.0 * j * j);
}

/* The root is written so that it does not cancel:  w = -2 Mi/(H c + sqrt(H^2 c^2 + 4 K Mi)). */
double imk_free_gyro_precession(const imk_free_gyro *design, double inner, double torque)
{
    const imki_free_gyro_parts parts = imki_free_gyro_parts_of(design);
    const double h = parts.h * imk_cos(inner);
    const double k = parts.a_c * imk_sin(inner) * imk_cos(inner);
    const double square = h * h + 4.0 * k * torque;
    return square >= 0.0 ? -2.0 * torque / (h + sqrt(square)) : (double)NAN;
}

void imk_free_gyro_unbalance(const imk_free_gyro *design, double sensitivity[3])
{
    const double per_h = design->mass / imk_free_gyro_momentum(design);
    sensitivity[0] = -per_h * design->unbalance[2];
    sensitivity[1] = 0.0;
    sensitivity[2] = per_h * design->unbalance[0];
}

double imk_free_gyro_anisoelasticity(const imk_free_gyro *design)
{
    return design->mass * design->mass * (design->compliance[2] - design->compliance[0]) /
           imk_free_gyro_momentum(design);
}

/* The inner gimbal's axes at the start, in case axes. */
typedef struct directions {
    double x[3], y[3], z[3];
} directions;

static directions directions_of(double outer, double inner)
{
    const double so = imk_sin(outer), co = imk_cos(outer), s = imk_sin(inner), c = imk_cos(inner);
    return (directions){.x = {c, s * so, -s * co}, .y = {0.0, co, so}, .z = {s, -c * so, c * co}};
}

/* Add factor (a.f)(b.f) to a row of products of f. */
static void add_product(double factor, const double a[3], const double b[3], double square[6])
{
    for (int k = 0; k < 3; k++) {
        const int next = (k + 1) % 3;
        square[k] += factor * a[k] * b[k];
        square[3 + k] += factor * (a[k] * b[next] + a[next] * b[k]);
    }
}

/* Torque M = m f x d + m^2 (C f) x f about the inner axis, M_y, less what friction passes on of
 * that about the outer one, M_x c + M_z s. */
static void reduce_force_terms(const imki_free_gyro_parts *parts, const directions *axes,
                               double per_h, double friction, imk_triad *gyro)
{
    const double *d = parts->moment, *e = parts->elastic;
    const double s = axes->z[0], c = axes->x[0], passed = -friction * per_h;
    double *row = gyro->g_sensitivity.value[0], *square = gyro->g2_sensitivity.value[0];
    for (int k = 0; k < 3; k++) {
        const double mx = d[2] * axes->y[k] - d[1] * axes->z[k];
        const double mz = d[1] * axes->x[k] - d[0] * axes->y[k];
        row[k] = per_h * (d[0] * axes->z[k] - d[2] * axes->x[k]) + passed * (mx * c + mz * s);
    }
    add_product(per_h * e[1], axes->z, axes->x, square);
    add_product(passed * c * e[0], axes->y, axes->z, square);
    add_product(passed * s * e[2], axes->x, axes->y, square);
}

void imki_free_gyro_reduce(const imk_free_gyro *design, imk_triad *gyro)
{
    const imki_free_gyro_parts parts = imki_free_gyro_parts_of(design);
    const directions axes = directions_of(design->start_outer, design->start_inner);
    const double c = imk_cos(design->start_inner), per_h = 1.0 / (parts.h * c);
    const double tangent = imk_sin(design->start_inner) / c, friction = parts.slope * per_h;
    const double scale = 1.0 + design->pickoff_scale_error, step = design->pickoff_resolution;
    gyro->bias.fixed.value[0] =
        scale * per_h * (design->torque_inner - friction * design->torque_outer);
    gyro->bias.repeatability.value[0] = per_h * design->torque_repeatability;
    if (design->torque_temperature != 0.0) {
        gyro->bias.temperature.order = 1;
        gyro->bias.temperature.coefficient[0].value[0] = per_h * design->torque_temperature;
        gyro->bias.temperature.reference = IMKI_DESIGN_TEMPERATURE;
        gyro->bias.temperature.minimum = LOWEST_TEMPERATURE;
        gyro->bias.temperature.maximum = HIGHEST_TEMPERATURE;
    }
    gyro->scale_factor.fixed.value[0] = scale / (1.0 + friction * friction) - 1.0;
    gyro->misalignment.value[0][1] = tangent * imk_sin(design->start_outer);
    gyro->misalignment.value[0][2] = -tangent * imk_cos(design->start_outer);
    for (int k = 0; k < 3; k++)
        gyro->cross_axis.value[0][k] = friction * axes.y[k];
    reduce_force_terms(&parts, &axes, per_h, friction, gyro);
    gyro->noise.density = IMK_DENSITY_TWO_SIDED;
    gyro->noise.white.value[0] = per_h * design->torque_noise;
    gyro->noise.bias_instability.value[0] = per_h * design->torque_instability;
    gyro->noise.quantization.value[0] = step / sqrt(12.0);
    gyro->noise.reading_noise.value[0] = design->pickoff_noise;
}
