/* SPDX-License-Identifier: Apache-2.0 */
/* Short texts in arrays. What does not fit is cut, never within a character of UTF-8. */
#ifndef IMUKIT_TEXT_INTERNAL_H
#define IMUKIT_TEXT_INTERNAL_H

#include <string.h>

static inline void imki_copy_text(char *text, size_t size, const char *from)
{
    size_t length = 0;
    for (; length + 1 < size && from[length]; length++)
        text[length] = from[length];
    while (length > 0 && ((unsigned char)from[length] & 0xC0) == 0x80)
        length--;
    text[length] = '\0';
}

static inline void imki_append_text(char *text, size_t size, const char *more)
{
    const size_t used = strlen(text);
    imki_copy_text(text + used, size - used, more);
}

/* Whatever the locale. */
static inline char imki_lower(char c)
{
    return (char)(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
}

#endif
