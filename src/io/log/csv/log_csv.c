/* SPDX-License-Identifier: Apache-2.0 */
/* Logs as CSV text: is it a text, which columns are what (log_csv_header.c), what the first rows
 * show (log_csv_look.c); rows (log_csv_rows.c). */
#include "io/file/text_file_internal.h"
#include "io/log/maker/foreign_kinds_internal.h"
#include "log_csv_internal.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LOOK = 4096 };           /* bytes looked at to tell a text */
enum { LOOK_AHEAD = 16 << 20 }; /* for the first cell of a column that is not blank */

static imk_status check_text(imki_log_text *text, imk_error *error)
{
    imk_status status = imki_log_text_need(text, LOOK, error);
    if (status != IMK_OK)
        return status;
    size_t at_hand = (size_t)(text->end - text->next);
    if (at_hand == 0)
        return imk_error_set(error, IMK_ERROR_EMPTY, "", "the log is empty",
                             "a header and rows of numbers");
    status = imki_foreign_kind_refuse(text->next, at_hand, error);
    if (status != IMK_OK)
        return status;
    const imki_log_encoding encoding =
        imki_log_encoding_of(text->next, at_hand < LOOK ? at_hand : LOOK);
    if (encoding != IMKI_LOG_PLAIN) {
        status = imki_log_text_decode(text, encoding, error);
        if (status == IMK_OK)
            status = imki_log_text_need(text, LOOK, error);
        if (status != IMK_OK)
            return status;
        at_hand = (size_t)(text->end - text->next);
    }
    if (!imki_is_text(text->next, at_hand < LOOK ? at_hand : LOOK)) {
        char others[256], expected[400];
        snprintf(expected, sizeof expected, "a log as CSV (plain, .gz or .zst)%s",
                 imk_log_formats_text(" or ", false, sizeof others, others));
        return imk_error_set(error, IMK_ERROR_FORMAT, "", "the file is not a text log", expected);
    }
    if (at_hand >= 3 && memcmp(text->next, "\xEF\xBB\xBF", 3) == 0) /* byte-order mark */
        text->next += 3;
    return IMK_OK;
}

/* What the cells of a row say of columns that are `open`. */
static imk_status look_at_cells(imk_log_reader *reader, const imki_log_piece *cells, bool *open,
                                size_t *left, imk_error *error)
{
    imki_log_layout_read *layout = &reader->layout;
    double value;
    for (size_t i = 0; i < layout->cell_count; i++) {
        if (!open[i] || imki_log_piece_is_missing(cells[i]))
            continue;
        open[i] = false;
        --*left;
        if (imki_log_piece_is_number(cells[i], &value) ||
            (layout->decimal_comma && imki_csv_is_value(cells[i])))
            continue;
        layout->column[layout->cell_column[i]].label = true;
        if (!reader->labels)
            reader->labels = calloc(IMKI_LABELS_MAX, sizeof reader->labels[0]);
        if (!reader->labels)
            return imk_error_set(error, IMK_ERROR_MEMORY, "", NULL, NULL);
    }
    return IMK_OK;
}

/* Columns without meaning here may hold texts: the first cell that is not blank tells. What is
 * wrong with a row is left to be found when it is read. */
static imk_status find_labels(imk_log_reader *reader, imk_error *error)
{
    const imki_log_layout_read *layout = &reader->layout;
    imki_log_text *text = &reader->text;
    bool open[IMK_LOG_COLUMNS_MAX] = {false};
    size_t left = 0;
    for (size_t i = 0; i < layout->cell_count; i++) {
        const int column = layout->cell_column[i];
        open[i] = column >= 0 && layout->column[column].quantity == IMK_QUANTITY_OTHER;
        left += open[i];
    }
    while (left > 0 && text->next - text->hold < LOOK_AHEAD) {
        imki_log_piece line, cells[IMK_LOG_COLUMNS_MAX];
        bool whole, found;
        if (imki_csv_line(text, &line, &whole, &found, NULL, NULL) != IMK_OK || !found ||
            imki_log_split(line.begin, line.end, layout->separator, IMK_LOG_COLUMNS_MAX, cells) !=
                layout->cell_count)
            return IMK_OK;
        const imk_status status = look_at_cells(reader, cells, open, &left, error);
        if (status != IMK_OK)
            return status;
    }
    return IMK_OK;
}

/* Numbers with decimal commas between commas: there are twice as many cells as names. */
static imk_status check_commas(const imki_csv *csv, char separator, imk_error *error)
{
    const size_t due = csv->header.count;
    bool all = csv->look.rows > 0 && separator == ',';
    for (size_t row = 0; row < csv->look.rows; row++)
        all = all && csv->look.count[row] > due && csv->look.count[row] <= 2 * due &&
              (due == IMK_LOG_COLUMNS_MAX || csv->look.text[row][due][0] != '\0');
    if (!all)
        return IMK_OK;
    char found[96];
    snprintf(found, sizeof found,
             "there are %zu names and %zu cells, as of numbers with decimal commas between commas",
             due, csv->look.count[0]);
    imk_error_set(error, IMK_ERROR_COLUMN, "", found,
                  "numbers with a decimal point, or semicolons or tabs between the cells");
    if (error)
        error->line = csv->header.number + 1;
    return IMK_ERROR_COLUMN;
}

