/* SPDX-License-Identifier: Apache-2.0 */
/* Writing results: HDF5, or CSV with one row per run and time. Either is streamed, a block of runs
 * at a time, into a file that appears complete or not at all. */
#define _POSIX_C_SOURCE 200809L
#include "campaign_internal.h"
#include "imukit/decimal.h"
#include "imukit/names.h"
#include "io/file/output_file_internal.h"

#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

enum { BLOCK = 1 << 20 }; /* bytes of values at a time, at least one run */

bool imki_store_is_hdf5(const char *path)
{
    return imk_has_ending(path, ".h5");
}

static imk_status refuse_stream(const char *path, imk_error *error)
{
    return imk_error_set(error, IMK_ERROR_WRITE, path, "it is not a regular file",
                         "a regular file, because its checksum is written last");
}

imk_status imki_store_check(const char *path, imk_error *error)
{
    struct stat about;
    if (imki_store_is_hdf5(path) && stat(path, &about) == 0 && !S_ISREG(about.st_mode))
        return refuse_stream(path, error);
    if (imki_store_is_hdf5(path) || imk_has_ending(path, ".csv") ||
        imk_has_ending(path, ".csv.gz") || imk_has_ending(path, ".csv.zst"))
        return IMK_OK;
    return imk_error_set(error, IMK_ERROR_FORMAT, path, "",
                         "a name ending in .h5, .csv, .csv.gz or .csv.zst");
}

/* What is done with a block of runs. */
typedef struct store {
    imk_output_file *file;
    const imki_record *record;
    imki_seal seal;
} store;

static void put_csv_head(const store *s)
{
    const imk_campaign *c = &s->record->campaign;
    imk_output_file_print(s->file, "run,time [s]");
    for (size_t k = 0; k < c->state_count; k++) {
        imk_output_file_print(s->file, ",%.2000s", c->state[k]);
        if (c->unit[k][0] != '\0')
            imk_output_file_print(s->file, " [%.2000s]", c->unit[k]);
    }
    imk_output_file_write(s->file, "\n", 1);
}

static void put_csv_runs(const store *s, uint64_t place, uint64_t count, const double *values)
{
    const imk_campaign *c = &s->record->campaign;
    char text[IMK_DECIMAL_SIZE + 1];
    for (uint64_t i = 0; i < count; i++) {
        for (size_t t = 0; t < c->time_count; t++) {
            imk_output_file_print(s->file, "%llu,", (unsigned long long)s->record->run[place + i]);
            imk_output_file_write(s->file, text, imk_decimal_shortest(c->time[t], text));
            for (size_t k = 0; k < c->state_count; k++) {
                text[0] = ',';
                const size_t length = imk_decimal_shortest(*values++, text + 1);
                imk_output_file_write(s->file, text, length + 1);
            }
            imk_output_file_write(s->file, "\n", 1);
        }
    }
}

static imk_status put_blocks(store *s, bool hdf5, imki_values values, void *context,
                             imk_error *error)
{
    const uint64_t run_size = imki_run_size(&s->record->campaign), runs = s->record->runs;
    uint64_t at_once = BLOCK / run_size > 0 ? BLOCK / run_size : 1;
    if (at_once > runs && runs > 0)
        at_once = runs;
    double *block = malloc(at_once * run_size);
    imk_status status = block ? IMK_OK : imk_error_set(error, IMK_ERROR_MEMORY, "", "", "");
    for (uint64_t place = 0; place < runs && status == IMK_OK; place += at_once) {
        const uint64_t count = runs - place < at_once ? runs - place : at_once;
        status = values(context, place, count, block, error);
        if (status != IMK_OK)
            break;
        if (!hdf5) {
            put_csv_runs(s, place, count, block);
            continue;
        }
        s->seal.crc = imki_crc(s->seal.crc, block, count * run_size);
        /* A write error is kept by the file and told at its commit; no need to go on, though. */
        if (imk_output_file_write(s->file, block, count * run_size) != IMK_OK)
            break;
    }
    free(block);
    return status;
}

/* What is in front of the values. */
static imk_status put_hdf5_head(store *s, const char *path, imk_error *error)
{
    unsigned char *bytes;
    size_t size;
    if (!imki_output_file_can_replace(s->file))
        return refuse_stream(path, error);
    const imk_status status = imki_hdf5_write(s->record, path, &bytes, &size, error);
    if (status != IMK_OK)
        return status;
    s->seal.size = size + s->record->runs * imki_run_size(&s->record->campaign);
    imki_seal_put(s->seal, bytes);
    s->seal.crc = imki_crc(0, bytes, size);
    imk_output_file_write(s->file, bytes, size);
    free(bytes);
    return IMK_OK;
}

static void put_seal(const store *s)
{
    unsigned char block[IMKI_SEAL_SIZE];
    imki_seal_put(s->seal, block);
    imki_output_file_replace(s->file, 0, block, sizeof block);
}

imk_status imki_store(const char *path, const imki_record *record, imki_values values,
                      void *context, imk_error *error)
{
    const bool hdf5 = imki_store_is_hdf5(path);
    store s = {.record = record};
    imk_status status = imk_output_file_open(path, &s.file, error);
    if (status != IMK_OK)
        return status;
    if (hdf5)
        status = put_hdf5_head(&s, path, error);
    else
        put_csv_head(&s);
    if (status == IMK_OK)
        status = put_blocks(&s, hdf5, values, context, error);
    if (status != IMK_OK) {
        imk_output_file_abandon(s.file);
        return status;
    }
    if (hdf5)
        put_seal(&s);
    return imk_output_file_commit(s.file, error);
}
