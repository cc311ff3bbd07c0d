/* SPDX-License-Identifier: Apache-2.0 */
/* Drift as a result: what the error grows to, and which terms make it. */
#include "drift_parts.h"

#include <math.h>
#include <stdlib.h>

/* ---- data ---- */

static const struct {
    const char *key, *unit;
    size_t offset;
} figures[DRIFT_FIGURES] = {
    {"cep", "m", offsetof(imk_drift_figures, cep)},
    {"r95", "m", offsetof(imk_drift_figures, r95)},
    {"drms", "m", offsetof(imk_drift_figures, drms)},
    {"north", "m", offsetof(imk_drift_figures, north)},
    {"east", "m", offsetof(imk_drift_figures, east)},
    {"height", "m", offsetof(imk_drift_figures, height)},
    {"velocity", "m/s", offsetof(imk_drift_figures, velocity)},
    {"climb", "m/s", offsetof(imk_drift_figures, climb)},
    {"tilt", "rad", offsetof(imk_drift_figures, tilt)},
    {"heading", "rad", offsetof(imk_drift_figures, heading)},
};

double drift_figure(const imk_drift_figures *f, int index)
{
    return *(const double *)((const char *)f + figures[index].offset);
}

static void show_figures(const char *key, const imk_drift_figures *f, imk_result *result)
{
    imk_result_object(result, key);
    for (int i = 0; i < DRIFT_FIGURES; i++)
        imk_result_quantity(result, figures[i].key, drift_figure(f, i), figures[i].unit);
    imk_result_end(result);
}

static void show_runs_data(const drift_result *r, imk_result *result)
{
    imk_result_object(result, "monte_carlo");
    imk_result_count(result, "runs", (long long)r->run_count);
    imk_result_array(result, "times");
    for (size_t k = 0; k < r->scene->row_count; k++) {
        imk_result_object(result, NULL);
        imk_result_quantity(result, "time", r->scene->time[r->scene->row[k]], "s");
        imk_result_count(result, "runs", (long long)r->used[k]);
        show_figures("figures", &r->found[k], result);
        show_figures("lower", &r->low[k], result);
        show_figures("upper", &r->high[k], result);
        imk_result_end(result);
    }
    imk_result_end(result);
    imk_result_end(result);
}

static void show_budget_data(const drift_case *one, imk_result *result)
{
    const imk_drift_analysis *a = one->analysis;
    imk_result_array(result, "budget");
    for (size_t i = 0; i < one->share_count; i++) {
        const drift_share *s = &one->share[i];
        const double *mean = a->contribution[s->source * a->time_count + one->time].mean;
        imk_result_object(result, NULL);
        imk_result_text(result, "source", a->source[s->source].name);
        imk_result_text(result, "text", a->source[s->source].text);
        imk_result_number(result, "share", s->share);
        show_figures("figures", &s->whole, result);
        imk_result_quantity(result, "mean_north", mean[0], "m");
        imk_result_quantity(result, "mean_east", mean[1], "m");
        imk_result_end(result);
    }
    imk_result_end(result);
}

static void show_case(const drift_result *r, const drift_case *one, imk_result *result)
{
    static const char *const validity[] = {"linear", "rough", "no_position"};
    const drift_scene *scene = r->scene;
    imk_result_object(result, NULL);
    imk_result_text(result, "model", one->name);
    imk_result_flag(result, "compensated", one->settings.compensated);
    imk_result_array(result, "times");
    for (size_t k = 0; k < scene->row_count; k++) {
        const imk_drift_figures *f = &one->figures[scene->row[k]];
        imk_result_object(result, NULL);
        imk_result_quantity(result, "time", scene->time[scene->row[k]], "s");
        imk_result_text(result, "validity", validity[imk_drift_validity_of(f)]);
        show_figures("figures", f, result);
        imk_result_end(result);
    }
    imk_result_end(result);
    imk_result_quantity(result, "budget_time", scene->time[one->time], "s");
    show_budget_data(one, result);
    imk_result_array(result, "omitted");
    for (size_t i = 0; i < one->analysis->omitted_count; i++)
        imk_result_text(result, NULL, one->analysis->omitted[i]);
    imk_result_end(result);
    imk_result_end(result);
}

