/* SPDX-License-Identifier: Apache-2.0 */
/* The rows that a job writes become a log in memory, whose length need not be known before. */
#include "extension.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { FIRST_ROWS = 4096 };

static imk_status begin(void *context, size_t column_count, const imk_log_column *columns,
                        const int *decimals, uint64_t rows, imk_error *error)
{
    log_sink *s = context;
    (void)decimals;
    (void)rows;
    (void)error;
    s->log->column_count = column_count;
    memcpy(s->log->column, columns, column_count * sizeof *columns);
    return IMK_OK;
}

static bool grow(log_sink *s, size_t rows)
{
    size_t capacity = s->capacity > 0 ? s->capacity : FIRST_ROWS;
    while (capacity < s->log->rows + rows)
        capacity += capacity / 2;
    if (capacity == s->capacity)
        return true;
    for (size_t c = 0; c < s->log->column_count; c++) {
        double *larger = realloc(s->log->data[c], (capacity + 1) * sizeof *larger);
        if (!larger)
            return false;
        s->log->data[c] = larger;
    }
    s->capacity = capacity;
    return true;
}

static imk_status write_rows(void *context, size_t rows, const double *const *columns,
                             const imk_executor *executor, imk_error *error)
{
    log_sink *s = context;
    (void)executor;
    if (!grow(s, rows))
        return imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
    for (size_t c = 0; c < s->log->column_count; c++)
        memcpy(s->log->data[c] + s->log->rows, columns[c], rows * sizeof(double));
    s->log->rows += rows;
    return IMK_OK;
}

static void take_labels(void *context, const imk_record_source *source)
{
    log_sink *s = context;
    const char *text;
    for (size_t k = 0; source->label && (text = source->label(source->context, k)); k++) {
        void *larger = realloc(s->log->label, (k + 1) * sizeof *s->log->label);
        if (!larger)
            return;
        s->log->label = larger;
        memset(s->log->label[k], 0, sizeof s->log->label[k]);
        strncpy(s->log->label[k], text, sizeof s->log->label[k] - 1);
        s->log->label_count = k + 1;
    }
}

bool log_sink_begin(log_sink *s)
{
    *s = (log_sink){.log = PyMem_Calloc(1, sizeof *s->log)};
    s->sink =
        (imk_record_sink){.context = s, .begin = begin, .write = write_rows, .labels = take_labels};
    if (!s->log)
        PyErr_NoMemory();
    return s->log != NULL;
}

PyObject *log_sink_end(log_sink *s, const imk_record_source *source)
{
    imk_log *log = s->log;
    if (source && grow(s, 0)) {
        log->findings = source->findings(source->context);
        if (!(log->findings.interval > 0) && source->rate > 0)
            log->findings.interval = 1 / source->rate;
        return describe_log(log);
    }
    if (source)
        PyErr_NoMemory();
    imk_log_free(log);
    PyMem_Free(log);
    return NULL;
}
