/* SPDX-License-Identifier: Apache-2.0 */
/* A parameter of a design as text with its unit, and errors in the units of the table. */
#include "imukit/decimal.h"
#include "imukit/physics_log.h"
#include "imukit/units.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { TEXT_SIZE = 128 };

static size_t put(const char *source, size_t length, char *text, size_t size)
{
    if (length >= size)
        return 0;
    memcpy(text, source, length);
    text[length] = '\0';
    return length;
}

/* Pure numbers stand alone. */
static bool is_bare(const imk_design_field *field)
{
    return strcmp(field->unit, "1") == 0;
}

static size_t number_text(const imk_design_field *field, double value, int digits, char *text,
                          size_t size)
{
    char whole[TEXT_SIZE];
    const imk_unit unit = imk_unit_of(field->unit);
    size_t length;
    if (digits > 0) {
        length = imk_decimal_significant((value - unit.offset) / unit.scale, digits, whole);
        length += (size_t)snprintf(whole + length, sizeof whole - length, " %s", field->unit);
    } else {
        length = imk_quantity_format(&value, NULL, 1, &unit, whole, sizeof whole);
    }
    if (is_bare(field) && length > 2)
        length -= 2;
    return put(whole, length, text, size);
}

static size_t choice_text(const imk_design_field *field, int position, char *text, size_t size)
{
    const char *word = field->choices;
    for (; position > 0 && *word; position--) {
        word += strcspn(word, "|");
        word += *word == '|';
    }
    return put(word, strcspn(word, "|"), text, size);
}

size_t imk_design_field_text(const imk_design_field *field, const void *design, int digits,
                             char *text, size_t size)
{
    const char *place = (const char *)design + field->offset;
    char whole_text[16];
    double number;
    int whole;
    bool is_on;
    switch (field->kind) {
    case IMK_DESIGN_NUMBER:
        memcpy(&number, place, sizeof number);
        return number_text(field, number, digits, text, size);
    case IMK_DESIGN_COUNT:
        memcpy(&whole, place, sizeof whole);
        return put(whole_text, (size_t)snprintf(whole_text, sizeof whole_text, "%d", whole), text,
                   size);
    case IMK_DESIGN_CHOICE:
        memcpy(&whole, place, sizeof whole);
        return choice_text(field, whole, text, size);
    case IMK_DESIGN_SWITCH:
        memcpy(&is_on, place, sizeof is_on);
        return put(is_on ? "yes" : "no", is_on ? 3 : 2, text, size);
    }
    return 0;
}

/* ---- errors ---------------------------------------------------------------------------------- */

/* The number at a field, when it has one. */
static bool number_of(const imk_design_field *field, const void *design, double *value)
{
    const char *place = (const char *)design + field->offset;
    int whole;
    if (field->kind == IMK_DESIGN_NUMBER) {
        memcpy(value, place, sizeof *value);
        return true;
    }
    memcpy(&whole, place, sizeof whole);
    *value = (double)whole;
    return field->kind == IMK_DESIGN_COUNT;
}

static void number_in_unit(const imk_design_field *field, double value, char *text, size_t size)
{
    if (field->kind == IMK_DESIGN_NUMBER)
        (void)number_text(field, value, 6, text, size);
    else
        snprintf(text, size, "%.0f", value);
}

/* Two settings of a run. */
static bool setting_in_unit(imk_error *error)
{
    const bool is_step = strcmp(error->field, "step") == 0;
    if ((!is_step && strcmp(error->field, "rate") != 0) || error->status != IMK_ERROR_RANGE)
        return false;
    snprintf(error->found, sizeof error->found,
             is_step ? "\"%.6g s\" is outside its valid range (limit %.6g s)"
                     : "\"%.6g Hz\" is outside its valid range (limit %.6g Hz)",
             error->value, error->limit);
    return true;
}

void imk_design_error_in_units(const imk_instrument *instrument, const void *design,
                               imk_error *error)
{
    char value_text[64] = "", limit_text[64] = "";
    double value;
    if (!error || error->found[0] ||
        (error->status != IMK_ERROR_RANGE && error->status != IMK_ERROR_CONFLICT))
        return;
    if (setting_in_unit(error))
        return;
    for (size_t i = 0; i < instrument->field_count; i++) {
        const imk_design_field *field = &instrument->fields[i];
        if (strcmp(field->path, error->field) != 0)
            continue;
        if (!number_of(field, design, &value) || value != error->value)
            return;
        number_in_unit(field, value, value_text, sizeof value_text);
        if (isfinite(error->limit))
            number_in_unit(field, error->limit, limit_text, sizeof limit_text);
        snprintf(error->found, sizeof error->found, "\"%.28s\" %s%s%.28s%s", value_text,
                 error->status == IMK_ERROR_RANGE ? "is outside its valid range" : "is in conflict",
                 limit_text[0] ? " (limit " : "", limit_text, limit_text[0] ? ")" : "");
        return;
    }
}
