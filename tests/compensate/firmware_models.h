/* SPDX-License-Identifier: Apache-2.0 */
/* Models of the size met in practice, with any of the terms a device can take out, and motions for
 * them: for the tests of firmware. */
#ifndef IMUKIT_TESTS_FIRMWARE_MODELS_H
#define IMUKIT_TESTS_FIRMWARE_MODELS_H

#include "imukit/firmware.h"

#include "io/random_model.h"

/* -size … size */
static inline double draw(uint64_t *state, double size)
{
    return size * (2 * random_unit(state) - 1);
}

static inline void draw_axes(uint64_t *state, imk_axes *axes, double size)
{
    for (int i = 0; i < IMK_AXES_MAX; i++)
        axes->value[i] = draw(state, size);
}

static inline void draw_rows(uint64_t *state, imk_rows *rows, double size, bool off_diagonal)
{
    for (int i = 0; i < 3 * IMK_AXES_MAX; i++)
        if (!off_diagonal || i % 4 != 0)
            rows->value[i / 3][i % 3] = draw(state, size);
}

/* Of effect `size` at 50 K from the middle of -40 … 85 degC. */
static inline void draw_polynomial(uint64_t *state, imk_temperature_polynomial *p, double size)
{
    double power = 50;
    p->order = 1 + random_below(state, IMK_TEMPERATURE_ORDER_MAX);
    p->reference = 298.15;
    p->minimum = 233.15 + random_below(state, 20);
    p->maximum = 358.15 - random_below(state, 20);
    for (int k = 0; k < p->order; k++, power *= 50)
        draw_axes(state, &p->coefficient[k], size / power);
}

static inline bool one_in(uint64_t *state, int count)
{
    return random_below(state, count) == 0;
}

/* unit: rad/s of a range of 10, or m/s^2 of a range of 100. `linear`: nothing but biases, scale
 * factors, misalignment and g-sensitivity. */
static inline void draw_triad(uint64_t *state, imk_triad *t, double range, bool gyro, bool linear)
{
    const bool counts = one_in(state, 2), offset = one_in(state, 3);
    if (one_in(state, 5)) {
        t->axis_count = 4;
        for (int k = 0; k < 3; k++)
            t->direction[3][k] = 0.57735026918962576;
    }
    draw_axes(state, &t->bias.fixed, 0.05 * range);
    draw_axes(state, &t->scale_factor.fixed, 0.02);
    draw_rows(state, &t->misalignment, 0.02, true);
    if (one_in(state, 2))
        draw_polynomial(state, &t->bias.temperature, 0.02 * range);
    if (gyro && one_in(state, 2))
        draw_rows(state, &t->g_sensitivity, 1e-4 * range, false);
    for (int i = 0; i < t->axis_count; i++) {
        t->range.value[i] = range;
        t->sensitivity.value[i] = counts ? 32768 / range : 0;
        t->zero_offset.value[i] = counts && offset ? 32768 : 0;
    }
    if (linear)
        return;
    if (one_in(state, 2))
        draw_polynomial(state, &t->scale_factor.temperature, 0.01);
    if (one_in(state, 2))
        draw_axes(state, &t->nonlinearity.k2, 0.003 / range);
    if (one_in(state, 2))
        draw_axes(state, &t->nonlinearity.k3, 0.003 / range / range);
    if (one_in(state, 3))
        draw_axes(state, &t->nonlinearity.koq, 0.003 / range);
    if (one_in(state, 3))
        draw_axes(state, &t->nonlinearity.asymmetry, 0.003);
    if (gyro && one_in(state, 3))
        for (int i = 0; i < 6 * IMK_AXES_MAX; i++)
            t->g2_sensitivity.value[i / 6][i % 6] = draw(state, 1e-7 * range);
    if (!gyro && t->axis_count == 3 && one_in(state, 3))
        draw_rows(state, &t->nonlinearity.cross_products, 0.002 / range, false);
}

static inline imk_model practical_model(uint64_t *state, bool linear)
{
    imk_model model;
    imk_model_default(&model);
    model.gyro.present = !one_in(state, 8);
    model.accel.present = !model.gyro.present || !one_in(state, 8);
    if (model.gyro.present)
        draw_triad(state, &model.gyro, 10, true, linear);
    if (model.accel.present)
        draw_triad(state, &model.accel, 100, false, linear);
    if (!model.accel.present) {
        memset(&model.gyro.g_sensitivity, 0, sizeof model.gyro.g_sensitivity);
        memset(&model.gyro.g2_sensitivity, 0, sizeof model.gyro.g2_sensitivity);
    }
    return model;
}

/* What a unit reads of a random motion within `part` of the limits, as its device has it. */
static inline void draw_sample(uint64_t *state, const imk_firmware *f, double part,
                               imk_firmware_sample *sample)
{
    imk_stimulus s = {0};
    double motion[2][3], temperature = 225 + 140 * random_unit(state);
    memset(sample, 0, sizeof *sample);
    sample->temperature = temperature - 273.15;
    imk_firmware_round(f, sample);
    temperature = sample->temperature + 273.15;
    for (int j = 0; j < 3; j++) {
        motion[IMK_GYRO][j] = draw(state, part * f->limit[IMK_GYRO][j]);
        motion[IMK_ACCEL][j] = draw(state, part * f->limit[IMK_ACCEL][j]);
        s.angular_rate[j] = f->output_count[IMK_GYRO] ? &motion[IMK_GYRO][j] : NULL;
        s.specific_force[j] = f->output_count[IMK_ACCEL] ? &motion[IMK_ACCEL][j] : NULL;
    }
    s.temperature = &temperature;
    for (int sensor = 0; sensor < 2; sensor++)
        for (int i = 0; i < f->axis_count[sensor]; i++) {
            double y;
            imk_distort(&f->correction.distortion, sensor, i, &s, 1, &y);
            sample->reading[sensor][i] =
                y / f->correction.per_unit[sensor][i] + f->correction.zero_offset[sensor][i];
        }
    imk_firmware_round(f, sample);
}

/* The same readings through imk_correct(). */
static inline void correct_sample(const imk_correction *correction,
                                  const imk_firmware_sample *sample,
                                  double corrected[2][IMK_AXES_MAX])
{
    const double temperature = sample->temperature + 273.15;
    imk_readings readings = {.temperature = &temperature};
    double *to[2][IMK_AXES_MAX];
    for (int sensor = 0; sensor < 2; sensor++)
        for (int i = 0; i < IMK_AXES_MAX; i++) {
            readings.channel[sensor][i] = &sample->reading[sensor][i];
            to[sensor][i] = &corrected[sensor][i];
        }
    imk_correct(correction, &readings, 1, (double *const(*)[IMK_AXES_MAX])to);
}

#endif
