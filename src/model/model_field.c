/* SPDX-License-Identifier: Apache-2.0 */
/* One field of the schema in a triad: where its numbers are, whether it says anything, whether it
 * is valid, and whether two triads agree in it. */
#include "base/algebra/vector_internal.h"
#include "model_schema_internal.h"

#include <float.h>
#include <stddef.h>
#include <string.h>

/* Directions farther from unit length than this were not meant as unit vectors; the reader
 * normalises to rounding. */
static const double direction_tolerance = 1e-9;

/* ---- its numbers ----------------------------------------------------------------------------- */

int imki_row_length(imki_shape shape)
{
    const bool three = shape == IMKI_OFF_DIAGONAL || shape == IMKI_ROWS ||
                       shape == IMKI_DIRECTION || shape == IMKI_PENDULOUS;
    return shape == IMKI_QUADRATIC ? 6 : three ? 3 : 1;
}

int imki_turned_element(const imki_field *field, int k, int turn)
{
    const bool turns = imki_row_length(field->shape) > 1 &&
                       field->offset != offsetof(imk_triad, nonlinearity.cross_products);
    return turns ? k / 3 * 3 + (k + turn) % 3 : k;
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

static const imk_temperature_polynomial *polynomial_of(const imki_field *field, const void *base)
{
    return (const imk_temperature_polynomial *)(const void *)((const char *)base + field->offset);
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

/* Another way to state a field has its bit. */
uint64_t imki_field_bit(const imki_field *field)
{
    const bool plain = field->shape == IMKI_SCALAR || field->shape == IMKI_AXES ||
                       field->shape == IMKI_OFF_DIAGONAL || field->shape == IMKI_ROWS ||
                       field->shape == IMKI_QUADRATIC;
    size_t index = 0;
    while (imki_triad_fields[index].offset != field->offset)
        index++;
    return plain ? UINT64_C(1) << index : 0;
}

bool imki_field_stated_zero(const imki_field *field, const imk_triad *triad)
{
    const uint64_t bit = imki_field_bit(field);
    return (triad->stated_zero & bit) != 0 && imki_field_absent(field, triad);
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

/* ---- validity -------------------------------------------------------------------------------- */

/* Of the field as a whole, or of an axis or row of it. */
static imk_status refuse(imki_fault *fault, imk_status status, int index, double value,
                         double limit, const char *expected)
{
    *fault = (imki_fault){
        .element = -1, .index = index, .value = value, .limit = limit, .expected = expected};
    return status;
}

static imk_status check_number(const imki_field *field, double x, int index, imki_fault *fault)
{
    if (!isfinite(x))
        return refuse(fault, IMK_ERROR_NOT_FINITE, index, x, 0, "a finite number");
    if ((field->flags & IMKI_TYPICAL) && x == 0)
        return IMK_OK;
    bool open = (field->flags & IMKI_OPEN) != 0;
    if (!(open ? x > field->minimum : x >= field->minimum)) {
        const char *due = field->minimum != 0 ? (open ? "a larger number than the limit"
                                                      : "a number not below the limit")
                          : open              ? "a positive number"
                                              : "a number that is not negative";
        return refuse(fault, IMK_ERROR_RANGE, index, x, field->minimum, due);
    }
    if (!(open && field->maximum < DBL_MAX ? x < field->maximum : x <= field->maximum))
        return refuse(fault, IMK_ERROR_RANGE, index, x, field->maximum,
                      "a smaller number than the limit");
    return IMK_OK;
}

static imk_status check_sigma(double sigma, int index, imki_fault *fault)
{
    if (!isfinite(sigma))
        return refuse(fault, IMK_ERROR_NOT_FINITE, index, sigma, 0, "a finite 1-sigma");
    if (!(sigma >= 0))
        return refuse(fault, IMK_ERROR_RANGE, index, sigma, 0, "a 1-sigma that is not negative");
    return IMK_OK;
}

static imk_status check_numbers(const imki_field *field, const void *base, int axis_count,
                                imki_fault *fault)
{
    const double *values = imki_field_values(field, base);
    const double *sigmas = imki_field_sigmas(field, base);
    int length = imki_row_length(field->shape), rows = imki_field_rows(field, axis_count);
    imk_status status = IMK_OK;
    for (int i = 0; i < rows * length && status == IMK_OK; i++) {
        int index = field->shape == IMKI_SCALAR ? -1 : i / length;
        status = check_number(field, values[i], index, fault);
        if (status == IMK_OK)
            status = check_sigma(sigmas[i], index, fault);
        bool diagonal = field->shape == IMKI_OFF_DIAGONAL && axis_count == 3 && i % 4 == 0;
        if (status == IMK_OK && diagonal && (values[i] != 0 || sigmas[i] != 0))
            status = refuse(fault, IMK_ERROR_RANGE, index, values[i], 0,
                            "put 0 on the diagonal: an error along the axis is a scale_factor");
    }
    return status;
}

static imk_status check_polynomial(const imk_temperature_polynomial *polynomial, int axis_count,
                                   imki_fault *fault)
{
    static const imki_field any = {.minimum = -DBL_MAX, .maximum = DBL_MAX};
    if (!(polynomial->order >= 0 && polynomial->order <= IMK_TEMPERATURE_ORDER_MAX))
        return refuse(fault, IMK_ERROR_RANGE, -1, polynomial->order, IMK_TEMPERATURE_ORDER_MAX,
                      "0 to 5 coefficients");
    if (polynomial->order == 0)
        return IMK_OK;
    const double temperatures[3] = {polynomial->reference, polynomial->minimum,
                                    polynomial->maximum};
    for (int i = 0; i < 3; i++) {
        if (!isfinite(temperatures[i]))
            return refuse(fault, IMK_ERROR_NOT_FINITE, -1, temperatures[i], 0,
                          "a finite temperature");
        if (!(temperatures[i] >= 0))
            return refuse(fault, IMK_ERROR_RANGE, -1, temperatures[i], 0,
                          "a temperature above absolute zero");
    }
    if (!(polynomial->minimum < polynomial->maximum))
        return refuse(fault, IMK_ERROR_RANGE, -1, polynomial->minimum, polynomial->maximum,
                      "a valid_range from a lower to a higher temperature");
    imk_status status = IMK_OK;
    for (int i = 0; i < polynomial->order * axis_count && status == IMK_OK; i++) {
        const imk_axes *axes = &polynomial->coefficient[i / axis_count];
        int axis = i % axis_count;
        status = check_number(&any, axes->value[axis], axis, fault);
        if (status == IMK_OK)
            status = check_sigma(axes->sigma[axis], axis, fault);
    }
    return status;
}

static imk_status check_element(const imki_list *list, const void *element, int kind,
                                int axis_count, imki_fault *fault)
{
    imk_status status = IMK_OK;
    for (size_t j = 0; j < list->field_count && status == IMK_OK; j++) {
        status = check_numbers(&list->field[j], element, axis_count, fault);
        fault->member = list->field[j].path[kind];
    }
    /* Time, frequency and q may be 0 only where the first field, the size, is 0. */
    const double *sizes = imki_field_values(&list->field[0], element);
    for (size_t j = 1; j < list->field_count && status == IMK_OK; j++) {
        const double *values = imki_field_values(&list->field[j], element);
        for (int axis = 0; axis < axis_count && status == IMK_OK; axis++)
            if (sizes[axis] != 0 && values[axis] == 0)
                status = refuse(fault, IMK_ERROR_RANGE, axis, 0, list->field[j].minimum,
                                "a positive number");
        fault->member = list->field[j].path[kind];
    }
    return status;
}

static imk_status check_list(const imki_field *field, const imk_triad *triad, int kind,
                             imki_fault *fault)
{
    imki_list list = imki_list_of(field);
    int count = imki_list_count(field, triad);
    if (!(count >= 0 && count <= IMK_TERMS_MAX))
        return refuse(fault, IMK_ERROR_RANGE, -1, count, IMK_TERMS_MAX, "0 to 8 terms");
    imk_status status = IMK_OK;
    for (int i = 0; i < count && status == IMK_OK; i++) {
        const void *element = imki_list_element(field, triad, i);
        status = check_element(&list, element, kind, triad->axis_count, fault);
        fault->element = i;
    }
    return status;
}

/* Of unit length; a pendulous axis is zeros, or at right angles to the sensing direction too. */
static imk_status check_directions(const imk_triad *triad, const double (*direction)[3],
                                   bool pendulous, imki_fault *fault)
{
    for (int i = 0; i < triad->axis_count; i++) {
        const double *e = direction[i];
        for (int j = 0; j < 3; j++)
            if (!isfinite(e[j]))
                return refuse(fault, IMK_ERROR_NOT_FINITE, i, e[j], 0, "a finite number");
        double square = imki_dot3(e, e), along = imki_dot3(e, triad->direction[i]);
        if (pendulous && square == 0)
            continue;
        if (!(square >= 1 - 2 * direction_tolerance && square <= 1 + 2 * direction_tolerance))
            return refuse(
                fault, IMK_ERROR_RANGE, i, square, 1,
                pendulous
                    ? "a direction of unit length, or zeros (the value shown is the square of the "
                      "length)"
                    : "a direction of unit length (the value shown is the square of the length)");
        if (pendulous && !(along >= -direction_tolerance && along <= direction_tolerance))
            return refuse(fault, IMK_ERROR_RANGE, i, along, 0,
                          "a direction at right angles to the sensing direction (the value shown "
                          "is the cosine of the angle)");
    }
    return IMK_OK;
}

static imk_status check_density(const imk_triad *triad, imki_fault *fault)
{
    int density = (int)triad->noise.density;
    return density >= IMK_DENSITY_UNSTATED && density <= IMK_DENSITY_ONE_SIDED
               ? IMK_OK
               : refuse(fault, IMK_ERROR_RANGE, -1, density, IMK_DENSITY_ONE_SIDED,
                        "one of the values of imk_density");
}

static imk_status refuse_field(imki_fault *fault, const char *field, double value, double limit,
                               const char *expected)
{
    refuse(fault, IMK_ERROR_RANGE, -1, value, limit, expected);
    fault->field = field;
    return IMK_ERROR_RANGE;
}

static imk_status conflict(imki_fault *fault, const char *field, int axis, const char *found,
                           const char *remedy)
{
    refuse(fault, IMK_ERROR_CONFLICT, axis, 0, 0, remedy);
    fault->field = field;
    fault->found = found;
    return IMK_ERROR_CONFLICT;
}

static imk_status check_own(const imki_field *field, const imk_triad *triad, int kind,
                            imki_fault *fault)
{
    switch (field->shape) {
    case IMKI_DENSITY:
        return check_density(triad, fault);
    case IMKI_DIRECTION:
        return check_directions(triad, triad->direction, false, fault);
    case IMKI_PENDULOUS:
        return check_directions(triad, triad->nonlinearity.pendulous_axis, true, fault);
    case IMKI_LIST:
        return check_list(field, triad, kind, fault);
    case IMKI_POLYNOMIAL:
        return check_polynomial(polynomial_of(field, triad), triad->axis_count, fault);
    default:
        return check_numbers(field, triad, triad->axis_count, fault);
    }
}

static imk_status check_field(const imki_field *field, const imk_triad *triad, int kind,
                              imki_fault *fault)
{
    static const char *const founds[IMK_KINDS] = {"a gyro has no such error",
                                                  "an accelerometer has no such error",
                                                  "a magnetometer has no such error"};
    if (!field->path[kind])
        return imki_field_absent(field, triad)
                   ? IMK_OK
                   : conflict(fault,
                              field->path[IMK_GYRO] ? field->path[IMK_GYRO]
                                                    : field->path[IMK_ACCEL],
                              -1, founds[kind], "set it to 0");
    const imk_status status = check_own(field, triad, kind, fault);
    fault->field = field->path[kind];
    return status;
}

/* Settings that need or exclude one another, axis by axis. */
static imk_status check_together(const imk_triad *triad, imki_fault *fault)
{
    for (int i = 0; i < triad->axis_count; i++) {
        bool counts = triad->sensitivity.value[i] != 0;
        if (triad->bias.warm_up_amplitude.value[i] != 0 && !(triad->bias.warm_up_time.value > 0))
            return refuse_field(fault, "bias.warm_up.time", triad->bias.warm_up_time.value, 0,
                                "a positive time for the warm-up amplitude");
        if (triad->damping.value[i] != 0 && triad->bandwidth.value[i] == 0)
            return conflict(fault, "damping", i, "damping needs a bandwidth",
                            "add bandwidth, or remove damping");
        if (triad->resolution.value[i] != 0 && triad->noise.quantization.value[i] != 0)
            return conflict(fault, "resolution", i,
                            "resolution and noise.quantization exclude each other",
                            "keep resolution, or noise.quantization if the sensor integrates");
        if (counts != (triad->sensitivity.value[0] != 0))
            return conflict(fault, "sensitivity", i,
                            "some axes have a sensitivity and some have none",
                            "give all axes a sensitivity, or none");
        if (triad->zero_offset.value[i] != 0 && !counts)
            return conflict(fault, "zero_offset", i, "zero_offset needs a sensitivity",
                            "add sensitivity, or remove zero_offset");
    }
    return IMK_OK;
}

imk_status imki_triad_check(const imk_triad *triad, int kind, imki_fault *fault)
{
    imk_status status = IMK_OK;
    if (!triad->present)
        return IMK_OK;
    if (!(triad->axis_count >= 1 && triad->axis_count <= IMK_AXES_MAX))
        status = refuse_field(fault, "axis_count", triad->axis_count, IMK_AXES_MAX, "1 to 8 axes");
    for (size_t i = 0; status == IMK_OK && i < imki_triad_field_count; i++)
        status = check_field(&imki_triad_fields[i], triad, kind, fault);
    if (status == IMK_OK)
        status = check_together(triad, fault);
    return status;
}

imk_status imki_timing_check(const imk_timing *timing, imki_fault *fault)
{
    imk_status status = IMK_OK;
    for (size_t i = 0; status == IMK_OK && i < imki_timing_field_count; i++) {
        status = check_numbers(&imki_timing_fields[i], timing, 1, fault);
        fault->field = imki_timing_fields[i].path[0];
    }
    return status;
}
