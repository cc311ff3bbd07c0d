/* SPDX-License-Identifier: Apache-2.0 */
/* A look at the first rows of a CSV text: decimal commas, dates, what the times and readings say of
 * a unit that is missing. */
#include "log_csv_internal.h"

#include "base/text_internal.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Digits behind the point of a number, 0 for none. */
static int decimals_of(imki_log_piece cell)
{
    const char *point = memchr(cell.begin, '.', (size_t)(cell.end - cell.begin));
    return point ? (int)(cell.end - point - 1) : 0;
}

void imki_csv_look_at(imk_log_reader *reader, imki_csv_look *look)
{
    imki_log_text *text = &reader->text;
    const size_t number = text->line;
    int decimals = -1;
    text->hold = text->next;
    *look = (imki_csv_look){.decimals = -1};
    while (look->rows < IMKI_CSV_LOOK) {
        imki_log_piece line, cells[IMK_LOG_COLUMNS_MAX];
        bool whole, found;
        if (imki_csv_line(text, &line, &whole, &found, NULL, NULL) != IMK_OK || !found || !whole)
            break;
        const size_t row = look->rows++;
        size_t count = imki_log_split(line.begin, line.end, reader->layout.separator,
                                      IMK_LOG_COLUMNS_MAX, cells);
        look->count[row] = count;
        count = count < IMK_LOG_COLUMNS_MAX ? count : IMK_LOG_COLUMNS_MAX;
        for (size_t i = 0; i < count; i++)
            imki_log_piece_copy(look->text[row][i], sizeof look->text[row][i], cells[i]);
        const int last = decimals_of(cells[count - 1]);
        decimals = row == 0 ? last : decimals == last ? last : -1;
    }
    look->decimals = look->rows > 1 ? decimals : -1;
    imki_csv_go_back(text, number);
    text->hold = NULL;
}

static bool is_digit(char c)
{
    return c >= '0' && c <= '9';
}

/* Digits, a comma, digits. */
static bool has_comma(const char *cell)
{
    const char *comma = strchr(cell, ',');
    const char *digits = cell + (*cell == '-' || *cell == '+');
    return comma && comma > digits && strspn(digits, "0123456789") == (size_t)(comma - digits) &&
           is_digit(comma[1]) && comma[1 + strspn(comma + 1, "0123456789eE+-")] == '\0';
}

bool imki_csv_has_decimal_commas(const imki_csv_look *look, size_t count)
{
    bool any = false;
    for (size_t row = 0; row < look->rows; row++)
        for (size_t i = 0; i < count && i < look->count[row]; i++) {
            const char *cell = look->text[row][i];
            double value;
            any = any || has_comma(cell);
            /* A point in a number: commas are something else. */
            if (strchr(cell, '.') &&
                imki_log_piece_is_number((imki_log_piece){cell, cell + strlen(cell)}, &value))
                return false;
        }
    return any;
}

/* Only whole numbers where a unit is missing, and one beyond 9: most likely counts. */
static bool look_like_counts(const imki_csv_look *look, const imki_log_layout_read *layout)
{
    bool any = false;
    for (size_t row = 0; row < look->rows; row++)
        for (size_t i = 0; i < layout->cell_count && look->count[row] == layout->cell_count; i++) {
            const char *cell = look->text[row][i];
            const size_t sign = *cell == '-' || *cell == '+';
            const size_t digits = strspn(cell + sign, "0123456789");
            const int column = layout->cell_column[i];
            if (!layout->missing.cell[i] || column < 0 || layout->column[column].axis < 0)
                continue;
            if (digits == 0 || cell[sign + digits] != '\0')
                return false;
            any = any || digits > 1;
        }
    return any;
}

/* Times that may be samples' of a sensor, and longest time that a clock without epoch runs. */
static const double step_least = 5e-5, step_most = 100, uptime_most = 60 * 86400.0;
/* 2000 and 2100 [s] since 1970 */
static const double epoch_first = 946684800, epoch_last = 4102444800;

/* The unit by which times count from 1970 and step as a sensor's do, if by no other one they are a
 * clock that runs since days. */
