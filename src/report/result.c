/* SPDX-License-Identifier: Apache-2.0 */
/* The data of a result: a tree of named values. */
#include "result_internal.h"

#include "imukit/utf8.h"

#include <math.h>
#include <stdarg.h>

imk_result *imk_result_create(const imk_allocator *allocator)
{
    imki_arena arena = {.allocator = allocator ? *allocator : (imk_allocator){0}};
    imk_result *result = imki_arena_take(&arena, sizeof *result);
    if (!result)
        return NULL;
    result->arena = arena;
    result->open = &result->root;
    result->audience = IMK_FOR_BOTH;
    return result;
}

void imk_result_free(imk_result *result)
{
    if (!result)
        return;
    imki_arena arena = result->arena; /* which holds the result itself */
    imki_arena_free(&arena);
}

static imki_data *add(imk_result *result, imki_data_kind kind, const char *key)
{
    imki_data *made = result ? imki_arena_take(&result->arena, sizeof *made) : NULL;
    if (!made)
        return NULL;
    imki_data *parent = result->open;
    *made = (imki_data){.kind = kind, .key = key, .parent = parent};
    if (parent->last)
        parent->last->next = made;
    else
        parent->first = made;
    parent->last = made;
    parent->size++;
    return made;
}

void imk_result_object(imk_result *result, const char *key)
{
    imki_data *made = add(result, IMKI_DATA_OBJECT, key);
    if (made)
        result->open = made;
}

void imk_result_array(imk_result *result, const char *key)
{
    imki_data *made = add(result, IMKI_DATA_ARRAY, key);
    if (made)
        result->open = made;
}

void imk_result_end(imk_result *result)
{
    /* After memory was exhausted, the object or array to end may never have begun. */
    if (result && result->open->parent)
        result->open = result->open->parent;
}

void imk_result_usability(imk_result *result, imk_usability usability, const char *sentence)
{
    static const char *const grades[] = {"usable", "usable with care", "not usable"};
    imk_result_object(result, "usability");
    imk_result_text(result, "grade", grades[usability]);
    imk_result_text(result, "sentence", sentence);
    imk_result_end(result);
}

void imk_result_judge(imk_result *result, imk_usability usability, const char *format, ...)
{
    if (!result)
        return;
    va_list arguments;
    va_start(arguments, format);
    result->judgement = imki_arena_format(&result->arena, format, arguments);
    va_end(arguments);
    result->usability = usability;
    imk_result_usability(result, usability, result->judgement);
}

const char *imk_result_key(imk_result *result, const char *format, ...)
{
    if (!result)
        return "";
    va_list arguments;
    va_start(arguments, format);
    const char *key = imki_arena_format(&result->arena, format, arguments);
    va_end(arguments);
    return key;
}

void imk_result_number(imk_result *result, const char *key, double value)
{
    imki_data *made = add(result, isfinite(value) ? IMKI_DATA_NUMBER : IMKI_DATA_NULL, key);
    if (made)
        made->value.number = value;
}

void imk_result_count(imk_result *result, const char *key, long long value)
{
    imki_data *made = add(result, IMKI_DATA_COUNT, key);
    if (made)
        made->value.count = value;
}

void imk_result_text(imk_result *result, const char *key, const char *text)
{
    imki_data *made = add(result, text ? IMKI_DATA_TEXT : IMKI_DATA_NULL, key);
    if (!made || !text)
        return;
    const size_t size = imk_utf8_clean(text, NULL, 0) + 1;
    char *clean = imki_arena_take(&result->arena, size);
    if (clean)
        imk_utf8_clean(text, clean, size);
    made->value.text = clean ? clean : "";
}

void imk_result_flag(imk_result *result, const char *key, bool value)
{
    imki_data *made = add(result, IMKI_DATA_FLAG, key);
    if (made)
        made->value.flag = value;
}

void imk_result_null(imk_result *result, const char *key)
{
    (void)add(result, IMKI_DATA_NULL, key);
}

void imk_result_quantity(imk_result *result, const char *key, double value, const char *unit)
{
    imk_result_object(result, key);
    imk_result_number(result, "value", value);
    imk_result_text(result, "unit", unit);
    imk_result_end(result);
}

void imk_result_numbers(imk_result *result, const char *key, size_t count, const double *values)
{
    imk_result_array(result, key);
    for (size_t i = 0; i < count; i++)
        imk_result_number(result, NULL, values[i]);
    imk_result_end(result);
}
