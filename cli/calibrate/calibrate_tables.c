/* SPDX-License-Identifier: Apache-2.0 */
/* The solution as tables: parameters by axis with 1 sigma and 95 % interval, the fit of each group
 * of observations, the poses. */
#include "calibrate_parts.h"

#include <math.h>
#include <string.h>

static const double degree = 0.017453292519943295;

/* ---- parameters ------------------------------------------------------------------------------ */

static const imk_triad *triad_of(const bench *b, int sensor)
{
    const imk_model *model = b->result ? &b->result->model : &b->model;
    return sensor == 0 ? &model->gyro : &model->accel;
}

static const char *axis_title(int axis)
{
    static const char *const names[IMK_AXES_MAX] = {"x", "y", "z", "3", "4", "5", "6", "7"};
    return names[axis];
}

/* One row of values and one of intervals for a number on every axis. */
static void parameter_rows(text_table *table, const bench *b, imk_model_parameter parameter,
                           int axes)
{
    const imk_calibration_result *r = b->result;
    double magnitude = 0;
    int found[IMK_AXES_MAX];
    bool any = false;
    for (int axis = 0; axis < axes; axis++) {
        parameter.axis = (uint8_t)axis;
        found[axis] = bench_find(b, parameter);
        if (found[axis] < 0)
            continue;
        any = true;
        magnitude = fmax(magnitude, fmax(fabs(r->value[found[axis]]), r->sigma[found[axis]]));
    }
    if (!any)
        return;
    const imk_unit unit = parameter_unit(parameter, magnitude);
    char title[80], value[40], sigma[40], lower[40], upper[40];
    parameter_title(parameter, title, sizeof title);
    text_table_row(table);
    text_table_set(table, 0, "%s", title);
    text_table_set(table, 1, "%s", unit.text);
    for (int axis = 0; axis < axes; axis++) {
        if (found[axis] < 0) {
            text_table_set(table, 2 + (size_t)axis, "-");
            continue;
        }
        const double s = r->sigma[found[axis]] / unit.scale;
        format_value(r->value[found[axis]] / unit.scale, s, 5, value, sizeof value);
        format_value(s, s, 2, sigma, sizeof sigma);
        text_table_set(table, 2 + (size_t)axis, "%s ± %s", value, sigma);
    }
    text_table_row(table);
    text_table_set(table, 1, "95 %%");
    for (int axis = 0; axis < axes; axis++) {
        if (found[axis] < 0)
            continue;
        const double half = imk_calibration_half_width(r, found[axis], 0.95) / unit.scale;
        const double middle = r->value[found[axis]] / unit.scale;
        format_value(middle - half, half / 2, 5, lower, sizeof lower);
        format_value(middle + half, half / 2, 5, upper, sizeof upper);
        text_table_set(table, 2 + (size_t)axis, "%s to %s", lower, upper);
    }
}

/* Readings in counts: what they make of a unit of input, and what they are without any. */
static void count_rows(text_table *table, const bench *b, int sensor)
{
    static const char *const units[2] = {"count/(rad/s)", "count/(m/s^2)"};
    static const int terms[2] = {IMK_MODEL_SCALE_FACTOR, IMK_MODEL_BIAS};
    const imk_triad *triad = triad_of(b, sensor);
    if (triad->sensitivity.value[0] == 0)
        return;
    for (int row = 0; row < 2; row++) {
        text_table_row(table);
        text_table_set(table, 0, row == 0 ? "counts per unit" : "counts at zero input");
        text_table_set(table, 1, "%s", row == 0 ? units[sensor] : "count");
        for (int axis = 0; axis < triad->axis_count; axis++) {
            const imk_model_parameter p = {(uint8_t)sensor, (uint8_t)terms[row], (uint8_t)axis, 0};
            const int found = bench_find(b, p);
            const double s = triad->sensitivity.value[axis];
            const double value =
                row == 0 ? s * (1 + triad->scale_factor.fixed.value[axis])
                         : triad->zero_offset.value[axis] + s * triad->bias.fixed.value[axis];
            const double one = found < 0 ? 0 : fabs(s) * b->result->sigma[found];
            char text[40], sigma[40];
            format_value(value, one, 6, text, sizeof text);
            format_value(one, one, 2, sigma, sizeof sigma);
            text_table_set(table, 2 + (size_t)axis, "%s%s%s", text, found < 0 ? "" : " ± ",
                           found < 0 ? "" : sigma);
        }
    }
}

