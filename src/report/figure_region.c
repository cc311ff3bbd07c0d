/* SPDX-License-Identifier: Apache-2.0 */
/* The tinted rectangles of a map, behind the curves, and their names, before them. */
#include "figure_internal.h"

#include <stdio.h>

static const double font_size = 10, row = 13, inset = 5, mark = 7;

/* A limit that cannot be drawn, such as infinity, becomes the limit of the frame. */
static double limit(const imki_axis *axis, double value, bool high)
{
    if (!imki_drawable(value, axis->logarithmic))
        return high ? 1 : 0;
    return fmax(0, fmin(1, imki_axis_place(axis, value)));
}

static imki_box box_of(const imki_frame *f, const imk_region *r)
{
    const double width = f->right - f->left, height = f->bottom - f->top;
    return (imki_box){.left = f->left + width * limit(&f->x, r->x_low, false),
                      .right = f->left + width * limit(&f->x, r->x_high, true),
                      .bottom = f->bottom - height * limit(&f->y, r->y_low, false),
                      .top = f->bottom - height * limit(&f->y, r->y_high, true)};
}

void imki_regions_draw(imki_text *out, const imki_frame *frame, const imk_panel *panel)
{
    for (size_t r = 0; r < panel->region_count; r++) {
        const imki_box box = box_of(frame, &panel->regions[r]);
        const char *color = imki_color(panel->regions[r].color);
        if (!(box.right >= box.left && box.bottom >= box.top))
            continue;
        imki_text_add(out,
                      "<rect x=\"%ld\" y=\"%ld\" width=\"%ld\" height=\"%ld\" fill=\"%s\" "
                      "fill-opacity=\"%s\" stroke=\"%s\" stroke-width=\"8\"%s/>\n",
                      imki_tenths(box.left), imki_tenths(box.top),
                      imki_tenths(box.right - box.left), imki_tenths(box.bottom - box.top), color,
                      panel->regions[r].dashed ? "0.05" : "0.12", color,
                      panel->regions[r].dashed ? " stroke-dasharray=\"50 35\"" : "");
    }
}

static bool overlap(const imki_box *a, const imki_box *b)
{
    return a->left < b->right && b->left < a->right && a->top < b->bottom && b->top < a->bottom;
}

/* Marks that names keep clear of, too. */
imki_placer imki_placer_make(const imki_frame *f, const imk_panel *panel)
{
    imki_placer placer = {.panel = panel};
    for (size_t c = 0; c < panel->curve_count; c++) {
        const imk_curve *curve = &panel->curves[c];
        if (curve->style != IMK_CURVE_MARKS)
            continue;
        for (size_t i = 0; i < curve->count && placer.count < IMKI_PLACED_MAX / 2; i++) {
            if (!imki_drawable(curve->x[i], f->x.logarithmic) ||
                !imki_drawable(curve->y[i], f->y.logarithmic))
                continue;
            const double x = imki_frame_x(f, curve->x[i]), y = imki_frame_y(f, curve->y[i]);
            placer.placed[placer.count++] = (imki_box){x - mark, y - mark, x + mark, y + mark};
        }
    }
    return placer;
}

/* ---- what crosses a name --------------------------------------------------------------------- */

/* How bad a name on another is, a name on a line, one outside of its region, and a row further down
 * or at the other side. */
static const double on_name = 100, on_line = 3, outside = 2, further = 0.05, other_side = 0.5;

/* Sides of a region that go through a box. */
static int sides_within(const imki_box *region, const imki_box *box)
{
    const bool beside = region->right < box->left || region->left > box->right;
    const bool above = region->bottom < box->top || region->top > box->bottom;
    const double x[2] = {region->left, region->right}, y[2] = {region->top, region->bottom};
    int count = 0;
    for (int i = 0; i < 2; i++) {
        count += !above && x[i] > box->left && x[i] < box->right;
        count += !beside && y[i] > box->top && y[i] < box->bottom;
    }
    return count;
}

static double badness(const imki_placer *placer, const imki_frame *frame, const imki_box *name)
{
    const imk_panel *panel = placer->panel;
    double sum = 0;
    for (size_t i = 0; i < placer->count; i++)
        sum += on_name * overlap(name, &placer->placed[i]);
    for (size_t r = 0; r < panel->region_count; r++) {
        const imki_box box = box_of(frame, &panel->regions[r]);
        sum += on_line * sides_within(&box, name);
    }
    for (size_t c = 0; c < panel->curve_count; c++)
        sum += on_line * (imki_curve_touches(frame, &panel->curves[c], name) > 0);
    return sum;
}

/* ---- places ---------------------------------------------------------------------------------- */

/* A search for the best place of a name of this width. */
typedef struct search {
    const imki_placer *placer;
    const imki_frame *frame;
    imki_box region, best;
    double width, least;
    bool at_right; /* is asked for */
} search;

/* Try the row at `top`, at both sides and in the middle. */
static void try_row(search *s, double top, double extra)
{
    const imki_frame *f = s->frame;
    const double places[3] = {s->region.left + inset, s->region.right - inset - s->width,
                              0.5 * (s->region.left + s->region.right - s->width)};
    if (top < f->top || top + row > f->bottom)
        return;
    for (int i = 0; i < 3; i++) {
        const double left = fmax(f->left + inset, fmin(f->right - inset - s->width, places[i]));
        const imki_box name = {left, top, left + s->width, top + row};
        const double bad =
            badness(s->placer, f, &name) + extra + other_side * ((i == 1) != s->at_right || i == 2);
        if (bad < s->least) {
            s->least = bad;
            s->best = name;
        }
    }
}

imki_box imki_region_place(imki_placer *placer, const imki_frame *frame, const imk_region *region)
{
    const double room = frame->right - frame->left - 2 * inset, edge = 3;
    search s = {.placer = placer,
                .frame = frame,
                .region = box_of(frame, region),
                .width = fmin(imki_line_width(region->label, font_size), room),
                .least = HUGE_VAL,
                .at_right = region->label_right};
    const double first = s.region.top + edge;
    s.best = (imki_box){s.region.left + inset, first, s.region.left + inset + s.width, first + row};
    for (int k = 0; k == 0 || first + (k + 1) * row <= s.region.bottom; k++)
        try_row(&s, first + k * row, k * further);
    try_row(&s, s.region.top - row, outside);
    try_row(&s, s.region.bottom, outside);
    if (placer->count < IMKI_PLACED_MAX)
        placer->placed[placer->count++] = s.best;
    return s.best;
}

/* ---- drawing --------------------------------------------------------------------------------- */

/* The colours of the palette, dark enough for letters on white: a contrast of 4.5 at least. */
static const char *const inks[IMKI_PALETTE_SIZE] = {"#0072b2", "#b04e00", "#007a59", "#a3527e",
                                                    "#8f6300", "#1f78ad", "#333333", "#6b6b6b"};

void imki_region_labels_draw(imki_text *out, const imki_frame *frame, const imk_panel *panel)
{
    imki_placer placer = imki_placer_make(frame, panel);
    const double room = frame->right - frame->left - 2 * inset;
    for (size_t r = 0; r < panel->region_count; r++) {
        const imk_region *region = &panel->regions[r];
        const imki_box name = imki_region_place(&placer, frame, region);
        char color[16];
        snprintf(color, sizeof color, " fill=\"%s\"",
                 inks[(unsigned)region->color % IMKI_PALETTE_SIZE]);
        imki_svg_line(out, name.left, name.bottom - 3, IMKI_START, font_size, room, color,
                      region->label);
    }
}
