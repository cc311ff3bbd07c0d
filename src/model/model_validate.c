/* SPDX-License-Identifier: Apache-2.0 */
/* Validation of a model: every field of the schema against its range, then what the ranges of
 * single fields cannot say: settings that need or exclude one another. */
#include "base/algebra/vector_internal.h"
#include "base/refuse_internal.h"
#include "model_internal.h"
#include "model_schema_internal.h"

#include <float.h>
#include <string.h>

enum { PATH_SIZE = 96 };

/* Directions farther from unit length than this were not meant as unit vectors; the reader
 * normalises to rounding. */
static const double direction_tolerance = 1e-9;

static const char *const kind_names[2] = {"gyro", "accel"};

/* A dotted path being put together; what does not fit is cut. */
typedef struct path {
    char text[PATH_SIZE];
    size_t length;
} path;

static void append(path *p, const char *text)
{
    for (; *text && p->length + 1 < sizeof p->text; text++)
        p->text[p->length++] = *text;
    p->text[p->length] = '\0';
}

static void append_index(path *p, int index)
{
    /* Lists have fewer than ten elements: IMK_TERMS_MAX. */
    char digits[4] = {'[', (char)('0' + index), ']', '\0'};
    append(p, digits);
}

static path path_of(const char *first, const char *second)
{
    path p = {"", 0};
    append(&p, first);
    append(&p, ".");
    append(&p, second);
    return p;
}

static imk_status refuse(imk_error *error, imk_status status, const path *where, int index,
                         double value, double limit, const char *expected)
{
    return imki_refuse_at(error, status, where->text, index < 0 ? SIZE_MAX : (size_t)index, value,
                          limit, expected);
}

static imk_status conflict(imk_error *error, const char *kind, const char *field, int axis,
                           const char *found, const char *remedy)
{
    path where = path_of(kind, field);
    imk_error_set(error, IMK_ERROR_CONFLICT, where.text, found, remedy);
    if (error)
        error->index = axis;
    return IMK_ERROR_CONFLICT;
}

static bool is_finite(double x)
{
    return x >= -DBL_MAX && x <= DBL_MAX;
}

static imk_status check_number(const imki_field *field, double x, const path *where, int index,
                               imk_error *error)
{
    if (!is_finite(x))
        return refuse(error, IMK_ERROR_NOT_FINITE, where, index, x, 0, "a finite number");
    if ((field->flags & IMKI_TYPICAL) && x == 0)
        return IMK_OK;
    bool open = (field->flags & IMKI_OPEN) != 0;
    if (!(open ? x > field->minimum : x >= field->minimum)) {
        const char *due = field->minimum != 0 ? (open ? "a larger number than the limit"
                                                      : "a number not below the limit")
                          : open              ? "a positive number"
                                              : "a number that is not negative";
        return refuse(error, IMK_ERROR_RANGE, where, index, x, field->minimum, due);
    }
    if (!(open && field->maximum < DBL_MAX ? x < field->maximum : x <= field->maximum))
        return refuse(error, IMK_ERROR_RANGE, where, index, x, field->maximum,
                      "a smaller number than the limit");
    return IMK_OK;
}

static imk_status check_sigma(double sigma, const path *where, int index, imk_error *error)
{
    if (!is_finite(sigma))
        return refuse(error, IMK_ERROR_NOT_FINITE, where, index, sigma, 0, "a finite 1-sigma");
    if (!(sigma >= 0))
        return refuse(error, IMK_ERROR_RANGE, where, index, sigma, 0,
                      "a 1-sigma that is not negative");
    return IMK_OK;
}

