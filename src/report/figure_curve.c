/* SPDX-License-Identifier: Apache-2.0 */
/* The path of a curve.
 *
 * A drawing must stay small when a curve has a million points. Of the points of a line that follow
 * one another in the same half of a pixel's column, the first, the lowest, the highest and the last
 * are kept, in their order: the picture is the same. A band keeps its extent per column, and of
 * points one is kept per pixel. If there are still too many points (a line that goes to and fro, a
 * cloud), they are thinned evenly. */
#include "figure_internal.h"

#include <stdlib.h>
#include <string.h>

typedef struct point {
    double x, y;
} point;

static imki_box box_of(const imki_frame *f)
{
    return (imki_box){f->left, f->top, f->right, f->bottom};
}

/* ---- writing --------------------------------------------------------------------------------- */

typedef struct pen {
    imki_text *out;
    bool down;
    long x, y; /* tenths of a pixel */
} pen;

static void pen_move(pen *p, point to)
{
    p->x = imki_tenths(to.x);
    p->y = imki_tenths(to.y);
    p->down = true;
    imki_text_add(p->out, "M%ld %ld", p->x, p->y);
}

static void pen_line(pen *p, point to)
{
    const long dx = imki_tenths(to.x) - p->x, dy = imki_tenths(to.y) - p->y;
    if (dx == 0 && dy == 0)
        return;
    imki_text_add(p->out, "l%ld%s%ld", dx, dy < 0 ? "" : " ", dy);
    p->x += dx;
    p->y += dy;
}

/* ---- points of a line, few in a column ------------------------------------------------------- */

enum { FIRST, LOWEST, HIGHEST, LAST, KEPT };

typedef struct column {
    bool filled, begins; /* begins: its first point begins a run */
    long number;
    point at[KEPT];
    size_t index[KEPT];
} column;

static void column_flush(column *c, imki_visitor *v)
{
    if (!c->filled)
        return;
    const bool low_first = c->index[LOWEST] < c->index[HIGHEST];
    const int order[KEPT] = {FIRST, low_first ? LOWEST : HIGHEST, low_first ? HIGHEST : LOWEST,
                             LAST};
    for (int i = 0; i < KEPT; i++)
        if (i == 0 || c->index[order[i]] != c->index[order[i - 1]])
            v->visit(v, c->index[order[i]], c->at[order[i]].x, c->at[order[i]].y,
                     i == 0 && c->begins);
    c->filled = false;
}

static void column_add(column *c, point p, size_t index)
{
    if (p.y < c->at[LOWEST].y) {
        c->at[LOWEST] = p;
        c->index[LOWEST] = index;
    }
    if (p.y > c->at[HIGHEST].y) {
        c->at[HIGHEST] = p;
        c->index[HIGHEST] = index;
    }
    c->at[LAST] = p;
    c->index[LAST] = index;
}

void imki_line_walk(const imki_frame *f, const imk_curve *curve, imki_visitor *v)
{
    column c = {.filled = false};
    bool begins = true;
    for (size_t i = 0; i < curve->count; i++) {
        if (!imki_drawable(curve->x[i], f->x.logarithmic) ||
            !imki_drawable(curve->y[i], f->y.logarithmic)) {
            column_flush(&c, v);
            begins = true;
            continue;
        }
        const point p = {imki_frame_x(f, curve->x[i]), imki_frame_y(f, curve->y[i])};
        if (c.filled && imki_column(p.x) == c.number) {
            column_add(&c, p, i);
            continue;
        }
        column_flush(&c, v);
        c = (column){true, begins, imki_column(p.x), {p, p, p, p}, {i, i, i, i}};
        begins = false;
    }
    column_flush(&c, v);
}

typedef struct counter {
    imki_visitor visitor;
    size_t count;
} counter;

static void count_point(imki_visitor *v, size_t index, double x, double y, bool begins)
{
    (void)index;
    (void)x;
    (void)y;
    (void)begins;
    ((counter *)v)->count++;
}

size_t imki_stride_for(size_t count)
{
    return (count + IMKI_CURVE_POINTS_MAX - 1) / IMKI_CURVE_POINTS_MAX + (count == 0);
}

size_t imki_line_stride(const imki_frame *frame, const imk_curve *curve)
{
    counter c = {{count_point}, 0};
    imki_line_walk(frame, curve, &c.visitor);
    return imki_stride_for(c.count);
}

/* ---- lines ----------------------------------------------------------------------------------- */

