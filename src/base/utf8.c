/* SPDX-License-Identifier: Apache-2.0 */
/* Well-formed UTF-8, and what is made of the rest. */
#include "imukit/utf8.h"

#include <stdbool.h>
#include <string.h>

static bool is_continuation(char byte)
{
    return ((unsigned char)byte & 0xC0) == 0x80;
}

size_t imk_utf8_length(const char *text)
{
    static const struct {
        unsigned char first, last, second_from, second_to, length;
    } forms[] = {
        {0x01, 0x7F, 0, 0, 1},       {0xC2, 0xDF, 0x80, 0xBF, 2}, {0xE0, 0xE0, 0xA0, 0xBF, 3},
        {0xE1, 0xEC, 0x80, 0xBF, 3}, {0xED, 0xED, 0x80, 0x9F, 3}, {0xEE, 0xEF, 0x80, 0xBF, 3},
        {0xF0, 0xF0, 0x90, 0xBF, 4}, {0xF1, 0xF3, 0x80, 0xBF, 4}, {0xF4, 0xF4, 0x80, 0x8F, 4}};
    const unsigned char *c = (const unsigned char *)text;
    for (size_t i = 0; i < sizeof forms / sizeof forms[0]; i++) {
        if (c[0] < forms[i].first || c[0] > forms[i].last)
            continue;
        if (forms[i].length > 1 && (c[1] < forms[i].second_from || c[1] > forms[i].second_to))
            return 0;
        for (size_t j = 2; j < forms[i].length; j++)
            if ((c[j] & 0xC0) != 0x80)
                return 0;
        return forms[i].length;
    }
    return 0;
}

size_t imk_utf8_printable(const char *text)
{
    const unsigned char *c = (const unsigned char *)text;
    const bool control = c[0] < 0x20 || c[0] == 0x7F || (c[0] == 0xC2 && c[1] < 0xA0);
    return control ? 0 : imk_utf8_length(text);
}

size_t imk_utf8_clean(const char *text, char *target, size_t size)
{
    size_t whole = 0, used = 0;
    bool full = size == 0;
    while (*text) {
        const size_t found = imk_utf8_length(text);
        const char *piece = found > 0 ? text : IMK_UTF8_REPLACEMENT;
        const size_t length = found > 0 ? found : sizeof IMK_UTF8_REPLACEMENT - 1;
        full = full || used + length >= size;
        if (!full) {
            memcpy(target + used, piece, length);
            used += length;
        }
        whole += length;
        text += found > 0 ? found : 1;
    }
    if (size > 0)
        target[used] = '\0';
    return whole;
}

void imk_utf8_shorten(const char *text, char *target, size_t size)
{
    static const char ellipsis[] = "\xE2\x80\xA6";
    const size_t length = strlen(text), mark = sizeof ellipsis - 1;
    if (length < size) {
        memcpy(target, text, length + 1);
        return;
    }
    const size_t room = size > mark + 1 ? size - mark - 1 : 0;
    size_t head = room / 3, tail = length - (room - head);
    while (head > 0 && is_continuation(text[head]))
        head--;
    while (is_continuation(text[tail]))
        tail++;
    memcpy(target, text, head);
    memcpy(target + head, ellipsis, room > 0 ? mark : 0);
    memcpy(target + head + (room > 0 ? mark : 0), text + tail, length - tail + 1);
}
