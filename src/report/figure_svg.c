/* SPDX-License-Identifier: Apache-2.0 */
/* A figure as SVG. Needs memory and arithmetic only: no file, no process, no font.
 *
 * The drawing is in whole tenths of a pixel, so that it contains no decimal point and does not
 * depend on the locale. The frames of a column of panels have the same left edge, those of a row
 * the same lower one. The order in a panel: grid, regions, curves as they come, axes, names. */
#include "figure_internal.h"
#include "markup_internal.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* [px] */
enum {
    TITLE_SIZE = 12,
    LABEL_SIZE = 12,
    NOTE_SIZE = 10,
    NOTE_ROW = 14,
    PANEL_TOP = 34, /* above a frame, with its title */
    SINGLE_TOP = 44,
    RIGHT = 22,
    TICK_GAP = 7, /* between an axis and its labels */
    TICK_LENGTH = 4,
    KEY_GAP = 10
};

/* Room for a label and the space to the next one, in sizes of the font. */
static const double x_label_room = 4.6, y_label_room = 3.3;

/* Names cover the drawing behind them with a thin white margin. */
static const char on_paper[] = "<g paint-order=\"stroke\" stroke=\"#fff\" stroke-width=\"25\" "
                               "stroke-opacity=\"0.8\" stroke-linejoin=\"round\">\n";

enum { CORNERS = 4 };

/* Where the parts of a panel are. */
typedef struct layout {
    imki_box cell;
    imki_frame frame;
    imki_key key;
    imk_key_place place; /* of the key */
    double key_left, key_top;
    double below, left; /* what a frame leaves free */
    size_t touches[CORNERS];
} layout;

typedef struct sheet {
    const imk_figure *figure;
    imki_figure_size size;
    bool single;
    double tick_size;
    layout *layout; /* of each panel */
} sheet;

static double width_of(const imki_tick *tick, double font_size)
{
    return imki_line_width(tick->text, font_size) + imki_line_width(tick->power, 0.75 * font_size);
}

/* The lines of a panel's note. */
static size_t note_lines(const imk_panel *panel)
{
    size_t count = panel->note && panel->note[0] ? 1 : 0;
    for (const char *c = count > 0 ? strchr(panel->note, '\n') : NULL; c; c = strchr(c + 1, '\n'))
        count++;
    return count;
}

/* ---- layout ---------------------------------------------------------------------------------- */

static bool is_beside(const sheet *s, const layout *l)
{
    return s->single && l->place == IMK_KEY_UPPER;
}

static bool is_inside(const sheet *s, const layout *l)
{
    return l->place != IMK_KEY_BELOW && !is_beside(s, l) && l->key.entries > 0;
}

/* The key, and everything below the frame. */
static void lay_out_key(const sheet *s, const imk_panel *panel, layout *l)
{
    const double width = l->cell.right - l->cell.left, height = l->cell.bottom - l->cell.top;
    const double font_size = s->single ? LABEL_SIZE : s->tick_size;
    l->below = TICK_GAP + s->tick_size + 12;
    if (panel->x_label && panel->x_label[0])
        l->below += LABEL_SIZE + 6;
    l->below += NOTE_ROW * (double)note_lines(panel);
    if (is_beside(s, l))
        l->key = imki_key_make(panel, font_size, 0.4 * width, 0.8 * height, 1);
    else if (l->place == IMK_KEY_BELOW)
        l->key = imki_key_make(panel, font_size, width - 60, 0.4 * height, 6);
    else
        l->key = imki_key_make(panel, font_size, 0.6 * width, 0.5 * height, 1);
    if (l->place == IMK_KEY_BELOW && l->key.entries > 0)
        l->below += KEY_GAP + l->key.height;
}

/* The frame without its left side, which depends on the widest label. */
static void lay_out_frame(const sheet *s, const imk_panel *panel, double below, layout *l)
{
    imki_ticks ticks;
    imki_frame *f = &l->frame;
    imki_panel_axes(panel, &f->x, &f->y);
    f->top = l->cell.top + (s->single ? SINGLE_TOP : PANEL_TOP);
    f->bottom = fmax(l->cell.bottom - below, f->top + 50);
    f->right = l->cell.right - RIGHT;
    if (is_beside(s, l) && l->key.entries > 0)
        f->right -= l->key.width + 4;
    double widest = 0;
    imki_axis_ticks(&f->y, f->bottom - f->top, y_label_room * s->tick_size, &ticks);
    for (size_t i = 0; i < ticks.count; i++)
        widest = fmax(widest, width_of(&ticks.tick[i], s->tick_size));
    l->left = TICK_GAP + widest + 12;
    if (panel->y_label && panel->y_label[0])
        l->left += LABEL_SIZE + 10;
}

