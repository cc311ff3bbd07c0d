/* SPDX-License-Identifier: Apache-2.0 */
/* Bytes from a file, a pipe or memory. Compression is recognised by content:
 *
 *     gzip [RFC1952]  1f 8b, any number of members, zero padding after the last one
 *     zstd [RFC8878]  28 b5 2f fd, any number of frames; 5x 2a 4d 18, a skippable frame, first
 *
 * Compressed and plain files use one raw buffer: a plain file's is only for the first bytes, which
 * had to be looked at; then the file is read straight into the caller's buffer. */
#define _POSIX_C_SOURCE 200809L
#include "input_stream_internal.h"

#include "descriptor_name_internal.h"
#include "input_copy_internal.h"
#include "system_error_internal.h"

#include "imukit/utf8.h"

#include <errno.h>
#include <fcntl.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>
#include <zstd.h>
#include <zstd_errors.h>

enum { RAW_SIZE = 1 << 16, FRAME_HEAD = 18 /* the longest of zstd */ };

typedef enum encoding { ENCODING_MEMORY, ENCODING_PLAIN, ENCODING_GZIP, ENCODING_ZSTD } encoding;

struct imki_input {
    imki_known_bytes *known; /* while it is opened; NULL: no others */
    const void *context;
    encoding encoding;
    const char *bytes; /* memory */
    size_t size;
    int file;      /* -1: none */
    bool standard; /* it is standard input, which stays open */
    bool copy;     /* it is a copy, which others read too */
    bool regular;  /* a file, at whose first byte reading began */
    off_t rewind;  /* where standard input is put back to at the end; -1: nowhere */
    char path[96]; /* for messages */
    uint64_t file_size;
    uint64_t fetched; /* bytes taken from the file or memory */
    unsigned char *raw;
    size_t raw_begin, raw_end; /* not yet used */
    bool file_ended;
    bool inside;                   /* a gzip member or zstd frame has begun and not ended */
    unsigned long long frame_size; /* of a zstd frame, as its head says it, or that it does not */
    unsigned long long frame_done;
    z_stream gzip;
    ZSTD_DStream *zstd;
    imk_error failure; /* kept: a failed input stays failed */
};

/* read(), again when a signal interrupts it; from a copy pread(), whose place is its own. */
static imk_status fetch(imki_input *input, void *target, size_t capacity, size_t *got)
{
    ssize_t count;
    do
        count = input->copy ? pread(input->file, target, capacity, (off_t)input->fetched)
                            : read(input->file, target, capacity);
    while (count < 0 && errno == EINTR);
    if (count < 0)
        return imki_system_error(&input->failure, IMK_ERROR_READ, input->path, errno);
    if (count == 0)
        input->file_ended = true;
    input->fetched += (uint64_t)count;
    *got = (size_t)count;
    return IMK_OK;
}

/* Have at least `count` raw bytes, or all there are. */
static imk_status fill(imki_input *input, size_t count)
{
    if (input->raw_begin > 0 && input->raw_end - input->raw_begin < count) {
        memmove(input->raw, input->raw + input->raw_begin, input->raw_end - input->raw_begin);
        input->raw_end -= input->raw_begin;
        input->raw_begin = 0;
    }
    while (input->raw_end - input->raw_begin < count && !input->file_ended) {
        size_t got = 0;
        const imk_status status =
            fetch(input, input->raw + input->raw_end, RAW_SIZE - input->raw_end, &got);
        if (status != IMK_OK)
            return status;
        input->raw_end += got;
    }
    return IMK_OK;
}

static imk_status damaged(imki_input *input, const char *what)
{
    char found[96];
    snprintf(found, sizeof found, "%s, at byte %llu", what,
             (unsigned long long)(input->fetched - (input->raw_end - input->raw_begin)));
    return imk_error_set(&input->failure, IMK_ERROR_COMPRESSED, input->path, found,
                         "copy or download the file again");
}

static imk_status no_memory(imki_input *input)
{
    return imk_error_set(&input->failure, IMK_ERROR_MEMORY, input->path, "", "");
}

/* After a gzip member: another one, zero padding, or the end. */
static imk_status next_member(imki_input *input)
{
    for (;;) {
        const imk_status status = fill(input, 2);
        if (status != IMK_OK)
            return status;
        const unsigned char *at = input->raw + input->raw_begin;
        const size_t left = input->raw_end - input->raw_begin;
        if (left == 0)
            return IMK_OK;
        if (left >= 2 && at[0] == 0x1F && at[1] == 0x8B) {
            input->inside = true;
            inflateReset(&input->gzip);
            return IMK_OK;
        }
        if (at[0] != 0)
            return damaged(input, "bytes that are not gzip follow the gzip data");
        input->raw_begin++;
    }
}

