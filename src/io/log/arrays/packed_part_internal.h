/* SPDX-License-Identifier: Apache-2.0 */
/* A part of a file as a stream of bytes, inflated on the way: a member of a zip, a compressed
 * element of a MAT-file, or bytes as they are. Several may be read side by side. */
#ifndef IMUKIT_PACKED_PART_INTERNAL_H
#define IMUKIT_PACKED_PART_INTERNAL_H

#include "imukit/status.h"

#include <stdbool.h>
#include <zlib.h>

typedef enum imki_packing {
    IMKI_PLAIN,
    IMKI_ZLIB,   /* [RFC1950] */
    IMKI_DEFLATE /* [RFC1951], as zip has it */
} imki_packing;

/* What is in the file. */
typedef struct imki_packed {
    int file;
    uint64_t begin, size; /* bytes of the file */
    imki_packing packing;
    const char *name; /* for messages, as in "gyro.npy"; may be NULL */
    bool has_crc;
    uint32_t crc;      /* of all unpacked bytes */
    uint64_t unpacked; /* their number, with has_crc, and with IMKI_ZLIB where it is known */
} imki_packed;

typedef struct imki_unpacking {
    imki_packed packed;
    uint64_t place; /* unpacked bytes that were given or passed over */
    uint64_t taken; /* packed bytes that were read */
    uint32_t crc;   /* so far, as long as nothing was passed over without reading it */
    bool crc_holds, ended;
    z_stream inflater; /* with packing */
    unsigned char *raw;
} imki_unpacking;

/* @return IMK_ERROR_MEMORY; close it also then */
imk_status imki_packed_open(const imki_packed *packed, imki_unpacking *part, imk_error *error);
void imki_packed_close(imki_unpacking *part);

/* Bytes at a place, which is not before those that were given when they are packed.
 * @return IMK_ERROR_FORMAT (it ends before, or is damaged), IMK_ERROR_READ, IMK_ERROR_UNSUPPORTED
 *         (a place before) */
imk_status imki_packed_read(imki_unpacking *part, uint64_t place, void *bytes, size_t size,
                            imk_error *error);

/* Read on to the end, so that the checksum is compared: that of the whole, or zlib's own.
 * @return as imki_packed_read() */
imk_status imki_packed_end(imki_unpacking *part, imk_error *error);
/* Read all of it for the checksum alone. */
imk_status imki_packed_check(const imki_packed *packed, imk_error *error);

/* Write `most` of the unpacked bytes to a file, from byte `begin` on; the checksum is compared.
 * @return as imki_packed_read(), IMK_ERROR_WRITE */
imk_status imki_packed_copy(const imki_packed *packed, uint64_t most, int to, uint64_t begin,
                            imk_error *error);

#endif
