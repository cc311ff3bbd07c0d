/* SPDX-License-Identifier: Apache-2.0 */
/* Logs as CSV text: is it a text, which separator, a header or not, what the first rows show; rows,
 * plain ones the fast way (log_cells.c), others in their general form (log_row.c). */
#include "io/file/text_file_internal.h"
#include "log_cells_internal.h"
#include "log_reader_internal.h"
#include "maker/foreign_kinds_internal.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LOOK = 4096 };           /* bytes looked at to tell a text */
enum { LOOK_AHEAD = 16 << 20 }; /* for the first cell of a column that is not blank */

typedef struct csv {
    imki_log_cells_reader *read_cells;
    size_t slow_left, slow_run; /* rows to read in their general form before trying the fast way */
    uint64_t begin;             /* byte of the first row */
} csv;

/* Texts of other systems, which other programs convert. @param size  above 0 */
static imk_status check_encoding(const char *begin, size_t size, imk_error *error)
{
    const imk_status foreign = imki_foreign_kind_refuse(begin, size, error);
    if (foreign != IMK_OK)
        return foreign;
    if (size >= 2 && (memcmp(begin, "\xFF\xFE", 2) == 0 || memcmp(begin, "\xFE\xFF", 2) == 0))
        return imk_error_set(error, IMK_ERROR_FORMAT, "", "the text is UTF-16",
                             "convert it: iconv -f UTF-16 -t UTF-8 FILE >NEW.csv");
    if (!imki_is_text(begin, size)) {
        char others[96], expected[160];
        snprintf(expected, sizeof expected, "a log as CSV (plain, .gz or .zst)%s",
                 imk_log_formats_text(" or ", false, sizeof others, others));
        return imk_error_set(error, IMK_ERROR_FORMAT, "", "the file is not a text log", expected);
    }
    /* The newline of a last CR may not be seen yet. */
    if (memchr(begin, '\r', size - 1) && !memchr(begin, '\n', size))
        return imk_error_set(error, IMK_ERROR_FORMAT, "", "the end of each line is CR alone",
                             "convert it: tr '\\r' '\\n' <FILE >NEW.csv");
    return IMK_OK;
}

static imk_status check_text(imki_log_text *text, imk_error *error)
{
    imk_status status = imki_log_text_need(text, LOOK, error);
    if (status != IMK_OK)
        return status;
    const size_t at_hand = (size_t)(text->end - text->next);
    if (at_hand == 0)
        return imk_error_set(error, IMK_ERROR_EMPTY, "", "the log is empty",
                             "a header and rows of numbers");
    status = check_encoding(text->next, at_hand < LOOK ? at_hand : LOOK, error);
    if (status != IMK_OK)
        return status;
    if (at_hand >= 3 && memcmp(text->next, "\xEF\xBB\xBF", 3) == 0) /* byte-order mark */
        text->next += 3;
    return IMK_OK;
}

/* The next line that is neither blank nor a comment. *found is false at the end. */
static imk_status next_line(imki_log_text *text, imki_log_piece *line, bool *whole, bool *found,
                            imk_error *error)
{
    for (;;) {
        const imk_status status = imki_log_text_need_line(text, error);
        if (status != IMK_OK)
            return status;
        *found = imki_log_text_take_line(text, &line->begin, &line->end, whole);
        if (!*found || !imki_log_line_is_idle(line->begin, line->end))
            return IMK_OK;
    }
}

/* Begin anew with the rows. */
static void go_back(imki_log_text *text, size_t line)
{
    text->next = text->hold;
    if (text->lines_end < text->next)
        text->lines_end = text->next;
    text->line = line;
}

