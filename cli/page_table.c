/* SPDX-License-Identifier: Apache-2.0 */
/* Hands the cells of a text table to the page. */
#include "page_table.h"

#include <stdlib.h>

void page_put_table(imk_page *page, const text_table *table)
{
    if (table->rows == 0)
        return;
    const char **cells = malloc(table->rows * table->columns * sizeof *cells);
    if (!cells)
        return;
    for (size_t r = 0; r < table->rows; r++)
        for (size_t c = 0; c < table->columns; c++)
            cells[r * table->columns + c] = text_table_get(table, r, c);
    imk_page_table(page, table->rows, table->columns, cells);
    free(cells);
}
