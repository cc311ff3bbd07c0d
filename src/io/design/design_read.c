/* SPDX-License-Identifier: Apache-2.0 */
/* From the tree of a design file to the fields of a design, by the instrument's table. */
#include "design_file_internal.h"
#include "io/model/model_yaml_internal.h"
#include "io/motion/step_sentence_internal.h"

#include "imukit/decimal.h"
#include "imukit/names.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

bool imki_design_component(const char *path, const char *prefix, size_t *length,
                           const char **component)
{
    const size_t skipped = strlen(prefix);
    if (strncmp(path, prefix, skipped) != 0)
        return false;
    *component = path + skipped;
    *length = strcspn(*component, ".");
    return true;
}

enum { CANDIDATES_MAX = IMKI_DESIGN_FIELDS_MAX + 4, WORD_SIZE = 64, CHOICES_MAX = 16 };

typedef struct reader {
    const imk_document *document;
    const imk_instrument *instrument;
    char *design;
    imk_error *error;
} reader;

/* ---- values ---------------------------------------------------------------------------------- */

static imk_status refuse(const reader *r, int node, imk_status status, const char *expected)
{
    const imki_node *n = &r->document->node[node];
    return imki_document_error(r->document, node, status,
                               n->kind == IMKI_NODE_SCALAR ? n->text : "", expected, r->error);
}

/* `at least 1 Hz`, with the unit of the table. */
static imk_status refuse_range(const reader *r, int node, const imk_design_field *field,
                               double value)
{
    char limit[IMKI_DESIGN_TEXT_SIZE], expected[sizeof r->error->expected];
    const bool low = field->open ? !(value > field->minimum) : !(value >= field->minimum);
    const double bound = low ? field->minimum : field->maximum;
    if (field->kind == IMK_DESIGN_NUMBER) {
        /* as a design that holds the limit would be written */
        const imk_design_field at_limit = {
            .kind = IMK_DESIGN_NUMBER, .unit = field->unit, .offset = 0};
        (void)imk_design_field_text(&at_limit, &bound, 6, limit, sizeof limit);
    } else {
        snprintf(limit, sizeof limit, "%.0f", bound);
    }
    snprintf(expected, sizeof expected, "%s %s (%s)",
             !low          ? "at most"
             : field->open ? "more than"
                           : "at least",
             limit, field->help);
    return refuse(r, node, IMK_ERROR_RANGE, expected);
}

static bool in_range(const imk_design_field *field, double value)
{
    return (field->open ? value > field->minimum : value >= field->minimum) &&
           value <= field->maximum;
}

/* A number with its unit; pure numbers may leave the 1 out. */
static imk_status read_number(const reader *r, int node, const imk_design_field *field)
{
    const imki_node *n = &r->document->node[node];
    double value, bare;
    imk_status status = imki_value_require(r->document, node, IMKI_NODE_SCALAR,
                                           "a number and its unit, as one text", r->error);
    if (status != IMK_OK)
        return status;
    if (strcmp(field->unit, "1") == 0 && n->length > 0 &&
        imk_decimal_parse(n->text, n->text + n->length, &bare) == n->text + n->length)
        value = bare;
    else
        status = imki_value_numbers(r->document, node, field->unit, 1, &value, r->error);
    if (status != IMK_OK)
        return status;
    if (!isfinite(value))
        return refuse(r, node, IMK_ERROR_NOT_FINITE, "a finite number");
    if (!in_range(field, value))
        return refuse_range(r, node, field, value);
    memcpy(r->design + field->offset, &value, sizeof value);
    return IMK_OK;
}

