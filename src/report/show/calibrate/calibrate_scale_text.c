/* SPDX-License-Identifier: Apache-2.0 */
/* Scale factors that no sensor has, in words: what the ratio looks like. */
#include "calibrate_show_internal.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* A ratio counts as one that is known when it is met to this part: sensors err by less, and the
 * ratios are farther apart. */
static const double tolerance = 0.12;

/* The same behind "; or " unless it is the first. */
#define add_cause(list, ...)                                                                       \
    (imki_text_put(list, (list)->size > 0 ? "; or " : ""), imki_text_add(list, __VA_ARGS__))

static bool is_near(double value, double due)
{
    return fabs(value / due - 1) < tolerance;
}

/* "2" or "1/2" of a power of two; "": it is none. */
static void power_of_two(double ratio, char text[16])
{
    text[0] = '\0';
    for (int power = 1; power <= 4; power++) {
        const double two = (double)(1 << power);
        if (is_near(ratio, two))
            snprintf(text, 16, "%g", two);
        else if (is_near(ratio, 1 / two))
            snprintf(text, 16, "1/%g", two);
    }
}

/* The angle of a turn is rate times time: a wrong sampling rate looks like a scale factor, unless
 * the rates themselves are known. */
static bool is_of_angles(const imk_calibrate_log *b)
{
    for (size_t k = 0; k < b->count; k++)
        if (b->record[k].procedure < IMK_PROCEDURE_RATE_TABLE ||
            b->record[k].procedure == IMK_PROCEDURE_THERMAL ||
            b->record[k].procedure == IMK_PROCEDURE_TURNS)
            return true;
    return false;
}

static void add_rate(const imk_calibrate_log *b, double ratio, imki_text *to)
{
    const imk_test_record *record = &b->record[0].record;
    if (!is_of_angles(b))
        return;
    add_cause(to,
              "a sampling rate of about %.3g Hz instead of %.4g Hz (the angle of a turn is rate "
              "times time: check %s)",
              ratio / record->dt, 1 / record->dt,
              record->time ? "the times and their unit" : "--rate");
}

static void add_angle(const imk_calibrate_log *b, double ratio, imki_text *to)
{
    bool stated = false;
    for (size_t k = 0; k < b->count; k++)
        stated = stated || b->record[k].procedure == IMK_PROCEDURE_TURNS;
    if (stated)
        add_cause(to, "turns by %.3g times the angle stated (--turn-angle, or the labels)", ratio);
}

static void add_unit(int sensor, double ratio, imki_text *to)
{
    static const struct {
        int sensor;
        double ratio;
        const char *words;
    } units[] = {{0, 57.29577951308232, "readings in deg/s taken for rad/s"},
                 {0, 0.017453292519943295, "readings in rad/s taken for deg/s"},
                 {1, 1 / 9.80665, "readings in g taken for m/s^2"},
                 {1, 9.80665, "readings in m/s^2 taken for g"},
                 {1, 1 / 0.3048, "readings in ft/s^2 taken for m/s^2"}};
    for (size_t k = 0; k < sizeof units / sizeof *units; k++)
        if (units[k].sensor == sensor && is_near(ratio, units[k].ratio))
            add_cause(to, "%s", units[k].words);
}

/* `record` is in counts: of a sensitivity that was stated. */
static void add_range(const imk_calibrate_log *b, int sensor, double ratio, imki_text *to)
{
    char factor[16], of_range[16];
    power_of_two(ratio, factor);
    power_of_two(1 / ratio, of_range);
    if (factor[0])
        add_cause(to, "a range of the device that is %s times that of the %s", of_range,
                  b->record[0].record.counts[sensor] ? "stated sensitivity" : "conversion");
}

void imki_scale_causes(const imk_calibrate_log *b, int sensor, double ratio, bool all_axes,
                       imki_text *to)
{
    const size_t before = to->size;
    if (ratio < 0)
        add_cause(to, "the opposite sign of %s",
                  all_axes ? "all columns, or of the reference" : "this column, or of a label");
    if (all_axes)
        add_unit(sensor, ratio, to);
    add_range(b, sensor, ratio, to);
    if (all_axes && sensor == 0 && ratio > 0)
        add_rate(b, ratio, to);
    if (sensor == 0 && ratio > 0)
        add_angle(b, ratio, to);
    if (to->size > before)
        return;
    add_cause(to, "a wrong unit or sensitivity%s",
              all_axes ? "" : " of this axis, or a fault of the sensor");
    if (sensor == 0 && !is_of_angles(b))
        add_cause(to, "a reference in another unit or about another axis");
}

void imki_scale_text(const imk_calibrate_log *b, const imk_diagnostic_finding *d, char *text,
                     size_t size)
{
    imki_text causes = {0};
    char which[40];
    const bool all = d->axis < 0;
    if (all)
        snprintf(which, sizeof which, "all %ss", imki_sensor_titles[d->sensor]);
    else
        snprintf(which, sizeof which, "%s_%c", imki_sensor_keys[d->sensor],
                 imk_axis_letter(d->axis));
    imki_scale_causes(b, d->sensor, d->value, all, &causes);
    snprintf(text, size,
             "%s read%s %.3g times the true %s: %s such sensor%s by more than %.2g %%. %s "
             "causes: %s",
             which, all ? "" : "s", d->value, d->sensor == 0 ? "rate" : "force",
             d->limit < 0.1 ? "few" : "no", d->limit < 0.1 ? "s err" : " errs", 100 * d->limit,
             d->limit < 0.1 ? "Possible" : "Likely", causes.bytes ? causes.bytes : "");
    free(causes.bytes);
}
