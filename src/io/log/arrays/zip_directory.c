/* SPDX-License-Identifier: Apache-2.0 */
/* The directory at the end of a zip file [ZIP, 4.3]:
 *
 *     end record           50 4b 05 06, disks, number of members (10), size (12) and place (16) of
 *                          the directory, length of the comment (20)
 *     zip64 locator        50 4b 06 07, 20 bytes, before it: place of the zip64 end record (8)
 *     zip64 end record     50 4b 06 06: number of members (32), size (40) and place (48)
 *     a directory entry    50 4b 01 02: flags (8), method (10), CRC-32 (16), packed (20) and
 *                          unpacked size (24), lengths of name (28), extra (30) and comment (32),
 *                          place of the local head (42); 46 bytes, name, extra, comment
 *     a local head         50 4b 03 04: lengths of name (26) and extra (28); 30 bytes, name, extra
 *
 * All numbers are little-endian; ffffffff refers to the extra field 1, which holds the sizes and
 * the place in 8 bytes each, in this order, where they are due. */
#define _POSIX_C_SOURCE 200809L
#include "zip_directory_internal.h"

#include "io/file/file_bytes_internal.h"
#include "io/file/system_error_internal.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

enum {
    END_SIZE = 22,
    LOCATOR_SIZE = 20,
    END64_SIZE = 56,
    ENTRY_SIZE = 46,
    LOCAL_SIZE = 30,
    COMMENT_MAX = 65535
};

typedef struct directory {
    int file;
    uint64_t size; /* of the file */
    uint64_t begin, length, members;
} directory;

static imk_status refuse(const char *what, imk_error *error)
{
    return imk_error_set(error, IMK_ERROR_FORMAT, "", what, "copy the file again");
}

static imk_status read_bytes(const directory *d, uint64_t place, void *bytes, size_t size,
                             imk_error *error)
{
    if (place > d->size || size > d->size - place)
        return refuse("the zip file is cut short", error);
    const int number = imki_read_at(d->file, place, bytes, size);
    if (number > 0)
        return imki_system_error(error, IMK_ERROR_READ, "", number);
    return number < 0 ? refuse("the zip file is cut short", error) : IMK_OK;
}

static bool is_signature(const unsigned char *at, unsigned char third, unsigned char fourth)
{
    return at[0] == 'P' && at[1] == 'K' && at[2] == third && at[3] == fourth;
}

/* The end record, from the end of the file backwards. */
static imk_status find_end(const directory *d, uint64_t *place, unsigned char end[END_SIZE],
                           imk_error *error)
{
    const uint64_t most = END_SIZE + COMMENT_MAX, size = d->size < most ? d->size : most;
    unsigned char *tail = malloc(size > 0 ? (size_t)size : 1);
    if (!tail)
        return imk_error_set(error, IMK_ERROR_MEMORY, "", NULL, NULL);
    imk_status status = read_bytes(d, d->size - size, tail, (size_t)size, error);
    bool found = false;
    for (size_t at = (size_t)size; status == IMK_OK && !found && at-- > 0;)
        if (size - at >= END_SIZE && is_signature(tail + at, 5, 6)) {
            memcpy(end, tail + at, END_SIZE);
            *place = d->size - size + at;
            found = true;
        }
    free(tail);
    return status == IMK_OK && !found
               ? refuse("the zip file has no directory at its end: it is cut short", error)
               : status;
}

/* The zip64 end record, if there is one. */
static imk_status find_end64(directory *d, uint64_t end, imk_error *error)
{
    unsigned char locator[LOCATOR_SIZE], end64[END64_SIZE];
    if (end < LOCATOR_SIZE)
        return IMK_OK;
    imk_status status = read_bytes(d, end - LOCATOR_SIZE, locator, LOCATOR_SIZE, error);
    if (status != IMK_OK || !is_signature(locator, 6, 7))
        return status;
    status = read_bytes(d, imki_get_number(locator + 8, 8), end64, END64_SIZE, error);
    if (status != IMK_OK)
        return status;
    if (!is_signature(end64, 6, 6))
        return refuse("the zip64 directory of the zip file is damaged", error);
    d->members = imki_get_number(end64 + 32, 8);
    d->length = imki_get_number(end64 + 40, 8);
    d->begin = imki_get_number(end64 + 48, 8);
    return IMK_OK;
}

