/* SPDX-License-Identifier: Apache-2.0 */
/* What the files that draw a figure share. Drawings in letters have the same axes and colours
 * (io/plot/gnuplot_script.c). Lengths are in pixels, y downwards; the drawing is written in whole
 * tenths of them. */
#ifndef IMUKIT_REPORT_FIGURE_INTERNAL_H
#define IMUKIT_REPORT_FIGURE_INTERNAL_H

#include "growing_text_internal.h"

#include "imukit/report.h"

#include <math.h>

/* ---- figure_axes.c --------------------------------------------------------------------------- */

/* The range of an axis, with a margin around the data; exponents of ten for a logarithmic axis. */
typedef struct imki_axis {
    double low, high;
    bool logarithmic;
    bool few_decades; /* powers of ten alone would give only one or two labels */
} imki_axis;

/* Can a value stand on such an axis? */
bool imki_drawable(double value, bool logarithmic);

/* Refuse a figure that cannot be drawn: no panel, a panel without a drawable point. */
imk_status imki_figure_check(const imk_figure *figure, imk_error *error);

/* The axes of a panel that has passed. */
void imki_panel_axes(const imk_panel *panel, imki_axis *x, imki_axis *y);

/* Place of a drawable value: 0 at the low end of the axis, 1 at the high end; values outside are
 * below 0 or above 1. */
double imki_axis_place(const imki_axis *axis, double value);

/* Filled between lower and upper? */
bool imki_curve_is_filled(const imk_curve *curve);

/* The colour of an index, "#0072b2". */
enum { IMKI_PALETTE_SIZE = 8 };
const char *imki_color(int index);

typedef struct imki_figure_size {
    size_t columns, rows;
    int width, height, head; /* of all; head is above the panels */
} imki_figure_size;
imki_figure_size imki_figure_measure(const imk_figure *figure);
/* Of a panel that is a drawing of its own on a page: large if its figure has no other. */
imki_figure_size imki_page_panel_measure(const imk_panel *panel, bool alone);

/* ---- figure_ticks.c -------------------------------------------------------------------------- */

enum { IMKI_TICKS_MAX = 256 };

/* A mark of an axis, and the line of the grid that goes through it. */
typedef struct imki_tick {
    double place; /* 0 … 1 */
    bool labelled;
    char text[40];  /* "0.5", or "2·10" with a power behind */
    char power[16]; /* raised: "−3"; "" without */
} imki_tick;

typedef struct imki_ticks {
    size_t count;
    imki_tick tick[IMKI_TICKS_MAX];
} imki_ticks;

/* Ticks from low to high for an axis of this length, whose labels need this much room. */
void imki_axis_ticks(const imki_axis *axis, double length, double room, imki_ticks *ticks);

/* ---- figure_text.c --------------------------------------------------------------------------- */

/* Approximate width of a line in DejaVu Sans; fonts that replace it are not wider. */
double imki_line_width(const char *text, double font_size);

typedef enum imki_anchor { IMKI_START = 0, IMKI_MIDDLE, IMKI_END } imki_anchor;

/* A line of text, as given. A line that is wider than `width` is drawn smaller; if that is not
 * enough, its middle is left out. `more` holds further attributes, or "". */
void imki_svg_line(imki_text *out, double x, double y, imki_anchor anchor, double font_size,
                   double width, const char *more, const char *text);

/* ---- figure_curve.c -------------------------------------------------------------------------- */

/* A pair of axes on the drawing. */
typedef struct imki_frame {
    double left, top, right, bottom;
    imki_axis x, y;
} imki_frame;

typedef struct imki_box {
    double left, top, right, bottom;
} imki_box;

/* Where a drawable value stands. */
double imki_frame_x(const imki_frame *frame, double value);
double imki_frame_y(const imki_frame *frame, double value);
bool imki_frame_has(const imki_frame *frame, double x, double y);

/* What a curve covers at a place, within the frame. */
typedef struct imki_slice {
    double x, top, bottom;
} imki_slice;

/* From the lower to the upper limit of point i. @return false: it cannot be drawn */
bool imki_slice_make(const imki_frame *frame, const imk_curve *curve, size_t i, imki_slice *slice);

