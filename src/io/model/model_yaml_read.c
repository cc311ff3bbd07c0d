/* SPDX-License-Identifier: Apache-2.0 */
/* From the tree of a model file to the model: walks the file's keys and looks each up in the
 * schema. Two things are read first in each sensor, because the rest depends on them: the
 * directions (number of axes) and the density (one- or two-sided). */
#include "model_reader_internal.h"

#include <stdio.h>
#include <string.h>

enum { NAMES_MAX = 64, PATH_SIZE = 160 };

/* ---- keys ------------------------------------------------------------------------------------ */

/* The other kind's name of the same term: angle_random_walk under accel. */
static const imki_field *field_of_other_kind(const char *path, int kind)
{
    for (size_t i = 0; i < imki_triad_field_count; i++) {
        const char *name = imki_triad_fields[i].path[1 - kind];
        if (name && strcmp(name, path) == 0)
            return &imki_triad_fields[i];
    }
    return NULL;
}

static imk_status refuse_key(imki_reader *r, int key, const char *path, const char *prefix)
{
    static const char *const owners[2] = {"gyros", "accelerometers"};
    char expected[sizeof r->error->expected];
    const imki_field *other = field_of_other_kind(path, r->kind);
    if (other && other->path[r->kind]) {
        const char *name = strrchr(other->path[r->kind], '.');
        snprintf(expected, sizeof expected, "%s have %s", owners[r->kind],
                 name ? name + 1 : other->path[r->kind]);
        return imki_reader_fail(r, key, IMK_ERROR_KEY_UNKNOWN, expected);
    }
    if (other) {
        snprintf(expected, sizeof expected, "only %s has this key",
                 r->kind == IMK_GYRO ? "accel" : "gyro");
        return imki_reader_fail(r, key, IMK_ERROR_KEY_UNKNOWN, expected);
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
    return imki_refuse_name(r->document, key, count, candidates, r->error);
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
static imk_status read_group(imki_reader *r, int mapping, const char *prefix)
{
    imk_status status =
        imki_reader_require(r, mapping, IMKI_NODE_MAPPING, "a mapping: {key: value, …}");
    for (int key = imki_reader_node(r, mapping)->first; status == IMK_OK && key != IMKI_NONE;) {
        int value = imki_reader_node(r, key)->next;
        char path[PATH_SIZE], next_prefix[PATH_SIZE + 1];
        snprintf(path, sizeof path, "%s%.64s", prefix, imki_reader_node(r, key)->text);
        const imki_field *field = exact_field(path, r->kind);
        if (field) {
            status = imki_read_field(r, field, value);
        } else if (is_group(path, r->kind)) {
            snprintf(next_prefix, sizeof next_prefix, "%s.", path);
            status = read_group(r, value, next_prefix);
        } else if (strcmp(path, "evidence") != 0) {
            status = refuse_key(r, key, path, prefix);
        }
        key = imki_reader_node(r, value)->next;
    }
    return status;
}

/* ---- evidence -------------------------------------------------------------------------------- */

static imk_status read_text(imki_reader *r, int node, char *target, size_t size)
{
    if (node == IMKI_NONE)
        return IMK_OK;
    imk_status status = imki_reader_require(r, node, IMKI_NODE_SCALAR, "a text");
    if (status != IMK_OK)
        return status;
    const imki_node *n = imki_reader_node(r, node);
    if (n->length >= size) {
        char expected[48];
        snprintf(expected, sizeof expected, "a text of at most %zu bytes", size - 1);
        return imki_reader_fail(r, node, IMK_ERROR_RANGE, expected);
    }
    memcpy(target, n->text, n->length + 1);
    return IMK_OK;
}

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

static imk_status read_interval(imki_reader *r, int key, bool is_bound, imk_evidence *evidence)
{
    int node = imki_reader_node(r, key)->next;
    if (evidence->interval_count == IMK_INTERVALS_MAX)
        return imki_reader_fail(r, key, IMK_ERROR_RANGE, "at most 24 intervals");
    imk_interval *interval = &evidence->interval[evidence->interval_count];
    const imki_field *field = split_key(r, key, interval);
    if (!field)
        return imki_reader_fail(r, key, IMK_ERROR_KEY_UNKNOWN,
                                "the path of a parameter with one number per axis, like "
                                "noise.bias_instability or noise.gauss_markov[0].sigma");
    imk_status status = IMK_OK;
    int upper = node;
    if (!is_bound) {
        if (imki_reader_node(r, node)->kind != IMKI_NODE_SEQUENCE ||
            imki_reader_node(r, node)->count != 2)
            return imki_reader_fail(r, node, IMK_ERROR_SYNTAX,
                                    "a list of the lower and the upper end: [1 deg/h, 3 deg/h]");
        int lower = imki_reader_node(r, node)->first;
        upper = imki_reader_node(r, lower)->next;
        status = imki_read_per_axis(r, lower, field->si[r->kind], field->flags,
                                    interval->lower.value, NULL);
    }
    if (status == IMK_OK)
        status = imki_read_per_axis(r, upper, field->si[r->kind], field->flags,
                                    interval->upper.value, NULL);
    if (status == IMK_OK)
        evidence->interval_count++;
    return status;
}

static imk_status read_evidence(imki_reader *r, int mapping, imk_evidence *evidence)
{
    static const char *const names[] = {"source", "method", "frame", "interval_95", "upper_bound"};
    imk_status status =
        imki_reader_require(r, mapping, IMKI_NODE_MAPPING, "a mapping: {source: …, …}");
    if (status != IMK_OK)
        return status;
    char *const texts[] = {evidence->source, evidence->method, evidence->frame};
    const size_t sizes[] = {sizeof evidence->source, sizeof evidence->method,
                            sizeof evidence->frame};
    for (int key = imki_reader_node(r, mapping)->first; key != IMKI_NONE;) {
        int value = imki_reader_node(r, key)->next;
        size_t which = 0;
        while (which < 5 && strcmp(imki_reader_node(r, key)->text, names[which]) != 0)
            which++;
        if (which == 5)
            return imki_refuse_name(r->document, key, 5, names, r->error);
        if (which < 3)
            status = read_text(r, value, texts[which], sizes[which]);
        else
            status = imki_reader_require(r, value, IMKI_NODE_MAPPING,
                                         "a mapping from parameters to numbers");
        for (int i = which < 3 ? IMKI_NONE : imki_reader_node(r, value)->first;
             status == IMK_OK && i != IMKI_NONE;
             i = imki_reader_node(r, imki_reader_node(r, i)->next)->next)
            status = read_interval(r, i, which == 4, evidence);
        if (status != IMK_OK)
            return status;
        key = imki_reader_node(r, value)->next;
    }
    return IMK_OK;
}

/* ---- the whole file -------------------------------------------------------------------------- */

static imk_status read_sensor(const imk_document *document, int kind, imk_triad *triad,
                              imk_evidence *evidence, imk_error *error)
{
    int node = imki_document_value(document, 0, kind == IMK_GYRO ? "gyro" : "accel");
    triad->present = node != IMKI_NONE;
    if (!triad->present)
        return IMK_OK;
    imki_reader r = {document, error, triad, kind, node, IMK_DENSITY_UNSTATED};
    imk_status status = imki_reader_require(&r, node, IMKI_NODE_MAPPING,
                                            "a mapping with the terms of the sensor, or {}");
    int direction = imki_document_value(document, node, "direction");
    int noise = imki_document_value(document, node, "noise");
    int density = imki_document_value(document, noise, "density");
    if (status == IMK_OK && direction != IMKI_NONE)
        status = imki_read_direction(&r, direction);
    if (status == IMK_OK && density != IMKI_NONE)
        status = imki_read_density(&r, density);
    if (status == IMK_OK)
        status = read_group(&r, node, "");
    int evidence_node = imki_document_value(document, node, "evidence");
    if (status == IMK_OK && evidence_node != IMKI_NONE)
        status = read_evidence(&r, evidence_node, evidence);
    return status;
}

static imk_status read_timing(const imk_document *document, imk_timing *timing, imk_error *error)
{
    imk_triad unused = {.axis_count = 1};
    imki_reader r = {document, error, &unused, IMK_GYRO, 0, IMK_DENSITY_UNSTATED};
    int mapping = imki_document_value(document, 0, "timing");
    if (mapping == IMKI_NONE)
        return IMK_OK;
    imk_status status =
        imki_reader_require(&r, mapping, IMKI_NODE_MAPPING, "a mapping: {jitter: …, …}");
    const char *names[8];
    for (size_t i = 0; i < imki_timing_field_count; i++)
        names[i] = imki_timing_fields[i].path[0];
    for (int key = document->node[mapping].first; status == IMK_OK && key != IMKI_NONE;) {
        int value = document->node[key].next;
        size_t i = 0;
        while (i < imki_timing_field_count && strcmp(names[i], document->node[key].text) != 0)
            i++;
        if (i == imki_timing_field_count)
            return imki_refuse_name(document, key, imki_timing_field_count, names, error);
        status = imki_read_scalar(&r, &imki_timing_fields[i], timing, value);
        key = document->node[value].next;
    }
    return status;
}

static imk_status read_version(const imk_document *document, imk_error *error)
{
    int node = imki_document_value(document, 0, "imukit");
    if (node == IMKI_NONE)
        return imki_document_error(document, 0, IMK_ERROR_KEY_MISSING, "",
                                   "imukit: 1, the version of the format, in a model file", error);
    const imki_node *n = &document->node[node];
    if (n->kind != IMKI_NODE_SCALAR || strcmp(n->text, "1") != 0)
        return imki_document_error(document, node, IMK_ERROR_VERSION,
                                   n->kind == IMKI_NODE_SCALAR ? n->text : "",
                                   "version 1 of the format", error);
    return IMK_OK;
}

static imk_status check_top_keys(const imk_document *document, imk_error *error)
{
    static const char *const names[] = {"imukit", "name",  "description", "residual_of",
                                        "gyro",   "accel", "timing",      "correlation"};
    enum { COUNT = sizeof names / sizeof names[0] };
    for (int key = document->node[0].first; key != IMKI_NONE;
         key = document->node[document->node[key].next].next) {
        size_t i = 0;
        while (i < COUNT && strcmp(names[i], document->node[key].text) != 0)
            i++;
        if (i == COUNT)
            return imki_refuse_name(document, key, COUNT, names, error);
    }
    return IMK_OK;
}

imk_status imki_document_read_model(const imk_document *document, imk_model *model,
                                    imk_error *error)
{
    imk_model_default(model);
    imki_reader r = {document, error, &model->gyro, IMK_GYRO, 0, IMK_DENSITY_UNSTATED};
    imk_status status = check_top_keys(document, error);
    if (status == IMK_OK)
        status = read_version(document, error);
    if (status == IMK_OK)
        status = read_text(&r, imki_document_value(document, 0, "name"), model->name,
                           sizeof model->name);
    if (status == IMK_OK)
        status = read_text(&r, imki_document_value(document, 0, "description"), model->description,
                           sizeof model->description);
    if (status == IMK_OK)
        status = read_text(&r, imki_document_value(document, 0, "residual_of"), model->residual_of,
                           sizeof model->residual_of);
    if (status == IMK_OK)
        status = read_sensor(document, IMK_GYRO, &model->gyro, &model->gyro_evidence, error);
    if (status == IMK_OK)
        status = read_sensor(document, IMK_ACCEL, &model->accel, &model->accel_evidence, error);
    if (status == IMK_OK)
        status = read_timing(document, &model->timing, error);
    if (status == IMK_OK)
        status = imki_read_correlation(document, &model->correlation, error);
    return status;
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
