/* SPDX-License-Identifier: Apache-2.0 */
/* Rows in memory as a source of records. */
#include "record_times_internal.h"

#include "base/refuse_internal.h"
#include "jobs/arena_internal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

int imk_record_find(const imk_record_source *source, imk_quantity quantity, int axis)
{
    for (size_t i = 0; i < source->column_count; i++)
        if (source->columns[i].quantity == quantity && source->columns[i].axis == axis)
            return (int)i;
    return -1;
}

/* x, y, z or 0 … 7 behind a prefix; -1 for anything else. */
static int axis_behind(const char *name, const char *prefix)
{
    static const char letters[] = "xyz";
    const size_t length = strlen(prefix);
    if (strncmp(name, prefix, length) != 0 || !name[length] || name[length + 1])
        return -1;
    const char *letter = strchr(letters, name[length]);
    if (letter)
        return (int)(letter - letters);
    return name[length] >= '0' && name[length] <= '7' ? name[length] - '0' : -1;
}

imk_log_column imk_record_column(const char *name)
{
    static const struct {
        const char *prefix, *unit;
        imk_quantity quantity;
    } sensors[] = {{"gyro_", "rad/s", IMK_QUANTITY_ANGULAR_RATE},
                   {"accel_", "m/s^2", IMK_QUANTITY_SPECIFIC_FORCE},
                   {"mag_", "T", IMK_QUANTITY_MAGNETIC}};
    imk_log_column column = {.quantity = IMK_QUANTITY_OTHER, .axis = -1, .unit = imk_unit_of("1")};
    snprintf(column.name, sizeof column.name, "%s", name);
    for (size_t k = 0; k < 3; k++)
        if (axis_behind(name, sensors[k].prefix) >= 0) {
            column.axis = axis_behind(name, sensors[k].prefix);
            column.quantity = sensors[k].quantity;
            column.unit = imk_unit_of(sensors[k].unit);
        }
    if (strcmp(name, "time") == 0) {
        column.quantity = IMK_QUANTITY_TIME;
        column.unit = imk_unit_of("s");
    } else if (strcmp(name, "temperature") == 0) {
        column.quantity = IMK_QUANTITY_TEMPERATURE;
        column.unit = imk_unit_of("K");
    }
    return column;
}

/* A name with its unit behind it, "gyro_x [deg/s]", or in SI units without. */
static imk_status column_of(const char *text, imk_log_column *column, imk_error *error)
{
    char name[sizeof column->name];
    const char *open = strchr(text, '['), *close = open ? strrchr(open, ']') : NULL;
    const size_t length = open ? (size_t)(open - text) : strlen(text);
    snprintf(name, sizeof name, "%.*s", (int)length, text);
    name[strcspn(name, " ")] = '\0';
    *column = imk_record_column(name);
    if (!open)
        return IMK_OK;
    imk_unit unit;
    const imk_dimension due = column->unit.dimension, counts = imk_unit_of("count").dimension;
    const imk_status status = imk_unit_parse(open + 1, close ? close : open + 1, &unit, error);
    if (status != IMK_OK)
        return status;
    const bool fits = column->quantity == IMK_QUANTITY_OTHER ||
                      imk_dimension_equal(unit.dimension, due) ||
                      (column->axis >= 0 && imk_dimension_equal(unit.dimension, counts));
    if (!fits)
        return imk_error_set(error, IMK_ERROR_DIMENSION, name, unit.text, column->unit.text);
    column->unit = unit;
    return IMK_OK;
}

/* Numbers of a column from `first` on, in SI units. */
static void read_column(const imk_array_source *s, size_t c, size_t first, size_t count, double *to)
{
    const imk_unit *unit = &s->column[c].unit;
    const ptrdiff_t stride = s->stride[c];
    const double *from = s->data[c] + (ptrdiff_t)first * stride;
    const bool si = unit->scale == 1 && unit->offset == 0;
    if (si && stride == 1)
        memcpy(to, from, count * sizeof *to);
    else if (si)
        for (size_t k = 0; k < count; k++)
            to[k] = from[(ptrdiff_t)k * stride];
    else
        for (size_t k = 0; k < count; k++)
            to[k] = unit->scale * from[(ptrdiff_t)k * stride] + unit->offset;
}

static imk_status read_rows(void *context, size_t rows_most, double *const *columns, size_t *rows,
                            imk_error *error)
{
    imk_array_source *s = context;
    const size_t left = s->rows - s->next;
    (void)error;
    *rows = left < rows_most ? left : rows_most;
    for (size_t c = 0; c < s->column_count; c++)
        if (columns[c] && *rows > 0)
            read_column(s, c, s->next, *rows, columns[c]);
    s->next += *rows;
    return IMK_OK;
}