static imk_status find_directory(directory *d, imk_error *error)
{
    struct stat about;
    unsigned char end[END_SIZE];
    uint64_t place = 0;
    if (fstat(d->file, &about) != 0)
        return imki_system_error(error, IMK_ERROR_READ, "", errno);
    d->size = (uint64_t)about.st_size;
    imk_status status = find_end(d, &place, end, error);
    if (status != IMK_OK)
        return status;
    d->members = imki_get_number(end + 10, 2);
    d->length = imki_get_number(end + 12, 4);
    d->begin = imki_get_number(end + 16, 4);
    status = find_end64(d, place, error);
    if (status == IMK_OK && (d->begin > place || d->length > place - d->begin))
        status = refuse("the directory of the zip file is damaged", error);
    return status;
}

/* Sizes and place of 8 bytes. @return false: they are due and not there */
static bool read_extra(const unsigned char *extra, size_t size, imki_zip_member *member)
{
    uint64_t *const number[] = {&member->unpacked, &member->packed, &member->begin};
    bool due = false;
    for (size_t i = 0; i < 3; i++)
        due = due || *number[i] == 0xFFFFFFFF;
    while (due && size >= 4) {
        const size_t length = (size_t)imki_get_number(extra + 2, 2);
        if (length > size - 4)
            return false;
        if (imki_get_number(extra, 2) == 1) {
            size_t at = 4;
            for (size_t i = 0; i < 3; i++) {
                if (*number[i] != 0xFFFFFFFF)
                    continue;
                if (at + 8 > 4 + length)
                    return false;
                *number[i] = imki_get_number(extra + at, 8);
                at += 8;
            }
            return true;
        }
        extra += 4 + length;
        size -= 4 + length;
    }
    return !due;
}

/* Where the data begin, behind the local head. */
static imk_status find_data(const directory *d, imki_zip_member *member, imk_error *error)
{
    unsigned char head[LOCAL_SIZE];
    const imk_status status = read_bytes(d, member->begin, head, LOCAL_SIZE, error);
    if (status != IMK_OK)
        return status;
    const uint64_t local =
        LOCAL_SIZE + imki_get_number(head + 26, 2) + imki_get_number(head + 28, 2);
    if (!is_signature(head, 3, 4) || member->begin > d->begin || local > d->begin - member->begin ||
        member->packed > d->begin - member->begin - local ||
        (member->method == 0 && member->packed != member->unpacked))
        return refuse("the directory of the zip file does not fit its members", error);
    member->begin += local;
    return IMK_OK;
}

/* One entry of the directory. @param at  its place; moved behind it */
static imk_status read_entry(const directory *d, uint64_t *at, unsigned char *text,
                             imki_zip_member *member, imk_error *error)
{
    unsigned char entry[ENTRY_SIZE];
    imk_status status = read_bytes(d, *at, entry, ENTRY_SIZE, error);
    if (status != IMK_OK)
        return status;
    const size_t name = (size_t)imki_get_number(entry + 28, 2);
    const size_t extra = (size_t)imki_get_number(entry + 30, 2);
    const size_t whole = ENTRY_SIZE + name + extra + (size_t)imki_get_number(entry + 32, 2);
    if (!is_signature(entry, 1, 2) || whole > d->begin + d->length - *at)
        return refuse("the directory of the zip file is damaged", error);
    status = read_bytes(d, *at + ENTRY_SIZE, text, name + extra, error);
    if (status != IMK_OK)
        return status;
    *member = (imki_zip_member){.method = (uint16_t)imki_get_number(entry + 10, 2),
                                .encrypted = (entry[8] & 1) != 0,
                                .crc = (uint32_t)imki_get_number(entry + 16, 4),
                                .packed = imki_get_number(entry + 20, 4),
                                .unpacked = imki_get_number(entry + 24, 4),
                                .begin = imki_get_number(entry + 42, 4)};
    if (!read_extra(text + name, extra, member))
        return refuse("the directory of the zip file is damaged", error);
    const size_t kept = name < sizeof member->name ? name : sizeof member->name - 1;
    memcpy(member->name, text, kept);
    *at += whole;
    return find_data(d, member, error);
}

imk_status imki_zip_members(int file, imki_zip_visit visit, void *context, imk_error *error)
{
    directory d = {.file = file};
    imk_status status = find_directory(&d, error);
    unsigned char *text = malloc(2 * 65536); /* the longest name and extra field */
    if (status == IMK_OK && !text)
        status = imk_error_set(error, IMK_ERROR_MEMORY, "", NULL, NULL);
    uint64_t at = d.begin;
    for (uint64_t i = 0; i < d.members && status == IMK_OK; i++) {
        imki_zip_member member;
        status = d.begin + d.length - at < ENTRY_SIZE
                     ? refuse("the directory of the zip file is damaged", error)
                     : read_entry(&d, &at, text, &member, error);
        if (status == IMK_OK)
            status = visit(context, &member, error);
    }
    free(text);
    return status;
}
