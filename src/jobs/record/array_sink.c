/* SPDX-License-Identifier: Apache-2.0 */
/* Rows of a record into arrays of the caller. */
#include "imukit/record.h"

#include "base/refuse_internal.h"

#include <stdio.h>
#include <string.h>

static imk_status refuse_room(size_t columns, uint64_t rows, imk_error *error)
{
    char expected[96];
    const int length =
        snprintf(expected, sizeof expected, "provide more or longer arrays: %zu arrays", columns);
    if (rows > 0)
        snprintf(expected + length, sizeof expected - (size_t)length, " of %llu rows",
                 (unsigned long long)rows);
    return imk_error_set(error, IMK_ERROR_WORKSPACE, "sink", NULL, expected);
}

static imk_status begin(void *context, size_t column_count, const imk_log_column *columns,
                        const int *decimals, uint64_t rows, imk_error *error)
{
    imk_array_sink *s = context;
    (void)decimals;
    if (column_count > s->column_count || rows > s->capacity)
        return refuse_room(column_count, rows, error);
    for (size_t c = 0; c < column_count; c++)
        if (!s->data || !s->data[c])
            return imki_refuse_at(error, IMK_ERROR_ARGUMENT, "sink.data", c, 0, 0, "an array");
    s->columns = column_count;
    memcpy(s->column, columns, column_count * sizeof *columns);
    return IMK_OK;
}

static imk_status write_rows(void *context, size_t rows, const double *const *columns,
                             const imk_executor *executor, imk_error *error)
{
    imk_array_sink *s = context;
    (void)executor;
    if (rows > s->capacity - s->rows)
        return imk_error_set(error, IMK_ERROR_WORKSPACE, "sink", NULL, "longer arrays");
    for (size_t c = 0; c < s->columns && rows > 0; c++)
        memcpy(s->data[c] + s->rows, columns[c], rows * sizeof **columns);
    s->rows += rows;
    return IMK_OK;
}

imk_record_sink imk_array_sink_of(imk_array_sink *memory)
{
    return (imk_record_sink){.context = memory, .begin = begin, .write = write_rows};
}

void imk_axis_name(const char *sensor, int axis, char *text)
{
    enum { SIZE = sizeof((imk_log_column *)0)->name };
    if (axis >= 0 && axis < 3)
        snprintf(text, SIZE, "%.40s_%c", sensor, "xyz"[axis]);
    else
        snprintf(text, SIZE, "%.32s_%d", sensor, axis);
}
