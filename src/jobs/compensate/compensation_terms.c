/* SPDX-License-Identifier: Apache-2.0 */
/* Which terms of a model compensation takes out, and which stay in the record: because they were
 * not selected, or because the model knows their size and not their course. */
#include "compensate_internal.h"

#include "model/model_schema_internal.h"

#include <stddef.h>
#include <stdio.h>
#include <string.h>

static bool any_value(const double *values, size_t count)
{
    for (size_t i = 0; i < count; i++)
        if (values[i] != 0)
            return true;
    return false;
}

static bool is_there(const imki_field *field, const imk_triad *triad)
{
    const size_t axes = (size_t)triad->axis_count;
    const double *values = imki_field_values(field, triad);
    if (field->shape == IMKI_POLYNOMIAL) {
        const imk_temperature_polynomial *polynomial = (const void *)values;
        for (int i = 0; i < polynomial->order; i++)
            if (any_value(polynomial->coefficient[i].value, axes))
                return true;
        return false;
    }
    return any_value(values, axes * (size_t)imki_row_length(field->shape));
}

static bool is_noise(const imki_field *field, int kind)
{
    return strncmp(field->path[kind], "noise.", 6) == 0;
}

/* What a field is listed as, in this order: direction and noise are asked for by themselves. */
enum { TERM, SENSITIVITY, STAYS, LISTS, UNLISTED };

/* Of a magnetometer only what is the same in all rows is taken out. */
static bool is_fixed(const imki_field *field)
{
    const int term = imki_field_term(field);
    return term >= 0 &&
           (imki_terms[term].form == IMKI_FORM_ONE || imki_terms[term].form == IMKI_FORM_INPUT ||
            imki_terms[term].form == IMKI_FORM_SEEN);
}

static int list_of(const imki_field *field, int kind)
{
    if (!field->path[kind] || field->flags & IMKI_COMPANION || is_noise(field, kind))
        return UNLISTED;
    if (field->flags & IMKI_OUTPUT)
        return field->offset == offsetof(imk_triad, sensitivity) ? SENSITIVITY : UNLISTED;
    if (kind == IMK_MAG)
        return is_fixed(field) ? TERM : STAYS;
    return imki_field_taken_out(field) ? TERM : STAYS;
}

static bool is_skewed(const imk_triad *triad)
{
    for (int i = 0; i < triad->axis_count; i++)
        for (int k = 0; k < 3; k++)
            if (triad->direction[i][k] != 0 && triad->direction[i][k] != 1)
                return true;
    return false;
}

static bool has_noise(const imk_triad *triad, int kind)
{
    for (size_t i = 0; i < imki_triad_field_count; i++) {
        const imki_field *field = &imki_triad_fields[i];
        if (field->path[kind] && is_noise(field, kind) &&
            (field->shape == IMKI_LIST ? imki_list_count(field, triad) > 0
                                       : field->shape == IMKI_AXES && is_there(field, triad)))
            return true;
    }
    return false;
}

static void add(imk_term_keys *keys, const char *sensor, const char *name)
{
    if (keys->count < IMK_TERM_KEYS_MAX)
        snprintf(keys->key[keys->count++], sizeof keys->key[0], "%s.%s", sensor, name);
}

static void add_taken_out(imk_term_keys *keys, const imk_triad *triad, int kind)
{
    if (triad->present && is_skewed(triad))
        add(keys, imki_kind_names[kind], "direction");
    for (int list = TERM; triad->present && list < STAYS; list++)
        for (size_t i = 0; i < imki_triad_field_count; i++)
            if (list_of(&imki_triad_fields[i], kind) == list &&
                is_there(&imki_triad_fields[i], triad))
                add(keys, imki_kind_names[kind], imki_field_name(&imki_triad_fields[i], kind));
}

static void add_left_in(imk_term_keys *keys, const imk_triad *triad, const imk_triad *whole,
                        int kind)
{
    for (int list = TERM; triad->present && list < LISTS; list++)
        for (size_t i = 0; i < imki_triad_field_count; i++) {
            const imki_field *field = &imki_triad_fields[i];
            if (list_of(field, kind) == list && is_there(field, whole) &&
                !(list < STAYS && is_there(field, triad)))
                add(keys, imki_kind_names[kind], imki_field_name(field, kind));
        }
    if (triad->present && has_noise(whole, kind))
        add(keys, imki_kind_names[kind], "noise");
}

imk_term_keys imki_taken_out(const imk_model *model)
{
    imk_term_keys list = {0};
    add_taken_out(&list, &model->gyro, IMK_GYRO);
    add_taken_out(&list, &model->accel, IMK_ACCEL);
    add_taken_out(&list, &model->mag, IMK_MAG);
    return list;
}

imk_term_keys imki_left_in(const imk_model *model, const imk_model *whole)
{
    imk_term_keys list = {0};
    add_left_in(&list, &model->gyro, &whole->gyro, IMK_GYRO);
    add_left_in(&list, &model->accel, &whole->accel, IMK_ACCEL);
    add_left_in(&list, &model->mag, &whole->mag, IMK_MAG);
    for (size_t i = 0; i < imki_timing_field_count; i++)
        if (*imki_field_values(&imki_timing_fields[i], &whole->timing) != 0)
            add(&list, "timing", imki_timing_fields[i].path[0]);
    return list;
}

void imk_compensation_model(const imk_model *whole, imk_model *selected)
{
    imk_triad *triads[2] = {&selected->gyro, &selected->accel};
    const imk_triad *from[2] = {&whole->gyro, &whole->accel};
    for (int sensor = 0; sensor < 2; sensor++) {
        triads[sensor]->range = from[sensor]->range;
        triads[sensor]->resolution = from[sensor]->resolution;
        triads[sensor]->noise.quantization = from[sensor]->noise.quantization;
    }
}

bool imki_temperature_term(const imk_model *model, char *name, size_t size)
{
    const imk_triad *triads[2] = {&model->gyro, &model->accel};
    for (size_t i = 0; i < imki_triad_field_count; i++) {
        const imki_field *field = &imki_triad_fields[i];
        const int term = imki_field_term(field);
        for (int sensor = 0; sensor < 2; sensor++)
            if (term >= 0 && imki_terms[term].form >= IMKI_FORM_WARMTH &&
                imki_terms[term].form <= IMKI_FORM_WARMING && field->path[sensor] &&
                triads[sensor]->present && is_there(field, triads[sensor])) {
                snprintf(name, size, "%s.%s", imki_kind_names[sensor], field->path[sensor]);
                return true;
            }
    }
    return false;
}
