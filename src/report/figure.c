/* SPDX-License-Identifier: Apache-2.0 */
/* A figure as a gnuplot script and a file of numbers.
 *
 * Every text of the caller is drawn without gnuplot's markup (`noenhanced`) and quoted, so that an
 * underscore is an underscore and no label can run a command. The axes span points, error bars and
 * bands; lines are clipped to them, because the asymptote of one noise term would otherwise squeeze
 * the data into a corner. */
#define _POSIX_C_SOURCE 200809L
#include "figure_internal.h"

#include "imukit/decimal.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

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
 * become blanks. */
static void quote(FILE *out, const char *text)
{
    fputc('\'', out);
    for (const char *c = text ? text : ""; *c; c++) {
        if (*c == '\'')
            fputs("''", out);
        else
            fputc((unsigned char)*c < 0x20 || *c == 0x7f ? ' ' : *c, out);
    }
    fputc('\'', out);
}

static void number(FILE *out, double value)
{
    char text[IMK_DECIMAL_SIZE];
    text[imk_decimal_shortest(value, text)] = '\0';
    fputs(isfinite(value) ? text : "NaN", out);
}

/* A logarithmic axis spans at least a factor of two: a flat response is drawn flat. */
static const double least_decades = 0.3;

/* Some air around the data: a tenth of the span, on a logarithmic axis in decades. */
static void range(FILE *out, const char *axis, span s, bool logarithmic)
{
    double low = logarithmic ? log10(s.low) : s.low;
    double high = logarithmic ? log10(s.high) : s.high;
    double air = high > low ? 0.07 * (high - low) : fmax(0.1 * fabs(high), logarithmic ? 0.3 : 0.1);
    if (logarithmic)
        air = fmax(air, 0.5 * (least_decades - (high - low)));
    low -= air;
    high += air;
    fprintf(out, "set %srange [", axis);
    number(out, logarithmic ? pow(10, low) : low);
    fputc(':', out);
    number(out, logarithmic ? pow(10, high) : high);
    fputs("]\n", out);
}

/* Ticks at 1, 2 and 5 for an axis of few decades, where powers of ten alone would be one label. */
static void close_ticks(FILE *out, const char *axis, span s)
{
    static const int digits[] = {1, 2, 5};
    const char *comma = "";
    fprintf(out, "set %stics (", axis);
    for (int power = (int)floor(log10(s.low)) - 1; power <= (int)ceil(log10(s.high)); power++) {
        for (int i = 0; i < 3; i++) {
            fprintf(out, "%s'", comma);
            if (power >= -3 && power <= 4)
                number(out, power < 0 ? digits[i] / pow(10, -power) : digits[i] * pow(10, power));
            else
                fprintf(out, "%d·10^{%d}", digits[i], power);
            fputs("' ", out);
            fprintf(out, "%de%d", digits[i], power);
            comma = ", ";
        }
    }
    fputs(")\n", out);
}

static void write_axis(FILE *out, const char *axis, const char *label, span s, bool logarithmic,
                       bool text_terminal)
{
    fprintf(out, "set %slabel ", axis);
    quote(out, label);
    fprintf(out, " noenhanced\nset %stics autofreq\n", axis);
    if (logarithmic)
        fprintf(out, "set logscale %s 10\nset m%stics 10\nset format %s '%s'\n", axis, axis, axis,
                text_terminal ? "%.0e" : "10^{%T}");
    else
        fprintf(out, "unset logscale %s\nset m%stics 2\nset format %s '%%g'\n", axis, axis, axis);
    range(out, axis, s, logarithmic);
    if (logarithmic && !text_terminal && s.high < few_decades * s.low)
        close_ticks(out, axis, s);
}