/* Only whole numbers in some cells of the first rows, and one beyond 9: most likely counts. */
static bool look_like_counts(imki_log_text *text, char separator, size_t count, const bool *asked)
{
    enum { ROWS = 8 };
    const size_t line = text->line;
    bool whole_numbers = true, any = false;
    text->hold = text->next;
    for (int row = 0; row < ROWS && whole_numbers; row++) {
        imki_log_piece at, cells[IMK_LOG_COLUMNS_MAX];
        bool whole, found;
        if (next_line(text, &at, &whole, &found, NULL) != IMK_OK || !found ||
            imki_log_split(at.begin, at.end, separator, IMK_LOG_COLUMNS_MAX, cells) != count)
            break;
        for (size_t i = 0; i < count; i++) {
            const size_t length = (size_t)(cells[i].end - cells[i].begin);
            size_t digits = 0;
            for (size_t k = 0; asked[i] && k < length; k++) {
                const char c = cells[i].begin[k];
                const bool digit = c >= '0' && c <= '9';
                digits += digit;
                whole_numbers = whole_numbers && (digit || c == '-' || c == '+');
            }
            any = any || digits > 1;
        }
    }
    go_back(text, line);
    text->hold = NULL;
    return whole_numbers && any;
}

/* What a unit is missing for, and readings that look like counts. */
static void suggest_counts(imk_log_reader *reader, const imki_log_piece *cells, size_t count,
                           imk_error *error)
{
    imk_log_settings settings = reader->settings;
    bool asked[IMK_LOG_COLUMNS_MAX] = {false};
    int sensors = 0; /* 1: gyros, 2: accelerometers lack their unit */
    settings.gyro_unit = settings.gyro_unit ? settings.gyro_unit : "count";
    settings.accel_unit = settings.accel_unit ? settings.accel_unit : "count";
    for (size_t i = 0; i < count; i++) {
        imk_log_column as_counts, as_stated;
        const bool sensor = imki_log_column_make(cells[i], &settings, &as_counts, NULL) == IMK_OK &&
                            (as_counts.quantity == IMK_QUANTITY_ANGULAR_RATE ||
                             as_counts.quantity == IMK_QUANTITY_SPECIFIC_FORCE);
        asked[i] = sensor && imki_log_column_make(cells[i], &reader->settings, &as_stated, NULL) ==
                                 IMK_ERROR_UNIT_MISSING;
        if (asked[i])
            sensors |= as_counts.quantity == IMK_QUANTITY_ANGULAR_RATE ? 1 : 2;
    }
    if (sensors > 0 && look_like_counts(&reader->text, reader->layout.separator, count, asked))
        snprintf(error->expected, sizeof error->expected,
                 "add %s%s%s (the readings are whole numbers; or a unit such as deg/s, g)",
                 sensors & 1 ? "--gyro-unit count" : "", sensors == 3 ? " " : "",
                 sensors & 2 ? "--accel-unit count" : "");
}

static imk_status refuse_no_header(size_t count, bool counts, imk_error *error)
{
    static const char sensors[] = "gyro_x,gyro_y,gyro_z,accel_x,accel_y,accel_z";
    const char *units =
        counts ? "--gyro-unit count --accel-unit count" : "--gyro-unit deg/s --accel-unit g";
    char expected[160];
    if (count == 6)
        snprintf(expected, sizeof expected, "add --columns %s %s --rate 100Hz", sensors, units);
    else if (count == 7)
        snprintf(expected, sizeof expected, "add --columns time,%s --time-unit s %s", sensors,
                 units);
    else
        snprintf(expected, sizeof expected,
                 "add --columns with %zu names (time,gyro_x,...; - skips one), --time-unit s %s",
                 count, units);
    return imk_error_set(error, IMK_ERROR_COLUMN, "", "no header: the first row is all numbers",
                         expected);
}

/* The first line is a row: of six readings, or of a time and six. */
static imk_status refuse_headless(imk_log_reader *reader, imki_log_piece line, char separator,
                                  size_t count, imk_error *error)
{
    bool asked[IMK_LOG_COLUMNS_MAX] = {false};
    for (size_t i = 0; i < count; i++)
        asked[i] = count == 6 || i > 0;
    reader->text.next = line.begin;
    return refuse_no_header(count, look_like_counts(&reader->text, separator, count, asked), error);
}

