/* SPDX-License-Identifier: Apache-2.0 */
/* The header of a CSV text: the first line, the last comment before the rows, or none; the names
 * and units of its cells, with those of the settings and of a line of units. What programs write in
 * their own way is in log_csv_programs.c. */
#include "log_csv_internal.h"

#include "base/text_internal.h"
#include "imukit/decimal.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static char *copy_line(imki_log_piece line)
{
    const size_t size = (size_t)(line.end - line.begin);
    char *text = malloc(size + 1);
    if (text) {
        memcpy(text, line.begin, size);
        text[size] = '\0';
    }
    return text;
}

static imk_status no_memory(imk_error *error)
{
    return imk_error_set(error, IMK_ERROR_MEMORY, "", NULL, NULL);
}

imk_status imki_csv_line(imki_log_text *text, imki_log_piece *line, bool *whole, bool *found,
                         imki_csv_comment *comment, imk_error *error)
{
    for (;;) {
        const imk_status status = imki_log_text_need_line(text, error);
        if (status != IMK_OK)
            return status;
        *found = imki_log_text_take_line(text, &line->begin, &line->end, whole);
        if (!*found || !imki_log_line_is_idle(line->begin, line->end))
            return IMK_OK;
        const char *begin = line->begin;
        while (begin < line->end && (*begin == ' ' || *begin == '\t'))
            begin++;
        if (!comment || begin == line->end)
            continue;
        free(comment->text);
        comment->text = copy_line(*line);
        comment->line = text->line - 1;
        if (!comment->text)
            return no_memory(error);
    }
}

void imki_csv_go_back(imki_log_text *text, size_t line)
{
    text->next = text->hold;
    if (text->lines_end < text->next)
        text->lines_end = text->next;
    text->line = line;
}

bool imki_csv_is_value(imki_log_piece cell)
{
    double value;
    char text[IMKI_CSV_CELL];
    if (imki_log_piece_is_number(cell, &value) || imki_log_piece_is_missing(cell) ||
        imki_log_date_read(cell.begin, cell.end, NULL))
        return true;
    imki_log_piece_copy(text, sizeof text, cell);
    char *comma = strchr(text, ',');
    if (!comma || (size_t)(cell.end - cell.begin) >= sizeof text)
        return false;
    *comma = '.';
    return imki_log_piece_is_number((imki_log_piece){text, text + strlen(text)}, &value);
}

/* A row and no header: values, and one of them is more than a word for none. */
static bool is_row(const imki_log_piece *cells, size_t count)
{
    bool any = false;
    for (size_t i = 0; i < count; i++) {
        if (!imki_csv_is_value(cells[i]))
            return false;
        any = any || !imki_log_piece_is_missing(cells[i]);
    }
    return any;
}

/* ---------------------------------------------------------------------------- where the names are
 */

static imk_status keep_header(imki_csv_header *header, imki_log_piece line, char separator,
                              imk_error *error)
{
    free(header->line);
    header->line = copy_line(line);
    if (!header->line)
        return no_memory(error);
    header->count = imki_log_split(header->line, header->line + strlen(header->line), separator,
                                   IMK_LOG_COLUMNS_MAX, header->cell);
    return IMK_OK;
}

/* Is the last comment before the first row its header? "# time [s], gyro_x [deg/s], …" */
static bool is_comment_header(const char *comment, imki_log_piece row, char *separator,
                              imki_log_piece *names)
{
    const char *begin = comment + strspn(comment, " \t#%/"), *end = begin + strlen(begin);
    imki_log_piece cells[IMK_LOG_COLUMNS_MAX];
    imki_log_cell named[IMK_LOG_COLUMNS_MAX];
    const char candidates[2] = {imki_log_find_separator(begin, end), *separator};
    for (int k = 0; k < 2; k++) {
        const size_t count = imki_log_split(begin, end, candidates[k], IMK_LOG_COLUMNS_MAX, cells);
        imki_log_piece due[IMK_LOG_COLUMNS_MAX];
        if (count > IMK_LOG_COLUMNS_MAX || count < 2 ||
            imki_log_split(row.begin, row.end, candidates[k], IMK_LOG_COLUMNS_MAX, due) != count)
            continue;
        imki_log_cells_name(cells, count, named);
        for (size_t i = 0; i < count; i++)
            if (named[i].name.kind) {
                *separator = candidates[k];
                *names = (imki_log_piece){begin, end};
                return true;
            }
    }
    return false;
}