/* Corner 0 is the corner that a panel asks for, 1 is on the other side, 2 and 3 are the same at the
 * other end. */
static imki_box corner_box(const layout *l, int corner)
{
    const imki_frame *f = &l->frame;
    const bool at_left = corner % 2 == 1;
    const bool at_bottom = (l->place == IMK_KEY_LOWER) != (corner >= 2);
    const double left = at_left ? f->left + KEY_GAP : f->right - KEY_GAP - l->key.width;
    const double top = at_bottom ? f->bottom - 6 - l->key.height : f->top + 2;
    return (imki_box){left, top, left + l->key.width, top + l->key.height};
}

/* How much the key would hide in each corner. */
static void count_touches(const imk_panel *panel, layout *l)
{
    for (int corner = 0; corner < CORNERS; corner++) {
        l->touches[corner] = 0;
        imki_box box = corner_box(l, corner);
        box = (imki_box){box.left - 4, box.top - 2, box.right + 4, box.bottom + 2};
        for (size_t c = 0; c < panel->curve_count; c++)
            l->touches[corner] += imki_curve_touches(&l->frame, &panel->curves[c], &box);
    }
}

/* The corner where the keys of all panels together hide least; if equal, the corner that is asked
 * for. */
static int common_corner(const sheet *s)
{
    size_t total[CORNERS] = {0};
    int best = 0;
    for (size_t p = 0; p < s->figure->panel_count; p++)
        for (int corner = 0; corner < CORNERS; corner++)
            total[corner] += s->layout[p].touches[corner];
    for (int corner = 1; corner < CORNERS; corner++)
        if (total[corner] < total[best])
            best = corner;
    return best;
}

/* That corner, or one where this key hides much less. */
static void choose_corner(int common, layout *l)
{
    int best = common;
    for (int corner = 0; corner < CORNERS; corner++)
        if (2 * l->touches[corner] < l->touches[best])
            best = corner;
    const imki_box box = corner_box(l, best);
    l->key_left = box.left;
    l->key_top = box.top;
}

static void place_key(const sheet *s, int common, layout *l)
{
    const imki_frame *f = &l->frame;
    if (l->key.entries == 0)
        return;
    if (is_beside(s, l)) {
        l->key_left = f->right + 14;
        l->key_top = f->top;
    } else if (l->place == IMK_KEY_BELOW) {
        const double middle = (f->left + f->right - l->key.width) / 2;
        l->key_left = fmax(l->cell.left + 8, fmin(middle, l->cell.right - 8 - l->key.width));
        l->key_top = l->cell.bottom - 8 - l->key.height;
    } else {
        choose_corner(common, l);
    }
}

static void lay_out_frames(const sheet *s)
{
    const imki_figure_size *z = &s->size;
    const size_t count = s->figure->panel_count;
    const double width = (double)z->width / (double)z->columns;
    const double height = (double)(z->height - z->head) / (double)z->rows;
    for (size_t p = 0; p < count; p++) {
        layout *l = &s->layout[p];
        const double left = (double)(p % z->columns) * width;
        const double top = z->head + (double)(p / z->columns) * height;
        l->cell = (imki_box){left, top, left + width, top + height};
        lay_out_key(s, &s->figure->panels[p], l);
    }
    for (size_t p = 0; p < count; p++) {
        double below = 0;
        for (size_t q = p - p % z->columns; q < count && q / z->columns == p / z->columns; q++)
            below = fmax(below, s->layout[q].below);
        lay_out_frame(s, &s->figure->panels[p], below, &s->layout[p]);
    }
    for (size_t p = 0; p < count; p++) {
        layout *l = &s->layout[p];
        double most = 0;
        for (size_t q = p % z->columns; q < count; q += z->columns)
            most = fmax(most, s->layout[q].left);
        l->frame.left = fmin(l->cell.left + most, l->frame.right - 50);
        if (is_inside(s, l))
            count_touches(&s->figure->panels[p], l);
    }
}