/* Names from the settings, with the unit of the file's header where they have none. */
static imk_status replace_names(const char *columns, bool has_header, size_t count,
                                imki_log_piece *cells, char (*text)[128], imk_error *error)
{
    imki_log_piece names[IMK_LOG_COLUMNS_MAX];
    const size_t name_count =
        imki_log_split(columns, columns + strlen(columns), ',', IMK_LOG_COLUMNS_MAX, names);
    if (name_count != count) {
        char found[96], expected[96];
        snprintf(found, sizeof found, "the list has %zu name%s", name_count,
                 name_count == 1 ? "" : "s");
        snprintf(expected, sizeof expected,
                 "%zu, one for each column of the log (- skips a column)", count);
        return imk_error_set(error, IMK_ERROR_COLUMN, "columns", found, expected);
    }
    for (size_t i = 0; i < count; i++) {
        const imki_log_piece name = names[i], cell = cells[i];
        const bool has_unit = memchr(name.begin, '[', (size_t)(name.end - name.begin)) ||
                              memchr(name.begin, '(', (size_t)(name.end - name.begin));
        const char *unit = NULL;
        for (const char *p = cell.begin; has_header && !has_unit && !unit && p < cell.end; p++)
            if (*p == '[' || *p == '(')
                unit = p;
        const bool skip = name.end - name.begin == 1 && *name.begin == '-';
        const int length =
            snprintf(text[i], sizeof text[i], "%.*s %.*s", (int)(name.end - name.begin), name.begin,
                     unit && !skip ? (int)(cell.end - unit) : 0, unit ? unit : "");
        const size_t room = sizeof text[i] - 1;
        cells[i] =
            (imki_log_piece){text[i], text[i] + ((size_t)length < room ? (size_t)length : room)};
    }
    return IMK_OK;
}

static imk_status read_names(imk_log_reader *reader, imk_error *error)
{
    const imk_log_settings *settings = &reader->settings;
    imki_log_text *text = &reader->text;
    imki_log_piece line, cells[IMK_LOG_COLUMNS_MAX];
    bool whole, found;
    imk_status status = next_line(text, &line, &whole, &found, error);
    if (status != IMK_OK)
        return status;
    if (!found)
        return imk_error_set(error, IMK_ERROR_EMPTY, "", "the log has no header and no rows",
                             "a header and rows of numbers");
    const size_t header_line = text->line - 1;
    const char separator = imki_log_find_separator(line.begin, line.end);
    const size_t count =
        imki_log_split(line.begin, line.end, separator, IMK_LOG_COLUMNS_MAX, cells);
    if (count > IMK_LOG_COLUMNS_MAX)
        return imk_error_set(error, IMK_ERROR_COLUMN, "", "the log has more than 64 columns",
                             "at most 64 columns");
    bool numbers = true;
    double value;
    for (size_t i = 0; i < count; i++)
        numbers &= imki_log_piece_is_number(cells[i], &value);
    char text_of_names[IMK_LOG_COLUMNS_MAX][128];
    if (settings->columns)
        status = replace_names(settings->columns, !numbers, count, cells, text_of_names, error);
    else if (numbers)
        status = refuse_headless(reader, line, separator, count, error);
    if (status != IMK_OK)
        return status;
    reader->layout.separator = separator;
    status = imki_log_layout_make(cells, count, settings, &reader->layout, error);
    if (status == IMK_ERROR_UNIT_MISSING && error && !numbers)
        suggest_counts(reader, cells, count, error);
    if (status != IMK_OK && error && !settings->columns)
        error->line = header_line;
    if (numbers) { /* it was a row */
        text->next = line.begin;
        text->line = header_line;
    }
    return status;
}

/* What the cells of a row say of columns that are `open`. */
static imk_status look_at_cells(imk_log_reader *reader, const imki_log_piece *cells, bool *open,
                                size_t *left, imk_error *error)
{
    imki_log_layout_read *layout = &reader->layout;
    double value;
    for (size_t i = 0; i < layout->cell_count; i++) {
        if (!open[i] || cells[i].begin == cells[i].end)
            continue;
        open[i] = false;
        --*left;
        if (imki_log_piece_is_number(cells[i], &value))
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
        if (next_line(text, &line, &whole, &found, NULL) != IMK_OK || !found ||
            imki_log_split(line.begin, line.end, layout->separator, IMK_LOG_COLUMNS_MAX, cells) !=
                layout->cell_count)
            return IMK_OK;
        const imk_status status = look_at_cells(reader, cells, open, &left, error);
        if (status != IMK_OK)
            return status;
    }
    return IMK_OK;
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
    for (; rows < rows_wanted; rows++) {
        imki_log_piece line;
        bool whole, found, not_finite;
        const imk_status status = next_line(&reader->text, &line, &whole, &found, error);
        if (status != IMK_OK)
            return status;
        if (!found)
            break;
        if (imki_log_row_read(layout, line, whole, 0, reader->labels, &reader->label_count, values,
                              &not_finite, NULL) != IMK_OK)
            return IMK_OK;
        if (layout->time_column >= 0)
            time[rows] = values[layout->time_column];
    }
    return imki_log_first_rows(reader, rows, time, "the log has a header but no rows",
                               "at least one row of numbers below the header", error);
}

