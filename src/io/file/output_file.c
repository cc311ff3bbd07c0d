/* SPDX-License-Identifier: Apache-2.0 */
/* Output files that appear complete or not at all: the bytes go to a temporary file in the same
 * directory, because rename() replaces a file in one step only within a file system, and it is
 * synced before the rename, because some file systems do the rename before the data otherwise.
 *
 * The first error is kept; everything after it is ignored until commit reports it. */
#define _POSIX_C_SOURCE 200809L
#include "output_file_internal.h"
#include "output_packing_internal.h"
#include "output_target_internal.h"
#include "system_error_internal.h"

#include "imukit/names.h"

#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum {
    BUFFER_SIZE = 1 << 20, /* few system calls, and still in the second-level cache */
    DIRECT_SIZE = 1 << 15, /* from here on a copy costs more than a call of its own */
    PRINT_SIZE = 4096
};

struct imk_output_file {
    imki_target target;
    imki_packing *packing; /* NULL: none */
    unsigned char *buffer; /* bytes to write to the file: compressed ones, if it is */
    size_t used;
    imk_status status;
    int system_error; /* errno of the first failure */
    bool prepared;
};

static imk_status fail(imk_output_file *file, int system_error)
{
    if (file->status == IMK_OK) {
        file->status = IMK_ERROR_WRITE;
        file->system_error = system_error;
    }
    return file->status;
}

/* write() until all is written. */
static imk_status write_all(imk_output_file *file, const unsigned char *bytes, size_t size)
{
    while (size > 0 && file->status == IMK_OK) {
        const ssize_t count = write(file->target.file, bytes, size);
        if (count < 0 && errno != EINTR)
            return fail(file, errno);
        if (count > 0) {
            bytes += count;
            size -= (size_t)count;
        }
    }
    return file->status;
}

static imk_status flush(imk_output_file *file)
{
    const size_t used = file->used;
    file->used = 0;
    return write_all(file, file->buffer, used);
}

static imk_status write_plain(imk_output_file *file, const unsigned char *bytes, size_t size)
{
    if (size >= DIRECT_SIZE) {
        flush(file);
        return write_all(file, bytes, size);
    }
    if (size > BUFFER_SIZE - file->used)
        flush(file);
    memcpy(file->buffer + file->used, bytes, size);
    file->used += size;
    return file->status;
}

/* last: nothing follows */
static imk_status write_packed(imk_output_file *file, const unsigned char *bytes, size_t size,
                               bool last)
{
    bool more;
    do {
        if (file->used == BUFFER_SIZE && flush(file) != IMK_OK)
            return file->status;
        const int number = imki_packing_step(file->packing, &bytes, &size, last, file->buffer,
                                             BUFFER_SIZE, &file->used, &more);
        if (number != 0)
            return fail(file, number);
    } while (more);
    return file->status;
}

static void release(imk_output_file *file)
{
    imki_packing_free(file->packing);
    free(file->buffer);
    free(file);
}

imk_status imki_output_file_check(const char *path, imk_error *error)
{
    const int number = imki_target_check(path);
    return number == 0 ? IMK_OK : imki_target_refuse(path, number, error);
}

imk_status imk_output_file_open(const char *path, imk_output_file **file, imk_error *error)
{
    if (!path)
        path = "-";
    imk_output_file *made = calloc(1, sizeof *made);
    if (!made || !(made->buffer = malloc(BUFFER_SIZE))) {
        free(made);
        return imk_error_set(error, IMK_ERROR_MEMORY, path, "", "");
    }
    const imk_status status = imki_packing_start(path, &made->packing, error);
    if (status != IMK_OK) {
        release(made);
        return status;
    }
    const int number = imki_target_open(&made->target, path);
    if (number != 0) {
        release(made);
        return imki_target_refuse(path, number, error);
    }
    *file = made;
    return IMK_OK;
}

imk_status imk_output_file_write(imk_output_file *file, const void *bytes, size_t size)
{
    if (file->status != IMK_OK || size == 0)
        return file->status;
    return file->packing ? write_packed(file, bytes, size, false) : write_plain(file, bytes, size);
}

imk_status imk_output_file_print(imk_output_file *file, const char *format, ...)
{
    char text[PRINT_SIZE];
    va_list arguments;
    va_start(arguments, format);
    const int length = vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    if (length < 0 || length >= PRINT_SIZE)
        return fail(file, EOVERFLOW);
    return imk_output_file_write(file, text, (size_t)length);
}

bool imki_output_file_can_replace(const imk_output_file *file)
{
    return !file->packing && file->target.temporary != NULL;
}

const char *imki_output_file_temporary(const imk_output_file *file)
{
    return file->target.temporary;
}

imk_status imki_output_file_replace(imk_output_file *file, uint64_t offset, const void *bytes,
                                    size_t size)
{
    flush(file);
    const unsigned char *at = bytes;
    while (size > 0 && file->status == IMK_OK) {
        const ssize_t count = pwrite(file->target.file, at, size, (off_t)offset);
        if (count < 0 && errno != EINTR)
            return fail(file, errno);
        if (count > 0) {
            at += count;
            offset += (uint64_t)count;
            size -= (size_t)count;
        }
    }
    return file->status;
}

/* Say why a file failed, and abandon it. */
static void refuse(imk_output_file *file, imk_error *error)
{
    (void)imki_system_error(error, file->status, file->target.path, file->system_error);
    imk_output_file_abandon(file);
}

imk_status imki_output_file_prepare(imk_output_file *file, imk_error *error)
{
    if (file->status == IMK_OK && file->packing)
        write_packed(file, NULL, 0, true);
    flush(file);
    if (file->status == IMK_OK && file->target.temporary && fsync(file->target.file) != 0)
        fail(file, errno);
    const imk_status status = file->status;
    if (status == IMK_OK)
        file->prepared = true;
    else
        refuse(file, error);
    return status;
}

imk_status imk_output_file_commit(imk_output_file *file, imk_error *error)
{
    if (!file->prepared) {
        const imk_status status = imki_output_file_prepare(file, error);
        if (status != IMK_OK)
            return status;
    }
    const int number = imki_target_publish(&file->target);
    if (number != 0) {
        fail(file, number);
        const imk_status status = file->status;
        refuse(file, error);
        return status;
    }
    imki_target_close(&file->target);
    release(file);
    return IMK_OK;
}

void imk_output_file_abandon(imk_output_file *file)
{
    if (!file)
        return;
    imki_target_close(&file->target);
    release(file);
}
