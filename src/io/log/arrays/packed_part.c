/* SPDX-License-Identifier: Apache-2.0 */
/* Parts of files, read at places and inflated. What is given is never more than what was asked for,
 * so that a small file that unpacks to a large one costs time in proportion to what is read. */
#define _POSIX_C_SOURCE 200809L
#include "packed_part_internal.h"

#include "io/file/file_bytes_internal.h"
#include "io/file/system_error_internal.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { RAW = 1 << 15, PASSED = 1 << 14 };

static imk_status damaged(const imki_unpacking *part, const char *what, imk_error *error)
{
    char found[96];
    const char *name = part->packed.name;
    snprintf(found, sizeof found, "%s%.40s%s%s", name ? "\"" : "", name ? name : "",
             name ? "\" " : "the file ", what);
    return imk_error_set(error, IMK_ERROR_FORMAT, "", found, "copy the file again");
}

imk_status imki_packed_open(const imki_packed *packed, imki_unpacking *part, imk_error *error)
{
    *part = (imki_unpacking){.packed = *packed, .crc_holds = packed->has_crc};
    if (packed->packing == IMKI_PLAIN)
        return IMK_OK;
    part->raw = malloc(RAW);
    const int window = packed->packing == IMKI_ZLIB ? 15 : -15; /* negative: without a head */
    if (!part->raw || inflateInit2(&part->inflater, window) != Z_OK) {
        free(part->raw);
        part->raw = NULL;
        return imk_error_set(error, IMK_ERROR_MEMORY, "", NULL, NULL);
    }
    return IMK_OK;
}

void imki_packed_close(imki_unpacking *part)
{
    if (part->raw)
        inflateEnd(&part->inflater);
    free(part->raw);
    part->raw = NULL;
}

static imk_status read_file(imki_unpacking *part, uint64_t place, void *bytes, size_t size,
                            imk_error *error)
{
    const imki_packed *packed = &part->packed;
    if (place > packed->size || size > packed->size - place)
        return damaged(part, "is cut short", error);
    const int number = imki_read_at(packed->file, packed->begin + place, bytes, size);
    if (number > 0)
        return imki_system_error(error, IMK_ERROR_READ, "", number);
    return number < 0 ? damaged(part, "is cut short", error) : IMK_OK;
}

/* One call of zlib, with more of the file where it needs that. */
static imk_status inflate_step(imki_unpacking *part, imk_error *error)
{
    z_stream *z = &part->inflater;
    const uint64_t left = part->packed.size - part->taken;
    if (z->avail_in == 0 && left > 0) {
        const size_t count = left < RAW ? (size_t)left : RAW;
        const imk_status status = read_file(part, part->taken, part->raw, count, error);
        if (status != IMK_OK)
            return status;
        part->taken += count;
        z->next_in = part->raw;
        z->avail_in = (uInt)count;
    }
    const int result = part->ended ? Z_BUF_ERROR : inflate(z, Z_NO_FLUSH);
    part->ended = part->ended || result == Z_STREAM_END;
    if (result == Z_MEM_ERROR)
        return imk_error_set(error, IMK_ERROR_MEMORY, "", NULL, NULL);
    if (result == Z_BUF_ERROR && z->avail_in == 0 && part->taken == part->packed.size)
        return damaged(part, "is cut short", error);
    return result == Z_OK || result == Z_STREAM_END
               ? IMK_OK
               : damaged(part, "has damaged compressed data", error);
}

/* Inflate until the bytes are there. */
static imk_status inflate_next(imki_unpacking *part, unsigned char *bytes, size_t size,
                               imk_error *error)
{
    z_stream *z = &part->inflater;
    z->next_out = bytes;
    z->avail_out = (uInt)size;
    while (z->avail_out > 0) {
        const imk_status status = inflate_step(part, error);
        if (status != IMK_OK)
            return status;
        if (part->ended && z->avail_out > 0)
            return damaged(part, "has damaged compressed data", error);
    }
    return IMK_OK;
}

/* zlib compares its checksum when it meets the end. A few bytes may fill up what was packed. */
static imk_status inflate_end(imki_unpacking *part, imk_error *error)
{
    unsigned char beyond[8];
    part->inflater.next_out = beyond;
    part->inflater.avail_out = sizeof beyond;
    while (!part->ended) {
        if (part->inflater.avail_out == 0)
            return damaged(part, "goes on behind what its head states", error);
        const imk_status status = inflate_step(part, error);
        if (status != IMK_OK)
            return status;
    }
    return IMK_OK;
}

