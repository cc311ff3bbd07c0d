/* SPDX-License-Identifier: Apache-2.0 */
/* The stamps of a source that is too long to be held: it is read once for them alone. */
#include "record_stamps_internal.h"

#include "jobs/arena_internal.h"
#include "jobs/job_internal.h"

enum { ROWS = 1 << 14 };

static imk_status add_rows(const imk_record_source *source, const imk_job *job,
                           double *const *columns, imki_stamps *stamps, imk_error *error)
{
    imk_status status = IMK_OK;
    for (size_t got = 1; status == IMK_OK && got > 0;) {
        uint64_t done, size;
        status = source->read(source->context, ROWS, columns, &got, error);
        if (status == IMK_OK && !imki_stamps_add(stamps, got, columns))
            status = imk_error_set(error, IMK_ERROR_MEMORY, "time", NULL, NULL);
        source->progress(source->context, &done, &size);
        if (status == IMK_OK)
            status = imki_job_progress(job, "reading the times", "B", done, size, error);
    }
    return status;
}

imk_status imki_stamps_of_source(const imk_record_source *source, const imk_job *job,
                                 imki_stamps *stamps, imk_error *error)
{
    imki_arena scratch = {.allocator = job->allocator};
    double *column[IMK_LOG_COLUMNS_MAX] = {NULL};
    *stamps = (imki_stamps){.allocator = job->allocator,
                            .column_count = source->column_count,
                            .time_column = (size_t)imk_record_find(source, IMK_QUANTITY_TIME, -1)};
    bool room = true;
    for (size_t c = 0; c < source->column_count; c++) {
        column[c] = imki_arena_room(&scratch, ROWS * sizeof *column[c]);
        room = room && column[c];
    }
    imk_status status = room ? source->rewind(source->context, error)
                             : imk_error_set(error, IMK_ERROR_MEMORY, "time", NULL, NULL);
    if (status == IMK_OK)
        status = add_rows(source, job, column, stamps, error);
    if (status == IMK_OK)
        status = source->rewind(source->context, error);
    imki_arena_free(&scratch);
    if (status != IMK_OK)
        imki_stamps_free(stamps);
    return status;
}
