/* SPDX-License-Identifier: Apache-2.0 */
/* Everything a model file can say, as a numbered list: the fields of the schema for all sensors,
 * and what only the file has (texts, evidence). */
#include "model_yaml_internal.h"

#include <stddef.h>
#include <stdio.h>
#include <string.h>

typedef struct text_item {
    const char *path;
    size_t offset;
} text_item;

static const text_item head_texts[] = {{"name", offsetof(imk_model, name)},
                                       {"description", offsetof(imk_model, description)},
                                       {"residual_of", offsetof(imk_model, residual_of)}};

static const text_item evidence_texts[] = {{"source", offsetof(imk_evidence, source)},
                                           {"method", offsetof(imk_evidence, method)},
                                           {"frame", offsetof(imk_evidence, frame)}};

enum { HEAD_TEXTS = 3, EVIDENCE_TEXTS = 3, EVIDENCE_ITEMS = EVIDENCE_TEXTS + 2 };

const imk_evidence *imki_evidence_of(const imk_model *model, int kind)
{
    return kind == IMK_GYRO    ? &model->gyro_evidence
           : kind == IMK_ACCEL ? &model->accel_evidence
                               : &model->mag_evidence;
}

/* Item `index` of one sensor: its presence, its fields, its evidence. A field that the kind does
 * not have leaves the path empty. */
static void sensor_item(size_t index, int kind, imki_item *item)
{
    static const size_t evidence[IMK_KINDS] = {offsetof(imk_model, gyro_evidence),
                                               offsetof(imk_model, accel_evidence),
                                               offsetof(imk_model, mag_evidence)};
    item->kind = kind;
    if (index == 0) {
        item->type = IMKI_ITEM_SENSOR;
        snprintf(item->path, sizeof item->path, "%s", imki_kind_names[kind]);
    } else if (index <= imki_triad_field_count) {
        item->type = IMKI_ITEM_FIELD;
        item->field = &imki_triad_fields[index - 1];
        const char *path = item->field->path[kind];
        if (path && !(item->field->flags & IMKI_FLOOR))
            snprintf(item->path, sizeof item->path, "%s.%s", imki_kind_names[kind], path);
    } else {
        size_t which = index - 1 - imki_triad_field_count;
        bool is_text = which < EVIDENCE_TEXTS;
        item->type = is_text ? IMKI_ITEM_TEXT : IMKI_ITEM_INTERVALS;
        item->is_bound = which == EVIDENCE_TEXTS + 1;
        if (is_text)
            item->offset = evidence_texts[which].offset + evidence[kind];
        snprintf(item->path, sizeof item->path, "%s.evidence.%s", imki_kind_names[kind],
                 is_text          ? evidence_texts[which].path
                 : item->is_bound ? "upper_bound"
                                  : "interval_95");
    }
}

bool imki_item_at(size_t index, imki_item *item)
{
    const size_t per_sensor = 1 + imki_triad_field_count + EVIDENCE_ITEMS;
    *item = (imki_item){.type = IMKI_ITEM_TEXT};
    if (index < HEAD_TEXTS) {
        item->offset = head_texts[index].offset;
        snprintf(item->path, sizeof item->path, "%s", head_texts[index].path);
        return true;
    }
    index -= HEAD_TEXTS;
    if (index < IMK_KINDS * per_sensor) {
        sensor_item(index % per_sensor, (int)(index / per_sensor), item);
        return true;
    }
    index -= IMK_KINDS * per_sensor;
    if (index == imki_timing_field_count) {
        item->type = IMKI_ITEM_CORRELATION;
        snprintf(item->path, sizeof item->path, "correlation");
        return true;
    }
    if (index > imki_timing_field_count)
        return false;
    item->type = IMKI_ITEM_TIMING;
    item->field = &imki_timing_fields[index];
    snprintf(item->path, sizeof item->path, "timing.%s", item->field->path[0]);
    return true;
}

bool imki_is_bound(const imk_interval *interval, int axis_count)
{
    for (int i = 0; i < axis_count; i++)
        if (interval->lower.value[i] != 0)
            return false;
    return true;
}