static imk_status read_count(const reader *r, int node, const imk_design_field *field)
{
    const imki_node *n = &r->document->node[node];
    char *end = NULL;
    const long value = n->kind == IMKI_NODE_SCALAR && n->length > 0 && n->length < 12
                           ? strtol(n->text, &end, 10)
                           : 0;
    const bool digit = n->kind == IMKI_NODE_SCALAR &&
                       (n->text[0] == '-' || (n->text[0] >= '0' && n->text[0] <= '9'));
    if (!digit || !end || *end != '\0' || value > INT_MAX || value < INT_MIN)
        return refuse(r, node, IMK_ERROR_SYNTAX, "a whole number, without a unit");
    if (!in_range(field, (double)value))
        return refuse_range(r, node, field, (double)value);
    const int whole = (int)value;
    memcpy(r->design + field->offset, &whole, sizeof whole);
    return IMK_OK;
}

static imk_status refuse_choice(const reader *r, int node, size_t count,
                                char words[CHOICES_MAX][WORD_SIZE])
{
    const char *names[CHOICES_MAX];
    char expected[sizeof r->error->expected];
    for (size_t i = 0; i < count; i++)
        names[i] = words[i];
    const size_t nearest = imk_nearest_name(r->document->node[node].text, count, names);
    size_t length;
    if (nearest < count)
        snprintf(expected, sizeof expected, "did you mean \"%s\"?", names[nearest]);
    else {
        length = (size_t)snprintf(expected, sizeof expected, "one of");
        for (size_t i = 0; i < count && length + WORD_SIZE < sizeof expected; i++)
            length += (size_t)snprintf(expected + length, sizeof expected - length, "%s %s",
                                       i > 0 ? "," : "", names[i]);
    }
    return refuse(r, node, IMK_ERROR_NAME_UNKNOWN, expected);
}

static imk_status read_choice(const reader *r, int node, const imk_design_field *field)
{
    char words[CHOICES_MAX][WORD_SIZE];
    size_t count = 0;
    const imk_status status =
        imki_value_require(r->document, node, IMKI_NODE_SCALAR, "one word", r->error);
    if (status != IMK_OK)
        return status;
    for (const char *at = field->choices; count < CHOICES_MAX; count++) {
        const size_t length = strcspn(at, "|");
        snprintf(words[count], WORD_SIZE, "%.*s", (int)length, at);
        if (strcmp(words[count], r->document->node[node].text) == 0) {
            const int position = (int)count;
            memcpy(r->design + field->offset, &position, sizeof position);
            return IMK_OK;
        }
        at += length;
        if (*at++ == '\0') {
            count++;
            break;
        }
    }
    return refuse_choice(r, node, count, words);
}

static imk_status read_switch(const reader *r, int node, const imk_design_field *field)
{
    static const char *const words[] = {"yes", "true", "on", "no", "false", "off"};
    const imki_node *n = &r->document->node[node];
    for (size_t i = 0; n->kind == IMKI_NODE_SCALAR && i < sizeof words / sizeof words[0]; i++)
        if (strcmp(words[i], n->text) == 0) {
            const bool is_on = i < 3;
            memcpy(r->design + field->offset, &is_on, sizeof is_on);
            return IMK_OK;
        }
    return refuse(r, node, IMK_ERROR_SYNTAX, "\"yes\" or \"no\"");
}

static imk_status read_field(const reader *r, int node, const imk_design_field *field)
{
    switch (field->kind) {
    case IMK_DESIGN_NUMBER:
        return read_number(r, node, field);
    case IMK_DESIGN_COUNT:
        return read_count(r, node, field);
    case IMK_DESIGN_CHOICE:
        return read_choice(r, node, field);
    case IMK_DESIGN_SWITCH:
        return read_switch(r, node, field);
    }
    return IMK_OK;
}

/* ---- keys ------------------------------------------------------------------------------------ */

static bool is_root_key(const char *key)
{
    return strcmp(key, "imukit") == 0 || strcmp(key, "instrument") == 0 ||
           strcmp(key, "name") == 0 || strcmp(key, "description") == 0;
}

