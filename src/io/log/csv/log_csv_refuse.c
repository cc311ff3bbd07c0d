/* SPDX-License-Identifier: Apache-2.0 */
/* Texts that are refused for what they are and not for what seems to lack: units that are not
 * UTF-8, a header that stands below other lines, dates in other words. */
#include "log_csv_internal.h"

#include "imukit/utf8.h"

#include <stdio.h>
#include <string.h>

enum { LINES_MOST = 64 }; /* looked at for a header below others */

bool imki_csv_is_utf8(imki_log_piece piece)
{
    char text[IMKI_LOG_NAME_SIZE];
    imki_log_piece_copy(text, sizeof text, piece);
    for (const char *c = text; *c;) {
        const size_t length = imk_utf8_length(c);
        if (length == 0)
            return false;
        c += length;
    }
    return true;
}

imk_status imki_csv_encoding_check(const imki_csv_header *header, imk_error *error)
{
    for (size_t i = 0; i < header->count; i++) {
        imki_log_piece name = header->cell[i], unit;
        imki_log_unit_split(&name, &unit);
        imk_unit readable;
        if (imki_csv_is_utf8(unit) ||
            imk_unit_parse(unit.begin, unit.end, &readable, NULL) == IMK_OK)
            continue;
        return imk_error_set(error, IMK_ERROR_FORMAT, "",
                             "the text is not UTF-8, and a unit is not readable",
                             "convert it: iconv -f LATIN1 -t UTF-8 FILE >NEW.csv (LATIN1, or the "
                             "encoding that it has)");
    }
    return IMK_OK;
}

/* How many cells of a line have known names; 0 where one is a number. */
static size_t count_known(const imki_log_piece *cells, size_t count)
{
    imki_log_cell named[IMK_LOG_COLUMNS_MAX];
    size_t known = 0;
    double value;
    if (count > IMK_LOG_COLUMNS_MAX)
        return 0;
    imki_log_cells_name(cells, count, named);
    for (size_t i = 0; i < count; i++) {
        if (imki_log_piece_is_number(cells[i], &value))
            return 0;
        known += named[i].name.kind != NULL;
    }
    return known;
}

imk_status imki_csv_preamble_check(imk_log_reader *reader, imk_error *error)
{
    const imki_csv_header *header = &((const imki_csv *)reader->state)->header;
    imki_log_text *text = &reader->text;
    imki_log_piece line, cells[IMK_LOG_COLUMNS_MAX];
    const size_t number = text->line;
    size_t below = 0, best = count_known(header->cell, header->count);
    bool whole, found = true;
    text->hold = text->next;
    for (size_t k = 0; k < LINES_MOST && below == 0 && best < 2; k++) {
        if (imki_csv_line(text, &line, &whole, &found, NULL, NULL) != IMK_OK || !found)
            break;
        const char separator = imki_log_find_separator(line.begin, line.end);
        const size_t count =
            imki_log_split(line.begin, line.end, separator, IMK_LOG_COLUMNS_MAX, cells);
        if (count_known(cells, count) >= 2)
            below = text->line - 1;
    }
    imki_csv_go_back(text, number);
    text->hold = NULL;
    if (below == 0)
        return IMK_OK;
    char message[128];
    snprintf(message, sizeof message, "the names of the columns are in line %zu, below other lines",
             below);
    imk_error_set(error, IMK_ERROR_COLUMN, "", message,
                  "the header in the first line: delete the lines above it, or begin each with #");
    if (error)
        error->line = header->number;
    return IMK_ERROR_COLUMN;
}

/* "01/05/2024 10:00", "10:00:00.5", "2024-05-01", "1.5.2024", "10:00:00 PM": it begins with a digit
 * and has colons, or two of the signs between the parts of a date. */
static bool is_date_like(const char *cell)
{
    size_t colons = 0, strokes = 0, hyphens = 0, points = 0;
    if (*cell < '0' || *cell > '9')
        return false;
    for (const char *c = cell; *c; c++) {
        const bool exponent = c > cell && (c[-1] == 'e' || c[-1] == 'E');
        colons += *c == ':';
        strokes += *c == '/';
        hyphens += *c == '-' && !exponent;
        points += *c == '.';
    }
    return colons > 0 || strokes == 2 || hyphens == 2 || points == 2;
}

imk_status imki_csv_dates_check(const imki_csv_look *look, const imki_log_layout_read *layout,
                                size_t line, imk_error *error)
{
    for (size_t i = 0; i < layout->cell_count && look->rows > 0 && layout->time_column >= 0; i++) {
        const char *text = look->text[0][i];
        char found[160];
        double value;
        if (layout->cell_column[i] != layout->time_column || look->count[0] <= i ||
            layout->date_cell[i] || !is_date_like(text) ||
            imki_log_piece_is_number((imki_log_piece){text, text + strlen(text)}, &value))
            continue;
        snprintf(found, sizeof found,
                 "\"%.40s\" is a date or time of day that imukit does not read", text);
        imk_error_set(error, IMK_ERROR_SYNTAX, layout->column[layout->time_column].name, found,
                      "write it as 2024-05-01T10:00:00.000 (ISO 8601) or as seconds");
        if (error)
            error->line = line + 1;
        return IMK_ERROR_SYNTAX;
    }
    return IMK_OK;
}
