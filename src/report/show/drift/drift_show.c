/* SPDX-License-Identifier: Apache-2.0 */
/* Drift as a result: how the error grows, and which terms cause it. */
#include "drift_show_internal.h"
#include "unstated_show_internal.h"

#include "report/result_internal.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>

/* ---- data ---- */

static const struct {
    const char *key, *unit;
    size_t offset;
} figures[] = {
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

static void show_figures(const char *key, const imk_drift_figures *f, imk_result *result)
{
    imk_result_object(result, key);
    for (size_t i = 0; i < sizeof figures / sizeof figures[0]; i++)
        imk_result_quantity(result, figures[i].key,
                            *(const double *)((const char *)f + figures[i].offset),
                            figures[i].unit);
    imk_result_end(result);
}

static void show_runs_data(const imk_drift_models *r, imk_result *result)
{
    imk_result_object(result, "monte_carlo");
    imk_result_count(result, "runs", (long long)r->run_count);
    imk_result_array(result, "times");
    for (size_t k = 0; k < r->times->row_count; k++) {
        imk_result_object(result, NULL);
        imk_result_quantity(result, "time", imki_drift_row_time(r, k), "s");
        imk_result_count(result, "runs", (long long)r->used[k]);
        show_figures("figures", &r->found[k], result);
        show_figures("lower", &r->low[k], result);
        show_figures("upper", &r->high[k], result);
        if (r->nees_degrees > 0) {
            double low, high;
            imki_drift_nees_due(r, k, &low, &high);
            imk_result_object(result, "nees");
            imk_result_number(result, "mean", r->nees[k]);
            imk_result_number(result, "degrees_of_freedom", r->nees_degrees);
            imk_result_number(result, "lower", low);
            imk_result_number(result, "upper", high);
            imk_result_end(result);
        }
        imk_result_end(result);
    }
    imk_result_end(result);
    imk_result_end(result);
}

static void show_budget_data(const imk_drift_case *one, imk_result *result)
{
    const imk_drift_analysis *a = one->analysis;
    imk_result_array(result, "budget");
    for (size_t i = 0; i < one->share_count; i++) {
        const imk_drift_share *s = &one->share[i];
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

/* What was assumed of the model of a case. */
static const imk_unstated *assumed_of(const imk_drift_models *r, const imk_drift_shown *shown,
                                      const imk_drift_case *one)
{
    size_t m = 0;
    while (r->model[m] != one->model)
        m++;
    return shown->assumed ? &shown->assumed[m] : NULL;
}

static void show_case(const imk_drift_models *r, const imk_drift_shown *shown,
                      const imk_drift_case *one, imk_result *result)
{
    static const char *const validity[] = {"linear", "rough", "no_position"};
    const imk_drift_times *times = r->times;
    imk_result_object(result, NULL);
    imk_result_text(result, "model", one->name);
    imk_result_flag(result, "compensated", one->settings.compensated);
    imk_result_array(result, "times");
    for (size_t k = 0; k < times->row_count; k++) {
        const imk_drift_figures *f = &one->figures[times->row[k]];
        imk_result_object(result, NULL);
        imk_result_quantity(result, "time", times->time[times->row[k]], "s");
        imk_result_text(result, "validity", validity[imk_drift_validity_of(f)]);
        show_figures("figures", f, result);
        if (one->analysis->believed) {
            const imk_drift_figures own =
                imk_drift_figures_of(&one->analysis->believed[times->row[k]]);
            show_figures("believed", &own, result);
        }
        imk_result_end(result);
    }
    imk_result_end(result);
    imk_result_quantity(result, "budget_time", times->time[one->time], "s");
    show_budget_data(one, result);
    imk_result_number(result, "correlation_share", one->correlation_share);
    imki_show_texts(result, "omitted", one->analysis->omitted_count, one->analysis->omitted);
    imki_show_missing_data(one->missing_count, one->missing, result);
    imki_show_assumed_data(assumed_of(r, shown, one), result);
    imk_result_end(result);
}

static void show_inputs(const imk_drift_models *r, const imk_drift_shown *shown, imk_result *result)
{
    static const char *const units[] = {"m", "m/s", "rad"};
    const imk_drift_settings *s = &r->settings.drift;
    imk_result_object(result, "inputs");
    imki_show_texts(result, "models", r->model_count, r->name);
    imk_result_text(result, "motion", shown->motion);
    imk_result_quantity(result, "rate", s->rate, "Hz");
    imk_result_text(result, "vertical",
                    imk_drift_vertical(s) == IMK_VERTICAL_FREE ? "free" : "slaved");
    imk_result_text(result, "aligned", s->alignment == IMK_ALIGNED_SELF ? "self" : "given");
    imk_result_text(result, "attitude_errors",
                    s->attitude_errors == IMK_ATTITUDE_EARTH ? "earth" : "local");
    imk_result_array(result, "initial_sigma");
    for (int i = 0; i < IMK_DRIFT_STATES; i++)
        imk_result_quantity(result, NULL, s->initial_sigma[i], units[i / 3]);
    imk_result_end(result);
    if (s->gravity_deflection > 0) {
        imk_result_quantity(result, "gravity_deflection", s->gravity_deflection, "m/s^2");
        imk_result_quantity(result, "gravity_distance", s->gravity_distance, "m");
    }
    if (!r->settings.drift.motion) {
        imk_result_quantity(result, "latitude", s->latitude, "rad");
        imk_result_quantity(result, "height", s->height, "m");
        imk_result_quantity(result, "roll", s->roll, "rad");
        imk_result_quantity(result, "pitch", s->pitch, "rad");
        imk_result_quantity(result, "yaw", s->yaw, "rad");
    }
    if (s->alignment == IMK_ALIGNED_SELF)
        imk_result_quantity(result, "alignment_time", s->alignment_time, "s");
    imki_drift_show_aids(r, shown->filter_model, result);
    if (r->found)
        imk_result_count(result, "seed", (long long)shown->seed);
    imk_result_end(result);
}

static void show_data(const imk_drift_models *r, const imk_drift_shown *shown, imk_result *result)
{
    show_inputs(r, shown, result);
    imk_result_object(result, "result");
    imki_judge_drift(r, &shown->verdict, result);
    imk_result_array(result, "models");
    for (size_t c = 0; c < r->case_count; c++)
        show_case(r, shown, &r->cases[c], result);
    imk_result_end(result);
    if (r->found)
        show_runs_data(r, result);
    if (r->answer)
        imki_drift_show_answer_data(r, result);
    imk_result_end(result);
}

/* ---- messages ---- */

/* "At rest at 45 deg north; attitude true at the start, height held by other means." */
static void conditions_of(const imk_drift_models *r, const char *motion, imki_text *text)
{
    const imk_drift_settings *s = &r->settings.drift;
    if (motion)
        imki_text_add(text, "On %s", motion);
    else
        imki_text_add(text, "At rest at %.4g deg %s", fabs(s->latitude) / imk_unit_of("deg").scale,
                      s->latitude < 0 ? "south" : "north");
    imki_text_put(text, "; ");
    imki_drift_aids_words(r, text);
    imki_text_add(text, "%sattitude %s at the start, height %s.%s", s->aid_count > 0 ? "; " : "",
                  s->alignment == IMK_ALIGNED_SELF ? "found by the unit itself"
                  : s->initial_sigma[6] + s->initial_sigma[7] + s->initial_sigma[8] > 0 ? "given"
                                                                                        : "true",
                  imk_drift_vertical(s) == IMK_VERTICAL_SLAVED ? "held by other means"
                  : s->vertical == IMK_VERTICAL_FREE           ? "free"
                                                               : "from the aids",
                  s->attitude_errors == IMK_ATTITUDE_EARTH
                      ? " Tilt and heading are errors against Earth-fixed axes."
                      : "");
}

static void show_title(const imk_drift_models *r, const imk_drift_shown *shown, imk_result *result)
{
    imki_text text = {.bytes = NULL}, names = {.bytes = NULL};
    conditions_of(r, shown->motion, &text);
    for (size_t m = 0; m < r->model_count; m++)
        imki_text_add(&names, "%s%s", m > 0 ? ", " : "", r->name[m]);
    if (names.size > 0 && !text.failed) {
        imk_result_for(result, IMK_FOR_TERMINAL);
        imk_result_line(result, IMK_BOLD "Error growth" IMK_PLAIN " of %s %c%s", names.bytes,
                        text.bytes[0] - 'A' + 'a', text.bytes + 1);
    }
    imk_result_for(result, IMK_FOR_PAGE);
    imk_result_title(result, "Error growth", "%s", r->model_count > 1 ? "" : r->name[0]);
    imki_show_text(&text, result);
    for (size_t i = 0; i < shown->verdict.count; i++)
        imk_result_finding(result, 2, shown->verdict.message[i].text);
    if (result && names.failed)
        result->arena.failed = true;
    free(names.bytes);
}

/* Of several models only what decides. */
static void show_deciding(const imk_drift_models *r, imk_result *result)
{
    imk_result_gap(result);
    for (size_t c = 0; c < r->case_count; c++) {
        const imk_drift_case *one = &r->cases[c];
        char text[IMKI_DRIFT_TIME];
        if (one->share_count > 0 && one->share[0].share > 0)
            imk_result_line(result, "%s: after %s %s contributes %.0f %% of the variance",
                            one->label, imki_drift_moment(r, r->times->time[one->time], text),
                            one->analysis->source[one->share[0].source].text,
                            100 * one->share[0].share);
    }
}

/* ---- all ---- */

/* What stands in place of what is not stated, and what is missing. */
static void show_unstated(const imk_drift_models *r, const imk_drift_shown *shown,
                          imk_result *result)
{
    if (shown->assumed)
        imk_result_gap(result);
    for (size_t m = 0; m < r->model_count && shown->assumed; m++)
        imki_show_assumed(&shown->assumed[m], r->name[m], result);
    for (size_t c = 0; c < r->case_count; c++) {
        const imk_drift_case *one = &r->cases[c];
        if (one->missing_count == 0)
            continue;
        imk_result_line(result,
                        "\nThe figures of %s are lower bounds. With what is typical of its "
                        "class, these would have a part in the mean square of an error:",
                        one->label);
        imki_show_missing(one->missing_count, one->missing, result);
    }
}

/* The page shows the shares too; a plot of letters has no shades for them. */
static void show_figure(const imk_drift_models *r, imk_result *result)
{
    imk_result_for(result, IMK_FOR_TERMINAL);
    imki_drift_show_figure(r, false, result);
    imk_result_for(result, IMK_FOR_PAGE);
    imki_drift_show_figure(r, true, result);
}

void imk_show_drift(const imk_drift_models *r, const imk_drift_shown *shown, imk_result *result)
{
    show_data(r, shown, result);
    show_title(r, shown, result);
    show_figure(r, result);
    imk_result_heading(result, r->model_count > 1  ? "Comparison"
                               : r->case_count > 1 ? "Before and after calibration"
                                                   : "Against time");
    imk_result_for(result, IMK_FOR_BOTH);
    imki_drift_show_growth(r, result);
    show_unstated(r, shown, result);
    imk_result_for(result, IMK_FOR_TERMINAL);
    if (r->model_count > 1)
        show_deciding(r, result);
    for (size_t c = 0; c < r->case_count; c++)
        imki_drift_show_budget(r, &r->cases[c], result);
    if (r->found) {
        imk_result_for(result, IMK_FOR_TERMINAL);
        imk_result_line(result,
                        "\nMonte Carlo of %s: %llu runs of the whole %s; in brackets 95 %% "
                        "intervals.",
                        imki_drift_last_case(r)->label, (unsigned long long)r->run_count,
                        r->nees_degrees > 0 ? "filter and its aids" : "mechanisation");
        imk_result_for(result, IMK_FOR_PAGE);
        imk_result_heading(result, "Monte Carlo");
        imk_result_for(result, IMK_FOR_BOTH);
        imki_drift_show_runs(r, result);
        imk_result_for(result, IMK_FOR_TERMINAL);
        imki_drift_show_ratios(r, result);
    }
    imk_result_for(result, IMK_FOR_TERMINAL);
    if (r->answer)
        imki_drift_show_answer(r, shown->model, result);
}

void imk_show_drift_runs(const imk_drift_models *r, const char *words, imk_result *result)
{
    const imk_drift_shown shown = {.motion = NULL};
    imk_result_object(result, "result");
    imki_judge_drift(r, &shown.verdict, result);
    show_runs_data(r, result);
    imk_result_end(result);
    show_title(r, &shown, result);
    show_figure(r, result);
    imk_result_heading(result, "Monte Carlo");
    imk_result_for(result, IMK_FOR_TERMINAL);
    imk_result_line(result, "%s", words);
    imk_result_for(result, IMK_FOR_BOTH);
    imki_drift_show_runs(r, result);
}
