/* SPDX-License-Identifier: Apache-2.0 */
/* What the instruments' error models have in common: how they begin, an error that acts like an
 * input, three axes from one. */
#include "physics_internal.h"

#include "base/text_internal.h"

void imk_instrument_reduce(const imk_instrument *instrument, const void *design, imk_model *model)
{
    const int sensor = instrument->sensor;
    imk_model_default(model);
    imk_triad *triad = imk_model_triad_to_set(model, sensor);
    imk_evidence *evidence = sensor == IMK_GYRO ? &model->gyro_evidence : &model->accel_evidence;
    imk_model_triad_to_set(model, sensor == IMK_GYRO ? IMK_ACCEL : IMK_GYRO)->present = false;
    triad->axis_count = 1;
    imki_copy_text(model->name, sizeof model->name, instrument->title);
    imki_copy_text(evidence->source, sizeof evidence->source, instrument->source);
    imki_copy_text(evidence->method, sizeof evidence->method, "design parameters, by closed forms");
    instrument->reduce(design, triad);
}

double imki_reduction_offset(imk_triad *triad, double u, double per_kelvin)
{
    double *const s = &triad->scale_factor.fixed.value[0];
    double *const k2 = &triad->nonlinearity.k2.value[0];
    double *const bias_slope = &triad->bias.temperature.coefficient[0].value[0];
    double *const scale_slope = &triad->scale_factor.temperature.coefficient[0].value[0];
    const double k3 = triad->nonlinearity.k3.value[0];
    const double slope = 1.0 + *s + u * (2.0 * *k2 + 3.0 * u * k3);
    triad->bias.fixed.value[0] += u * (1.0 + *s + u * (*k2 + u * k3));
    *bias_slope += slope * per_kelvin + *scale_slope * u;
    *scale_slope += 2.0 * (*k2 + 3.0 * u * k3) * per_kelvin;
    *s = slope - 1.0;
    *k2 += 3.0 * u * k3;
    return slope;
}

/* Component k of axis 0 becomes component (k + axis) mod 3 of axis `axis`. */
static void turn_rows(imk_rows *rows)
{
    for (int axis = 1; axis < 3; axis++)
        for (int k = 0; k < 3; k++) {
            rows->value[axis][(k + axis) % 3] = rows->value[0][k];
            rows->sigma[axis][(k + axis) % 3] = rows->sigma[0][k];
        }
}

/* Squares turn as components do; so do the products xy, yz, zx. */
static void turn_quadratic(imk_quadratic_rows *rows)
{
    for (int axis = 1; axis < 3; axis++)
        for (int k = 0; k < 6; k++) {
            const int to = k / 3 * 3 + (k + axis) % 3;
            rows->value[axis][to] = rows->value[0][k];
            rows->sigma[axis][to] = rows->sigma[0][k];
        }
}

static void repeat(imk_axes *axes)
{
    for (int axis = 1; axis < 3; axis++) {
        axes->value[axis] = axes->value[0];
        axes->sigma[axis] = axes->sigma[0];
    }
}

static void repeat_polynomial(imk_temperature_polynomial *polynomial)
{
    for (int i = 0; i < IMK_TEMPERATURE_ORDER_MAX; i++)
        repeat(&polynomial->coefficient[i]);
}

static void repeat_noise(imk_noise *noise)
{
    imk_axes *const single[] = {&noise->white, &noise->bias_instability, &noise->random_walk,
                                &noise->ramp, &noise->quantization};
    for (size_t i = 0; i < sizeof single / sizeof single[0]; i++)
        repeat(single[i]);
    for (int i = 0; i < IMK_TERMS_MAX; i++) {
        repeat(&noise->gauss_markov[i].sigma);
        repeat(&noise->gauss_markov[i].correlation_time);
        repeat(&noise->sinusoid[i].amplitude);
        repeat(&noise->sinusoid[i].frequency);
        repeat(&noise->resonance[i].sigma);
        repeat(&noise->resonance[i].frequency);
        repeat(&noise->resonance[i].q);
    }
}

static void three_axes(imk_triad *triad)
{
    imk_axes *const single[] = {&triad->bias.fixed,
                                &triad->bias.repeatability,
                                &triad->bias.temperature_rate,
                                &triad->bias.warm_up_amplitude,
                                &triad->bias.hysteresis,
                                &triad->scale_factor.fixed,
                                &triad->scale_factor.repeatability,
                                &triad->nonlinearity.k2,
                                &triad->nonlinearity.koq,
                                &triad->nonlinearity.k3,
                                &triad->nonlinearity.asymmetry,
                                &triad->bandwidth,
                                &triad->damping,
                                &triad->dead_band,
                                &triad->range,
                                &triad->resolution,
                                &triad->sensitivity,
                                &triad->zero_offset};
    imk_rows *const rows[] = {&triad->misalignment, &triad->cross_axis, &triad->g_sensitivity,
                              &triad->lever_arm};
    for (size_t i = 0; i < sizeof single / sizeof single[0]; i++)
        repeat(single[i]);
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++)
        turn_rows(rows[i]);
    repeat_polynomial(&triad->bias.temperature);
    repeat_polynomial(&triad->scale_factor.temperature);
    repeat_noise(&triad->noise);
    turn_quadratic(&triad->g2_sensitivity);
    imk_rows *cross = &triad->nonlinearity.cross_products; /* Kip, Kio, Kpo: of the axis itself */
    for (int axis = 1; axis < 3; axis++)
        for (int k = 0; k < 3; k++) {
            cross->value[axis][k] = cross->value[0][k];
            cross->sigma[axis][k] = cross->sigma[0][k];
            triad->nonlinearity.pendulous_axis[axis][(k + axis) % 3] =
                triad->nonlinearity.pendulous_axis[0][k];
        }
    for (int axis = 0; axis < 3; axis++)
        for (int k = 0; k < 3; k++)
            triad->direction[axis][k] = axis == k ? 1.0 : 0.0;
    triad->axis_count = 3;
}

void imk_model_three_axes(imk_model *model)
{
    if (model->gyro.present)
        three_axes(&model->gyro);
    if (model->accel.present)
        three_axes(&model->accel);
}