/* A row with texts in it, below a comment that is its header. */
static bool is_row_below(const imki_csv_comment *comment, imki_log_piece line,
                         const imki_log_piece *cells, size_t count)
{
    imki_log_cell named[IMK_LOG_COLUMNS_MAX];
    imki_log_piece names;
    char separator = imki_log_find_separator(line.begin, line.end);
    bool number = false, known = false;
    double value;
    imki_log_cells_name(cells, count, named);
    for (size_t i = 0; i < count; i++) {
        number = number || imki_log_piece_is_number(cells[i], &value);
        known = known || named[i].name.kind;
    }
    return number && !known && comment->text &&
           is_comment_header(comment->text, line, &separator, &names);
}

static imk_status refuse_headless(size_t count, imk_error *error)
{
    static const char sensors[] = "gyro_x,gyro_y,gyro_z,accel_x,accel_y,accel_z";
    char expected[300];
    if (count == 6 || count == 7)
        snprintf(expected, sizeof expected,
                 "add --columns with the names in their order, such as \"%s%s\"; - skips a column, "
                 "and units as in gyro_x [UNIT]%s",
                 count == 7 ? "time," : "", sensors,
                 count == 7 ? "" : "; add --rate RATE, too (samples per second)");
    else
        snprintf(expected, sizeof expected,
                 "add --columns with %zu names in their order (time,gyro_x,...; - skips one), and "
                 "units as in gyro_x [UNIT]",
                 count);
    return imk_error_set(error, IMK_ERROR_COLUMN, "", "no header: the first row is all numbers",
                         expected);
}

/* ------------------------------------------------------------------------------ other names, units
 */

/* Names of a list, with the unit of the file's header where they have none. */
static imk_status replace_names(const char *columns, bool has_header, imki_csv_header *header,
                                imk_error *error)
{
    imki_log_piece names[IMK_LOG_COLUMNS_MAX];
    const size_t count = header->count;
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
        imki_log_piece name = names[i], unit, own = header->cell[i], own_unit;
        char first[48], second[60] = "";
        const bool skip = name.end - name.begin == 1 && *name.begin == '-';
        imki_log_unit_split(&name, &unit);
        imki_log_unit_split(&own, &own_unit);
        if (own_unit.begin == own_unit.end)
            own_unit = imki_log_unit_of_name(own);
        imki_log_piece_copy(first, sizeof first, name);
        const imki_log_kind *kind = imki_log_name_of(first).kind;
        const imk_status status =
            has_header && !skip ? imki_log_units_agree("columns", kind, own, unit, own_unit, error)
                                : IMK_OK;
        if (status != IMK_OK)
            return status;
        if (unit.begin < unit.end)
            imki_log_piece_copy(second, sizeof second, unit);
        else if (has_header && !skip)
            imki_log_piece_copy(second, sizeof second, own_unit);
        snprintf(header->text[i], sizeof header->text[i], second[0] ? "%s [%s]" : "%s", first,
                 second);
        header->cell[i] =
            (imki_log_piece){header->text[i], header->text[i] + strlen(header->text[i])};
    }
    return IMK_OK;
}

/* "column 1", "column 2": for a look at a table without header. */
static void number_columns(imki_csv_header *header)
{
    for (size_t i = 0; i < header->count; i++) {
        snprintf(header->text[i], sizeof header->text[i], "column %zu", i + 1);
        header->cell[i] =
            (imki_log_piece){header->text[i], header->text[i] + strlen(header->text[i])};
    }
}

/* "[deg/s]", "(deg/s)", "deg/s" in a line of units. */
static imki_log_piece without_brackets(imki_log_piece cell)
{
    const bool brackets = cell.end - cell.begin >= 2 && (*cell.begin == '[' || *cell.begin == '(');
    return brackets ? (imki_log_piece){cell.begin + 1, cell.end - 1} : cell;
}

