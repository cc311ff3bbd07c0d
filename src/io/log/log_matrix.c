/* SPDX-License-Identifier: Apache-2.0 */
/* Logs as .npy matrices: float64 or float32, rows by columns. The names of the columns stand one a
 * line in FILE.npy.columns, as `gyro_x [deg/s]`, or come from the settings. */
#define _POSIX_C_SOURCE 200809L
#include "io/file/system_error_internal.h"
#include "io/file/text_file_internal.h"
#include "log_reader_internal.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { NAMES_SIZE = 16384 };

/* The file of names with its line ends; "" when there is none. */
static imk_status read_names(const char *path, char names[NAMES_SIZE], imk_error *error)
{
    const size_t path_size = strlen(path) + sizeof ".columns";
    char *names_path = malloc(path_size), *text = NULL;
    size_t size = 0;
    if (!names_path)
        return imk_error_set(error, IMK_ERROR_MEMORY, path, "", "");
    snprintf(names_path, path_size, "%s.columns", path);
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

static imk_status check_count(size_t count, uint64_t due, bool from_settings, imk_error *error)
{
    char found[96];
    if (due == 0 || due > IMK_LOG_COLUMNS_MAX) {
        snprintf(found, sizeof found, "a matrix of %llu columns", (unsigned long long)due);
        return imk_error_set(error, IMK_ERROR_COLUMN, "", found, "1 to 64 columns");
    }
    if (count == due)
        return IMK_OK;
    char expected[160];
    snprintf(found, sizeof found, "%zu name%s for %llu columns", count, count == 1 ? "" : "s",
             (unsigned long long)due);
    snprintf(expected, sizeof expected,
             "%sadd --columns with %llu names (time,gyro_x,...; - skips one)",
             from_settings ? "" : "a file FILE.npy.columns; or ", (unsigned long long)due);
    return imk_error_set(error, IMK_ERROR_COLUMN, "columns", found, expected);
}

/* First time and first step; the rows stay. */
static imk_status look_at_rows(imk_log_reader *reader, imk_error *error)
{
    imki_log_layout_read *layout = &reader->layout;
    const bool needs_step = layout->has_increments && reader->rate == 0.0;
    if (reader->npy.rows == 0)
        return imk_error_set(error, IMK_ERROR_EMPTY, "", "a matrix without rows",
                             "rows of numbers");
    if (needs_step && reader->npy.rows < 2)
        return imk_error_set(error, IMK_ERROR_TOO_SHORT, "", "increments in a single row",
                             "two rows; or add --rate 100Hz (samples per second)");
    if (layout->time_column < 0)
        return IMK_OK;
    imki_log_text *text = &reader->text;
    const size_t row_size = (size_t)reader->npy.columns * reader->npy.value_size;
    const imk_status status = imki_log_text_need(text, 2 * row_size, error);
    if (status != IMK_OK)
        return status;
    double time[2] = {(double)NAN, (double)NAN};
    const size_t at_hand = (size_t)(text->end - text->next) / row_size;
    for (size_t cell = 0; cell < layout->cell_count; cell++)
        for (size_t row = 0; row < 2 && row < at_hand; row++) {
            if (layout->cell_column[cell] != layout->time_column)
                continue;
            const char *place = text->next + row * row_size + cell * reader->npy.value_size;
            float single;
            if (reader->npy.value_size == 8) {
                memcpy(&time[row], place, 8);
            } else {
                memcpy(&single, place, 4);
                time[row] = (double)single;
            }
        }
    const double scale = layout->factor[layout->time_column];
    if (fabs(time[0]) * scale > 1e6)
        reader->time_origin = time[0];
    reader->last_step = (time[1] - time[0]) * scale;
    return IMK_OK;
}

imk_status imki_log_open_matrix(imk_log_reader *reader, const char *path,
                                const imk_log_settings *settings, imk_error *error)
{
    imki_log_text *text = &reader->text;
    const size_t header_size = imki_npy_header_size(text->next);
    if (header_size == 0 || header_size > IMKI_LINE_MAX)
        return imk_error_set(error, IMK_ERROR_FORMAT, "", "the head of the .npy file is damaged",
                             "a file that numpy.save() wrote");
    imk_status status = imki_log_text_need(text, header_size, error);
    if (status == IMK_OK)
        status =
            imki_npy_header_read(text->next, (size_t)(text->end - text->next), &reader->npy, error);
    if (status != IMK_OK)
        return status;
    text->next += reader->npy.header_size;
    char names[NAMES_SIZE] = "";
    if (!settings->columns && path && strcmp(path, "-") != 0)
        status = read_names(path, names, error);
    if (status != IMK_OK)
        return status;
    imki_log_piece cells[IMK_LOG_COLUMNS_MAX];
    const size_t count = settings->columns ? split_names(settings->columns, false, cells)
                                           : split_names(names, true, cells);
    status = check_count(count, reader->npy.columns, settings->columns != NULL, error);
    if (status == IMK_OK)
        status = imki_log_layout_make(cells, count, settings, &reader->layout, error);
    if (status != IMK_OK)
        return status;
    reader->binary = true;
    reader->npy_rows_left = reader->npy.rows;
    return look_at_rows(reader, error);
}

static void copy_cell(const char *source, size_t stride, size_t value_size, double factor,
                      double *out, size_t rows)
{
    for (size_t row = 0; row < rows; row++, source += stride) {
        double value;
        if (value_size == 8) {
            memcpy(&value, source, 8);
        } else {
            float single;
            memcpy(&single, source, 4);
            value = (double)single;
        }
        out[row] = value * factor;
    }
}

imk_status imki_log_read_matrix(imk_log_reader *reader, size_t max_rows, double *const *out,
                                size_t *rows, imk_error *error)
{
    imki_log_text *text = &reader->text;
    const imki_log_layout_read *layout = &reader->layout;
    const size_t value_size = reader->npy.value_size;
    const size_t row_size = layout->cell_count * value_size;
    size_t wanted = max_rows < reader->npy_rows_left ? max_rows : (size_t)reader->npy_rows_left;
    *rows = 0;
    const imk_status status = imki_log_text_need(text, wanted > 0 ? row_size : 0, error);
    if (status != IMK_OK)
        return status;
    const size_t at_hand = (size_t)(text->end - text->next) / row_size;
    if (wanted > 0 && at_hand == 0)
        return imk_error_set(error, IMK_ERROR_FORMAT, "", "the .npy file ends in the middle",
                             "as many rows as its head says: copy the file again");
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
    reader->npy_rows_left -= wanted;
    *rows = wanted;
    return IMK_OK;
}
