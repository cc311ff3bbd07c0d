/* SPDX-License-Identifier: Apache-2.0 */
/* One field of the schema in a triad: where its numbers are, whether it says anything, and whether
 * two triads agree in it. */
#include "model_schema_internal.h"

#include <stddef.h>
#include <string.h>

/* ---- its numbers ----------------------------------------------------------------------------- */

int imki_row_length(imki_shape shape)
{
    const bool three = shape == IMKI_OFF_DIAGONAL || shape == IMKI_ROWS ||
                       shape == IMKI_DIRECTION || shape == IMKI_PENDULOUS;
    return shape == IMKI_QUADRATIC ? 6 : three ? 3 : 1;
}

const double *imki_field_values(const imki_field *field, const void *base)
{
    /* Every one of the structs begins with its values. */
    return (const double *)(const void *)((const char *)base + field->offset);
}

const double *imki_field_sigmas(const imki_field *field, const void *base)
{
    const int between =
        field->shape == IMKI_SCALAR ? 1 : IMK_AXES_MAX * imki_row_length(field->shape);
    return imki_field_values(field, base) + between;
}

int imki_field_rows(const imki_field *field, int axis_count)
{
    return field->shape == IMKI_SCALAR ? 1 : axis_count;
}

const void *imki_list_element(const imki_field *field, const imk_triad *triad, int index)
{
    return (const char *)triad + field->offset + (size_t)index * imki_list_of(field).size;
}

int imki_list_count(const imki_field *field, const imk_triad *triad)
{
    int count;
    memcpy(&count, (const char *)triad + field->count_offset, sizeof count);
    return count;
}

const imki_field *imki_field_find(const char *path, int kind, const imki_field **list)
{
    if (list)
        *list = NULL;
    for (size_t i = 0; i < imki_triad_field_count; i++) {
        const imki_field *field = &imki_triad_fields[i];
        const char *name = field->path[kind];
        size_t length = name ? strlen(name) : 0;
        if (!name || strncmp(path, name, length) != 0)
            continue;
        if (path[length] == '\0')
            return field;
        if (field->shape != IMKI_LIST || path[length] != '.')
            continue;
        imki_list terms = imki_list_of(field);
        for (size_t j = 0; j < terms.field_count; j++) {
            if (strcmp(path + length + 1, terms.field[j].path[kind]) != 0)
                continue;
            if (list)
                *list = field;
            return &terms.field[j];
        }
    }
    return NULL;
}

/* ---- comparison ------------------------------------------------------------------------------ */

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

bool imki_numbers_equal(const imki_field *field, const void *a, const void *b, int axis_count,
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
            if (!imki_numbers_equal(&list.field[j], imki_list_element(field, a, i),
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
        return imki_numbers_equal(field, a, b, a->axis_count, false);
    case IMKI_LIST:
        return equal_lists(field, a, b, with_sigmas);
    case IMKI_POLYNOMIAL:
        return equal_polynomials(polynomial_of(field, a), polynomial_of(field, b),
                                 (size_t)a->axis_count, with_sigmas);
    default:
        return imki_numbers_equal(field, a, b, a->axis_count, with_sigmas);
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