/* A key that would hide something in each corner goes below the axes, with those of its row. */
static bool put_below(const sheet *s, size_t first, size_t end)
{
    bool below = false;
    for (size_t p = first; p < end; p++) {
        bool hides = is_inside(s, &s->layout[p]);
        for (int corner = 0; corner < CORNERS; corner++)
            hides = hides && s->layout[p].touches[corner] > 0;
        below = below || hides;
    }
    for (size_t p = first; p < end && below; p++) {
        s->layout[p].place = IMK_KEY_BELOW;
        memset(s->layout[p].touches, 0, sizeof s->layout[p].touches);
    }
    return below;
}

static void lay_out(const sheet *s)
{
    const size_t count = s->figure->panel_count;
    bool again = false;
    for (size_t p = 0; p < count; p++)
        s->layout[p].place = s->figure->panels[p].key;
    lay_out_frames(s);
    for (size_t p = 0; p < count; p += s->size.columns)
        again = put_below(s, p, p + s->size.columns < count ? p + s->size.columns : count) || again;
    if (again)
        lay_out_frames(s);
    const int common = common_corner(s);
    for (size_t p = 0; p < count; p++)
        place_key(s, common, &s->layout[p]);
}

/* ---- axes ------------------------------------------------------------------------------------ */

static void put_label(imki_text *out, const imki_tick *tick, double x, double y, double font_size)
{
    imki_text_add(out, "<text x=\"%ld\" y=\"%ld\">%s", imki_tenths(x), imki_tenths(y), tick->text);
    if (tick->power[0])
        imki_text_add(out, "<tspan dy=\"-%ld\" font-size=\"%ld\">%s</tspan>",
                      imki_tenths(0.4 * font_size), imki_tenths(0.75 * font_size), tick->power);
    imki_text_put(out, "</text>\n");
}

static double tick_x(const imki_frame *f, const imki_tick *tick)
{
    return f->left + tick->place * (f->right - f->left);
}

static double tick_y(const imki_frame *f, const imki_tick *tick)
{
    return f->bottom - tick->place * (f->bottom - f->top);
}

/* Labels that would run into the one before are left out. */
static void put_x_labels(imki_text *out, const imki_frame *f, const imki_ticks *ticks,
                         double font_size)
{
    double end = -HUGE_VAL;
    imki_text_add(out, "<g font-size=\"%ld\" text-anchor=\"middle\">\n", imki_tenths(font_size));
    for (size_t i = 0; i < ticks->count; i++) {
        const double half = width_of(&ticks->tick[i], font_size) / 2,
                     x = tick_x(f, &ticks->tick[i]);
        if (!ticks->tick[i].labelled || x - half < end + 6)
            continue;
        put_label(out, &ticks->tick[i], x, f->bottom + TICK_GAP + font_size, font_size);
        end = x + half;
    }
    imki_text_put(out, "</g>\n");
}

static void put_y_labels(imki_text *out, const imki_frame *f, const imki_ticks *ticks,
                         double font_size)
{
    double end = HUGE_VAL;
    imki_text_add(out, "<g font-size=\"%ld\" text-anchor=\"end\">\n", imki_tenths(font_size));
    for (size_t i = 0; i < ticks->count; i++) {
        const double y = tick_y(f, &ticks->tick[i]);
        if (!ticks->tick[i].labelled || y > end - 1.2 * font_size)
            continue;
        put_label(out, &ticks->tick[i], f->left - TICK_GAP, y + 0.35 * font_size, font_size);
        end = y;
    }
    imki_text_put(out, "</g>\n");
}

static void put_grid(imki_text *out, const imki_frame *f, const imki_ticks *x, const imki_ticks *y,
                     bool labelled)
{
    imki_text_add(out, "<path stroke=\"%s\" stroke-width=\"%d\" d=\"",
                  labelled ? "#d9d9d9" : "#f0f0f0", labelled ? 8 : 6);
    for (size_t i = 0; i < x->count; i++)
        if (x->tick[i].labelled == labelled)
            imki_text_add(out, "M%ld %ldV%ld", imki_tenths(tick_x(f, &x->tick[i])),
                          imki_tenths(f->top), imki_tenths(f->bottom));
    for (size_t i = 0; i < y->count; i++)
        if (y->tick[i].labelled == labelled)
            imki_text_add(out, "M%ld %ldH%ld", imki_tenths(f->left),
                          imki_tenths(tick_y(f, &y->tick[i])), imki_tenths(f->right));
    imki_text_put(out, "\"/>\n");
}