static void find_time_unit(double first, double step, imki_log_hints *hints)
{
    static const struct {
        const char *unit, *words;
        double scale;
    } units[] = {{"s", "seconds", 1},
                 {"ms", "milliseconds", 1e-3},
                 {"us", "microseconds", 1e-6},
                 {"ns", "nanoseconds", 1e-9}};
    const size_t count = sizeof units / sizeof units[0];
    size_t fits = count, others = 0;
    for (size_t k = 0; k < count; k++) {
        const double time = first * units[k].scale, by = step * units[k].scale;
        if (!(by >= step_least && by <= step_most))
            continue;
        if (time >= epoch_first && time <= epoch_last)
            fits = k;
        else
            others += time < uptime_most;
    }
    if (fits == count || others > 0)
        return;
    hints->time_unit = units[fits].unit;
    hints->time_words = units[fits].words;
}

/* What the times in a cell of the rows look like. */
static void look_at_times(const imki_csv_look *look, size_t cell, imki_log_hints *hints)
{
    double first = (double)NAN, last = (double)NAN;
    if (look->rows < 2)
        return;
    const size_t row = look->rows - 1;
    const char *a = look->text[0][cell], *b = look->text[row][cell];
    if (!imki_log_piece_is_number((imki_log_piece){a, a + strlen(a)}, &first) ||
        !imki_log_piece_is_number((imki_log_piece){b, b + strlen(b)}, &last))
        return;
    find_time_unit(first, (last - first) / (double)row, hints);
    snprintf(hints->time, sizeof hints->time, "%.31s", a);
}

/* Has a name one of the words for a time, anywhere in it? */
static bool names_time(const char *name)
{
    static const char *const words[] = {"time", "stamp", "sec", "clock"};
    for (const char *at = name; *at; at++)
        for (size_t k = 0; k < sizeof words / sizeof words[0]; k++) {
            size_t same = 0;
            while (words[k][same] && imki_lower(at[same]) == words[k][same])
                same++;
            if (!words[k][same])
                return true;
        }
    return false;
}

/* Do the numbers of a cell increase from row to row? */
static bool increases(const imki_csv_look *look, size_t cell)
{
    double last = -INFINITY, value;
    for (size_t row = 0; row < look->rows; row++, last = value) {
        const char *text = look->text[row][cell];
        if (look->count[row] <= cell ||
            !imki_log_piece_is_number((imki_log_piece){text, text + strlen(text)}, &value) ||
            !(value > last))
            return false;
    }
    return look->rows > 1;
}

static int find_time_like(const imki_csv_look *look, const imki_log_layout_read *layout)
{
    for (size_t i = 0; i < layout->cell_count; i++) {
        const int column = layout->cell_column[i];
        if (column >= 0 && layout->column[column].quantity == IMK_QUANTITY_OTHER &&
            names_time(layout->column[column].name) && increases(look, i))
            return column;
    }
    return -1;
}

imki_log_hints imki_csv_hints(const imki_csv_look *look, const imki_log_layout_read *layout)
{
    imki_log_hints hints = {.counts = look_like_counts(look, layout),
                            .time_like = find_time_like(look, layout)};
    for (size_t i = 0; i < layout->cell_count; i++)
        if (layout->cell_column[i] >= 0 && layout->cell_column[i] == layout->time_column &&
            layout->missing.cell[i])
            look_at_times(look, i, &hints);
    return hints;
}

imk_status imki_csv_time_unit_check(const imki_csv_look *look, const imki_log_layout_read *layout,
                                    size_t cell, imk_error *error)
{
    const imk_log_column *column = &layout->column[layout->time_column];
    const char *text = look->text[0][cell];
    imki_log_hints hints = {.time_like = -1};
    double first;
    char found[128], expected[160];
    look_at_times(look, cell, &hints);
    if (!hints.time_unit || layout->date_cell[cell] ||
        !imki_log_piece_is_number((imki_log_piece){text, text + strlen(text)}, &first) ||
        first * column->unit.scale <= epoch_last)
        return IMK_OK;
    const bool option = column->unit_origin == IMK_UNIT_OF_SETTINGS;
    snprintf(found, sizeof found, "times such as %.24s are no %.8s: they can only be %s since 1970",
             hints.time, column->unit.text, hints.time_words);
    snprintf(
        expected, sizeof expected, option ? "%s%s" : "%s%s%s",
        option ? "give --time-unit " : "write the unit ", hints.time_unit,
        " into the header, or leave this column out with --map or --columns and state --rate RATE");
    return imk_error_set(error, IMK_ERROR_CONFLICT, option ? "--time-unit" : column->name, found,
                         expected);
}
