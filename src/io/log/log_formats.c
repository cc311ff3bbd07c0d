/* SPDX-License-Identifier: Apache-2.0 */
/* The formats of logs by their names and by how their files begin. */
#define _POSIX_C_SOURCE 200809L
#include "imukit/log.h"

#include "base/text_internal.h"
#include "imukit/names.h"
#include "log_formats_internal.h"

#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

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

/* The ending of a name, without .gz and .zst. @return its length; 0: there is none */
static size_t find_ending(const char *path, const char **ending)
{
    const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path;
    size_t length = strlen(name);
    for (;;) {
        size_t at = length;
        while (at > 0 && name[at - 1] != '.')
            at--;
        if (at < 2) /* none, or a name that begins with a dot */
            return 0;
        *ending = name + at - 1;
        const size_t size = length - at + 1;
        const bool packed = (size == 3 && strncmp(*ending, ".gz", 3) == 0) ||
                            (size == 4 && strncmp(*ending, ".zst", 4) == 0);
        if (!packed)
            return size;
        length = at - 1;
    }
}

static bool is_text_ending(const char *ending, size_t length)
{
    char lower[8] = "";
    for (size_t i = 0; i < length && i + 1 < sizeof lower; i++)
        lower[i] = imki_lower(ending[i]);
    return length + 1 < sizeof lower && ends_in(lower, formats[0].endings);
}

static imk_status refuse_ending(const char *path, const char *ending, size_t length,
                                imk_error *error)
{
    char found[96], expected[160] = "name it in ";
    snprintf(found, sizeof found, "no log is written to a file with the ending %.*s",
             length < 24 ? (int)length : 24, ending);
    for (size_t i = 0; i < FORMATS; i++)
        if (formats[i].written) {
            imki_append_text(expected, sizeof expected, i > 0 ? " " : "");
            imki_append_text(expected, sizeof expected, formats[i].endings);
        }
    imki_append_text(expected, sizeof expected, " (lower case)");
    return imk_error_set(error, IMK_ERROR_UNSUPPORTED, path, found, expected);
}

imk_status imk_log_format_written(const char *path, const imk_log_format **format, imk_error *error)
{
    struct stat about;
    const char *ending = "";
    *format = imk_log_format_of(path);
    if (!path || strcmp(path, "-") == 0 ||
        (*format == &formats[0] && stat(path, &about) == 0 && !S_ISREG(about.st_mode) &&
         !S_ISDIR(about.st_mode)))
        return IMK_OK;
    const size_t length = find_ending(path, &ending);
    if (*format == &formats[0] && (length == 0 || is_text_ending(ending, length)))
        return IMK_OK;
    return *format != &formats[0] && (*format)->written
               ? IMK_OK
               : refuse_ending(path, ending, length, error);
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
