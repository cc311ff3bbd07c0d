/* SPDX-License-Identifier: Apache-2.0 */
/* Names are compared by the places that they lead to: the folders and links of a path are followed
 * as far as they exist, and files that exist are compared by their numbers too, for two of them may
 * be one (hard links). */
#define _XOPEN_SOURCE 700
#include "file_clash.h"

#include "command.h"

#include "imukit/log.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* ---- places ---------------------------------------------------------------------------------- */

enum { LINKS_MAX = 40 }; /* as Linux itself follows */

/* Move the last part of a path, with a slash before it, in front of `rest`. The path is empty when
 * all parts have been moved. */
static bool move_last_part(char path[PATH_MAX], char rest[PATH_MAX])
{
    size_t end = strlen(path);
    while (end > 1 && path[end - 1] == '/')
        path[--end] = '\0';
    const char *slash = strrchr(path, '/');
    const char *part = slash ? slash + 1 : path;
    const size_t size = strlen(part), behind = strlen(rest);
    if (size + behind + 2 > PATH_MAX)
        return false;
    memmove(rest + size + 1, rest, behind + 1);
    rest[0] = '/';
    memcpy(rest + 1, part, size);
    const size_t kept = slash ? (size_t)(slash - path) + (slash == path) : 0;
    path[kept] = '\0';
    return size > 0;
}

/* Put the target of a link in its place. */
static bool follow_link(char path[PATH_MAX])
{
    char link[PATH_MAX];
    const ssize_t length = readlink(path, link, sizeof link);
    const char *slash = strrchr(path, '/');
    if (length <= 0)
        return false;
    const size_t folder = link[0] == '/' || !slash ? 0 : (size_t)(slash - path) + 1;
    if (folder + (size_t)length >= PATH_MAX)
        return false;
    memcpy(path + folder, link, (size_t)length);
    path[folder + (size_t)length] = '\0';
    return true;
}

/* Where a name leads: the real path of what exists of it, and the rest as it stands.
 * @return from malloc(); NULL when the name is too long, or memory is exhausted: such a name is
 *         refused when it is opened */
static char *place_of(const char *name)
{
    char path[PATH_MAX], real[PATH_MAX], rest[PATH_MAX] = "";
    const size_t length = strlen(name);
    if (length >= sizeof path)
        return NULL;
    memcpy(path, name, length + 1);
    for (int links = 0; !realpath(*path ? path : ".", real);) {
        if (links < LINKS_MAX && follow_link(path))
            links++;
        else if (!move_last_part(path, rest))
            return NULL;
    }
    const size_t size = strlen(real) + strlen(rest) + 1;
    char *place = malloc(size);
    if (place)
        snprintf(place, size, "%s%s", strcmp(real, "/") == 0 && *rest ? "" : real, rest);
    return place;
}

bool file_is_in(const char *path, const char *folder)
{
    char *place = place_of(path), *around = place_of(folder);
    char *slash = place ? strrchr(place, '/') : NULL;
    if (slash)
        *slash = '\0';
    const bool is_in = slash && around && strcmp(place, around) == 0;
    free(place);
    free(around);
    return is_in;
}

/* ---- the files of a run ---------------------------------------------------------------------- */

/* A name by which the run reads or writes a file. */
typedef struct run_file {
    const char *option; /* NULL: an operand */
    const char *given;  /* as it stands on the command line */
    char *name;         /* the same, or a file that comes with it */
    char *place;        /* NULL: not to be compared */
    option_kind kind;   /* OPTION_OUTPUT: written */
} run_file;

typedef struct run_files {
    run_file *file;
    size_t count, capacity;
    bool exhausted;
} run_files;

static void add_name(run_files *files, const char *taker, const char *given, const char *ending,
                     option_kind kind)
{
    if (files->count == files->capacity) {
        const size_t capacity = 2 * files->capacity + 16;
        run_file *more = realloc(files->file, capacity * sizeof *more);
        if (!more) {
            files->exhausted = true;
            return;
        }
        files->file = more;
        files->capacity = capacity;
    }
    const size_t size = strlen(given) + strlen(ending) + 1;
    char *name = malloc(size);
    if (!name) {
        files->exhausted = true;
        return;
    }
    snprintf(name, size, "%s%s", given, ending);
    files->file[files->count++] = (run_file){taker, given, name, place_of(name), kind};
}