/* A field of shape scalar … quadratic. */
static imk_status check_numbers(const imki_field *field, const void *base, int axis_count,
                                const path *where, imk_error *error)
{
    const double *values = imki_field_values(field, base);
    const double *sigmas = imki_field_sigmas(field, base);
    int length = imki_row_length(field->shape), rows = imki_field_rows(field, axis_count);
    for (int i = 0; i < rows * length; i++) {
        int index = field->shape == IMKI_SCALAR ? -1 : i / length;
        imk_status status = check_number(field, values[i], where, index, error);
        if (status == IMK_OK)
            status = check_sigma(sigmas[i], where, index, error);
        if (status != IMK_OK)
            return status;
        bool diagonal = field->shape == IMKI_OFF_DIAGONAL && axis_count == 3 && i % 4 == 0;
        if (diagonal && (values[i] != 0 || sigmas[i] != 0))
            return refuse(error, IMK_ERROR_RANGE, where, index, values[i], 0,
                          "put 0 on the diagonal: an error along the axis is a scale_factor");
    }
    return IMK_OK;
}

static imk_status check_polynomial(const imk_temperature_polynomial *polynomial, int axis_count,
                                   const path *where, imk_error *error)
{
    static const imki_field any = {.minimum = -DBL_MAX, .maximum = DBL_MAX};
    if (!(polynomial->order >= 0 && polynomial->order <= IMK_TEMPERATURE_ORDER_MAX))
        return refuse(error, IMK_ERROR_RANGE, where, -1, polynomial->order,
                      IMK_TEMPERATURE_ORDER_MAX, "0 to 5 coefficients");
    if (polynomial->order == 0)
        return IMK_OK;
    const double temperatures[3] = {polynomial->reference, polynomial->minimum,
                                    polynomial->maximum};
    for (int i = 0; i < 3; i++) {
        if (!is_finite(temperatures[i]))
            return refuse(error, IMK_ERROR_NOT_FINITE, where, -1, temperatures[i], 0,
                          "a finite temperature");
        if (!(temperatures[i] >= 0))
            return refuse(error, IMK_ERROR_RANGE, where, -1, temperatures[i], 0,
                          "a temperature above absolute zero");
    }
    if (!(polynomial->minimum < polynomial->maximum))
        return refuse(error, IMK_ERROR_RANGE, where, -1, polynomial->minimum, polynomial->maximum,
                      "a valid_range from a lower to a higher temperature");
    for (int i = 0; i < polynomial->order * axis_count; i++) {
        const imk_axes *axes = &polynomial->coefficient[i / axis_count];
        int axis = i % axis_count;
        imk_status status = check_number(&any, axes->value[axis], where, axis, error);
        if (status == IMK_OK)
            status = check_sigma(axes->sigma[axis], where, axis, error);
        if (status != IMK_OK)
            return status;
    }
    return IMK_OK;
}

static imk_status check_list(const imki_field *field, const imk_triad *triad, int kind,
                             const path *where, imk_error *error)
{
    imki_list list = imki_list_of(field);
    int count = imki_list_count(field, triad);
    if (!(count >= 0 && count <= IMK_TERMS_MAX))
        return refuse(error, IMK_ERROR_RANGE, where, -1, count, IMK_TERMS_MAX, "0 to 8 terms");
    for (int i = 0; i < count; i++) {
        const void *element = imki_list_element(field, triad, i);
        path term = *where;
        append_index(&term, i);
        append(&term, ".");
        for (size_t j = 0; j < list.field_count; j++) {
            path place = term;
            append(&place, list.field[j].path[kind]);
            imk_status status =
                check_numbers(&list.field[j], element, triad->axis_count, &place, error);
            if (status != IMK_OK)
                return status;
        }
        /* Time, frequency and q may be 0 only where the first field, the size, is 0. */
        const double *sizes = imki_field_values(&list.field[0], element);
        for (size_t j = 1; j < list.field_count; j++) {
            const double *values = imki_field_values(&list.field[j], element);
            for (int axis = 0; axis < triad->axis_count; axis++) {
                path place = term;
                append(&place, list.field[j].path[kind]);
                if (sizes[axis] != 0 && values[axis] == 0)
                    return refuse(error, IMK_ERROR_RANGE, &place, axis, 0, list.field[j].minimum,
                                  "a positive number");
            }
        }
    }
    return IMK_OK;
}

