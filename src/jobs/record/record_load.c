/* SPDX-License-Identifier: Apache-2.0 */
/* A whole record in memory. */
#include "even_record_internal.h"
#include "record_check_internal.h"

#include "jobs/arena_internal.h"
#include "jobs/job_internal.h"

#include <stdio.h>
#include <string.h>

enum { LOAD_ROWS = 1 << 16, FIRST_CAPACITY = 1 << 12 };

int imk_log_find(const imk_log *log, imk_quantity quantity, int axis)
{
    for (size_t i = 0; i < log->column_count; i++)
        if (log->column[i].quantity == quantity && log->column[i].axis == axis)
            return (int)i;
    return -1;
}

void imk_log_free(imk_log *log)
{
    for (size_t i = 0; i < IMK_LOG_COLUMNS_MAX; i++)
        imki_resize(&log->allocator, log->data[i], 0);
    imki_resize(&log->allocator, log->label, 0);
    *log = (imk_log){0};
}

/* Room for `capacity` rows and one more in every column. */
static bool set_capacity(imk_log *log, size_t capacity)
{
    for (size_t i = 0; i < log->column_count; i++) {
        double *larger =
            imki_resize(&log->allocator, log->data[i], (capacity + 1) * sizeof(double));
        if (!larger)
            return false;
        log->data[i] = larger;
    }
    return true;
}

static void progress_of(const imk_record_source *source, uint64_t *done, uint64_t *size)
{
    *done = *size = 0;
    if (source->progress)
        source->progress(source->context, done, size);
}

/* Rows to make room for when all of `rows` is full: as many as the source seems to hold, assessing
 * by the part read, and half as many again at least. */
static size_t next_capacity(const imk_record_source *source, size_t rows)
{
    uint64_t done, size;
    progress_of(source, &done, &size);
    const size_t least = rows + rows / 2;
    if (done == 0 || size <= done)
        return least;
    const double estimate = (double)rows * ((double)size / (double)done) * 1.01;
    /* A part that shows little, such as long comments before the rows, must not ask for too much.
     */
    const double most = 64.0 * (double)rows;
    const size_t bounded = (size_t)(estimate < most ? estimate : most);
    return bounded > least ? bounded : least;
}

/* A few bytes of compressed text are rows without end; what is beyond the memory of the machine
 * would end the program, or all others, without a word. */
static imk_status refuse_length(const imk_log *log, imk_error *error)
{
    char found[96];
    const double taken = (double)log->rows * (double)log->column_count * sizeof(double);
    snprintf(found, sizeof found, "memory is full: %zu rows of %zu columns take %.1f MB", log->rows,
             log->column_count, 1e-6 * taken);
    return imk_error_set(error, IMK_ERROR_MEMORY, "", found,
                         "cut the log into parts, or leave out columns (--columns with -)");
}

/* Fill the room there is. @param more  false at the end of the source */
static imk_status fill(const imk_record_source *source, const imk_job *job, size_t capacity,
                       imk_log *log, bool *more, imk_error *error)
{
    while (log->rows < capacity) {
        double *place[IMK_LOG_COLUMNS_MAX];
        for (size_t i = 0; i < log->column_count; i++)
            place[i] = log->data[i] + log->rows;
        const size_t room = capacity - log->rows;
        size_t got;
        imk_status status =
            source->read(source->context, room < LOAD_ROWS ? room : LOAD_ROWS, place, &got, error);
        uint64_t done, size;
        *more = status == IMK_OK && got > 0;
        if (!*more)
            return status;
        log->rows += got;
        progress_of(source, &done, &size);
        status = imki_job_progress(job, "reading", "B", done, size, error);
        if (status != IMK_OK)
            return status;
    }
    return IMK_OK;
}

static imk_status take_labels(const imk_record_source *source, imk_log *log, imk_error *error)
{
    const char *text;
    for (size_t k = 0; source->label && (text = source->label(source->context, k)); k++) {
        if ((k & (k - 1)) == 0) { /* room for twice as many */
            void *larger =
                imki_resize(&log->allocator, log->label, (k > 0 ? 2 * k : 1) * sizeof *log->label);
            if (!larger)
                return imk_error_set(error, IMK_ERROR_MEMORY, "", NULL, NULL);
            log->label = larger;
        }
        snprintf(log->label[k], sizeof log->label[k], "%s", text);
        log->label_count = k + 1;
    }
    return IMK_OK;
}

imk_status imki_record_load(const imk_record_source *source, const imk_job *job, imk_log *log,
                            imk_error *error)
{
    imk_status status = imki_check_source(source, error);
    if (status != IMK_OK)
        return status;
    imk_log made = {.column_count = source->column_count, .allocator = job->allocator};
    const size_t row_bytes = made.column_count * sizeof(double);
    const size_t rows_most = job->memory > 0 ? job->memory / row_bytes : SIZE_MAX / row_bytes / 2;
    size_t capacity = FIRST_CAPACITY;
    bool more = true;
    while (status == IMK_OK && more) {
        if (made.rows == capacity)
            capacity = next_capacity(source, made.rows);
        capacity = capacity < rows_most ? capacity : rows_most;
        if (made.rows == capacity || !set_capacity(&made, capacity))
            status = refuse_length(&made, error);
        else
            status = fill(source, job, capacity, &made, &more, error);
    }
    if (status == IMK_OK)
        status = take_labels(source, &made, error);
    if (status == IMK_OK)
        status = imki_source_findings(source, made.rows, made.data, &job->allocator, &made.findings,
                                      error);
    if (status != IMK_OK) {
        imk_log_free(&made);
        return status;
    }
    memcpy(made.column, source->columns, made.column_count * sizeof made.column[0]);
    set_capacity(&made, made.rows); /* give back what is not used; cannot grow */
    *log = made;
    return IMK_OK;
}
