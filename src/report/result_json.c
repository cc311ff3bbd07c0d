/* SPDX-License-Identifier: Apache-2.0 */
/* The data of a result as JSON [RFC8259]. An object of few plain values, such as a quantity, goes
 * on one line. */
#include "markup_internal.h"
#include "result_internal.h"

#include "imukit/decimal.h"

#include <stdio.h>
#include <string.h>

enum { FLAT_MOST = 6, INDENT = 2 };

static bool is_container(const imki_data *data)
{
    return data->kind == IMKI_DATA_OBJECT || data->kind == IMKI_DATA_ARRAY;
}

static bool is_flat(const imki_data *data)
{
    if (data->kind != IMKI_DATA_OBJECT || data->size > FLAT_MOST)
        return false;
    for (const imki_data *member = data->first; member; member = member->next)
        if (is_container(member))
            return false;
    return true;
}

static void put_scalar(imki_text *out, const imki_data *data)
{
    char number[IMK_DECIMAL_SIZE];
    switch (data->kind) {
    case IMKI_DATA_NUMBER:
        number[imk_decimal_shortest(data->value.number, number)] = '\0';
        imki_text_put(out, number);
        break;
    case IMKI_DATA_COUNT:
        imki_text_add(out, "%lld", data->value.count);
        break;
    case IMKI_DATA_TEXT:
        imki_markup_quote(out, data->value.text);
        break;
    case IMKI_DATA_FLAG:
        imki_text_put(out, data->value.flag ? "true" : "false");
        break;
    default:
        imki_text_put(out, "null");
    }
}

/* The text before a member: a comma, and a new line unless its object is on one line. */
static void put_separator(imki_text *out, const imki_data *member, bool flat, int depth)
{
    const bool first = member->parent->first == member;
    if (flat)
        imki_text_put(out, first ? "" : ", ");
    else
        imki_text_add(out, "%s\n%*s", first ? "" : ",", INDENT * (depth + 1), "");
    if (member->key) {
        imki_markup_quote(out, member->key);
        imki_text_put(out, ": ");
    }
}

/* The depth of the recursion is the depth of the tree, which the code that makes the tree
 * bounds. */
static void put(imki_text *out, const imki_data *data, int depth)
{
    if (!is_container(data)) {
        put_scalar(out, data);
        return;
    }
    const bool flat = is_flat(data), object = data->kind == IMKI_DATA_OBJECT;
    imki_text_put_char(out, object ? '{' : '[');
    for (const imki_data *member = data->first; member; member = member->next) {
        put_separator(out, member, flat, depth);
        put(out, member, depth + 1);
    }
    if (data->first && !flat)
        imki_text_add(out, "\n%*s", INDENT * depth, "");
    imki_text_put_char(out, object ? '}' : ']');
}

/* 0.25, 1e-7, 2.0: a number always looks different from a count. */
static void put_digits(imki_text *out, double value)
{
    char text[40];
    snprintf(text, sizeof text, "%.17g", value);
    char *exponent = strchr(text, 'e');
    const char *digits = exponent ? exponent + 1 + strspn(exponent + 1, "+-0") : "";
    if (!exponent)
        imki_text_add(out, "%s%s", text, strchr(text, '.') ? "" : ".0");
    else
        imki_text_add(out, "%.*se%s%s", (int)(exponent - text), text, exponent[1] == '-' ? "-" : "",
                      digits);
}

/* The member with the next key in alphabetical order after `last`, or the first one. */
static const imki_data *next_by_key(const imki_data *data, const imki_data *last)
{
    const imki_data *next = NULL;
    for (const imki_data *member = data->first; member; member = member->next)
        if ((!last || strcmp(member->key, last->key) > 0) &&
            (!next || strcmp(member->key, next->key) < 0))
            next = member;
    return next;
}

static void put_in_order(imki_text *out, const imki_data *data)
{
    const bool object = data->kind == IMKI_DATA_OBJECT;
    if (data->kind == IMKI_DATA_NUMBER)
        put_digits(out, data->value.number);
    else if (!is_container(data))
        put_scalar(out, data);
    if (!is_container(data))
        return;
    imki_text_put_char(out, object ? '{' : '[');
    const imki_data *first = object ? next_by_key(data, NULL) : data->first;
    for (const imki_data *member = first; member;
         member = object ? next_by_key(data, member) : member->next) {
        imki_text_put(out, member == first ? "" : ",");
        if (object) {
            imki_markup_quote(out, member->key);
            imki_text_put_char(out, ':');
        }
        put_in_order(out, member);
    }
    imki_text_put_char(out, object ? '}' : ']');
}

static imk_status write(const imk_result *result, bool in_order, char **text, size_t *size)
{
    imki_text out = {.bytes = NULL};
    if (!result || result->arena.failed)
        return IMK_ERROR_MEMORY;
    if (in_order)
        put_in_order(&out, &result->root);
    else
        put(&out, &result->root, 0);
    imki_text_put(&out, in_order ? "" : "\n");
    char *made = imki_text_take(&out, size);
    if (!made)
        return IMK_ERROR_MEMORY;
    *text = made;
    return IMK_OK;
}

imk_status imk_result_to_json(const imk_result *result, char **text, size_t *size)
{
    return write(result, false, text, size);
}

imk_status imk_result_to_key(const imk_result *result, char **text, size_t *size)
{
    return write(result, true, text, size);
}
