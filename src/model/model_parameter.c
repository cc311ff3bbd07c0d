/* SPDX-License-Identifier: Apache-2.0 */
/* One number of a model by its place. Names and units follow the table of fields, so that a number
 * is called here as it is called in the model file:
 *
 *     sensor . path of the field . axis [ . element ] */
#include "imukit/model_parameter.h"

#include "model_internal.h"
#include "model_schema_internal.h"

#include <math.h>
#include <string.h>

#define AT(member) offsetof(imk_triad, member)

enum { ELEMENTS_MAX = 6 };

typedef struct term_place {
    const char *path[2]; /* below the sensor; NULL: the sensor does not have it */
    size_t offset;       /* of the field in imk_triad */
    imki_shape shape;
    int elements;
    const char *element[ELEMENTS_MAX]; /* their names; none where there is one number per axis */
} term_place;

#define BOTH(name)                                                                                 \
    {                                                                                              \
        name, name                                                                                 \
    }
#define COMPONENTS                                                                                 \
    3,                                                                                             \
    {                                                                                              \
        "x", "y", "z"                                                                              \
    }
#define POWERS                                                                                     \
    IMK_TEMPERATURE_ORDER_MAX,                                                                     \
    {                                                                                              \
        "1", "2", "3", "4", "5"                                                                    \
    }
#define ONE                                                                                        \
    1,                                                                                             \
    {                                                                                              \
        NULL                                                                                       \
    }

static const term_place term_places[IMK_MODEL_TERMS] = {
    [IMK_MODEL_BIAS] = {BOTH("bias.fixed"), AT(bias.fixed), IMKI_AXES, ONE},
    [IMK_MODEL_SCALE_FACTOR] = {BOTH("scale_factor.fixed"), AT(scale_factor.fixed), IMKI_AXES, ONE},
    [IMK_MODEL_MISALIGNMENT] = {BOTH("misalignment"), AT(misalignment), IMKI_OFF_DIAGONAL,
                                COMPONENTS},
    [IMK_MODEL_CROSS_AXIS] = {BOTH("cross_axis"), AT(cross_axis), IMKI_OFF_DIAGONAL, COMPONENTS},
    [IMK_MODEL_K2] = {BOTH("nonlinearity.k2"), AT(nonlinearity.k2), IMKI_AXES, ONE},
    [IMK_MODEL_KOQ] = {BOTH("nonlinearity.koq"), AT(nonlinearity.koq), IMKI_AXES, ONE},
    [IMK_MODEL_K3] = {BOTH("nonlinearity.k3"), AT(nonlinearity.k3), IMKI_AXES, ONE},
    [IMK_MODEL_ASYMMETRY] = {BOTH("nonlinearity.asymmetry"), AT(nonlinearity.asymmetry), IMKI_AXES,
                             ONE},
    [IMK_MODEL_CROSS_PRODUCTS] = {{NULL, "cross_products"},
                                  AT(nonlinearity.cross_products),
                                  IMKI_ROWS,
                                  3,
                                  {"ip", "io", "po"}},
    [IMK_MODEL_G_SENSITIVITY] = {{"g_sensitivity", NULL}, AT(g_sensitivity), IMKI_ROWS, COMPONENTS},
    [IMK_MODEL_G2_SENSITIVITY] = {{"g2_sensitivity", NULL},
                                  AT(g2_sensitivity),
                                  IMKI_QUADRATIC,
                                  6,
                                  {"xx", "yy", "zz", "xy", "yz", "zx"}},
    [IMK_MODEL_LEVER_ARM] = {{NULL, "lever_arm"}, AT(lever_arm), IMKI_ROWS, COMPONENTS},
    [IMK_MODEL_BIAS_TEMPERATURE] = {BOTH("bias.temperature"), AT(bias.temperature.coefficient),
                                    IMKI_POLYNOMIAL, POWERS},
    [IMK_MODEL_SCALE_TEMPERATURE] = {BOTH("scale_factor.temperature"),
                                     AT(scale_factor.temperature.coefficient), IMKI_POLYNOMIAL,
                                     POWERS},
    [IMK_MODEL_TEMPERATURE_RATE] = {BOTH("bias.temperature_rate"), AT(bias.temperature_rate),
                                    IMKI_AXES, ONE},
};

static const char *const sensor_names[2] = {"gyro", "accel"};
static const char *const axis_letters[3] = {"x", "y", "z"};

/* NULL when the sensor has no such term. */
static const term_place *place_of(int sensor, int term)
{
    const bool known = sensor >= 0 && sensor < 2 && term >= 0 && term < IMK_MODEL_TERMS;
    return known && term_places[term].path[sensor] ? &term_places[term] : NULL;
}

/* NULL when no model can have such a number. */
static const term_place *place_of_parameter(imk_model_parameter parameter)
{
    const term_place *place = place_of(parameter.sensor, parameter.term);
    return place && parameter.axis < IMK_AXES_MAX && parameter.element < place->elements ? place
                                                                                         : NULL;
}

int imk_model_term_elements(int sensor, int term)
{
    const term_place *place = place_of(sensor, term);
    return place ? place->elements : 0;
}

