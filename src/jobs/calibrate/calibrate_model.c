/* SPDX-License-Identifier: Apache-2.0 */
/* The model that is written: values with 1 sigma to the digits they have, 95 % intervals,
 * correlations, and where they come from.
 *
 * Values are rounded to a hundredth of their 1 sigma, in the units of the model file, so that the
 * file can be read by people and says what was computed all the same. */
#include "calibrate_internal.h"

#include "jobs/job_internal.h"

#include "imukit/decimal.h"
#include "imukit/utf8.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { SIGMA_DIGITS = 4, DIGITS_MAX = 15 };

/* ---- rounding -------------------------------------------------------------------------------- */

/* The double a reader gets from the value written with so many digits in a unit. */
static double rounded(double value, int digits, const char *unit)
{
    char text[80];
    double result, sigma;
    size_t count;
    const imk_unit u = imk_unit_of(unit);
    if (value == 0 || !isfinite(value) || !(u.scale > 0))
        return value;
    const size_t length = imk_decimal_significant(value / u.scale, digits, text);
    snprintf(text + length, sizeof text - length, " %s", unit);
    if (imk_quantity_parse(text, text + strlen(text), u.dimension, 1, &result, &sigma, &count, NULL,
                           NULL) != IMK_OK)
        return value;
    return result;
}

/* Significant digits that reach a hundredth of the uncertainty. */
static int digits_for(double value, double uncertainty)
{
    if (!(uncertainty > 0) || value == 0)
        return DIGITS_MAX;
    const int digits = (int)floor(log10(fabs(value))) - (int)floor(log10(uncertainty)) + 3;
    return digits < 1 ? 1 : digits > DIGITS_MAX ? DIGITS_MAX : digits;
}

static void round_parameter(imk_model *model, imk_model_parameter parameter)
{
    double *sigma = NULL, *value = imk_model_parameter_at(model, parameter, &sigma);
    const char *unit = imk_parameter_file_unit(parameter);
    if (!value)
        return;
    *value = rounded(*value, digits_for(*value, *sigma), unit);
    *sigma = rounded(*sigma, SIGMA_DIGITS, unit);
}

static void round_axes(imk_axes *axes, const char *unit)
{
    for (int axis = 0; axis < IMK_AXES_MAX; axis++) {
        const double sigma = axes->sigma[axis];
        const int digits = sigma > 0 ? digits_for(axes->value[axis], sigma) : (int)SIGMA_DIGITS;
        axes->value[axis] = rounded(axes->value[axis], digits, unit);
        axes->sigma[axis] = rounded(sigma, SIGMA_DIGITS, unit);
    }
}

/* bias.repeatability and scale_factor.repeatability with their intervals. */
static void round_repeatability(imk_model *model, int sensor)
{
    static const char *const units[2] = {"deg/h", "mg"};
    imk_triad *triad = imk_model_triad_to_set(model, sensor);
    imk_evidence *evidence = sensor == 0 ? &model->gyro_evidence : &model->accel_evidence;
    round_axes(&triad->bias.repeatability, units[sensor]);
    round_axes(&triad->scale_factor.repeatability, "ppm");
    for (int k = 0; k < evidence->interval_count; k++) {
        imk_interval *interval = &evidence->interval[k];
        const bool bias = strcmp(interval->key, "bias.repeatability") == 0;
        if (!bias && strcmp(interval->key, "scale_factor.repeatability") != 0)
            continue;
        for (int axis = 0; axis < triad->axis_count; axis++) {
            const char *unit = bias ? units[sensor] : "ppm";
            interval->lower.value[axis] = rounded(interval->lower.value[axis], SIGMA_DIGITS, unit);
            interval->upper.value[axis] = rounded(interval->upper.value[axis], SIGMA_DIGITS, unit);
        }
    }
}

/* ---- evidence -------------------------------------------------------------------------------- */

/* Key of a term that has one number per axis, as intervals want it; false for others. */
static bool interval_key(imk_model_parameter parameter, char *key, size_t size)
{
    char name[IMK_MODEL_PARAMETER_NAME];
    if (imk_model_term_elements(parameter.sensor, parameter.term) != 1 ||
        imk_model_parameter_name(parameter, name) != IMK_OK)
        return false;
    const char *begin = strchr(name, '.') + 1;
    snprintf(key, size, "%.*s", (int)(strrchr(begin, '.') - begin), begin);
    return true;
}

/* Put an interval in the place of the one of the same key, or behind the others. */
static void put_interval(imk_evidence *evidence, const imk_interval *interval)
{
    int k = 0;
    while (k < evidence->interval_count && strcmp(evidence->interval[k].key, interval->key) != 0)
        k++;
    if (k == IMK_INTERVALS_MAX)
        return;
    evidence->interval[k] = *interval;
    evidence->interval_count += k == evidence->interval_count;
}

static imk_evidence *evidence_of(imk_model *model, int sensor)
{
    return sensor == IMK_GYRO    ? &model->gyro_evidence
           : sensor == IMK_ACCEL ? &model->accel_evidence
                                 : &model->mag_evidence;
}

