/* SPDX-License-Identifier: Apache-2.0 */
/* Times in two columns, as of the headers of ROS and of the timespec and timeval of POSIX: whole
 * seconds, and the nanoseconds, microseconds or milliseconds beyond them. Beside minutes they are
 * those of a clock on the wall, which begin again with each of them, and no time. */
#include "log_columns_internal.h"

#include "base/text_internal.h"

#include <stdio.h>
#include <string.h>

static const struct {
    const char *word;
    int64_t ticks; /* [ns] of one; a second: of the whole */
    bool alone;    /* without a word before it, too */
} words[] = {{"sec", 1000000000, true},
             {"secs", 1000000000, true},
             {"seconds", 1000000000, true},
             {"s", 1000000000, false},
             {"nsec", 1, true},
             {"nsecs", 1, true},
             {"nanosec", 1, true},
             {"nanosecs", 1, true},
             {"nanoseconds", 1, true},
             {"ns", 1, false},
             {"usec", 1000, true},
             {"usecs", 1000, true},
             {"microsec", 1000, true},
             {"microsecs", 1000, true},
             {"microseconds", 1000, true},
             {"us", 1000, false},
             {"msec", 1000000, true},
             {"msecs", 1000000, true},
             {"millisec", 1000000, true},
             {"millisecs", 1000000, true},
             {"milliseconds", 1000000, true},
             {"ms", 1000000, false}};

static const int64_t second = 1000000000;

#define COUNT(array) (sizeof(array) / sizeof(array)[0])

static bool is_sign(char c)
{
    return c == '.' || c == '_' || c == ' ' || c == '/' || c == '-';
}

/* Divide "header.stamp.secs" before its last word. */
static void divide(imki_log_piece cell, char text[48], const char **word)
{
    imki_log_piece unit;
    imki_log_unit_split(&cell, &unit);
    imki_log_piece_copy(text, 48, cell);
    for (char *c = text; *c; c++)
        *c = imki_lower(*c);
    const char *at = text + strlen(text);
    while (at > text && !is_sign(at[-1]))
        at--;
    *word = at;
}

/* [ns] of one of what a column counts; 0: it is none of the two. */
static int64_t ticks_of(const char *text, const char *word)
{
    for (size_t k = 0; k < COUNT(words); k++)
        if (strcmp(word, words[k].word) == 0 && (words[k].alone || word > text))
            return words[k].ticks;
    return 0;
}

/* Are there minutes beside seconds of this beginning? */
static bool has_minutes(const imki_log_piece *header, size_t count, const char *begin, size_t size)
{
    static const char *const minutes[] = {"minute", "minutes", "min", "mins"};
    for (size_t i = 0; i < count; i++) {
        char text[48];
        const char *word;
        divide(header[i], text, &word);
        if ((size_t)(word - text) != size || memcmp(begin, text, size) != 0)
            continue;
        for (size_t k = 0; k < COUNT(minutes); k++)
            if (strcmp(word, minutes[k]) == 0)
                return true;
    }
    return false;
}

/* Is there a column that is the whole time, by an exact name, beside these two? */
static bool has_time(const imki_log_piece *header, size_t count, size_t whole, size_t rest)
{
    for (size_t i = 0; i < count; i++) {
        char text[48];
        imki_log_piece cell = header[i], unit;
        imki_log_unit_split(&cell, &unit);
        imki_log_piece_copy(text, sizeof text, cell);
        const imki_log_name name = imki_log_name_of(text);
        imk_unit own;
        if (i == whole || i == rest || !name.kind || name.kind->quantity != IMK_QUANTITY_TIME ||
            !name.exact)
            continue;
        /* "T [degC]" is none. */
        if (unit.begin == unit.end || imki_log_unit_read(unit, name.kind, &own, NULL) != IMK_OK ||
            imki_log_unit_fits(name.kind, &own))
            return true;
    }
    return false;
}

bool imki_log_time_parts_find(const imki_log_piece *header, size_t count,
                              imki_log_time_parts *parts)
{
    for (size_t i = 0; i < count; i++) {
        char first[48], other[48];
        const char *word, *rest;
        divide(header[i], first, &word);
        if (ticks_of(first, word) != second ||
            has_minutes(header, count, first, (size_t)(word - first)))
            continue;
        for (size_t k = 0; k < count; k++) {
            divide(header[k], other, &rest);
            if (word - first != rest - other || memcmp(first, other, (size_t)(word - first)) != 0)
                continue;
            const int64_t ticks = ticks_of(other, rest);
            if (ticks == 0 || ticks == second || has_time(header, count, i, k))
                continue;
            *parts = (imki_log_time_parts){i, k, ticks};
            return true;
        }
    }
    return false;
}

imk_status imki_log_time_parts_refuse(const imki_log_piece *header, size_t count, const char *map,
                                      imk_error *error)
{
    imki_log_time_parts parts;
    char found[160], first[40], second_name[40];
    if (map || !imki_log_time_parts_find(header, count, &parts))
        return IMK_OK;
    imki_log_piece name = header[parts.whole], rest = header[parts.rest], unit;
    imki_log_unit_split(&name, &unit);
    imki_log_unit_split(&rest, &unit);
    imki_log_piece_copy(first, sizeof first, name);
    imki_log_piece_copy(second_name, sizeof second_name, rest);
    const imki_log_name seconds = imki_log_name_of(first), beyond = imki_log_name_of(second_name);
    /* Two that are the whole time by their names are told as such. */
    if (!seconds.kind || seconds.kind->quantity != IMK_QUANTITY_TIME || beyond.kind)
        return IMK_OK;
    snprintf(found, sizeof found, "%s is only the seconds of the time, and %s the rest of it",
             first, second_name);
    return imk_error_set(error, IMK_ERROR_COLUMN, "time", found,
                         "one column with the whole time; in a CSV text, whole seconds and whole "
                         "nanoseconds, microseconds or milliseconds beyond them are joined");
}