static imk_status check_directions(const imk_triad *triad, const path *where, imk_error *error)
{
    for (int i = 0; i < triad->axis_count; i++) {
        const double *e = triad->direction[i];
        for (int j = 0; j < 3; j++)
            if (!is_finite(e[j]))
                return refuse(error, IMK_ERROR_NOT_FINITE, where, i, e[j], 0, "a finite number");
        double square = imki_dot3(e, e);
        if (!(square >= 1 - 2 * direction_tolerance && square <= 1 + 2 * direction_tolerance))
            return refuse(error, IMK_ERROR_RANGE, where, i, square, 1,
                          "a direction of unit length (this is its square)");
    }
    return IMK_OK;
}

/* Zeros, or of unit length and at right angles to the sensing direction. */
static imk_status check_pendulous(const imk_triad *triad, const path *where, imk_error *error)
{
    for (int i = 0; i < triad->axis_count; i++) {
        const double *p = triad->nonlinearity.pendulous_axis[i], *e = triad->direction[i];
        for (int j = 0; j < 3; j++)
            if (!is_finite(p[j]))
                return refuse(error, IMK_ERROR_NOT_FINITE, where, i, p[j], 0, "a finite number");
        double square = imki_dot3(p, p);
        double along = imki_dot3(p, e);
        if (square == 0)
            continue;
        if (!(square >= 1 - 2 * direction_tolerance && square <= 1 + 2 * direction_tolerance))
            return refuse(error, IMK_ERROR_RANGE, where, i, square, 1,
                          "a direction of unit length, or zeros (this is its square)");
        if (!(along >= -direction_tolerance && along <= direction_tolerance))
            return refuse(error, IMK_ERROR_RANGE, where, i, along, 0,
                          "a direction at right angles to the sensing direction (this is the "
                          "cosine between them)");
    }
    return IMK_OK;
}

static imk_status check_density(const imk_triad *triad, const path *where, imk_error *error)
{
    int density = (int)triad->noise.density;
    if (!(density >= IMK_DENSITY_UNSTATED && density <= IMK_DENSITY_ONE_SIDED))
        return refuse(error, IMK_ERROR_RANGE, where, -1, density, IMK_DENSITY_ONE_SIDED,
                      "one of imk_density");
    return IMK_OK;
}

static imk_status check_field(const imki_field *field, const imk_triad *triad, int kind,
                              imk_error *error)
{
    int of = field->path[kind] ? kind : 1 - kind;
    path where = path_of(kind_names[kind], field->path[of]);
    if (of != kind) {
        if (!imki_field_absent(field, triad))
            return conflict(error, kind_names[kind], field->path[of], -1,
                            kind == IMK_GYRO ? "a gyro has no such error"
                                             : "an accelerometer has no such error",
                            "set it to 0");
        return IMK_OK;
    }
    switch (field->shape) {
    case IMKI_DENSITY:
        return check_density(triad, &where, error);
    case IMKI_DIRECTION:
        return check_directions(triad, &where, error);
    case IMKI_PENDULOUS:
        return check_pendulous(triad, &where, error);
    case IMKI_LIST:
        return check_list(field, triad, kind, &where, error);
    case IMKI_POLYNOMIAL:
        return check_polynomial(
            (const imk_temperature_polynomial *)(const void *)((const char *)triad + field->offset),
            triad->axis_count, &where, error);
    default:
        return check_numbers(field, triad, triad->axis_count, &where, error);
    }
}

/* Settings that need or exclude one another, axis by axis. */
static imk_status check_together(const imk_triad *triad, const char *kind, imk_error *error)
{
    for (int i = 0; i < triad->axis_count; i++) {
        bool counts = triad->sensitivity.value[i] != 0;
        if (triad->bias.warm_up_amplitude.value[i] != 0 && !(triad->bias.warm_up_time.value > 0)) {
            path where = path_of(kind, "bias.warm_up.time");
            return refuse(error, IMK_ERROR_RANGE, &where, -1, triad->bias.warm_up_time.value, 0,
                          "a positive time for the warm-up amplitude");
        }
        if (triad->damping.value[i] != 0 && triad->bandwidth.value[i] == 0)
            return conflict(error, kind, "damping", i, "damping needs a bandwidth",
                            "add bandwidth, or remove damping");
        if (triad->resolution.value[i] != 0 && triad->noise.quantization.value[i] != 0)
            return conflict(error, kind, "resolution", i,
                            "resolution and noise.quantization exclude each other",
                            "keep resolution, or noise.quantization if the sensor integrates");
        if (counts != (triad->sensitivity.value[0] != 0))
            return conflict(error, kind, "sensitivity", i,
                            "some axes have a sensitivity and some have none",
                            "give all of them one, or none");
        if (triad->zero_offset.value[i] != 0 && !counts)
            return conflict(error, kind, "zero_offset", i, "zero_offset needs a sensitivity",
                            "add sensitivity, or remove zero_offset");
    }
    return IMK_OK;
}

