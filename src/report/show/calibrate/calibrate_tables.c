/* SPDX-License-Identifier: Apache-2.0 */
/* What was found as tables: parameters by axis with 1 sigma and 95 % interval, the fit of each
 * group of observations, the poses, runs compared, and what temperature does. On the terminal an
 * empty line follows each; nothing is shown where there is nothing to say. */
#include "calibrate_show_internal.h"

#include "base/algebra/vector_internal.h"

#include <math.h>

static const double degree = 0.017453292519943295;

enum {
    KELVIN = 27315, /* of 0 degC, in hundredths */
    NUMBER = 40
};

/* "gyro | unit | x | y | z" */
static imk_table *begin_axes(const char *title, int axes, imk_result *result)
{
    imk_table *table = imk_result_table(result, 0);
    imk_table_row(table, "%s\tunit", title);
    for (int axis = 0; axis < axes; axis++)
        imk_table_add(table, "%c", imk_axis_letter(axis));
    return table;
}

static void add_value(imk_table *table, double value, double sigma, int digits)
{
    char text[NUMBER], spread[NUMBER];
    imk_readable_value(value, sigma, digits, text, sizeof text);
    imk_readable_value(sigma, sigma, 2, spread, sizeof spread);
    imk_table_add(table, "%s ± %s", text, spread);
}

/* ---- parameters ------------------------------------------------------------------------------ */

/* One row of values and one of intervals for a number on every axis. */
static void add_parameter(imk_table *table, const imk_calibrate_log *b,
                          imk_model_parameter parameter, int axes)
{
    const imk_calibration_result *r = b->result;
    double magnitude = 0;
    int found[IMK_AXES_MAX];
    bool any = false;
    for (int axis = 0; axis < axes; axis++) {
        parameter.axis = (uint8_t)axis;
        found[axis] = imk_calibrate_find(b, parameter);
        if (found[axis] < 0)
            continue;
        any = true;
        magnitude = fmax(magnitude, fmax(fabs(r->value[found[axis]]), r->sigma[found[axis]]));
    }
    if (!any)
        return;
    const imk_unit unit = imk_parameter_unit(parameter, magnitude);
    char title[80], lower[NUMBER], upper[NUMBER];
    imk_parameter_title(parameter, title, sizeof title);
    imk_table_row(table, "%s\t%s", title, unit.text);
    for (int axis = 0; axis < axes; axis++)
        if (found[axis] < 0)
            imk_table_add(table, "-");
        else
            add_value(table, r->value[found[axis]] / unit.scale, r->sigma[found[axis]] / unit.scale,
                      5);
    imk_table_row(table, "\t95 %%");
    for (int axis = 0; axis < axes; axis++) {
        if (found[axis] < 0) {
            imk_table_add(table, "%s", "");
            continue;
        }
        const double half = imk_calibration_half_width(r, found[axis], 0.95) / unit.scale;
        const double middle = r->value[found[axis]] / unit.scale;
        imk_readable_value(middle - half, half / 2, 5, lower, sizeof lower);
        imk_readable_value(middle + half, half / 2, 5, upper, sizeof upper);
        imk_table_add(table, "%s to %s", lower, upper);
    }
}

/* Readings in counts: what they make of a unit of input, and what they are without any. */
static void add_counts(imk_table *table, const imk_calibrate_log *b, int sensor,
                       const imk_triad *triad)
{
    static const int terms[2] = {IMK_MODEL_SCALE_FACTOR, IMK_MODEL_BIAS};
    for (int row = 0; row < 2 && triad->sensitivity.value[0] != 0; row++) {
        if (row == 0)
            imk_table_row(table, "counts per unit\tcount/(%s)", imki_sensor_units[sensor]);
        else
            imk_table_row(table, "counts at zero input\tcount");
        for (int axis = 0; axis < triad->axis_count; axis++) {
            const imk_model_parameter p = {(uint8_t)sensor, (uint8_t)terms[row], (uint8_t)axis, 0};
            const int found = imk_calibrate_find(b, p);
            const double s = triad->sensitivity.value[axis];
            const double value =
                row == 0 ? s * (1 + triad->scale_factor.fixed.value[axis])
                         : triad->zero_offset.value[axis] + s * triad->bias.fixed.value[axis];
            char text[NUMBER];
            imk_readable_value(value, 0, 6, text, sizeof text);
            if (found < 0)
                imk_table_add(table, "%s", text);
            else
                add_value(table, value, fabs(s) * b->result->sigma[found], 6);
        }
    }
}

