/* SPDX-License-Identifier: Apache-2.0 */
/* The calibration as a result: data for programs, text and a page for people. */
#include "calibrate_show_internal.h"

#include <stdlib.h>

/* ---- data ------------------------------------------------------------------------------------ */

static void show_parameters(const imk_calibration_result *r, imk_result *result)
{
    imk_result_array(result, "parameters");
    for (size_t p = 0; r && p < r->parameter_count; p++) {
        char name[IMK_MODEL_PARAMETER_NAME];
        const double half = imk_calibration_half_width(r, (int)p, 0.95);
        if (imk_model_parameter_name(r->parameter[p], name) != IMK_OK)
            continue;
        imk_result_object(result, NULL);
        imk_result_text(result, "name", name);
        imk_result_number(result, "value", r->value[p]);
        imk_result_number(result, "sigma", r->sigma[p]);
        imk_result_number(result, "lower", r->value[p] - half);
        imk_result_number(result, "upper", r->value[p] + half);
        imk_result_number(result, "freedom", r->freedom[p]);
        imk_result_text(result, "unit", imk_model_parameter_unit(r->parameter[p]));
        imk_result_end(result);
    }
    imk_result_end(result);
    const size_t n = r ? r->parameter_count : 0;
    imk_result_array(result, "correlation");
    for (size_t i = 0; i < n; i++) {
        imk_result_array(result, NULL);
        for (size_t j = 0; j <= i; j++)
            imk_result_number(result, NULL, r->covariance[i * n + j] / (r->sigma[i] * r->sigma[j]));
        imk_result_end(result);
    }
    imk_result_end(result);
}

static void show_fit(const imk_calibrate_log *b, imk_result *result)
{
    const imk_calibration_result *r = b->result;
    static const char *const names[IMK_GROUPS] = {"gyro", "accel", "turn"};
    static const char *const units[IMK_GROUPS] = {"rad/s", "m/s^2", "rad"};
    imk_result_object(result, "fit");
    for (int g = 0; r && g < IMK_GROUPS; g++) {
        const imk_group_fit *fit = &r->group[g];
        if (fit->count == 0)
            continue;
        imk_result_object(result, names[g]);
        imk_result_count(result, "count", (long long)fit->count);
        imk_result_count(result, "refused", (long long)fit->refused);
        if (!imki_no_sigma(b, g))
            imk_result_number(result, "chi_square", fit->chi_square);
        imk_result_number(result, "degrees_of_freedom", fit->degrees_of_freedom);
        if (!imki_no_sigma(b, g))
            imk_result_number(result, "factor", fit->factor);
        imk_result_quantity(result, "rms", fit->rms, units[g]);
        imk_result_end(result);
    }
    imk_result_end(result);
}

static void show_observations(const imk_calibrate_log *b, imk_result *result)
{
    const imk_calibration *c = b->calibration;
    imk_result_array(result, "poses");
    for (size_t k = 0; b->result && k < c->observation_count; k++) {
        const imk_observation *o = &c->observation[k];
        if (imki_is_of_turns(b, o))
            continue;
        const imk_test_record *record = c->record[o->record];
        imk_result_object(result, NULL);
        imk_result_text(result, "log", record->name);
        if (record->means) {
            imk_result_count(result, "row", (long long)o->begin + 1);
            if (imki_label_of(record, o->begin))
                imk_result_text(result, "label", imki_label_of(record, o->begin));
        } else {
            imk_result_quantity(result, "begin", imk_test_record_time(record, o->begin), "s");
            imk_result_quantity(result, "length", (double)(o->end - o->begin) * record->dt, "s");
        }
        imk_result_numbers(result, "force", 3,
                           o->knowledge == IMK_INPUT_GRAVITY ? o->vertical : o->force);
        imk_result_numbers(result, "accel_residual", 3, o->residual[1]);
        imk_result_numbers(result, "gyro_residual", 3, o->residual[0]);
        imk_result_number(result, "distance", o->distance);
        imk_result_number(result, "weight", o->weight);
        imk_result_end(result);
    }
    imk_result_end(result);
}