/* The kind of a column by its name and its unit: that of the header, or else the one below it. */
static const imki_log_kind *kind_below(imki_log_piece header, imki_log_piece below)
{
    char text[IMKI_LOG_NAME_SIZE], name[48], unit[60];
    imki_log_piece bare = header, own;
    imki_log_cell cell;
    imki_log_unit_split(&bare, &own);
    imki_log_piece_copy(name, sizeof name, bare);
    imki_log_piece_copy(unit, sizeof unit, own.begin < own.end ? own : below);
    snprintf(text, sizeof text, "%s [%s]", name, unit);
    const imki_log_piece whole = {text, text + strlen(text)};
    imki_log_cells_name(&whole, 1, &cell);
    return cell.name.kind;
}

/* Is it one that the column may have, or any? Of what is not UTF-8 the unit is told later. */
static bool is_unit_for(imki_log_piece header, imki_log_piece cell)
{
    imk_unit unit;
    const imki_log_kind *kind = kind_below(header, cell);
    return imk_unit_parse(cell.begin, cell.end, &unit, NULL) == IMK_OK ||
           (kind && imki_log_unit_read(cell, kind, &unit, NULL) == IMK_OK) ||
           !imki_csv_is_utf8(cell);
}

/* A line of units below that of names: "s,deg/s,deg/s". Words for no unit may stand among them. */
static bool is_unit_row(const imki_csv_header *header, const imki_log_piece *cells, size_t count)
{
    static const char *const none[] = {"", "-", "none", "n/a", "1", "text", "bool", "flags"};
    size_t units = 0;
    for (size_t i = 0; i < count; i++) {
        char text[40];
        const imki_log_piece cell = without_brackets(cells[i]);
        imki_log_piece_copy(text, sizeof text, cell);
        bool is_none = false;
        for (size_t k = 0; k < sizeof none / sizeof none[0]; k++)
            is_none = is_none || strcmp(text, none[k]) == 0;
        const bool is_unit = is_unit_for(header->cell[i], cell);
        if (!is_none && !is_unit)
            return false;
        units += is_unit && !is_none;
    }
    return units > 0;
}

/* Give the cell of a name the unit below it. One that is there already must be the same. */
static imk_status take_unit(imki_csv_header *header, size_t index, imki_log_piece cell,
                            imk_error *error)
{
    char name[48], unit[60], own_text[16], found[96];
    imki_log_piece own, bare = header->cell[index];
    imki_log_unit_split(&bare, &own);
    imki_log_piece_copy(name, sizeof name, bare);
    imki_log_piece_copy(unit, sizeof unit, cell);
    if (!unit[0] || strcmp(unit, "-") == 0)
        return IMK_OK;
    if (own.begin < own.end) {
        imki_log_piece_copy(own_text, sizeof own_text, own);
        snprintf(found, sizeof found,
                 "%.16s in the line of units does not agree with [%s] in the header", unit,
                 own_text);
        return imki_log_units_agree("", kind_below(header->cell[index], cell), bare, cell, own,
                                    NULL) == IMK_OK
                   ? IMK_OK
                   : imk_error_set(error, IMK_ERROR_CONFLICT, name, found,
                                   "correct the one that is wrong");
    }
    snprintf(header->text[index], sizeof header->text[index], "%s [%s]", name, unit);
    header->cell[index] =
        (imki_log_piece){header->text[index], header->text[index] + strlen(header->text[index])};
    return IMK_OK;
}

/* Take the line behind the header if it is one of units. */
static imk_status take_units(imk_log_reader *reader, imki_csv_header *header, imk_error *error)
{
    imki_log_text *text = &reader->text;
    imki_log_piece line, cells[IMK_LOG_COLUMNS_MAX];
    const size_t number = text->line;
    bool whole, found;
    text->hold = text->next;
    const imk_status status = imki_csv_line(text, &line, &whole, &found, NULL, error);
    if (status != IMK_OK)
        return status;
    const size_t count = found ? imki_log_split(line.begin, line.end, reader->layout.separator,
                                                IMK_LOG_COLUMNS_MAX, cells)
                               : 0;
    if (count != header->count || !is_unit_row(header, cells, count)) {
        imki_csv_go_back(text, number);
        text->hold = NULL;
        return IMK_OK;
    }
    text->hold = NULL;
    header->units = copy_line(line);
    if (!header->units)
        return no_memory(error);
    for (size_t i = 0; i < count; i++) {
        const imk_status taken = take_unit(header, i, without_brackets(cells[i]), error);
        if (taken != IMK_OK)
            return taken;
    }
    return IMK_OK;
}