static void write_curve(FILE *out, const imk_curve *curve, size_t index, const imki_drawing *d)
{
    const char *color = palette[(unsigned)curve->color % PALETTE_SIZE];
    bool text = d->terminal == IMKI_TERMINAL_TEXT;
    quote(out, d->data);
    fprintf(out, " index %zu ", index);
    bool bars = curve->lower && curve->upper;
    switch (curve->style) {
    case IMK_CURVE_BAND:
    case IMK_CURVE_LAYER:
        fprintf(out,
                "using 1:3:4 with filledcurves fillcolor rgb '%s' fillstyle transparent solid "
                "%s noborder",
                color, curve->style == IMK_CURVE_BAND ? "0.18" : "0.7");
        break;
    case IMK_CURVE_POINTS:
        /* Bars as lines of their own: gnuplot blanks a disc around a point drawn with its bar. */
        if (bars && !text) {
            fprintf(out,
                    "using 1:3:(0):($4-$3) with vectors nohead linewidth 1.2 linecolor rgb '%s' "
                    "notitle, \\\n     ",
                    color);
            quote(out, d->data);
            fprintf(out, " index %zu ", index);
        }
        fprintf(out, "using 1:2 with points %slinecolor rgb '%s'",
                text ? "" : "pointtype 7 pointsize 0.5 ", color);
        break;
    case IMK_CURVE_MARKS:
        fprintf(out, "using 1:2 with points %slinecolor rgb '%s'",
                text ? "" : "pointtype 13 pointsize 1.5 ", color);
        break;
    case IMK_CURVE_LINE:
        fprintf(out, "using 1:2 with lines linewidth 2 linecolor rgb '%s'", color);
        break;
    case IMK_CURVE_DASHES:
        fprintf(out, "using 1:2 with lines linewidth 1.3 %slinecolor rgb '%s'",
                text ? "" : "dashtype '-' ", color);
        break;
    }
    if (curve->label && curve->label[0]) {
        fputs(" title ", out);
        quote(out, curve->label);
        fputs(" noenhanced", out);
    } else {
        fputs(" notitle", out);
    }
}

static void corner(FILE *out, double x, double y)
{
    number(out, x);
    fputc(',', out);
    number(out, y);
}

/* Rectangles are for drawings only: made of letters they would hide the points. */
static void write_regions(FILE *out, const imk_panel *panel, bool text)
{
    fputs("unset object\nunset label\n", out);
    for (size_t r = 0; r < panel->region_count; r++) {
        const imk_region *region = &panel->regions[r];
        const char *color = palette[(unsigned)region->color % PALETTE_SIZE];
        if (!text) {
            fprintf(out, "set object %zu rectangle from ", r + 1);
            corner(out, region->x_low, region->y_low);
            fputs(" to ", out);
            corner(out, region->x_high, region->y_high);
            fprintf(out,
                    " behind fillcolor rgb '%s' fillstyle transparent solid 0.12 border "
                    "linecolor rgb '%s'\n",
                    color, color);
        }
        fprintf(out, "set label %zu ", r + 1);
        quote(out, region->label);
        fputs(" at ", out);
        corner(out, region->label_right ? region->x_high : region->x_low, region->y_high);
        fprintf(out, " %s noenhanced", region->label_right ? "right" : "left");
        if (!text)
            fprintf(out, " offset character %s,-0.7 font ',10' textcolor rgb '%s'",
                    region->label_right ? "-0.5" : "0.5", color);
        else if (region->label_right) /* a line below the names on the left */
            fputs(" offset character 0,-1", out);
        fputc('\n', out);
    }
}

/* The empty title keeps a key below off the label of the axis. */
static void write_key(FILE *out, imk_key_place place, bool single)
{
    static const char *const among_panels[] = {"at graph 0.87,0.99 right top",
                                               "at graph 0.97,0.03 right bottom",
                                               "outside bottom center horizontal title ' '"};
    static const char *const alone[] = {"outside right top", "inside right bottom",
                                        "outside bottom center horizontal title ' '"};
    fprintf(out, "set key default %s noautotitle samplen 2 spacing 1.1 textcolor rgb '#333333'%s\n",
            single ? alone[place] : among_panels[place], single ? "" : " font ',9'");
}

static void write_panel(FILE *out, const imk_panel *panel, size_t first_index,
                        const imki_drawing *drawing, bool single)
{
    span x, y;
    panel_spans(panel, &x, &y);
    bool text = drawing->terminal == IMKI_TERMINAL_TEXT;
    fputs("set title ", out);
    quote(out, panel->title);
    fputs(" noenhanced\n", out);
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
        fputs(separator, out);
        write_curve(out, &panel->curves[c], first_index + c, drawing);
        separator = ", \\\n     ";
    }
    /* A map of regions alone needs something to be plotted all the same. */
    if (panel->curve_count == 0)
        fputs("plot NaN notitle", out);
    fputc('\n', out);
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

