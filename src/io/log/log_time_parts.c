/* SPDX-License-Identifier: Apache-2.0 */
/* Times in two columns, as of the headers of ROS and of the timespec and timeval of POSIX: whole
 * seconds, and the nanoseconds or microseconds beyond them. */
#include "log_columns_internal.h"

#include "base/text_internal.h"

#include <stdio.h>
#include <string.h>

static const char *const wholes[] = {"sec", "secs", "seconds"};

static const struct {
    const char *word;
    int64_t ticks; /* [ns] of one */
} rests[] = {{"nsec", 1},         {"nsecs", 1},          {"nanosec", 1},  {"nanosecs", 1},
             {"nanoseconds", 1},  {"usec", 1000},        {"usecs", 1000}, {"microsec", 1000},
             {"microsecs", 1000}, {"microseconds", 1000}};

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

static bool is_whole(const char *word)
{
    for (size_t k = 0; k < COUNT(wholes); k++)
        if (strcmp(word, wholes[k]) == 0)
            return true;
    return false;
}

/* Is there a column that is the whole time, by an exact name? */
static bool has_time(const imki_log_piece *header, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        char text[48];
        imki_log_piece cell = header[i], unit;
        imki_log_unit_split(&cell, &unit);
        imki_log_piece_copy(text, sizeof text, cell);
        const imki_log_name name = imki_log_name_of(text);
        if (name.kind && name.kind->quantity == IMK_QUANTITY_TIME && name.exact)
            return true;
    }
    return false;
}

bool imki_log_time_parts_find(const imki_log_piece *header, size_t count,
                              imki_log_time_parts *parts)
{
    if (has_time(header, count))
        return false;
    for (size_t i = 0; i < count; i++) {
        char first[48], second[48];
        const char *word, *rest;
        divide(header[i], first, &word);
        if (!is_whole(word))
            continue;
        for (size_t k = 0; k < count; k++) {
            divide(header[k], second, &rest);
            if (word - first != rest - second || memcmp(first, second, (size_t)(word - first)) != 0)
                continue;
            for (size_t r = 0; r < COUNT(rests); r++)
                if (strcmp(rest, rests[r].word) == 0) {
                    *parts = (imki_log_time_parts){i, k, rests[r].ticks};
                    return true;
                }
        }
    }
    return false;
}

imk_status imki_log_time_parts_refuse(const imki_log_piece *header, size_t count, const char *map,
                                      imk_error *error)
{
    imki_log_time_parts parts;
    char found[160], first[40], second[40];
    if (map || !imki_log_time_parts_find(header, count, &parts))
        return IMK_OK;
    imki_log_piece name = header[parts.whole], rest = header[parts.rest], unit;
    imki_log_unit_split(&name, &unit);
    imki_log_unit_split(&rest, &unit);
    imki_log_piece_copy(first, sizeof first, name);
    imki_log_piece_copy(second, sizeof second, rest);
    const imki_log_name seconds = imki_log_name_of(first);
    if (!seconds.kind || seconds.kind->quantity != IMK_QUANTITY_TIME)
        return IMK_OK;
    snprintf(found, sizeof found, "%s is only the seconds of the time, and %s the rest of it",
             first, second);
    return imk_error_set(error, IMK_ERROR_COLUMN, "time", found,
                         "one column with the whole time; in a CSV text, whole seconds and whole "
                         "nanoseconds or microseconds beyond them are joined");
}