text_table bench_parameter_table(const bench *b, int sensor)
{
    const imk_triad *triad = triad_of(b, sensor);
    const int axes = triad->present ? triad->axis_count : 0;
    text_table table = text_table_make(2 + (size_t)axes);
    bool any = false;
    for (size_t p = 0; b->result && p < b->result->parameter_count; p++)
        any = any || b->result->parameter[p].sensor == sensor;
    if (!any)
        return table;
    text_table_row(&table);
    text_table_set(&table, 0, sensor == 0 ? "gyro" : "accelerometer");
    text_table_set(&table, 1, "unit");
    for (int axis = 0; axis < axes; axis++)
        text_table_set(&table, 2 + (size_t)axis, "%s", axis_title(axis));
    for (int term = 0; term < IMK_MODEL_TERMS; term++)
        for (int element = 0; element < imk_model_term_elements(sensor, term); element++) {
            const imk_model_parameter p = {(uint8_t)sensor, (uint8_t)term, 0, (uint8_t)element};
            parameter_rows(&table, b, p, axes);
        }
    count_rows(&table, b, sensor);
    return table;
}

/* ---- fit ------------------------------------------------------------------------------------- */

text_table bench_fit_table(const bench *b)
{
    static const char *const names[IMK_GROUPS] = {"gyro readings", "accelerometer readings",
                                                  "turns between poses"};
    static const char *const si[IMK_GROUPS] = {"rad/s", "m/s^2", "rad"};
    static const char *const headers[] = {"fit",         "observed",  "left out",
                                          "chi^2 / dof", "1 sigma x", "residuals (rms)"};
    text_table table = text_table_make(6);
    if (!b->result || b->ferraris)
        return table;
    text_table_row(&table);
    for (size_t c = 0; c < 6; c++)
        text_table_set(&table, c, "%s", headers[c]);
    for (int g = 0; g < IMK_GROUPS; g++) {
        const imk_group_fit *fit = &b->result->group[g];
        if (fit->count == 0)
            continue;
        imk_unit unit = imk_unit_readable(imk_unit_of(si[g]).dimension, fit->rms);
        text_table_row(&table);
        text_table_set(&table, 0, "%s", names[g]);
        text_table_set(&table, 1, "%zu", fit->count);
        text_table_set(&table, 2, "%zu", fit->refused);
        if (fit->degrees_of_freedom >= 0.5)
            text_table_set(&table, 3, "%.4g / %.1f", fit->chi_square, fit->degrees_of_freedom);
        else
            text_table_set(&table, 3, "-");
        text_table_set(&table, 4, "%.3g", fit->factor);
        text_table_set(&table, 5, "%.4g %s", fit->rms / unit.scale, unit.text);
    }
    return table;
}

/* ---- poses ----------------------------------------------------------------------------------- */

static double time_of(const imk_test_record *record, size_t row)
{
    return record->time ? record->time[row] : (double)row * record->dt;
}

/* Largest residual of a sensor in a pose, SI; NaN when it was not observed. */
static double worst_residual(const imk_observation *o, int sensor)
{
    double most = (double)NAN;
    for (int axis = 0; axis < IMK_AXES_MAX; axis++)
        if (isfinite(o->residual[sensor][axis]) && !(fabs(o->residual[sensor][axis]) <= fabs(most)))
            most = o->residual[sensor][axis];
    return most;
}

