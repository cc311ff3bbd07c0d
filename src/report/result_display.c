/* SPDX-License-Identifier: Apache-2.0 */
/* The display of a result: headings, lines, tables and figures in the order they are added. */
#include "result_internal.h"

#include "imukit/utf8.h"

#include <stdarg.h>
#include <string.h>

void imk_result_for(imk_result *result, imk_audience audience)
{
    if (result)
        result->audience = audience;
}

static imki_block *add(imk_result *result, imki_block_kind kind, const char *text)
{
    imki_block *made = result ? imki_arena_take(&result->arena, sizeof *made) : NULL;
    if (!made)
        return NULL;
    made->kind = kind;
    made->audience = result->audience;
    made->text = imki_arena_text(&result->arena, text ? text : "");
    if (result->last)
        result->last->next = made;
    else
        result->first = made;
    result->last = made;
    return made;
}

void imk_result_title(imk_result *result, const char *title, const char *format, ...)
{
    if (!result)
        return;
    va_list arguments;
    result->title = imki_arena_text(&result->arena, title);
    va_start(arguments, format);
    result->subtitle = imki_arena_format(&result->arena, format, arguments);
    va_end(arguments);
}

void imk_result_heading(imk_result *result, const char *text)
{
    (void)add(result, IMKI_BLOCK_HEADING, text);
}

void imk_result_line(imk_result *result, const char *format, ...)
{
    if (!result)
        return;
    va_list arguments;
    va_start(arguments, format);
    const char *text = imki_arena_format(&result->arena, format, arguments);
    va_end(arguments);
    (void)add(result, IMKI_BLOCK_LINE, text);
}

void imk_result_gap(imk_result *result)
{
    imki_block *made = add(result, IMKI_BLOCK_LINE, "");
    if (made)
        made->audience &= IMK_FOR_TERMINAL;
}

void imk_result_finding(imk_result *result, int level, const char *text)
{
    imki_block *made = add(result, IMKI_BLOCK_FINDING, text);
    if (made)
        made->level = level;
}

void imk_result_code(imk_result *result, const char *text)
{
    (void)add(result, IMKI_BLOCK_CODE, text);
}

void imk_result_break(imk_result *result)
{
    (void)add(result, IMKI_BLOCK_BREAK, NULL);
}

void imk_result_animation(imk_result *result, const imk_animation *animation, const char *caption)
{
    imki_block *made = add(result, IMKI_BLOCK_ANIMATION, caption);
    if (!made)
        return;
    imki_arena *arena = &result->arena;
    made->animation = *animation;
    made->animation.title = imki_arena_text(arena, animation->title);
    made->animation.x_label = imki_arena_text(arena, animation->x_label);
    made->animation.y_label = imki_arena_text(arena, animation->y_label);
    made->animation.clock = imki_arena_text(arena, animation->clock);
    made->animation.x = imki_arena_numbers(arena, animation->x, animation->count, 1);
    made->animation.y = imki_arena_numbers(arena, animation->y, animation->count, 1);
    if (animation->law_count > 0) {
        made->animation.law_x =
            imki_arena_numbers(arena, animation->law_x, animation->law_count, 1);
        made->animation.law_y =
            imki_arena_numbers(arena, animation->law_y, animation->law_count, 1);
    }
}

void imk_result_drawing(imk_result *result, const char *svg, const char *caption)
{
    imki_block *made = add(result, IMKI_BLOCK_DRAWING, caption);
    if (!made)
        return;
    made->drawing = imki_arena_text(&result->arena, svg);
    result->arena.failed = result->arena.failed || !svg;
}

/* -------------------------------------------------------------------------------------- tables */

imk_table *imk_result_table(imk_result *result, unsigned right)
{
    imki_block *made = add(result, IMKI_BLOCK_TABLE, NULL);
    if (!made)
        return NULL;
    made->table = (imk_table){.arena = &result->arena, .right = right};
    return &made->table;
}

/* The unit separator of ASCII, which no text of a user contains. */
enum { CELL_END = 0x1f };

/* A cell of `length` bytes; bytes that a terminal could take for a command become "?". */
static const char *clean_cell(imki_arena *arena, const char *text, size_t length)
{
    char *cell = imki_arena_take(arena, length + 1), *end = cell;
    for (const char *stop = text + length; cell && text < stop;) {
        const size_t printable = imk_utf8_printable(text), bytes = imk_utf8_length(text);
        if (printable > 0 || *text == '\n') {
            memcpy(end, text, bytes);
            end += bytes;
        } else {
            *end++ = '?';
        }
        text += bytes > 0 ? bytes : 1;
    }
    return cell ? cell : "";
}

/* The cells of a format: its tabs are distinguished from tabs in the arguments. */
static void add_cells(imk_table *table, const char *format, va_list arguments)
{
    imki_row *row = &table->row[table->rows - 1];
    char *pattern = imki_arena_text(table->arena, format);
    for (char *c = pattern; c && *c; c++)
        *c = *c == '\t' ? CELL_END : *c;
    const char *text = pattern ? imki_arena_format(table->arena, pattern, arguments) : "";
    for (;;) {
        const size_t length = strcspn(text, (const char[]){CELL_END, '\0'});
        row->cells = imki_arena_extend(table->arena, row->cells, row->count, sizeof *row->cells);
        if (!row->cells) {
            row->count = 0;
            return;
        }
        row->cells[row->count++] = clean_cell(table->arena, text, length);
        if (!text[length])
            break;
        text += length + 1;
    }
    table->columns = row->count > table->columns ? row->count : table->columns;
}