static void show_inputs(const drift_result *r, imk_result *result)
{
    static const char *const units[] = {"m", "m/s", "rad"};
    const imk_drift_settings *s = &r->scene->settings;
    imk_result_object(result, "inputs");
    imk_result_array(result, "models");
    for (size_t m = 0; m < r->model_count; m++)
        imk_result_text(result, NULL, r->name[m]);
    imk_result_end(result);
    imk_result_text(result, "motion", r->scene->motion ? r->options->motion : NULL);
    imk_result_quantity(result, "rate", s->rate, "Hz");
    imk_result_text(result, "vertical", s->vertical == IMK_VERTICAL_FREE ? "free" : "slaved");
    imk_result_text(result, "aligned", s->alignment == IMK_ALIGNED_SELF ? "self" : "given");
    imk_result_array(result, "initial_sigma");
    for (int i = 0; i < IMK_DRIFT_STATES; i++)
        imk_result_quantity(result, NULL, s->initial_sigma[i], units[i / 3]);
    imk_result_end(result);
    if (!r->scene->motion) {
        imk_result_quantity(result, "latitude", s->latitude, "rad");
        imk_result_quantity(result, "height", s->height, "m");
        imk_result_quantity(result, "roll", s->roll, "rad");
        imk_result_quantity(result, "pitch", s->pitch, "rad");
        imk_result_quantity(result, "yaw", s->yaw, "rad");
    }
    if (s->alignment == IMK_ALIGNED_SELF)
        imk_result_quantity(result, "alignment_time", s->alignment_time, "s");
    if (r->found)
        imk_result_count(result, "seed", (long long)r->options->seed.value);
    imk_result_end(result);
}

static void show_data(const drift_result *r, const drift_answer *answer, imk_result *result)
{
    show_inputs(r, result);
    imk_result_object(result, "result");
    imk_result_array(result, "models");
    for (size_t c = 0; c < r->case_count; c++)
        show_case(r, &r->cases[c], result);
    imk_result_end(result);
    if (r->found)
        show_runs_data(r, result);
    if (answer)
        drift_show_answer_data(r, answer, result);
    imk_result_end(result);
}

/* ---- sentences ---- */

/* "at rest at 45 deg north; attitude true at the start, height held by other means." */
static growing_list conditions_of(const drift_result *r)
{
    const imk_drift_settings *s = &r->scene->settings;
    growing_list text = {0};
    if (r->scene->motion)
        list_add(&text, "on %s", r->options->motion);
    else
        list_add(&text, "at rest at %.4g deg %s", fabs(s->latitude) / imk_unit_of("deg").scale,
                 s->latitude < 0 ? "south" : "north");
    list_add(&text, "; attitude %s at the start, height %s.",
             s->alignment == IMK_ALIGNED_SELF ? "found by the unit itself"
             : s->initial_sigma[6] + s->initial_sigma[7] + s->initial_sigma[8] > 0 ? "given"
                                                                                   : "true",
             s->vertical == IMK_VERTICAL_FREE ? "free" : "held by other means");
    return text;
}

static void show_title(const drift_result *r, imk_result *result)
{
    growing_list text = conditions_of(r), names = {0};
    for (size_t m = 0; m < r->model_count; m++)
        list_add_item(&names, "%s", r->name[m]);
    if (names.size > 0) {
        imk_result_for(result, IMK_FOR_TERMINAL);
        imk_result_line(result, IMK_BOLD "Error growth" IMK_PLAIN " of %s %s", names.text,
                        text.text);
    }
    text.text[0] = (char)(text.text[0] - 'a' + 'A');
    imk_result_for(result, IMK_FOR_PAGE);
    imk_result_title(result, "Error growth", "%s", r->model_count > 1 ? "" : r->name[0]);
    imk_result_line(result, "%s", text.text);
    show_warnings(result);
    list_free(&names);
    list_free(&text);
}

/* Of several models only what decides. */
static void show_deciding(const drift_result *r, imk_result *result)
{
    imk_result_gap(result);
    for (size_t c = 0; c < r->case_count; c++) {
        const drift_case *one = &r->cases[c];
        char text[DRIFT_TIME_TEXT];
        if (one->share_count > 0 && one->share[0].share > 0)
            imk_result_line(result, "%s: after %s %s makes %.0f %% of the variance", one->label,
                            drift_time(r->scene->time[one->time], IMK_DRIFT_LINEAR, text),
                            one->analysis->source[one->share[0].source].text,
                            100 * one->share[0].share);
    }
}