static void pose_row(text_table *table, const bench *b, const imk_observation *o)
{
    const imk_test_record *record = b->calibration->record[o->record];
    const double *up = o->knowledge == IMK_INPUT_GRAVITY ? o->vertical : o->force;
    const double norm = sqrt(up[0] * up[0] + up[1] * up[1] + up[2] * up[2]);
    text_table_row(table);
    if (b->log_count > 1)
        text_table_set(table, 0, "%.30s", record->name);
    text_table_set(table, 1, "%.2f", time_of(record, o->begin));
    text_table_set(table, 2, "%.2f", (double)(o->end - o->begin) * record->dt);
    if (norm > 0)
        text_table_set(table, 3, "%+.3f %+.3f %+.3f", up[0] / norm, up[1] / norm, up[2] / norm);
    if (isfinite(o->temperature))
        text_table_set(table, 4, "%.1f", o->temperature - 273.15);
    const double accel = worst_residual(o, 1), gyro = worst_residual(o, 0);
    if (isfinite(accel))
        text_table_set(table, 5, "%+.3f", accel * 1e3 / 9.80665);
    if (isfinite(gyro))
        text_table_set(table, 6, "%+.5f", gyro / degree);
    text_table_set(table, 7, "%.1f", o->distance);
    text_table_set(table, 8, o->weight > 0.5 ? "" : o->weight > 0 ? "doubtful" : "left out");
}

text_table bench_pose_table(const bench *b)
{
    static const char *const headers[] = {"log",          "from [s]", "length [s]",
                                          "force along",  "[degC]",   "accel [mg]",
                                          "gyro [deg/s]", "sigmas",   ""};
    const imk_calibration *c = b->calibration;
    text_table table = text_table_make(9);
    if (!b->result || b->ferraris)
        return table;
    text_table_row(&table);
    for (size_t k = 0; k < 9; k++)
        text_table_set(&table, k, "%s", k > 0 || b->log_count > 1 ? headers[k] : "");
    for (size_t k = 0; k < c->observation_count; k++)
        pose_row(&table, b, &c->observation[k]);
    return table;
}

/* ---- runs ------------------------------------------------------------------------------------ */

static void run_rows(text_table *table, const imk_repeatability *runs, const char *title,
                     const char *si, int axes)
{
    double magnitude = 0;
    for (int axis = 0; axis < axes; axis++)
        magnitude = fmax(magnitude, fmax(runs[axis].value, runs[axis].within));
    if (axes == 0 || runs[0].runs == 0)
        return;
    const imk_unit unit = imk_unit_readable(imk_unit_of(si).dimension, magnitude);
    for (int row = 0; row < 3; row++) {
        static const char *const names[3] = {"1 sigma from run to run", "", "within the runs"};
        text_table_row(table);
        if (row == 1)
            text_table_set(table, 1, "95 %%");
        else
            text_table_set(table, 1, "%s", unit.text);
        text_table_set(table, 0, "%s%s%s", row == 0 ? title : "", row == 0 ? ", " : "", names[row]);
        for (int axis = 0; axis < axes; axis++) {
            const imk_repeatability *r = &runs[axis];
            char lower[40], upper[40];
            format_value(r->lower / unit.scale, 0, 3, lower, sizeof lower);
            format_value(r->upper / unit.scale, 0, 3, upper, sizeof upper);
            if (row == 0 && r->lower > 0)
                text_table_set(table, 2 + (size_t)axis, "%.3g", r->value / unit.scale);
            else if (row == 0)
                text_table_set(table, 2 + (size_t)axis, "not seen");
            else if (row == 1 && r->lower > 0)
                text_table_set(table, 2 + (size_t)axis, "%s to %s", lower, upper);
            else if (row == 1)
                text_table_set(table, 2 + (size_t)axis, "< %s", upper);
            else
                text_table_set(table, 2 + (size_t)axis, "%.3g", r->within / unit.scale);
        }
    }
}

text_table bench_run_table(const bench *b, int sensor)
{
    const int axes = b->runs ? b->runs->axis_count[sensor] : 0;
    text_table table = text_table_make(2 + (size_t)axes);
    if (axes == 0)
        return table;
    text_table_row(&table);
    text_table_set(&table, 0, sensor == 0 ? "gyro" : "accelerometer");
    text_table_set(&table, 1, "unit");
    for (int axis = 0; axis < axes; axis++)
        text_table_set(&table, 2 + (size_t)axis, "%s", axis_title(axis));
    run_rows(&table, b->runs->bias[sensor], "bias", sensor == 0 ? "rad/s" : "m/s^2", axes);
    run_rows(&table, b->runs->scale_factor[sensor], "scale factor", "1", axes);
    return table;
}