/* The half of a pixel's column that a place is in. */
static inline long imki_column(double x)
{
    return (long)floor(2 * x);
}

/* Takes the points of a curve that are drawn, in order. `begins`: the first, or the first after a
 * gap. */
typedef struct imki_visitor {
    void (*visit)(struct imki_visitor *v, size_t index, double x, double y, bool begins);
} imki_visitor;

/* Of the points of a line that share half of a pixel's column: the first, the lowest, the highest
 * and the last. */
void imki_line_walk(const imki_frame *frame, const imk_curve *curve, imki_visitor *v);
/* Of so many points each so-manieth is drawn; and of those of a line. */
size_t imki_stride_for(size_t count);
size_t imki_line_stride(const imki_frame *frame, const imk_curve *curve);

/* The path of a curve, which is within the frame. However many points a curve has, at most
 * IMKI_CURVE_POINTS_MAX are drawn, of 8 to 32 bytes. */
enum { IMKI_CURVE_POINTS_MAX = 20000 };
void imki_curve_draw(imki_text *out, const imki_frame *frame, const imk_curve *curve);

/* How many parts of a curve reach into a box? */
size_t imki_curve_touches(const imki_frame *frame, const imk_curve *curve, const imki_box *box);

/* The beginning of the <path …> of a curve, up to but without d=". */
void imki_curve_style(imki_text *out, const imk_curve *curve);

/* ---- figure_points.c ------------------------------------------------------------------------- */

/* The points of which one is drawn per pixel, or per some pixels if there are too many.
 * @return false: memory is exhausted */
bool imki_points_walk(const imki_frame *frame, const imk_curve *curve, imki_visitor *v);

/* In the data of a path: the marks of a curve, their error bars, and a single large mark. */
void imki_points_draw(imki_text *out, const imki_frame *frame, const imk_curve *curve);
void imki_bars_draw(imki_text *out, const imki_frame *frame, const imk_curve *curve);
void imki_put_diamond(imki_text *out, double x, double y);

/* ---- figure_key.c ---------------------------------------------------------------------------- */

/* The names of the curves in rows and columns. */
typedef struct imki_key {
    size_t entries, columns, rows;
    double font_size, pitch, entry_width; /* pitch: from row to row */
    double width, height;
} imki_key;

/* Make the key of a panel, with as many columns as the width allows, at most `columns_max`; the
 * rows are closer if the height is small. */
imki_key imki_key_make(const imk_panel *panel, double font_size, double width, double height,
                       size_t columns_max);
void imki_key_draw(imki_text *out, const imki_key *key, const imk_panel *panel, double left,
                   double top);

/* ---- figure_region.c ------------------------------------------------------------------------- */

/* Names of regions that keep clear of one another, of marks and of lines; gnuplot's drawings use
 * it, too. */
enum { IMKI_PLACED_MAX = 64 };
typedef struct imki_placer {
    const imk_panel *panel;
    size_t count;
    imki_box placed[IMKI_PLACED_MAX];
} imki_placer;
imki_placer imki_placer_make(const imki_frame *frame, const imk_panel *panel);
/* Where the name of the next region goes: in its corner, or where nothing crosses it. */
imki_box imki_region_place(imki_placer *placer, const imki_frame *frame, const imk_region *region);

void imki_regions_draw(imki_text *out, const imki_frame *frame, const imk_panel *panel);
void imki_region_labels_draw(imki_text *out, const imki_frame *frame, const imk_panel *panel);

/* ---- figure_svg.c ---------------------------------------------------------------------------- */

/* Draw one panel on a page: large if it is the only one of its figure. */
void imki_panel_svg(imki_text *out, const imk_panel *panel, bool alone);
/* The frame of its axes. */
imki_frame imki_panel_frame(const imk_panel *panel, bool alone);

/* ---- figure_data.c --------------------------------------------------------------------------- */

/* What imki_panel_svg() draws, as JSON that page_panel.js draws again. */
void imki_panel_data(imki_text *out, const imk_panel *panel, bool alone);

/* ---- all of them ----------------------------------------------------------------------------- */

static inline long imki_tenths(double pixels)
{
    return lround(10 * pixels);
}

#endif
