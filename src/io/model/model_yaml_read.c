/* SPDX-License-Identifier: Apache-2.0 */
/* From the tree of a model file to the model: walks the file's keys and looks each up in the
 * schema. Two things are read first in each sensor, because the rest depends on them: the
 * directions (number of axes) and the density (one- or two-sided). */
#include "model_reader_internal.h"

#include <stdio.h>
#include <string.h>

enum { NAMES_MAX = 64, PATH_SIZE = 160 };

/* ---- keys ------------------------------------------------------------------------------------ */

/* Another kind's name of the same term: angle_random_walk under accel. */
static const imki_field *field_of_other_kind(const char *path, int kind, int *other)
{
    for (size_t i = 0; i < imki_triad_field_count; i++)
        for (*other = 0; *other < IMK_KINDS; ++*other) {
            const char *name = imki_triad_fields[i].path[*other];
            if (*other != kind && name && strcmp(name, path) == 0)
                return &imki_triad_fields[i];
        }
    return NULL;
}

static void refuse_key(imki_reader *r, int key, const char *path, const char *prefix)
{
    static const char *const owners[IMK_KINDS] = {"gyros", "accelerometers", "magnetometers"};
    int which;
    char expected[sizeof r->reading->error->expected];
    const imki_field *other = field_of_other_kind(path, r->kind, &which);
    const char *own = other ? other->path[r->kind] : NULL, *last = own ? strrchr(own, '.') : NULL;
    if (own)
        snprintf(expected, sizeof expected, "%s have %s", owners[r->kind], last ? last + 1 : own);
    else if (other)
        snprintf(expected, sizeof expected, "only %s has this key", imki_kind_names[which]);
    if (other) {
        imki_refuse_value(r->reading, key, IMK_ERROR_KEY_UNKNOWN, expected);
        return;
    }
    char names[NAMES_MAX][32];
    const char *candidates[NAMES_MAX];
    size_t count = 0, prefix_length = strlen(prefix);
    for (size_t i = 0; i < imki_triad_field_count && count < NAMES_MAX - 1; i++) {
        const char *name = imki_triad_fields[i].path[r->kind];
        if (!name || strncmp(name, prefix, prefix_length) != 0)
            continue;
        snprintf(names[count], sizeof names[count], "%.*s", (int)strcspn(name + prefix_length, "."),
                 name + prefix_length);
        candidates[count] = names[count];
        if (count == 0 || strcmp(names[count], names[count - 1]) != 0)
            count++;
    }
    if (prefix_length == 0)
        candidates[count++] = "evidence";
    imki_refuse_key(r->reading, key, count, candidates);
}

static const imki_field *exact_field(const char *path, int kind)
{
    for (size_t i = 0; i < imki_triad_field_count; i++) {
        const char *name = imki_triad_fields[i].path[kind];
        if (name && strcmp(name, path) == 0)
            return &imki_triad_fields[i];
    }
    return NULL;
}

/* True when fields stand below this path. */
static bool is_group(const char *path, int kind)
{
    size_t length = strlen(path);
    for (size_t i = 0; i < imki_triad_field_count; i++) {
        const char *name = imki_triad_fields[i].path[kind];
        if (name && strncmp(name, path, length) == 0 && name[length] == '.')
            return true;
    }
    return false;
}

/* The keys of a sensor, or of a group in it (prefix "noise."). */
static void read_group(imki_reader *r, int mapping, const char *prefix)
{
    if (!imki_value_require(r->reading, mapping, IMKI_NODE_MAPPING, "a mapping: {key: value, …}"))
        return;
    for (int key = imki_reader_node(r, mapping)->first; key != IMKI_NONE;) {
        int value = imki_reader_node(r, key)->next;
        char path[PATH_SIZE], next_prefix[PATH_SIZE + 1];
        snprintf(path, sizeof path, "%s%.64s", prefix, imki_reader_node(r, key)->text);
        const imki_field *field = exact_field(path, r->kind);
        if (field) {
            imki_read_field(r, field, value);
            if (imki_field_absent(field, r->triad))
                r->triad->stated_zero |= imki_field_bit(field);
        } else if (is_group(path, r->kind)) {
            snprintf(next_prefix, sizeof next_prefix, "%s.", path);
            read_group(r, value, next_prefix);
        } else if (strcmp(path, "evidence") != 0) {
            refuse_key(r, key, path, prefix);
        }
        key = imki_reader_node(r, value)->next;
    }
}

/* ---- evidence -------------------------------------------------------------------------------- */

