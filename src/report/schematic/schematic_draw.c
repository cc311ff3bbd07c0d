/* SPDX-License-Identifier: Apache-2.0 */
/* The shapes that schematics consist of, as SVG. */
#include "schematic_internal.h"

#include "imukit/elementary.h"

#include <math.h>

static const double degree = 3.14159265358979323846 / 180;

/* ---- numbers --------------------------------------------------------------------------------- */

void imki_put_tenths(imki_text *out, double value)
{
    long tenths = lround(value * 10);
    if (tenths < 0)
        imki_text_put_char(out, '-');
    tenths = tenths < 0 ? -tenths : tenths;
    imki_text_add(out, "%ld", tenths / 10);
    if (tenths % 10 != 0)
        imki_text_add(out, ".%ld", tenths % 10);
}

static void put_attribute(imki_drawing *d, const char *name, double value)
{
    imki_text_add(&d->text, " %s=\"", name);
    imki_put_tenths(&d->text, value);
    imki_text_put_char(&d->text, '"');
}

static void put_point(imki_drawing *d, char command, double x, double y)
{
    imki_text_put_char(&d->text, command);
    imki_put_tenths(&d->text, x);
    imki_text_put_char(&d->text, ' ');
    imki_put_tenths(&d->text, y);
}

/* `<path class="s-mass s-rim`, of the classes "mass rim". */
static void put_shape(imki_drawing *d, const char *shape, const char *class)
{
    imki_text_add(&d->text, "<%s class=\"s-", shape);
    for (const char *c = class; *c; c++) {
        imki_text_put_char(&d->text, *c);
        imki_text_put(&d->text, *c == ' ' ? "s-" : "");
    }
    imki_text_put_char(&d->text, '"');
}

/* ---- groups ---------------------------------------------------------------------------------- */

void imki_dashes_begin(imki_drawing *d, double dash, double gap)
{
    imki_text_put(&d->text, "<g stroke-dasharray=\"");
    imki_put_tenths(&d->text, dash);
    imki_text_put_char(&d->text, ' ');
    imki_put_tenths(&d->text, gap);
    imki_text_put(&d->text, "\">\n");
}

void imki_turned_begin(imki_drawing *d, double degrees, double x, double y)
{
    imki_text_put(&d->text, "<g transform=\"rotate(");
    imki_put_tenths(&d->text, degrees);
    put_point(d, ' ', x, y);
    imki_text_put(&d->text, ")\">\n");
}

void imki_window_begin(imki_drawing *d, const char *name, double x, double y, double width,
                       double height)
{
    const char *copy = d->film ? "-moving" : "";
    imki_text_add(&d->text, "<clipPath id=\"%s%s\"><rect", name, copy);
    put_attribute(d, "x", x);
    put_attribute(d, "y", y);
    put_attribute(d, "width", width);
    put_attribute(d, "height", height);
    imki_text_add(&d->text, "/></clipPath><g clip-path=\"url(#%s%s)\">\n", name, copy);
}

void imki_group_end(imki_drawing *d)
{
    imki_text_put(&d->text, "</g>\n");
}

/* ---- shapes ---------------------------------------------------------------------------------- */

void imki_draw_line(imki_drawing *d, const char *class, double x1, double y1, double x2, double y2)
{
    put_shape(d, "path", class);
    imki_text_put(&d->text, " d=\"");
    put_point(d, 'M', x1, y1);
    put_point(d, 'L', x2, y2);
    imki_text_put(&d->text, "\"/>\n");
}

void imki_draw_circle(imki_drawing *d, const char *class, double x, double y, double radius)
{
    put_shape(d, "circle", class);
    put_attribute(d, "cx", x);
    put_attribute(d, "cy", y);
    put_attribute(d, "r", radius);
    imki_text_put(&d->text, "/>\n");
}

void imki_draw_ellipse(imki_drawing *d, const char *class, double x, double y, double rx, double ry)
{
    put_shape(d, "ellipse", class);
    put_attribute(d, "cx", x);
    put_attribute(d, "cy", y);
    put_attribute(d, "rx", rx);
    put_attribute(d, "ry", ry);
    imki_text_put(&d->text, "/>\n");
}

void imki_draw_box(imki_drawing *d, const char *class, double x, double y, double width,
                   double height, double corner)
{
    put_shape(d, "rect", class);
    put_attribute(d, "x", x);
    put_attribute(d, "y", y);
    put_attribute(d, "width", width);
    put_attribute(d, "height", height);
    if (corner > 0)
        put_attribute(d, "rx", corner);
    imki_text_put(&d->text, "/>\n");
}