/* The two axes, with their ticks outside. */
static void put_axes(imki_text *out, const imki_frame *f, const imki_ticks *x, const imki_ticks *y)
{
    imki_text_add(
        out, "<path fill=\"none\" stroke=\"#666\" stroke-width=\"10\" d=\"M%ld %ldV%ldH%ld",
        imki_tenths(f->left), imki_tenths(f->top), imki_tenths(f->bottom), imki_tenths(f->right));
    for (size_t i = 0; i < x->count; i++)
        imki_text_add(out, "M%ld %ldv%d", imki_tenths(tick_x(f, &x->tick[i])),
                      imki_tenths(f->bottom), x->tick[i].labelled ? 10 * TICK_LENGTH : 20);
    for (size_t i = 0; i < y->count; i++)
        imki_text_add(out, "M%ld %ldh-%d", imki_tenths(f->left),
                      imki_tenths(tick_y(f, &y->tick[i])),
                      y->tick[i].labelled ? 10 * TICK_LENGTH : 20);
    imki_text_put(out, "\"/>\n");
}

/* As many labels as have room side by side. */
static void make_x_ticks(const imki_frame *f, double font_size, imki_ticks *ticks)
{
    const double length = f->right - f->left;
    double room = x_label_room * font_size;
    for (int tries = 0; tries < 3; tries++) {
        double widest = 0;
        imki_axis_ticks(&f->x, length, room, ticks);
        for (size_t i = 0; i < ticks->count; i++)
            widest = fmax(widest, width_of(&ticks->tick[i], font_size));
        if (widest + 1.5 * font_size <= room)
            return;
        room = widest + 1.5 * font_size;
    }
}

/* ---- a panel --------------------------------------------------------------------------------- */

/* Each line of the note, below the label of the axis. */
static void put_note(imki_text *out, const imk_panel *panel, const layout *l, double y)
{
    const imki_frame *f = &l->frame;
    const double room = l->cell.right - f->left - 8;
    char line[400];
    for (const char *c = note_lines(panel) > 0 ? panel->note : NULL; c; y += NOTE_ROW) {
        const char *end = strchr(c, '\n');
        snprintf(line, sizeof line, "%.*s", end ? (int)(end - c) : (int)strlen(c), c);
        imki_svg_line(out, f->left, y, IMKI_START, NOTE_SIZE, room, "", line);
        c = end ? end + 1 : NULL;
    }
}

static void put_names(imki_text *out, const imk_panel *panel, const layout *l, double font_size)
{
    const imki_frame *f = &l->frame;
    const double middle = (f->left + f->right) / 2, height = (f->top + f->bottom) / 2;
    const double x = l->cell.left + LABEL_SIZE + 6;
    const double room = 2 * fmin(middle - l->cell.left, l->cell.right - middle) - 8;
    char turned[60];
    imki_svg_line(out, middle, f->top - 12, IMKI_MIDDLE, TITLE_SIZE, room, "", panel->title);
    const double below = f->bottom + TICK_GAP + font_size + 9 + LABEL_SIZE;
    imki_svg_line(out, middle, below, IMKI_MIDDLE, LABEL_SIZE, room, "", panel->x_label);
    put_note(out, panel, l, below + 4 + NOTE_ROW);
    snprintf(turned, sizeof turned, " transform=\"rotate(-90 %ld %ld)\"", imki_tenths(x),
             imki_tenths(height));
    imki_svg_line(out, x, height, IMKI_MIDDLE, LABEL_SIZE, f->bottom - f->top + 30, turned,
                  panel->y_label);
}