static imk_status rewind_rows(void *context, imk_error *error)
{
    imk_array_source *s = context;
    (void)error;
    s->next = 0;
    return IMK_OK;
}

static imk_log_findings findings_of(void *context)
{
    const imk_array_source *s = context;
    return s->findings;
}

static void progress_of(void *context, uint64_t *done, uint64_t *total)
{
    const imk_array_source *s = context;
    *done = s->next * s->column_count * sizeof(double);
    *total = s->rows * s->column_count * sizeof(double);
}

/* Rows with a number that is not finite, and the first of them from 1. */
static void count_not_finite(imk_array_source *s)
{
    for (size_t row = 0; row < s->rows; row++) {
        bool finite = true;
        for (size_t c = 0; c < s->column_count; c++)
            finite = finite && isfinite(s->data[c][(ptrdiff_t)row * s->stride[c]]);
        if (!finite && s->findings.not_finite++ == 0)
            s->findings.first_not_finite = row + 1;
    }
}

static void add_times(const imk_array_source *s, size_t column, imki_record_times *times)
{
    double seconds[256];
    const size_t room = sizeof seconds / sizeof *seconds;
    for (size_t row = 0; row < s->rows; row += room) {
        const size_t count = s->rows - row < room ? s->rows - row : room;
        read_column(s, column, row, count, seconds);
        imki_record_times_add(times, row + 1, count, seconds);
    }
}

/* @param time  index of that column; -1: there is none */
static imk_status find_times(int time, imk_array_source *s, imk_error *error)
{
    imki_arena scratch = {.blocks = NULL};
    imki_record_times *times = imki_arena_take(&scratch, sizeof *times);
    if (!times)
        return imk_error_set(error, IMK_ERROR_MEMORY, "time", NULL, NULL);
    imki_record_times_start(times, s->rate > 0 ? 1 / s->rate : 0);
    if (time >= 0)
        add_times(s, (size_t)time, times);
    s->findings = imki_record_times_findings(times);
    s->findings.rows = s->rows;
    if (time < 0 && s->rows > 0)
        s->findings.last_time = (double)(s->rows - 1) / s->rate;
    imki_arena_free(&scratch);
    count_not_finite(s);
    return IMK_OK;
}

imk_status imk_array_source_strided(size_t column_count, const char *const *names,
                                    const double *const *data, const ptrdiff_t *strides,
                                    size_t rows, double rate, imk_array_source *memory,
                                    imk_record_source *source, imk_error *error)
{
    int time = -1;
    if (!names || !data || !memory || !source)
        return imk_error_set(error, IMK_ERROR_ARGUMENT, "columns", NULL,
                             "names, arrays and memory");
    if (column_count == 0 || column_count > IMK_LOG_COLUMNS_MAX)
        return imk_error_set(error, IMK_ERROR_COLUMN, "columns", NULL, "1 to 64 columns");
    imk_array_source made = {.column_count = column_count, .rows = rows, .rate = rate};
    for (size_t c = 0; c < column_count; c++) {
        if (!names[c])
            return imki_refuse_at(error, IMK_ERROR_ARGUMENT, "names", c, 0, 0, "a name");
        if (!data[c])
            return imk_error_set(error, IMK_ERROR_ARGUMENT, names[c], NULL, "an array");
        const imk_status status = column_of(names[c], &made.column[c], error);
        if (status != IMK_OK)
            return status;
        for (size_t k = 0; k < c; k++)
            if (strcmp(made.column[c].name, made.column[k].name) == 0)
                return imk_error_set(error, IMK_ERROR_COLUMN, names[c], NULL,
                                     "use each column name only once");
        made.data[c] = data[c];
        made.stride[c] = strides ? strides[c] : 1;
        if (made.column[c].quantity == IMK_QUANTITY_TIME)
            time = (int)c;
    }
    if (!(rate > 0 && isfinite(rate)) && time < 0)
        return imk_error_set(error, IMK_ERROR_RATE_MISSING, "rate", NULL,
                             "a rate in Hz, or a column named time");
    const imk_status status = find_times(time, &made, error);
    if (status != IMK_OK)
        return status;
    *memory = made;
    *source = (imk_record_source){.context = memory,
                                  .column_count = column_count,
                                  .columns = memory->column,
                                  .rate = rate,
                                  .read = read_rows,
                                  .rewind = rewind_rows,
                                  .findings = findings_of,
                                  .progress = progress_of};
    return IMK_OK;
}

imk_status imk_array_source_make(size_t column_count, const char *const *names,
                                 const double *const *data, size_t rows, double rate,
                                 imk_array_source *memory, imk_record_source *source,
                                 imk_error *error)
{
    return imk_array_source_strided(column_count, names, data, NULL, rows, rate, memory, source,
                                    error);
}
