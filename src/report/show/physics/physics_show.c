/* SPDX-License-Identifier: Apache-2.0 */
/* The run or the design of an instrument, as data, on the terminal and on a page. */
#include "physics_show_internal.h"

#include <math.h>

const char *imki_physics_name(const imk_physics_shown *p)
{
    return p->name && p->name[0] ? p->name : p->settings->instrument->title;
}

static double internal_step(const imk_physics_shown *p)
{
    return p->settings->physics.step > 0
               ? fmin(p->settings->physics.step, 1 / p->settings->physics.rate)
               : p->settings->instrument->step_length(p->settings->design, &p->settings->physics);
}

/* ---- data ------------------------------------------------------------------------------------ */

static void vector_data(const char *key, const double v[3], const char *unit, imk_result *result)
{
    imk_result_array(result, key);
    for (int k = 0; k < 3; k++)
        imk_result_quantity(result, NULL, v[k], unit);
    imk_result_end(result);
}

static void settings_data(const imk_physics_shown *p, imk_result *result)
{
    const imk_exposure *e = &p->settings->input.exposure;
    imk_result_text(result, "instrument", p->settings->instrument->name);
    imk_result_quantity(result, "output_rate", p->settings->physics.rate, "Hz");
    imk_result_text(result, "level",
                    p->settings->physics.level == IMK_LEVEL_FULL ? "full" : "slow");
    imk_result_flag(result, "noise", p->settings->physics.noise);
    imk_result_count(result, "seed", (long long)p->settings->physics.seed);
    vector_data("rate", e->angular_rate, "rad/s", result);
    vector_data("acceleration", e->specific_force, "m/s^2", result);
    if (p->settings->input.frequency > 0)
        imk_result_quantity(result, "sine", p->settings->input.frequency, "Hz");
    else
        imk_result_null(result, "sine");
    imk_result_quantity(result, "temperature", e->temperature, "K");
}

static void run_data(const imk_physics_shown *p, const imk_physics_log *r, imk_result *result)
{
    const imk_instrument *instrument = p->settings->instrument;
    imk_result_count(result, "rows", (long long)r->samples);
    imk_result_quantity(result, "internal_step", internal_step(p), "s");
    imk_result_array(result, "outputs");
    for (size_t i = 0; i < instrument->output_count; i++) {
        const imk_signal *signal = &instrument->outputs[i];
        imk_result_object(result, NULL);
        imk_result_text(result, "name", signal->name);
        imk_result_quantity(result, "mean", r->mean[i], signal->si);
        imk_result_quantity(result, "standard_deviation", r->deviation[i], signal->si);
        imk_result_quantity(result, "at_the_end", r->last[i], signal->si);
        imk_result_end(result);
    }
    imk_result_end(result);
}

static void show_data(const imk_physics_shown *p, imk_result *result)
{
    const imk_physics_log *r = p->run;
    const imk_physics_sweep *l = p->sweep;
    const bool overview = !r && !p->reduced && !l;
    imk_result_object(result, "inputs");
    imk_result_text(result, "design", p->source);
    if (!overview)
        settings_data(p, result);
    imk_result_end(result);
    imk_result_object(result, "result");
    imki_judge_physics(p, result);
    if (overview) {
        imki_instrument_data(p->settings->instrument, "instrument", result);
        imki_design_data(p, result);
    }
    if (r)
        run_data(p, r, result);
    else
        imki_reduced_data(p->model, p->settings->instrument->sensor, result);
    if (!r)
        imki_derived_data(p, result);
    if (l)
        imki_sweep_data(l, p->settings->instrument->sensor, result);
    imk_result_end(result);
}

/* ---- terminal -------------------------------------------------------------------------------- */

static void show_run(const imk_physics_shown *p, const imk_physics_log *r, imk_result *result)
{
    char length[60];
    imk_readable_duration(p->settings->duration, length, sizeof length);
    imk_result_line(result, "%s: %llu sample%s at %g Hz, %s, %s, internal step %.4g s\n",
                    imki_physics_name(p), (unsigned long long)r->samples,
                    r->samples == 1 ? "" : "s", p->settings->physics.rate, length,
                    p->settings->physics.level == IMK_LEVEL_FULL ? "full dynamics" : "slow map",
                    internal_step(p));
    imk_table *table = imk_result_table(result, 0xeu);
    imk_table_row(table, "output\tmean\tstandard deviation\tat the end\tunit");
    for (size_t i = 0; i < p->settings->instrument->output_count; i++) {
        const imk_unit unit = imk_physics_output_unit(r, i);
        imk_table_row(table, "%s\t%.8g", p->settings->instrument->outputs[i].name,
                      (r->mean[i] - unit.offset) / unit.scale);
        imk_table_add(table, r->samples > 1 ? "%.5g" : "-", r->deviation[i] / unit.scale);
        imk_table_add(table, "%.8g\t%s", (r->last[i] - unit.offset) / unit.scale,
                      imki_unit_text(unit.text));
    }
}

static void show_models(const imk_physics_shown *p, const imk_physics_sweep *l, imk_result *result)
{
    const bool reduce = p->reduced;
    if (reduce) {
        imk_result_line(result, "Error model by closed forms, one axis");
        imki_show_reduced(p->model, p->settings->instrument->sensor, result);
        imk_result_line(result, "\nDerived quantities");
        imki_show_derived(p, result);
    }
    if (l) {
        imk_result_line(result, "%sClosed forms against experiments", reduce ? "\n" : "");
        imki_show_sweep(l, result);
    }
}

/* ---- all ------------------------------------------------------------------------------------- */

/* Pictures that a plot draws too. */
static const imk_audience pictures = IMK_FOR_PAGE | IMK_FOR_PLOT;

void imk_show_physics(const imk_physics_shown *p, imk_result *result)
{
    const imk_instrument *instrument = p->settings->instrument;
    show_data(p, result);
    imk_result_for(result, IMK_FOR_TERMINAL);
    if (p->run)
        show_run(p, p->run, result);
    else if (p->sweep || p->reduced)
        show_models(p, p->sweep, result);
    else
        imki_show_overview(p, result);
    imk_result_title(result, imki_physics_name(p), "%.120s. Default design: %.240s",
                     instrument->title, instrument->source);
    imk_result_for(result, IMK_FOR_PAGE);
    if (p->description && p->description[0])
        imk_result_line(result, "%s", p->description);
    imki_show_schematic(p, result);
    if (!p->run)
        return;
    imk_result_heading(result, "Outputs against time");
    imk_result_for(result, pictures);
    imki_show_physics_run(p, result);
    imk_result_for(result, IMK_FOR_PAGE);
}

void imk_show_physics_design(const imk_physics_shown *p, imk_result *result)
{
    imk_result_heading(result, "Design");
    imki_show_design(p, result);
    imk_result_heading(result, "Derived quantities");
    imki_show_derived(p, result);
    imk_result_heading(result, "Reduced error model");
    imki_show_reduced(p->model, p->settings->instrument->sensor, result);
    imk_result_line(result, "From the design by closed forms; one axis, along x.");
}

void imk_show_physics_sweep(const imk_physics_shown *p, imk_result *result)
{
    imk_result_heading(result, "Closed forms against experiments");
    imki_show_sweep(p->sweep, result);
    imk_result_for(result, pictures);
    imki_show_sweep_figure(p, result);
    imk_result_for(result, IMK_FOR_PAGE);
}