static void show_repeatability(const char *key, int axes, const imk_repeatability *runs,
                               const char *unit, imk_result *result)
{
    imk_result_array(result, key);
    for (const imk_repeatability *r = runs; r < runs + axes; r++) {
        imk_result_object(result, NULL);
        imk_result_count(result, "runs", (long long)r->runs);
        imk_result_number(result, "value", r->value);
        imk_result_number(result, "sigma", r->sigma);
        imk_result_number(result, "lower", r->lower);
        imk_result_number(result, "upper", r->upper);
        imk_result_number(result, "within", r->within);
        imk_result_text(result, "unit", unit);
        imk_result_end(result);
    }
    imk_result_end(result);
}

static void show_runs(const imk_calibrate_log *b, imk_result *result)
{
    if (!imki_begin_object(result, "repeatability", b->runs))
        return;
    for (int sensor = 0; sensor < 2; sensor++) {
        const int axes = b->runs->axis_count[sensor];
        imk_result_object(result, imki_sensor_keys[sensor]);
        show_repeatability("bias", axes, b->runs->bias[sensor], imki_sensor_units[sensor], result);
        show_repeatability("scale_factor", axes, b->runs->scale_factor[sensor], "1", result);
        imk_result_end(result);
    }
    imk_result_count(result, "runs", (long long)b->run_count);
    imk_result_end(result);
}

/* 3 x 3, row-major. */
static void show_matrix(const char *key, const double *m, imk_result *result)
{
    imk_result_array(result, key);
    for (int row = 0; row < 3; row++)
        imk_result_numbers(result, NULL, 3, m + 3 * row);
    imk_result_end(result);
}

/* The matrices of ferraris.h, in the unit of the readings. */
static void show_closed_form(const imk_calibrate_log *b, imk_result *result)
{
    if (!imki_begin_object(result, "closed_form", b->ferraris))
        return;
    for (int sensor = 0; sensor < 2; sensor++) {
        const imk_ferraris_triad *t = sensor == 0 ? &b->ferraris->gyro : &b->ferraris->accel;
        const bool counts = b->record[0].record.counts[sensor];
        imk_result_object(result, imki_sensor_keys[sensor]);
        imk_result_numbers(result, "scale", 3, t->scale);
        show_matrix("axes", t->axes[0], result);
        imk_result_numbers(result, "bias", 3, t->bias);
        imk_result_text(result, "reading_unit", counts ? "count" : imki_sensor_units[sensor]);
        imk_result_text(result, "input_unit", imki_sensor_units[sensor]);
        imk_result_end(result);
    }
    show_matrix("g_sensitivity", b->ferraris->g_sensitivity[0], result);
    imk_result_end(result);
}

static void show_thermal_axis(const imk_thermal_findings *f, const imk_thermal_axis *a,
                              const char *unit, imk_result *result)
{
    imk_result_object(result, NULL);
    imk_result_count(result, "order", a->order);
    imk_result_text(result, "cause", imk_thermal_cause_name(a->cause));
    imk_result_quantity(result, "hysteresis", a->hysteresis.value, unit);
    imk_result_quantity(result, "hysteresis_sigma", a->hysteresis.sigma, unit);
    imk_result_quantity(result, "rms_polynomial", a->rms_polynomial, unit);
    imk_result_quantity(result, "rms_compensated", a->rms_compensated, unit);
    imk_result_quantity(result, "rms", a->rms, unit);
    imk_result_flag(result, "single_valued", a->single_valued);
    imk_result_array(result, "gaps");
    for (int k = 0; k < f->gap_count; k++) {
        imk_result_object(result, NULL);
        imk_result_quantity(result, "temperature", f->gap_temperature[k], "K");
        imk_result_number(result, "value", a->gap[k].value);
        imk_result_number(result, "sigma", a->gap[k].sigma);
        imk_result_end(result);
    }
    imk_result_end(result);
    imk_result_end(result);
}

