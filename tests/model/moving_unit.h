/* SPDX-License-Identifier: Apache-2.0 */
/* Random units with every deterministic term, at sizes a poor MEMS unit has, and random motions for
 * them: for the tests of the forward and the inverse map. */
#ifndef IMUKIT_TESTS_MOVING_UNIT_H
#define IMUKIT_TESTS_MOVING_UNIT_H

#include "imukit/distort.h"

#include <math.h>
#include <string.h>

enum { SAMPLES_MAX = 128, COMPONENTS = 15 };

#define RATE_RANGE 10.0   /* [rad/s] */
#define FORCE_RANGE 200.0 /* [m/s^2] */

/* SplitMix64: enough for choosing test cases, and the same everywhere. */
static inline uint64_t draw(uint64_t *state)
{
    uint64_t z = (*state += 0x9E3779B97F4A7C15u);
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    return z ^ (z >> 31);
}

/* Between -1 and 1. */
static inline double draw_signed(uint64_t *state)
{
    return (double)(draw(state) >> 11) * 0x1p-52 - 1.0;
}

static inline bool draw_chance(uint64_t *state, int one_in)
{
    return draw(state) % (uint64_t)one_in == 0;
}

static inline void fill(uint64_t *state, double *values, int count, double size)
{
    for (int i = 0; i < count; i++)
        values[i] = size * draw_signed(state);
}

static inline void fill_polynomial(uint64_t *state, imk_temperature_polynomial *p, double size)
{
    p->order = 1 + (int)(draw(state) % IMK_TEMPERATURE_ORDER_MAX);
    p->reference = 298.15;
    p->minimum = 233.15;
    p->maximum = 358.15;
    for (int k = 0; k < p->order; k++) {
        fill(state, p->coefficient[k].value, IMK_AXES_MAX, size);
        size /= 60;
    }
}

/* Across e, in the plane of e and a body axis. */
static inline void set_across(const double e[3], double p[3])
{
    const int k = fabs(e[0]) < 0.6 ? 0 : 1;
    double square = 0;
    for (int j = 0; j < 3; j++) {
        p[j] = (j == k ? 1 : 0) - e[k] * e[j];
        square += p[j] * p[j];
    }
    for (int j = 0; j < 3; j++)
        p[j] /= sqrt(square);
}

/* Four to eight axes: around a cone, which no two directions of are close on, turned at random. */
static inline void set_redundant(uint64_t *state, imk_triad *triad)
{
    const double phase = draw_signed(state), height = 0.5 + 0.2 * draw_signed(state);
    triad->axis_count = 4 + (int)(draw(state) % 5);
    for (int i = 0; i < triad->axis_count; i++) {
        const double angle = phase + 6.283185307179586 * i / triad->axis_count;
        double *e = triad->direction[i];
        e[0] = sqrt(1 - height * height) * cos(angle);
        e[1] = sqrt(1 - height * height) * sin(angle);
        e[2] = height;
    }
}

/* Three axes, each tilted out of its body axis by up to 20 degrees. */
static inline void set_tilted(uint64_t *state, imk_triad *triad)
{
    for (int i = 0; i < 3; i++) {
        double *e = triad->direction[i], square = 0;
        for (int j = 0; j < 3; j++) {
            e[j] = (i == j ? 1 : 0) + 0.2 * draw_signed(state);
            square += e[j] * e[j];
        }
        for (int j = 0; j < 3; j++)
            e[j] /= sqrt(square);
    }
}

static inline void set_coupling(uint64_t *state, imk_triad *triad, double size)
{
    for (int i = 0; i < triad->axis_count; i++)
        for (int j = 0; j < 3; j++)
            if (triad->axis_count != 3 || i != j) {
                triad->misalignment.value[i][j] = size * draw_signed(state);
                triad->cross_axis.value[i][j] = size * draw_signed(state);
            }
}

static inline void set_nonlinearity(uint64_t *state, imk_triad *triad, double range)
{
    imk_nonlinearity *n = &triad->nonlinearity;
    fill(state, n->k2.value, IMK_AXES_MAX, 0.01 / range);
    fill(state, n->koq.value, IMK_AXES_MAX, 0.01 / range);
    fill(state, n->k3.value, IMK_AXES_MAX, 0.01 / range / range);
    fill(state, n->asymmetry.value, IMK_AXES_MAX, 0.01);
}