static imk_status read_gzip(imki_input *input, unsigned char *target, size_t capacity, size_t *got)
{
    z_stream *z = &input->gzip;
    while (*got == 0) {
        imk_status status = input->inside ? fill(input, 1) : next_member(input);
        if (status != IMK_OK)
            return status;
        if (!input->inside)
            return IMK_OK;
        z->next_in = input->raw + input->raw_begin;
        z->avail_in = (uInt)(input->raw_end - input->raw_begin);
        z->next_out = target;
        z->avail_out = capacity < (1u << 30) ? (uInt)capacity : 1u << 30;
        const int result = inflate(z, Z_NO_FLUSH);
        *got = (size_t)(z->next_out - target);
        input->raw_begin = input->raw_end - z->avail_in;
        if (result == Z_STREAM_END) {
            input->inside = false;
        } else if (result != Z_OK && result != Z_BUF_ERROR) {
            status = result == Z_MEM_ERROR
                         ? no_memory(input)
                         : damaged(input, z->msg ? z->msg : "the gzip data is damaged");
            return *got > 0 ? IMK_OK : status;
        } else if (*got == 0 && input->file_ended && input->raw_begin == input->raw_end) {
            return damaged(input, "the gzip data is cut short");
        }
    }
    return IMK_OK;
}

static bool is_zstd(const unsigned char *at)
{
    return at[1] == 0xB5 && at[2] == 0x2F && at[3] == 0xFD && at[0] == 0x28;
}

static bool is_skippable(const unsigned char *at)
{
    return at[1] == 0x2A && at[2] == 0x4D && at[3] == 0x18 && (at[0] & 0xF0) == 0x50;
}

/* After a zstd frame: another one, or the end. Frames of the formats before RFC 8878 are not handed
 * to the library, which gives bytes away that it never set when such a frame is damaged. */
static imk_status next_frame(imki_input *input)
{
    const imk_status status = fill(input, FRAME_HEAD);
    if (status != IMK_OK)
        return status;
    const unsigned char *at = input->raw + input->raw_begin;
    const size_t left = input->raw_end - input->raw_begin;
    if (left == 0)
        return IMK_OK;
    if (left < 4 || !(is_zstd(at) || is_skippable(at)))
        return damaged(input, "bytes that are not zstd follow the zstd data");
    input->frame_size = ZSTD_getFrameContentSize(at, left);
    input->frame_done = 0;
    input->inside = true;
    return IMK_OK;
}

static imk_status zstd_failed(imki_input *input, size_t result)
{
    switch (ZSTD_getErrorCode(result)) {
    case ZSTD_error_memory_allocation:
        return no_memory(input);
    case ZSTD_error_frameParameter_windowTooLarge:
        return imk_error_set(&input->failure, IMK_ERROR_UNSUPPORTED, input->path,
                             "the window of the zstd data is larger than 128 MiB",
                             "compress it again without --long, or unpack it first: zstd -d "
                             "--long=31 FILE");
    default:
        return damaged(input, ZSTD_getErrorName(result));
    }
}

static imk_status read_zstd(imki_input *input, unsigned char *target, size_t capacity, size_t *got)
{
    while (*got == 0) {
        imk_status status = input->inside ? fill(input, 1) : next_frame(input);
        if (status != IMK_OK)
            return status;
        if (!input->inside)
            return IMK_OK;
        ZSTD_inBuffer in = {input->raw + input->raw_begin, input->raw_end - input->raw_begin, 0};
        ZSTD_outBuffer out = {target, capacity, 0};
        const size_t result = ZSTD_decompressStream(input->zstd, &out, &in);
        input->raw_begin += in.pos;
        if (ZSTD_isError(result))
            return zstd_failed(input, result);
        input->inside = result != 0;
        input->frame_done += out.pos;
        /* libzstd does not look at this where the last block is empty. */
        if (!input->inside && input->frame_size < ZSTD_CONTENTSIZE_ERROR &&
            input->frame_size != input->frame_done)
            return damaged(input, "the size of the zstd data is not that in its frame header");
        *got = out.pos;
        if (*got == 0 && input->inside && in.pos == 0 && input->file_ended)
            return damaged(input, "the zstd data is cut short");
    }
    return IMK_OK;
}

static imk_status read_plain(imki_input *input, char *target, size_t capacity, size_t *got)
{
    const size_t left = input->raw_end - input->raw_begin;
    if (left == 0)
        return input->file_ended ? IMK_OK : fetch(input, target, capacity, got);
    *got = left < capacity ? left : capacity;
    memcpy(target, input->raw + input->raw_begin, *got);
    input->raw_begin += *got;
    return IMK_OK;
}