/* The part of a segment within a box [Liang and Barsky]. @return false: none */
static bool clip(const imki_box *b, point *from, point *to)
{
    const double dx = to->x - from->x, dy = to->y - from->y;
    const double step[4] = {-dx, dx, -dy, dy};
    const double room[4] = {from->x - b->left, b->right - from->x, from->y - b->top,
                            b->bottom - from->y};
    double begin = 0, end = 1;
    for (int side = 0; side < 4; side++) {
        if (step[side] == 0 && room[side] < 0)
            return false;
        if (step[side] < 0)
            begin = fmax(begin, room[side] / step[side]);
        else if (step[side] > 0)
            end = fmin(end, room[side] / step[side]);
    }
    if (begin > end)
        return false;
    const point start = *from;
    *from = (point){start.x + begin * dx, start.y + begin * dy};
    *to = (point){start.x + end * dx, start.y + end * dy};
    return true;
}

typedef struct line_drawer {
    imki_visitor visitor;
    pen pen;
    const imki_frame *frame;
    imki_box box;
    point before;
    bool has_before, alone; /* alone: nothing leads from it or to it */
    size_t index, stride;
} line_drawer;

/* A point between two gaps is a dot. */
static void finish_run(line_drawer *d)
{
    if (d->has_before && d->alone && imki_frame_has(d->frame, d->before.x, d->before.y)) {
        pen_move(&d->pen, d->before);
        imki_text_put(d->pen.out, "h0");
    }
    d->has_before = false;
}

static void draw_segment(imki_visitor *v, size_t index, double x, double y, bool begins)
{
    line_drawer *d = (line_drawer *)v;
    const point p = {x, y};
    (void)index;
    if (begins)
        finish_run(d);
    if (d->index++ % d->stride != 0)
        return;
    if (d->has_before) {
        point from = d->before, to = p;
        if (clip(&d->box, &from, &to)) {
            if (!d->pen.down || imki_tenths(from.x) != d->pen.x || imki_tenths(from.y) != d->pen.y)
                pen_move(&d->pen, from);
            pen_line(&d->pen, to);
        }
    }
    d->alone = !d->has_before;
    d->has_before = true;
    d->before = p;
}

static void draw_line(imki_text *out, const imki_frame *f, const imk_curve *curve)
{
    line_drawer d = {.visitor = {draw_segment},
                     .pen = {.out = out},
                     .frame = f,
                     .box = box_of(f),
                     .stride = imki_line_stride(f, curve)};
    imki_line_walk(f, curve, &d.visitor);
    finish_run(&d);
}

/* ---- bands ----------------------------------------------------------------------------------- */

typedef struct band {
    imki_slice *slice; /* NULL: they are counted only */
    size_t count, index, stride;
} band;

/* Along the upper limits and back along the lower ones; of a single slice, two pixels wide. */
static void put_run(imki_text *out, const band *b)
{
    pen p = {.out = out};
    if (b->count == 0)
        return;
    const imki_slice *first = &b->slice[0];
    if (b->count == 1) {
        imki_text_add(out, "M%ld %ldh20V%ldh-20z", imki_tenths(first->x - 1),
                      imki_tenths(first->top), imki_tenths(first->bottom));
        return;
    }
    pen_move(&p, (point){first->x, first->top});
    for (size_t i = 1; i < b->count; i++)
        pen_line(&p, (point){b->slice[i].x, b->slice[i].top});
    for (size_t i = b->count; i-- > 0;)
        pen_line(&p, (point){b->slice[i].x, b->slice[i].bottom});
    imki_text_put_char(out, 'z');
}

static void add_slice(band *b, const imki_slice *s)
{
    if (b->slice && b->index % b->stride == 0)
        b->slice[b->count++] = *s;
    b->index++;
}

/* The slices of a band, one for a column that several points share. A run ends at a gap; it is
 * written to `out` when that is not NULL. */
static void walk_band(const imki_frame *f, const imk_curve *curve, band *b, imki_text *out)
{
    imki_slice s = {0};
    bool filled = false;
    for (size_t i = 0; i <= curve->count; i++) {
        imki_slice next;
        const bool drawable = i < curve->count && imki_slice_make(f, curve, i, &next);
        if (drawable && filled && imki_column(next.x) == imki_column(s.x)) {
            s.top = fmin(s.top, next.top);
            s.bottom = fmax(s.bottom, next.bottom);
            continue;
        }
        if (filled)
            add_slice(b, &s);
        if (!drawable && out) {
            put_run(out, b);
            b->count = 0;
        }
        filled = drawable;
        if (drawable)
            s = next;
    }
}

