/* SPDX-License-Identifier: Apache-2.0 */
/* A row of a CSV text in its general form: any of the separators, blanks and quotes around cells,
 * empty cells, nan, labels. */
#include "imukit/decimal.h"

#include "base/text_internal.h"
#include "io/log/log_reader_internal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static bool is_blank(char c)
{
    return c == ' ' || c == '\t';
}

bool imki_log_line_is_idle(const char *begin, const char *end)
{
    while (begin < end && is_blank(*begin))
        begin++;
    return begin == end || *begin == '#' || *begin == '%' ||
           (end - begin >= 2 && begin[0] == '/' && begin[1] == '/');
}

/* End of a cell: the separator outside brackets and quotes. */
static const char *find_cell_end(const char *p, const char *end, char separator)
{
    int depth = 0;
    bool quoted = false;
    for (; p < end; p++) {
        if (*p == '"')
            quoted = !quoted;
        else if (*p == '[' || *p == '(')
            depth++;
        else if ((*p == ']' || *p == ')') && depth > 0)
            depth--;
        else if (depth == 0 && !quoted && (*p == separator || (separator == ' ' && *p == '\t')))
            return p;
    }
    return end;
}

char imki_log_find_separator(const char *begin, const char *end)
{
    static const char candidates[] = "\t;,";
    for (const char *c = candidates; *c; c++) {
        /* A tab that only pads is no separator when another one is there. */
        const char *found = find_cell_end(begin, end, *c);
        const bool padded = *c == '\t' && (find_cell_end(begin, end, ',') < end ||
                                           find_cell_end(begin, end, ';') < end);
        if (found < end && !padded)
            return *c;
    }
    return ' ';
}

static imki_log_piece strip(const char *begin, const char *end)
{
    while (begin < end && is_blank(*begin))
        begin++;
    while (end > begin && is_blank(end[-1]))
        end--;
    if (end - begin >= 2 && *begin == '"' && end[-1] == '"') {
        begin++;
        end--;
    }
    return (imki_log_piece){begin, end};
}

/* A unit in brackets after a blank belongs to the name before it. */
static const char *take_unit(const char *after, const char *end)
{
    const char *p = after;
    while (p < end && is_blank(*p))
        p++;
    if (p < end && (*p == '[' || *p == '('))
        return find_cell_end(p, end, ' ');
    return after;
}

size_t imki_log_split(const char *begin, const char *end, char separator, size_t max_count,
                      imki_log_piece *cells)
{
    size_t count = 0;
    const bool blanks = separator == ' ';
    if (blanks)
        while (end > begin && is_blank(end[-1]))
            end--;
    for (const char *p = begin;; p++) {
        if (blanks)
            while (p < end && is_blank(*p))
                p++;
        const char *cell_end = find_cell_end(p, end, separator);
        if (blanks)
            cell_end = take_unit(cell_end, end);
        if (count < max_count)
            cells[count] = strip(p, cell_end);
        count++;
        p = cell_end;
        if (p >= end)
            return count;
    }
}

bool imki_log_piece_is_number(imki_log_piece piece, double *value)
{
    return piece.begin < piece.end && imk_decimal_parse(piece.begin, piece.end, value) == piece.end;
}

bool imki_log_piece_is_missing(imki_log_piece piece)
{
    static const char *const words[] = {"-", "--", "n/a", "#n/a", "na", "null", "none", "nil"};
    const size_t length = (size_t)(piece.end - piece.begin);
    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++) {
        size_t same = 0;
        while (same < length && imki_lower(piece.begin[same]) == words[i][same] && words[i][same])
            same++;
        if (same == length && words[i][same] == '\0')
            return true;
    }
    return length == 0;
}

/* A number as the log writes them; with a decimal comma there is no point. */
static bool is_number(const imki_log_layout_read *layout, imki_log_piece cell, double *value)
{
    char text[64];
    const size_t length = (size_t)(cell.end - cell.begin);
    if (!layout->decimal_comma)
        return imki_log_piece_is_number(cell, value);
    if (length >= sizeof text || memchr(cell.begin, '.', length))
        return false;
    memcpy(text, cell.begin, length);
    char *comma = memchr(text, ',', length);
    if (comma)
        *comma = '.';
    return imki_log_piece_is_number((imki_log_piece){text, text + length}, value);
}

