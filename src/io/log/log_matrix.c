/* SPDX-License-Identifier: Apache-2.0 */
/* Logs as matrices of float64 or float32, rows by columns, little-endian. The names of the columns
 * stand one a line in FILE.npy.columns, as `gyro_x [deg/s]`, or come from the settings. */
#define _POSIX_C_SOURCE 200809L
#include "log_matrix_internal.h"

#include "io/file/system_error_internal.h"
#include "io/file/text_file_internal.h"
#include "log_columns_internal.h"
#include "log_reader_internal.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { NAMES_SIZE = 16384 };

/* The path of the file of names. @return from malloc() */
static char *path_of_names(const char *path)
{
    const size_t size = strlen(path) + sizeof ".columns";
    char *text = malloc(size);
    if (text)
        snprintf(text, size, "%s.columns", path);
    return text;
}

/* The file of names with its line ends; "" when there is none. */
static imk_status read_names(const char *path, char names[NAMES_SIZE], imk_error *error)
{
    char *names_path = path_of_names(path), *text = NULL;
    size_t size = 0;
    if (!names_path)
        return imk_error_set(error, IMK_ERROR_MEMORY, path, "", "");
    imk_status status = IMK_OK;
    if (access(names_path, F_OK) == 0)
        status = imki_text_file_read(names_path, NAMES_SIZE - 2, &text, &size, error);
    else if (errno != ENOENT && errno != ENAMETOOLONG)
        status = imki_system_error(error, IMK_ERROR_OPEN, names_path, errno);
    if (status == IMK_OK && size > 0)
        memcpy(names, text, size);
    names[size] = '\0';
    free(text);
    free(names_path);
    return status;
}

static size_t split_names(const char *names, bool by_line, imki_log_piece *cells)
{
    const char *end = names + strlen(names);
    if (!by_line)
        return imki_log_split(names, end, ',', IMK_LOG_COLUMNS_MAX, cells);
    while (end > names && (end[-1] == '\n' || end[-1] == '\r'))
        end--;
    return end > names ? imki_log_split(names, end, '\n', IMK_LOG_COLUMNS_MAX, cells) : 0;
}

static imk_status check_count(const imk_log_reader *reader, size_t count, uint64_t due,
                              imk_error *error)
{
    char found[96], expected[160], file[48];
    if (count == due)
        return IMK_OK;
    snprintf(file, sizeof file, "give the names in FILE%s.columns, or ", reader->format->endings);
    snprintf(found, sizeof found, "%zu name%s given for %llu columns", count,
             count == 1 ? " is" : "s are", (unsigned long long)due);
    snprintf(expected, sizeof expected,
             "%sadd --columns with %llu names (time,gyro_x,...; - skips one)",
             reader->settings.columns ? "" : file, (unsigned long long)due);
    return imk_error_set(error, IMK_ERROR_COLUMN, "columns", found, expected);
}

static double value_at(const char *place, size_t value_size)
{
    double value;
    float single;
    if (value_size == 8) {
        memcpy(&value, place, 8);
        return value;
    }
    memcpy(&single, place, 4);
    return (double)single;
}

/* First time and first step; the rows stay. */
static imk_status look_at_rows(imk_log_reader *reader, const imki_matrix *matrix, imk_error *error)
{
    const imki_log_layout_read *layout = &reader->layout;
    imki_log_text *text = &reader->text;
    const size_t row_size = layout->cell_count * matrix->value_size;
    double time[2] = {(double)NAN, (double)NAN};
    imk_status status = IMK_OK;
    if (layout->time_column >= 0 && matrix->rows_left > 0)
        status = imki_log_text_need(text, 2 * row_size, error);
    if (status != IMK_OK)
        return status;
    const size_t at_hand = (size_t)(text->end - text->next) / row_size;
    for (size_t cell = 0; cell < layout->cell_count; cell++)
        for (size_t row = 0; row < 2 && row < at_hand; row++)
            if (layout->cell_column[cell] >= 0 && layout->cell_column[cell] == layout->time_column)
                time[row] = value_at(text->next + row * row_size + cell * matrix->value_size,
                                     matrix->value_size);
    return imki_log_first_rows(reader, matrix->rows_left, time, "the matrix has no rows",
                               "at least one row of numbers", error);
}

