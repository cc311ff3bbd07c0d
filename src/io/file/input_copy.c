/* SPDX-License-Identifier: Apache-2.0 */
/* Copies of inputs that cannot be read twice, in files without a name: they are gone with the
 * process, however it ends. An input is known by its device and inode, which do not depend on the
 * name it is opened by. */
#define _GNU_SOURCE /* memrchr() */
#include "input_copy_internal.h"

#include "imukit/log.h"
#include "io/log/log_text_internal.h"
#include "nameless_file_internal.h"
#include "system_error_internal.h"
#include "text_file_internal.h"

#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum {
    BLOCK = 1 << 16,
    LOOK = 4096 /* bytes looked at to tell a text */
};

typedef struct copy {
    dev_t device;
    ino_t inode;
    int file;          /* -1: it could not be made */
    imk_error failure; /* why not: part of the input is lost, and whoever opens it is to know */
    struct copy *next;
} copy;

static pthread_mutex_t mutex = PTHREAD_MUTEX_INITIALIZER;
static copy *copies;

static imk_status refuse(const char *path, int number, imk_error *error)
{
    imk_error reason;
    char found[sizeof reason.found];
    (void)imki_system_error(&reason, IMK_ERROR_WRITE, "", number);
    snprintf(found, sizeof found, "its temporary copy cannot be written: %.55s", reason.found);
    return imk_error_set(error, IMK_ERROR_WRITE, path, found,
                         "set TMPDIR to a folder with room, or give a file instead of a pipe");
}

/* @return 0 or an errno value */
static int write_all(int file, const char *bytes, size_t size)
{
    while (size > 0) {
        const ssize_t count = write(file, bytes, size);
        if (count < 0 && errno != EINTR)
            return errno;
        if (count > 0) {
            bytes += count;
            size -= (size_t)count;
        }
    }
    return 0;
}

/* Fill a block unless the input ends before. @return -1 with errno */
static ssize_t read_block(int file, char *block)
{
    size_t size = 0;
    while (size < BLOCK) {
        const ssize_t count = read(file, block + size, BLOCK - size);
        if (count == 0)
            break;
        if (count < 0 && errno != EINTR)
            return -1;
        size += count > 0 ? (size_t)count : 0;
    }
    return (ssize_t)size;
}

/* What an input that may have no end is known by, so that it does not fill the disk. */
typedef struct seen {
    imki_known_bytes *known;
    const void *context;
    bool text;
    size_t line; /* bytes since the last line feed */
} seen;

/* The first block: text, or one of the other forms that inputs have. UTF-16 is left to the reader,
 * which tells how to convert it. */
static imk_status look_at_begin(seen *s, const char *block, size_t size, const char *path,
                                imk_error *error)
{
    static const char *const others[] = {"\x1F\x8B", "\x28\xB5\x2F\xFD", "\xFF\xFE", "\xFE\xFF"};
    for (size_t i = 0; i < sizeof others / sizeof others[0]; i++)
        if (size >= strlen(others[i]) && memcmp(block, others[i], strlen(others[i])) == 0)
            return IMK_OK;
    /* A skippable frame of zstd. */
    if (size >= 4 && (block[0] & 0xF0) == 0x50 && memcmp(block + 1, "\x2A\x4D\x18", 3) == 0)
        return IMK_OK;
    if (imk_log_format_begun(block, size) || (s->known && s->known(s->context, block, size)))
        return IMK_OK;
    s->text = imki_is_text(block, size < LOOK ? size : LOOK);
    if (s->text)
        return IMK_OK;
    return imk_error_set(error, IMK_ERROR_FORMAT, path,
                         "this is neither text nor a log that is read without a file, nor packed "
                         "by gzip or zstd",
                         "");
}

static imk_status look_at_line(seen *s, const char *block, size_t size, const char *path,
                               imk_error *error)
{
    const char *feed = memrchr(block, '\n', size);
    s->line = feed ? (size_t)(block + size - feed - 1) : s->line + size;
    return s->line <= IMKI_LINE_MAX
               ? IMK_OK
               : imk_error_set(error, IMK_ERROR_FORMAT, path, "a line is longer than 1 MiB",
                               "a text file with shorter lines");
}

static imk_status copy_all(int from, int to, const char *path, seen s, imk_error *error)
{
    char block[BLOCK];
    for (bool first = true;; first = false) {
        const ssize_t count = read_block(from, block);
        if (count < 0)
            return imki_system_error(error, IMK_ERROR_READ, path, errno);
        if (count == 0)
            return IMK_OK;
        imk_status status = IMK_OK;
        if (first)
            status = look_at_begin(&s, block, (size_t)count, path, error);
        if (status == IMK_OK && s.text)
            status = look_at_line(&s, block, (size_t)count, path, error);
        if (status != IMK_OK)
            return status;
        const int number = write_all(to, block, (size_t)count);
        if (number != 0)
            return refuse(path, number, error);
    }
}

imk_status imki_copy_make(const struct stat *about, int file, const char *path,
                          imki_known_bytes *known, const void *context, imk_error *error)
{
    copy *made = malloc(sizeof *made);
    if (!made)
        return imk_error_set(error, IMK_ERROR_MEMORY, path, "", "");
    *made = (copy){.device = about->st_dev, .inode = about->st_ino, .file = imki_open_nameless()};
    const imk_status status =
        made->file < 0
            ? refuse(path, errno, &made->failure)
            : copy_all(file, made->file, path, (seen){known, context, false, 0}, &made->failure);
    if (status != IMK_OK) {
        if (made->file >= 0)
            close(made->file);
        made->file = -1;
        if (error)
            *error = made->failure;
    }
    pthread_mutex_lock(&mutex);
    made->next = copies;
    copies = made;
    pthread_mutex_unlock(&mutex);
    return status;
}

/* What is found, taken out of the list unless it is kept. */
static imk_status use(copy **place, bool kept, int *file, imk_error *error)
{
    copy *found = *place;
    const imk_status status = found->failure.status;
    if (status != IMK_OK && error)
        *error = found->failure;
    if (status == IMK_OK)
        *file = kept ? fcntl(found->file, F_DUPFD_CLOEXEC, 0) : found->file;
    if (!kept) {
        *place = found->next;
        free(found);
    }
    return status;
}

imk_status imki_copy_open(const struct stat *about, bool kept, int *file, imk_error *error)
{
    imk_status status = IMK_OK;
    *file = -1;
    pthread_mutex_lock(&mutex);
    copy **place = &copies;
    while (*place && ((*place)->device != about->st_dev || (*place)->inode != about->st_ino))
        place = &(*place)->next;
    if (*place)
        status = use(place, kept, file, error);
    pthread_mutex_unlock(&mutex);
    return status;
}

imk_status imki_nameless_write(int file, const char *bytes, size_t size, const char *path,
                               imk_error *error)
{
    const int number = file < 0 ? errno : write_all(file, bytes, size);
    return number == 0 ? IMK_OK : refuse(path, number, error);
}
