/* SPDX-License-Identifier: Apache-2.0 */
/* Units and titles of the numbers of a model, and rows of a test. */
#include "calibrate_internal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

char imk_axis_letter(int axis)
{
    return axis < 0 ? '?' : axis < 3 ? "xyz"[axis] : (char)('0' + axis);
}

typedef struct term_words {
    const char *unit[2]; /* of the model file: gyro, accel; powers of kelvin are added */
    const char *title;
} term_words;

static const term_words words[IMK_MODEL_TERMS] = {
    [IMK_MODEL_BIAS] = {{"deg/h", "mg"}, "bias"},
    [IMK_MODEL_SCALE_FACTOR] = {{"ppm", "ppm"}, "scale factor error"},
    [IMK_MODEL_MISALIGNMENT] = {{"mrad", "mrad"}, "misalignment"},
    [IMK_MODEL_CROSS_AXIS] = {{"%", "%"}, "cross-axis response"},
    [IMK_MODEL_K2] = {{"ppm/(deg/s)", "ppm/g"}, "K2"},
    [IMK_MODEL_KOQ] = {{"ppm/(deg/s)", "ppm/g"}, "Koq"},
    [IMK_MODEL_K3] = {{"ppm/(deg/s)^2", "ppm/g^2"}, "K3"},
    [IMK_MODEL_ASYMMETRY] = {{"ppm", "ppm"}, "asymmetry"},
    [IMK_MODEL_CROSS_PRODUCTS] = {{"1", "ppm/g"}, "cross product"},
    [IMK_MODEL_G_SENSITIVITY] = {{"deg/h/g", "1"}, "g-sensitivity"},
    [IMK_MODEL_G2_SENSITIVITY] = {{"deg/h/g^2", "1"}, "g^2-sensitivity"},
    [IMK_MODEL_LEVER_ARM] = {{"1", "mm"}, "place"},
    [IMK_MODEL_BIAS_TEMPERATURE] = {{"deg/h/K", "mg/K"}, "bias over temperature"},
    [IMK_MODEL_SCALE_TEMPERATURE] = {{"ppm/K", "ppm/K"}, "scale factor over temperature"},
    [IMK_MODEL_TEMPERATURE_RATE] = {{"deg/h/(K/min)", "mg/(K/min)"}, "bias by temperature rate"},
};

static const char *power_unit(const char *unit, int power)
{
    static const char *const units[3][IMK_TEMPERATURE_ORDER_MAX] = {
        {"deg/h/K", "deg/h/K^2", "deg/h/K^3", "deg/h/K^4", "deg/h/K^5"},
        {"mg/K", "mg/K^2", "mg/K^3", "mg/K^4", "mg/K^5"},
        {"ppm/K", "ppm/K^2", "ppm/K^3", "ppm/K^4", "ppm/K^5"}};
    for (int k = 0; k < 3; k++)
        if (strcmp(units[k][0], unit) == 0)
            return units[k][power - 1];
    return unit;
}

static bool is_power(imk_model_parameter parameter)
{
    return parameter.term == IMK_MODEL_BIAS_TEMPERATURE ||
           parameter.term == IMK_MODEL_SCALE_TEMPERATURE;
}

const char *imk_parameter_file_unit(imk_model_parameter parameter)
{
    const char *unit = words[parameter.term].unit[parameter.sensor];
    return is_power(parameter) ? power_unit(unit, parameter.element + 1) : unit;
}

imk_unit imk_parameter_unit(imk_model_parameter parameter, double magnitude)
{
    const imk_unit unit = imk_unit_of(imk_parameter_file_unit(parameter));
    if (parameter.term == IMK_MODEL_BIAS)
        return imk_unit_readable(unit.dimension, magnitude);
    if (parameter.term == IMK_MODEL_SCALE_FACTOR && magnitude >= 0.01)
        return imk_unit_of("%");
    return unit;
}

void imk_parameter_title(imk_model_parameter parameter, char *text, size_t size)
{
    static const char *const components[3] = {"x", "y", "z"};
    static const char *const products[3] = {"Kip", "Kio", "Kpo"};
    static const char *const squares[6] = {"xx", "yy", "zz", "xy", "yz", "zx"};
    const char *title = words[parameter.term].title;
    const int element = parameter.element;
    switch (parameter.term) {
    case IMK_MODEL_CROSS_PRODUCTS:
        snprintf(text, size, "%s", products[element]);
        break;
    case IMK_MODEL_G2_SENSITIVITY:
        snprintf(text, size, "%s, %s", title, squares[element]);
        break;
    case IMK_MODEL_BIAS_TEMPERATURE:
    case IMK_MODEL_SCALE_TEMPERATURE:
        snprintf(text, size, "%s, power %d", title, element + 1);
        break;
    case IMK_MODEL_MISALIGNMENT:
    case IMK_MODEL_CROSS_AXIS:
    case IMK_MODEL_G_SENSITIVITY:
    case IMK_MODEL_LEVER_ARM:
        snprintf(text, size, "%s, %s", title, components[element]);
        break;
    default:
        snprintf(text, size, "%s", title);
        break;
    }
}

int imk_calibrate_find(const imk_calibrate_log *b, imk_model_parameter parameter)
{
    for (size_t p = 0; b->result && p < b->result->parameter_count; p++)
        if (memcmp(&b->result->parameter[p], &parameter, sizeof parameter) == 0)
            return (int)p;
    return -1;
}

double imk_test_record_time(const imk_test_record *record, size_t row)
{
    return record->time ? record->time[row] : (double)row * record->dt;
}

static bool is_missing(const imk_test_record *record, size_t row)
{
    bool missing = record->temperature && !isfinite(record->temperature[row]);
    for (int sensor = 0; sensor < 2; sensor++)
        for (int axis = 0; axis < record->axis_count[sensor]; axis++)
            missing = missing || !isfinite(record->reading[sensor][axis][row]);
    return missing;
}

size_t imk_test_record_missing(const imk_test_record *record, size_t *first)
{
    size_t rows = 0;
    for (size_t row = 0; row < record->count; row++)
        if (is_missing(record, row) && rows++ == 0)
            *first = row;
    return rows;
}