/* A wish that can be typed: half of what there is, at a time of the table. */
static void show_wish(const drift_result *r, imk_result *result)
{
    char length[IMK_READABLE_SIZE];
    const drift_case *one = drift_last_case(r);
    const imk_drift_figures *f = &one->figures[one->time];
    const double time = r->scene->time[one->time], hours = time / 3600, minutes = time / 60;
    const bool whole_hours = hours == floor(hours), whole_minutes = minutes == floor(minutes);
    if (!(f->cep > 0) || imk_drift_validity_of(f) == IMK_DRIFT_LOST)
        return;
    imk_result_line(result, "\nNext: what would halve it?  %s --want \"CEP %s @ %.8g%s\"",
                    command_line(), imk_readable_figure(IMK_WISH_CEP, 0.5 * f->cep, length),
                    whole_hours     ? hours
                    : whole_minutes ? minutes
                                    : time,
                    whole_hours     ? "h"
                    : whole_minutes ? "min"
                                    : "s");
}

/* What a reader may want to know next. */
static void show_next(const drift_result *r, imk_result *result)
{
    if (r->model_count > 1 || r->scene->want.asked)
        return;
    if (!r->found)
        show_wish(r, result);
    else if (!r->options->output)
        imk_result_line(result, "\nNext: keep the runs with -o RESULTS.h5");
}

/* ---- all ---- */

/* What stands on the page, and letters have no shades. */
static void show_figure(const drift_result *r, imk_result *result)
{
    imk_result_for(result, IMK_FOR_TERMINAL);
    drift_show_figure(r, false, result);
    imk_result_for(result, IMK_FOR_PAGE);
    drift_show_figure(r, true, result);
}

void drift_show(const drift_result *r, const drift_answer *answer, imk_result *result)
{
    show_data(r, answer, result);
    show_title(r, result);
    show_figure(r, result);
    imk_result_heading(result, r->model_count > 1  ? "Comparison"
                               : r->case_count > 1 ? "Before and after calibration"
                                                   : "Against time");
    imk_result_for(result, IMK_FOR_BOTH);
    drift_show_growth(r, result);
    imk_result_for(result, IMK_FOR_TERMINAL);
    if (r->model_count > 1)
        show_deciding(r, result);
    for (size_t c = 0; c < r->case_count; c++)
        drift_show_budget(r, &r->cases[c], result);
    if (r->found) {
        imk_result_for(result, IMK_FOR_TERMINAL);
        imk_result_line(result,
                        "\nMonte Carlo of %s: %llu runs of the whole mechanisation; in brackets "
                        "95 %% intervals.",
                        drift_last_case(r)->label, (unsigned long long)r->run_count);
        imk_result_for(result, IMK_FOR_PAGE);
        imk_result_heading(result, "Monte Carlo");
        imk_result_for(result, IMK_FOR_BOTH);
        drift_show_runs(r, result);
        imk_result_for(result, IMK_FOR_TERMINAL);
        drift_show_ratios(r, result);
    }
    imk_result_for(result, IMK_FOR_TERMINAL);
    show_next(r, result);
    if (answer)
        drift_show_answer(r, answer, result);
    imk_result_for(result, IMK_FOR_PAGE);
    for (size_t m = 0; m < r->model_count; m++)
        show_model(result, r->name[m], r->model[m]);
    show_origin(result);
}

void drift_show_results(const drift_result *r, const imk_campaign_results *file, imk_result *result)
{
    const imk_campaign *c = &file->campaign;
    const unsigned long long whole = c->run_count, there = file->runs, first = file->run[0];
    imk_result_object(result, "inputs");
    imk_result_text(result, "results", r->name[0]);
    imk_result_text(result, "version", c->version);
    imk_result_count(result, "seed", (long long)c->seed);
    imk_result_count(result, "runs", (long long)whole);
    imk_result_count(result, "first", (long long)first);
    imk_result_count(result, "count", (long long)there);
    (void)imk_result_json(result, "parameters", c->parameters);
    imk_result_end(result);
    imk_result_object(result, "result");
    show_runs_data(r, result);
    imk_result_end(result);
    show_title(r, result);
    show_figure(r, result);
    imk_result_heading(result, "Monte Carlo");
    growing_list runs = {0};
    if (there == whole)
        list_add(&runs, "%llu runs", whole);
    else
        list_add(&runs, "%llu of %llu runs, from run %llu on", there, whole, first);
    imk_result_for(result, IMK_FOR_TERMINAL);
    imk_result_line(result, "%s: %s, seed %llu, imukit %s. In brackets 95 %% intervals.",
                    r->name[0], runs.text, (unsigned long long)c->seed, c->version);
    list_free(&runs);
    imk_result_for(result, IMK_FOR_BOTH);
    drift_show_runs(r, result);
    imk_result_for(result, IMK_FOR_TERMINAL);
    if (there < whole)
        imk_result_line(result,
                        "\nA part of the campaign; the whole: imukit merge PART.h5... -o WHOLE.h5");
    imk_result_for(result, IMK_FOR_PAGE);
    show_origin(result);
}
