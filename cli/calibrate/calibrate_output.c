/* SPDX-License-Identifier: Apache-2.0 */
/* The calibration on standard output: text for people, JSON for programs. */
#include "calibrate_parts.h"

#include "shell/json_output.h"

#include <math.h>
#include <string.h>

static void put_table(text_table table)
{
    if (table.rows > 0) {
        text_table_print(&table, stdout);
        putchar('\n');
    }
    text_table_free(&table);
}

static void suggest_next(const bench *b)
{
    const calibrate_options *o = b->options;
    const bool written = bench_level(b) < LEVEL_USELESS || o->anyway;
    if (o->report)
        printf("Report: %s\n", o->report);
    if (!written)
        return;
    if (o->output)
        printf(b->runs ? "Model: %s\nNext: imukit grade %s\n"
                       : "Model: %s\nNext: imukit compensate LOG %s -o clean.csv\n",
               o->output, o->output);
    else
        printf("Next: add -o model.yaml to keep the model, --report report.html for a page\n");
}

void bench_print(const bench *b)
{
    char text[900];
    for (int sensor = 1; sensor >= 0; sensor--)
        put_table(b->runs ? bench_run_table(b, sensor) : bench_parameter_table(b, sensor));
    for (size_t k = 0; k < b->log_count; k++)
        for (int sensor = 1; sensor >= 0; sensor--)
            put_table(bench_thermal_table(&b->log[k], sensor, true));
    if (b->options->poses)
        put_table(bench_pose_table(b));
    put_table(bench_fit_table(b));
    for (size_t line = 0; bench_remark(b, line, text, sizeof text); line++)
        printf("%s\n", text);
    for (size_t k = 0; k < b->sentence_count; k++)
        if (b->sentence[k].level == LEVEL_NOTE)
            printf("%s.\n", b->sentence[k].text);
    bench_verdict(b, text, sizeof text);
    printf("%s\n", text);
    suggest_next(b);
}

/* ---- JSON ------------------------------------------------------------------------------------ */

static json_t *parameters_json(const bench *b)
{
    json_t *list = json_array();
    const imk_calibration_result *r = b->result;
    for (size_t p = 0; r && p < r->parameter_count; p++) {
        char name[IMK_MODEL_PARAMETER_NAME];
        const double half = imk_calibration_half_width(r, (int)p, 0.95);
        if (imk_model_parameter_name(r->parameter[p], name) != IMK_OK)
            continue;
        json_array_append_new(
            list, json_pack("{s:s, s:o, s:o, s:o, s:o, s:o, s:s}", "name", name, "value",
                            json_number(r->value[p]), "sigma", json_number(r->sigma[p]), "lower",
                            json_number(r->value[p] - half), "upper",
                            json_number(r->value[p] + half), "freedom", json_number(r->freedom[p]),
                            "unit", imk_model_parameter_unit(r->parameter[p])));
    }
    return list;
}

static json_t *correlation_json(const bench *b)
{
    json_t *rows = json_array();
    const imk_calibration_result *r = b->result;
    const size_t n = r ? r->parameter_count : 0;
    for (size_t i = 0; i < n; i++) {
        json_t *row = json_array();
        for (size_t j = 0; j <= i; j++)
            json_array_append_new(
                row, json_number(r->covariance[i * n + j] / (r->sigma[i] * r->sigma[j])));
        json_array_append_new(rows, row);
    }
    return rows;
}

static json_t *fit_json(const bench *b)
{
    static const char *const names[IMK_GROUPS] = {"gyro", "accel", "turn"};
    static const char *const units[IMK_GROUPS] = {"rad/s", "m/s^2", "rad"};
    json_t *groups = json_object();
    for (int g = 0; b->result && g < IMK_GROUPS; g++) {
        const imk_group_fit *fit = &b->result->group[g];
        if (fit->count == 0)
            continue;
        json_object_set_new(
            groups, names[g],
            json_pack("{s:I, s:I, s:o, s:o, s:o, s:o}", "count", (json_int_t)fit->count, "refused",
                      (json_int_t)fit->refused, "chi_square", json_number(fit->chi_square),
                      "degrees_of_freedom", json_number(fit->degrees_of_freedom), "factor",
                      json_number(fit->factor), "rms", json_quantity(fit->rms, units[g])));
    }
    return groups;
}