void imki_parameter_table(const imk_calibrate_log *b, int sensor, imk_result *result)
{
    bool any = false;
    for (size_t p = 0; b->result && p < b->result->parameter_count; p++)
        any = any || b->result->parameter[p].sensor == sensor;
    if (!any)
        return;
    const imk_model *model = &b->result->model;
    const imk_triad *triad = imk_model_triad(model, sensor);
    const int axes = triad->present ? triad->axis_count : 0;
    imk_table *table = begin_axes(imki_sensor_titles[sensor], axes, result);
    for (int term = 0; term < IMK_MODEL_TERMS; term++)
        for (int element = 0; element < imk_model_term_elements(sensor, term); element++) {
            const imk_model_parameter p = {(uint8_t)sensor, (uint8_t)term, 0, (uint8_t)element};
            add_parameter(table, b, p, axes);
        }
    add_counts(table, b, sensor, triad);
    imk_result_gap(result);
}

/* ---- fit ------------------------------------------------------------------------------------- */

void imki_fit_table(const imk_calibrate_log *b, imk_result *result)
{
    static const char *const names[IMK_GROUPS] = {"gyro readings", "accelerometer readings",
                                                  "turns between poses"};
    static const char *const si[IMK_GROUPS] = {"rad/s", "m/s^2", "rad"};
    imk_table *table = imk_result_table(result, 0);
    imk_table_row(table, "fit\tobserved\tleft out\tchi^2 / dof\t1 sigma x\tresiduals (rms)");
    for (int g = 0; g < IMK_GROUPS; g++) {
        const imk_group_fit *fit = &b->result->group[g];
        if (fit->count == 0 || (g == IMK_GROUP_GYRO && imki_has_only_turns(b)))
            continue;
        const imk_unit unit = imk_unit_readable(imk_unit_of(si[g]).dimension, fit->rms);
        imk_table_row(table, "%s\t%zu\t%zu", names[g], fit->count, fit->refused);
        if (imki_no_sigma(b, g))
            imk_table_add(table, "- / %.1f\t-", fit->degrees_of_freedom);
        else if (fit->degrees_of_freedom >= 0.5)
            imk_table_add(table, "%.4g / %.1f\t%.3g", fit->chi_square, fit->degrees_of_freedom,
                          fit->factor);
        else
            imk_table_add(table, "-\t%.3g", fit->factor);
        imk_table_add(table, "%.4g %s", fit->rms / unit.scale, unit.text);
    }
    imki_turn_fit(b, table);
    imki_magnetometer_row(b, table);
    imk_result_gap(result);
}

/* ---- poses ----------------------------------------------------------------------------------- */

/* Largest residual of a sensor in a pose, SI; NaN when it was not observed. */
static double worst_residual(const imk_observation *o, int sensor)
{
    double most = (double)NAN;
    for (int axis = 0; axis < IMK_AXES_MAX; axis++)
        if (isfinite(o->residual[sensor][axis]) && !(fabs(o->residual[sensor][axis]) <= fabs(most)))
            most = o->residual[sensor][axis];
    return most;
}

/* Nothing for what is no number. */
static void add_finite(imk_table *table, const char *format, double value)
    __attribute__((format(printf, 2, 0)));

