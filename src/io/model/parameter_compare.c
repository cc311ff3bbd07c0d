/* SPDX-License-Identifier: Apache-2.0 */
/* What a foreign format could not hold: the file just written is read back and compared with the
 * model, field by field, so that nothing is dropped silently. */
#include "io/foreign/parameter_internal.h"

#include <math.h>
#include <stdlib.h>

/* Decimals, square roots and products of matrices on the way there and back cost a few units in the
 * last place of the largest number. */
static const double tolerance = 1e-12;

static bool close_numbers(const double *a, const double *b, int count)
{
    double largest = 0, difference = 0;
    for (int i = 0; i < count; i++) {
        largest = fmax(largest, fmax(fabs(a[i]), fabs(b[i])));
        difference = fmax(difference, fabs(a[i] - b[i]));
    }
    return difference <= tolerance * largest;
}

static bool close_polynomials(const imk_temperature_polynomial *a,
                              const imk_temperature_polynomial *b)
{
    bool same = a->order == b->order && close_numbers(&a->reference, &b->reference, 1) &&
                close_numbers(&a->minimum, &b->minimum, 1) &&
                close_numbers(&a->maximum, &b->maximum, 1);
    for (int i = 0; same && i < a->order; i++)
        same = close_numbers(a->coefficient[i].value, b->coefficient[i].value, 3);
    return same;
}

static bool close_lists(const imki_field *field, const imk_triad *a, const imk_triad *b)
{
    imki_list list = imki_list_of(field);
    bool same = imki_list_count(field, a) == imki_list_count(field, b);
    for (int i = 0; same && i < imki_list_count(field, a); i++)
        for (size_t j = 0; same && j < list.field_count; j++)
            same =
                close_numbers(imki_field_values(&list.field[j], imki_list_element(field, a, i)),
                              imki_field_values(&list.field[j], imki_list_element(field, b, i)), 3);
    return same;
}

static bool close_fields(const imki_field *field, const imk_triad *a, const imk_triad *b)
{
    switch (field->shape) {
    case IMKI_DENSITY:
        return true;
    case IMKI_DIRECTION:
        return close_numbers(a->direction[0], b->direction[0], 9);
    case IMKI_POLYNOMIAL:
        return close_polynomials(
            (const imk_temperature_polynomial *)(const void *)((const char *)a + field->offset),
            (const imk_temperature_polynomial *)(const void *)((const char *)b + field->offset));
    case IMKI_LIST:
        return close_lists(field, a, b);
    case IMKI_SCALAR:
        return close_numbers(imki_field_values(field, a), imki_field_values(field, b), 1);
    default:
        return close_numbers(imki_field_values(field, a), imki_field_values(field, b),
                             3 * imki_row_length(field->shape));
    }
}

/* Matrices hold only the sum of the terms, so both sides are compared as the reader makes them. */
static void bring_together(imki_parameters *p, imk_triad *triad)
{
    double response[3][3], zero[3][3] = {{0}};
    imki_parameters made = {.notes = p->notes}; /* that it cannot be made is no failure */
    bool folded = triad->cross_axis.value[0][0] != 0;
    for (int i = 0; i < 9; i++)
        folded = folded || triad->cross_axis.value[i / 3][i % 3] != zero[i / 3][i % 3];
    imki_response_of(triad, response);
    imki_response_set(&made, (imki_place){"", 0, 0}, triad, response);
    if (folded)
        imki_note(p, false, "cross_axis and misalignment are written as their sum");
}

static bool has_sigmas(const imki_field *field, const imk_triad *triad)
{
    if (field->shape > IMKI_QUADRATIC)
        return false;
    const double *sigmas = imki_field_sigmas(field, triad);
    int count = imki_field_rows(field, triad->axis_count) * imki_row_length(field->shape);
    for (int i = 0; i < count; i++)
        if (sigmas[i] != 0)
            return true;
    return false;
}

/* Notes on what one sensor lost. @return how many fields came back */
static int compare_triads(imki_parameters *p, const char *format, int kind, const imk_triad *triad,
                          const imk_triad *back, int *had)
{
    const char *name = imki_kind_names[kind];
    int kept = 0;
    bool sigmas = false;
    if (!triad->present)
        return 0;
    for (size_t i = 0; i < imki_triad_field_count; i++) {
        const imki_field *field = &imki_triad_fields[i];
        if (!field->path[kind] || field->shape == IMKI_DENSITY || (field->flags & IMKI_FLOOR))
            continue;
        sigmas = sigmas || has_sigmas(field, triad);
        if (imki_field_absent(field, triad))
            continue;
        ++*had;
        if (!back->present || imki_field_absent(field, back)) {
            imki_note(p, true, "%s.%s is not held by the format %s", name, field->path[kind],
                      format);
            continue;
        }
        kept++;
        if (!close_fields(field, triad, back))
            imki_note(p, true, "%s.%s is held only in part by the format %s", name,
                      field->path[kind], format);
    }
    if (sigmas)
        imki_note(p, true, "%s: uncertainties (±) are not held by the format %s", name, format);
    return kept;
}

static void compare_timing(imki_parameters *p, const char *format, const imk_timing *timing)
{
    for (size_t i = 0; i < imki_timing_field_count; i++)
        if (*imki_field_values(&imki_timing_fields[i], timing) != 0)
            imki_note(p, true, "timing.%s is not held by the format %s",
                      imki_timing_fields[i].path[0], format);
}

static bool holds_matrices(imk_parameter_format format)
{
    return format == IMK_PARAMETERS_KALIBR || format == IMK_PARAMETERS_MATLAB ||
           format == IMK_PARAMETERS_OPENVINS || format == IMK_PARAMETERS_DLIO ||
           format == IMK_PARAMETERS_FUSION;
}

void imki_parameters_compare(imki_parameters *p, imki_parameter_function *read, const char *format)
{
    imk_model *models = malloc(2 * sizeof *models);
    if (!models) {
        imki_parameter_refuse(p, IMK_ERROR_MEMORY, "", "", "");
        return;
    }
    imk_model *back = &models[0], *source = &models[1];
    imk_model_default(back);
    *source = *p->source;
    imk_parameter_settings settings = *p->settings;
    settings.sensor = NULL;
    imki_parameters reading = {.settings = &settings,
                               .error = p->error,
                               .text = p->out.bytes,
                               .size = p->out.size,
                               .model = back,
                               .triad = {&back->gyro, &back->accel}};
    read(&reading);
    imk_document_free(reading.document);
    p->status = reading.status;
    int had = 0, kept = 0;
    if (p->status == IMK_OK && holds_matrices(p->settings->format)) {
        bring_together(p, &source->gyro);
        bring_together(p, &source->accel);
        if (back->mag.present)
            bring_together(p, &source->mag);
    }
    if (p->status == IMK_OK) {
        kept = compare_triads(p, format, IMK_GYRO, &source->gyro, &back->gyro, &had);
        kept += compare_triads(p, format, IMK_ACCEL, &source->accel, &back->accel, &had);
        if (back->mag.present)
            kept += compare_triads(p, format, IMK_MAG, &source->mag, &back->mag, &had);
        else if (source->mag.present)
            imki_note(p, true, "mag is not held by the format %s", format);
        compare_timing(p, format, &source->timing);
    }
    if (had > 0 && kept == 0)
        imki_parameter_refuse(p, IMK_ERROR_UNSUPPORTED, "model",
                              "the format has no place for any term of the model",
                              "choose another format with --to");
    free(models);
}