/* "noise.gauss_markov[1].sigma" is key "noise.gauss_markov.sigma", instance 1. @return the field
 * of a key that has intervals, NULL of others */
static const imki_field *split_key(const imki_reader *r, int key, imk_interval *interval)
{
    const imki_field *list, *field = NULL;
    const char *text = imki_reader_node(r, key)->text;
    const char *bracket = strchr(text, '[');
    *interval = (imk_interval){.instance = 0};
    if (!bracket && strlen(text) < sizeof interval->key) {
        snprintf(interval->key, sizeof interval->key, "%s", text);
        field = imki_field_find(interval->key, r->kind, &list);
        if (field && list)
            field = NULL;
    } else if (bracket && bracket[1] >= '0' && bracket[1] < '0' + IMK_TERMS_MAX &&
               bracket[2] == ']' && strlen(text) < sizeof interval->key) {
        snprintf(interval->key, sizeof interval->key, "%.*s%s", (int)(bracket - text), text,
                 bracket + 3);
        interval->instance = bracket[1] - '0';
        field = imki_field_find(interval->key, r->kind, &list);
        if (field && !list)
            field = NULL;
    }
    return field && field->shape == IMKI_AXES && !(field->flags & IMKI_FLOOR) ? field : NULL;
}

static void read_interval(imki_reader *r, int key, bool is_bound, imk_evidence *evidence)
{
    imki_reading *reading = r->reading;
    const int node = imki_reader_node(r, key)->next;
    const imki_node *ends = imki_reader_node(r, node);
    if (evidence->interval_count == IMK_INTERVALS_MAX) {
        imki_refuse_value(reading, key, IMK_ERROR_RANGE, "at most 24 intervals");
        return;
    }
    imk_interval *interval = &evidence->interval[evidence->interval_count++];
    const imki_field *field = split_key(r, key, interval);
    if (!field)
        imki_refuse_value(reading, key, IMK_ERROR_KEY_UNKNOWN,
                          "the path of a parameter with one number per axis, like "
                          "noise.bias_instability or noise.gauss_markov[0].sigma");
    else if (!is_bound && (ends->kind != IMKI_NODE_SEQUENCE || ends->count != 2))
        imki_refuse_value(reading, node, IMK_ERROR_SYNTAX,
                          "a list of the lower and the upper end: [1 deg/h, 3 deg/h]");
    if (reading->status != IMK_OK)
        return;
    if (!is_bound)
        imki_read_per_axis(r, ends->first, field->si[r->kind], field->flags, interval->lower.value,
                           NULL);
    imki_read_per_axis(r, is_bound ? node : imki_reader_node(r, ends->first)->next,
                       field->si[r->kind], field->flags, interval->upper.value, NULL);
}

static void read_intervals(imki_reader *r, int mapping, bool is_bound, imk_evidence *evidence)
{
    if (!imki_value_require(r->reading, mapping, IMKI_NODE_MAPPING,
                            "a mapping from parameters to numbers"))
        return;
    for (int key = imki_reader_node(r, mapping)->first;
         key != IMKI_NONE && r->reading->status == IMK_OK;
         key = imki_reader_node(r, imki_reader_node(r, key)->next)->next)
        read_interval(r, key, is_bound, evidence);
}

static void read_evidence(imki_reader *r, int mapping, imk_evidence *evidence)
{
    static const char *const names[] = {"source", "method", "frame", "interval_95", "upper_bound"};
    char *const texts[] = {evidence->source, evidence->method, evidence->frame};
    const size_t sizes[] = {sizeof evidence->source, sizeof evidence->method,
                            sizeof evidence->frame};
    if (!imki_value_require(r->reading, mapping, IMKI_NODE_MAPPING, "a mapping: {source: …, …}"))
        return;
    for (int key = imki_reader_node(r, mapping)->first; key != IMKI_NONE;) {
        int value = imki_reader_node(r, key)->next;
        size_t which = 0;
        while (which < 5 && strcmp(imki_reader_node(r, key)->text, names[which]) != 0)
            which++;
        if (which == 5)
            imki_refuse_key(r->reading, key, 5, names);
        else if (which < 3)
            imki_value_text(r->reading, value, texts[which], sizes[which]);
        else
            read_intervals(r, value, which == 4, evidence);
        key = imki_reader_node(r, value)->next;
    }
}

/* ---- the whole file -------------------------------------------------------------------------- */