static void add_finite(imk_table *table, const char *format, double value)
{
    if (isfinite(value))
        imk_table_add(table, format, value);
    else
        imk_table_add(table, "%s", "");
}

/* Rows of a table have a number and perhaps a text, stretches of a log a time and a length. */
static void begin_pose(imk_table *table, const char *name, const imk_test_record *record,
                       const imk_observation *o)
{
    if (record->means) {
        const char *label = imki_label_of(record, o->begin);
        imk_table_row(table, "%.30s\trow %zu\t%s", name, o->begin + 1, label ? label : "");
    } else {
        imk_table_row(table, "%.30s\t%.2f\t%.2f", name, imk_test_record_time(record, o->begin),
                      (double)(o->end - o->begin) * record->dt);
    }
}

void imki_pose_table(const imk_calibrate_log *b, imk_result *result)
{
    const bool several = b->count > 1;
    imki_turn_table(b, result);
    if (imki_has_only_turns(b))
        return;
    bool times = false;
    for (size_t k = 0; k < b->count; k++)
        times = times || !b->record[k].record.means;
    imk_table *table = imk_result_table(result, 0);
    imk_table_row(table, "%s\t%s\t%s\tforce along\t[degC]\taccel [mg]\tgyro [deg/s]\tsigmas\t",
                  several ? "log" : "", times ? "from [s]" : "pose", times ? "length [s]" : "");
    for (size_t k = 0; k < b->calibration->observation_count; k++) {
        const imk_observation *o = &b->calibration->observation[k];
        if (imki_is_of_turns(b, o))
            continue;
        const imk_test_record *record = b->calibration->record[o->record];
        const double *up = o->knowledge == IMK_INPUT_GRAVITY ? o->vertical : o->force;
        const double norm = imki_norm3(up);
        begin_pose(table, several ? record->name : "", record, o);
        if (norm > 0)
            imk_table_add(table, "%+.3f %+.3f %+.3f", up[0] / norm, up[1] / norm, up[2] / norm);
        else
            imk_table_add(table, "%s", "");
        add_finite(table, "%.1f", o->temperature - 273.15);
        add_finite(table, "%+.3f", worst_residual(o, 1) * 1e3 / 9.80665);
        add_finite(table, "%+.5f", worst_residual(o, 0) / degree);
        imk_table_add(table, "%.1f\t%s", o->distance,
                      o->weight > 0.5 ? ""
                      : o->weight > 0 ? "doubtful"
                                      : "left out");
    }
    imk_result_gap(result);
}

/* ---- runs ------------------------------------------------------------------------------------ */

static void add_runs(imk_table *table, const imk_repeatability *runs, const char *title,
                     const char *si, int axes)
{
    double magnitude = 0;
    for (int axis = 0; axis < axes; axis++)
        magnitude = fmax(magnitude, fmax(runs[axis].value, runs[axis].within));
    if (runs[0].runs == 0)
        return;
    const imk_unit unit = imk_unit_readable(imk_unit_of(si).dimension, magnitude);
    imk_table_row(table, "%s, 1 sigma from run to run\t%s", title, unit.text);
    for (const imk_repeatability *r = runs; r < runs + axes; r++)
        if (r->lower > 0)
            imk_table_add(table, "%.3g", r->value / unit.scale);
        else
            imk_table_add(table, "not seen");
    imk_table_row(table, "\t95 %%");
    for (const imk_repeatability *r = runs; r < runs + axes; r++) {
        char lower[NUMBER], upper[NUMBER];
        imk_readable_value(r->lower / unit.scale, 0, 3, lower, sizeof lower);
        imk_readable_value(r->upper / unit.scale, 0, 3, upper, sizeof upper);
        imk_table_add(table, "%s%s%s", r->lower > 0 ? lower : "", r->lower > 0 ? " to " : "< ",
                      upper);
    }
    imk_table_row(table, "within the runs\t%s", unit.text);
    for (const imk_repeatability *r = runs; r < runs + axes; r++)
        imk_table_add(table, "%.3g", r->within / unit.scale);
}

