/* SPDX-License-Identifier: Apache-2.0 */
/* What the verbs share of reports: tables of texts, the text of a model, and writing the page. */
#include "page_table.h"

#include "command.h"

#include "imukit/model_file.h"

#include <stdlib.h>

void page_put_table(imk_page *page, const text_table *table)
{
    if (table->rows == 0)
        return;
    const char **cells = command_memory(NULL, table->rows * table->columns * sizeof *cells);
    for (size_t r = 0; r < table->rows; r++)
        for (size_t c = 0; c < table->columns; c++)
            cells[r * table->columns + c] = text_table_get(table, r, c);
    imk_page_table(page, table->rows, table->columns, cells);
    free(cells);
}

int page_write(imk_page *page, const char *path)
{
    imk_error error;
    if (imk_page_write(page, path, &error) != IMK_OK)
        return command_error(&error, NULL);
    return -1;
}

void page_put_model(imk_page *page, const char *title, const imk_model *model)
{
    char *text = NULL, reason[900];
    size_t size;
    imk_error error;
    imk_page_heading(page, title);
    if (command_unless_memory(imk_model_print(model, NULL, &text, &size, &error)) == IMK_OK) {
        imk_page_code(page, text);
    } else {
        imk_error_text(&error, NULL, reason, sizeof reason);
        imk_page_text(page, reason);
    }
    free(text);
}
