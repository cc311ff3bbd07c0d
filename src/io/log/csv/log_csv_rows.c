/* SPDX-License-Identifier: Apache-2.0 */
/* Rows of a CSV text: plain ones the fast way (log_cells.c), others in their general form
 * (log_row.c). A row that cannot be read is left out and counted, as long as such rows are few. */
#include "log_csv_internal.h"

#include "base/text_internal.h"

#include <stdio.h>
#include <string.h>

/* Rows that cannot be read: more than this many, and more than this share of the rows up to the
 * last one, and the table is something else than its header says. */
static const size_t bad_most = 3, bad_one_in = 100;

static imk_status refuse_many(const imk_log_reader *reader, size_t rows, imk_error *error)
{
    const imki_csv *csv = reader->state;
    char more[160];
    if (!error)
        return csv->damage.status;
    *error = csv->damage;
    snprintf(more, sizeof more,
             "; %zu of the first %zu rows cannot be read: is it the right header?", reader->damaged,
             rows);
    imki_append_text(error->expected, sizeof error->expected, more);
    return error->status;
}

/* A row that cannot be read, with this error. @param rows  of the call, before it */
static imk_status leave_out(imk_log_reader *reader, size_t rows, const imk_error *why,
                            imk_error *error)
{
    imki_csv *csv = reader->state;
    if (reader->damaged == 0)
        csv->damage = *why;
    imki_log_damage(reader, rows);
    reader->damaged_line = csv->damage.line;
    reader->damaged_column = csv->damage.column;
    const size_t all =
        reader->part.before + reader->part.after + reader->rows + rows + reader->damaged;
    return reader->damaged > bad_most && reader->damaged * bad_one_in > all
               ? refuse_many(reader, all, error)
               : IMK_OK;
}

static bool is_line(imki_log_piece line, const char *text)
{
    return text && strlen(text) == (size_t)(line.end - line.begin) &&
           memcmp(text, line.begin, strlen(text)) == 0;
}

/* The header or its units once more, as where files were put together. */
static bool is_header_again(imk_log_reader *reader, imki_log_piece line, size_t rows)
{
    const imki_csv_header *header = &((const imki_csv *)reader->state)->header;
    if (header->is_comment) {
        while (line.begin < line.end && strchr(" \t#%/", *line.begin))
            line.begin++;
    }
    if (is_line(line, header->units))
        return true;
    if ((header->is_row && !header->is_comment) || !is_line(line, header->line))
        return false;
    if (reader->headers++ == 0)
        reader->first_header = reader->rows + rows;
    return true;
}

bool imki_csv_is_whole(const imk_log_reader *reader, imki_log_piece line)
{
    const imki_csv *csv = reader->state;
    imki_log_piece cells[IMK_LOG_COLUMNS_MAX];
    const size_t count =
        imki_log_split(line.begin, line.end, reader->layout.separator, IMK_LOG_COLUMNS_MAX, cells);
    if (count != reader->layout.cell_count || line.begin == line.end)
        return false;
    const imki_log_piece last = cells[count - 1];
    const char end = last.end > last.begin ? last.end[-1] : '.';
    if (line.end[-1] == '"')
        return true;
    if (reader->settings.any_columns)
        return end >= '0' && end <= '9';
    const char *point = memchr(last.begin, '.', (size_t)(last.end - last.begin));
    return csv->look.decimals > 0 && point && last.end - point - 1 == csv->look.decimals;
}

