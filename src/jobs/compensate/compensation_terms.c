/* SPDX-License-Identifier: Apache-2.0 */
/* Which terms of a model compensation takes out, and which stay in the record: because they were
 * not selected, or because the model knows their size and not their course. */
#include "compensate_internal.h"

#include <stddef.h>
#include <stdio.h>

typedef enum term_kind { OF_AXES, OF_ROWS, OF_QUADRATIC, OF_POLYNOMIAL } term_kind;

typedef struct term {
    const char *name;
    size_t offset; /* in the triad */
    term_kind kind;
    bool taken_out, needs_temperature;
} term;

#define TRIAD(field) offsetof(imk_triad, field)
static const term terms[] = {
    {"bias.fixed", TRIAD(bias.fixed), OF_AXES, true, false},
    {"bias.temperature", TRIAD(bias.temperature), OF_POLYNOMIAL, true, true},
    {"bias.temperature_rate", TRIAD(bias.temperature_rate), OF_AXES, true, true},
    {"bias.warm_up", TRIAD(bias.warm_up_amplitude), OF_AXES, true, false},
    {"scale_factor.fixed", TRIAD(scale_factor.fixed), OF_AXES, true, false},
    {"scale_factor.temperature", TRIAD(scale_factor.temperature), OF_POLYNOMIAL, true, true},
    {"nonlinearity.k2", TRIAD(nonlinearity.k2), OF_AXES, true, false},
    {"nonlinearity.koq", TRIAD(nonlinearity.koq), OF_AXES, true, false},
    {"nonlinearity.k3", TRIAD(nonlinearity.k3), OF_AXES, true, false},
    {"nonlinearity.asymmetry", TRIAD(nonlinearity.asymmetry), OF_AXES, true, false},
    {"cross_products", TRIAD(nonlinearity.cross_products), OF_ROWS, true, false},
    {"misalignment", TRIAD(misalignment), OF_ROWS, true, false},
    {"cross_axis", TRIAD(cross_axis), OF_ROWS, true, false},
    {"g_sensitivity", TRIAD(g_sensitivity), OF_ROWS, true, false},
    {"g2_sensitivity", TRIAD(g2_sensitivity), OF_QUADRATIC, true, false},
    {"lever_arm", TRIAD(lever_arm), OF_ROWS, true, false},
    {"sensitivity", TRIAD(sensitivity), OF_AXES, true, false},
    {"bias.repeatability", TRIAD(bias.repeatability), OF_AXES, false, false},
    {"bias.hysteresis", TRIAD(bias.hysteresis), OF_AXES, false, false},
    {"scale_factor.repeatability", TRIAD(scale_factor.repeatability), OF_AXES, false, false},
    {"bandwidth", TRIAD(bandwidth), OF_AXES, false, false},
    {"dead_band", TRIAD(dead_band), OF_AXES, false, false},
    {"resolution", TRIAD(resolution), OF_AXES, false, false},
};
enum { TERM_COUNT = sizeof terms / sizeof terms[0] };

static bool any_value(const double *values, size_t count)
{
    for (size_t i = 0; i < count; i++)
        if (values[i] != 0)
            return true;
    return false;
}

static bool is_there(const imk_triad *triad, const term *t)
{
    const char *place = (const char *)triad + t->offset;
    size_t axes = (size_t)triad->axis_count;
    const imk_temperature_polynomial *polynomial = (const void *)place;
    switch (t->kind) {
    case OF_AXES:
        return any_value(((const imk_axes *)(const void *)place)->value, axes);
    case OF_ROWS:
        return any_value(&((const imk_rows *)(const void *)place)->value[0][0], 3 * axes);
    case OF_QUADRATIC:
        return any_value(&((const imk_quadratic_rows *)(const void *)place)->value[0][0], 6 * axes);
    case OF_POLYNOMIAL:
        for (int i = 0; i < polynomial->order; i++)
            if (any_value(polynomial->coefficient[i].value, axes))
                return true;
    }
    return false;
}