/* ------------------------------------------------------------------------------------------- read
 */

/* The first line is a row: names are in a comment, in the settings or of the format. */
static imk_status name_row(imk_log_reader *reader, imki_log_piece line,
                           const imki_csv_comment *comment, char separator, imk_error *error)
{
    imki_csv_header *header = &((imki_csv *)reader->state)->header;
    const imk_log_settings *settings = &reader->settings;
    const imki_log_dialect *dialect =
        settings->format ? imki_log_dialect_named(settings->format) : NULL;
    imki_log_piece names;
    imk_status status;
    header->is_row = true;
    header->is_comment =
        comment->text && is_comment_header(comment->text, line, &separator, &names);
    if (header->is_comment)
        header->number = comment->line;
    reader->layout.separator = separator;
    status = keep_header(header, header->is_comment ? names : line, separator, error);
    if (status != IMK_OK)
        return status;
    if (dialect)
        return replace_names(dialect->columns, false, header, error);
    if (settings->columns)
        return replace_names(settings->columns, header->is_comment, header, error);
    if (!header->is_comment && settings->as_written)
        number_columns(header);
    else if (!header->is_comment)
        return refuse_headless(header->count, error);
    imki_csv_dialect_apply(header, settings->map != NULL);
    return IMK_OK;
}

static imk_status name_header(imk_log_reader *reader, imki_log_piece line, char separator,
                              const imki_csv_scales *scales, imk_error *error)
{
    imki_csv_header *header = &((imki_csv *)reader->state)->header;
    reader->layout.separator = separator;
    imk_status status = keep_header(header, line, separator, error);
    if (status == IMK_OK && !scales)
        status = imki_csv_preamble_check(reader, error);
    if (status == IMK_OK)
        status = take_units(reader, header, error);
    if (status != IMK_OK)
        return status;
    if (reader->settings.columns)
        return replace_names(reader->settings.columns, true, header, error);
    if (scales)
        imki_csv_gyroflow_apply(header, scales, reader->settings.map != NULL);
    else
        imki_csv_dialect_apply(header, reader->settings.map != NULL);
    return IMK_OK;
}

static imk_status read_names(imk_log_reader *reader, imki_csv_comment *comment, imk_error *error)
{
    imki_log_text *text = &reader->text;
    imki_csv_header *header = &((imki_csv *)reader->state)->header;
    imki_log_piece line, cells[IMK_LOG_COLUMNS_MAX];
    imki_csv_scales scales = {.found = false};
    bool whole, found;
    imk_status status = imki_csv_line(text, &line, &whole, &found, comment, error);
    if (status == IMK_OK && found)
        status = imki_csv_preamble_skip(reader, &line, &whole, &found, &scales, error);
    if (status != IMK_OK)
        return status;
    if (!found)
        return imk_error_set(error, IMK_ERROR_EMPTY, "", "the log has no header and no rows",
                             "a header and rows of numbers");
    header->number = text->line - 1;
    const char separator = imki_log_find_separator(line.begin, line.end);
    const size_t count =
        imki_log_split(line.begin, line.end, separator, IMK_LOG_COLUMNS_MAX, cells);
    if (count > IMK_LOG_COLUMNS_MAX)
        return imk_error_set(error, IMK_ERROR_COLUMN, "", "the log has more than 64 columns",
                             "at most 64 columns");
    if (!is_row(cells, count) && !is_row_below(comment, line, cells, count))
        return name_header(reader, line, separator, scales.found ? &scales : NULL, error);
    status = name_row(reader, line, comment, separator, error);
    text->next = line.begin; /* it is the first row */
    text->line--;
    return status;
}

imk_status imki_csv_header_read(imk_log_reader *reader, imk_error *error)
{
    imki_csv_header *header = &((imki_csv *)reader->state)->header;
    imki_csv_comment comment = {.text = NULL};
    for (size_t i = 0; i < IMK_LOG_COLUMNS_MAX; i++)
        header->scale[i] = 1;
    const imk_status status = read_names(reader, &comment, error);
    free(comment.text);
    return status;
}
