/* SPDX-License-Identifier: Apache-2.0 */
/* A log as a source of records, a first look at it, and a whole log in memory. */
#include "jobs/job_internal.h"
#include "jobs/record/even_record_internal.h"
#include "log_reader_internal.h"

#include "imukit/memory_limit.h"

static imk_status read_rows(void *context, size_t rows_most, double *const *columns, size_t *rows,
                            imk_error *error)
{
    return imk_log_read(context, rows_most, columns, rows, error);
}

static imk_status rewind_rows(void *context, imk_error *error)
{
    return imki_log_rewind(context, error);
}

static imk_status seek_row(void *context, double fraction, imk_error *error)
{
    return imk_log_seek(context, fraction, error);
}

static imk_log_findings findings_of(void *context)
{
    return imk_log_findings_get(context);
}

static void progress_of(void *context, uint64_t *done, uint64_t *total)
{
    imk_log_progress(context, done, total);
}

static const char *label_of(void *context, size_t index)
{
    return imk_log_label(context, index);
}

imk_record_source imk_log_source(imk_log_reader *reader)
{
    return (imk_record_source){.context = reader,
                               .column_count = reader->layout.column_count,
                               .columns = reader->layout.column,
                               .rate = reader->rate,
                               .read = read_rows,
                               .rewind = rewind_rows,
                               .seek = seek_row,
                               .findings = findings_of,
                               .progress = progress_of,
                               .label = label_of,
                               .axes_turned = reader->layout.axes_turned};
}

imk_status imk_log_load(const char *path, const imk_log_settings *settings, const imk_job *job,
                        imk_log *log, imk_error *error)
{
    imk_log_reader *reader;
    imk_job own = *imki_job_of(job);
    if (settings && settings->memory > 0)
        own.memory = settings->memory;
    else if (own.memory == 0)
        own.memory = imk_memory_limit() / 2;
    imk_status status = imk_log_open(path, settings, &reader, error);
    if (status != IMK_OK)
        return status;
    const imk_record_source source = imk_log_source(reader);
    status = imki_record_load(&source, &own, log, error);
    imk_log_close(reader);
    return status;
}

imk_status imk_log_open_first_look(const char *path, const imk_log_settings *settings,
                                   imk_log_reader **reader, imk_error *lacking, imk_error *error)
{
    const imk_status status = imk_log_open(path, settings, reader, lacking);
    if (status == IMK_OK)
        *lacking = (imk_error){.status = IMK_OK};
    if (status == IMK_OK)
        return IMK_OK;
    if (status == IMK_ERROR_UNIT_MISSING || status == IMK_ERROR_RATE_MISSING ||
        status == IMK_ERROR_COLUMN) {
        imk_log_settings written = *settings;
        written.as_written = true;
        if (imk_log_open(path, &written, reader, NULL) == IMK_OK)
            return IMK_OK;
    }
    if (error)
        *error = *lacking;
    return status;
}
