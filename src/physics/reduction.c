/* SPDX-License-Identifier: Apache-2.0 */
/* What the instruments' error models have in common: how they begin, an error that acts like an
 * input, three axes from one. */
#include "physics_internal.h"

#include "base/text_internal.h"
#include "model/model_schema_internal.h"

void imk_instrument_reduce(const imk_instrument *instrument, const void *design, imk_model *model)
{
    const int sensor = instrument->sensor;
    imk_model_default(model);
    imk_triad *triad = imk_model_triad_to_set(model, sensor);
    imk_evidence *evidence = sensor == IMK_GYRO ? &model->gyro_evidence : &model->accel_evidence;
    imk_model_triad_to_set(model, sensor == IMK_GYRO ? IMK_ACCEL : IMK_GYRO)->present = false;
    triad->axis_count = 1;
    imki_copy_text(model->name, sizeof model->name, instrument->title);
    imki_copy_text(evidence->source, sizeof evidence->source, instrument->source);
    imki_copy_text(evidence->method, sizeof evidence->method, "design parameters, by closed forms");
    instrument->reduce(design, triad);
}

imk_status imki_check_bias(const imk_instrument *instrument, const void *design, const char *field,
                           imk_error *error)
{
    imk_triad triad = {.axis_count = 1, .direction = {{1.0, 0.0, 0.0}}};
    instrument->reduce(design, &triad);
    const double bias = triad.bias.fixed.value[0], range = triad.range.value[0];
    if (range <= 0.0 || fabs(bias) < range) /* 0: no end */
        return IMK_OK;
    return imki_conflict(error, field, range, fabs(bias),
                         "a range above the bias of this design: its reading would stay at the end "
                         "of the range without any input");
}

imk_status imki_check_torque(double torque, double usual, double largest, const char *field,
                             double value, const char *expected, imk_error *error)
{
    const double fixed = fabs(torque);
    if (fixed < largest)
        return IMK_OK;
    if (fabs(usual) < largest)
        return imki_conflict(error, "torque.fixed", fixed, largest, expected);
    const double needed = largest > 0.0 ? value * (fixed / largest) : (double)INFINITY;
    return imki_conflict(error, field, value, needed, expected);
}

double imki_reduction_offset(imk_triad *triad, double u, double per_kelvin)
{
    double *const s = &triad->scale_factor.fixed.value[0];
    double *const k2 = &triad->nonlinearity.k2.value[0];
    double *const bias_slope = &triad->bias.temperature.coefficient[0].value[0];
    double *const scale_slope = &triad->scale_factor.temperature.coefficient[0].value[0];
    const double k3 = triad->nonlinearity.k3.value[0];
    const double slope = 1.0 + *s + u * (2.0 * *k2 + 3.0 * u * k3);
    triad->bias.fixed.value[0] += u * (1.0 + *s + u * (*k2 + u * k3));
    *bias_slope += slope * per_kelvin + *scale_slope * u;
    *scale_slope += 2.0 * (*k2 + 3.0 * u * k3) * per_kelvin;
    *s = slope - 1.0;
    *k2 += 3.0 * u * k3;
    return slope;
}

static void copy_row(const imki_field *field, double *row)
{
    const int length = imki_row_length(field->shape);
    for (int axis = 1; axis < 3; axis++)
        for (int k = 0; k < length; k++)
            row[axis * length + imki_turned_element(field, k, axis)] = row[k];
}

static void copy_field(const imki_field *field, void *base)
{
    const int length = imki_row_length(field->shape);
    double *value = (double *)(void *)((char *)base + field->offset);
    copy_row(field, value);
    if (field->shape != IMKI_PENDULOUS) /* the sigmas stand behind the values */
        copy_row(field, value + (ptrdiff_t)IMK_AXES_MAX * length);
}

static void copy_list(const imki_field *field, imk_triad *triad)
{
    const imki_list list = imki_list_of(field);
    for (size_t i = 0; i < IMK_TERMS_MAX; i++)
        for (size_t j = 0; j < list.field_count; j++)
            copy_field(&list.field[j], (char *)triad + field->offset + i * list.size);
}

static void copy_polynomial(const imki_field *field, imk_temperature_polynomial *polynomial)
{
    for (int k = 0; k < IMK_TEMPERATURE_ORDER_MAX; k++) {
        copy_row(field, polynomial->coefficient[k].value);
        copy_row(field, polynomial->coefficient[k].sigma);
    }
}

static void three_axes(imk_triad *triad)
{
    for (const imki_field *field = imki_triad_fields;
         field < imki_triad_fields + imki_triad_field_count; field++)
        switch (field->shape) {
        case IMKI_SCALAR:
        case IMKI_DENSITY:
        case IMKI_DIRECTION:
            break;
        case IMKI_POLYNOMIAL:
            copy_polynomial(field,
                            (imk_temperature_polynomial *)(void *)((char *)triad + field->offset));
            break;
        case IMKI_LIST:
            copy_list(field, triad);
            break;
        default:
            copy_field(field, triad);
        }
    for (int axis = 0; axis < 3; axis++)
        for (int k = 0; k < 3; k++)
            triad->direction[axis][k] = axis == k ? 1.0 : 0.0;
    triad->axis_count = 3;
}

void imk_model_three_axes(imk_model *model)
{
    if (model->gyro.present)
        three_axes(&model->gyro);
    if (model->accel.present)
        three_axes(&model->accel);
}
