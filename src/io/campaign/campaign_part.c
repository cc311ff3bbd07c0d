/* SPDX-License-Identifier: Apache-2.0 */
/* PATH.part: runs as they come, kept through the end of the process.
 *
 *   "imukit campaign part 1\n", size of the head (8 bytes), head, CRC-32 of these (4 bytes)
 *   records: "RUNS", number of runs (4), first run (8), CRC-32 of the values (4),
 *            CRC-32 of the 20 bytes before (4), values
 *
 * All little-endian. A record is added by writes at the end of the file, under a lock that the
 * system releases when the process dies, however it does. What a death or a full disk leaves of a
 * record is found by its checksums: values that do not agree cost their record, a record head that
 * does not agree ends the file. */
#if defined(__APPLE__)
#define _DARWIN_C_SOURCE /* flock() */
#else
#define _DEFAULT_SOURCE
#endif
#include "campaign_internal.h"
#include "io/file/system_error_internal.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

static const char magic[] = "imukit campaign part 1\n";
static const char record_magic[4] = {'R', 'U', 'N', 'S'};
enum { MAGIC = sizeof magic - 1, FILE_HEAD = MAGIC + 8, CRC = 4, RECORD_HEAD = 24 };

/* What a crash of the whole machine may cost, against what waiting for a slow disk does. */
static const double sync_interval = 5.0; /* [s] */

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* @return 0 or an errno value */
static int write_at(int file, uint64_t offset, const void *bytes, size_t size)
{
    const unsigned char *at = bytes;
    while (size > 0) {
        const ssize_t count = pwrite(file, at, size, (off_t)offset);
        if (count < 0 && errno == EINTR)
            continue;
        if (count <= 0)
            return count < 0 ? errno : ENOSPC;
        at += count;
        offset += (uint64_t)count;
        size -= (size_t)count;
    }
    return 0;
}

/* ---------------------------------------------------------------------------------------- head */

static imk_status write_head(imki_part *part, const imki_record *record, imk_error *error)
{
    unsigned char size[8], crc[CRC];
    imki_put_number(size, record->head_size, sizeof size);
    uint32_t sum = imki_crc(0, magic, MAGIC);
    sum = imki_crc(sum, size, sizeof size);
    imki_put_number(crc, imki_crc(sum, record->head, record->head_size), CRC);
    int number = ftruncate(part->file, 0) == 0 ? 0 : errno;
    if (number == 0)
        number = write_at(part->file, 0, magic, MAGIC);
    if (number == 0)
        number = write_at(part->file, MAGIC, size, sizeof size);
    if (number == 0)
        number = write_at(part->file, FILE_HEAD, record->head, record->head_size);
    if (number == 0)
        number = write_at(part->file, FILE_HEAD + record->head_size, crc, CRC);
    if (number != 0)
        return imki_system_error(error, IMK_ERROR_WRITE, part->path, number);
    part->end = FILE_HEAD + record->head_size + CRC;
    return IMK_OK;
}

static imk_status belongs_elsewhere(const imki_part *part, const char *found, imk_error *error)
{
    return imk_error_set(error, IMK_ERROR_CONFLICT, part->path, found,
                         "remove the file to begin anew, or choose another name for the results");
}

/* Say what another head is about. */
static imk_status compare_heads(const imki_part *part, const imki_record *there,
                                const imki_record *own, imk_error *error)
{
    imk_error difference;
    char found[96];
    if (imki_campaign_compare(&there->campaign, &own->campaign, &difference) != IMK_OK)
        return belongs_elsewhere(part, difference.found, error);
    if (there->head_size == own->head_size && memcmp(there->head, own->head, own->head_size) == 0)
        return IMK_OK;
    snprintf(found, sizeof found, "the file is of the shard of runs %llu-%llu, not %llu-%llu",
             (unsigned long long)there->run[0], (unsigned long long)there->run[there->runs - 1],
             (unsigned long long)own->run[0], (unsigned long long)own->run[own->runs - 1]);
    return belongs_elsewhere(part, found, error);
}