/* A file, and those that are read or written with it. */
static void add(run_files *files, const char *taker, const char *given, option_kind kind)
{
    if (!given || !*given || strcmp(given, "-") == 0 || strcmp(given, "term") == 0)
        return;
    add_name(files, taker, given, "", kind);
    const char *companion = imk_log_format_of(given)->companion;
    if (companion)
        add_name(files, taker, given, companion, kind);
}

static void add_all(run_files *files, const verb *v, const void *settings,
                    const char *const *operands)
{
    size_t count = 0;
    while (count < v->operands_maximum && operands[count])
        count++;
    for (size_t i = 0; i < count; i++)
        add(files, NULL, operands[i],
            v->last_is_written && i + 1 == count ? OPTION_OUTPUT : OPTION_FILE);
    for (size_t g = 0; g < GROUPS_MAX; g++)
        for (size_t i = 0; i < v->groups[g].count; i++) {
            const option *o = &v->groups[g].options[i];
            const void *at = (const char *)settings + v->groups[g].offset + o->offset;
            if (o->kind == OPTION_FILE || o->kind == OPTION_INTO || o->kind == OPTION_OUTPUT)
                add(files, o->name, *(const char *const *)at, o->kind);
        }
}

/* Devices may serve twice. */
static bool is_same(const run_file *a, const run_file *b)
{
    struct stat one, other;
    if (stat(a->name, &one) == 0 && stat(b->name, &other) == 0)
        return S_ISREG(one.st_mode) && one.st_dev == other.st_dev && one.st_ino == other.st_ino;
    return a->place && b->place && strcmp(a->place, b->place) == 0;
}

/* The model that receives the results may be the file that is written. */
static bool may_replace(const run_file *written, const run_file *read)
{
    return read->kind == OPTION_INTO && written->option && strcmp(written->option, "output") == 0;
}

static int tell(const run_file *written, const run_file *other)
{
    const char *dashes = written->option ? "--" : "";
    const char *name = written->option ? written->option : "";
    if (other->kind == OPTION_OUTPUT)
        return command_misused("--%s and --%s both write %s: give another name", name,
                               other->option, written->name);
    if (strcmp(written->name, written->given) != 0)
        return command_misused("%s%s%s%s comes with %s, which would overwrite what is read: give "
                               "another name",
                               dashes, name, *name ? " " : "", written->given, written->name);
    return command_misused("%s%s%s%s would overwrite what is read: give another name", dashes, name,
                           *name ? " " : "", written->given);
}

static int find_clash(const run_files *files)
{
    for (size_t i = 0; i < files->count; i++)
        for (size_t k = 0; k < files->count; k++) {
            const run_file *one = &files->file[i], *other = &files->file[k];
            const bool both = other->kind == OPTION_OUTPUT;
            const bool to_compare = one->kind == OPTION_OUTPUT && one->given != other->given &&
                                    (!both || i > k) && !may_replace(one, other);
            if (to_compare && is_same(other, one))
                return tell(both ? other : one, both ? one : other);
        }
    return -1;
}

static int find_repeated(const run_files *files)
{
    for (size_t i = 0; i < files->count; i++)
        for (size_t k = 0; k < i; k++) {
            const run_file *one = &files->file[i], *other = &files->file[k];
            if (!one->option && !other->option && one->given != other->given && is_same(one, other))
                return command_misused("%s is given twice: its readings would count as those of "
                                       "two logs",
                                       one->given);
        }
    return -1;
}

int file_clash(const verb *v, const void *settings, const char *const *operands)
{
    run_files files = {0};
    add_all(&files, v, settings, operands);
    int code = files.exhausted ? command_failed("memory is exhausted") : find_clash(&files);
    if (code < 0 && v->all_are_evidence)
        code = find_repeated(&files);
    for (size_t i = 0; i < files.count; i++) {
        free(files.file[i].name);
        free(files.file[i].place);
    }
    free(files.file);
    return code;
}
