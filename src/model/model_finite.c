/* SPDX-License-Identifier: Apache-2.0 */
/* Whether every number that a triad states is finite. */
#include "model_schema_internal.h"

static bool all_finite(const double *a, size_t count)
{
    for (size_t i = 0; i < count; i++)
        if (!isfinite(a[i]))
            return false;
    return true;
}

static bool numbers_finite(const imki_field *field, const void *base, int axis_count)
{
    const size_t count =
        (size_t)imki_field_rows(field, axis_count) * (size_t)imki_row_length(field->shape);
    /* a direction of the pendulum has no sigmas */
    return all_finite(imki_field_values(field, base), count) &&
           (field->shape == IMKI_PENDULOUS || all_finite(imki_field_sigmas(field, base), count));
}

static bool polynomial_finite(const imk_temperature_polynomial *polynomial, size_t axis_count)
{
    for (int i = 0; i < polynomial->order; i++)
        if (!all_finite(polynomial->coefficient[i].value, axis_count) ||
            !all_finite(polynomial->coefficient[i].sigma, axis_count))
            return false;
    return polynomial->order == 0 ||
           (isfinite(polynomial->reference) && isfinite(polynomial->minimum) &&
            isfinite(polynomial->maximum));
}

static bool list_finite(const imki_field *field, const imk_triad *triad)
{
    const imki_list list = imki_list_of(field);
    for (int i = 0; i < imki_list_count(field, triad); i++)
        for (size_t j = 0; j < list.field_count; j++)
            if (!numbers_finite(&list.field[j], imki_list_element(field, triad, i),
                                triad->axis_count))
                return false;
    return true;
}

static bool field_finite(const imki_field *field, const imk_triad *triad)
{
    const char *place = (const char *)triad + field->offset;
    switch (field->shape) {
    case IMKI_DENSITY:
        return true;
    case IMKI_DIRECTION:
        return all_finite(triad->direction[0], (size_t)triad->axis_count * 3);
    case IMKI_LIST:
        return list_finite(field, triad);
    case IMKI_POLYNOMIAL:
        return polynomial_finite((const imk_temperature_polynomial *)(const void *)place,
                                 (size_t)triad->axis_count);
    default:
        return numbers_finite(field, triad, triad->axis_count);
    }
}

const imki_field *imki_triad_not_finite(const imk_triad *triad)
{
    for (size_t i = 0; i < imki_triad_field_count; i++)
        if (!field_finite(&imki_triad_fields[i], triad))
            return &imki_triad_fields[i];
    return NULL;
}