/* Which column is the time, and from which of its rows on it counts. */
static void find_stamps(imk_log_reader *reader, imki_csv *csv)
{
    imki_log_layout_read *layout = &reader->layout;
    csv->time_cell = IMK_LOG_COLUMNS_MAX;
    if (layout->time_column < 0)
        return;
    for (size_t i = 0; i < layout->cell_count; i++)
        if (layout->cell_column[i] == layout->time_column)
            csv->time_cell = i;
    const double scale = layout->factor[layout->time_column];
    const int64_t ticks = csv->parts.whole == csv->time_cell ? csv->parts.ticks : 0;
    for (size_t row = 0; row < csv->look.rows && !layout->stamps.exact; row++) {
        const char *cell = csv->look.text[row][csv->time_cell];
        const char *rest = csv->look.text[row][csv->parts.rest];
        if (ticks > 0) {
            layout->rest_cell = csv->parts.rest;
            layout->stamps =
                imki_log_stamps_join(cell, cell + strlen(cell), rest, rest + strlen(rest), ticks);
            continue;
        }
        double value;
        const imki_log_piece piece = {cell, cell + strlen(cell)};
        if (layout->decimal_comma)
            continue;
        layout->stamps = imki_log_stamps_start(piece.begin, piece.end, scale);
        if (!layout->stamps.exact && imki_log_piece_is_number(piece, &value))
            break;
    }
    if (!layout->stamps.exact)
        return;
    reader->origin_before = imki_log_stamps_origin(&layout->stamps) * scale;
    reader->origin_nanoseconds =
        imki_log_nanoseconds(layout->stamps.origin, llround(layout->stamps.per_unit / scale));
}

/* Look at the first row, and the second where the first interval is needed. What is wrong in them
 * is left to be found when they are read. */
static imk_status look_at_rows(imk_log_reader *reader, imk_error *error)
{
    imki_log_layout_read *layout = &reader->layout;
    const bool needs_step = layout->has_increments && reader->rate == 0.0;
    double values[IMK_LOG_COLUMNS_MAX], time[2] = {(double)NAN, (double)NAN};
    const size_t rows_wanted = needs_step ? 2 : 1;
    size_t rows = 0;
    while (rows < rows_wanted) {
        imki_log_piece line;
        bool whole, found, not_finite;
        const imk_status status = imki_csv_line(&reader->text, &line, &whole, &found, NULL, error);
        if (status != IMK_OK)
            return status;
        if (!found || (!whole && !imki_csv_is_whole(reader, line)))
            break;
        if (imki_log_row_read(layout, line, 0, reader->labels, &reader->label_count, values,
                              &not_finite, NULL) != IMK_OK)
            return IMK_OK;
        if (layout->time_column >= 0)
            time[rows] = values[layout->time_column];
        rows++;
    }
    return imki_log_first_rows(reader, rows, time, "the log has a header but no rows",
                               "at least one row of numbers below the header", error);
}

/* Is each cell of the first rows a whole number from 0 on and below `most`? */
static bool are_whole(const imki_csv_look *look, size_t cell, double most)
{
    double value;
    for (size_t row = 0; row < look->rows; row++) {
        const char *text = look->text[row][cell];
        const imki_log_piece piece = {text, text + strlen(text)};
        if (imki_log_piece_is_missing(piece))
            continue;
        if (!imki_log_piece_is_number(piece, &value) || !(value >= 0 && value < most) ||
            value != floor(value))
            return false;
    }
    return true;
}

/* Are two columns the time, the second what is beyond the seconds of the first? They are one. */
static void find_parts(const imk_log_reader *reader, imki_csv *csv)
{
    static const char time[] = "time [s]", skip[] = "-";
    imki_csv_header *header = &csv->header;
    imki_log_time_parts parts;
    if (!imki_log_time_parts_find(header->cell, header->count, &parts) ||
        !are_whole(&csv->look, parts.whole, 9e9) ||
        !are_whole(&csv->look, parts.rest, 1e9 / (double)parts.ticks))
        return;
    csv->parts = parts;
    if (reader->settings.map) /* it says itself which one is the time */
        return;
    header->cell[parts.whole] = (imki_log_piece){time, time + strlen(time)};
    header->cell[parts.rest] = (imki_log_piece){skip, skip + 1};
}

