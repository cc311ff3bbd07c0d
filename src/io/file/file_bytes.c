/* SPDX-License-Identifier: Apache-2.0 */
/* Reading at a place, whole or not at all, CRC-32 of long runs of bytes, numbers in bytes. */
#define _POSIX_C_SOURCE 200809L
#include "file_bytes_internal.h"

#include <errno.h>
#include <stdlib.h>
#include <unistd.h>
#include <zlib.h>

int imki_read_at(int file, uint64_t offset, void *bytes, size_t size)
{
    unsigned char *at = bytes;
    while (size > 0) {
        const ssize_t count = pread(file, at, size, (off_t)offset);
        if (count < 0 && errno == EINTR)
            continue;
        if (count <= 0)
            return count < 0 ? errno : -1;
        at += count;
        offset += (uint64_t)count;
        size -= (size_t)count;
    }
    return 0;
}

uint32_t imki_crc(uint32_t crc, const void *bytes, size_t size)
{
    return (uint32_t)crc32_z(crc, bytes, size);
}

int imki_crc_at(int file, uint64_t offset, uint64_t size, uint32_t *crc)
{
    enum { BLOCK = 1 << 16 }; /* bytes: stays in the first caches */
    unsigned char *block = malloc(BLOCK);
    int number = block ? 0 : ENOMEM;
    while (size > 0 && number == 0) {
        const size_t step = size < BLOCK ? (size_t)size : BLOCK;
        number = imki_read_at(file, offset, block, step);
        if (number == 0)
            *crc = imki_crc(*crc, block, step);
        offset += step;
        size -= step;
    }
    free(block);
    return number;
}

void imki_put_number(unsigned char *at, uint64_t number, size_t size)
{
    for (size_t i = 0; i < size; i++)
        at[i] = (unsigned char)(number >> (8 * i));
}

uint64_t imki_get_number(const unsigned char *at, size_t size)
{
    uint64_t number = 0;
    for (size_t i = size; i-- > 0;)
        number = number << 8 | at[i];
    return number;
}
