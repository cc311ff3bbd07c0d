/* SPDX-License-Identifier: Apache-2.0 */
/* A figure as a gnuplot script and a file of numbers.
 *
 * Every text of the caller is drawn without gnuplot's markup (`noenhanced`) and quoted, so that an
 * underscore is an underscore and no label can run a command. The axes span points, error bars and
 * bands; lines are clipped to them, because the asymptote of one noise term would otherwise squeeze
 * the data into a corner. */
#include "figure_internal.h"

#include "growing_text_internal.h"

#include "imukit/decimal.h"
#include "imukit/utf8.h"

#include <math.h>

/* Colours that readers with any colour vision can tell apart [OKABE2008], and two greys. */
static const char *const palette[] = {"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                      "#e69f00", "#56b4e9", "#333333", "#999999"};
enum { PALETTE_SIZE = sizeof palette / sizeof palette[0] };

/* Up to this ratio an axis has labels at 1, 2 and 5. */
static const double few_decades = 300;

enum { PANEL_WIDTH = 480, PANEL_HEIGHT = 380, SINGLE_WIDTH = 860, SINGLE_HEIGHT = 560 };
enum { LARGE_WIDTH = 800, LARGE_HEIGHT = 540 };

typedef struct span {
    double low, high;
} span;

static bool drawable(double value, bool logarithmic)
{
    return isfinite(value) && (!logarithmic || value > 0);
}

static void span_add(span *s, double value, bool logarithmic)
{
    if (!drawable(value, logarithmic))
        return;
    s->low = value < s->low ? value : s->low;
    s->high = value > s->high ? value : s->high;
}

static bool is_filled(const imk_curve *curve)
{
    return curve->style == IMK_CURVE_BAND || curve->style == IMK_CURVE_LAYER;
}

static bool spans_axes(const imk_curve *curve)
{
    return curve->style == IMK_CURVE_POINTS || curve->style == IMK_CURVE_MARKS || is_filled(curve);
}

/* Spans of a panel's points, bands and regions; of its lines when it has nothing else. */
static void panel_spans(const imk_panel *panel, span *x, span *y)
{
    bool lines_only = panel->region_count == 0;
    for (size_t c = 0; c < panel->curve_count; c++)
        lines_only = lines_only && !spans_axes(&panel->curves[c]);
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
        if (!lines_only && !spans_axes(curve))
            continue;
        for (size_t i = 0; i < curve->count; i++) {
            if (!drawable(curve->x[i], panel->x_logarithmic))
                continue;
            span_add(x, curve->x[i], panel->x_logarithmic);
            if (!is_filled(curve))
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

/* Text in single quotes, where a quote is doubled and nothing else is special; control characters
 * become blanks, and bytes that are no UTF-8 its replacement character. */
static void quote(imki_text *out, const char *text)
{
    size_t length;
    imki_text_put_char(out, '\'');
    for (const char *c = text ? text : ""; *c; c += length > 0 ? length : 1) {
        length = imk_utf8_length(c);
        if (*c == '\'')
            imki_text_put(out, "''");
        else if (length == 0)
            imki_text_put(out, IMK_UTF8_REPLACEMENT);
        else if ((unsigned char)*c < 0x20 || *c == 0x7f)
            imki_text_put_char(out, ' ');
        else
            imki_text_put_bytes(out, c, length);
    }
    imki_text_put_char(out, '\'');
}

/* The name of a file, to the byte, whatever it is. */
static void quote_name(imki_text *out, const char *name)
{
    imki_text_put_char(out, '\'');
    for (const char *c = name; *c; c++)
        imki_text_put(out, *c == '\'' ? "''" : (const char[]){*c, '\0'});
    imki_text_put_char(out, '\'');
}

static void number(imki_text *out, double value)
{
    char text[IMK_DECIMAL_SIZE];
    text[imk_decimal_shortest(value, text)] = '\0';
    imki_text_put(out, isfinite(value) ? text : "NaN");
}

/* A logarithmic axis spans at least a factor of two: a flat response is drawn flat. */
static const double least_decades = 0.3;

/* Some air around the data: a tenth of the span, on a logarithmic axis in decades. */
static void range(imki_text *out, const char *axis, span s, bool logarithmic)
{
    double low = logarithmic ? log10(s.low) : s.low;
    double high = logarithmic ? log10(s.high) : s.high;
    double air = high > low ? 0.07 * (high - low) : fmax(0.1 * fabs(high), logarithmic ? 0.3 : 0.1);
    if (logarithmic)
        air = fmax(air, 0.5 * (least_decades - (high - low)));
    low -= air;
    high += air;
    imki_text_add(out, "set %srange [", axis);
    number(out, logarithmic ? pow(10, low) : low);
    imki_text_put_char(out, ':');
    number(out, logarithmic ? pow(10, high) : high);
    imki_text_put(out, "]\n");
}

/* Ticks at 1, 2 and 5 for an axis of few decades, where powers of ten alone would be one label. */
static void close_ticks(imki_text *out, const char *axis, span s)
{
    static const int digits[] = {1, 2, 5};
    const char *comma = "";
    imki_text_add(out, "set %stics (", axis);
    for (int power = (int)floor(log10(s.low)) - 1; power <= (int)ceil(log10(s.high)); power++) {
        for (int i = 0; i < 3; i++) {
            imki_text_add(out, "%s'", comma);
            if (power >= -3 && power <= 4)
                number(out, power < 0 ? digits[i] / pow(10, -power) : digits[i] * pow(10, power));
            else
                imki_text_add(out, "%d·10^{%d}", digits[i], power);
            imki_text_put(out, "' ");
            imki_text_add(out, "%de%d", digits[i], power);
            comma = ", ";
        }
    }
    imki_text_put(out, ")\n");
}

static void write_axis(imki_text *out, const char *axis, const char *label, span s,
                       bool logarithmic, bool text_terminal)
{
    imki_text_add(out, "set %slabel ", axis);
    quote(out, label);
    imki_text_add(out, " noenhanced\nset %stics autofreq\n", axis);
    if (logarithmic)
        imki_text_add(out, "set logscale %s 10\nset m%stics 10\nset format %s '%s'\n", axis, axis,
                      axis, text_terminal ? "%.0e" : "10^{%T}");
    else
        imki_text_add(out, "unset logscale %s\nset m%stics 2\nset format %s '%%g'\n", axis, axis,
                      axis);
    range(out, axis, s, logarithmic);
    if (logarithmic && !text_terminal && s.high < few_decades * s.low)
        close_ticks(out, axis, s);
}

static void write_curve(imki_text *out, const imk_curve *curve, size_t index, const imki_drawing *d)
{
    const char *color = palette[(unsigned)curve->color % PALETTE_SIZE];
    bool text = d->terminal == IMKI_TERMINAL_TEXT;
    quote_name(out, d->data);
    imki_text_add(out, " index %zu ", index);
    bool bars = curve->lower && curve->upper;
    switch (curve->style) {
    case IMK_CURVE_BAND:
    case IMK_CURVE_LAYER:
        imki_text_add(
            out,
            "using 1:3:4 with filledcurves fillcolor rgb '%s' fillstyle transparent solid "
            "%s noborder",
            color, curve->style == IMK_CURVE_BAND ? "0.18" : "0.7");
        break;
    case IMK_CURVE_POINTS:
        /* Bars as lines of their own: gnuplot blanks a disc around a point drawn with its bar. */
        if (bars && !text) {
            imki_text_add(
                out,
                "using 1:3:(0):($4-$3) with vectors nohead linewidth 1.2 linecolor rgb '%s' "
                "notitle, \\\n     ",
                color);
            quote_name(out, d->data);
            imki_text_add(out, " index %zu ", index);
        }
        imki_text_add(out, "using 1:2 with points %slinecolor rgb '%s'",
                      text ? "" : "pointtype 7 pointsize 0.5 ", color);
        break;
    case IMK_CURVE_MARKS:
        imki_text_add(out, "using 1:2 with points %slinecolor rgb '%s'",
                      text ? "" : "pointtype 13 pointsize 1.5 ", color);
        break;
    case IMK_CURVE_LINE:
        imki_text_add(out, "using 1:2 with lines linewidth 2 linecolor rgb '%s'", color);
        break;
    case IMK_CURVE_DASHES:
        imki_text_add(out, "using 1:2 with lines linewidth 1.3 %slinecolor rgb '%s'",
                      text ? "" : "dashtype '-' ", color);
        break;
    }
    if (curve->label && curve->label[0]) {
        imki_text_put(out, " title ");
        quote(out, curve->label);
        imki_text_put(out, " noenhanced");
    } else {
        imki_text_put(out, " notitle");
    }
}

static void corner(imki_text *out, double x, double y)
{
    number(out, x);
    imki_text_put_char(out, ',');
    number(out, y);
}

/* Rectangles are for drawings only: made of letters they would hide the points. */
static void write_regions(imki_text *out, const imk_panel *panel, bool text)
{
    imki_text_put(out, "unset object\nunset label\n");
    for (size_t r = 0; r < panel->region_count; r++) {
        const imk_region *region = &panel->regions[r];
        const char *color = palette[(unsigned)region->color % PALETTE_SIZE];
        if (!text) {
            imki_text_add(out, "set object %zu rectangle from ", r + 1);
            corner(out, region->x_low, region->y_low);
            imki_text_put(out, " to ");
            corner(out, region->x_high, region->y_high);
            imki_text_add(out,
                          " behind fillcolor rgb '%s' fillstyle transparent solid 0.12 border "
                          "linecolor rgb '%s'\n",
                          color, color);
        }
        imki_text_add(out, "set label %zu ", r + 1);
        quote(out, region->label);
        imki_text_put(out, " at ");
        corner(out, region->label_right ? region->x_high : region->x_low, region->y_high);
        imki_text_add(out, " %s noenhanced", region->label_right ? "right" : "left");
        if (!text)
            imki_text_add(out, " offset character %s,-0.7 font ',10' textcolor rgb '%s'",
                          region->label_right ? "-0.5" : "0.5", color);
        else if (region->label_right) /* a line below the names on the left */
            imki_text_put(out, " offset character 0,-1");
        imki_text_put_char(out, '\n');
    }
}

/* The empty title keeps a key below off the label of the axis. */
static void write_key(imki_text *out, imk_key_place place, bool single)
{
    static const char *const among_panels[] = {"at graph 0.87,0.99 right top",
                                               "at graph 0.97,0.03 right bottom",
                                               "outside bottom center horizontal title ' '"};
    static const char *const alone[] = {"outside right top", "inside right bottom",
                                        "outside bottom center horizontal title ' '"};
    imki_text_add(
        out, "set key default %s noautotitle samplen 2 spacing 1.1 textcolor rgb '#333333'%s\n",
        single ? alone[place] : among_panels[place], single ? "" : " font ',9'");
}

static void write_panel(imki_text *out, const imk_panel *panel, size_t first_index,
                        const imki_drawing *drawing, bool single)
{
    span x, y;
    panel_spans(panel, &x, &y);
    bool text = drawing->terminal == IMKI_TERMINAL_TEXT;
    imki_text_put(out, "set title ");
    quote(out, panel->title);
    imki_text_put(out, " noenhanced\n");
    write_axis(out, "x", panel->x_label, x, panel->x_logarithmic, text);
    write_axis(out, "y", panel->y_label, y, panel->y_logarithmic, text);
    write_regions(out, panel, text);
    if (!text)
        write_key(out, panel->key, single);
    const char *separator = "plot ";
    for (size_t c = 0; c < panel->curve_count; c++) {
        /* A band of letters would hide the points. */
        if (text && is_filled(&panel->curves[c]) && panel->curve_count > 1)
            continue;
        imki_text_put(out, separator);
        write_curve(out, &panel->curves[c], first_index + c, drawing);
        separator = ", \\\n     ";
    }
    /* A map of regions alone needs something to be plotted all the same. */
    if (panel->curve_count == 0)
        imki_text_put(out, "plot NaN notitle");
    imki_text_put_char(out, '\n');
}

static size_t figure_columns(const imk_figure *figure)
{
    size_t columns = figure->columns > 0 ? figure->columns : 1;
    return columns < figure->panel_count ? columns : figure->panel_count;
}

static bool is_map(const imk_figure *figure)
{
    for (size_t p = 0; p < figure->panel_count; p++)
        if (figure->panels[p].region_count > 0)
            return true;
    return false;
}

static void write_terminal(imki_text *out, const imk_figure *figure, const imki_drawing *drawing)
{
    size_t columns = figure_columns(figure);
    size_t rows = (figure->panel_count + columns - 1) / columns;
    bool single = figure->panel_count == 1;
    size_t width = columns * (is_map(figure) ? LARGE_WIDTH : PANEL_WIDTH);
    size_t height = rows * (is_map(figure) ? LARGE_HEIGHT : PANEL_HEIGHT) + 40;
    if (single) {
        width = SINGLE_WIDTH;
        height = SINGLE_HEIGHT;
    }
    switch (drawing->terminal) {
    case IMKI_TERMINAL_SVG:
        imki_text_add(out,
                      "set terminal svg size %zu,%zu dynamic background '#ffffff' "
                      "font 'DejaVu Sans,Verdana,sans-serif,12' enhanced\n",
                      width, height);
        break;
    case IMKI_TERMINAL_PNG:
        /* Twice the size at twice the scale: sharp on dense screens and in print. */
        imki_text_add(out,
                      "set terminal pngcairo size %zu,%zu background '#ffffff' "
                      "font 'DejaVu Sans,12' fontscale 1.8 linewidth 2 pointscale 2 enhanced\n",
                      2 * width, 2 * height);
        break;
    case IMKI_TERMINAL_TEXT:
        imki_text_add(out, "set terminal dumb size %d,%d noenhanced %s\n", drawing->width,
                      drawing->height, drawing->color ? "ansi256" : "mono");
        break;
    }
    imki_text_put(out, "set output ");
    quote_name(out, drawing->output);
    imki_text_put_char(out, '\n');
}

static void write_style(imki_text *out, const imk_figure *figure, const imki_drawing *drawing)
{
    if (drawing->terminal == IMKI_TERMINAL_TEXT) {
        imki_text_put(out, "set key top right\nset tics nomirror\n");
        return;
    }
    imki_text_put(out, "set border 3 linecolor rgb '#666666'\n"
                       "set tics nomirror textcolor rgb '#333333'\n"
                       "set grid xtics ytics mxtics mytics linecolor rgb '#d4d4d4' linewidth 0.8, "
                       "linecolor rgb '#efefef' linewidth 0.5\n");
    if (figure->panel_count > 1)
        imki_text_put(out, "set xlabel offset 0,0.3\nset tics font ',10'\n");
}

char *imki_figure_script(const imk_figure *figure, const imki_drawing *drawing, size_t *size)
{
    imki_text text = {.bytes = NULL}, *out = &text;
    imki_text_put(out,
                  "# Drawn by imukit. Run it again with: gnuplot FILE.gp\nset encoding utf8\n");
    write_terminal(out, figure, drawing);
    write_style(out, figure, drawing);
    size_t columns = figure_columns(figure);
    bool multiplot = figure->panel_count > 1 && drawing->terminal != IMKI_TERMINAL_TEXT;
    if (multiplot) {
        imki_text_add(out, "set multiplot layout %zu,%zu",
                      (figure->panel_count + columns - 1) / columns, columns);
        if (figure->title && figure->title[0]) {
            imki_text_put(out, " title ");
            quote(out, figure->title);
            imki_text_put(out, " noenhanced");
        }
        imki_text_put_char(out, '\n');
    }
    size_t index = 0;
    for (size_t p = 0; p < figure->panel_count; p++) {
        write_panel(out, &figure->panels[p], index, drawing, figure->panel_count == 1);
        index += figure->panels[p].curve_count;
    }
    imki_text_put(out, multiplot ? "unset multiplot\nset output\n" : "set output\n");
    return imki_text_take(out, size);
}

static double element(const double *values, size_t i)
{
    return values ? values[i] : (double)NAN;
}

/* One block per curve, in the order of the script, two blank lines between: gnuplot's `index`. A
 * comment keeps an empty curve's block from vanishing. */
char *imki_figure_data(const imk_figure *figure, size_t *size)
{
    imki_text text = {.bytes = NULL}, *out = &text;
    for (size_t p = 0; p < figure->panel_count; p++) {
        const imk_panel *panel = &figure->panels[p];
        for (size_t c = 0; c < panel->curve_count; c++) {
            const imk_curve *curve = &panel->curves[c];
            imki_text_put(out, "# ");
            quote(out, curve->label);
            imki_text_put(out, " x y lower upper\n");
            for (size_t i = 0; i < curve->count; i++) {
                number(out, curve->x[i]);
                imki_text_put_char(out, ' ');
                number(out, element(curve->y, i));
                imki_text_put_char(out, ' ');
                number(out, element(curve->lower, i));
                imki_text_put_char(out, ' ');
                number(out, element(curve->upper, i));
                imki_text_put_char(out, '\n');
            }
            if (curve->count == 0)
                imki_text_put(out, "NaN NaN NaN NaN\n");
            imki_text_put(out, "\n\n");
        }
    }
    return imki_text_take(out, size);
}