imk_status imki_input_read(imki_input *input, char *buffer, size_t capacity, size_t *got,
                           imk_error *error)
{
    size_t count = 0;
    if (input->failure.status != IMK_OK) {
        if (error)
            *error = input->failure;
        return input->failure.status;
    }
    imk_status status = IMK_OK;
    switch (input->encoding) {
    case ENCODING_MEMORY:
        count = input->size - (size_t)input->fetched;
        count = count < capacity ? count : capacity;
        if (count > 0)
            memcpy(buffer, input->bytes + input->fetched, count);
        input->fetched += count;
        break;
    case ENCODING_PLAIN:
        status = read_plain(input, buffer, capacity, &count);
        break;
    case ENCODING_GZIP:
        status = read_gzip(input, (unsigned char *)buffer, capacity, &count);
        break;
    case ENCODING_ZSTD:
        status = read_zstd(input, (unsigned char *)buffer, capacity, &count);
        break;
    }
    if (status != IMK_OK) {
        if (error)
            *error = input->failure;
        return status;
    }
    *got = count;
    return IMK_OK;
}

/* What the first bytes say, with the decoder made ready. */
static imk_status recognise(imki_input *input)
{
    const imk_status status = fill(input, 4);
    if (status != IMK_OK)
        return status;
    const unsigned char *at = input->raw;
    if (input->raw_end == 0)
        return imk_error_set(&input->failure, IMK_ERROR_EMPTY, input->path, "the file is empty",
                             "");
    const uint32_t word = input->raw_end < 4 ? 0
                                             : at[0] | (uint32_t)at[1] << 8 |
                                                   (uint32_t)at[2] << 16 | (uint32_t)at[3] << 24;
    if (input->raw_end >= 2 && at[0] == 0x1F && at[1] == 0x8B) {
        input->encoding = ENCODING_GZIP;
        input->inside = true;
        if (inflateInit2(&input->gzip, 15 + 16) != Z_OK) /* 15: largest window, + 16: gzip only */
            return no_memory(input);
    } else if (word == 0xFD2FB528u || (word & 0xFFFFFFF0u) == 0x184D2A50u) {
        input->encoding = ENCODING_ZSTD;
        input->zstd = ZSTD_createDStream();
        if (!input->zstd)
            return no_memory(input);
    }
    return IMK_OK;
}

/* A stream that is open already is taken as it is: a socket cannot be opened by its name, nor the
 * pipe of another user. */
static int open_stream(imki_input *input, const char *path)
{
    if (input->standard)
        return STDIN_FILENO;
    const int number = imki_descriptor_named(path);
    return number >= 0 ? fcntl(number, F_DUPFD_CLOEXEC, 0)
                       : open(path, O_RDONLY | O_CLOEXEC | O_NOCTTY);
}

static imk_status open_regular(imki_input *input, const char *path, bool kept)
{
    struct stat about;
    input->file = input->standard ? STDIN_FILENO : open(path, O_RDONLY | O_CLOEXEC | O_NOCTTY);
    if (input->file < 0 || fstat(input->file, &about) != 0)
        return imki_system_error(&input->failure, IMK_ERROR_OPEN, input->path, errno);
    const off_t begin = lseek(input->file, 0, SEEK_CUR); /* stdin may stand in the middle */
    if (begin < 0 && errno != ESPIPE)
        return imki_system_error(&input->failure, IMK_ERROR_READ, input->path, errno);
    if (begin >= 0 && about.st_size > begin)
        input->file_size = (uint64_t)(about.st_size - begin);
    if (kept && input->standard)
        input->rewind = begin;
    input->regular = S_ISREG(about.st_mode) && begin == 0 && !input->standard;
#ifdef POSIX_FADV_SEQUENTIAL
    posix_fadvise(input->file, 0, 0, POSIX_FADV_SEQUENTIAL);
#endif
    return IMK_OK;
}

/* The copy that was made before, or that is made now for those who come after. */
static imk_status open_copy(imki_input *input, const char *path, const struct stat *about,
                            bool kept)
{
    struct stat copied;
    int file;
    imk_status status = imki_copy_open(about, kept, &file, &input->failure);
    if (status == IMK_OK && file < 0 && kept) {
        const int from = open_stream(input, path);
        if (from < 0)
            return imki_system_error(&input->failure, IMK_ERROR_OPEN, input->path, errno);
        status =
            imki_copy_make(about, from, input->path, input->known, input->context, &input->failure);
        if (!input->standard)
            close(from);
        if (status == IMK_OK)
            status = imki_copy_open(about, kept, &file, &input->failure);
        if (status == IMK_OK && file < 0)
            status = imki_system_error(&input->failure, IMK_ERROR_OPEN, input->path, errno);
    }
    if (status != IMK_OK || file < 0 || fstat(file, &copied) != 0)
        return status;
    input->file = file;
    input->copy = true;
    input->standard = false;
    input->file_size = (uint64_t)copied.st_size;
    return IMK_OK;
}