static void show_thermal(const imk_thermal_findings *f, imk_result *result)
{
    if (!imki_begin_object(result, "thermal", f))
        return;
    imk_result_quantity(result, "reference", f->reference, "K");
    imk_result_quantity(result, "minimum", f->minimum, "K");
    imk_result_quantity(result, "maximum", f->maximum, "K");
    for (int sensor = 0; sensor < 2; sensor++) {
        imk_result_array(result, imki_sensor_keys[sensor]);
        for (int axis = 0; axis < f->axis_count[sensor]; axis++)
            show_thermal_axis(f, &f->axis[sensor][axis], imki_sensor_units[sensor], result);
        imk_result_end(result);
    }
    imk_result_end(result);
}

static const char *procedure_name(const imk_calibrate_log *b, const imk_calibrate_record *log)
{
    return b->runs ? "repeatability" : imk_procedure_name(log->procedure);
}

static void show_inputs(const imk_calibrate_log *b, imk_result *result)
{
    imk_result_object(result, "inputs");
    imk_result_array(result, "logs");
    for (const imk_calibrate_record *log = b->record; log < b->record + b->count; log++) {
        imk_result_object(result, NULL);
        imk_result_text(result, "log", log->path);
        imk_result_text(result, "procedure", procedure_name(b, log));
        imk_result_count(result, "rows", (long long)log->record.count);
        imk_result_count(result, "left_out", (long long)log->dropped);
        if (log->record.means)
            imk_result_flag(result, "pose_means", true);
        else
            imk_result_quantity(result, "interval", log->record.dt, "s");
        imk_result_count(result, "intervals_at_rest", (long long)log->interval_count);
        show_thermal(log->thermal, result);
        imk_result_end(result);
    }
    imk_result_end(result);
    imk_result_quantity(result, "gravity", b->calibration->gravity, "m/s^2");
    imk_result_quantity(result, "latitude", b->calibration->latitude, "rad");
    imk_result_end(result);
}

static void show_data(const imk_calibrate_log *b, const imk_verdict *v, const char *verdict,
                      imk_result *result)
{
    static const char *const levels[] = {"good", "note", "warning", "useless"};
    show_inputs(b, result);
    imk_result_object(result, "result");
    imk_result_judge(result, imk_verdict_usability(v), "%s", verdict);
    imk_result_array(result, "sentences");
    for (const imk_message *s = v->message; s < v->message + v->count; s++) {
        imk_result_object(result, NULL);
        imk_result_text(result, "level", levels[s->level]);
        imk_result_text(result, "code", s->code);
        imk_result_text(result, "message", s->text);
        imk_result_end(result);
    }
    imk_result_end(result);
    imk_result_text(result, "frame", imk_triad_frame_name(b->calibration->frame));
    show_parameters(b->result, result);
    show_fit(b, result);
    show_observations(b, result);
    imki_show_turns(b, result);
    show_runs(b, result);
    show_closed_form(b, result);
    imki_magnetometer_data(b, result);
    imk_result_end(result);
}

/* ---- display --------------------------------------------------------------------------------- */

static void show_title(const imk_calibrate_log *b, imk_result *result)
{
    imki_text logs = {0};
    for (const imk_calibrate_record *log = b->record; log < b->record + b->count; log++)
        imki_list_item(&logs, "%s (%s)", log->record.name, procedure_name(b, log));
    imk_result_title(result, "Calibration of an inertial sensor", "%s", logs.bytes);
    free(logs.bytes);
}

static void show_verdict(const imk_verdict *v, imk_result *result)
{
    static const int boxes[] = {0, 1, 2, 2};
    for (const imk_message *s = v->message; s < v->message + v->count; s++)
        imk_result_finding(result, boxes[s->level], s->text);
}