static void draw_band(imki_text *out, const imki_frame *f, const imk_curve *curve)
{
    band b = {.stride = 1};
    if (!curve->lower || !curve->upper)
        return;
    walk_band(f, curve, &b, NULL);
    b = (band){.stride = imki_stride_for(b.index),
               .slice = malloc((b.index / imki_stride_for(b.index) + 1) * sizeof *b.slice)};
    if (b.slice)
        walk_band(f, curve, &b, out);
    else
        out->failed = true;
    free(b.slice);
}

/* ---- all styles ------------------------------------------------------------------------------ */

void imki_curve_style(imki_text *out, const imk_curve *curve)
{
    const char *color = imki_color(curve->color);
    switch (curve->style) {
    case IMK_CURVE_BAND:
    case IMK_CURVE_LAYER:
        imki_text_add(out, "<path fill=\"%s\" fill-opacity=\"%s\"", color,
                      curve->style == IMK_CURVE_BAND ? "0.18" : "0.7");
        break;
    case IMK_CURVE_MARKS:
        imki_text_add(out, "<path fill=\"%s\" stroke=\"#fff\" stroke-width=\"10\"", color);
        break;
    case IMK_CURVE_POINTS:
        imki_text_add(
            out, "<path fill=\"none\" stroke=\"%s\" stroke-width=\"48\" stroke-linecap=\"round\"",
            color);
        break;
    case IMK_CURVE_LINE:
        imki_text_add(out,
                      "<path fill=\"none\" stroke=\"%s\" stroke-width=\"18\" "
                      "stroke-linejoin=\"round\" stroke-linecap=\"round\"",
                      color);
        break;
    case IMK_CURVE_DASHES:
        imki_text_add(out,
                      "<path fill=\"none\" stroke=\"%s\" stroke-width=\"14\" "
                      "stroke-linejoin=\"round\" stroke-dasharray=\"70 45\"",
                      color);
        break;
    }
}

void imki_curve_draw(imki_text *out, const imki_frame *frame, const imk_curve *curve)
{
    const bool marks = curve->style == IMK_CURVE_POINTS || curve->style == IMK_CURVE_MARKS;
    if (marks && curve->lower && curve->upper) {
        imki_text_add(out, "<path fill=\"none\" stroke=\"%s\" stroke-width=\"12\" d=\"",
                      imki_color(curve->color));
        imki_bars_draw(out, frame, curve);
        imki_text_put(out, "\"/>\n");
    }
    imki_curve_style(out, curve);
    imki_text_put(out, " d=\"");
    if (imki_curve_is_filled(curve))
        draw_band(out, frame, curve);
    else if (marks)
        imki_points_draw(out, frame, curve);
    else
        draw_line(out, frame, curve);
    imki_text_put(out, "\"/>\n");
}

/* ---- what a key would hide ------------------------------------------------------------------- */

typedef struct toucher {
    imki_visitor visitor;
    const imki_box *box;
    point before;
    size_t count;
} toucher;

static void touch(imki_visitor *v, size_t index, double x, double y, bool begins)
{
    toucher *t = (toucher *)v;
    point from = begins ? (point){x, y} : t->before, to = {x, y};
    (void)index;
    t->count += clip(t->box, &from, &to);
    t->before = (point){x, y};
}

size_t imki_curve_touches(const imki_frame *frame, const imk_curve *curve, const imki_box *box)
{
    toucher t = {.visitor = {touch}, .box = box};
    if (curve->style == IMK_CURVE_LINE || curve->style == IMK_CURVE_DASHES) {
        imki_line_walk(frame, curve, &t.visitor);
        return t.count;
    }
    for (size_t i = 0; i < curve->count; i++) {
        imki_slice s;
        const bool marked = imki_drawable(curve->x[i], frame->x.logarithmic) &&
                            !imki_curve_is_filled(curve) &&
                            imki_drawable(curve->y[i], frame->y.logarithmic);
        if (marked) {
            const double x = imki_frame_x(frame, curve->x[i]);
            touch(&t.visitor, i, x, imki_frame_y(frame, curve->y[i]), true);
        }
        if (imki_slice_make(frame, curve, i, &s)) {
            t.before = (point){s.x, s.top};
            touch(&t.visitor, i, s.x, s.bottom, false);
        }
    }
    return t.count;
}
