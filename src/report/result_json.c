/* SPDX-License-Identifier: Apache-2.0 */
/* The data of a result as JSON [RFC8259]. An object of few plain values, such as a quantity, goes
 * on one line. */
#include "growing_text_internal.h"
#include "result_internal.h"

#include "imukit/decimal.h"

enum { FLAT_MOST = 6, INDENT = 2 };

static void put_text(imki_text *out, const char *text)
{
    static const char short_forms[] = "\"\\\b\f\n\r\t", letters[] = "\"\\bfnrt";
    imki_text_put_char(out, '"');
    for (const char *c = text; *c; c++) {
        size_t k = 0;
        while (short_forms[k] && short_forms[k] != *c)
            k++;
        if (short_forms[k])
            imki_text_put_bytes(out, (const char[]){'\\', letters[k]}, 2);
        else if ((unsigned char)*c < 0x20)
            imki_text_add(out, "\\u%04X", (unsigned)*c);
        else
            imki_text_put_char(out, *c);
    }
    imki_text_put_char(out, '"');
}

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
        put_text(out, data->value.text);
        break;
    case IMKI_DATA_FLAG:
        imki_text_put(out, data->value.flag ? "true" : "false");
        break;
    default:
        imki_text_put(out, "null");
    }
}

/* What stands before a member: a comma, and a new line unless its object is on one. */
static void put_separator(imki_text *out, const imki_data *member, bool flat, int depth)
{
    const bool first = member->parent->first == member;
    if (flat)
        imki_text_put(out, first ? "" : ", ");
    else
        imki_text_add(out, "%s\n%*s", first ? "" : ",", INDENT * (depth + 1), "");
    if (member->key) {
        put_text(out, member->key);
        imki_text_put(out, ": ");
    }
}

/* Trees are as deep as the code that makes them nests. */
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

imk_status imk_result_to_json(const imk_result *result, char **text, size_t *size)
{
    imki_text out = {.bytes = NULL};
    if (!result || result->arena.failed)
        return IMK_ERROR_MEMORY;
    put(&out, &result->root, 0);
    imki_text_put_char(&out, '\n');
    char *made = imki_text_take(&out, size);
    if (!made)
        return IMK_ERROR_MEMORY;
    *text = made;
    return IMK_OK;
}
