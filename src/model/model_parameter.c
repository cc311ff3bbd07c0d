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

static const char *const axis_letters[3] = {"x", "y", "z"};

static bool is_term(int sensor, int term)
{
    return sensor >= 0 && sensor < IMK_KINDS && term >= 0 && term < IMK_MODEL_TERMS &&
           imki_term_field(term)->path[sensor];
}

int imk_model_term_elements(int sensor, int term)
{
    return is_term(sensor, term) ? imki_form_elements(imki_terms[term].form) : 0;
}

/* Can a model have such a number? */
static bool is_parameter(imk_model_parameter parameter)
{
    return parameter.axis < IMK_AXES_MAX &&
           parameter.element < imk_model_term_elements(parameter.sensor, parameter.term);
}

bool imki_model_parameter_fits(const imk_model *model, imk_model_parameter parameter)
{
    if (!is_parameter(parameter))
        return false;
    const imk_triad *triad = imk_model_triad(model, parameter.sensor);
    const bool diagonal = imki_terms[parameter.term].form == IMKI_FORM_SEEN &&
                          triad->axis_count == 3 && parameter.axis == parameter.element;
    return !triad->present || (parameter.axis < triad->axis_count && !diagonal);
}

/* Each power of a polynomial is an imk_axes; elsewhere an axis has its elements in a row. */
static bool is_polynomial(imk_model_parameter parameter)
{
    const imki_form form = imki_terms[parameter.term].form;
    return form == IMKI_FORM_WARMTH || form == IMKI_FORM_WARM_INPUT;
}

static const double *value_at(const imk_model *model, imk_model_parameter parameter)
{
    if (!imki_model_parameter_fits(model, parameter))
        return NULL;
    const imk_triad *triad = imk_model_triad(model, parameter.sensor);
    if (!triad->present)
        return NULL;
    const double *first = imki_term_values(parameter.term, triad);
    if (is_polynomial(parameter)) {
        const imk_temperature_polynomial *polynomial = (const void *)first;
        return &polynomial->coefficient[parameter.element].value[parameter.axis];
    }
    return first + parameter.axis * imki_form_elements(imki_terms[parameter.term].form) +
           parameter.element;
}

double *imk_model_parameter_at(imk_model *model, imk_model_parameter parameter, double **sigma)
{
    const double *place = value_at(model, parameter);
    if (!place)
        return NULL;
    double *value = (double *)(void *)((char *)model + ((const char *)place - (const char *)model));
    /* The sigmas of a field stand behind its values. */
    if (sigma)
        *sigma = value +
                 (ptrdiff_t)IMK_AXES_MAX * imki_row_length(imki_term_field(parameter.term)->shape);
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
    if (!is_parameter(parameter))
        return IMK_ERROR_ARGUMENT;
    const char *element = imki_form_element(imki_terms[parameter.term].form, parameter.element);
    const char number[2] = {(char)('0' + parameter.axis), '\0'};
    name[0] = '\0';
    append(name, imki_kind_names[parameter.sensor]);
    append(name, imki_term_field(parameter.term)->path[parameter.sensor]);
    append(name, parameter.axis < 3 ? axis_letters[parameter.axis] : number);
    if (element)
        append(name, element);
    return IMK_OK;
}

/* What stands behind `prefix` and a dot; NULL when the text does not begin so. */
static const char *behind(const char *text, const char *prefix)
{
    const size_t length = strlen(prefix);
    return strncmp(text, prefix, length) == 0 && text[length] == '.' ? text + length + 1 : NULL;
}

/* Axis and element of "x" or "x.yz"; false when there is no such number. */
static bool parse_place(imki_form form, const char *text, imk_model_parameter *parameter)
{
    const int elements = imki_form_elements(form);
    int axis = 0, element = 0;
    if (text[0] >= '0' && text[0] < '0' + IMK_AXES_MAX)
        axis = text[0] - '0';
    else if (text[0] >= 'x' && text[0] <= 'z')
        axis = text[0] - 'x';
    else
        return false;
    if (elements == 1 ? text[1] != '\0' : text[1] != '.')
        return false;
    while (elements > 1 && strcmp(text + 2, imki_form_element(form, element)) != 0)
        if (++element == elements)
            return false;
    parameter->axis = (uint8_t)axis;
    parameter->element = (uint8_t)element;
    return true;
}

imk_status imk_model_parameter_parse(const char *name, imk_model_parameter *parameter)
{
    for (int sensor = 0; name && sensor < IMK_KINDS; sensor++) {
        const char *path = behind(name, imki_kind_names[sensor]);
        for (int term = 0; path && term < IMK_MODEL_TERMS; term++) {
            const char *own = imki_term_field(term)->path[sensor];
            const char *rest = own ? behind(path, own) : NULL;
            imk_model_parameter found = {.sensor = (uint8_t)sensor, .term = (uint8_t)term};
            if (!rest || !parse_place(imki_terms[term].form, rest, &found))
                continue;
            *parameter = found;
            return IMK_OK;
        }
    }
    return IMK_ERROR_NAME_UNKNOWN;
}

const char *imk_model_parameter_unit(imk_model_parameter parameter)
{
    if (!is_parameter(parameter))
        return "";
    const int kind = parameter.sensor;
    const imki_field *field = imki_term_field(parameter.term);
    return is_polynomial(parameter) ? imki_polynomial_si(field, kind, parameter.element + 1)
                                    : field->si[kind];
}
