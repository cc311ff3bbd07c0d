/* SPDX-License-Identifier: Apache-2.0 */
/* A log that is written as a sink of records, also in the words of EuRoC [EUROC]. */
#include "imukit/log.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { EUROC_COLUMNS = 7 };

/* Names and units as in imu0/data.csv. */
static imk_status rename_columns(size_t count, const imk_log_column *columns,
                                 imk_log_column *renamed, imk_error *error)
{
    static const struct {
        const char *from, *to, *unit;
    } names[EUROC_COLUMNS] = {
        {"time", "#timestamp", "ns"},       {"gyro_x", "w_RS_S_x", "rad s^-1"},
        {"gyro_y", "w_RS_S_y", "rad s^-1"}, {"gyro_z", "w_RS_S_z", "rad s^-1"},
        {"accel_x", "a_RS_S_x", "m s^-2"},  {"accel_y", "a_RS_S_y", "m s^-2"},
        {"accel_z", "a_RS_S_z", "m s^-2"}};
    for (size_t i = 0; i < EUROC_COLUMNS; i++) {
        if (count != EUROC_COLUMNS || strcmp(columns[i].name, names[i].from) != 0)
            return imk_error_set(error, IMK_ERROR_COLUMN, names[i].from,
                                 "the EuRoC format has other columns",
                                 "time, gyro_x … gyro_z, accel_x … accel_z, in this order");
        renamed[i] = columns[i];
        renamed[i].unit = imk_unit_of(names[i].unit);
        snprintf(renamed[i].name, sizeof renamed[i].name, "%s", names[i].to);
    }
    return IMK_OK;
}

static bool is_taken(size_t count, const imk_log_column *columns, const char *name)
{
    for (size_t i = 0; i < count; i++)
        if (strcmp(columns[i].name, name) == 0)
            return true;
    return false;
}

/* Brackets enclose units in a header: "axisP[0]" of another program is written as axisP_0, which
 * has the same words. Another column of that name makes it axisP_0_. */
static void take_out_brackets(size_t count, imk_log_column *columns)
{
    for (size_t i = 0; i < count; i++) {
        char name[sizeof columns[i].name];
        size_t length = 0;
        if (!strpbrk(columns[i].name, "[]()"))
            continue;
        for (const char *c = columns[i].name; *c; c++) {
            const bool bracket = strchr("[]()", *c) != NULL;
            if (bracket && (length == 0 || name[length - 1] == '_' || !c[1]))
                continue;
            name[length++] = bracket ? '_' : *c;
        }
        name[length] = '\0';
        while (length > 0 && length + 1 < sizeof name && is_taken(count, columns, name)) {
            name[length++] = '_';
            name[length] = '\0';
        }
        if (length > 0)
            memcpy(columns[i].name, name, length + 1);
    }
}

static imk_status create(imk_log_sink *s, size_t count, const imk_log_column *columns,
                         imk_log_precision precision, const int *decimals, uint64_t rows,
                         imk_error *error)
{
    const imk_status status =
        imk_log_create(s->path, count, columns, precision, decimals, rows, &s->writer, error);
    const bool kept = s->euroc || imk_log_format_of(s->path)->keeps_epoch;
    if (status == IMK_OK && kept)
        imk_log_write_origin(s->writer, s->origin);
    if (status == IMK_OK) {
        s->column_count = count;
        memcpy(s->column, columns, count * sizeof *columns);
    }
    return status;
}

static imk_status begin(void *context, size_t column_count, const imk_log_column *columns,
                        const int *decimals, uint64_t rows, imk_error *error)
{
    imk_log_sink *s = context;
    int count[IMK_LOG_COLUMNS_MAX];
    imk_log_column renamed[IMK_LOG_COLUMNS_MAX];
    if (s->euroc && imk_log_format_of(s->path) != imk_log_format_get(0))
        return imk_error_set(error, IMK_ERROR_UNSUPPORTED, s->path, "the EuRoC format is a text",
                             "a name that ends in .csv");
    if (s->euroc) {
        const imk_status status = rename_columns(column_count, columns, renamed, error);
        return status == IMK_OK
                   ? create(s, column_count, renamed, IMK_LOG_SHORTEST, NULL, rows, error)
                   : status;
    }
    if (column_count > IMK_LOG_COLUMNS_MAX)
        return imk_error_set(error, IMK_ERROR_ARGUMENT, "column_count", "", "1 to 64 columns");
    memcpy(renamed, columns, column_count * sizeof *columns);
    take_out_brackets(column_count, renamed);
    for (size_t c = 0; c < column_count; c++)
        count[c] = decimals[c] >= 0 ? decimals[c] : s->decimals;
    return create(s, column_count, renamed, s->fixed ? IMK_LOG_FIXED : IMK_LOG_SHORTEST,
                  s->fixed ? count : NULL, rows, error);
}

/* Times in whole nanoseconds, which their unit then writes as whole numbers. */
static imk_status write_euroc(imk_log_sink *s, size_t rows, const double *const *columns,
                              const imk_executor *executor)
{
    const double *changed[EUROC_COLUMNS];
    double *time = malloc((rows > 0 ? rows : 1) * sizeof *time);
    if (!time)
        return IMK_ERROR_MEMORY;
    for (size_t i = 0; i < rows; i++)
        time[i] = round(columns[0][i] * 1e9) * 1e-9;
    for (size_t c = 0; c < EUROC_COLUMNS; c++)
        changed[c] = c == 0 ? time : columns[c];
    const imk_status status = imk_log_write(s->writer, rows, changed, executor);
    free(time);
    return status;
}

static imk_status write_rows(void *context, size_t rows, const double *const *columns,
                             const imk_executor *executor, imk_error *error)
{
    imk_log_sink *s = context;
    s->rows += rows;
    if (s->euroc) {
        const imk_status written = write_euroc(s, rows, columns, executor);
        return written == IMK_OK ? written : imk_error_set(error, written, s->path, NULL, NULL);
    }
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
    log->rows = log->column_count = 0;
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
