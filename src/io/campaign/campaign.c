/* SPDX-License-Identifier: Apache-2.0 */
/* The results file of a campaign in the making: runs are kept in PATH.part in the order in which
 * they come, and copied in the order of their numbers when all are there. */
#define _POSIX_C_SOURCE 200809L
#include "campaign_internal.h"
#include "io/file/output_file_internal.h"

#include "imukit/utf8.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

struct imk_campaign_writer {
    pthread_mutex_t mutex;
    char *path;
    imki_record record;
    imki_part part;       /* while `finished` is false */
    imki_results results; /* the whole file, when it was there already */
    bool finished;
    uint64_t first, done;
    uint64_t *place; /* of each run's values in the part; 0: not there */
};

void imk_campaign_shard(uint64_t run_count, uint64_t index, uint64_t count, uint64_t *first,
                        uint64_t *runs)
{
    /* The first run_count % count shards have one more. */
    const uint64_t least = run_count / count, more = run_count % count, before = index - 1;
    *first = before * least + (before < more ? before : more);
    *runs = least + (before < more);
}

static void release(imk_campaign_writer *w)
{
    pthread_mutex_destroy(&w->mutex);
    imki_record_free(&w->record);
    free(w->path);
    free(w->place);
    free(w);
}

/* Is the results file there, whole, and of this shard? */
static bool is_finished(imk_campaign_writer *w)
{
    imk_error ignored;
    if (!imki_store_is_hdf5(w->path) || imki_results_open(w->path, &w->results, &ignored) != IMK_OK)
        return false;
    if (w->results.record.head_size == w->record.head_size &&
        memcmp(w->results.record.head, w->record.head, w->record.head_size) == 0)
        return true;
    imki_results_close(&w->results);
    return false;
}

static imk_status start(imk_campaign_writer *w, imk_error *error)
{
    w->finished = is_finished(w);
    if (w->finished) {
        w->done = w->record.runs;
        return IMK_OK;
    }
    imk_status status = imki_output_file_check(w->path, error);
    if (status == IMK_OK)
        status = imki_part_open(w->path, &w->record, w->place, &w->part, error);
    for (uint64_t i = 0; i < w->record.runs && status == IMK_OK; i++)
        w->done += w->place[i] != 0;
    return status;
}

/* Errors of the campaign itself are about its file. */
static imk_status name_path(imk_status status, const char *path, imk_error *error)
{
    if (status != IMK_OK && error && error->field[0] == '\0')
        imk_utf8_shorten(path, error->field, sizeof error->field);
    return status;
}

imk_status imk_campaign_create(const char *path, const imk_campaign *campaign, uint64_t first,
                               uint64_t runs, imk_campaign_writer **writer, imk_error *error)
{
    imk_status status = imki_store_check(path, error);
    if (status != IMK_OK)
        return status;
    if (runs == 0 || first >= campaign->run_count || runs > campaign->run_count - first)
        return imk_error_set(error, IMK_ERROR_RANGE, path, "the shard has no runs",
                             "fewer shards than runs");
    imk_campaign_writer *w = calloc(1, sizeof *w);
    uint64_t *run = malloc(runs * sizeof *run);
    if (!w || !run || !(w->path = strdup(path)) || !(w->place = calloc(runs, sizeof *w->place))) {
        free(w ? w->path : NULL);
        free(w);
        free(run);
        return imk_error_set(error, IMK_ERROR_MEMORY, path, "", "");
    }
    pthread_mutex_init(&w->mutex, NULL);
    w->part.file = w->results.file = -1;
    w->first = first;
    for (uint64_t i = 0; i < runs; i++)
        run[i] = first + i;
    status = imki_record_make(campaign, runs, run, &w->record, error);
    free(run);
    if (status == IMK_OK)
        status = start(w, error);
    if (status != IMK_OK) {
        release(w);
        return name_path(status, path, error);
    }
    *writer = w;
    return IMK_OK;
}

uint64_t imk_campaign_done(const imk_campaign_writer *writer)
{
    return writer->done;
}

static bool contains(const imk_campaign_writer *w, uint64_t first, uint64_t runs)
{
    return first >= w->first && first - w->first < w->record.runs &&
           runs <= w->record.runs - (first - w->first);
}

bool imk_campaign_has(const imk_campaign_writer *writer, uint64_t run)
{
    return contains(writer, run, 1) && (writer->finished || writer->place[run - writer->first]);
}

/* Runs by their places in the shard, for imki_store(). */
static imk_status read_runs(void *context, uint64_t place, uint64_t count, double *values,
                            imk_error *error)
{
    const imk_campaign_writer *w = context;
    if (w->finished)
        return name_path(imki_results_read(&w->results, place, count, values, error), w->path,
                         error);
    unsigned char *at = (unsigned char *)values;
    for (uint64_t i = 0; i < count; i++, at += w->part.run_size) {
        const int number =
            imki_read_at(w->part.file, w->place[place + i], at, (size_t)w->part.run_size);
        if (number != 0)
            return imki_read_error(number, w->part.path, error);
    }
    return IMK_OK;
}

imk_status imk_campaign_read(imk_campaign_writer *writer, uint64_t first, uint64_t runs,
                             double *values, imk_error *error)
{
    for (uint64_t i = 0; i < runs; i++)
        if (!imk_campaign_has(writer, first + i))
            return imk_error_set(error, IMK_ERROR_EMPTY, writer->path, "", "");
    return read_runs(writer, first - writer->first, runs, values, error);
}

imk_status imk_campaign_add(imk_campaign_writer *writer, uint64_t first, uint64_t runs,
                            const double *values, imk_error *error)
{
    if (!contains(writer, first, runs) || runs > UINT32_MAX)
        return imk_error_set(error, IMK_ERROR_RANGE, writer->path, "the runs are not of this shard",
                             "");
    if (writer->finished || runs == 0)
        return IMK_OK;
    uint64_t at = 0;
    pthread_mutex_lock(&writer->mutex);
    const imk_status status = imki_part_add(&writer->part, first, runs, values, &at, error);
    for (uint64_t i = 0; i < runs && status == IMK_OK; i++) {
        uint64_t *place = &writer->place[first - writer->first + i];
        writer->done += *place == 0;
        *place = at + i * writer->part.run_size;
    }
    pthread_mutex_unlock(&writer->mutex);
    return status;
}

imk_status imk_campaign_commit(imk_campaign_writer *writer, imk_error *error)
{
    imk_status status = IMK_OK;
    if (writer->done < writer->record.runs) {
        char found[96];
        snprintf(found, sizeof found, "%llu of %llu runs are missing",
                 (unsigned long long)(writer->record.runs - writer->done),
                 (unsigned long long)writer->record.runs);
        status = imk_error_set(error, IMK_ERROR_CONFLICT, writer->path, found, "compute them");
    } else if (!writer->finished) {
        status = imki_store(writer->path, &writer->record, read_runs, writer, error);
    }
    imki_part_close(&writer->part, status == IMK_OK);
    imki_results_close(&writer->results);
    release(writer);
    return status;
}

void imk_campaign_stop(imk_campaign_writer *writer)
{
    if (!writer)
        return;
    imki_part_close(&writer->part, false);
    imki_results_close(&writer->results);
    release(writer);
}