/* Number of a label, a new one if need be; IMKI_LABELS_MAX when there is no room. */
static size_t find_label(imki_log_piece cell, imki_log_label *labels, size_t *label_count)
{
    imki_log_label text = "";
    const size_t length = (size_t)(cell.end - cell.begin);
    memcpy(text, cell.begin, length < sizeof text ? length : sizeof text - 1);
    for (size_t i = *label_count; i-- > 0;)
        if (strcmp(labels[i], text) == 0)
            return i;
    if (*label_count == IMKI_LABELS_MAX)
        return IMKI_LABELS_MAX;
    memcpy(labels[*label_count], text, sizeof text);
    return (*label_count)++;
}

static imk_status refuse(imk_error *error, imk_status status, const char *field,
                         imki_log_piece found, const char *expected, size_t line, size_t column)
{
    char text[48];
    const int length = (int)(found.end - found.begin < 40 ? found.end - found.begin : 40);
    snprintf(text, sizeof text, "%.*s", length, found.begin);
    imk_error_set(error, status, field, text, expected);
    if (error) {
        error->line = line;
        error->column = column;
    }
    return status;
}

static imk_status refuse_count(imk_error *error, size_t count, size_t due, size_t line)
{
    char found[96], expected[96];
    snprintf(found, sizeof found, "the row has %zu cell%s", count, count == 1 ? "" : "s");
    snprintf(expected, sizeof expected, "%zu, as in the first line", due);
    imk_error_set(error, IMK_ERROR_COLUMN, "", found, expected);
    if (error)
        error->line = line;
    return IMK_ERROR_COLUMN;
}

/* The number of a cell; NaN where there is none. @param rest  of a time in two columns */
static bool read_value(const imki_log_layout_read *layout, int column, imki_log_piece cell,
                       imki_log_piece rest, double *value)
{
    *value = (double)NAN;
    if (column == layout->time_column && layout->stamps.rest_ticks > 0)
        return imki_log_stamp_join(&layout->stamps, cell.begin, cell.end, rest.begin, rest.end,
                                   value) ||
               imki_log_piece_is_missing(cell) || imki_log_piece_is_missing(rest);
    if (column == layout->time_column && layout->stamps.exact)
        return imki_log_stamp_read(&layout->stamps, cell.begin, cell.end, value) ||
               imki_log_piece_is_missing(cell) || is_number(layout, cell, value);
    return is_number(layout, cell, value) || imki_log_piece_is_missing(cell);
}

imk_status imki_log_row_read(imki_log_layout_read *layout, imki_log_piece line, size_t line_number,
                             imki_log_label *labels, size_t *label_count, double *values,
                             bool *not_finite, imk_error *error)
{
    imki_log_piece cells[IMK_LOG_COLUMNS_MAX + 1];
    const size_t due = layout->cell_count;
    const size_t count =
        imki_log_split(line.begin, line.end, layout->separator, IMK_LOG_COLUMNS_MAX + 1, cells);
    /* A separator behind the last cell ends it. */
    if (count != due && !(count == due + 1 && cells[due].begin == cells[due].end))
        return refuse_count(error, count, due, line_number);
    *not_finite = false;
    for (size_t i = 0; i < due; i++) {
        const int index = layout->cell_column[i];
        if (index < 0)
            continue;
        const imk_log_column *column = &layout->column[index];
        const size_t place = (size_t)(cells[i].begin - line.begin) + 1;
        double value;
        if (column->label) {
            const size_t label = find_label(cells[i], labels, label_count);
            if (label == IMKI_LABELS_MAX)
                return refuse(error, IMK_ERROR_UNSUPPORTED, column->name, cells[i],
                              "at most 4096 different labels; leave this column out, with --map or "
                              "with - in its place "
                              "in --columns",
                              line_number, place);
            values[index] = (double)label;
            continue;
        }
        if (!read_value(layout, index, cells[i], cells[layout->rest_cell], &value))
            return refuse(error, IMK_ERROR_SYNTAX, column->name, cells[i],
                          layout->stamps.rest_ticks > 0 && index == layout->time_column
                              ? "whole seconds, and less than a second in the column of the rest"
                          : layout->decimal_comma
                              ? "a number with a decimal comma, as in the others"
                              : "a number with a decimal point",
                          line_number, place);
        *not_finite |= !isfinite(value);
        values[index] = value * layout->cell_factor[i];
    }
    return IMK_OK;
}