/* An unknown key, with the nearest of those that may stand there. */
static imk_status refuse_key(const reader *r, int key, const char *prefix)
{
    static const char *const of_root[] = {"imukit", "instrument", "name", "description"};
    char words[IMKI_DESIGN_FIELDS_MAX][WORD_SIZE];
    const char *names[CANDIDATES_MAX];
    size_t count = 0;
    for (size_t i = 0; i < r->instrument->field_count && count < IMKI_DESIGN_FIELDS_MAX; i++) {
        const char *component;
        size_t length;
        if (!imki_design_component(r->instrument->fields[i].path, prefix, &length, &component))
            continue;
        snprintf(words[count], WORD_SIZE, "%.*s", (int)length, component);
        bool is_new = true;
        for (size_t k = 0; k < count; k++)
            is_new = is_new && strcmp(words[k], words[count]) != 0;
        if (is_new) {
            names[count] = words[count];
            count++;
        }
    }
    for (size_t i = 0; prefix[0] == '\0' && i < sizeof of_root / sizeof of_root[0]; i++)
        names[count++] = of_root[i];
    return imki_refuse_name(r->document, key, count, names, r->error);
}

/* The field of a path, or NULL; *is_group says that fields stand below it. */
static const imk_design_field *find_field(const imk_instrument *instrument, const char *path,
                                          bool *is_group)
{
    const size_t length = strlen(path);
    *is_group = false;
    for (size_t i = 0; i < instrument->field_count; i++) {
        const char *other = instrument->fields[i].path;
        if (strcmp(other, path) == 0)
            return &instrument->fields[i];
        *is_group = *is_group || (strncmp(other, path, length) == 0 && other[length] == '.');
    }
    return NULL;
}

static imk_status read_group(const reader *r, int mapping, const char *prefix)
{
    const imki_node *nodes = r->document->node;
    for (int key = nodes[mapping].first; key != IMKI_NONE; key = nodes[nodes[key].next].next) {
        char path[sizeof r->error->field];
        const int value = nodes[key].next;
        bool is_group = false;
        imk_status status;
        if (prefix[0] == '\0' && is_root_key(nodes[key].text))
            continue;
        if (strchr(nodes[key].text, '.'))
            return imki_document_error(r->document, key, IMK_ERROR_KEY_UNKNOWN, nodes[key].text,
                                       "nest the keys instead of dots: a: {b: …}", r->error);
        const int length = snprintf(path, sizeof path - 1, "%s%s", prefix, nodes[key].text);
        const imk_design_field *field = length > 0 && (size_t)length < sizeof path - 1
                                            ? find_field(r->instrument, path, &is_group)
                                            : NULL;
        if (!field && !is_group)
            return refuse_key(r, key, prefix);
        if (field) {
            status = read_field(r, value, field);
        } else {
            status = imki_value_require(r->document, value, IMKI_NODE_MAPPING,
                                        "a mapping: {key: value, …}", r->error);
            path[length] = '.';
            path[length + 1] = '\0';
            if (status == IMK_OK)
                status = read_group(r, value, path);
        }
        if (status != IMK_OK)
            return status;
    }
    return IMK_OK;
}

/* Give a validation error the place of the value it speaks of, when the file says that value. */
static void place_error(const imk_document *document, imk_error *error)
{
    bool complete = false;
    if (!error || error->field[0] == '\0')
        return;
    const int node = imki_document_find(document, 0, error->field, &complete);
    if (complete) {
        error->line = document->node[node].line;
        error->column = document->node[node].column;
    }
}

imk_status imki_design_read_fields(const imk_document *document, const imk_instrument *instrument,
                                   void *design, imk_error *error)
{
    const reader r = {document, instrument, design, error};
    imk_status status = read_group(&r, 0, "");
    if (status != IMK_OK)
        return status;
    status = imk_design_check(instrument, design, error);
    if (status != IMK_OK) {
        place_error(document, error);
        imk_design_error_in_units(instrument, design, error);
    }
    return status;
}