static void show_temperature(const imk_calibrate_log *b, bool brief, imk_result *result)
{
    bool begun = brief;
    for (const imk_calibrate_record *log = b->record; log < b->record + b->count; log++)
        for (int sensor = 1; sensor >= 0; sensor--) {
            if (!begun && log->thermal && log->thermal->axis_count[sensor] > 0) {
                imk_result_heading(result, "Over temperature");
                begun = true;
            }
            imki_thermal_table(log, sensor, brief, result);
        }
}

/* How the threshold came about, and the intervals. */
static void show_holds(const imk_calibrate_record *log, imk_result *result)
{
    const imk_static_findings *f = &log->stationary;
    if (f->window > 0)
        imk_result_line(result,
                        "%s: windows of %.3g s; noise estimated from %.6g s to %.6g s; the unit is "
                        "stationary in %.3g %% of the log, in %zu intervals; %zu stretches were "
                        "too short, %zu samples were saturated, %zu were not numbers.",
                        log->record.name, f->window, (double)f->rest_begin * log->record.dt,
                        (double)f->rest_end * log->record.dt, 100 * f->standing, f->intervals,
                        f->too_short, f->saturated, f->not_finite);
}

static bool has_observations(const imk_calibrate_log *b)
{
    return b->result && !b->ferraris && b->calibration->observation_count > 0;
}

/* The rest of the page. */
static void show_evidence(const imk_calibrate_log *b, imk_result *result)
{
    imk_result_for(result, IMK_FOR_PAGE);
    if (has_observations(b))
        imk_result_heading(result, "Observations");
    for (const imk_calibrate_record *log = b->record; log < b->record + b->count; log++)
        show_holds(log, result);
    if (has_observations(b))
        imki_pose_table(b, result);
}

void imk_show_calibrate_log(const imk_calibrate_log *b, const imk_verdict *v, bool poses,
                            imk_result *result)
{
    char verdict[900];
    const bool fitted = b->result && !b->ferraris;
    imki_calibrate_summary(b, v, verdict, sizeof verdict);
    show_data(b, v, verdict, result);
    show_title(b, result);
    imk_result_for(result, IMK_FOR_PAGE);
    show_verdict(v, result);
    if (has_observations(b))
        imki_calibrate_figure(b, result);
    imk_result_heading(result, b->runs ? "From run to run" : "Parameters");
    imk_result_for(result, IMK_FOR_BOTH);
    for (int sensor = 1; sensor >= 0; sensor--)
        if (b->runs)
            imki_runs_table(b, sensor, result);
        else
            imki_parameter_table(b, sensor, result);
    imki_parameter_table(b, IMK_MAG, result);
    imk_result_for(result, IMK_FOR_PAGE);
    if (b->result)
        imk_result_line(result,
                        "Each value has its 1 sigma; the interval below contains the true value "
                        "with 95 %% confidence (Student's distribution; residuals beyond the noise "
                        "are taken into account). A response \"misalignment, y\" is the share of "
                        "the y component that the axis senses.");
    imki_calibrate_remarks(b, result);
    show_temperature(b, false, result);
    if (fitted)
        imk_result_heading(result, "Fit");
    imk_result_for(result, IMK_FOR_TERMINAL);
    show_temperature(b, true, result);
    if (fitted && poses && b->calibration->observation_count > 0)
        imki_pose_table(b, result);
    imk_result_for(result, IMK_FOR_BOTH);
    if (fitted)
        imki_fit_table(b, result);
    show_evidence(b, result);
    imk_result_for(result, IMK_FOR_TERMINAL);
    imki_calibrate_remarks(b, result);
    for (const imk_message *s = v->message; s < v->message + v->count; s++)
        if (s->level == IMK_FINDING_NOTE)
            imk_result_line(result, "%s.", s->text);
    imk_result_for(result, IMK_FOR_BOTH);
}
