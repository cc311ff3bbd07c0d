/* SPDX-License-Identifier: Apache-2.0 */
/* The first line of a results file, in the user block of HDF5, which other programs pass over:
 *
 *   imukit results 1  size=00000000000000012345  crc32=0123abcd
 *
 * and zeros up to 512 bytes. The CRC-32 is that of the whole file with zeros for its own eight
 * digits. Nothing of a file is believed, and nothing but this line read, before size and CRC agree:
 * what a broken disk or transfer leaves never reaches libhdf5. */
#include "campaign_internal.h"
#include "io/file/system_error_internal.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

static const char magic[] = IMKI_RESULTS_MAGIC;
enum {
    MAGIC = sizeof magic - 1,
    SIZE_AT = MAGIC + 8, /* "1  size=" */
    SIZE_DIGITS = 20,
    CRC_AT = SIZE_AT + SIZE_DIGITS + 8, /* "  crc32=" */
    LINE = CRC_AT + 8 + 1
};

void imki_seal_put(imki_seal seal, unsigned char block[IMKI_SEAL_SIZE])
{
    char line[LINE + 1];
    snprintf(line, sizeof line, "%s1  size=%020llu  crc32=%08lx\n", magic,
             (unsigned long long)seal.size, (unsigned long)seal.crc);
    memset(block, 0, IMKI_SEAL_SIZE);
    memcpy(block, line, LINE);
}

static imk_status damaged(imk_error *error, const char *found)
{
    return imk_error_set(error, IMK_ERROR_READ, "", found, "compute it again");
}

/* A line that is not as imki_seal_put() makes it.
 * @param block  what the file begins with, and a zero */
static imk_status refuse_line(const char *block, size_t there, imk_error *error)
{
    static const char signature[] = "\x89HDF\r\n\x1a\n"; /* behind the user block */
    static const char under_way[] = "imukit campaign part ";
    const size_t digits = strspn(block + MAGIC, "0123456789");
    if (there == 0)
        return damaged(error, "the file is empty");
    if (strncmp(block, under_way, sizeof under_way - 1) == 0)
        return imk_error_set(error, IMK_ERROR_FORMAT, "",
                             "this is the file of an unfinished campaign",
                             "run the interrupted command again: it makes the results file");
    const bool ours = strncmp(block, magic, MAGIC) == 0;
    if (ours && digits > 0 && block[MAGIC + digits] == ' ' && (digits > 1 || block[MAGIC] != '1')) {
        char found[24];
        snprintf(found, sizeof found, "%.*s", digits < 20 ? (int)digits : 20, block + MAGIC);
        return imk_error_set(error, IMK_ERROR_VERSION, "format", found, "1; use a newer imukit");
    }
    if (ours || (there > IMKI_SEAL_SIZE &&
                 memcmp(block + IMKI_SEAL_SIZE, signature, sizeof signature - 1) == 0))
        return damaged(error, "the file is damaged: its first line cannot be read");
    return imki_record_refuse(error);
}

/* @return false when the line is not as imki_seal_put() makes it */
static bool parse(const char *line, imki_seal *seal)
{
    unsigned char again[IMKI_SEAL_SIZE];
    if (strncmp(line, magic, MAGIC) != 0)
        return false;
    seal->size = strtoull(line + SIZE_AT, NULL, 10);
    seal->crc = (uint32_t)strtoul(line + CRC_AT, NULL, 16);
    imki_seal_put(*seal, again);
    return memcmp(again, line, LINE) == 0;
}

imk_status imki_seal_verify(int file, uint64_t size, imki_seal *seal, imk_error *error)
{
    enum { FIRST = IMKI_SEAL_SIZE + 8 }; /* with the signature of HDF5 */
    char block[FIRST + 1] = {0};
    const size_t there = size < FIRST ? (size_t)size : FIRST;
    int number = imki_read_at(file, 0, block, there);
    if (number != 0)
        return imki_read_error(number, "", error);
    if (!parse(block, seal))
        return refuse_line(block, there, error);
    if (seal->size != size) {
        char found[96];
        snprintf(found, sizeof found, "the file is %s: %llu of %llu bytes",
                 size < seal->size ? "cut short" : "too long", (unsigned long long)size,
                 (unsigned long long)seal->size);
        return damaged(error, found);
    }
    memset(block + CRC_AT, '0', 8);
    uint32_t crc = imki_crc(0, block, there);
    number = imki_crc_at(file, there, size - there, &crc);
    if (number != 0)
        return imki_read_error(number, "", error);
    if (crc != seal->crc)
        return damaged(error, "the file is damaged: its checksum does not agree with its content");
    return IMK_OK;
}

imk_status imki_read_error(int number, const char *field, imk_error *error)
{
    if (number == ENOMEM)
        return imk_error_set(error, IMK_ERROR_MEMORY, field, "", "");
    if (number > 0)
        return imki_system_error(error, IMK_ERROR_READ, field, number);
    return imk_error_set(error, IMK_ERROR_READ, field, "the file is cut short", "compute it again");
}