static imk_status check_triad(const imk_triad *triad, int kind, imk_error *error)
{
    if (!triad->present)
        return IMK_OK;
    if (!(triad->axis_count >= 1 && triad->axis_count <= IMK_AXES_MAX)) {
        path where = path_of(kind_names[kind], "axis_count");
        return refuse(error, IMK_ERROR_RANGE, &where, -1, triad->axis_count, IMK_AXES_MAX,
                      "1 to 8 axes");
    }
    for (size_t i = 0; i < imki_triad_field_count; i++) {
        imk_status status = check_field(&imki_triad_fields[i], triad, kind, error);
        if (status != IMK_OK)
            return status;
    }
    return check_together(triad, kind_names[kind], error);
}

static imk_status check_text(const char *text, size_t size, const char *name, imk_error *error)
{
    if (memchr(text, '\0', size))
        return IMK_OK;
    return imk_error_set(error, IMK_ERROR_ARGUMENT, name, "", "a text that ends within its array");
}

static imk_status check_interval(const imk_interval *interval, const imk_triad *triad, int kind,
                                 imk_error *error)
{
    path where = path_of(kind_names[kind], "evidence.interval_95");
    if (!memchr(interval->key, '\0', sizeof interval->key))
        return refuse(error, IMK_ERROR_ARGUMENT, &where, -1, 0, 0, "a key that ends in its array");
    const imki_field *list;
    const imki_field *field = imki_field_find(interval->key, kind, &list);
    if (!field || field->shape != IMKI_AXES || (field->flags & IMKI_FLOOR))
        return refuse(error, IMK_ERROR_KEY_UNKNOWN, &where, -1, 0, 0,
                      "the path of a parameter with one number per axis, like "
                      "noise.bias_instability");
    int last = list ? IMK_TERMS_MAX - 1 : 0;
    if (!(interval->instance >= 0 && interval->instance <= last))
        return refuse(error, IMK_ERROR_RANGE, &where, -1, interval->instance, last,
                      "the number of a list term, from 0");
    append(&where, ".");
    append(&where, interval->key);
    for (int i = 0; i < triad->axis_count; i++) {
        double lower = interval->lower.value[i], upper = interval->upper.value[i];
        if (!is_finite(lower) || !is_finite(upper))
            return refuse(error, IMK_ERROR_NOT_FINITE, &where, i, is_finite(lower) ? upper : lower,
                          0, "a finite number");
        if (!(lower <= upper))
            return refuse(error, IMK_ERROR_RANGE, &where, i, lower, upper,
                          "a lower end that is not above the upper one");
    }
    return IMK_OK;
}

static imk_status check_evidence(const imk_evidence *evidence, const imk_triad *triad, int kind,
                                 imk_error *error)
{
    if (!triad->present)
        return IMK_OK;
    path where = path_of(kind_names[kind], "evidence");
    imk_status status = check_text(evidence->source, sizeof evidence->source, where.text, error);
    if (status == IMK_OK)
        status = check_text(evidence->method, sizeof evidence->method, where.text, error);
    if (status == IMK_OK)
        status = check_text(evidence->frame, sizeof evidence->frame, where.text, error);
    if (status == IMK_OK &&
        !(evidence->interval_count >= 0 && evidence->interval_count <= IMK_INTERVALS_MAX))
        return refuse(error, IMK_ERROR_RANGE, &where, -1, evidence->interval_count,
                      IMK_INTERVALS_MAX, "0 to 24 intervals");
    for (int i = 0; status == IMK_OK && i < evidence->interval_count; i++) {
        status = check_interval(&evidence->interval[i], triad, kind, error);
        for (int j = 0; status == IMK_OK && j < i; j++)
            if (strcmp(evidence->interval[i].key, evidence->interval[j].key) == 0 &&
                evidence->interval[i].instance == evidence->interval[j].instance)
                return refuse(error, IMK_ERROR_KEY_DUPLICATE, &where, -1, 0, 0,
                              "one interval for each parameter");
    }
    return status;
}

