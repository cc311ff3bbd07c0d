/* SPDX-License-Identifier: Apache-2.0 */
#include "log_words_internal.h"

#include "base/text_internal.h"

#include <string.h>

static bool is_upper(char c)
{
    return c >= 'A' && c <= 'Z';
}

static bool is_small(char c)
{
    return c >= 'a' && c <= 'z';
}

static bool is_figure(char c)
{
    return c >= '0' && c <= '9';
}

/* Does a word begin at a character although no sign stands before it? "gyroX", "IMUGyro". */
static bool turns(const char *name, const char *at)
{
    return at > name && is_upper(*at) &&
           (is_small(at[-1]) || is_figure(at[-1]) || (is_upper(at[-1]) && is_small(at[1])));
}

static void end_word(imki_log_words *w, size_t *length)
{
    if (*length > 0)
        w->word[w->count++][*length] = '\0';
    *length = 0;
}

void imki_log_words_divide(const char *name, imki_log_words *w)
{
    size_t length = 0;
    *w = (imki_log_words){.count = 0};
    for (const char *c = name; *c; c++) {
        const bool sign =
            (unsigned char)*c < 0x80 && !is_upper(*c) && !is_small(*c) && !is_figure(*c);
        if (sign || turns(name, c))
            end_word(w, &length);
        if (sign)
            continue;
        if (w->count == IMKI_LOG_WORDS_MOST || length + 1 == IMKI_LOG_WORD_SIZE) {
            w->overflow = true;
            return;
        }
        w->word[w->count][length++] = imki_lower(*c);
    }
    end_word(w, &length);
}

size_t imki_log_words_match(const imki_log_words *w, size_t first, size_t end, const char *phrase)
{
    size_t count = 0;
    for (const char *at = phrase; *at; count++) {
        const size_t length = strcspn(at, " ");
        if (first + count >= end || strlen(w->word[first + count]) != length ||
            memcmp(w->word[first + count], at, length) != 0)
            return 0;
        at += length;
        at += *at == ' ';
    }
    return count;
}

bool imki_log_words_are(const imki_log_words *w, size_t first, size_t end, const char *phrase)
{
    return end > first && imki_log_words_match(w, first, end, phrase) == end - first;
}