static inline void set_common(uint64_t *state, imk_triad *triad, double range, bool is_linear)
{
    if (draw_chance(state, 3))
        set_redundant(state, triad);
    else if (draw_chance(state, 2))
        set_tilted(state, triad);
    fill(state, triad->bias.fixed.value, IMK_AXES_MAX, 0.01 * range);
    fill(state, triad->scale_factor.fixed.value, IMK_AXES_MAX, 0.02);
    for (int i = 0; i < IMK_AXES_MAX; i++)
        triad->range.value[i] = range;
    if (!draw_chance(state, 3))
        set_coupling(state, triad, 0.01);
    if (!is_linear && !draw_chance(state, 3))
        set_nonlinearity(state, triad, range);
    if (draw_chance(state, 2))
        fill_polynomial(state, &triad->bias.temperature, 1e-4 * range);
    if (draw_chance(state, 2))
        fill_polynomial(state, &triad->scale_factor.temperature, 1e-4);
    if (draw_chance(state, 2)) {
        fill(state, triad->bias.temperature_rate.value, IMK_AXES_MAX, 0.001 * range);
        fill(state, triad->bias.warm_up_amplitude.value, IMK_AXES_MAX, 0.001 * range);
        triad->bias.warm_up_time.value = 100;
    }
}

/* A valid model. Linear ones have no term that is not linear in the motion, and no lever arms. */
static inline imk_model draw_unit(uint64_t *state, bool is_linear)
{
    imk_model model;
    imk_model_default(&model);
    set_common(state, &model.gyro, RATE_RANGE, is_linear);
    set_common(state, &model.accel, FORCE_RANGE, is_linear);
    if (!draw_chance(state, 3))
        fill(state, model.gyro.g_sensitivity.value[0], IMK_AXES_MAX * 3, 5e-4);
    if (is_linear)
        return model;
    if (!draw_chance(state, 3))
        fill(state, model.gyro.g2_sensitivity.value[0], IMK_AXES_MAX * 6, 1e-6);
    if (!draw_chance(state, 3))
        fill(state, model.accel.lever_arm.value[0], IMK_AXES_MAX * 3, 0.05);
    if (draw_chance(state, 2)) {
        fill(state, model.accel.nonlinearity.cross_products.value[0], IMK_AXES_MAX * 3,
             0.005 / FORCE_RANGE);
        for (int i = 0; i < model.accel.axis_count; i++)
            set_across(model.accel.direction[i], model.accel.nonlinearity.pendulous_axis[i]);
    }
    return model;
}

/* Samples of everything a unit is exposed to. */
typedef struct motion_samples {
    double value[COMPONENTS][SAMPLES_MAX];
    imk_stimulus stimulus;
} motion_samples;

/* Uniform over the range; some components are exactly zero now and then. */
static inline void draw_motion(uint64_t *state, int count, motion_samples *m)
{
    static const double size[COMPONENTS] = {
        RATE_RANGE, RATE_RANGE, RATE_RANGE, FORCE_RANGE, FORCE_RANGE, FORCE_RANGE, 100, 100,
        100,        80,         0.1,        1,           1,           1,           1};
    for (int c = 0; c < COMPONENTS; c++)
        for (int k = 0; k < count; k++)
            m->value[c][k] = draw_chance(state, 50) ? 0 : size[c] * draw_signed(state);
    for (int k = 0; k < count; k++)
        m->value[9][k] += 298.15;
    for (int j = 0; j < 3; j++) {
        m->stimulus.angular_rate[j] = m->value[j];
        m->stimulus.specific_force[j] = m->value[3 + j];
        m->stimulus.angular_acceleration[j] = m->value[6 + j];
    }
    m->stimulus.temperature = m->value[9];
    m->stimulus.temperature_rate = m->value[10];
    for (int s = 0; s < 2; s++) {
        m->stimulus.warm_up[s] = m->value[11 + s];
        m->stimulus.hysteresis[s] = m->value[13 + s];
    }
}

#endif
