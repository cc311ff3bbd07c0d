/* SPDX-License-Identifier: Apache-2.0 */
/* Units and titles of the numbers of a model, and rows of a test. */
#include "calibrate_internal.h"

#include "model/model_schema_internal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

char imk_axis_letter(int axis)
{
    return axis < 0 ? '?' : axis < 3 ? "xyz"[axis] : (char)('0' + axis);
}

const char *imk_parameter_file_unit(imk_model_parameter parameter)
{
    const imki_field *field = imki_term_field(parameter.term);
    return field->shape == IMKI_POLYNOMIAL
               ? imki_polynomial_unit(field, parameter.sensor, parameter.element + 1)
               : field->unit[parameter.sensor];
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
    const imki_term *term = &imki_terms[parameter.term];
    const char *element = imki_form_element(term->form, parameter.element);
    if (term->form == IMKI_FORM_CROSS)
        snprintf(text, size, "K%s", element);
    else if (term->form == IMKI_FORM_WARMTH || term->form == IMKI_FORM_WARM_INPUT)
        snprintf(text, size, "%s, power %s", term->title, element);
    else
        snprintf(text, size, "%s%s%s", term->title, element ? ", " : "", element ? element : "");
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