void imk_table_row(imk_table *table, const char *format, ...)
{
    if (!table)
        return;
    table->row = imki_arena_extend(table->arena, table->row, table->rows, sizeof *table->row);
    if (!table->row) {
        table->rows = 0;
        return;
    }
    va_list arguments;
    table->row[table->rows++] = (imki_row){0};
    va_start(arguments, format);
    add_cells(table, format, arguments);
    va_end(arguments);
}

void imk_table_add(imk_table *table, const char *format, ...)
{
    if (!table || table->rows == 0)
        return;
    va_list arguments;
    va_start(arguments, format);
    add_cells(table, format, arguments);
    va_end(arguments);
}

size_t imk_table_rows(const imk_table *table)
{
    return table ? table->rows : 0;
}

/* ------------------------------------------------------------------------------------- figures */

imk_figure_builder *imk_result_figure(imk_result *result, const char *title, size_t columns,
                                      const char *caption)
{
    imki_block *made = add(result, IMKI_BLOCK_FIGURE, caption);
    if (!made)
        return NULL;
    made->figure.arena = &result->arena;
    made->figure.figure.title = imki_arena_text(&result->arena, title);
    made->figure.figure.columns = columns;
    return &made->figure;
}

void imk_figure_panel(imk_figure_builder *figure, const imk_panel *panel)
{
    if (!figure)
        return;
    imki_arena *arena = figure->arena;
    figure->panels = imki_arena_extend(arena, figure->panels, figure->figure.panel_count,
                                       sizeof *figure->panels);
    figure->figure.panels = figure->panels;
    if (!figure->panels) {
        figure->figure.panel_count = 0;
        return;
    }
    imk_panel *made = &figure->panels[figure->figure.panel_count++];
    *made = *panel;
    made->title = imki_arena_text(arena, panel->title);
    made->x_label = imki_arena_text(arena, panel->x_label);
    made->y_label = imki_arena_text(arena, panel->y_label);
    made->note = panel->note ? imki_arena_text(arena, panel->note) : NULL;
    made->curve_count = made->region_count = 0;
    made->curves = NULL;
    made->regions = NULL;
}

static imk_panel *last_panel(imk_figure_builder *figure)
{
    return figure && figure->figure.panel_count > 0
               ? &figure->panels[figure->figure.panel_count - 1]
               : NULL;
}

void imk_figure_curve(imk_figure_builder *figure, const imk_curve *curve, double scale)
{
    imk_panel *panel = last_panel(figure);
    if (!panel)
        return;
    imki_arena *arena = figure->arena;
    imk_curve *curves =
        imki_arena_extend(arena, (void *)panel->curves, panel->curve_count, sizeof *curves);
    panel->curves = curves;
    if (!curves) {
        panel->curve_count = 0;
        return;
    }
    imk_curve *made = &curves[panel->curve_count++];
    *made = *curve;
    made->label = imki_arena_text(arena, curve->label);
    made->x = imki_arena_numbers(arena, curve->x, curve->count, 1);
    made->y = imki_arena_numbers(arena, curve->y, curve->count, scale);
    made->lower = imki_arena_numbers(arena, curve->lower, curve->count, scale);
    made->upper = imki_arena_numbers(arena, curve->upper, curve->count, scale);
}

static double *extended(imki_arena *arena, const double *values, size_t count, double value)
{
    double *made = imki_arena_extend(arena, (void *)values, count, sizeof *made);
    if (made)
        made[count] = value;
    return made;
}

/* The last curve; NULL where there is none. */
static imk_curve *last_curve(imk_figure_builder *figure)
{
    const imk_panel *panel = last_panel(figure);
    return panel && panel->curve_count > 0 ? (imk_curve *)panel->curves + panel->curve_count - 1
                                           : NULL;
}

void imk_figure_point(imk_figure_builder *figure, double x, double y)
{
    imk_curve *curve = last_curve(figure);
    if (!curve)
        return;
    curve->x = extended(figure->arena, curve->x, curve->count, x);
    curve->y = extended(figure->arena, curve->y, curve->count, y);
    curve->count = curve->x && curve->y ? curve->count + 1 : 0;
}

void imk_figure_bar(imk_figure_builder *figure, double x, double y, double lower, double upper)
{
    imk_curve *curve = last_curve(figure);
    if (!curve)
        return;
    curve->lower = extended(figure->arena, curve->lower, curve->count, lower);
    curve->upper = extended(figure->arena, curve->upper, curve->count, upper);
    imk_figure_point(figure, x, y);
    curve->count = curve->lower && curve->upper ? curve->count : 0;
}

void imk_figure_region(imk_figure_builder *figure, const imk_region *region)
{
    imk_panel *panel = last_panel(figure);
    if (!panel)
        return;
    imk_region *regions = imki_arena_extend(figure->arena, (void *)panel->regions,
                                            panel->region_count, sizeof *regions);
    panel->regions = regions;
    if (!regions) {
        panel->region_count = 0;
        return;
    }
    regions[panel->region_count] = *region;
    regions[panel->region_count++].label = imki_arena_text(figure->arena, region->label);
}

const imk_figure *imk_result_figure_get(const imk_result *result, imk_audience audience,
                                        size_t index)
{
    for (const imki_block *b = result ? result->first : NULL; b; b = b->next)
        if (b->kind == IMKI_BLOCK_FIGURE && (b->audience & audience) == audience && index-- == 0)
            return &b->figure.figure;
    return NULL;
}