void imki_runs_table(const imk_calibrate_log *b, int sensor, imk_result *result)
{
    const int axes = b->runs->axis_count[sensor];
    if (axes == 0)
        return;
    imk_table *table = begin_axes(imki_sensor_titles[sensor], axes, result);
    add_runs(table, b->runs->bias[sensor], "bias", imki_sensor_units[sensor], axes);
    add_runs(table, b->runs->scale_factor[sensor], "scale factor", "1", axes);
    imk_result_gap(result);
}

/* ---- temperature ----------------------------------------------------------------------------- */

static void add_number(imk_table *table, double value)
{
    if (isfinite(value))
        imk_table_add(table, "%.4g", value);
    else
        imk_table_add(table, "-");
}

/* Warming against cooling. In brief: some four temperatures, with round numbers. */
static void add_loop(imk_table *table, const imk_thermal_findings *f, int sensor,
                     const imk_unit *unit, bool brief)
{
    imk_table_row(table, "why warming and cooling differ\t");
    for (int i = 0; i < f->axis_count[sensor]; i++)
        imk_table_add(table, "%s", imk_thermal_cause_name(f->axis[sensor][i].cause));
    imk_table_row(table, "width of the loop\t%s", unit->text);
    for (int i = 0; i < f->axis_count[sensor]; i++) {
        const imk_scalar *width = &f->axis[sensor][i].hysteresis;
        add_value(table, width->value / unit->scale, width->sigma / unit->scale, 3);
    }
    for (int k = 0; k < f->gap_count; k++) {
        const double celsius = f->gap_temperature[k] - KELVIN / 100.0;
        if (brief && f->gap_count > 5 && fmod(floor(celsius + 0.5), 25) != 0)
            continue;
        imk_table_row(table, "warming less cooling at %.0f degC\t%s", celsius, unit->text);
        for (int i = 0; i < f->axis_count[sensor]; i++)
            add_number(table, f->axis[sensor][i].gap[k].value / unit->scale);
    }
}

void imki_thermal_table(const imk_calibrate_record *log, int sensor, bool brief, imk_result *result)
{
    static const char *const rms[4] = {"scatter before", "after the polynomial",
                                       "after compensation", "after the whole fit"};
    static const char *const titles[2] = {"gyro over temperature",
                                          "accelerometer over temperature"};
    const imk_thermal_findings *f = log->thermal;
    const int axes = f ? f->axis_count[sensor] : 0;
    if (axes == 0)
        return;
    imk_table *table = begin_axes(titles[sensor], axes, result);
    const imk_unit unit = imk_unit_readable(imk_unit_of(imki_sensor_units[sensor]).dimension,
                                            f->axis[sensor][0].scatter);
    imk_table_row(table, "order of the polynomial\t");
    for (int i = 0; i < axes; i++)
        imk_table_add(table, "%d", f->axis[sensor][i].order);
    for (int order = 0; order <= IMK_TEMPERATURE_ORDER_MAX; order++) {
        imk_table_row(table, "predicted by order %d (rms)\t%s", order, unit.text);
        for (int i = 0; i < axes; i++)
            add_number(table, f->axis[sensor][i].score[order] / unit.scale);
    }
    for (int k = 0; k < 4; k++) {
        imk_table_row(table, "%s (rms)\t%s", rms[k], unit.text);
        for (const imk_thermal_axis *a = f->axis[sensor]; a < f->axis[sensor] + axes; a++)
            add_number(table, (k == 0   ? a->scatter
                               : k == 1 ? a->rms_polynomial
                               : k == 2 ? a->rms_compensated
                                        : a->rms) /
                                  unit.scale);
    }
    add_loop(table, f, sensor, &unit, brief);
    imk_result_gap(result);
}