/* Index of the next interval that is a bound, or is none, from `i` on. */
static int next_interval(const imk_evidence *evidence, int i, int axis_count, bool is_bound)
{
    while (i < evidence->interval_count &&
           imki_is_bound(&evidence->interval[i], axis_count) != is_bound)
        i++;
    return i;
}

static bool equal_interval(const imk_interval *a, const imk_interval *b, int axis_count)
{
    bool equal = strcmp(a->key, b->key) == 0 && a->instance == b->instance;
    for (int i = 0; i < axis_count; i++)
        equal = equal && a->lower.value[i] == b->lower.value[i] &&
                a->upper.value[i] == b->upper.value[i];
    return equal;
}

static bool equal_intervals(const imk_evidence *a, const imk_evidence *b, int axis_count,
                            bool is_bound)
{
    int i = next_interval(a, 0, axis_count, is_bound);
    int j = next_interval(b, 0, axis_count, is_bound);
    while (i < a->interval_count && j < b->interval_count) {
        if (!equal_interval(&a->interval[i], &b->interval[j], axis_count))
            return false;
        i = next_interval(a, i + 1, axis_count, is_bound);
        j = next_interval(b, j + 1, axis_count, is_bound);
    }
    return i == a->interval_count && j == b->interval_count;
}

static bool in_absent_sensor(const imki_item *item, const imk_model *model)
{
    bool in_sensor =
        strncmp(item->path, imki_kind_names[item->kind], strlen(imki_kind_names[item->kind])) == 0;
    return in_sensor && !imk_model_triad(model, item->kind)->present;
}

bool imki_item_equal(const imki_item *item, const imk_model *a, const imk_model *b)
{
    const imk_triad *a_triad = imk_model_triad(a, item->kind),
                    *b_triad = imk_model_triad(b, item->kind);
    const char *a_bytes = (const char *)a, *b_bytes = (const char *)b;
    if (item->path[0] == '\0')
        return true;
    if (item->type == IMKI_ITEM_SENSOR)
        return a_triad->present == b_triad->present;
    if (in_absent_sensor(item, a) || in_absent_sensor(item, b))
        return true; /* settled by the sensor's own item */
    switch (item->type) {
    case IMKI_ITEM_TEXT:
        return strcmp(a_bytes + item->offset, b_bytes + item->offset) == 0;
    case IMKI_ITEM_INTERVALS:
        return equal_intervals(imki_evidence_of(a, item->kind), imki_evidence_of(b, item->kind),
                               a_triad->axis_count, item->is_bound);
    case IMKI_ITEM_CORRELATION:
        return imki_correlation_equal(&a->correlation, &b->correlation);
    case IMKI_ITEM_TIMING:
        return *imki_field_values(item->field, &a->timing) ==
                   *imki_field_values(item->field, &b->timing) &&
               *imki_field_sigmas(item->field, &a->timing) ==
                   *imki_field_sigmas(item->field, &b->timing);
    default:
        return imki_field_equal(item->field, a_triad, b_triad, true) &&
               imki_field_stated_zero(item->field, a_triad) ==
                   imki_field_stated_zero(item->field, b_triad);
    }
}

bool imki_item_absent(const imki_item *item, const imk_model *model)
{
    const imk_triad *triad = imk_model_triad(model, item->kind);
    if (item->path[0] == '\0' || in_absent_sensor(item, model))
        return true;
    switch (item->type) {
    case IMKI_ITEM_SENSOR:
        return !triad->present;
    case IMKI_ITEM_TEXT:
        return ((const char *)model)[item->offset] == '\0';
    case IMKI_ITEM_INTERVALS: {
        const imk_evidence *evidence = imki_evidence_of(model, item->kind);
        return next_interval(evidence, 0, triad->axis_count, item->is_bound) ==
               evidence->interval_count;
    }
    case IMKI_ITEM_CORRELATION:
        return model->correlation.count == 0;
    case IMKI_ITEM_TIMING:
        return *imki_field_values(item->field, &model->timing) == 0 &&
               *imki_field_sigmas(item->field, &model->timing) == 0;
    default:
        return imki_field_absent(item->field, triad) && !imki_field_stated_zero(item->field, triad);
    }
}