static imk_status open_csv(imk_log_reader *reader, imk_error *error)
{
    imki_log_text *text = &reader->text;
    csv *state = calloc(1, sizeof *state);
    if (!state)
        return imk_error_set(error, IMK_ERROR_MEMORY, "", NULL, NULL);
    state->read_cells = imki_log_cells_choose();
    reader->state = state;
    imk_status status = check_text(text, error);
    if (status == IMK_OK)
        status = read_names(reader, error);
    if (status != IMK_OK)
        return status;
    const size_t line = text->line;
    state->begin = imki_log_text_place(text);
    text->hold = text->next;
    status = find_labels(reader, error);
    go_back(text, line);
    if (status == IMK_OK)
        status = look_at_rows(reader, error);
    go_back(text, line);
    text->hold = NULL;
    return status;
}

/* One row in its general form, or an idle line. *rows grows by the rows it gave. */
static imk_status read_row(imk_log_reader *reader, double *const *out, size_t *rows,
                           imk_error *error)
{
    imki_log_layout_read *layout = &reader->layout;
    imki_log_piece line;
    bool whole, not_finite = false;
    double values[IMK_LOG_COLUMNS_MAX];
    const size_t number = reader->text.line;
    if (!imki_log_text_take_line(&reader->text, &line.begin, &line.end, &whole) ||
        imki_log_line_is_idle(line.begin, line.end))
        return IMK_OK;
    const imk_status status = imki_log_row_read(layout, line, whole, number, reader->labels,
                                                &reader->label_count, values, &not_finite, error);
    if (status != IMK_OK)
        return status;
    for (size_t i = 0; i < layout->cell_count; i++)
        if (layout->cell_column[i] >= 0)
            out[i][*rows] = values[layout->cell_column[i]];
    ++*rows;
    if (not_finite && reader->not_finite++ == 0)
        reader->first_not_finite = reader->rows + *rows;
    return IMK_OK;
}

/* To the beginning of the line behind that place. */
static imk_status seek_row(imk_log_reader *reader, double fraction, imk_error *error)
{
    const csv *state = reader->state;
    imki_log_piece line;
    uint64_t done, size;
    bool whole;
    imk_log_progress(reader, &done, &size);
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

static imk_status read_rows(imk_log_reader *reader, size_t max_rows, double *const *out,
                            size_t *rows, imk_error *error)
{
    imki_log_text *text = &reader->text;
    csv *state = reader->state;
    const imki_log_cells cells = {reader->layout.cell_count, reader->layout.separator,
                                  reader->layout.cell_factor};
    *rows = 0;
    while (*rows < max_rows) {
        imk_status status = imki_log_text_need_line(text, error);
        if (status != IMK_OK)
            return status;
        if (text->next == text->end)
            return IMK_OK;
        if (state->slow_left == 0 && text->next < text->lines_end) {
            double *place[IMK_LOG_COLUMNS_MAX];
            for (size_t i = 0; i < cells.cell_count; i++)
                place[i] = out[i] + *rows;
            const size_t read = state->read_cells(&cells, text->base, &text->next, text->lines_end,
                                                  place, max_rows - *rows);
            *rows += read;
            text->line += read;
            if (read > 0) {
                state->slow_run = 0;
                continue;
            }
            /* Where rows are not plain, try less and less often. */
            state->slow_run = state->slow_run < 32 ? 2 * state->slow_run + 1 : 63;
            state->slow_left = state->slow_run;
        }
        status = read_row(reader, out, rows, error);
        if (status != IMK_OK)
            return status;
        state->slow_left -= state->slow_left > 0;
    }
    return IMK_OK;
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
                                     .read = read_rows,
                                     .seek = seek_row,
                                     .comment = write_comment,
                                     .begin = begin,
                                     .format = imki_log_format_text};