/* Open the file and learn what it is. */
static imk_status open_file(imki_input *input, const char *path, bool kept)
{
    struct stat about;
    input->standard = strcmp(path, "-") == 0;
    imk_utf8_shorten(input->standard ? "standard input" : path, input->path, sizeof input->path);
    if ((input->standard ? fstat(STDIN_FILENO, &about) : stat(path, &about)) != 0)
        return imki_system_error(&input->failure, IMK_ERROR_OPEN, input->path, errno);
    if (S_ISDIR(about.st_mode))
        return imki_system_error(&input->failure, IMK_ERROR_OPEN, input->path, EISDIR);
    if (S_ISREG(about.st_mode))
        return open_regular(input, path, kept);
    const imk_status status = open_copy(input, path, &about, kept);
    if (status == IMK_OK && !input->copy)
        input->file = open_stream(input, path);
    return status == IMK_OK && input->file < 0
               ? imki_system_error(&input->failure, IMK_ERROR_OPEN, input->path, errno)
               : status;
}

static imk_status open_input(const char *path, bool kept, imki_known_bytes *known,
                             const void *context, imki_input **input, imk_error *error)
{
    imki_input *made = calloc(1, sizeof *made);
    unsigned char *raw = malloc(RAW_SIZE);
    if (!made || !raw) {
        free(made);
        free(raw);
        return imk_error_set(error, IMK_ERROR_MEMORY, path, "", "");
    }
    made->encoding = ENCODING_PLAIN;
    made->file = -1;
    made->rewind = -1;
    made->raw = raw;
    made->known = known;
    made->context = context;
    imk_status status = open_file(made, path, kept);
    if (status == IMK_OK)
        status = recognise(made);
    if (status != IMK_OK) {
        if (error)
            *error = made->failure;
        imki_input_close(made);
        return status;
    }
    *input = made;
    return IMK_OK;
}

imk_status imki_input_open(const char *path, imki_input **input, imk_error *error)
{
    return open_input(path, false, NULL, NULL, input, error);
}

imk_status imki_input_open_kept(const char *path, imki_input **input, imk_error *error)
{
    return open_input(path, true, NULL, NULL, input, error);
}

imk_status imki_input_open_known(const char *path, imki_known_bytes *known, const void *context,
                                 imki_input **input, imk_error *error)
{
    return open_input(path, true, known, context, input, error);
}

imk_status imki_input_open_memory(const char *bytes, size_t size, imki_input **input)
{
    imki_input *made = calloc(1, sizeof *made);
    if (!made)
        return IMK_ERROR_MEMORY;
    made->encoding = ENCODING_MEMORY;
    made->bytes = size > 0 ? bytes : "";
    made->size = size;
    made->file = -1;
    made->rewind = -1;
    made->file_size = size;
    *input = made;
    return IMK_OK;
}

const char *imki_input_mapped(const imki_input *input, size_t *size)
{
    if (input->encoding != ENCODING_MEMORY)
        return NULL;
    *size = input->size;
    return input->bytes;
}

void imki_input_progress(const imki_input *input, uint64_t *done, uint64_t *size)
{
    *done = input->fetched - (input->raw_end - input->raw_begin);
    *size = input->file_size;
}

int imki_input_file(const imki_input *input)
{
    return input->encoding == ENCODING_PLAIN && (input->regular || input->copy) ? input->file : -1;
}

imk_status imki_input_seek(imki_input *input, uint64_t place, imk_error *error)
{
    const bool memory = input->encoding == ENCODING_MEMORY;
    if (!memory && imki_input_file(input) < 0)
        return imk_error_set(error, IMK_ERROR_UNSUPPORTED, input->path,
                             "in a pipe and in compressed data there is no way to another place",
                             "write it to a plain file");
    if (memory && place > input->size)
        place = input->size;
    if (!memory && !input->copy && lseek(input->file, (off_t)place, SEEK_SET) < 0)
        return imki_system_error(error, IMK_ERROR_READ, input->path, errno);
    input->fetched = place;
    input->raw_begin = input->raw_end = 0;
    input->file_ended = false;
    return IMK_OK;
}

void imki_input_close(imki_input *input)
{
    if (!input)
        return;
    if (input->encoding == ENCODING_GZIP)
        inflateEnd(&input->gzip);
    ZSTD_freeDStream(input->zstd);
    if (input->rewind >= 0)
        lseek(input->file, input->rewind, SEEK_SET);
    if (input->file >= 0 && !input->standard)
        close(input->file);
    free(input->raw);
    free(input);
}
