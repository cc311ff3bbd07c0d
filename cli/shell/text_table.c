/* SPDX-License-Identifier: Apache-2.0 */
/* Aligned tables and readable numbers. */
#include "text_table.h"

#include "command.h"

#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

text_table text_table_make(size_t columns)
{
    return (text_table){.columns = columns};
}

void text_table_row(text_table *table)
{
    if (table->rows == table->capacity) {
        size_t capacity = table->capacity ? 2 * table->capacity : 32;
        table->cell = command_memory(table->cell, capacity * table->columns * CELL_SIZE);
        table->capacity = capacity;
    }
    for (size_t c = 0; c < table->columns; c++)
        table->cell[table->rows * table->columns + c][0] = '\0';
    table->rows++;
}

void text_table_set(text_table *table, size_t column, const char *format, ...)
{
    va_list arguments;
    char *cell = table->cell[(table->rows - 1) * table->columns + column];
    va_start(arguments, format);
    vsnprintf(cell, CELL_SIZE, format, arguments);
    va_end(arguments);
    command_clean(cell);
}

const char *text_table_get(const text_table *table, size_t row, size_t column)
{
    return table->cell[row * table->columns + column];
}

/* Characters of a UTF-8 text: continuation bytes do not count. */
static size_t characters(const char *text)
{
    size_t count = 0;
    for (; *text; text++)
        count += ((unsigned char)*text & 0xC0) != 0x80;
    return count;
}

void text_table_print(const text_table *table, FILE *out)
{
    size_t width[32] = {0};
    for (size_t r = 0; r < table->rows; r++) {
        for (size_t c = 0; c < table->columns && c < 32; c++) {
            size_t length = characters(text_table_get(table, r, c));
            width[c] = length > width[c] ? length : width[c];
        }
    }
    for (size_t r = 0; r < table->rows; r++) {
        fputs(r == 0 ? command_color(out, COLOR_BOLD) : "", out);
        size_t pending = 0; /* blanks due before the next text: none at the end of a line */
        for (size_t c = 0; c < table->columns && c < 32; c++) {
            const char *text = text_table_get(table, r, c);
            size_t length = characters(text), free_space = width[c] - length;
            bool right = (table->right >> c & 1) != 0;
            if (length > 0)
                fprintf(out, "%*s%s", (int)(pending + (right ? free_space : 0)), "", text);
            pending = (length > 0 ? (right ? 0 : free_space) : pending + width[c]) + 2;
        }
        fprintf(out, "%s\n", r == 0 ? command_color(out, COLOR_RESET) : "");
    }
}

void text_table_free(text_table *table)
{
    free(table->cell);
    table->cell = NULL;
}

void format_value(double value, double uncertainty, int digits, char *text, size_t size)
{
    double magnitude = fabs(value);
    if (!isfinite(value)) {
        snprintf(text, size, "%s", isnan(value) ? "-" : value > 0 ? "inf" : "-inf");
        return;
    }
    int decimals;
    if (uncertainty > 0 && isfinite(uncertainty) && uncertainty < 1e6)
        decimals = 1 - (int)floor(log10(uncertainty));
    else
        decimals = magnitude > 0 ? digits - 1 - (int)floor(log10(magnitude)) : 0;
    decimals = decimals < 0 ? 0 : decimals;
    if (decimals > 9 || magnitude >= 1e7)
        snprintf(text, size, "%.*g", digits, value);
    else
        snprintf(text, size, "%.*f", decimals, value);
    /* What rounds to nothing has no sign. */
    if (text[0] == '-' && strspn(text + 1, "0.") == strlen(text + 1))
        memmove(text, text + 1, strlen(text));
}

void format_duration(double seconds, char *text, size_t size)
{
    if (!(seconds >= 60) || seconds > 1e9) {
        snprintf(text, size, "%.3g s", seconds);
        return;
    }
    unsigned long whole = (unsigned long)llround(seconds);
    unsigned long days = whole / 86400, hours = whole / 3600 % 24, minutes = whole / 60 % 60;
    size_t used = 0;
    const struct {
        unsigned long count;
        const char *unit;
    } part[] = {{days, "d"}, {hours, "h"}, {minutes, "min"}, {whole % 60, "s"}};
    text[0] = '\0';
    for (int i = 0; i < 4 && used < size; i++)
        if (part[i].count > 0)
            used += (size_t)snprintf(text + used, size - used, "%s%lu %s", used ? " " : "",
                                     part[i].count, part[i].unit);
}
