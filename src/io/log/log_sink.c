/* SPDX-License-Identifier: Apache-2.0 */
/* A log that is written as a sink of records. */
#include "imukit/log.h"

static imk_status begin(void *context, size_t column_count, const imk_log_column *columns,
                        const int *decimals, uint64_t rows, imk_error *error)
{
    imk_log_sink *s = context;
    int count[IMK_LOG_COLUMNS_MAX];
    for (size_t c = 0; c < column_count; c++)
        count[c] = decimals[c] >= 0 ? decimals[c] : s->decimals;
    return imk_log_create(s->path, column_count, columns,
                          s->fixed ? IMK_LOG_FIXED : IMK_LOG_SHORTEST, s->fixed ? count : NULL,
                          rows, &s->writer, error);
}

static imk_status write_rows(void *context, size_t rows, const double *const *columns,
                             const imk_executor *executor, imk_error *error)
{
    imk_log_sink *s = context;
    const imk_status status = imk_log_write(s->writer, rows, columns, executor);
    return status == IMK_OK ? status : imk_error_set(error, status, s->path, NULL, NULL);
}

static const char *label_of(void *context, size_t index)
{
    const imk_log_sink *s = context;
    return s->labels.label(s->labels.context, index);
}

static void take_labels(void *context, const imk_record_source *source)
{
    imk_log_sink *s = context;
    s->labels = *source;
    if (source->label)
        imk_log_write_labels(s->writer, label_of, s);
}

imk_record_sink imk_log_sink_of(imk_log_sink *log)
{
    log->writer = NULL;
    return (imk_record_sink){
        .context = log, .begin = begin, .write = write_rows, .labels = take_labels};
}

imk_status imk_log_sink_end(imk_log_sink *log, imk_status status, imk_error *error)
{
    imk_error why;
    if (!log->writer)
        return status;
    if (status != IMK_OK && status != IMK_ERROR_WRITE && status != IMK_ERROR_NOT_FINITE) {
        imk_log_abandon(log->writer);
    } else { /* a failed write is told by commit, which knows the system's reason */
        const imk_status committed = imk_log_commit(log->writer, &why);
        if (committed != IMK_OK && error)
            *error = why;
        status = committed != IMK_OK ? committed : status;
    }
    log->writer = NULL;
    return status;
}
