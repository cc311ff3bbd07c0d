/* SPDX-License-Identifier: Apache-2.0 */
/* Drift as CSV and JSON. */
#include "drift_parts.h"

#include "imukit/output_file.h"

#include <math.h>
#include <stdlib.h>

/* ---- CSV ---- */

enum { FIGURES = 10 };

static void list_figures(const imk_drift_figures *f, double value[FIGURES])
{
    const double all[FIGURES] = {f->cep,    f->r95,      f->drms,  f->north, f->east,
                                 f->height, f->velocity, f->climb, f->tilt,  f->heading};
    for (int i = 0; i < FIGURES; i++)
        value[i] = all[i];
}

static void put_number(imk_output_file *file, double value)
{
    char text[IMK_DECIMAL_SIZE];
    text[isfinite(value) ? imk_decimal_shortest(value, text) : 0] = '\0';
    imk_output_file_print(file, ",%s", text);
}

/* A text that may have a comma or a quote in it. */
static void put_text(imk_output_file *file, const char *text)
{
    imk_output_file_print(file, "\"");
    for (; *text; text++)
        imk_output_file_print(file, *text == '"' ? "\"\"" : "%c", *text);
    imk_output_file_print(file, "\"");
}

static void put_row(imk_output_file *file, const char *model, const char *source, double time,
                    const imk_drift_figures *figures, const imk_drift_moments *moments)
{
    double value[FIGURES];
    list_figures(figures, value);
    put_text(file, model);
    imk_output_file_print(file, ",%s", source);
    put_number(file, time);
    for (int i = 0; i < FIGURES; i++)
        put_number(file, value[i]);
    for (int i = 0; i < 2; i++)
        put_number(file, moments ? moments->mean[i] : (double)NAN);
    imk_output_file_print(file, "\n");
}

/* The total and every source of an analysis at all times. */
static void put_case(imk_output_file *file, const drift_case *one)
{
    const imk_drift_analysis *a = one->analysis;
    for (size_t t = 0; t < a->time_count; t++)
        put_row(file, one->label, "total", a->time[t], &one->figures[t], &a->total[t]);
    for (size_t k = 0; k < a->source_count; k++)
        for (size_t t = 0; t < a->time_count; t++) {
            const imk_drift_moments *m = &a->contribution[k * a->time_count + t];
            const imk_drift_figures f = imk_drift_figures_of(m);
            put_row(file, one->label, a->source[k].name, a->time[t], &f, m);
        }
}

int drift_write_csv(const drift_result *r, const char *path)
{
    imk_output_file *file;
    imk_error error;
    if (imk_output_file_open(path, &file, &error) != IMK_OK)
        return command_error(&error, NULL);
    imk_output_file_print(file, "model,source,time [s],cep [m],r95 [m],drms [m],north [m],east [m],"
                                "height [m],velocity [m/s],climb [m/s],tilt [rad],heading [rad],"
                                "mean_north [m],mean_east [m]\n");
    for (size_t c = 0; c < r->case_count; c++)
        put_case(file, &r->cases[c]);
    for (size_t k = 0; r->found && k < r->scene->row_count; k++) {
        const double time = r->scene->time[r->scene->row[k]];
        put_row(file, r->name[0], "runs", time, &r->found[k], NULL);
        put_row(file, r->name[0], "runs_lower", time, &r->low[k], NULL);
        put_row(file, r->name[0], "runs_upper", time, &r->high[k], NULL);
    }
    if (imk_output_file_commit(file, &error) != IMK_OK)
        return command_error(&error, NULL);
    return -1;
}

/* ---- JSON ---- */

static json_t *figures_json(const imk_drift_figures *f)
{
    static const char *const name[FIGURES] = {"cep",    "r95",      "drms",  "north", "east",
                                              "height", "velocity", "climb", "tilt",  "heading"};
    static const char *const unit[FIGURES] = {"m", "m",   "m",   "m",   "m",
                                              "m", "m/s", "m/s", "rad", "rad"};
    double value[FIGURES];
    json_t *object = json_object();
    list_figures(f, value);
    for (int i = 0; i < FIGURES; i++)
        json_object_set_new(object, name[i], json_quantity(value[i], unit[i]));
    return object;
}

json_t *drift_runs_json(const drift_result *r)
{
    json_t *times = json_array();
    for (size_t k = 0; k < r->scene->row_count; k++)
        json_array_append_new(
            times, json_pack("{s:o, s:I, s:o, s:o, s:o}", "time",
                             json_quantity(r->scene->time[r->scene->row[k]], "s"), "runs",
                             (json_int_t)r->used[k], "figures", figures_json(&r->found[k]), "lower",
                             figures_json(&r->low[k]), "upper", figures_json(&r->high[k])));
    return json_pack("{s:I, s:o}", "runs", (json_int_t)r->run_count, "times", times);
}

static json_t *json_of_budget(const drift_case *one, size_t time, imk_drift_wish wish)
{
    static drift_share share[IMK_DRIFT_SOURCES_MAX];
    const imk_drift_analysis *a = one->analysis;
    const size_t count = drift_budget(one, time, wish, share);
    json_t *list = json_array();
    for (size_t i = 0; i < count; i++) {
        const imk_drift_moments *m = &a->contribution[share[i].source * a->time_count + time];
        json_array_append_new(
            list,
            json_pack("{s:s, s:s, s:o, s:o, s:o, s:o}", "source", a->source[share[i].source].name,
                      "text", a->source[share[i].source].text, "share", json_number(share[i].share),
                      "figures", figures_json(&share[i].whole), "mean_north",
                      json_quantity(m->mean[0], "m"), "mean_east", json_quantity(m->mean[1], "m")));
    }
    return list;
}