/* @return IMK_OK; IMK_ERROR_EMPTY: no whole head, write one; others: refuse */
static imk_status read_head(imki_part *part, const imki_record *own, uint64_t file_size,
                            imk_error *error)
{
    unsigned char begin[FILE_HEAD], crc[CRC];
    if (file_size < FILE_HEAD + CRC)
        return IMK_ERROR_EMPTY;
    int number = imki_read_at(part->file, 0, begin, sizeof begin);
    if (number != 0)
        return imki_read_error(number, part->path, error);
    if (memcmp(begin, magic, MAGIC) != 0)
        return belongs_elsewhere(part, "the file is not from an interrupted campaign", error);
    const uint64_t size = imki_get_number(begin + MAGIC, 8);
    if (size > file_size - FILE_HEAD - CRC)
        return IMK_ERROR_EMPTY;
    unsigned char *head = malloc(size > 0 ? size : 1);
    if (!head)
        return imk_error_set(error, IMK_ERROR_MEMORY, part->path, "", "");
    number = imki_read_at(part->file, FILE_HEAD, head, size);
    if (number == 0)
        number = imki_read_at(part->file, FILE_HEAD + size, crc, CRC);
    if (number != 0) {
        free(head);
        return imki_read_error(number, part->path, error);
    }
    imki_record there;
    const uint32_t sum = imki_crc(imki_crc(0, begin, sizeof begin), head, size);
    imk_status status = IMK_ERROR_FORMAT;
    if (imki_get_number(crc, CRC) == sum)
        status = imki_record_read(head, size, &there, error);
    else
        free(head);
    if (status != IMK_OK)
        return status == IMK_ERROR_MEMORY ? status
                                          : belongs_elsewhere(part, "its header is damaged", error);
    status = compare_heads(part, &there, own, error);
    imki_record_free(&there);
    part->end = FILE_HEAD + size + CRC;
    return status;
}

/* ------------------------------------------------------------------------------------- records */

/* Find the records, up to the first that is not whole. */
static imk_status find_records(imki_part *part, const imki_record *record, uint64_t file_size,
                               uint64_t *place, imk_error *error)
{
    unsigned char head[RECORD_HEAD];
    const uint64_t first = record->run[0];
    int number = 0;
    while (number == 0 && file_size - part->end >= RECORD_HEAD) {
        number = imki_read_at(part->file, part->end, head, sizeof head);
        if (number != 0 || memcmp(head, record_magic, 4) != 0 ||
            imki_get_number(head + 20, 4) != imki_crc(0, head, 20))
            break;
        const uint64_t runs = imki_get_number(head + 4, 4), from = imki_get_number(head + 8, 8),
                       values = part->end + RECORD_HEAD, size = runs * part->run_size;
        uint32_t crc = 0;
        if (runs > record->runs || from < first || from - first > record->runs - runs ||
            size > file_size - values)
            break;
        number = imki_crc_at(part->file, values, size, &crc);
        for (uint64_t i = 0; i < runs && number == 0; i++)
            if (imki_get_number(head + 16, 4) == crc)
                place[from - first + i] = values + i * part->run_size;
        if (number == 0)
            part->end = values + size;
    }
    /* The file may end within a record. */
    if (number > 0)
        return imki_read_error(number, part->path, error);
    return IMK_OK;
}