static json_t *vector_json(const double *v)
{
    return json_pack("[o, o, o]", json_number(v[0]), json_number(v[1]), json_number(v[2]));
}

static json_t *poses_json(const bench *b)
{
    json_t *list = json_array();
    const imk_calibration *c = b->calibration;
    for (size_t k = 0; b->result && k < c->observation_count; k++) {
        const imk_observation *o = &c->observation[k];
        const imk_test_record *record = c->record[o->record];
        const double begin = record->time ? record->time[o->begin] : (double)o->begin * record->dt;
        json_array_append_new(
            list, json_pack("{s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o}", "log",
                            json_text(record->name), "begin", json_quantity(begin, "s"), "length",
                            json_quantity((double)(o->end - o->begin) * record->dt, "s"), "force",
                            vector_json(o->knowledge == IMK_INPUT_GRAVITY ? o->vertical : o->force),
                            "accel_residual", vector_json(o->residual[1]), "gyro_residual",
                            vector_json(o->residual[0]), "distance", json_number(o->distance),
                            "weight", json_number(o->weight)));
    }
    return list;
}

static json_t *repeatability_json(const imk_repeatability *r, const char *unit)
{
    return json_pack("{s:I, s:o, s:o, s:o, s:o, s:o, s:s}", "runs", (json_int_t)r->runs, "value",
                     json_number(r->value), "sigma", json_number(r->sigma), "lower",
                     json_number(r->lower), "upper", json_number(r->upper), "within",
                     json_number(r->within), "unit", unit);
}

static json_t *runs_json(const bench *b)
{
    static const char *const names[2] = {"gyro", "accel"};
    if (!b->runs)
        return json_null();
    json_t *both = json_object();
    for (int sensor = 0; sensor < 2; sensor++) {
        json_t *bias = json_array(), *scale = json_array();
        for (int axis = 0; axis < b->runs->axis_count[sensor]; axis++) {
            json_array_append_new(bias, repeatability_json(&b->runs->bias[sensor][axis],
                                                           sensor == 0 ? "rad/s" : "m/s^2"));
            json_array_append_new(scale,
                                  repeatability_json(&b->runs->scale_factor[sensor][axis], "1"));
        }
        json_object_set_new(both, names[sensor],
                            json_pack("{s:o, s:o}", "bias", bias, "scale_factor", scale));
    }
    json_object_set_new(both, "runs", json_integer((json_int_t)b->run_count));
    return both;
}

/* 3 x 3, row-major. */
static json_t *matrix_json(const double *m)
{
    return json_pack("[o, o, o]", vector_json(m), vector_json(m + 3), vector_json(m + 6));
}

/* The matrices of ferraris.h, in the unit of the readings. */
static json_t *closed_form_json(const bench *b)
{
    static const char *const names[2] = {"gyro", "accel"};
    static const char *const units[2] = {"rad/s", "m/s^2"};
    if (!b->ferraris)
        return json_null();
    json_t *all = json_object();
    for (int sensor = 0; sensor < 2; sensor++) {
        const imk_ferraris_triad *t = sensor == 0 ? &b->ferraris->gyro : &b->ferraris->accel;
        const char *reading = b->log[0].record.counts[sensor] ? "count" : units[sensor];
        json_object_set_new(all, names[sensor],
                            json_pack("{s:o, s:o, s:o, s:s, s:s}", "scale", vector_json(t->scale),
                                      "axes", matrix_json(t->axes[0]), "bias", vector_json(t->bias),
                                      "reading_unit", reading, "input_unit", units[sensor]));
    }
    json_object_set_new(all, "g_sensitivity", matrix_json(b->ferraris->g_sensitivity[0]));
    return all;
}

