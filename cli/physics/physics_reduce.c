/* SPDX-License-Identifier: Apache-2.0 */
/* The error model of an instrument: as a table, as JSON, as a model file. */
#include "physics_parts.h"

#include "imukit/model_file.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { FIGURES_MAX = IMK_LABORATORY_FIGURES_MAX + 12 + 7 * IMK_TERMS_MAX };

static size_t add(imk_laboratory_figure *figures, size_t count, const char *key, const char *si,
                  const char *unit, const imk_axes *axes)
{
    figures[count] = (imk_laboratory_figure){key, si, unit, axes->value[0], axes->sigma[0]};
    return count + 1;
}

/* Several terms of a kind have the same keys, in the order of the model file. */
static size_t add_terms(imk_laboratory_figure *figures, size_t n, const imk_noise *noise,
                        const char *si, const char *unit)
{
    for (int i = 0; i < noise->gauss_markov_count; i++) {
        n = add(figures, n, "noise.gauss_markov.sigma", si, unit, &noise->gauss_markov[i].sigma);
        n = add(figures, n, "noise.gauss_markov.correlation_time", "s", "s",
                &noise->gauss_markov[i].correlation_time);
    }
    for (int i = 0; i < noise->sinusoid_count; i++) {
        n = add(figures, n, "noise.sinusoid.amplitude", si, unit, &noise->sinusoid[i].amplitude);
        n = add(figures, n, "noise.sinusoid.frequency", "Hz", "Hz", &noise->sinusoid[i].frequency);
    }
    for (int i = 0; i < noise->resonance_count; i++) {
        n = add(figures, n, "noise.resonance.sigma", si, unit, &noise->resonance[i].sigma);
        n = add(figures, n, "noise.resonance.frequency", "Hz", "Hz",
                &noise->resonance[i].frequency);
        n = add(figures, n, "noise.resonance.q", "1", "1", &noise->resonance[i].q);
    }
    return n;
}

/* The figures of a laboratory and those that its experiments do not find. */
static size_t all_figures(const imk_model *model, int sensor, imk_laboratory_figure *figures)
{
    const bool gyro = sensor == IMK_GYRO;
    const imk_triad *t = gyro ? &model->gyro : &model->accel;
    const char *si = gyro ? "rad/s" : "m/s^2", *small = gyro ? "deg/h" : "ug";
    size_t n = imk_laboratory_figures(model, sensor, figures);
    n = add(figures, n, "bias.repeatability", si, small, &t->bias.repeatability);
    n = add(figures, n, "bias.warm_up_amplitude", si, small, &t->bias.warm_up_amplitude);
    n = add(figures, n, "bias.hysteresis", si, small, &t->bias.hysteresis);
    n = add(figures, n, "scale_factor.repeatability", "1", "ppm", &t->scale_factor.repeatability);
    figures[n++] = (imk_laboratory_figure){
        "misalignment.y", "rad", "mrad", t->misalignment.value[0][1], t->misalignment.sigma[0][1]};
    figures[n++] = (imk_laboratory_figure){
        "misalignment.z", "rad", "mrad", t->misalignment.value[0][2], t->misalignment.sigma[0][2]};
    n = add(figures, n, "damping", "1", "1", &t->damping);
    n = add(figures, n, "resolution", si, small, &t->resolution);
    n = add(figures, n, "range", si, gyro ? "deg/s" : "m/s^2", &t->range);
    return add_terms(figures, n, &t->noise, si, small);
}

text_table physics_model_table(const imk_model *model, int sensor)
{
    imk_laboratory_figure figures[FIGURES_MAX];
    const size_t count = all_figures(model, sensor, figures);
    text_table table = text_table_make(3);
    table.right = 2u;
    text_table_row(&table);
    text_table_set(&table, 0, "parameter");
    text_table_set(&table, 1, "value");
    text_table_set(&table, 2, "unit");
    for (size_t i = 0; i < count; i++) {
        if (figures[i].value == 0 || isnan(figures[i].value))
            continue;
        text_table_row(&table);
        text_table_set(&table, 0, "%s", figures[i].key);
        text_table_set(&table, 1, "%.5g", figures[i].value / imk_unit_of(figures[i].unit).scale);
        text_table_set(&table, 2, "%s", strcmp(figures[i].unit, "1") == 0 ? "" : figures[i].unit);
    }
    return table;
}

json_t *physics_model_json(const imk_model *model, int sensor)
{
    imk_laboratory_figure figures[FIGURES_MAX];
    const size_t count = all_figures(model, sensor, figures);
    json_t *result = json_object();
    for (size_t i = 0; i < count; i++) {
        char key[80];
        int number = 1; /* of several terms of a kind: sigma, sigma[1], … */
        snprintf(key, sizeof key, "%s", figures[i].key);
        while (json_object_get(result, key))
            snprintf(key, sizeof key, "%s[%d]", figures[i].key, number++);
        json_object_set_new(result, key, json_quantity(figures[i].value, figures[i].si));
    }
    return result;
}

int physics_write_model(const physics *p, const imk_model *model, const char *path)
{
    imk_error error;
    imk_model *copy = malloc(sizeof *copy);
    if (!copy)
        return command_failed("memory is exhausted");
    *copy = *model;
    if (p->file.name[0])
        snprintf(copy->name, sizeof copy->name, "%s", p->file.name);
    if (!p->options->single_axis)
        imk_model_three_axes(copy);
    const imk_status status = imk_model_write(path, copy, NULL, &error);
    free(copy);
    return status == IMK_OK ? -1 : command_error(&error, NULL);
}