imk_status imki_part_add(imki_part *part, uint64_t first, uint64_t runs, const double *values,
                         uint64_t *at, imk_error *error)
{
    unsigned char head[RECORD_HEAD];
    const size_t size = (size_t)(runs * part->run_size);
    memcpy(head, record_magic, 4);
    imki_put_number(head + 4, runs, 4);
    imki_put_number(head + 8, first, 8);
    imki_put_number(head + 16, imki_crc(0, values, size), 4);
    imki_put_number(head + 20, imki_crc(0, head, 20), 4);
    int number = write_at(part->file, part->end, head, sizeof head);
    if (number == 0)
        number = write_at(part->file, part->end + RECORD_HEAD, values, size);
    if (number == 0 && now() - part->synced >= sync_interval) {
        number = fsync(part->file) == 0 ? 0 : errno;
        part->synced = now();
    }
    if (number != 0) {
        /* What is beyond the end would be ignored all the same; the space is given back. */
        const int cut = ftruncate(part->file, (off_t)part->end);
        (void)cut;
        (void)imki_system_error(error, IMK_ERROR_WRITE, part->path, number);
        if (error)
            snprintf(error->expected, sizeof error->expected,
                     "make room: the runs computed before are kept");
        return IMK_ERROR_WRITE;
    }
    *at = part->end + RECORD_HEAD;
    part->end += RECORD_HEAD + size;
    return IMK_OK;
}

/* -------------------------------------------------------------------------------- open and close
 */

/* Open and lock the file that has the name: one that another process finished with and removed in
 * between does not count. @return 0 or an errno value */
static int open_locked(const char *path, int *file)
{
    for (;;) {
        struct stat opened, named;
        *file = open(path, O_RDWR | O_CREAT | O_CLOEXEC | O_NOCTTY, 0666);
        if (*file < 0)
            return errno;
        if (flock(*file, LOCK_EX | LOCK_NB) != 0 || fstat(*file, &opened) != 0) {
            const int number = errno;
            close(*file);
            return number;
        }
        if (stat(path, &named) == 0 && named.st_ino == opened.st_ino &&
            named.st_dev == opened.st_dev)
            return 0;
        close(*file);
    }
}

static imk_status read_part(imki_part *part, const imki_record *record, uint64_t *place,
                            imk_error *error)
{
    struct stat about;
    if (fstat(part->file, &about) != 0 || !S_ISREG(about.st_mode))
        return imk_error_set(error, IMK_ERROR_OPEN, part->path, "it is not a regular file", "");
    const uint64_t size = (uint64_t)about.st_size;
    imk_status status = read_head(part, record, size, error);
    if (status == IMK_ERROR_EMPTY)
        return write_head(part, record, error);
    if (status == IMK_OK)
        status = find_records(part, record, size, place, error);
    if (status == IMK_OK && part->end < size && ftruncate(part->file, (off_t)part->end) != 0)
        status = imki_system_error(error, IMK_ERROR_WRITE, part->path, errno);
    return status;
}

imk_status imki_part_open(const char *path, const imki_record *record, uint64_t *place,
                          imki_part *part, imk_error *error)
{
    const size_t size = strlen(path) + sizeof ".part";
    *part =
        (imki_part){.file = -1, .path = malloc(size), .run_size = imki_run_size(&record->campaign)};
    if (!part->path)
        return imk_error_set(error, IMK_ERROR_MEMORY, path, "", "");
    snprintf(part->path, size, "%s.part", path);
    const int number = open_locked(part->path, &part->file);
    imk_status status = IMK_OK;
    if (number != 0) {
        part->file = -1;
        status =
            number == EWOULDBLOCK
                ? imk_error_set(
                      error, IMK_ERROR_CONFLICT, part->path, "another process is writing this file",
                      "wait until that process ends, or choose another name for the results")
                : imki_system_error(error, IMK_ERROR_OPEN, part->path, number);
    }
    part->synced = now();
    if (status == IMK_OK)
        status = read_part(part, record, place, error);
    if (status != IMK_OK)
        imki_part_close(part, false);
    return status;
}

void imki_part_close(imki_part *part, bool remove_it)
{
    if (remove_it && part->file >= 0)
        unlink(part->path);
    if (part->file >= 0)
        close(part->file);
    free(part->path);
    *part = (imki_part){.file = -1};
}
