/* SPDX-License-Identifier: Apache-2.0 */
/* The display of a result for the terminal: the judgement, lines, and tables aligned by characters,
 * not bytes. */
#include "growing_text_internal.h"
#include "result_internal.h"

#include "imukit/utf8.h"

#include <stdlib.h>

enum { SPACE = 2 /* between columns */ };

/* Characters of a UTF-8 text: continuation bytes do not count. */
static size_t characters(const char *text)
{
    size_t count = 0;
    for (; *text; text++)
        count += ((unsigned char)*text & 0xC0) != 0x80;
    return count;
}

static size_t column_width(const imk_table *table, size_t column)
{
    size_t width = 0;
    for (size_t r = 0; r < table->rows; r++) {
        const imki_row *row = &table->row[r];
        const size_t length = column < row->count ? characters(row->cells[column]) : 0;
        width = length > width ? length : width;
    }
    return width;
}

static void put_row(imki_text *out, const imk_table *table, const imki_row *row,
                    const size_t *width)
{
    size_t pending = 0; /* blanks due before the next text: none at the end of a line */
    for (size_t c = 0; c < row->count; c++) {
        const size_t length = characters(row->cells[c]), free_space = width[c] - length;
        const bool right = c < 32 && (table->right >> c & 1) != 0;
        if (length > 0)
            imki_text_add(out, "%*s%s", (int)(pending + (right ? free_space : 0)), "",
                          row->cells[c]);
        pending = (length > 0 ? (right ? 0 : free_space) : pending + width[c]) + SPACE;
    }
}

static imk_status put_table(imki_text *out, const imk_table *table, const char *bold,
                            const char *plain, imki_arena *scratch)
{
    size_t *width = imki_arena_take(scratch, (table->columns + 1) * sizeof *width);
    if (!width)
        return IMK_ERROR_MEMORY;
    for (size_t c = 0; c < table->columns; c++)
        width[c] = column_width(table, c);
    for (size_t r = 0; r < table->rows; r++) {
        imki_text_put(out, r == 0 ? bold : "");
        put_row(out, table, &table->row[r], width);
        imki_text_add(out, "%s\n", r == 0 ? plain : "");
    }
    return IMK_OK;
}

/* Bytes that a terminal could take for a command become "?". */
static void put_line(imki_text *out, const char *text, const char *bold, const char *plain)
{
    while (*text) {
        const size_t length = imk_utf8_length(text);
        if (*text == IMK_BOLD[0] || *text == IMK_PLAIN[0])
            imki_text_put(out, *text == IMK_BOLD[0] ? bold : plain);
        else if (imk_utf8_printable(text) > 0 || *text == '\n' || *text == '\t')
            imki_text_put_bytes(out, text, length);
        else
            imki_text_put_char(out, '?');
        text += length > 0 ? length : 1;
    }
    imki_text_put_char(out, '\n');
}

imk_status imk_result_to_text(const imk_result *result, const char *bold, const char *plain,
                              char **text, size_t *size)
{
    imki_text out = {.bytes = NULL};
    if (!result || result->arena.failed)
        return IMK_ERROR_MEMORY;
    imki_arena scratch = {.allocator = result->arena.allocator};
    imk_status status = IMK_OK;
    plain = bold && plain ? plain : "";
    bold = bold ? bold : "";
    if (result->judgement)
        put_line(&out, result->judgement, bold, plain);
    bool alone = result->judgement != NULL; /* an empty line below it before anything else */
    for (const imki_block *b = result->first; b && status == IMK_OK; b = b->next) {
        if (!(b->audience & IMK_FOR_TERMINAL) || b->kind > IMKI_BLOCK_TABLE)
            continue;
        if (alone && !(b->kind == IMKI_BLOCK_LINE && b->text[0] == '\0'))
            imki_text_put(&out, "\n");
        alone = false;
        if (b->kind == IMKI_BLOCK_TABLE)
            status = put_table(&out, &b->table, bold, plain, &scratch);
        else if (b->kind == IMKI_BLOCK_CODE)
            imki_text_add(&out, "%s\n", b->text);
        else if (b->kind < IMKI_BLOCK_CODE)
            put_line(&out, b->text, bold, plain);
    }
    imki_arena_free(&scratch);
    char *made = imki_text_take(&out, size);
    if (!made || status != IMK_OK) {
        free(made);
        return IMK_ERROR_MEMORY;
    }
    *text = made;
    return IMK_OK;
}