/* 95 % interval of a term that was estimated on every axis. */
static void state_interval(const imk_calibrate_log *b, imk_model *model, int sensor, int term)
{
    const imk_triad *triad = imk_model_triad(model, sensor);
    const imk_model_parameter first = {(uint8_t)sensor, (uint8_t)term, 0, 0};
    const char *unit = imk_parameter_file_unit(first);
    imk_interval interval = {.instance = 0};
    if (!interval_key(first, interval.key, sizeof interval.key))
        return;
    for (int axis = 0; axis < triad->axis_count; axis++) {
        imk_model_parameter p = first;
        p.axis = (uint8_t)axis;
        const int found = imk_calibrate_find(b, p);
        if (found < 0)
            return;
        const double half = imk_calibration_half_width(b->result, found, 0.95);
        const double low = b->result->value[found] - half, high = b->result->value[found] + half;
        if (!isfinite(half))
            return;
        interval.lower.value[axis] = rounded(low, digits_for(low, half / 2), unit);
        interval.upper.value[axis] = rounded(high, digits_for(high, half / 2), unit);
    }
    put_interval(evidence_of(model, sensor), &interval);
}

static bool estimated(const imk_calibrate_log *b, int sensor)
{
    for (size_t p = 0; b->result && p < b->result->parameter_count; p++)
        if (b->result->parameter[p].sensor == sensor)
            return true;
    return b->runs && sensor < IMK_MAG && b->runs->axis_count[sensor] > 0;
}

/* Put a text behind ", " unless it is the first. */
static void add_item(char *list, size_t size, const char *item)
{
    const size_t length = strlen(list);
    snprintf(list + length, size - length, "%s%s", length > 0 ? ", " : "", item);
}

/* Names of the logs, and how they were used. */
static void describe(const imk_calibrate_log *b, imk_evidence *evidence)
{
    char logs[8192] = "", names[400] = "";
    for (size_t k = 0; k < b->count; k++)
        add_item(logs, sizeof logs, b->record[k].record.name);
    imk_utf8_clean(logs, evidence->source, sizeof evidence->source);
    if (b->runs) {
        snprintf(evidence->method, sizeof evidence->method,
                 "imukit %s calibrate: repeatability of %zu runs", IMK_VERSION, b->run_count);
        return;
    }
    if (b->ferraris) {
        snprintf(evidence->method, sizeof evidence->method,
                 "imukit %s calibrate: ferraris, closed form, gravity %.6g m/s^2", IMK_VERSION,
                 b->calibration->gravity);
        return;
    }
    for (size_t k = 0; k < b->count; k++) {
        const char *name = imk_procedure_name(b->record[k].procedure);
        if (!strstr(names, name))
            add_item(names, sizeof names, name);
    }
    snprintf(evidence->method, sizeof evidence->method,
             "imukit %s calibrate: %s, maximum likelihood, %zu observations, %zu turns, gravity "
             "%.6g m/s^2",
             IMK_VERSION, names, b->calibration->observation_count, b->calibration->turn_count,
             b->calibration->gravity);
}

/* Behind the names of the logs, which are those of all sensors. */
static void describe_magnetometer(const imk_calibrate_log *b, imk_evidence *evidence)
{
    const imk_magnetometer_result *r = b->mag;
    char field[80] = "determinant 1 by convention";
    if (r->field_known)
        snprintf(field, sizeof field, "field %.5g uT", 1e6 * r->value[IMK_MAGNETOMETER_FIELD]);
    snprintf(evidence->method, sizeof evidence->method,
             "imukit %s calibrate: magnetometer, maximum likelihood, %zu means%s; %s", IMK_VERSION,
             b->magnetometer->count, r->aligned ? ", aligned by the dip" : "", field);
    snprintf(evidence->frame, sizeof evidence->frame, "%s",
             imk_triad_frame_name(r->aligned ? b->calibration->frame : b->magnetometer->frame));
}

/* What temperature does besides the polynomials that were solved for. */
static void apply_thermal(imk_calibrate_log *b, imk_model *model)
{
    static const char *const width[2] = {"deg/h", "mg"};
    static const char *const rate[2] = {"deg/h/(K/min)", "mg/(K/min)"};
    imk_triad *triad[2] = {&model->gyro, &model->accel};
    for (size_t k = 0; k < b->count; k++) {
        if (!b->record[k].thermal)
            continue;
        const imk_status status = imk_thermal_apply(b->record[k].thermal, false, model, NULL);
        if (status != IMK_OK)
            imki_find(&b->findings, IMK_FINDING_WARNING, "temperature_left_out", b->record[k].path,
                      IMKI_NUMBERS(status));
        for (int sensor = 0; sensor < 2; sensor++) {
            round_axes(&triad[sensor]->bias.hysteresis, width[sensor]);
            round_axes(&triad[sensor]->bias.temperature_rate, rate[sensor]);
        }
    }
}

void imki_calibrate_model(imk_calibrate_log *b)
{
    imk_model *model = &b->model;
    *model = b->result ? b->result->model : b->calibration->model;
    if (b->runs)
        imk_repeatability_to_model(b->runs, model);
    apply_thermal(b, model);
    for (size_t p = 0; b->result && p < b->result->parameter_count; p++)
        round_parameter(model, b->result->parameter[p]);
    for (int sensor = 0; sensor < IMK_KINDS; sensor++) {
        if (!estimated(b, sensor))
            continue;
        for (int term = 0; b->result && term < IMK_MODEL_TERMS; term++)
            state_interval(b, model, sensor, term);
        if (b->runs)
            round_repeatability(model, sensor);
        describe(b, evidence_of(model, sensor));
    }
    if (b->mag)
        describe_magnetometer(b, &model->mag_evidence);
}