static void put_panel(imki_text *out, const sheet *s, size_t number)
{
    const imk_panel *panel = &s->figure->panels[number];
    const layout *l = &s->layout[number];
    const imki_frame *f = &l->frame;
    imki_ticks x, y;
    make_x_ticks(f, s->tick_size, &x);
    imki_axis_ticks(&f->y, f->bottom - f->top, y_label_room * s->tick_size, &y);
    imki_text_add(out,
                  "<clipPath id=\"frame%zu\"><rect x=\"%ld\" y=\"%ld\" width=\"%ld\" "
                  "height=\"%ld\"/></clipPath>\n",
                  number + 1, imki_tenths(f->left), imki_tenths(f->top),
                  imki_tenths(f->right) - imki_tenths(f->left),
                  imki_tenths(f->bottom) - imki_tenths(f->top));
    put_grid(out, f, &x, &y, false);
    put_grid(out, f, &x, &y, true);
    imki_text_add(out, "<g clip-path=\"url(#frame%zu)\">\n", number + 1);
    imki_regions_draw(out, f, panel);
    for (size_t c = 0; c < panel->curve_count; c++)
        imki_curve_draw(out, f, &panel->curves[c]);
    imki_text_put(out, "</g>\n");
    put_axes(out, f, &x, &y);
    put_x_labels(out, f, &x, s->tick_size);
    put_y_labels(out, f, &y, s->tick_size);
    put_names(out, panel, l, s->tick_size);
    imki_text_put(out, on_paper);
    imki_region_labels_draw(out, f, panel);
    imki_text_put(out, "</g>\n");
    imki_key_draw(out, &l->key, panel, l->key_left, l->key_top);
}

/* ---- all of it ------------------------------------------------------------------------------- */

static void put_head(imki_text *out, const imki_figure_size *z, const char *name, const char *more)
{
    imki_text_add(out,
                  "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%d\" height=\"%d\" "
                  "viewBox=\"0 0 %d %d\" role=\"img\" aria-label=\"",
                  z->width, z->height, 10 * z->width, 10 * z->height);
    imki_markup_escape(out, name);
    imki_markup_escape(out, more);
    imki_text_add(out,
                  "\" font-family=\"'DejaVu Sans',Verdana,sans-serif\" fill=\"#333\">\n"
                  "<rect width=\"%d\" height=\"%d\" fill=\"#fff\"/>\n",
                  10 * z->width, 10 * z->height);
}

static void put_panels(imki_text *out, const sheet *s)
{
    lay_out(s);
    for (size_t p = 0; p < s->figure->panel_count; p++)
        put_panel(out, s, p);
    imki_text_put(out, "</svg>\n");
}

imk_status imk_figure_svg(const imk_figure *figure, char **svg, size_t *size, imk_error *error)
{
    const imk_status status = imki_figure_check(figure, error);
    if (status != IMK_OK)
        return status;
    imki_text text = {.bytes = NULL};
    sheet s = {.figure = figure,
               .size = imki_figure_measure(figure),
               .single = figure->panel_count == 1,
               .tick_size = figure->panel_count == 1 ? 12 : 10,
               .layout = calloc(figure->panel_count, sizeof *s.layout)};
    if (s.layout) {
        put_head(&text, &s.size, s.single ? figure->panels[0].title : figure->title, "");
        if (!s.single)
            imki_svg_line(&text, s.size.width / 2.0, 24, IMKI_MIDDLE, TITLE_SIZE + 1,
                          s.size.width - 20.0, "", figure->title);
        put_panels(&text, &s);
    } else {
        text.failed = true;
    }
    free(s.layout);
    char *drawn = imki_text_take(&text, size);
    if (!drawn)
        return imk_error_set(error, IMK_ERROR_MEMORY, "figure", NULL, NULL);
    *svg = drawn;
    return IMK_OK;
}

/* ---- one panel of it, on a page -------------------------------------------------------------- */

static sheet page_sheet(const imk_figure *figure, layout *l, bool alone)
{
    return (sheet){.figure = figure,
                   .size = imki_page_panel_measure(figure->panels, alone),
                   .single = alone,
                   .tick_size = alone ? 12 : 10,
                   .layout = l};
}

void imki_panel_svg(imki_text *out, const imk_panel *panel, bool alone)
{
    const imk_figure figure = {"", 1, 1, panel};
    layout l = {.left = 0};
    const sheet s = page_sheet(&figure, &l, alone);
    char axes[300];
    snprintf(axes, sizeof axes, "%s%.140s against %.140s", panel->title[0] ? ": " : "",
             panel->y_label, panel->x_label);
    put_head(out, &s.size, panel->title, axes);
    put_panels(out, &s);
}

imki_frame imki_panel_frame(const imk_panel *panel, bool alone)
{
    const imk_figure figure = {"", 1, 1, panel};
    layout l = {.left = 0};
    const sheet s = page_sheet(&figure, &l, alone);
    lay_out(&s);
    return l.frame;
}
