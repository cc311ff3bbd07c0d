/* SPDX-License-Identifier: Apache-2.0 */
/* The folder gnuplot or rsvg-convert runs in. Script or SVG, numbers and drawing have fixed names
 * in it: a name that begins with | or < is a command to gnuplot, so it sees none that the user or
 * the environment chose. */
#define _GNU_SOURCE /* nftw(), mkdtemp() */
#include "scratch_folder_internal.h"

#include "io/file/leftovers_internal.h"
#include "io/file/system_error_internal.h"

#include "imukit/utf8.h"

#include <ctype.h>
#include <errno.h>
#include <ftw.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

const char *const imki_scratch_names[IMKI_SCRATCH_FILES] = {"figure.in", "figure.dat", "figure.out",
                                                            "figure.err"};

static bool means_full(int number)
{
    return number == ENOSPC || number == EDQUOT;
}

/* ---- refusals -------------------------------------------------------------------------------- */

static const char *base_folder(void)
{
    const char *base = getenv("TMPDIR");
    return base && *base ? base : "/tmp";
}

imk_status imki_scratch_refuse_full(imk_error *error)
{
    char folder[64], field[sizeof error->field];
    imk_utf8_shorten(base_folder(), folder, sizeof folder);
    snprintf(field, sizeof field, "temporary folder %s", folder);
    return imk_error_set(error, IMK_ERROR_WRITE, field, "its disk is full",
                         "set TMPDIR to a folder with room");
}

static imk_status refuse(int number, imk_error *error)
{
    if (means_full(number))
        return imki_scratch_refuse_full(error);
    (void)imki_system_error(error, IMK_ERROR_OPEN, "temporary folder", number);
    if (error)
        snprintf(error->expected, sizeof error->expected,
                 "set TMPDIR to a folder that can be written");
    return IMK_ERROR_OPEN;
}

/* ---- the folder ------------------------------------------------------------------------------ */

static void release(imki_scratch *s)
{
    for (int i = 0; i < IMKI_SCRATCH_FILES; i++)
        free(s->file[i]);
    free(s->folder);
}

static int remove_entry(const char *path, const struct stat *about, int kind, struct FTW *place)
{
    (void)about;
    (void)kind;
    (void)place;
    remove(path);
    return 0;
}

/* The program, or what it has started, may have made files of its own. */
void imki_scratch_remove(imki_scratch *s)
{
    for (int i = 0; i < IMKI_SCRATCH_FILES; i++)
        unlink(s->file[i]);
    if (rmdir(s->folder) != 0 && (errno == ENOTEMPTY || errno == EEXIST))
        nftw(s->folder, remove_entry, 8, FTW_DEPTH | FTW_PHYS | FTW_MOUNT);
    for (int i = 0; i <= IMKI_SCRATCH_FILES; i++)
        imki_leftover_drop(s->slot[i]);
    release(s);
}

imk_status imki_scratch_make(imki_scratch *s, imk_error *error)
{
    static const char pattern[] = "/imukit-XXXXXX";
    const char *base = base_folder();
    const size_t size = strlen(base) + sizeof pattern;
    *s = (imki_scratch){.folder = malloc(size)};
    bool good = s->folder != NULL;
    for (int i = 0; i < IMKI_SCRATCH_FILES; i++)
        good = (s->file[i] = malloc(size + 1 + strlen(imki_scratch_names[i]))) && good;
    if (!good) {
        release(s);
        return imk_error_set(error, IMK_ERROR_MEMORY, "figure", NULL, NULL);
    }
    snprintf(s->folder, size, "%s%s", base, pattern);
    sigset_t before;
    imki_signals_hold(&before);
    const int number = mkdtemp(s->folder) ? 0 : errno;
    for (int i = 0; i < IMKI_SCRATCH_FILES && number == 0; i++) {
        snprintf(s->file[i], size + 1 + strlen(imki_scratch_names[i]), "%s/%s", s->folder,
                 imki_scratch_names[i]);
        s->slot[i] = imki_leftover_add(s->file[i]);
    }
    if (number == 0)
        s->slot[IMKI_SCRATCH_FILES] = imki_leftover_add(s->folder);
    imki_signals_release(&before);
    if (number == 0)
        return IMK_OK;
    release(s);
    return refuse(number, error);
}

/* ---- its files ------------------------------------------------------------------------------- */

/* @param mode  of fopen()
 * @return 0 or an errno value */
static int save(const char *path, const char *mode, const char *text, size_t size)
{
    FILE *file = fopen(path, mode);
    if (!file)
        return errno;
    int number = fwrite(text, 1, size, file) == size ? 0 : errno;
    if (fclose(file) != 0 && number == 0)
        number = errno;
    return number;
}

imk_status imki_scratch_save(const imki_scratch *s, imki_scratch_file which, const char *text,
                             size_t size, imk_error *error)
{
    const int number = save(s->file[which], "wb", text, size);
    return number == 0 ? IMK_OK : refuse(number, error);
}

int imki_scratch_load(const imki_scratch *s, imki_scratch_file which, char **text, size_t *size)
{
    FILE *file = fopen(s->file[which], "rb");
    struct stat about;
    if (!file)
        return errno;
    if (fstat(fileno(file), &about) != 0 || about.st_size == 0) {
        fclose(file);
        return ENOENT;
    }
    const size_t length = (size_t)about.st_size;
    char *whole = malloc(length + 1);
    const int number = !whole ? ENOMEM : fread(whole, 1, length, file) == length ? 0 : EIO;
    fclose(file);
    if (number != 0) {
        free(whole);
        return number;
    }
    whole[length] = '\0';
    *text = whole;
    *size = length;
    return 0;
}

void imki_scratch_last_line(const imki_scratch *s, imki_scratch_file which, char *line, size_t size)
{
    char text[1 << 10] = "";
    FILE *file = fopen(s->file[which], "rb");
    if (file) {
        if (fseek(file, 1 - (long)sizeof text, SEEK_END) != 0) /* it is shorter */
            rewind(file);
        text[fread(text, 1, sizeof text - 1, file)] = '\0';
        fclose(file);
    }
    size_t end = strlen(text);
    while (end > 0 && isspace((unsigned char)text[end - 1]))
        end--;
    text[end] = '\0';
    const char *newline = strrchr(text, '\n');
    const char *begin = newline ? newline + 1 : text;
    snprintf(line, size, "%s", begin + strspn(begin, " \t"));
}

/* A disk without room for this much has cut a drawing short, or soon will. */
bool imki_scratch_is_full(const imki_scratch *s)
{
    static const char block[1 << 16];
    return means_full(save(s->file[IMKI_SCRATCH_OUTPUT], "ab", block, sizeof block));
}
