/* SPDX-License-Identifier: Apache-2.0 */
/* What every drawing of a figure shares: the range of each axis, sizes, colours.
 *
 * The axes span points, error bars and bands; lines are clipped to them, because the asymptote of
 * one noise term would otherwise squeeze the data into a corner. */
#include "figure_internal.h"

/* Colours that readers with any colour vision can tell apart [OKABE2008], and two greys. */
static const char *const palette[IMKI_PALETTE_SIZE] = {"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                                       "#e69f00", "#56b4e9", "#333333", "#999999"};

enum { PANEL_WIDTH = 480, PANEL_HEIGHT = 380, SINGLE_WIDTH = 860, SINGLE_HEIGHT = 560 };
enum { LARGE_WIDTH = 800, LARGE_HEIGHT = 540, HEAD = 40 };
/* On a page panels can be as narrow as a third of it, where letters must still be read. */
enum { PAGE_WIDTH = 430, PAGE_HEIGHT = 350, PAGE_LARGE_WIDTH = 640, PAGE_LARGE_HEIGHT = 470 };

/* Up to this ratio an axis has labels at 1, 2 and 5. */
static const double few_decades = 300;

/* A logarithmic axis spans at least a factor of two: a flat response is drawn flat. */
static const double least_decades = 0.3;

/* Values with a smaller relative or absolute difference are drawn as equal: no label could
 * distinguish them. The third number is the largest length of an axis, so that the length stays
 * finite. */
static const double least_part = 1e-9, least_span = 1e-290, largest = 1e300;

typedef struct span {
    double low, high;
} span;

const char *imki_color(int index)
{
    return palette[(unsigned)index % IMKI_PALETTE_SIZE];
}

bool imki_drawable(double value, bool logarithmic)
{
    return isfinite(value) && (!logarithmic || value > 0);
}

bool imki_curve_is_filled(const imk_curve *curve)
{
    return curve->style == IMK_CURVE_BAND || curve->style == IMK_CURVE_LAYER;
}

static void span_add(span *s, double value, bool logarithmic)
{
    if (!imki_drawable(value, logarithmic))
        return;
    s->low = value < s->low ? value : s->low;
    s->high = value > s->high ? value : s->high;
}

static bool spans_axes(const imk_curve *curve)
{
    return curve->style == IMK_CURVE_POINTS || curve->style == IMK_CURVE_MARKS ||
           imki_curve_is_filled(curve);
}

/* Spans of a panel's points, bands and regions; of its lines when it has nothing else, or the span
 * upwards is given. */
static void panel_spans(const imk_panel *panel, span *x, span *y)
{
    bool lines = panel->region_count == 0;
    for (size_t c = 0; c < panel->curve_count; c++)
        lines = lines && !spans_axes(&panel->curves[c]);
    lines = lines || panel->y_low < panel->y_high;
    *x = *y = (span){(double)INFINITY, -(double)INFINITY};
    for (size_t r = 0; r < panel->region_count; r++) {
        const imk_region *region = &panel->regions[r];
        span_add(x, region->x_low, panel->x_logarithmic);
        span_add(x, region->x_high, panel->x_logarithmic);
        span_add(y, region->y_low, panel->y_logarithmic);
        span_add(y, region->y_high, panel->y_logarithmic);
    }
    for (size_t c = 0; c < panel->curve_count; c++) {
        const imk_curve *curve = &panel->curves[c];
        if (!lines && !spans_axes(curve))
            continue;
        for (size_t i = 0; i < curve->count; i++) {
            if (!imki_drawable(curve->x[i], panel->x_logarithmic))
                continue;
            span_add(x, curve->x[i], panel->x_logarithmic);
            if (!imki_curve_is_filled(curve))
                span_add(y, curve->y[i], panel->y_logarithmic);
            if (curve->lower && curve->upper) {
                span_add(y, curve->lower[i], panel->y_logarithmic);
                span_add(y, curve->upper[i], panel->y_logarithmic);
            }
        }
    }
}

imk_status imki_figure_check(const imk_figure *figure, imk_error *error)
{
    if (!figure || figure->panel_count == 0 || !figure->panels)
        return imk_error_set(error, IMK_ERROR_EMPTY, "figure", NULL, "a panel to draw");
    for (size_t p = 0; p < figure->panel_count; p++) {
        span x, y;
        panel_spans(&figure->panels[p], &x, &y);
        if (!(x.low <= x.high) || !(y.low <= y.high))
            return imk_error_set(error, IMK_ERROR_EMPTY, figure->panels[p].title,
                                 "no finite point (positive on a logarithmic axis)",
                                 "data to draw");
    }
    return IMK_OK;
}

/* Margin around the data: a part of the span, on a logarithmic axis in decades. */
static imki_axis axis_make(span s, bool logarithmic)
{
    double low = logarithmic ? log10(s.low) : fmax(s.low, -largest);
    double high = logarithmic ? log10(s.high) : fmin(s.high, largest);
    double air = high > low ? 0.07 * (high - low) : fmax(0.1 * fabs(high), logarithmic ? 0.3 : 0.1);
    const double least =
        logarithmic ? least_decades : fmax(least_span, least_part * fmax(fabs(low), fabs(high)));
    air = fmax(air, 0.5 * (least - (high - low)));
    return (imki_axis){.low = low - air,
                       .high = high + air,
                       .logarithmic = logarithmic,
                       .few_decades = logarithmic && s.high < few_decades * s.low};
}

void imki_panel_axes(const imk_panel *panel, imki_axis *x, imki_axis *y)
{
    span across, along;
    panel_spans(panel, &across, &along);
    *x = axis_make(across, panel->x_logarithmic);
    *y = axis_make(along, panel->y_logarithmic);
    if (panel->y_low < panel->y_high) {
        y->low = panel->y_logarithmic ? log10(panel->y_low) : panel->y_low;
        y->high = panel->y_logarithmic ? log10(panel->y_high) : panel->y_high;
    }
}

double imki_axis_place(const imki_axis *axis, double value)
{
    const double at = axis->logarithmic ? log10(value) : value;
    /* Far outside the frame any finite place will do. */
    return fmax(-1e6, fmin(1e6, (at - axis->low) / (axis->high - axis->low)));
}

double imki_frame_x(const imki_frame *frame, double value)
{
    return frame->left + imki_axis_place(&frame->x, value) * (frame->right - frame->left);
}

double imki_frame_y(const imki_frame *frame, double value)
{
    return frame->bottom + imki_axis_place(&frame->y, value) * (frame->top - frame->bottom);
}

bool imki_frame_has(const imki_frame *frame, double x, double y)
{
    return x >= frame->left && x <= frame->right && y >= frame->top && y <= frame->bottom;
}

static double within(double value, double low, double high)
{
    return fmax(low, fmin(high, value));
}

bool imki_slice_make(const imki_frame *frame, const imk_curve *curve, size_t i, imki_slice *slice)
{
    if (!curve->lower || !curve->upper || !imki_drawable(curve->x[i], frame->x.logarithmic) ||
        !imki_drawable(curve->lower[i], frame->y.logarithmic) ||
        !imki_drawable(curve->upper[i], frame->y.logarithmic))
        return false;
    const double low = imki_frame_y(frame, curve->lower[i]);
    const double high = imki_frame_y(frame, curve->upper[i]);
    *slice = (imki_slice){within(imki_frame_x(frame, curve->x[i]), frame->left, frame->right),
                          within(fmin(low, high), frame->top, frame->bottom),
                          within(fmax(low, high), frame->top, frame->bottom)};
    return true;
}

static bool is_map(const imk_figure *figure)
{
    for (size_t p = 0; p < figure->panel_count; p++)
        if (figure->panels[p].region_count > 0)
            return true;
    return false;
}

imki_figure_size imki_figure_measure(const imk_figure *figure)
{
    if (figure->panel_count <= 1)
        return (imki_figure_size){1, 1, SINGLE_WIDTH, SINGLE_HEIGHT, 0};
    size_t columns = figure->columns > 0 ? figure->columns : 1;
    columns = columns < figure->panel_count ? columns : figure->panel_count;
    const size_t rows = (figure->panel_count + columns - 1) / columns;
    const bool map = is_map(figure);
    return (imki_figure_size){columns, rows, (int)columns * (map ? LARGE_WIDTH : PANEL_WIDTH),
                              (int)rows * (map ? LARGE_HEIGHT : PANEL_HEIGHT) + HEAD, HEAD};
}

imki_figure_size imki_page_panel_measure(const imk_panel *panel, bool alone)
{
    if (alone)
        return (imki_figure_size){1, 1, SINGLE_WIDTH, SINGLE_HEIGHT, 0};
    return panel->region_count > 0
               ? (imki_figure_size){1, 1, PAGE_LARGE_WIDTH, PAGE_LARGE_HEIGHT, 0}
               : (imki_figure_size){1, 1, PAGE_WIDTH, PAGE_HEIGHT, 0};
}
