/* SPDX-License-Identifier: Apache-2.0 */
/* A figure as a gnuplot script that draws it in letters, and a file of numbers. Axes and colours
 * are those of our own drawings (report/figure_axes.c).
 *
 * Every text of the caller is drawn without gnuplot's markup (`noenhanced`) and quoted, so that an
 * underscore is an underscore and no label can run a command. */
#include "drawing_program_internal.h"

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

enum { NOTE_WIDEST = 84 };

static size_t note_width(const imki_drawing *drawing)
{
    const int room = drawing->width - 4;
    return room >= NOTE_WIDEST ? NOTE_WIDEST : room > 20 ? (size_t)room : 20;
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
    imki_text_add(out, "set %slabel ", name);
    quote(out, label);
    write_note(out, note, note_width(drawing));
    imki_text_add(out, " noenhanced\nset %stics autofreq\n", name);
    if (axis->logarithmic)
        imki_text_add(out, "set logscale %s 10\nset m%stics 10\nset format %s '%%.0e'\n", name,
                      name, name);
    else
        imki_text_add(out, "unset logscale %s\nset m%stics 2\nset format %s '%%g'\n", name, name,
                      name);
    range(out, name, axis);
}

static void write_curve(imki_text *out, const imk_curve *curve, size_t index, const imki_drawing *d)
{
    static const char *const styles[] = {[IMK_CURVE_LINE] = "using 1:2 with lines linewidth 2",
                                         [IMK_CURVE_POINTS] = "using 1:2 with points",
                                         [IMK_CURVE_DASHES] = "using 1:2 with lines linewidth 1.3",
                                         [IMK_CURVE_BAND] = "using 1:3:4 with filledcurves",
                                         [IMK_CURVE_LAYER] = "using 1:3:4 with filledcurves",
                                         [IMK_CURVE_MARKS] = "using 1:2 with points"};
    quote_name(out, d->data);
    imki_text_add(out, " index %zu %s %s rgb '%s'", index, styles[curve->style],
                  imki_curve_is_filled(curve) ? "fillcolor" : "linecolor",
                  imki_color(curve->color));
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

/* The frame as our own drawing would have it, in which names are placed: gnuplot does not tell the
 * size of its frame. A letter of a terminal is as large as one of a name. */
static imki_frame nominal_frame(const imk_panel *panel, const imki_drawing *drawing)
{
    const double letter = 6.2, line = 13, margin = 15;
    const char *note = panel->note;
    char noted[NOTE_WIDEST + 1];
    int lines = 8;
    while (next_line(&note, note_width(drawing), noted))
        lines++;
    imki_frame frame = {.right = (drawing->width - margin) * letter,
                        .bottom = (drawing->height - lines) * line};
    imki_panel_axes(panel, &frame.x, &frame.y);
    return frame;
}

/* Names of regions; rectangles made of letters would hide the points. */
static void write_regions(imki_text *out, const imk_panel *panel, const imki_drawing *drawing)
{
    const imki_frame frame = nominal_frame(panel, drawing);
    imki_placer placer = imki_placer_make(&frame, panel);
    imki_text_put(out, "unset label\n");
    for (size_t r = 0; r < panel->region_count; r++) {
        const imk_region *region = &panel->regions[r];
        const imki_box name = imki_region_place(&placer, &frame, region);
        imki_text_add(out, "set label %zu ", r + 1);
        quote(out, region->label);
        imki_text_put(out, " at graph ");
        const bool right = region->label_right;
        corner(out, round(1e4 * (right ? name.right : name.left) / frame.right) / 1e4,
               round(1e4 * (1 - (name.top + name.bottom) / 2 / frame.bottom)) / 1e4);
        imki_text_add(out, " %s noenhanced\n", right ? "right" : "left");
    }
}

static void write_panel(imki_text *out, const imk_panel *panel, size_t first_index,
                        const imki_drawing *drawing)
{
    imki_axis x, y;
    imki_panel_axes(panel, &x, &y);
    imki_text_put(out, "set title ");
    quote(out, panel->title);
    imki_text_put(out, " noenhanced\n");
    write_axis(out, "x", panel->x_label, panel->note, &x, drawing);
    write_axis(out, "y", panel->y_label, NULL, &y, drawing);
    write_regions(out, panel, drawing);
    const char *separator = "plot ";
    for (size_t c = 0; c < panel->curve_count; c++) {
        /* A band of letters would hide the points. */
        if (imki_curve_is_filled(&panel->curves[c]) && panel->curve_count > 1)
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

char *imki_figure_script(const imk_figure *figure, const imki_drawing *drawing, size_t *size)
{
    imki_text text = {.bytes = NULL}, *out = &text;
    /* A line whose ends are outside, as one across a map, is drawn where it crosses the frame. */
    imki_text_add(out,
                  "set encoding utf8\nset clip two\nset terminal dumb size %d,%d noenhanced %s\n"
                  "set output ",
                  drawing->width, drawing->height, drawing->color ? "ansi256" : "mono");
    quote_name(out, drawing->output);
    imki_text_put(out, "\nset key top right\nset tics nomirror\n");
    size_t index = 0;
    for (size_t p = 0; p < figure->panel_count; p++) {
        write_panel(out, &figure->panels[p], index, drawing);
        index += figure->panels[p].curve_count;
    }
    imki_text_put(out, "set output\n");
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