static json_t *thermal_axis_json(const imk_thermal_findings *f, int sensor, int axis)
{
    const imk_thermal_axis *a = &f->axis[sensor][axis];
    const char *unit = sensor == 0 ? "rad/s" : "m/s^2";
    json_t *gaps = json_array();
    for (int k = 0; k < f->gap_count; k++)
        json_array_append_new(gaps, json_pack("{s:o, s:o, s:o}", "temperature",
                                              json_quantity(f->gap_temperature[k], "K"), "value",
                                              json_number(a->gap[k].value), "sigma",
                                              json_number(a->gap[k].sigma)));
    return json_pack("{s:i, s:s, s:o, s:o, s:o, s:o, s:o, s:b, s:o}", "order", a->order, "cause",
                     imk_thermal_cause_name(a->cause), "hysteresis",
                     json_quantity(a->hysteresis.value, unit), "hysteresis_sigma",
                     json_quantity(a->hysteresis.sigma, unit), "rms_polynomial",
                     json_quantity(a->rms_polynomial, unit), "rms_compensated",
                     json_quantity(a->rms_compensated, unit), "rms", json_quantity(a->rms, unit),
                     "single_valued", a->single_valued, "gaps", gaps);
}

static json_t *thermal_json(const bench_log *log)
{
    static const char *const names[2] = {"gyro", "accel"};
    const imk_thermal_findings *f = log->thermal;
    if (!f)
        return json_null();
    json_t *result =
        json_pack("{s:o, s:o, s:o}", "reference", json_quantity(f->reference, "K"), "minimum",
                  json_quantity(f->minimum, "K"), "maximum", json_quantity(f->maximum, "K"));
    for (int sensor = 0; sensor < 2; sensor++) {
        json_t *axes = json_array();
        for (int axis = 0; axis < f->axis_count[sensor]; axis++)
            json_array_append_new(axes, thermal_axis_json(f, sensor, axis));
        json_object_set_new(result, names[sensor], axes);
    }
    return result;
}

static json_t *logs_json(const bench *b)
{
    json_t *list = json_array();
    for (size_t k = 0; k < b->log_count; k++) {
        const bench_log *log = &b->log[k];
        json_array_append_new(
            list,
            json_pack("{s:o, s:s, s:I, s:I, s:o, s:I, s:o}", "log", json_text(log->path),
                      "procedure", b->runs ? "repeatability" : imk_procedure_name(log->procedure),
                      "rows", (json_int_t)log->record.count, "left_out", (json_int_t)log->dropped,
                      "interval", json_quantity(log->record.dt, "s"), "intervals_at_rest",
                      (json_int_t)log->interval_count, "thermal", thermal_json(log)));
    }
    return list;
}

int bench_json(const bench *b, int code)
{
    static const char *const levels[] = {"good", "note", "warning", "useless"};
    char text[900];
    json_t *sentences = json_array();
    for (size_t k = 0; k < b->sentence_count; k++)
        json_array_append_new(
            sentences, json_pack("{s:s, s:s, s:o}", "level", levels[b->sentence[k].level], "code",
                                 b->sentence[k].code, "message", json_text(b->sentence[k].text)));
    bench_verdict(b, text, sizeof text);
    json_t *inputs = json_pack("{s:o, s:o, s:o}", "logs", logs_json(b), "gravity",
                               json_quantity(b->calibration->gravity, "m/s^2"), "latitude",
                               json_quantity(b->calibration->latitude, "rad"));
    json_t *result =
        json_pack("{s:o, s:s, s:o, s:s, s:o, s:o, s:o, s:o, s:o, s:o}", "verdict", json_text(text),
                  "level", levels[bench_level(b)], "sentences", sentences, "frame",
                  imk_triad_frame_name(b->calibration->frame), "parameters", parameters_json(b),
                  "correlation", correlation_json(b), "fit", fit_json(b), "poses", poses_json(b),
                  "repeatability", runs_json(b), "closed_form", closed_form_json(b));
    return json_print("calibrate", inputs, result, code);
}