imk_status imki_log_matrix_open(imk_log_reader *reader, uint64_t columns, uint64_t rows,
                                size_t value_size, imk_error *error)
{
    const imk_log_settings *settings = &reader->settings;
    const char *path = reader->path;
    imki_matrix *matrix = malloc(sizeof *matrix);
    char names[NAMES_SIZE] = "";
    imk_status status = matrix ? IMK_OK : imk_error_set(error, IMK_ERROR_MEMORY, "", NULL, NULL);
    reader->state = matrix;
    if (status == IMK_OK && !settings->columns && path && strcmp(path, "-") != 0)
        status = read_names(path, names, error);
    if (status != IMK_OK)
        return status;
    *matrix = (imki_matrix){.value_size = value_size,
                            .begin = imki_log_text_place(&reader->text),
                            .rows = rows,
                            .rows_left = rows};
    imki_log_piece cells[IMK_LOG_COLUMNS_MAX];
    const size_t count = settings->columns ? split_names(settings->columns, false, cells)
                                           : split_names(names, true, cells);
    if (columns == 0) /* more names than fit are refused all the same */
        columns = count < IMK_LOG_COLUMNS_MAX ? count : IMK_LOG_COLUMNS_MAX;
    status = check_count(reader, count, columns, error);
    if (status == IMK_OK)
        status = imki_log_time_parts_refuse(cells, count, settings->map, error);
    if (status == IMK_OK)
        status = imki_log_layout_make(cells, count, settings, &reader->layout, error);
    return status == IMK_OK ? look_at_rows(reader, matrix, error) : status;
}

imk_status imki_log_matrix_seek(imk_log_reader *reader, double fraction, imk_error *error)
{
    imki_matrix *matrix = reader->state;
    const size_t row_size = reader->layout.cell_count * matrix->value_size;
    const uint64_t row = (uint64_t)(fraction * (double)matrix->rows);
    const uint64_t to = row < matrix->rows ? row : matrix->rows;
    const imk_status status =
        imki_log_text_seek(&reader->text, matrix->begin + to * row_size, error);
    if (status == IMK_OK)
        matrix->rows_left = matrix->rows - to;
    return status;
}

static void copy_cell(const char *source, size_t stride, size_t value_size, double factor,
                      double *out, size_t rows)
{
    for (size_t row = 0; row < rows; row++, source += stride)
        out[row] = value_at(source, value_size) * factor;
}

imk_status imki_log_matrix_read(imk_log_reader *reader, size_t max_rows, double *const *out,
                                size_t *rows, imk_error *error)
{
    imki_log_text *text = &reader->text;
    const imki_log_layout_read *layout = &reader->layout;
    imki_matrix *matrix = reader->state;
    const size_t value_size = matrix->value_size;
    const size_t row_size = layout->cell_count * value_size;
    size_t wanted = max_rows < matrix->rows_left ? max_rows : (size_t)matrix->rows_left;
    *rows = 0;
    const imk_status status = imki_log_text_need(text, wanted > 0 ? row_size : 0, error);
    if (status != IMK_OK)
        return status;
    const size_t at_hand = (size_t)(text->end - text->next) / row_size;
    if (wanted > 0 && at_hand == 0) {
        char found[64];
        snprintf(found, sizeof found, "the %s file is cut short", reader->format->title);
        return imk_error_set(error, IMK_ERROR_FORMAT, "", found,
                             "its header announces more rows: copy the file again");
    }
    if (wanted > at_hand)
        wanted = at_hand;
    for (size_t i = 0; i < layout->cell_count; i++)
        if (layout->cell_column[i] >= 0)
            copy_cell(text->next + i * value_size, row_size, value_size, layout->cell_factor[i],
                      out[i], wanted);
    for (size_t row = 0; row < wanted; row++) {
        bool finite = true;
        for (size_t i = 0; i < layout->cell_count; i++)
            finite &= layout->cell_column[i] < 0 || isfinite(out[i][row]);
        if (!finite && reader->not_finite++ == 0)
            reader->first_not_finite = reader->rows + row + 1;
    }
    text->next += wanted * row_size;
    matrix->rows_left -= wanted;
    *rows = wanted;
    return IMK_OK;
}

imk_status imki_log_matrix_create(imki_log_output *log, const char *path, imk_error *error)
{
    char *names_path = path_of_names(path);
    if (!names_path)
        return imk_error_set(error, IMK_ERROR_MEMORY, path, "", "");
    const imk_status status = imk_output_file_open(names_path, &log->companion, error);
    free(names_path);
    if (status != IMK_OK)
        return status;
    imki_log_names_write(log->companion, log->rows.column_count, log->column, '\n');
    imk_output_file_write(log->companion, "\n", 1);
    return IMK_OK;
}
