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

/* Move down row by row until no other name is in the way. */
static void find_room(imki_box *name, const imki_box *placed, size_t count, double bottom)
{
    for (size_t i = 0; i < count && name->bottom + row <= bottom; i++)
        if (overlap(name, &placed[i])) {
            name->top += row;
            name->bottom += row;
            i = (size_t)-1; /* from the first again */
        }
}

/* Marks that names keep clear of, too. */
imki_placer imki_placer_make(const imki_frame *f, const imk_panel *panel)
{
    imki_placer placer = {.count = 0};
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

imki_box imki_region_place(imki_placer *placer, const imki_frame *frame, const imk_region *region)
{
    const imki_box box = box_of(frame, region);
    const double width = imki_line_width(region->label, font_size);
    const double room = frame->right - frame->left - 2 * inset;
    double left = region->label_right ? box.right - inset - width : box.left + inset;
    left = fmax(frame->left + inset, fmin(frame->right - inset - width, left));
    imki_box name = {left, box.top + 3, left + fmin(width, room), box.top + 3 + row};
    find_room(&name, placer->placed, placer->count, frame->bottom);
    if (placer->count < IMKI_PLACED_MAX)
        placer->placed[placer->count++] = name;
    return name;
}

void imki_region_labels_draw(imki_text *out, const imki_frame *frame, const imk_panel *panel)
{
    imki_placer placer = imki_placer_make(frame, panel);
    const double room = frame->right - frame->left - 2 * inset;
    for (size_t r = 0; r < panel->region_count; r++) {
        const imk_region *region = &panel->regions[r];
        const imki_box name = imki_region_place(&placer, frame, region);
        char color[16];
        snprintf(color, sizeof color, " fill=\"%s\"", imki_color(region->color));
        imki_svg_line(out, name.left, name.bottom - 3, IMKI_START, font_size, room, color,
                      region->label);
    }
}
