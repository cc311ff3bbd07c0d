/* SPDX-License-Identifier: Apache-2.0 */
/* From the tree of a design file to the fields of a design, by the instrument's table. */
#include "design_file_internal.h"
#include "io/model/model_yaml_internal.h"

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
    imki_reading *reading;
    const imk_instrument *instrument;
    char *design;
} reader;

/* ---- values ---------------------------------------------------------------------------------- */

/* `at least 1 Hz`, with the unit of the table. */
static void refuse_range(const reader *r, int node, const imk_design_field *field, double value)
{
    char limit[IMKI_DESIGN_TEXT_SIZE], expected[sizeof r->reading->error->expected];
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
    imki_refuse_value(r->reading, node, IMK_ERROR_RANGE, expected);
}

static bool in_range(const imk_design_field *field, double value)
{
    return (field->open ? value > field->minimum : value >= field->minimum) &&
           value <= field->maximum;
}

/* A number with its unit; pure numbers may leave the 1 out. */
static void read_number(const reader *r, int node, const imk_design_field *field)
{
    const imki_node *n = &r->reading->document->node[node];
    double value = 0, bare;
    if (strcmp(field->unit, "1") == 0 && n->kind == IMKI_NODE_SCALAR && n->length > 0 &&
        imk_decimal_parse(n->text, n->text + n->length, &bare) == n->text + n->length)
        value = bare;
    else
        imki_number_at(r->reading, node, field->unit, &value);
    if (!isfinite(value))
        imki_refuse_value(r->reading, node, IMK_ERROR_NOT_FINITE, "a finite number");
    if (!in_range(field, value))
        refuse_range(r, node, field, value);
    memcpy(r->design + field->offset, &value, sizeof value);
}

static void read_count(const reader *r, int node, const imk_design_field *field)
{
    const imki_node *n = &r->reading->document->node[node];
    char *end = NULL;
    const long value = n->kind == IMKI_NODE_SCALAR && n->length > 0 && n->length < 12
                           ? strtol(n->text, &end, 10)
                           : 0;
    const bool digit = n->kind == IMKI_NODE_SCALAR &&
                       (n->text[0] == '-' || (n->text[0] >= '0' && n->text[0] <= '9'));
    if (!digit || !end || *end != '\0' || value > INT_MAX || value < INT_MIN)
        imki_refuse_value(r->reading, node, IMK_ERROR_SYNTAX, "a whole number, without a unit");
    if (!in_range(field, (double)value))
        refuse_range(r, node, field, (double)value);
    const int whole = (int)value;
    memcpy(r->design + field->offset, &whole, sizeof whole);
}

static void read_choice(const reader *r, int node, const imk_design_field *field)
{
    char words[CHOICES_MAX][WORD_SIZE];
    const char *names[CHOICES_MAX];
    int count = 0;
    if (!imki_value_require(r->reading, node, IMKI_NODE_SCALAR, "one word"))
        return;
    const char *text = r->reading->document->node[node].text;
    for (const char *at = field->choices; at && count < CHOICES_MAX; count++) {
        const size_t length = strcspn(at, "|");
        snprintf(words[count], WORD_SIZE, "%.*s", (int)length, at);
        names[count] = words[count];
        if (strcmp(words[count], text) == 0) {
            memcpy(r->design + field->offset, &count, sizeof count);
            return;
        }
        at = at[length] ? at + length + 1 : NULL;
    }
    imki_refuse_name(r->reading, node, text, text, (size_t)count, names);
}

static void read_switch(const reader *r, int node, const imk_design_field *field)
{
    bool is_on = false;
    imki_value_choice(r->reading, node, imki_yes_no, "\"yes\" or \"no\"", &is_on);
    memcpy(r->design + field->offset, &is_on, sizeof is_on);
}

static void read_field(const reader *r, int node, const imk_design_field *field)
{
    static void (*const readers[])(const reader *, int,
                                   const imk_design_field *) = {[IMK_DESIGN_NUMBER] = read_number,
                                                                [IMK_DESIGN_COUNT] = read_count,
                                                                [IMK_DESIGN_CHOICE] = read_choice,
                                                                [IMK_DESIGN_SWITCH] = read_switch};
    readers[field->kind](r, node, field);
}

/* ---- keys ------------------------------------------------------------------------------------ */

static bool is_root_key(const char *key)
{
    return strcmp(key, "imukit") == 0 || strcmp(key, "instrument") == 0 ||
           strcmp(key, "name") == 0 || strcmp(key, "description") == 0;
}

/* An unknown key, with the nearest of those that may stand there. */
static void refuse_key(const reader *r, int key, const char *prefix)
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
    imki_refuse_key(r->reading, key, count, names);
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

static void read_group(const reader *r, int mapping, const char *prefix)
{
    imki_reading *reading = r->reading;
    const imki_node *nodes = reading->document->node;
    for (int key = nodes[mapping].first; key != IMKI_NONE && reading->status == IMK_OK;
         key = nodes[nodes[key].next].next) {
        char path[sizeof reading->error->field];
        const int value = nodes[key].next;
        bool is_group = false;
        if (prefix[0] == '\0' && is_root_key(nodes[key].text))
            continue;
        if (strchr(nodes[key].text, '.')) {
            imki_value_refuse(reading, key, IMK_ERROR_KEY_UNKNOWN, nodes[key].text,
                              "nest the keys instead of writing dots: a: {b: …}");
            return;
        }
        const int length = snprintf(path, sizeof path - 1, "%s%s", prefix, nodes[key].text);
        const imk_design_field *field = length > 0 && (size_t)length < sizeof path - 1
                                            ? find_field(r->instrument, path, &is_group)
                                            : NULL;
        if (field) {
            read_field(r, value, field);
        } else if (!is_group) {
            refuse_key(r, key, prefix);
        } else if (imki_value_require(reading, value, IMKI_NODE_MAPPING,
                                      "a mapping: {key: value, …}")) {
            path[length] = '.';
            path[length + 1] = '\0';
            read_group(r, value, path);
        }
    }
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

void imki_design_read_fields(imki_reading *reading, const imk_instrument *instrument, void *design)
{
    const reader r = {reading, instrument, design};
    read_group(&r, 0, "");
    if (reading->status != IMK_OK)
        return;
    reading->status = imk_design_check(instrument, design, reading->error);
    if (reading->status != IMK_OK) {
        place_error(reading->document, reading->error);
        imk_design_error_in_units(instrument, design, reading->error);
    }
}
