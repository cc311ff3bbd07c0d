/* SPDX-License-Identifier: Apache-2.0 */
/* The display of a result as a page. */
#include "page_internal.h"
#include "result_internal.h"

#include <stdlib.h>

static void put_table(imki_page *page, const imk_table *table, imki_arena *scratch)
{
    const size_t count = table->rows * table->columns;
    const char **cells = imki_arena_take(scratch, (count + 1) * sizeof *cells);
    for (size_t k = 0; cells && k < count; k++) {
        const imki_row *row = &table->row[k / table->columns];
        const size_t c = k % table->columns;
        cells[k] = c < row->count ? row->cells[c] : "";
    }
    if (cells && count > 0)
        imki_page_table(page, table->rows, table->columns, table->right, cells);
}

static void put_block(imki_page *page, const imki_block *block, imki_arena *scratch)
{
    switch (block->kind) {
    case IMKI_BLOCK_HEADING:
        imki_page_heading(page, block->text);
        break;
    case IMKI_BLOCK_LINE:
        imki_page_text(page, block->text);
        break;
    case IMKI_BLOCK_FINDING:
        imki_page_verdict(page, block->level, block->text);
        break;
    case IMKI_BLOCK_CODE:
        imki_page_code(page, block->text);
        break;
    case IMKI_BLOCK_BREAK:
        imki_page_break(page);
        break;
    case IMKI_BLOCK_TABLE:
        put_table(page, &block->table, scratch);
        break;
    case IMKI_BLOCK_FIGURE:
        imki_page_figure(page, &block->figure.figure, block->text);
        break;
    case IMKI_BLOCK_ANIMATION:
        imki_page_animation(page, &block->animation, block->text);
        break;
    case IMKI_BLOCK_DRAWING:
        imki_page_drawing(page, block->drawing, block->text);
        break;
    }
}

static imk_status render(const imk_result *result, bool whole, char **text, size_t *size,
                         imk_error *error)
{
    if (!result || result->arena.failed)
        return imk_error_set(error, IMK_ERROR_MEMORY, "page", NULL, NULL);
    imki_arena scratch = {.allocator = result->arena.allocator};
    imki_page *page = imki_page_create(result->title, result->subtitle, whole);
    if (result->judgement)
        imki_page_judgement(page, (int)result->usability, result->judgement);
    for (const imki_block *b = result->first; b; b = b->next)
        if (b->audience & IMK_FOR_PAGE)
            put_block(page, b, &scratch);
    imki_arena_free(&scratch);
    char *made;
    size_t made_size;
    const imk_status status = imki_page_take(page, &made, &made_size, error);
    if (status != IMK_OK)
        return status;
    if (scratch.failed) {
        free(made);
        return imk_error_set(error, IMK_ERROR_MEMORY, "page", NULL, NULL);
    }
    *text = made;
    *size = made_size;
    return IMK_OK;
}

imk_status imk_result_to_page(const imk_result *result, char **text, size_t *size, imk_error *error)
{
    return render(result, true, text, size, error);
}

imk_status imk_result_to_fragment(const imk_result *result, char **text, size_t *size,
                                  imk_error *error)
{
    return render(result, false, text, size, error);
}