static void read_sensor(imki_reading *reading, int kind, imk_triad *triad, imk_evidence *evidence)
{
    const imk_document *document = reading->document;
    int node = imki_document_value(document, 0, imki_kind_names[kind]);
    triad->present = node != IMKI_NONE;
    if (!triad->present || !imki_value_require(reading, node, IMKI_NODE_MAPPING,
                                               "a mapping with the terms of the sensor, or {}"))
        return;
    imki_reader r = {reading, triad, kind, node, IMK_DENSITY_UNSTATED};
    int direction = imki_document_value(document, node, "direction");
    int noise = imki_document_value(document, node, "noise");
    int density = imki_document_value(document, noise, "density");
    int evidence_node = imki_document_value(document, node, "evidence");
    if (direction != IMKI_NONE)
        imki_read_direction(&r, direction);
    if (density != IMKI_NONE)
        imki_read_density(&r, density);
    read_group(&r, node, "");
    if (evidence_node != IMKI_NONE)
        read_evidence(&r, evidence_node, evidence);
}

static void read_timing(imki_reading *reading, imk_timing *timing)
{
    const imki_node *nodes = reading->document->node;
    imk_triad unused = {.axis_count = 1};
    imki_reader r = {reading, &unused, IMK_GYRO, 0, IMK_DENSITY_UNSTATED};
    int mapping = imki_document_value(reading->document, 0, "timing");
    if (mapping == IMKI_NONE ||
        !imki_value_require(reading, mapping, IMKI_NODE_MAPPING, "a mapping: {jitter: …, …}"))
        return;
    const char *names[8];
    for (size_t i = 0; i < imki_timing_field_count; i++)
        names[i] = imki_timing_fields[i].path[0];
    for (int key = nodes[mapping].first; key != IMKI_NONE; key = nodes[nodes[key].next].next) {
        size_t i = 0;
        while (i < imki_timing_field_count && strcmp(names[i], nodes[key].text) != 0)
            i++;
        if (i == imki_timing_field_count)
            imki_refuse_key(reading, key, imki_timing_field_count, names);
        else
            imki_read_scalar(&r, &imki_timing_fields[i], timing, nodes[key].next);
    }
}

imk_status imki_document_read_model(const imk_document *document, imk_model *model,
                                    imk_error *error)
{
    static const char *const names[] = {"imukit", "name", "description", "residual_of", "gyro",
                                        "accel",  "mag",  "timing",      "correlation"};
    imki_reading r = {.document = document, .error = error};
    imk_model_default(model);
    imki_value_keys(&r, 0, sizeof names / sizeof names[0], names);
    if (imki_document_value(document, 0, "imukit") == IMKI_NONE)
        imki_value_refuse(&r, 0, IMK_ERROR_KEY_MISSING, "",
                          "write imukit: 1, the version of the format, in a model file");
    imki_value_version(&r, "imukit");
    imki_value_name(&r, "name", model->name, sizeof model->name);
    imki_value_name(&r, "description", model->description, sizeof model->description);
    imki_value_name(&r, "residual_of", model->residual_of, sizeof model->residual_of);
    read_sensor(&r, IMK_GYRO, &model->gyro, &model->gyro_evidence);
    read_sensor(&r, IMK_ACCEL, &model->accel, &model->accel_evidence);
    read_sensor(&r, IMK_MAG, &model->mag, &model->mag_evidence);
    read_timing(&r, &model->timing);
    imki_read_correlation(&r, &model->correlation);
    return r.status;
}

/* Give a validation error the place of the value it speaks of. */
static void place_error(const imk_document *document, imk_error *error)
{
    if (!error || error->field[0] == '\0')
        return;
    int node = imki_document_find(document, 0, error->field, NULL);
    error->line = document->node[node].line;
    error->column = document->node[node].column;
    if (error->found[0] == '\0' && document->node[node].kind == IMKI_NODE_SCALAR)
        snprintf(error->found, sizeof error->found, "%.80s", document->node[node].text);
}

imk_status imki_document_open(const char *text, size_t size, bool validate, imk_document **document,
                              imk_error *error)
{
    imk_document *made = NULL;
    imk_status status = imki_document_parse(text, size, &made, error);
    if (status != IMK_OK)
        return status;
    status = imki_document_read_model(made, &made->model, error);
    if (status == IMK_OK && validate) {
        status = imk_model_validate(&made->model, error);
        if (status != IMK_OK)
            place_error(made, error);
    }
    if (status != IMK_OK) {
        imk_document_free(made);
        return status;
    }
    *document = made;
    return IMK_OK;
}
