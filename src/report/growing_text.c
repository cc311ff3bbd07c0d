/* SPDX-License-Identifier: Apache-2.0 */
/* Text that grows in memory. A failed allocation is remembered, so that callers need not check
 * after every word. */
#include "growing_text_internal.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Is there room for so many more bytes and a zero? */
static bool make_room(imki_text *text, size_t more)
{
    const size_t needed = text->size + more + 1;
    if (text->failed || needed <= text->capacity)
        return !text->failed;
    const size_t capacity = needed > 2 * text->capacity ? needed + 4096 : 2 * text->capacity;
    char *grown = realloc(text->bytes, capacity);
    text->failed = !grown;
    if (!grown)
        return false;
    text->bytes = grown;
    text->capacity = capacity;
    return true;
}

void imki_text_put_bytes(imki_text *text, const char *bytes, size_t size)
{
    if (!make_room(text, size))
        return;
    if (size > 0)
        memcpy(text->bytes + text->size, bytes, size);
    text->size += size;
    text->bytes[text->size] = '\0';
}

void imki_text_put(imki_text *text, const char *words)
{
    imki_text_put_bytes(text, words, strlen(words));
}

void imki_text_put_char(imki_text *text, char letter)
{
    imki_text_put_bytes(text, &letter, 1);
}

void imki_text_add(imki_text *text, const char *format, ...)
{
    size_t due = 255; /* nearly all are shorter */
    while (make_room(text, due)) {
        va_list arguments;
        va_start(arguments, format);
        const int length = vsnprintf(text->bytes + text->size, due + 1, format, arguments);
        va_end(arguments);
        text->failed = length < 0;
        if (length >= 0 && (size_t)length <= due) {
            text->size += (size_t)length;
            return;
        }
        due = length > 0 ? (size_t)length : 0;
    }
}

char *imki_text_take(imki_text *text, size_t *size)
{
    if (!make_room(text, 0)) {
        free(text->bytes);
        return NULL;
    }
    text->bytes[text->size] = '\0';
    *size = text->size;
    return text->bytes;
}
