/* SPDX-License-Identifier: Apache-2.0 */
/* Single points, one in each pixel of the frame, and their error bars. */
#include "figure_internal.h"

#include <stdlib.h>
#include <string.h>

/* If there are more error bars than this, those of a column are joined. */
enum { BARS_MAX = 2000 };

/* Draws a mark unless there is one in its cell of the frame. */
typedef struct grid {
    unsigned char *taken; /* a bit for each cell */
    size_t columns, rows;
    int cell; /* [px] */
} grid;

static bool grid_make(grid *g, const imki_frame *f)
{
    g->cell = 1;
    g->columns = (size_t)(f->right - f->left) + 1;
    g->rows = (size_t)(f->bottom - f->top) + 1;
    g->taken = malloc(g->columns * g->rows / 8 + 1);
    return g->taken != NULL;
}

static bool grid_take(grid *g, const imki_frame *f, double x, double y)
{
    const size_t column = (size_t)(x - f->left) / (size_t)g->cell;
    const size_t row = (size_t)(y - f->top) / (size_t)g->cell;
    const size_t bit = row * g->columns + column;
    const unsigned char mask = (unsigned char)(1U << bit % 8);
    if (g->taken[bit / 8] & mask)
        return false;
    g->taken[bit / 8] |= mask;
    return true;
}

void imki_put_diamond(imki_text *out, double x, double y)
{
    imki_text_add(out, "M%ld %ldl80 80l-80 80l-80-80z", imki_tenths(x), imki_tenths(y - 8));
}

/* @return how many marks there are; they are visited when `v` is not NULL */
static size_t walk_points(const imki_frame *f, const imk_curve *curve, grid *g, imki_visitor *v)
{
    size_t count = 0;
    memset(g->taken, 0, g->columns * g->rows / 8 + 1);
    for (size_t i = 0; i < curve->count; i++) {
        if (!imki_drawable(curve->x[i], f->x.logarithmic) ||
            !imki_drawable(curve->y[i], f->y.logarithmic))
            continue;
        const double x = imki_frame_x(f, curve->x[i]), y = imki_frame_y(f, curve->y[i]);
        if (!imki_frame_has(f, x, y) || !grid_take(g, f, x, y))
            continue;
        if (v)
            v->visit(v, i, x, y, count == 0);
        count++;
    }
    return count;
}

bool imki_points_walk(const imki_frame *f, const imk_curve *curve, imki_visitor *v)
{
    grid g;
    if (!grid_make(&g, f))
        return false;
    while (walk_points(f, curve, &g, NULL) > IMKI_CURVE_POINTS_MAX)
        g.cell *= 2;
    walk_points(f, curve, &g, v);
    free(g.taken);
    return true;
}

typedef struct point_drawer {
    imki_visitor visitor;
    imki_text *out;
    bool diamonds;
} point_drawer;

static void draw_point(imki_visitor *v, size_t index, double x, double y, bool begins)
{
    const point_drawer *d = (const point_drawer *)v;
    (void)index;
    (void)begins;
    if (d->diamonds)
        imki_put_diamond(d->out, x, y);
    else
        imki_text_add(d->out, "M%ld %ldh0", imki_tenths(x), imki_tenths(y));
}

void imki_points_draw(imki_text *out, const imki_frame *f, const imk_curve *curve)
{
    point_drawer d = {{draw_point}, out, curve->style == IMK_CURVE_MARKS};
    if (!imki_points_walk(f, curve, &d.visitor))
        out->failed = true;
}

static void put_bar(imki_text *out, const imki_slice *s)
{
    imki_text_add(out, "M%ld %ldV%ld", imki_tenths(s->x), imki_tenths(s->top),
                  imki_tenths(s->bottom));
}

/* Each bar, or with `joined` one for each column. */
static void walk_bars(imki_text *out, const imki_frame *f, const imk_curve *curve,
                      imki_slice *joined)
{
    for (size_t i = 0; i < curve->count; i++) {
        imki_slice s;
        if (!imki_drawable(curve->y[i], f->y.logarithmic) || !imki_slice_make(f, curve, i, &s))
            continue;
        if (!joined) {
            put_bar(out, &s);
            continue;
        }
        imki_slice *of_column = &joined[imki_column(s.x - f->left)];
        of_column->x = s.x;
        of_column->top = fmin(of_column->top, s.top);
        of_column->bottom = fmax(of_column->bottom, s.bottom);
    }
}

void imki_bars_draw(imki_text *out, const imki_frame *f, const imk_curve *curve)
{
    if (curve->count <= BARS_MAX) {
        walk_bars(out, f, curve, NULL);
        return;
    }
    const size_t columns = (size_t)imki_column(f->right - f->left) + 1;
    imki_slice *joined = malloc(columns * sizeof *joined);
    if (!joined) {
        out->failed = true;
        return;
    }
    for (size_t i = 0; i < columns; i++)
        joined[i] = (imki_slice){0, f->bottom, f->top};
    walk_bars(out, f, curve, joined);
    for (size_t i = 0; i < columns; i++)
        if (joined[i].top <= joined[i].bottom)
            put_bar(out, &joined[i]);
    free(joined);
}
