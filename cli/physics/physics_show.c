/* SPDX-License-Identifier: Apache-2.0 */
/* What an instrument did, or is, as data, on the terminal and on a page. */
#include "physics_parts.h"

#include <math.h>

const char *physics_name(const physics *p)
{
    return p->file.name[0] ? p->file.name : p->settings.instrument->title;
}

static double internal_step(const physics *p)
{
    return p->settings.physics.step > 0
               ? fmin(p->settings.physics.step, 1 / p->settings.physics.rate)
               : p->settings.instrument->step_length(p->settings.design, &p->settings.physics);
}

/* ---- data ------------------------------------------------------------------------------------ */

static void vector_data(const char *key, const double v[3], const char *unit, imk_result *result)
{
    imk_result_array(result, key);
    for (int k = 0; k < 3; k++)
        imk_result_quantity(result, NULL, v[k], unit);
    imk_result_end(result);
}

static void settings_data(const physics *p, imk_result *result)
{
    const imk_exposure *e = &p->settings.input.exposure;
    imk_result_text(result, "instrument", p->settings.instrument->name);
    imk_result_quantity(result, "output_rate", p->settings.physics.rate, "Hz");
    imk_result_text(result, "level", p->settings.physics.level == IMK_LEVEL_FULL ? "full" : "slow");
    imk_result_flag(result, "noise", p->settings.physics.noise);
    imk_result_count(result, "seed", (long long)p->settings.physics.seed);
    vector_data("rate", e->angular_rate, "rad/s", result);
    vector_data("acceleration", e->specific_force, "m/s^2", result);
    if (p->settings.input.frequency > 0)
        imk_result_quantity(result, "sine", p->settings.input.frequency, "Hz");
    else
        imk_result_null(result, "sine");
    imk_result_quantity(result, "temperature", e->temperature, "K");
}

static void run_data(const physics *p, const imk_physics_log *r, imk_result *result)
{
    const imk_instrument *instrument = p->settings.instrument;
    imk_result_count(result, "samples", (long long)r->samples);
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

static void show_data(const physics *p, const imk_physics_log *r, const physics_laboratory *l,
                      imk_result *result)
{
    const bool overview = !r && !p->options->reduce && !l;
    imk_result_object(result, "inputs");
    imk_result_text(result, "design", p->source);
    if (!overview)
        settings_data(p, result);
    imk_result_end(result);
    imk_result_object(result, "result");
    if (overview) {
        physics_instrument_data(p->settings.instrument, "instrument", result);
        physics_design_data(p, result);
    }
    if (r)
        run_data(p, r, result);
    else
        physics_model_data(p->model, p->settings.instrument->sensor, result);
    if (l)
        physics_laboratory_data(p, l, result);
    imk_result_end(result);
}

/* ---- terminal -------------------------------------------------------------------------------- */

static void show_run(const physics *p, const imk_physics_log *r, imk_result *result)
{
    char length[60];
    imk_readable_duration(p->options->duration, length, sizeof length);
    imk_result_line(result, "%s: %llu samples at %g Hz, %s, %s, internal step %.4g s\n",
                    physics_name(p), (unsigned long long)r->samples, p->settings.physics.rate,
                    length,
                    p->settings.physics.level == IMK_LEVEL_FULL ? "full dynamics" : "slow map",
                    internal_step(p));
    imk_table *table = imk_result_table(result, 0xeu);
    imk_table_row(table, "output\tmean\tstandard deviation\tat the end\tunit");
    for (size_t i = 0; i < p->settings.instrument->output_count; i++) {
        const imk_unit unit = imk_physics_output_unit(r, i);
        imk_table_row(table, "%s\t%.8g", p->settings.instrument->outputs[i].name,
                      (r->mean[i] - unit.offset) / unit.scale);
        imk_table_add(table, r->samples > 1 ? "%.5g" : "-", r->deviation[i] / unit.scale);
        imk_table_add(table, "%.8g\t%s", (r->last[i] - unit.offset) / unit.scale,
                      physics_unit_text(unit.text));
    }
}

static void show_models(const physics *p, const physics_laboratory *l, imk_result *result)
{
    const bool reduce = p->options->reduce;
    if (reduce) {
        imk_result_line(result, "Error model by closed forms, one axis");
        physics_show_model(p->model, p->settings.instrument->sensor, result);
    }
    if (l) {
        imk_result_line(result, "%sClosed forms against experiments", reduce ? "\n" : "");
        physics_show_laboratory(l, result);
    }
}

/* ---- page ------------------------------------------------------------------------------------ */

/* Pictures that a plot draws too. */
static const imk_audience pictures = IMK_FOR_PAGE | IMK_FOR_PLOT;

static void show_page(const physics *p, imk_result *result)
{
    physics_show_views(p, result);
    imk_result_heading(result, "Design");
    physics_show_design(p, result);
    imk_result_heading(result, "Reduced error model");
    physics_show_model(p->model, p->settings.instrument->sensor, result);
    imk_result_line(result, "From the design by closed forms; one axis, along x.");
    show_model(result, "As a file", p->model);
}

int physics_show(const physics *p, const imk_physics_log *r, const physics_laboratory *l,
                 imk_result *result)
{
    const physics_options *o = p->options;
    const imk_instrument *instrument = p->settings.instrument;
    bool drawn = true;
    int code = -1;
    show_data(p, r, l, result);
    imk_result_for(result, IMK_FOR_TERMINAL);
    if (r)
        show_run(p, r, result);
    else if (l || o->reduce)
        show_models(p, l, result);
    else
        physics_show_overview(p, result);
    imk_result_title(result, physics_name(p), "%.120s. Default design: %.240s", instrument->title,
                     instrument->source);
    imk_result_for(result, IMK_FOR_PAGE);
    if (p->file.description[0])
        imk_result_line(result, "%s", p->file.description);
    if (r) {
        imk_result_heading(result, "Outputs against time");
        imk_result_for(result, pictures);
        physics_show_run_figure(p, r, result);
        imk_result_for(result, IMK_FOR_PAGE);
    }
    if (o->report)
        show_page(p, result);
    if (l) {
        imk_result_heading(result, "Closed forms against experiments");
        physics_show_laboratory(l, result);
        imk_result_for(result, pictures);
        drawn = physics_show_laboratory_figure(p, l, result);
    } else if (o->plot && !r) {
        imk_result_for(result, IMK_FOR_PLOT);
        code = physics_show_view_figure(p, result);
    }
    imk_result_for(result, IMK_FOR_PAGE);
    for (size_t i = 0; i < command_warning_count(); i++) /* all are known now */
        imk_result_finding(result, 2, command_warning_get(i)->message);
    show_origin(result);
    return o->plot && !drawn ? command_failed("nothing was measured that can be drawn") : code;
}