/* Numbers of sensors that are not present are not looked at, but must be numbers of some model. */
static imk_status check_correlated(const imk_model *model, int index, imk_error *error)
{
    static const path where = {"correlation.parameters", 0};
    const imk_model_parameter parameter = model->correlation.parameter[index];
    const bool present = parameter.sensor == IMK_GYRO ? model->gyro.present : model->accel.present;
    char unused[IMK_MODEL_PARAMETER_NAME];
    if (imk_model_parameter_name(parameter, unused) != IMK_OK ||
        (present && !imki_model_parameter_exists(model, parameter)))
        return refuse(error, IMK_ERROR_KEY_UNKNOWN, &where, index, 0, 0,
                      "a number of the model, like accel.bias.fixed.x");
    for (int i = 0; i < index; i++)
        if (memcmp(&model->correlation.parameter[i], &parameter, sizeof parameter) == 0)
            return refuse(error, IMK_ERROR_KEY_DUPLICATE, &where, index, 0, 0,
                          "every parameter once");
    return IMK_OK;
}

static imk_status check_correlation(const imk_model *model, imk_error *error)
{
    static const path where = {"correlation.values", 0};
    const imk_correlation *correlation = &model->correlation;
    if (!(correlation->count >= 0 && correlation->count <= IMK_CORRELATED_MAX))
        return refuse(error, IMK_ERROR_RANGE, &where, -1, correlation->count, IMK_CORRELATED_MAX,
                      "0 to 64 parameters");
    imk_status status = IMK_OK;
    for (int i = 0; status == IMK_OK && i < correlation->count; i++)
        status = check_correlated(model, i, error);
    for (int i = 0; status == IMK_OK && i < correlation->count; i++)
        for (int j = 0; j < i; j++) {
            const double value = (double)correlation->value[i * (i - 1) / 2 + j];
            if (!(value >= -1 && value <= 1))
                return refuse(error, IMK_ERROR_RANGE, &where, i, value, 1,
                              "correlations from -1 to 1");
        }
    return status;
}

imk_status imk_model_validate(const imk_model *model, imk_error *error)
{
    if (!model || model->cookie != IMKI_MODEL_COOKIE)
        return imk_error_set(error, IMK_ERROR_UNINITIALISED, "model", "",
                             "a model from imk_model_default() or from a file");
    imk_status status = check_text(model->name, sizeof model->name, "name", error);
    if (status == IMK_OK)
        status = check_text(model->description, sizeof model->description, "description", error);
    if (status == IMK_OK)
        status = check_text(model->residual_of, sizeof model->residual_of, "residual_of", error);
    if (status == IMK_OK && !model->gyro.present && !model->accel.present)
        return imk_error_set(error, IMK_ERROR_KEY_MISSING, "gyro", "", "a gyro, an accel, or both");
    if (status == IMK_OK)
        status = check_triad(&model->gyro, IMK_GYRO, error);
    if (status == IMK_OK)
        status = check_triad(&model->accel, IMK_ACCEL, error);
    for (size_t i = 0; status == IMK_OK && i < imki_timing_field_count; i++) {
        path where = path_of("timing", imki_timing_fields[i].path[0]);
        status = check_numbers(&imki_timing_fields[i], &model->timing, 1, &where, error);
    }
    if (status == IMK_OK)
        status = check_evidence(&model->gyro_evidence, &model->gyro, IMK_GYRO, error);
    if (status == IMK_OK)
        status = check_evidence(&model->accel_evidence, &model->accel, IMK_ACCEL, error);
    if (status == IMK_OK)
        status = check_correlation(model, error);
    return status;
}