/* One row in its general form, or an idle line. *rows grows by the rows it gave. */
static imk_status read_row(imk_log_reader *reader, double *const *out, size_t *rows,
                           imk_error *error)
{
    imki_log_layout_read *layout = &reader->layout;
    imki_log_piece line;
    bool whole, not_finite = false;
    double values[IMK_LOG_COLUMNS_MAX];
    imk_error why = {.status = IMK_OK};
    const size_t number = reader->text.line;
    if (!imki_log_text_take_line(&reader->text, &line.begin, &line.end, &whole))
        return IMK_OK;
    const bool idle = imki_log_line_is_idle(line.begin, line.end);
    if (is_header_again(reader, line, *rows) || idle)
        return IMK_OK;
    if (!whole && !imki_csv_is_whole(reader, line)) {
        reader->cut_short = true;
        return IMK_OK;
    }
    const imk_status status = imki_log_row_read(layout, line, number, reader->labels,
                                                &reader->label_count, values, &not_finite, &why);
    if (status == IMK_ERROR_SYNTAX || status == IMK_ERROR_COLUMN)
        return leave_out(reader, *rows, &why, error);
    if (status != IMK_OK) {
        if (error)
            *error = why;
        return status;
    }
    for (size_t i = 0; i < layout->cell_count; i++)
        if (layout->cell_column[i] >= 0)
            out[i][*rows] = values[layout->cell_column[i]];
    ++*rows;
    if (not_finite && reader->not_finite++ == 0)
        reader->first_not_finite = reader->rows + *rows;
    return IMK_OK;
}

/* Times of plain rows once more, as whole ticks. */
static void read_stamps(const imk_log_reader *reader, const char *text, size_t rows, double *time)
{
    const imki_log_layout_read *layout = &reader->layout;
    const size_t cell = ((const imki_csv *)reader->state)->time_cell;
    const char *end = reader->text.next;
    for (size_t row = 0; row < rows; row++) {
        const char *newline = memchr(text, '\n', (size_t)(end - text));
        const char *begin = text, *to;
        for (size_t i = 0; i < cell; i++)
            begin = (const char *)memchr(begin, layout->separator, (size_t)(newline - begin)) + 1;
        to = memchr(begin, layout->separator, (size_t)(newline - begin));
        to = to ? to : newline - (newline > begin && newline[-1] == '\r');
        (void)imki_log_stamp_read(&layout->stamps, begin, to, &time[row]);
        text = newline + 1;
    }
}

/* Plain rows. @return how many */
static size_t read_plain(imk_log_reader *reader, size_t max_rows, double *const *out, size_t first)
{
    const imki_log_layout_read *layout = &reader->layout;
    const imki_csv *csv = reader->state;
    imki_log_text *text = &reader->text;
    const imki_log_cells cells = {layout->cell_count, layout->separator, layout->cell_factor};
    double *place[IMK_LOG_COLUMNS_MAX];
    const char *begin = text->next;
    if (layout->decimal_comma || layout->stamps.dates || layout->stamps.rest_ticks > 0)
        return 0;
    for (size_t i = 0; i < cells.cell_count; i++)
        place[i] = out[i] + first;
    const size_t read =
        csv->read_cells(&cells, text->base, &text->next, text->lines_end, place, max_rows);
    if (read > 0 && layout->stamps.exact)
        read_stamps(reader, begin, read, place[csv->time_cell]);
    text->line += read;
    return read;
}

imk_status imki_csv_rows_read(imk_log_reader *reader, size_t max_rows, double *const *out,
                              size_t *rows, imk_error *error)
{
    imki_log_text *text = &reader->text;
    imki_csv *csv = reader->state;
    *rows = 0;
    while (*rows < max_rows) {
        imk_status status = imki_log_text_need_line(text, error);
        if (status != IMK_OK)
            return status;
        if (text->next == text->end)
            return IMK_OK;
        if (csv->slow_left == 0 && text->next < text->lines_end) {
            const size_t read = read_plain(reader, max_rows - *rows, out, *rows);
            *rows += read;
            if (read > 0) {
                csv->slow_run = 0;
                continue;
            }
            /* Where rows are not plain, try less and less often. */
            csv->slow_run = csv->slow_run < 32 ? 2 * csv->slow_run + 1 : 63;
            csv->slow_left = csv->slow_run;
        }
        status = read_row(reader, out, rows, error);
        if (status != IMK_OK)
            return status;
        csv->slow_left -= csv->slow_left > 0;
    }
    return IMK_OK;
}
