/* SPDX-License-Identifier: Apache-2.0 */
/* The model that is written: values with 1 sigma to the digits they have, 95 % intervals,
 * correlations, and where they come from.
 *
 * Values are rounded to a hundredth of their 1 sigma, in the units of the model file, so that the
 * file can be read by people and says what was computed all the same. */
#include "calibrate_parts.h"
#include "shell/growing_list.h"
#include "shell/model_changes.h"

#include "imukit/utf8.h"

#include <math.h>
#include <stdlib.h>
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
    imk_triad *triad = sensor == 0 ? &model->gyro : &model->accel;
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

/* 95 % interval of a term that was estimated on every axis. */
static void state_interval(const bench *b, imk_model *model, int sensor, int term)
{
    const imk_triad *triad = sensor == 0 ? &model->gyro : &model->accel;
    const imk_model_parameter first = {(uint8_t)sensor, (uint8_t)term, 0, 0};
    const char *unit = imk_parameter_file_unit(first);
    imk_interval interval = {.instance = 0};
    if (!interval_key(first, interval.key, sizeof interval.key))
        return;
    for (int axis = 0; axis < triad->axis_count; axis++) {
        imk_model_parameter p = first;
        p.axis = (uint8_t)axis;
        const int found = imk_calibrate_find(b->found, p);
        if (found < 0)
            return;
        const double half = imk_calibration_half_width(b->found->result, found, 0.95);
        const double low = b->found->result->value[found] - half,
                     high = b->found->result->value[found] + half;
        if (!isfinite(half))
            return;
        interval.lower.value[axis] = rounded(low, digits_for(low, half / 2), unit);
        interval.upper.value[axis] = rounded(high, digits_for(high, half / 2), unit);
    }
    put_interval(sensor == 0 ? &model->gyro_evidence : &model->accel_evidence, &interval);
}

static bool estimated(const bench *b, int sensor)
{
    for (size_t p = 0; b->found->result && p < b->found->result->parameter_count; p++)
        if (b->found->result->parameter[p].sensor == sensor)
            return true;
    return b->found->runs && b->found->runs->axis_count[sensor] > 0;
}

/* Names of the logs, and how they were used. */
static void describe(const bench *b, imk_evidence *evidence)
{
    growing_list logs = {0}, names = {0};
    for (size_t k = 0; k < b->found->count; k++)
        list_add_item(&logs, "%s", b->found->record[k].record.name);
    imk_utf8_clean(logs.text, evidence->source, sizeof evidence->source);
    list_free(&logs);
    if (b->found->runs) {
        snprintf(evidence->method, sizeof evidence->method,
                 "imukit %s calibrate: repeatability of %zu runs", IMK_VERSION,
                 b->found->run_count);
        return;
    }
    if (b->found->ferraris) {
        snprintf(evidence->method, sizeof evidence->method,
                 "imukit %s calibrate: ferraris, closed form, gravity %.6g m/s^2", IMK_VERSION,
                 b->found->calibration->gravity);
        return;
    }
    for (size_t k = 0; k < b->found->count; k++) {
        const char *name = imk_procedure_name(b->found->record[k].procedure);
        if (!names.text || !strstr(names.text, name))
            list_add_item(&names, "%s", name);
    }
    snprintf(evidence->method, sizeof evidence->method,
             "imukit %s calibrate: %s, maximum likelihood, %zu observations, %zu turns, gravity "
             "%.6g m/s^2",
             IMK_VERSION, names.text, b->found->calibration->observation_count,
             b->found->calibration->turn_count, b->found->calibration->gravity);
    list_free(&names);
}

static void name_model(const bench *b, imk_model *model)
{
    if (b->options->name || !model->name[0] || !b->options->into)
        command_model_name(b->options->name, b->found->record[0].path, model->name,
                           sizeof model->name);
}

/* What temperature does besides the polynomials that were solved for. */
static void apply_thermal(const bench *b, imk_model *model)
{
    static const char *const width[2] = {"deg/h", "mg"};
    static const char *const rate[2] = {"deg/h/(K/min)", "mg/(K/min)"};
    imk_triad *triad[2] = {&model->gyro, &model->accel};
    imk_error error;
    for (size_t k = 0; k < b->found->count; k++) {
        if (!b->found->record[k].thermal)
            continue;
        if (imk_thermal_apply(b->found->record[k].thermal, false, model, &error) != IMK_OK)
            (void)command_error(&error, b->found->record[k].path);
        for (int sensor = 0; sensor < 2; sensor++) {
            round_axes(&triad[sensor]->bias.hysteresis, width[sensor]);
            round_axes(&triad[sensor]->bias.temperature_rate, rate[sensor]);
        }
    }
}

void bench_make_model(bench *b)
{
    imk_model *model = &b->found->model;
    imk_evidence *evidence[2] = {&model->gyro_evidence, &model->accel_evidence};
    *model = b->found->result ? b->found->result->model : b->found->calibration->model;
    if (b->found->runs)
        imk_repeatability_to_model(b->found->runs, model);
    apply_thermal(b, model);
    for (size_t p = 0; b->found->result && p < b->found->result->parameter_count; p++)
        round_parameter(model, b->found->result->parameter[p]);
    for (int sensor = 0; sensor < 2; sensor++) {
        if (!estimated(b, sensor))
            continue;
        for (int term = 0; b->found->result && term < IMK_MODEL_TERMS; term++)
            state_interval(b, model, sensor, term);
        if (b->found->runs)
            round_repeatability(model, sensor);
        describe(b, evidence[sensor]);
    }
    name_model(b, model);
}

int bench_write_model(bench *b)
{
    imk_error error;
    const calibrate_options *o = b->options;
    if (o->into)
        model_print_changes(o->into, &b->before, &b->found->model, b->document);
    if (o->output && imk_model_write(o->output, &b->found->model, b->document, &error) != IMK_OK)
        return command_error(&error, NULL);
    return -1;
}
