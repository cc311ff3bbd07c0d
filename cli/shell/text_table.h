/* SPDX-License-Identifier: Apache-2.0 */
/* Tables of text aligned by characters (not bytes), and numbers as a person reads them. */
#ifndef IMUKIT_TEXT_TABLE_H
#define IMUKIT_TEXT_TABLE_H

#include <stddef.h>
#include <stdio.h>

enum { CELL_SIZE = 120 };

typedef struct text_table {
    size_t rows, columns, capacity;
    char (*cell)[CELL_SIZE];
    unsigned right; /* bit c: column c is aligned to the right */
} text_table;

text_table text_table_make(size_t columns);
/* Start a row; its cells are empty. */
void text_table_row(text_table *table);
/* Set a cell of the last row. */
void text_table_set(text_table *table, size_t column, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
const char *text_table_get(const text_table *table, size_t row, size_t column);
/* Print it, the first row in bold on a terminal. */
void text_table_print(const text_table *table, FILE *out);
void text_table_free(text_table *table);

/* A value to as many decimals as two digits of its uncertainty need, or `digits` significant ones
 * when the uncertainty is 0. */
void format_value(double value, double uncertainty, int digits, char *text, size_t size);
/* "2 h 46 min 40 s", "12.5 s". */
void format_duration(double seconds, char *text, size_t size);

#endif