static bool is_skewed(const imk_triad *triad)
{
    for (int i = 0; i < triad->axis_count; i++)
        for (int k = 0; k < 3; k++)
            if (triad->direction[i][k] != 0 && triad->direction[i][k] != 1)
                return true;
    return false;
}

static bool has_noise(const imk_noise *noise, int axis_count)
{
    size_t axes = (size_t)axis_count;
    return any_value(noise->white.value, axes) || any_value(noise->bias_instability.value, axes) ||
           any_value(noise->random_walk.value, axes) || any_value(noise->ramp.value, axes) ||
           any_value(noise->quantization.value, axes) || noise->gauss_markov_count > 0 ||
           noise->sinusoid_count > 0 || noise->resonance_count > 0;
}

static void add(imk_term_keys *list, const char *sensor, const char *name)
{
    if (list->count < IMK_TERM_KEYS_MAX)
        snprintf(list->key[list->count++], sizeof list->key[0], "%s.%s", sensor, name);
}

static void add_taken_out(imk_term_keys *list, const imk_triad *triad, const char *sensor)
{
    if (triad->present && is_skewed(triad))
        add(list, sensor, "direction");
    for (size_t i = 0; i < TERM_COUNT; i++)
        if (triad->present && terms[i].taken_out && is_there(triad, &terms[i]))
            add(list, sensor, terms[i].name);
}

static void add_left_in(imk_term_keys *list, const imk_triad *triad, const imk_triad *whole,
                        const char *sensor)
{
    if (!triad->present)
        return;
    for (size_t i = 0; i < TERM_COUNT; i++)
        if (is_there(whole, &terms[i]) && !(terms[i].taken_out && is_there(triad, &terms[i])))
            add(list, sensor, terms[i].name);
    if (has_noise(&whole->noise, whole->axis_count))
        add(list, sensor, "noise");
}

imk_term_keys imki_taken_out(const imk_model *model)
{
    imk_term_keys list = {0};
    add_taken_out(&list, &model->gyro, "gyro");
    add_taken_out(&list, &model->accel, "accel");
    return list;
}

imk_term_keys imki_left_in(const imk_model *model, const imk_model *whole)
{
    imk_term_keys list = {0};
    add_left_in(&list, &model->gyro, &whole->gyro, "gyro");
    add_left_in(&list, &model->accel, &whole->accel, "accel");
    const struct {
        const char *name;
        double value;
    } timing[] = {{"rate_error", whole->timing.rate_error.value},
                  {"jitter", whole->timing.jitter.value},
                  {"skew", whole->timing.skew.value},
                  {"drops", whole->timing.drops.value}};
    for (size_t i = 0; i < 4; i++)
        if (timing[i].value != 0)
            add(&list, "timing", timing[i].name);
    return list;
}

void imk_compensation_model(const imk_model *whole, imk_model *selected)
{
    imk_triad *triads[2] = {&selected->gyro, &selected->accel};
    const imk_triad *from[2] = {&whole->gyro, &whole->accel};
    for (int sensor = 0; sensor < 2; sensor++) {
        triads[sensor]->range = from[sensor]->range;
        triads[sensor]->resolution = from[sensor]->resolution;
        triads[sensor]->noise.quantization = from[sensor]->noise.quantization;
    }
}

bool imki_temperature_term(const imk_model *model, char *name, size_t size)
{
    const imk_triad *triads[2] = {&model->gyro, &model->accel};
    for (size_t i = 0; i < TERM_COUNT; i++)
        for (int sensor = 0; sensor < 2 && terms[i].needs_temperature; sensor++)
            if (triads[sensor]->present && is_there(triads[sensor], &terms[i])) {
                snprintf(name, size, "%s.%s", sensor == 0 ? "gyro" : "accel", terms[i].name);
                return true;
            }
    return false;
}