static void write_terminal(FILE *out, const imk_figure *figure, const imki_drawing *drawing)
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
        fprintf(out,
                "set terminal svg size %zu,%zu dynamic background '#ffffff' "
                "font 'DejaVu Sans,Verdana,sans-serif,12' enhanced\n",
                width, height);
        break;
    case IMKI_TERMINAL_PNG:
        /* Twice the size at twice the scale: sharp on dense screens and in print. */
        fprintf(out,
                "set terminal pngcairo size %zu,%zu background '#ffffff' "
                "font 'DejaVu Sans,12' fontscale 1.8 linewidth 2 pointscale 2 enhanced\n",
                2 * width, 2 * height);
        break;
    case IMKI_TERMINAL_TEXT:
        fprintf(out, "set terminal dumb size %d,%d noenhanced %s\n", drawing->width,
                drawing->height, drawing->color ? "ansi256" : "mono");
        break;
    }
    fputs("set output ", out);
    quote(out, drawing->output);
    fputc('\n', out);
}

static void write_style(FILE *out, const imk_figure *figure, const imki_drawing *drawing)
{
    if (drawing->terminal == IMKI_TERMINAL_TEXT) {
        fputs("set key top right\nset tics nomirror\n", out);
        return;
    }
    fputs("set border 3 linecolor rgb '#666666'\n"
          "set tics nomirror textcolor rgb '#333333'\n"
          "set grid xtics ytics mxtics mytics linecolor rgb '#d4d4d4' linewidth 0.8, "
          "linecolor rgb '#efefef' linewidth 0.5\n",
          out);
    if (figure->panel_count > 1)
        fputs("set xlabel offset 0,0.3\nset tics font ',10'\n", out);
}

char *imki_figure_script(const imk_figure *figure, const imki_drawing *drawing, size_t *size)
{
    char *text = NULL;
    FILE *out = open_memstream(&text, size);
    if (!out)
        return NULL;
    fputs("# Drawn by imukit. Run it again with: gnuplot FILE.gp\nset encoding utf8\n", out);
    write_terminal(out, figure, drawing);
    write_style(out, figure, drawing);
    size_t columns = figure_columns(figure);
    bool multiplot = figure->panel_count > 1 && drawing->terminal != IMKI_TERMINAL_TEXT;
    if (multiplot) {
        fprintf(out, "set multiplot layout %zu,%zu", (figure->panel_count + columns - 1) / columns,
                columns);
        if (figure->title && figure->title[0]) {
            fputs(" title ", out);
            quote(out, figure->title);
            fputs(" noenhanced", out);
        }
        fputc('\n', out);
    }
    size_t index = 0;
    for (size_t p = 0; p < figure->panel_count; p++) {
        write_panel(out, &figure->panels[p], index, drawing, figure->panel_count == 1);
        index += figure->panels[p].curve_count;
    }
    fputs(multiplot ? "unset multiplot\nset output\n" : "set output\n", out);
    if (fclose(out) != 0) {
        free(text);
        return NULL;
    }
    return text;
}

static double element(const double *values, size_t i)
{
    return values ? values[i] : (double)NAN;
}

/* One block per curve, in the order of the script, two blank lines between: gnuplot's `index`. A
 * comment keeps an empty curve's block from vanishing. */
char *imki_figure_data(const imk_figure *figure, size_t *size)
{
    char *text = NULL;
    FILE *out = open_memstream(&text, size);
    if (!out)
        return NULL;
    for (size_t p = 0; p < figure->panel_count; p++) {
        const imk_panel *panel = &figure->panels[p];
        for (size_t c = 0; c < panel->curve_count; c++) {
            const imk_curve *curve = &panel->curves[c];
            fputs("# ", out);
            quote(out, curve->label);
            fputs(" x y lower upper\n", out);
            for (size_t i = 0; i < curve->count; i++) {
                number(out, curve->x[i]);
                fputc(' ', out);
                number(out, element(curve->y, i));
                fputc(' ', out);
                number(out, element(curve->lower, i));
                fputc(' ', out);
                number(out, element(curve->upper, i));
                fputc('\n', out);
            }
            if (curve->count == 0)
                fputs("NaN NaN NaN NaN\n", out);
            fputs("\n\n", out);
        }
    }
    if (fclose(out) != 0) {
        free(text);
        return NULL;
    }
    return text;
}