static json_t *json_of_case(const drift_result *r, const drift_case *one)
{
    static const char *const validity[] = {"linear", "rough", "no_position"};
    const drift_scene *scene = r->scene;
    const imk_drift_wish wish = scene->want.asked ? scene->want.figure : IMK_WISH_CEP;
    const size_t at = drift_budget_time(r, one);
    json_t *times = json_array(), *omitted = json_array();
    for (size_t k = 0; k < scene->row_count; k++) {
        const imk_drift_figures *f = &one->figures[scene->row[k]];
        json_array_append_new(times, json_pack("{s:o, s:s, s:o}", "time",
                                               json_quantity(scene->time[scene->row[k]], "s"),
                                               "validity", validity[drift_validity_of(f)],
                                               "figures", figures_json(f)));
    }
    for (size_t i = 0; i < one->analysis->omitted_count; i++)
        json_array_append_new(omitted, json_string(one->analysis->omitted[i]));
    return json_pack("{s:o, s:b, s:o, s:o, s:o, s:o}", "model", json_text(one->name), "compensated",
                     one->settings.compensated, "times", times, "budget_time",
                     json_quantity(scene->time[at], "s"), "budget", json_of_budget(one, at, wish),
                     "omitted", omitted);
}

static json_t *json_of_answer(const drift_result *r, const drift_answer *answer)
{
    const drift_wished *want = &r->scene->want;
    const drift_case *one = &r->cases[r->case_count - 1];
    const imk_drift_requirement *need = &answer->requirement;
    const char *unit = drift_wish_unit(want->figure);
    json_t *terms = json_array(), *devices = json_array();
    for (size_t k = 0; k < one->analysis->source_count; k++)
        json_array_append_new(
            terms, json_pack("{s:s, s:o, s:o}", "source", one->analysis->source[k].name, "factor",
                             json_number(need->source[k]), "alone", json_number(need->alone[k])));
    for (size_t i = 0; i < answer->candidate_count; i++) {
        const drift_candidate *c = &answer->candidate[i];
        if (!c->usable)
            continue;
        const double figure = imk_drift_wished(&c->figures, want->figure);
        json_array_append_new(devices, json_pack("{s:s, s:b, s:o, s:b, s:b}", "name",
                                                 c->device->name, "preset", c->device->is_preset,
                                                 "figure", json_quantity(figure, unit), "meets",
                                                 figure <= want->goal, "bias_stated", !c->no_bias));
    }
    return json_pack("{s:s, s:o, s:o, s:o, s:o, s:o, s:o}", "figure", drift_wish_name(want->figure),
                     "goal", json_quantity(want->goal, unit), "time",
                     json_quantity(want->time, "s"), "present", json_quantity(need->present, unit),
                     "all", json_number(need->all), "terms", terms, "devices", devices);
}

static json_t *json_of_inputs(const drift_result *r)
{
    const imk_drift_settings *s = &r->scene->settings;
    json_t *models = json_array(), *initial = json_array();
    for (size_t m = 0; m < r->model_count; m++)
        json_array_append_new(models, json_text(r->name[m]));
    for (int i = 0; i < IMK_DRIFT_STATES; i++)
        json_array_append_new(initial, json_quantity(s->initial_sigma[i], i < 3   ? "m"
                                                                          : i < 6 ? "m/s"
                                                                                  : "rad"));
    json_t *inputs =
        json_pack("{s:o, s:o, s:o, s:s, s:s, s:o}", "models", models, "motion",
                  r->scene->motion ? json_text(r->options->motion) : json_null(), "rate",
                  json_quantity(s->rate, "Hz"), "vertical",
                  s->vertical == IMK_VERTICAL_FREE ? "free" : "slaved", "aligned",
                  s->alignment == IMK_ALIGNED_SELF ? "self" : "given", "initial_sigma", initial);
    if (!r->scene->motion) {
        json_object_set_new(inputs, "latitude", json_quantity(s->latitude, "rad"));
        json_object_set_new(inputs, "height", json_quantity(s->height, "m"));
        json_object_set_new(inputs, "roll", json_quantity(s->roll, "rad"));
        json_object_set_new(inputs, "pitch", json_quantity(s->pitch, "rad"));
        json_object_set_new(inputs, "yaw", json_quantity(s->yaw, "rad"));
    }
    if (s->alignment == IMK_ALIGNED_SELF)
        json_object_set_new(inputs, "alignment_time", json_quantity(s->alignment_time, "s"));
    if (r->found)
        json_object_set_new(inputs, "seed", json_integer((json_int_t)r->options->seed.value));
    return inputs;
}

int drift_print_json(const drift_result *r, const drift_answer *answer)
{
    json_t *models = json_array();
    for (size_t c = 0; c < r->case_count; c++)
        json_array_append_new(models, json_of_case(r, &r->cases[c]));
    json_t *result = json_pack("{s:o}", "models", models);
    if (r->found)
        json_object_set_new(result, "monte_carlo", drift_runs_json(r));
    if (answer)
        json_object_set_new(result, "want", json_of_answer(r, answer));
    const int code = json_print("drift", json_of_inputs(r), result, EXIT_DONE);
    return code == EXIT_DONE ? -1 : code;
}
