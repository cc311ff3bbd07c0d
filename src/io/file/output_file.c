/* SPDX-License-Identifier: Apache-2.0 */
/* Output files that appear complete or not at all: the bytes go to a temporary file in the same
 * directory, because rename() replaces a file in one step only within a file system, and it is
 * synced before the rename, because some file systems do the rename before the data otherwise.
 *
 * The first error is kept; everything after it is ignored until commit reports it. */
#define _POSIX_C_SOURCE 200809L
#define ZLIB_CONST
#include "output_file_internal.h"
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
#include <zlib.h>
#include <zstd.h>

enum {
    BUFFER_SIZE = 1 << 20, /* few system calls, and still in the second-level cache */
    DIRECT_SIZE = 1 << 15, /* from here on a copy costs more than a call of its own */
    PRINT_SIZE = 4096
};

typedef enum encoding { ENCODING_PLAIN, ENCODING_GZIP, ENCODING_ZSTD } encoding;

struct imk_output_file {
    imki_target target;
    encoding encoding;
    unsigned char *buffer; /* bytes to write to the file: compressed ones, if it is */
    size_t used;
    z_stream gzip;
    gz_header gzip_header;
    ZSTD_CStream *zstd;
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

/* @param flush_mode  Z_NO_FLUSH, or Z_FINISH with the last bytes */
static imk_status write_gzip(imk_output_file *file, const unsigned char *bytes, size_t size,
                             int flush_mode)
{
    z_stream *z = &file->gzip;
    z->next_in = bytes;
    int result;
    do {
        const uInt step = size < (1u << 30) ? (uInt)size : 1u << 30;
        z->avail_in = step;
        size -= step;
        do {
            if (file->used == BUFFER_SIZE && flush(file) != IMK_OK)
                return file->status;
            z->next_out = file->buffer + file->used;
            z->avail_out = (uInt)(BUFFER_SIZE - file->used);
            result = deflate(z, size > 0 ? Z_NO_FLUSH : flush_mode);
            file->used = BUFFER_SIZE - z->avail_out;
        } while (z->avail_out == 0);
    } while (size > 0);
    return result == Z_STREAM_ERROR ? fail(file, EINVAL) : file->status;
}

static imk_status write_zstd(imk_output_file *file, const unsigned char *bytes, size_t size,
                             ZSTD_EndDirective directive)
{
    ZSTD_inBuffer in = {bytes, size, 0};
    size_t left;
    do {
        if (file->used == BUFFER_SIZE && flush(file) != IMK_OK)
            return file->status;
        ZSTD_outBuffer out = {file->buffer, BUFFER_SIZE, file->used};
        left = ZSTD_compressStream2(file->zstd, &out, &in, directive);
        file->used = out.pos;
        if (ZSTD_isError(left)) /* nothing is wrong with the bytes */
            return fail(file, ENOMEM);
    } while (in.pos < size || (directive == ZSTD_e_end && left > 0));
    return file->status;
}

static bool start_compression(imk_output_file *file, const char *path)
{
    if (imk_has_ending(path, ".gz")) {
        /* 15: largest window, + 16: gzip; 8: zlib's usual memory */
        if (deflateInit2(&file->gzip, 6, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY) != Z_OK)
            return false;
        file->gzip_header.os = 255; /* "unknown": the same bytes on every system */
        deflateSetHeader(&file->gzip, &file->gzip_header);
        file->encoding = ENCODING_GZIP;
    } else if (imk_has_ending(path, ".zst")) {
        file->zstd = ZSTD_createCStream();
        if (!file->zstd)
            return false;
        ZSTD_CCtx_setParameter(file->zstd, ZSTD_c_compressionLevel, 3);
        ZSTD_CCtx_setParameter(file->zstd, ZSTD_c_checksumFlag, 1);
        file->encoding = ENCODING_ZSTD;
    }
    return true;
}

static void release(imk_output_file *file)
{
    if (file->encoding == ENCODING_GZIP)
        deflateEnd(&file->gzip);
    ZSTD_freeCStream(file->zstd);
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
    if (!made || !(made->buffer = malloc(BUFFER_SIZE)) || !start_compression(made, path)) {
        if (made)
            release(made);
        return imk_error_set(error, IMK_ERROR_MEMORY, path, "", "");
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
    switch (file->encoding) {
    case ENCODING_GZIP:
        return write_gzip(file, bytes, size, Z_NO_FLUSH);
    case ENCODING_ZSTD:
        return write_zstd(file, bytes, size, ZSTD_e_continue);
    case ENCODING_PLAIN:
        break;
    }
    return write_plain(file, bytes, size);
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
    return file->encoding == ENCODING_PLAIN && file->target.temporary != NULL;
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
    if (file->status == IMK_OK && file->encoding == ENCODING_GZIP)
        write_gzip(file, NULL, 0, Z_FINISH);
    if (file->status == IMK_OK && file->encoding == ENCODING_ZSTD)
        write_zstd(file, NULL, 0, ZSTD_e_end);
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
