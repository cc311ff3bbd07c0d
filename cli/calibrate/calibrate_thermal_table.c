/* SPDX-License-Identifier: Apache-2.0 */
/* What temperature does, by axis: how the order was chosen, what is left, warming against
 * cooling. */
#include "calibrate_parts.h"

#include <math.h>

enum { KELVIN = 27315 }; /* of 0 degC, in hundredths */

/* A row of one number per axis. */
static void number_row(text_table *table, const imk_thermal_findings *f, int sensor,
                       const char *title, const char *unit,
                       double (*number)(const imk_thermal_axis *axis, int which), int which,
                       double scale)
{
    text_table_row(table);
    text_table_set(table, 0, "%s", title);
    text_table_set(table, 1, "%s", unit);
    for (int i = 0; i < f->axis_count[sensor]; i++) {
        const double value = number(&f->axis[sensor][i], which);
        if (isfinite(value))
            text_table_set(table, 2 + (size_t)i, "%.4g", value / scale);
        else
            text_table_set(table, 2 + (size_t)i, "-");
    }
}

static double order_of(const imk_thermal_axis *axis, int which)
{
    (void)which;
    return axis->order;
}

static double score_of(const imk_thermal_axis *axis, int which)
{
    return axis->score[which];
}

static double rms_of(const imk_thermal_axis *axis, int which)
{
    const double rms[4] = {axis->scatter, axis->rms_polynomial, axis->rms_compensated, axis->rms};
    return rms[which];
}

static double gap_of(const imk_thermal_axis *axis, int which)
{
    return axis->gap[which].value;
}

static void cause_rows(text_table *table, const imk_thermal_findings *f, int sensor,
                       const imk_unit *unit)
{
    text_table_row(table);
    text_table_set(table, 0, "warming and cooling differ by");
    for (int i = 0; i < f->axis_count[sensor]; i++)
        text_table_set(table, 2 + (size_t)i, "%s",
                       imk_thermal_cause_name(f->axis[sensor][i].cause));
    text_table_row(table);
    text_table_set(table, 0, "width of the loop");
    text_table_set(table, 1, "%s", unit->text);
    for (int i = 0; i < f->axis_count[sensor]; i++) {
        const imk_scalar *width = &f->axis[sensor][i].hysteresis;
        char value[40], sigma[40];
        format_value(width->value / unit->scale, width->sigma / unit->scale, 3, value,
                     sizeof value);
        format_value(width->sigma / unit->scale, width->sigma / unit->scale, 2, sigma,
                     sizeof sigma);
        text_table_set(table, 2 + (size_t)i, "%s ± %s", value, sigma);
    }
}

/* In brief: some four temperatures, with round numbers. */
static bool is_shown(const imk_thermal_findings *f, int gap, bool brief)
{
    const double celsius = floor(f->gap_temperature[gap] - KELVIN / 100.0 + 0.5);
    return !brief || f->gap_count <= 5 || fmod(celsius, 25) == 0;
}

text_table bench_thermal_table(const bench_log *log, int sensor, bool brief)
{
    static const char *const titles[4] = {"scatter before (rms)", "after the polynomial (rms)",
                                          "after compensation (rms)", "after all of it (rms)"};
    const imk_thermal_findings *f = log->thermal;
    const int axes = f ? f->axis_count[sensor] : 0;
    text_table table = text_table_make(2 + (size_t)axes);
    if (axes == 0)
        return table;
    text_table_row(&table);
    text_table_set(&table, 0,
                   sensor == 0 ? "gyro over temperature" : "accelerometer over temperature");
    text_table_set(&table, 1, "unit");
    for (int i = 0; i < axes; i++)
        text_table_set(&table, 2 + (size_t)i, "%c", i < 3 ? "xyz"[i] : '0' + i);
    const imk_unit unit = imk_unit_readable(imk_unit_of(sensor == 0 ? "rad/s" : "m/s^2").dimension,
                                            f->axis[sensor][0].scatter);
    number_row(&table, f, sensor, "order of the polynomial", "", order_of, 0, 1);
    for (int order = 0; order <= IMK_TEMPERATURE_ORDER_MAX; order++) {
        char title[60];
        snprintf(title, sizeof title, "predicted by order %d (rms)", order);
        number_row(&table, f, sensor, title, unit.text, score_of, order, unit.scale);
    }
    for (int k = 0; k < 4; k++)
        number_row(&table, f, sensor, titles[k], unit.text, rms_of, k, unit.scale);
    cause_rows(&table, f, sensor, &unit);
    for (int k = 0; k < f->gap_count; k++) {
        char title[60];
        if (!is_shown(f, k, brief))
            continue;
        snprintf(title, sizeof title, "warming less cooling at %.0f degC",
                 f->gap_temperature[k] - KELVIN / 100.0);
        number_row(&table, f, sensor, title, unit.text, gap_of, k, unit.scale);
    }
    return table;
}
