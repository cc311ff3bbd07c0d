/* SPDX-License-Identifier: Apache-2.0 */
/* A figure as a gnuplot script and a file of numbers, for the terminal and for pictures that are
 * not SVG. Axes, sizes and colours are those of our own drawings (report/figure_axes.c).
 *
 * Every text of the caller is drawn without gnuplot's markup (`noenhanced`) and quoted, so that an
 * underscore is an underscore and no label can run a command. */
#include "gnuplot_internal.h"

#include "report/figure_internal.h"

#include "imukit/decimal.h"
#include "imukit/utf8.h"

#include <stdio.h>
#include <string.h>

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

static void range(imki_text *out, const char *name, const imki_axis *axis)
{
    imki_text_add(out, "set %srange [", name);
    number(out, axis->logarithmic ? pow(10, fmax(axis->low, -307)) : axis->low);
    imki_text_put_char(out, ':');
    number(out, axis->logarithmic ? pow(10, fmin(axis->high, 308)) : axis->high);
    imki_text_put(out, "]\n");
}

/* Ticks at 1, 2 and 5 for an axis of few decades, where powers of ten alone would be one label. */
static void close_ticks(imki_text *out, const char *name, const imki_axis *axis)
{
    static const int digits[] = {1, 2, 5};
    const char *comma = "";
    imki_text_add(out, "set %stics (", name);
    for (int power = (int)floor(axis->low); power <= (int)ceil(axis->high); power++) {
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

enum { NOTE_WIDEST = 84 };

static size_t note_width(const imki_drawing *drawing)
{
    const int room = drawing->width - 4;
    return drawing->terminal == IMKI_TERMINAL_TEXT && room < NOTE_WIDEST
               ? room > 20 ? (size_t)room : 20
               : NOTE_WIDEST;
}

/* The next line of a note, broken at a blank where it is too long: gnuplot breaks no labels.
 * @return false at the end */
static bool next_line(const char **note, size_t widest, char line[NOTE_WIDEST + 1])
{
    const char *c = *note ? *note : "";
    size_t length = strcspn(c, "\n");
    if (*c == '\0')
        return false;
    if (length > widest) {
        length = widest;
        while (length > 1 && c[length] != ' ')
            length--;
        length = c[length] == ' ' ? length : widest;
    }
    snprintf(line, NOTE_WIDEST + 1, "%.*s", (int)length, c);
    *note = c + length + (c[length] == '\n' || c[length] == ' ');
    return true;
}

/* Further lines of a label; a quoted line cannot hold a line feed. */
static void write_note(imki_text *out, const char *note, size_t widest)
{
    char line[NOTE_WIDEST + 1];
    while (next_line(&note, widest, line)) {
        imki_text_put(out, ".\"\\n\".");
        quote(out, line);
    }
}

static void write_axis(imki_text *out, const char *name, const char *label, const char *note,
                       const imki_axis *axis, const imki_drawing *drawing)
{
    const bool text_terminal = drawing->terminal == IMKI_TERMINAL_TEXT;
    imki_text_add(out, "set %slabel ", name);
    quote(out, label);
    write_note(out, note, note_width(drawing));
    imki_text_add(out, " noenhanced\nset %stics autofreq\n", name);
    if (axis->logarithmic)
        imki_text_add(out, "set logscale %s 10\nset m%stics 10\nset format %s '%s'\n", name, name,
                      name, text_terminal ? "%.0e" : "10^{%T}");
    else
        imki_text_add(out, "unset logscale %s\nset m%stics 2\nset format %s '%%g'\n", name, name,
                      name);
    range(out, name, axis);
    if (axis->few_decades && !text_terminal)
        close_ticks(out, name, axis);
}

static void write_curve(imki_text *out, const imk_curve *curve, size_t index, const imki_drawing *d)
{
    const char *color = imki_color(curve->color);
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

/* A limit that is infinite is that of the frame. */
static void limit(imki_text *out, double value)
{
    if (isinf(value))
        imki_text_put(out, value > 0 ? "graph 1" : "graph 0");
    else
        number(out, value);
}

static void corner(imki_text *out, double x, double y)
{
    limit(out, x);
    imki_text_put_char(out, ',');
    limit(out, y);
}

static void write_rectangle(imki_text *out, size_t number_of, const imk_region *region)
{
    const char *color = imki_color(region->color);
    imki_text_add(out, "set object %zu rectangle from ", number_of);
    corner(out, region->x_low, region->y_low);
    imki_text_put(out, " to ");
    corner(out, region->x_high, region->y_high);
    imki_text_add(out,
                  " behind fillcolor rgb '%s' fillstyle transparent solid %s border "
                  "linecolor rgb '%s'%s\n",
                  color, region->dashed ? "0.05" : "0.12", color,
                  region->dashed ? " dashtype '-'" : "");
}

/* The frame as our own drawing would have it, in which names are placed: gnuplot does not tell the
 * size of its frame. A letter of a terminal is as large as one of a name. */
static imki_frame nominal_frame(const imk_panel *panel, const imki_drawing *drawing)
{
    const bool text = drawing->terminal == IMKI_TERMINAL_TEXT;
    const double letter = 6.2, line = 13, margin = 15;
    const char *note = panel->note;
    char noted[NOTE_WIDEST + 1];
    int lines = 8;
    while (next_line(&note, note_width(drawing), noted))
        lines++;
    imki_frame frame = {.right = text ? (drawing->width - margin) * letter : 740,
                        .bottom = text ? (drawing->height - lines) * line : 400};
    imki_panel_axes(panel, &frame.x, &frame.y);
    return frame;
}

/* Rectangles are for drawings only: made of letters they would hide the points. */
static void write_regions(imki_text *out, const imk_panel *panel, const imki_drawing *drawing)
{
    const bool text = drawing->terminal == IMKI_TERMINAL_TEXT;
    const imki_frame frame = nominal_frame(panel, drawing);
    imki_placer placer = imki_placer_make(&frame, panel);
    imki_text_put(out, "unset object\nunset label\n");
    for (size_t r = 0; r < panel->region_count; r++) {
        const imk_region *region = &panel->regions[r];
        const imki_box name = imki_region_place(&placer, &frame, region);
        if (!text)
            write_rectangle(out, r + 1, region);
        imki_text_add(out, "set label %zu ", r + 1);
        quote(out, region->label);
        imki_text_put(out, " at graph ");
        const bool right = region->label_right;
        corner(out, round(1e4 * (right ? name.right : name.left) / frame.right) / 1e4,
               round(1e4 * (1 - (name.top + name.bottom) / 2 / frame.bottom)) / 1e4);
        imki_text_add(out, " %s noenhanced", right ? "right" : "left");
        if (!text)
            imki_text_add(out, " font ',10' textcolor rgb '%s'", imki_color(region->color));
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
    imki_axis x, y;
    imki_panel_axes(panel, &x, &y);
    bool text = drawing->terminal == IMKI_TERMINAL_TEXT;
    imki_text_put(out, "set title ");
    quote(out, panel->title);
    imki_text_put(out, " noenhanced\n");
    write_axis(out, "x", panel->x_label, panel->note, &x, drawing);
    write_axis(out, "y", panel->y_label, NULL, &y, drawing);
    write_regions(out, panel, drawing);
    if (!text)
        write_key(out, panel->key, single);
    const char *separator = "plot ";
    for (size_t c = 0; c < panel->curve_count; c++) {
        /* A band of letters would hide the points. */
        if (text && imki_curve_is_filled(&panel->curves[c]) && panel->curve_count > 1)
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

static void write_terminal(imki_text *out, const imk_figure *figure, const imki_drawing *drawing)
{
    const imki_figure_size size = imki_figure_measure(figure);
    switch (drawing->terminal) {
    case IMKI_TERMINAL_PNG:
        /* Twice the size at twice the scale: sharp on dense screens and in print. */
        imki_text_add(out,
                      "set terminal pngcairo size %d,%d background '#ffffff' "
                      "font 'DejaVu Sans,12' fontscale 1.8 linewidth 2 pointscale 2 enhanced\n",
                      2 * size.width, 2 * size.height);
        break;
    case IMKI_TERMINAL_PDF:
        imki_text_add(out,
                      "set terminal pdfcairo size %d.%02din,%d.%02din background '#ffffff' "
                      "font 'DejaVu Sans,12' enhanced\n",
                      size.width / 100, size.width % 100, size.height / 100, size.height % 100);
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
    /* A line whose ends are outside, as one across a map, is drawn where it crosses the frame. */
    imki_text_put(out, "set encoding utf8\nset clip two\n");
    write_terminal(out, figure, drawing);
    write_style(out, figure, drawing);
    const imki_figure_size grid = imki_figure_measure(figure);
    bool multiplot = figure->panel_count > 1 && drawing->terminal != IMKI_TERMINAL_TEXT;
    if (multiplot) {
        imki_text_add(out, "set multiplot layout %zu,%zu", grid.rows, grid.columns);
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
