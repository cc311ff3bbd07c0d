/* SPDX-License-Identifier: Apache-2.0 */
/* Text that grows in memory. What does not fit is remembered, so that nobody need look after every
 * word. */
#include "growing_text_internal.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void imki_text_add(imki_text *text, const char *format, ...)
{
    char piece[1024];
    va_list arguments;
    va_start(arguments, format);
    int length = vsnprintf(piece, sizeof piece, format, arguments);
    va_end(arguments);
    if (length < 0 || (size_t)length >= sizeof piece || text->failed) {
        text->failed = true;
        return;
    }
    size_t needed = text->size + (size_t)length + 1;
    if (needed > text->capacity) {
        size_t capacity = needed > 2 * text->capacity ? needed + 4096 : 2 * text->capacity;
        char *grown = realloc(text->bytes, capacity);
        text->failed = !grown;
        if (!grown)
            return;
        text->bytes = grown;
        text->capacity = capacity;
    }
    memcpy(text->bytes + text->size, piece, (size_t)length + 1);
    text->size += (size_t)length;
}
