/* SPDX-License-Identifier: Apache-2.0 */
/* Directions of a log's axes in words, mapped to forward-right-down. */
#include "log_reader_internal.h"

#include <stdio.h>
#include <string.h>

static const struct {
    const char *name;
    int body;
    double sign;
} directions[] = {{"forward", 0, 1.0}, {"backward", 0, -1.0}, {"right", 1, 1.0},
                  {"left", 1, -1.0},   {"down", 2, 1.0},      {"up", 2, -1.0}};

static int find_direction(const char *begin, size_t length)
{
    for (size_t i = 0; i < sizeof directions / sizeof directions[0]; i++)
        if (strlen(directions[i].name) == length && memcmp(directions[i].name, begin, length) == 0)
            return (int)i;
    return -1;
}

imk_status imki_log_axes_parse(const char *text, int body[3], double sign[3], imk_error *error)
{
    const char *due = "three of forward, backward, right, left, down, up, as in "
                      "--axes right-forward-up";
    const char *p = text;
    for (int i = 0; i < 3; i++) {
        const size_t length = strcspn(p, "-,");
        const int found = find_direction(p, length);
        if (found < 0 || (p[length] == '\0') != (i == 2))
            return imk_error_set(error, IMK_ERROR_SYNTAX, "axes", text, due);
        body[i] = directions[found].body;
        sign[i] = directions[found].sign;
        p += length + (i < 2);
    }
    char found[96];
    if (body[0] == body[1] || body[1] == body[2] || body[2] == body[0]) {
        snprintf(found, sizeof found, "\"%.40s\" has two directions along one line", text);
        return imk_error_set(error, IMK_ERROR_CONFLICT, "axes", found,
                             "three directions at right angles");
    }
    /* Even permutations of the axes are those with body[1] next after body[0]. */
    const double order = body[1] == (body[0] + 1) % 3 ? 1.0 : -1.0;
    if (order * sign[0] * sign[1] * sign[2] < 0.0) {
        snprintf(found, sizeof found, "\"%.40s\" is a left-handed set", text);
        return imk_error_set(error, IMK_ERROR_CONFLICT, "axes", found,
                             "a right-handed set: reverse one direction");
    }
    return IMK_OK;
}
