/* SPDX-License-Identifier: Apache-2.0 */
/* Comparison of models, field by field of the schema. Numbers are compared as numbers (-0 is 0);
 * what lies beyond the number of axes or of list elements does not count. */
#include "model_schema_internal.h"

#include <string.h>

static bool equal_numbers(const double *a, const double *b, size_t count)
{
    for (size_t i = 0; i < count; i++)
        if (!(a[i] == b[i]))
            return false;
    return true;
}

static bool all_zero(const double *a, size_t count)
{
    for (size_t i = 0; i < count; i++)
        if (a[i] != 0)
            return false;
    return true;
}

static bool equal_at(const imki_field *field, const void *a, const void *b, int axis_count,
                     bool with_sigmas)
{
    size_t count = (size_t)imki_field_rows(field, axis_count) * imki_row_length(field->shape);
    return equal_numbers(imki_field_values(field, a), imki_field_values(field, b), count) &&
           (!with_sigmas ||
            equal_numbers(imki_field_sigmas(field, a), imki_field_sigmas(field, b), count));
}

static const imk_temperature_polynomial *polynomial_of(const imki_field *field, const void *base)
{
    return (const imk_temperature_polynomial *)(const void *)((const char *)base + field->offset);
}

static bool equal_polynomials(const imk_temperature_polynomial *a,
                              const imk_temperature_polynomial *b, size_t axis_count,
                              bool with_sigmas)
{
    if (a->order != b->order)
        return false;
    for (int i = 0; i < a->order; i++) {
        if (!equal_numbers(a->coefficient[i].value, b->coefficient[i].value, axis_count))
            return false;
        if (with_sigmas &&
            !equal_numbers(a->coefficient[i].sigma, b->coefficient[i].sigma, axis_count))
            return false;
    }
    return a->order == 0 ||
           (a->reference == b->reference && a->minimum == b->minimum && a->maximum == b->maximum);
}

static bool equal_lists(const imki_field *field, const imk_triad *a, const imk_triad *b,
                        bool with_sigmas)
{
    imki_list list = imki_list_of(field);
    int count = imki_list_count(field, a);
    if (count != imki_list_count(field, b))
        return false;
    for (int i = 0; i < count; i++)
        for (size_t j = 0; j < list.field_count; j++)
            if (!equal_at(&list.field[j], imki_list_element(field, a, i),
                          imki_list_element(field, b, i), a->axis_count, with_sigmas))
                return false;
    return true;
}

static bool equal_directions(const imk_triad *a, const imk_triad *b)
{
    return a->axis_count == b->axis_count &&
           equal_numbers(a->direction[0], b->direction[0], (size_t)a->axis_count * 3);
}

bool imki_field_equal(const imki_field *field, const imk_triad *a, const imk_triad *b,
                      bool with_sigmas)
{
    switch (field->shape) {
    case IMKI_DENSITY:
        return a->noise.density == b->noise.density;
    case IMKI_DIRECTION:
        return equal_directions(a, b);
    case IMKI_PENDULOUS:
        return equal_at(field, a, b, a->axis_count, false);
    case IMKI_LIST:
        return equal_lists(field, a, b, with_sigmas);
    case IMKI_POLYNOMIAL:
        return equal_polynomials(polynomial_of(field, a), polynomial_of(field, b),
                                 (size_t)a->axis_count, with_sigmas);
    default:
        return equal_at(field, a, b, a->axis_count, with_sigmas);
    }
}

static bool is_standard_triad(const imk_triad *triad)
{
    static const double standard[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    return triad->axis_count == 3 && equal_numbers(triad->direction[0], standard[0], 9);
}

bool imki_field_absent(const imki_field *field, const imk_triad *triad)
{
    switch (field->shape) {
    case IMKI_DENSITY:
        return triad->noise.density == IMK_DENSITY_UNSTATED;
    case IMKI_DIRECTION:
        return is_standard_triad(triad);
    case IMKI_PENDULOUS:
        return all_zero(triad->nonlinearity.pendulous_axis[0], (size_t)triad->axis_count * 3);
    case IMKI_LIST:
        return imki_list_count(field, triad) == 0;
    case IMKI_POLYNOMIAL:
        return polynomial_of(field, triad)->order == 0;
    default: {
        size_t count =
            (size_t)imki_field_rows(field, triad->axis_count) * imki_row_length(field->shape);
        return all_zero(imki_field_values(field, triad), count) &&
               all_zero(imki_field_sigmas(field, triad), count);
    }
    }
}

static bool equal_triads(const imk_triad *a, const imk_triad *b)
{
    if (a->present != b->present)
        return false;
    if (!a->present)
        return true;
    /* The first field is the direction, with the number of axes the others are compared on. How
     * the file states its densities changes no number. */
    for (size_t i = 0; i < imki_triad_field_count; i++)
        if (imki_triad_fields[i].shape != IMKI_DENSITY &&
            !imki_field_equal(&imki_triad_fields[i], a, b, false))
            return false;
    return true;
}

bool imk_model_equal(const imk_model *a, const imk_model *b)
{
    for (size_t i = 0; i < imki_timing_field_count; i++)
        if (!equal_at(&imki_timing_fields[i], &a->timing, &b->timing, 1, false))
            return false;
    return equal_triads(&a->gyro, &b->gyro) && equal_triads(&a->accel, &b->accel);
}