bool imki_model_parameter_exists(const imk_model *model, imk_model_parameter parameter)
{
    const term_place *place = place_of_parameter(parameter);
    if (!place)
        return false;
    const imk_triad *triad = imk_model_triad(model, parameter.sensor);
    const bool diagonal = place->shape == IMKI_OFF_DIAGONAL && triad->axis_count == 3 &&
                          parameter.axis == parameter.element;
    return triad->present && parameter.axis < triad->axis_count && !diagonal;
}

static const double *value_at(const imk_model *model, imk_model_parameter parameter)
{
    if (!imki_model_parameter_exists(model, parameter))
        return NULL;
    const term_place *place = place_of_parameter(parameter);
    const imk_triad *triad = imk_model_triad(model, parameter.sensor);
    const double *first = (const double *)(const void *)((const char *)triad + place->offset);
    /* Each power of a polynomial is an imk_axes; elsewhere an axis has its elements in a row. */
    const size_t between_elements =
        place->shape == IMKI_POLYNOMIAL ? sizeof(imk_axes) / sizeof(double) : 1;
    return first + parameter.axis * (size_t)imki_row_length(place->shape) +
           parameter.element * between_elements;
}

double *imk_model_parameter_at(imk_model *model, imk_model_parameter parameter, double **sigma)
{
    const double *place = value_at(model, parameter);
    if (!place)
        return NULL;
    double *value = (double *)(void *)((char *)model + ((const char *)place - (const char *)model));
    /* The sigmas of a field stand behind its values. */
    if (sigma)
        *sigma = value + IMK_AXES_MAX * imki_row_length(place_of_parameter(parameter)->shape);
    return value;
}

double imk_model_parameter_get(const imk_model *model, imk_model_parameter parameter)
{
    const double *value = value_at(model, parameter);
    return value ? *value : (double)NAN;
}

/* ---- names ----------------------------------------------------------------------------------- */

static void append(char name[IMK_MODEL_PARAMETER_NAME], const char *text)
{
    size_t length = strlen(name);
    if (length > 0 && length + 1 < IMK_MODEL_PARAMETER_NAME)
        name[length++] = '.';
    for (; *text && length + 1 < IMK_MODEL_PARAMETER_NAME; text++)
        name[length++] = *text;
    name[length] = '\0';
}

imk_status imk_model_parameter_name(imk_model_parameter parameter,
                                    char name[IMK_MODEL_PARAMETER_NAME])
{
    const term_place *place = place_of_parameter(parameter);
    if (!place)
        return IMK_ERROR_ARGUMENT;
    const char number[2] = {(char)('0' + parameter.axis), '\0'};
    name[0] = '\0';
    append(name, sensor_names[parameter.sensor]);
    append(name, place->path[parameter.sensor]);
    append(name, parameter.axis < 3 ? axis_letters[parameter.axis] : number);
    if (place->elements > 1)
        append(name, place->element[parameter.element]);
    return IMK_OK;
}

/* What stands behind `prefix` and a dot; NULL when the text does not begin so. */
static const char *behind(const char *text, const char *prefix)
{
    const size_t length = strlen(prefix);
    return strncmp(text, prefix, length) == 0 && text[length] == '.' ? text + length + 1 : NULL;
}

/* Axis and element of "x" or "x.yz"; false when there is no such number. */
static bool parse_place(const term_place *place, const char *text, imk_model_parameter *parameter)
{
    int axis = 0, element = 0;
    if (text[0] >= '0' && text[0] < '0' + IMK_AXES_MAX)
        axis = text[0] - '0';
    else if (text[0] >= 'x' && text[0] <= 'z')
        axis = text[0] - 'x';
    else
        return false;
    if (place->elements == 1) {
        if (text[1] != '\0')
            return false;
    } else {
        if (text[1] != '.')
            return false;
        while (element < place->elements && strcmp(text + 2, place->element[element]) != 0)
            element++;
        if (element == place->elements)
            return false;
    }
    parameter->axis = (uint8_t)axis;
    parameter->element = (uint8_t)element;
    return true;
}

imk_status imk_model_parameter_parse(const char *name, imk_model_parameter *parameter)
{
    for (int sensor = 0; name && sensor < 2; sensor++) {
        const char *path = behind(name, sensor_names[sensor]);
        for (int term = 0; path && term < IMK_MODEL_TERMS; term++) {
            const term_place *place = place_of(sensor, term);
            const char *rest = place ? behind(path, place->path[sensor]) : NULL;
            imk_model_parameter found = {.sensor = (uint8_t)sensor, .term = (uint8_t)term};
            if (!rest || !parse_place(place, rest, &found))
                continue;
            *parameter = found;
            return IMK_OK;
        }
    }
    return IMK_ERROR_NAME_UNKNOWN;
}

const char *imk_model_parameter_unit(imk_model_parameter parameter)
{
    const term_place *place = place_of_parameter(parameter);
    if (!place)
        return "";
    const int kind = parameter.sensor;
    const imki_field *field = imki_field_find(place->path[kind], kind, NULL);
    return place->shape == IMKI_POLYNOMIAL ? imki_polynomial_si(field, kind, parameter.element + 1)
                                           : field->si[kind];
}
