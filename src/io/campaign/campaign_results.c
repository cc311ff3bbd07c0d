/* SPDX-License-Identifier: Apache-2.0 */
/* Reading results files. */
#define _POSIX_C_SOURCE 200809L
#include "campaign_internal.h"
#include "io/file/system_error_internal.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static imk_status refuse_stream(imk_error *error)
{
    return imk_error_set(error, IMK_ERROR_OPEN, "", "a results file cannot be read through a pipe",
                         "give the file itself");
}

/* A FIFO is not waited for: it is refused. @return an open regular file, its size; -1 on error */
static int open_file(const char *path, uint64_t *size, imk_status *status, imk_error *error)
{
    struct stat about;
    if (strcmp(path, "-") == 0) {
        *status = refuse_stream(error);
        return -1;
    }
    const int file = open(path, O_RDONLY | O_CLOEXEC | O_NOCTTY | O_NONBLOCK);
    if (file < 0 || fstat(file, &about) != 0)
        *status = imki_system_error(error, IMK_ERROR_OPEN, "", errno);
    else if (S_ISDIR(about.st_mode))
        *status = imki_system_error(error, IMK_ERROR_OPEN, "", EISDIR);
    else if (!S_ISREG(about.st_mode))
        *status = refuse_stream(error);
    else
        *status = IMK_OK;
    if (*status == IMK_OK) {
        *size = (uint64_t)about.st_size;
        return file;
    }
    if (file >= 0)
        close(file);
    return -1;
}

/* Open and verify. */
static imk_status open_verified(const char *path, int *file, imki_seal *seal, imk_error *error)
{
    uint64_t size = 0;
    imk_status status;
    *file = open_file(path, &size, &status, error);
    if (status == IMK_OK)
        status = imki_seal_verify(*file, size, seal, error);
    if (status != IMK_OK && *file >= 0) {
        close(*file);
        *file = -1;
    }
    return status;
}

imk_status imki_results_open(const char *path, imki_results *results, imk_error *error)
{
    imki_results made = {0};
    imk_status status = open_verified(path, &made.file, &made.seal, error);
    if (status != IMK_OK)
        return status;
    status = imki_hdf5_read(path, made.file, made.seal.size, &made.record, &made.values, error);
    if (status != IMK_OK)
        close(made.file);
    else
        *results = made;
    return status;
}

void imki_results_pause(imki_results *results)
{
    if (results->file >= 0)
        close(results->file);
    results->file = -1;
}

imk_status imki_results_resume(const char *path, imki_results *results, imk_error *error)
{
    imki_seal seal;
    const imk_status status = open_verified(path, &results->file, &seal, error);
    if (status != IMK_OK || (seal.size == results->seal.size && seal.crc == results->seal.crc))
        return status;
    imki_results_pause(results);
    return imk_error_set(error, IMK_ERROR_READ, "", "the file has changed meanwhile",
                         "start again");
}

imk_status imki_results_read(const imki_results *results, uint64_t place, uint64_t count,
                             double *values, imk_error *error)
{
    const uint64_t size = imki_run_size(&results->record.campaign);
    const int number =
        imki_read_at(results->file, results->values + place * size, values, (size_t)(count * size));
    return number == 0 ? IMK_OK : imki_read_error(number, "", error);
}

void imki_results_close(imki_results *results)
{
    imki_results_pause(results);
    imki_record_free(&results->record);
}

/* ---- in memory ---- */

typedef struct loaded {
    imk_campaign_results results; /* first: what the caller sees */
    imki_record record;
    double *values;
} loaded;

imk_status imk_campaign_load(const char *path, imk_campaign_results **results, imk_error *error)
{
    imki_results file;
    imk_status status = imki_results_open(path, &file, error);
    if (status != IMK_OK)
        return status;
    const imki_record *r = &file.record;
    loaded *made = calloc(1, sizeof *made);
    double *values = malloc(r->runs * imki_run_size(&r->campaign));
    if (!made || !values)
        status = imk_error_set(error, IMK_ERROR_MEMORY, "", "", "");
    else
        status = imki_results_read(&file, 0, r->runs, values, error);
    if (status != IMK_OK) {
        free(values);
        free(made);
        imki_results_close(&file);
        return status;
    }
    made->record = file.record;
    made->values = values;
    made->results = (imk_campaign_results){file.record.campaign, r->runs, r->run, values};
    file.record = (imki_record){0};
    imki_results_close(&file);
    *results = &made->results;
    return IMK_OK;
}

void imk_campaign_free(imk_campaign_results *results)
{
    loaded *made = (loaded *)(void *)results;
    if (!made)
        return;
    imki_record_free(&made->record);
    free(made->values);
    free(made);
}