/* The checksum when the last byte was given. */
static imk_status follow(imki_unpacking *part, const unsigned char *bytes, size_t size,
                         imk_error *error)
{
    part->place += size;
    if (!part->crc_holds)
        return IMK_OK;
    part->crc = imki_crc(part->crc, bytes, size);
    return part->place == part->packed.unpacked && part->crc != part->packed.crc
               ? damaged(part, "does not have the checksum that is stated for it", error)
               : IMK_OK;
}

/* zlib counts in unsigned int. */
static imk_status next(imki_unpacking *part, unsigned char *bytes, size_t size, imk_error *error)
{
    imk_status status = IMK_OK;
    while (size > 0 && status == IMK_OK) {
        const size_t step = size < 1u << 30 ? size : 1u << 30;
        status = part->packed.packing == IMKI_PLAIN
                     ? read_file(part, part->place, bytes, step, error)
                     : inflate_next(part, bytes, step, error);
        if (status == IMK_OK)
            status = follow(part, bytes, step, error);
        bytes += step;
        size -= step;
    }
    return status;
}

imk_status imki_packed_read(imki_unpacking *part, uint64_t place, void *bytes, size_t size,
                            imk_error *error)
{
    unsigned char passed[PASSED];
    if (part->packed.packing == IMKI_PLAIN) {
        part->crc_holds = part->crc_holds && place == part->place;
        part->place = place;
        return next(part, bytes, size, error);
    }
    if (place < part->place)
        return imk_error_set(error, IMK_ERROR_UNSUPPORTED, "",
                             "compressed data is read from its beginning", "");
    while (part->place < place) {
        const uint64_t left = place - part->place;
        const imk_status status = next(part, passed, left < PASSED ? (size_t)left : PASSED, error);
        if (status != IMK_OK)
            return status;
    }
    return next(part, bytes, size, error);
}

imk_status imki_packed_end(imki_unpacking *part, imk_error *error)
{
    unsigned char passed[PASSED];
    const bool has_end = part->packed.packing == IMKI_ZLIB;
    while ((part->crc_holds || has_end) && part->place < part->packed.unpacked) {
        const uint64_t left = part->packed.unpacked - part->place;
        const imk_status status = next(part, passed, left < PASSED ? (size_t)left : PASSED, error);
        if (status != IMK_OK)
            return status;
    }
    return has_end ? inflate_end(part, error) : IMK_OK;
}

imk_status imki_packed_check(const imki_packed *packed, imk_error *error)
{
    imki_unpacking part;
    imk_status status = imki_packed_open(packed, &part, error);
    if (status == IMK_OK)
        status = imki_packed_end(&part, error);
    imki_packed_close(&part);
    return status;
}

static imk_status put(int to, uint64_t place, const unsigned char *bytes, size_t size,
                      imk_error *error)
{
    while (size > 0) {
        const ssize_t count = pwrite(to, bytes, size, (off_t)place);
        if (count < 0 && errno != EINTR) {
            imk_error reason;
            char found[96];
            (void)imki_system_error(&reason, IMK_ERROR_WRITE, "", errno);
            snprintf(found, sizeof found, "its unpacked copy cannot be written: %.55s",
                     reason.found);
            return imk_error_set(error, IMK_ERROR_WRITE, "", found,
                                 "set TMPDIR to a folder with room");
        }
        if (count > 0) {
            bytes += count;
            place += (uint64_t)count;
            size -= (size_t)count;
        }
    }
    return IMK_OK;
}

imk_status imki_packed_copy(const imki_packed *packed, uint64_t most, int to, uint64_t begin,
                            imk_error *error)
{
    imki_unpacking part;
    unsigned char *bytes = malloc(RAW);
    imk_status status = imki_packed_open(packed, &part, error);
    if (status == IMK_OK && !bytes)
        status = imk_error_set(error, IMK_ERROR_MEMORY, "", NULL, NULL);
    while (status == IMK_OK && part.place < most) {
        const uint64_t place = part.place;
        const size_t size = most - place < RAW ? (size_t)(most - place) : RAW;
        status = imki_packed_read(&part, place, bytes, size, error);
        if (status == IMK_OK)
            status = put(to, begin + place, bytes, size, error);
    }
    if (status == IMK_OK)
        status = imki_packed_end(&part, error);
    imki_packed_close(&part);
    free(bytes);
    return status;
}
