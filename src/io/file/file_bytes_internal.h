/* SPDX-License-Identifier: Apache-2.0 */
/* Reading at a place, CRC-32, numbers in bytes: what binary files need. */
#ifndef IMUKIT_FILE_BYTES_INTERNAL_H
#define IMUKIT_FILE_BYTES_INTERNAL_H

#include <stddef.h>
#include <stdint.h>

/* read() until `size` bytes are there. @return 0, an errno value, or -1 at the end of the file */
int imki_read_at(int file, uint64_t offset, void *bytes, size_t size);
uint32_t imki_crc(uint32_t crc, const void *bytes, size_t size);
/* CRC-32 of a part of the file, going on from *crc. @return as imki_read_at(), or ENOMEM */
int imki_crc_at(int file, uint64_t offset, uint64_t size, uint32_t *crc);
/* Little-endian numbers of 1 … 8 bytes. */
void imki_put_number(unsigned char *at, uint64_t number, size_t size);
uint64_t imki_get_number(const unsigned char *at, size_t size);

#endif
