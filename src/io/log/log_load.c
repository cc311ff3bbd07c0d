/* SPDX-License-Identifier: Apache-2.0 */
/* A whole log in memory. */
#include "log_reader_internal.h"

#include "imukit/memory_limit.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LOAD_ROWS = 1 << 16, FIRST_CAPACITY = 1 << 12 };

/* Room for `capacity` rows and one more in every column. */
static bool set_capacity(imk_log *log, size_t capacity)
{
    for (size_t i = 0; i < log->column_count; i++) {
        double *larger = realloc(log->data[i], (capacity + 1) * sizeof(double));
        if (!larger)
            return false;
        log->data[i] = larger;
    }
    return true;
}

/* Rows to make room for when all of `rows` is full: as many as the file seems to hold, judging by
 * the part read, and half as many again at least. */
static size_t next_capacity(const imk_log_reader *reader, size_t rows)
{
    uint64_t done, size;
    imk_log_progress(reader, &done, &size);
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

static imk_status read_all(imk_log_reader *reader, size_t rows_most, imk_progress progress,
                           void *context, imk_log *log, imk_error *error)
{
    size_t capacity = FIRST_CAPACITY;
    for (;;) {
        if (log->rows == capacity)
            capacity = next_capacity(reader, log->rows);
        capacity = capacity < rows_most ? capacity : rows_most;
        if (log->rows == capacity || !set_capacity(log, capacity))
            return refuse_length(log, error);
        while (log->rows < capacity) {
            double *place[IMK_LOG_COLUMNS_MAX];
            for (size_t i = 0; i < log->column_count; i++)
                place[i] = log->data[i] + log->rows;
            const size_t room = capacity - log->rows;
            size_t got;
            const imk_status status =
                imk_log_read(reader, room < LOAD_ROWS ? room : LOAD_ROWS, place, &got, error);
            if (status != IMK_OK)
                return status;
            if (got == 0)
                return IMK_OK;
            log->rows += got;
            if (progress) {
                uint64_t done, size;
                imk_log_progress(reader, &done, &size);
                progress(context, done, size);
            }
        }
    }
}

imk_status imk_log_load(const char *path, const imk_log_settings *settings, imk_progress progress,
                        void *progress_context, imk_log *log, imk_error *error)
{
    imk_log_reader *reader;
    imk_status status = imk_log_open(path, settings, &reader, error);
    if (status != IMK_OK)
        return status;
    imk_log made = {.column_count = reader->layout.column_count};
    const size_t memory =
        settings && settings->memory > 0 ? settings->memory : imk_memory_limit() / 2;
    status = read_all(reader, memory / (made.column_count * sizeof(double)), progress,
                      progress_context, &made, error);
    if (status == IMK_OK) {
        memcpy(made.column, reader->layout.column, made.column_count * sizeof made.column[0]);
        made.findings = imk_log_findings_get(reader);
        set_capacity(&made, made.rows); /* give back what is not used; cannot grow */
        made.label = reader->labels;
        made.label_count = reader->label_count;
        reader->labels = NULL;
        *log = made;
    } else {
        imk_log_free(&made);
    }
    imk_log_close(reader);
    return status;
}

void imk_log_free(imk_log *log)
{
    for (size_t i = 0; i < IMK_LOG_COLUMNS_MAX; i++)
        free(log->data[i]);
    free(log->label);
    *log = (imk_log){0};
}

int imk_log_find(const imk_log *log, imk_quantity quantity, int axis)
{
    for (size_t i = 0; i < log->column_count; i++)
        if (log->column[i].quantity == quantity && log->column[i].axis == axis)
            return (int)i;
    return -1;
}
