/* SPDX-License-Identifier: Apache-2.0 */
/* The error model of an instrument by closed forms, and beside it the results of laboratory
 * experiments, as tables and as data. */
#include "physics_show_internal.h"

#include <math.h>
#include <stdio.h>
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

/* The figures of a laboratory, and the figures that its experiments do not find. */
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

const char *imki_unit_text(const char *unit)
{
    return strcmp(unit, "1") == 0 ? "" : unit;
}

void imki_show_reduced(const imk_model *model, int sensor, imk_result *result)
{
    imk_laboratory_figure figures[FIGURES_MAX];
    const size_t count = all_figures(model, sensor, figures);
    imk_table *table = imk_result_table(result, 2u);
    imk_table_row(table, "parameter\tvalue\tunit");
    for (const imk_laboratory_figure *f = figures; f < figures + count; f++)
        if (f->value != 0 && !isnan(f->value))
            imk_table_row(table, "%s\t%.5g\t%s", f->key, f->value / imk_unit_of(f->unit).scale,
                          imki_unit_text(f->unit));
}

/* Of several terms of a kind: sigma, sigma[1], … */
void imki_reduced_data(const imk_model *model, int sensor, imk_result *result)
{
    imk_laboratory_figure figures[FIGURES_MAX];
    const size_t count = all_figures(model, sensor, figures);
    imk_result_object(result, "reduced");
    for (size_t i = 0; i < count; i++) {
        int before = 0;
        for (size_t j = 0; j < i; j++)
            before += strcmp(figures[j].key, figures[i].key) == 0;
        imk_result_quantity(result,
                            before == 0 ? figures[i].key
                                        : imk_result_key(result, "%s[%d]", figures[i].key, before),
                            figures[i].value, figures[i].si);
    }
    imk_result_end(result);
}

/* ---- experiments ----------------------------------------------------------------------------- */

/* A row for what the closed forms state, and for what was found although they do not. */
static bool says_something(const imk_physics_sweep *l, size_t i)
{
    return l->computed[i].value != 0 || l->verdict[i] == IMK_LABORATORY_DIFFERS ||
           l->verdict[i] == IMK_LABORATORY_CLOSE;
}

/* Terms that are zero in the closed forms, by their verdict; of those that were not measured, the
 * ones whose experiment gave no number. */
static void show_zeros(const imk_physics_sweep *l, imk_laboratory_verdict verdict,
                       const char *words, imk_result *result)
{
    char line[1200];
    size_t length = 0;
    for (size_t i = 0; i < l->count && length < sizeof line; i++)
        if (!says_something(l, i) && l->verdict[i] == verdict &&
            (verdict != IMK_LABORATORY_NOT_MEASURED || l->result.effort[i].seconds > 0))
            length += (size_t)snprintf(line + length, sizeof line - length, "%s%s",
                                       length > 0 ? ", " : "", l->computed[i].key);
    if (length > 0)
        imk_result_line(result, "%s: %s.", words, line);
}

void imki_show_sweep(const imk_physics_sweep *l, imk_result *result)
{
    char verdict[100];
    imk_table *table = imk_result_table(result, 0xeu);
    imk_table_row(table, "parameter\tclosed form\texperiment\t1 sigma\tunit\t");
    for (size_t i = 0; i < l->count; i++) {
        const imk_laboratory_figure *computed = &l->computed[i], *found = &l->found[i];
        const double scale = imk_unit_of(found->unit).scale;
        if (!says_something(l, i))
            continue;
        imk_table_row(table, "%s\t%.5g", found->key, computed->value / scale);
        if (l->verdict[i] == IMK_LABORATORY_NOT_MEASURED)
            imk_table_add(table, "-\t-");
        else
            imk_table_add(table, "%.5g\t%.2g", found->value / scale, found->sigma / scale);
        imk_table_add(table, "%s\t%s", imki_unit_text(found->unit),
                      imk_physics_sweep_verdict(l, i, verdict, sizeof verdict));
    }
    show_zeros(l, IMK_LABORATORY_AGREES, "Zero in both", result);
    show_zeros(l, IMK_LABORATORY_CANNOT_TELL,
               "Zero in the closed forms, not told by the experiment", result);
    show_zeros(l, IMK_LABORATORY_NOT_MEASURED,
               "Zero in the closed forms, and the readings of the experiment are no numbers",
               result);
}

static void show_points(const imk_laboratory_result *r, const char *si, imk_result *result)
{
    imk_result_array(result, "points");
    for (int i = 0; i < r->point_count; i++) {
        imk_result_object(result, NULL);
        imk_result_quantity(result, "input", r->point[i].input, si);
        imk_result_quantity(result, "output", r->point[i].output, si);
        imk_result_quantity(result, "sigma", r->point[i].sigma, si);
        imk_result_quantity(result, "error", r->point[i].error, si);
        imk_result_quantity(result, "error_sigma", r->point[i].error_sigma, si);
        imk_result_quantity(result, "computed", r->point[i].computed, si);
        imk_result_end(result);
    }
    imk_result_end(result);
    imk_result_array(result, "responses");
    for (int i = 0; i < r->response_count; i++) {
        imk_result_object(result, NULL);
        imk_result_quantity(result, "frequency", r->response[i].frequency, "Hz");
        imk_result_quantity(result, "gain", r->response[i].gain, "1");
        imk_result_quantity(result, "phase", r->response[i].phase, "rad");
        imk_result_end(result);
    }
    imk_result_end(result);
}

void imki_sweep_data(const imk_physics_sweep *l, int sensor, imk_result *result)
{
    const char *si = sensor == IMK_GYRO ? "rad/s" : "m/s^2";
    const imk_laboratory_result *r = &l->result;
    imk_result_object(result, "experiment");
    imk_result_object(result, "figures");
    for (size_t i = 0; i < l->count; i++) {
        const imk_laboratory_figure *computed = &l->computed[i], *found = &l->found[i];
        imk_result_object(result, found->key);
        imk_result_quantity(result, "closed_form", computed->value, found->si);
        imk_result_quantity(result, "experiment", found->value, found->si);
        imk_result_quantity(result, "sigma", found->sigma, found->si);
        imk_result_text(result, "verdict", imk_laboratory_verdict_text(l->verdict[i]));
        imk_result_quantity(result, "matters", r->matters[i], found->si);
        imk_result_quantity(result, "seconds", r->effort[i].seconds, "s");
        if (isfinite(r->effort[i].needs) && l->verdict[i] != IMK_LABORATORY_NOT_MEASURED)
            imk_result_quantity(result, "seconds_needed", r->effort[i].needs, "s");
        else
            imk_result_null(result, "seconds_needed");
        imk_result_text(result, "limit", r->effort[i].limit ? r->effort[i].limit : "");
        imk_result_end(result);
    }
    imk_result_end(result);
    imk_result_quantity(result, "full_scale", r->full_scale, si);
    imk_result_quantity(result, "line_deviation", r->line_deviation, "1");
    imk_result_quantity(result, "threshold", r->threshold, si);
    imk_result_quantity(result, "bandwidth", r->bandwidth, "Hz");
    show_points(r, si, result);
    imk_result_end(result);
}