/* The columns of a table whose header is known, and whose first rows are. */
static imk_status make_layout(imk_log_reader *reader, imki_csv *csv, imk_error *error)
{
    imki_log_layout_read *layout = &reader->layout;
    imki_csv_header *header = &csv->header;
    layout->decimal_comma =
        layout->separator != ',' && imki_csv_has_decimal_commas(&csv->look, header->count);
    for (size_t i = 0; i < header->count && csv->look.rows > 0; i++) {
        const char *cell = csv->look.text[0][i];
        layout->date_cell[i] =
            i < csv->look.count[0] && imki_log_date_read(cell, cell + strlen(cell), NULL);
    }
    find_parts(reader, csv);
    imk_status status = imki_csv_encoding_check(header, error);
    if (status == IMK_OK)
        status =
            imki_log_time_parts_refuse(header->cell, header->count, reader->settings.map, error);
    if (status == IMK_OK)
        status = imki_csv_choose_sensor(reader, header, error);
    if (status == IMK_OK)
        status =
            imki_log_layout_make(header->cell, header->count, &reader->settings, layout, error);
    if (status == IMK_OK || status == IMK_ERROR_UNIT_MISSING) {
        const imk_status dates = imki_csv_dates_check(&csv->look, layout, header->number, error);
        status = dates != IMK_OK ? dates : status;
    }
    if ((status == IMK_ERROR_UNIT_MISSING || status == IMK_ERROR_RATE_MISSING) && error) {
        const imki_log_hints hints = imki_csv_hints(&csv->look, layout);
        status = imki_log_missing_refuse(layout, &hints, error);
    }
    if (status != IMK_OK && error && !reader->settings.columns && error->line == 0)
        error->line = header->number;
    for (size_t i = 0; status == IMK_OK && i < header->count; i++)
        imki_log_layout_scale(layout, i, header->scale[i]);
    return status;
}

static imk_status open_csv(imk_log_reader *reader, imk_error *error)
{
    imki_log_text *text = &reader->text;
    imki_csv *csv = calloc(1, sizeof *csv);
    if (!csv)
        return imk_error_set(error, IMK_ERROR_MEMORY, "", NULL, NULL);
    csv->read_cells = imki_log_cells_choose();
    reader->state = csv;
    imk_status status = check_text(text, error);
    if (status == IMK_OK)
        status = imki_csv_header_read(reader, error);
    if (status != IMK_OK)
        return status;
    imki_csv_look_at(reader, &csv->look);
    status = check_commas(csv, reader->layout.separator, error);
    if (status == IMK_OK)
        status = make_layout(reader, csv, error);
    if (status != IMK_OK)
        return status;
    find_stamps(reader, csv);
    if (csv->time_cell < IMK_LOG_COLUMNS_MAX)
        status = imki_csv_time_unit_check(&csv->look, &reader->layout, csv->time_cell, error);
    if (status != IMK_OK)
        return status;
    const size_t line = text->line;
    csv->begin = imki_log_text_place(text);
    text->hold = text->next;
    status = find_labels(reader, error);
    imki_csv_go_back(text, line);
    if (status == IMK_OK)
        status = look_at_rows(reader, error);
    imki_csv_go_back(text, line);
    text->hold = NULL;
    return status;
}

static void close_csv(imk_log_reader *reader)
{
    imki_csv *csv = reader->state;
    if (!csv)
        return;
    free(csv->header.line);
    free(csv->header.units);
    free(csv);
    reader->state = NULL;
}

/* To the beginning of the line behind that place. */
static imk_status seek_row(imk_log_reader *reader, double fraction, imk_error *error)
{
    const imki_csv *state = reader->state;
    imki_log_piece line;
    uint64_t done, size;
    bool whole;
    imki_log_text_progress(&reader->text, &done, &size);
    if (size < state->begin)
        size = state->begin;
    const uint64_t to = state->begin + (uint64_t)(fraction * (double)(size - state->begin));
    imk_status status = imki_log_text_seek(&reader->text, to, error);
    if (status != IMK_OK || to == state->begin)
        return status;
    status = imki_log_text_need_line(&reader->text, error);
    if (status == IMK_OK)
        imki_log_text_take_line(&reader->text, &line.begin, &line.end, &whole);
    return status;
}

/* Each line of the text. */
static void write_comment(imki_log_output *log, const char *text)
{
    do {
        const size_t length = strcspn(text, "\r\n");
        imk_output_file_write(log->file, "# ", 2);
        imk_output_file_write(log->file, text, length);
        imk_output_file_write(log->file, "\n", 1);
        text += length;
        text += strspn(text, "\r\n");
    } while (*text != '\0');
}

static void begin(imki_log_output *log)
{
    imki_log_names_write(log->file, log->rows.column_count, log->column, ',');
    imk_output_file_write(log->file, "\n", 1);
}

const imki_log_codec imki_log_csv = {.open = open_csv,
                                     .read = imki_csv_rows_read,
                                     .close = close_csv,
                                     .seek = seek_row,
                                     .comment = write_comment,
                                     .begin = begin,
                                     .format = imki_log_format_text};