void imki_draw_path(imki_drawing *d, const char *class, const char *data)
{
    put_shape(d, "path", class);
    imki_text_add(&d->text, " d=\"%s\"/>\n", data);
}

void imki_draw_polygon(imki_drawing *d, const char *class, size_t count, const double *points,
                       bool closed)
{
    put_shape(d, "path", class);
    imki_text_put(&d->text, " d=\"");
    for (size_t i = 0; i < count; i++)
        put_point(d, i == 0 ? 'M' : 'L', points[2 * i], points[2 * i + 1]);
    imki_text_put(&d->text, closed ? "Z\"/>\n" : "\"/>\n");
}

void imki_draw_head(imki_drawing *d, const char *class, double at_x, double at_y, double x,
                    double y)
{
    const double length = 12, half = 4.5;
    imki_text_add(&d->text, "<path class=\"s-head s-%s\" d=\"", class);
    put_point(d, 'M', at_x, at_y);
    put_point(d, 'L', at_x - length * x + half * y, at_y - length * y - half * x);
    put_point(d, 'L', at_x - length * x - half * y, at_y - length * y + half * x);
    imki_text_put(&d->text, "Z\"/>\n");
}

void imki_draw_arrow(imki_drawing *d, const char *class, double x1, double y1, double x2, double y2)
{
    const double length = sqrt((x2 - x1) * (x2 - x1) + (y2 - y1) * (y2 - y1));
    const double x = (x2 - x1) / length, y = (y2 - y1) / length;
    imki_draw_line(d, class, x1, y1, x2 - 8 * x, y2 - 8 * y);
    imki_draw_head(d, class, x2, y2, x, y);
}

void imki_draw_turn(imki_drawing *d, const char *class, double x, double y, double radius,
                    double from, double to)
{
    const double way = to > from ? 1 : -1;
    const double end = to - way * 9 / radius / degree; /* the head covers the rest */
    const bool large = fabs(end - from) > 180;
    put_shape(d, "path", class);
    imki_text_put(&d->text, " d=\"");
    put_point(d, 'M', x + radius * imk_cos(from * degree), y + radius * imk_sin(from * degree));
    put_point(d, 'A', radius, radius);
    imki_text_add(&d->text, " 0 %d %d", large, way > 0);
    put_point(d, ' ', x + radius * imk_cos(end * degree), y + radius * imk_sin(end * degree));
    imki_text_put(&d->text, "\"/>\n");
    /* the head is straight: its direction is that of the circle in its middle */
    const double middle = (to - way * 5 / radius / degree) * degree;
    imki_draw_head(d, class, x + radius * imk_cos(to * degree), y + radius * imk_sin(to * degree),
                   -way * imk_sin(middle), way * imk_cos(middle));
}

void imki_draw_spring(imki_drawing *d, double x1, double y1, double x2, double y2, int turns,
                      double width)
{
    const double length = sqrt((x2 - x1) * (x2 - x1) + (y2 - y1) * (y2 - y1));
    const double x = (x2 - x1) / length, y = (y2 - y1) / length, step = length / (4.0 * turns);
    imki_text_put(&d->text, "<path class=\"s-spring\" d=\"");
    put_point(d, 'M', x1, y1);
    for (int i = 0; i < 2 * turns; i++) {
        const double along = (2 * i + 1) * step, aside = i % 2 == 0 ? width : -width;
        put_point(d, 'L', x1 + along * x - aside * y, y1 + along * y + aside * x);
    }
    put_point(d, 'L', x2, y2);
    imki_text_put(&d->text, "\"/>\n");
}

void imki_draw_anchor(imki_drawing *d, double x1, double y1, double x2, double y2)
{
    const double length = sqrt((x2 - x1) * (x2 - x1) + (y2 - y1) * (y2 - y1));
    const double x = (x2 - x1) / length, y = (y2 - y1) / length, distance = 8;
    const int count = (int)floor(length / distance);
    imki_text_put(&d->text, "<path class=\"s-hatch\" d=\"");
    for (int i = 0; i <= count; i++) {
        const double along = (length - count * distance) / 2 + i * distance;
        put_point(d, 'M', x1 + along * x, y1 + along * y);
        put_point(d, 'L', x1 + (along - 6) * x - 8 * y, y1 + (along - 6) * y + 8 * x);
    }
    imki_text_put(&d->text, "\"/>\n");
    imki_draw_line(d, "line", x1, y1, x2, y2);
}
