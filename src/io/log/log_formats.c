/* SPDX-License-Identifier: Apache-2.0 */
/* The formats of logs by their names and by how their files begin. */
#include "imukit/log.h"

#include "imukit/names.h"
#include "log_formats_internal.h"

#include <stdio.h>
#include <string.h>

#define ROW(functions, ...) {__VA_ARGS__},
static const imk_log_format formats[] = {IMKI_LOG_FORMATS(ROW)};
#undef ROW

enum { FORMATS = sizeof formats / sizeof formats[0] };

const imk_log_format *imk_log_format_get(size_t index)
{
    return index < FORMATS ? &formats[index] : NULL;
}

/* @param endings  with blanks between */
static bool ends_in(const char *path, const char *endings)
{
    static const char *const compressed[] = {"", ".gz", ".zst"};
    char ending[32];
    for (const char *at = endings; *at; at += strspn(at, " ")) {
        const size_t length = strcspn(at, " ");
        for (size_t i = 0; i < sizeof compressed / sizeof compressed[0]; i++) {
            snprintf(ending, sizeof ending, "%.*s%s", (int)length, at, compressed[i]);
            if (imk_has_ending(path, ending))
                return true;
        }
        at += length;
    }
    return false;
}

const imk_log_format *imk_log_format_of(const char *path)
{
    for (size_t i = 1; i < FORMATS; i++)
        if (ends_in(path, formats[i].endings))
            return &formats[i];
    return &formats[0];
}

const imk_log_format *imk_log_format_begun(const char *begin, size_t size)
{
    for (size_t i = 1; i < FORMATS; i++) {
        const char *due = formats[i].beginning;
        if (due && size >= strlen(due) && memcmp(begin, due, strlen(due)) == 0)
            return &formats[i];
    }
    return NULL;
}

const imk_log_format *imk_log_format_named(const char *name)
{
    for (size_t i = 0; i < FORMATS; i++)
        if (strcmp(formats[i].name, name) == 0)
            return &formats[i];
    return NULL;
}

const char *imk_log_formats_text(const char *last, bool written, size_t size, char *text)
{
    const char *title[FORMATS];
    size_t count = 0, used = 0;
    for (size_t i = 1; i < FORMATS; i++)
        if (formats[i].written || !written)
            title[count++] = formats[i].title;
    text[0] = '\0';
    for (size_t i = 0; i < count && used < size; i++)
        used += (size_t)snprintf(text + used, size - used, "%s%s", i + 1 < count ? ", " : last,
                                 title[i]);
    return text;
}
