/* SPDX-License-Identifier: Apache-2.0 */
/* A path with a point that walks along it, as an SVG that moves by itself (SMIL).
 *
 * The drawing is in whole tenths of a pixel, so that it contains no decimal point and does not
 * depend on the locale. The walker follows the path by the length s(t) that has been walked
 * (keyPoints); its trail is a dash of the same path, whose offset is w - s(t). Where the path
 * jumps, dots hop instead. */
#include "markup_internal.h"

#include "imukit/names.h"
#include "imukit/report.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum {
    WIDTH = 7200,
    HEIGHT = 5200,
    LEFT = 950,
    RIGHT = 250,
    TOP = 500,
    BOTTOM = 850,
    POINTS_MAX = 4000, /* of a path */
    KEYS = 400,        /* moments for which the walker's place is written */
    HOPS_MAX = 600,
    GHOSTS = 5, /* dots that follow a hopping one */
    TRAIL_MAX = 6000
};

static const char blue[] = "#0072b2", orange[] = "#d55e00"; /* of the palette of figures */

/* As in figures: values with a smaller relative or absolute difference are drawn as equal, and the
 * largest number of an axis keeps its length finite. */
static const double least_part = 1e-9, least_span = 1e-290, largest = 1e300;

typedef struct axis {
    double low, high; /* of the data, with some air */
    int begin, end;   /* on the drawing */
} axis;

typedef struct drawing {
    const imk_animation *animation;
    axis x, y;
    size_t count;   /* points of the path */
    size_t *sample; /* sample of the animation at which each point is reached */
    size_t *last;   /* and left: some stay */
    int *px, *py;   /* tenths of a pixel */
    double *walked; /* length up to each */
} drawing;

static void span_values(axis *a, const double *values, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        a->low = fmin(a->low, values[i]);
        a->high = fmax(a->high, values[i]);
    }
}

/* Of the values of the path and of the line behind it. */
static axis axis_make(const imk_animation *animation, bool upwards, int begin, int end)
{
    const double *values = upwards ? animation->y : animation->x;
    axis a = {values[0], values[0], begin, end};
    span_values(&a, values, animation->count);
    span_values(&a, upwards ? animation->law_y : animation->law_x, animation->law_count);
    a.low = fmin(fmax(a.low, -largest), largest);
    a.high = fmin(fmax(a.high, -largest), largest);
    const double span = a.high - a.low;
    const double least = fmax(least_span, least_part * fmax(fabs(a.low), fabs(a.high)));
    const double air = span > 0 ? 0.05 * span : fmax(0.1 * fabs(a.high), 0.1);
    a.low -= fmax(air, 0.5 * (least - span));
    a.high += fmax(air, 0.5 * (least - span));
    return a;
}

static int place(const axis *a, double value)
{
    const double part = fmin(fmax((value - a->low) / (a->high - a->low), 0), 1);
    return (int)lround(a->begin + part * (a->end - a->begin));
}

/* Distance of ticks, 1, 2 or 5 times a power of ten: four to ten of them. */
static double tick_distance(const axis *a)
{
    const double rough = (a->high - a->low) / 5, power = pow(10, floor(log10(rough)));
    const double digit = rough / power;
    return power * (digit < 2 ? 1 : digit < 5 ? 2 : 5);
}

/* "0.3", without the rounding error of a multiple of the distance; with more than six digits if
 * fewer do not part the ticks of this axis. */
static void put_number(imki_text *out, const axis *a, double value, double distance)
{
    char text[40];
    const double most = fmax(fabs(a->low), fabs(a->high));
    const int digits = (int)(floor(log10(most)) - floor(log10(distance))) + 1;
    snprintf(text, sizeof text, "%.*g", digits > 6 ? digits : 6,
             fabs(value) < 1e-6 * distance ? 0.0 : value);
    for (char *c = text; *c; c++)
        imki_text_put_char(out, *c == ',' ? '.' : *c);
}

/* Ticks are counted by whole numbers: the sum of a value and a distance may be the same value. */
static void put_axes(imki_text *out, const drawing *d)
{
    const double dx = tick_distance(&d->x), dy = tick_distance(&d->y);
    for (double n = ceil(d->x.low / dx); n <= floor(d->x.high / dx); n++) {
        const int at = place(&d->x, n * dx);
        imki_text_add(out, "<path class=\"grid\" d=\"M%d %dV%d\"/><text x=\"%d\" y=\"%d\">", at,
                      TOP, HEIGHT - BOTTOM, at, HEIGHT - BOTTOM + 190);
        put_number(out, &d->x, n * dx, dx);
        imki_text_put(out, "</text>\n");
    }
    for (double n = ceil(d->y.low / dy); n <= floor(d->y.high / dy); n++) {
        const int at = place(&d->y, n * dy);
        imki_text_add(out,
                      "<path class=\"grid\" d=\"M%d %dH%d\"/>"
                      "<text x=\"%d\" y=\"%d\" text-anchor=\"end\">",
                      LEFT, at, WIDTH - RIGHT, LEFT - 70, at + 40);
        put_number(out, &d->y, n * dy, dy);
        imki_text_put(out, "</text>\n");
    }
    imki_text_add(out,
                  "<path fill=\"none\" stroke=\"#666\" stroke-width=\"10\" d=\"M%d %dV%dH%d\"/>\n",
                  LEFT, TOP, HEIGHT - BOTTOM, WIDTH - RIGHT);
}

static void put_text(imki_text *out, int x, int y, const char *attributes, const char *text)
{
    imki_text_add(out, "<text x=\"%d\" y=\"%d\"%s>", x, y, attributes);
    imki_markup_escape(out, text);
    imki_text_put(out, "</text>\n");
}

static void put_head(imki_text *out, const drawing *d)
{
    const int middle = (LEFT + WIDTH - RIGHT) / 2, height = (TOP + HEIGHT - BOTTOM) / 2;
    char turned[60];
    imki_text_add(
        out,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" xmlns:xlink=\"http://www.w3.org/1999/xlink\""
        " width=\"%d\" height=\"%d\" viewBox=\"0 0 %d %d\" role=\"img\" aria-label=\"",
        WIDTH / 10, HEIGHT / 10, WIDTH, HEIGHT);
    imki_markup_escape(out, d->animation->title);
    imki_text_add(
        out,
        "\" font-family=\"DejaVu Sans,Verdana,sans-serif\" font-size=\"120\" fill=\"#333\" "
        "text-anchor=\"middle\">\n"
        "<style>.grid{stroke:#d4d4d4;stroke-width:8}"
        "@media (prefers-reduced-motion:reduce){.moving{display:none}}"
        "@media print{.moving{display:none}}</style>\n"
        "<rect width=\"%d\" height=\"%d\" fill=\"#fff\"/>\n",
        WIDTH, HEIGHT);
    put_axes(out, d);
    put_text(out, middle, 300, "", d->animation->title);
    put_text(out, middle, HEIGHT - BOTTOM + 430, "", d->animation->x_label);
    snprintf(turned, sizeof turned, " transform=\"rotate(-90 250 %d)\"", height);
    put_text(out, 250, height, turned, d->animation->y_label);
}

/* A bar that grows while a round passes. */
static void put_clock(imki_text *out, const drawing *d, int milliseconds)
{
    const int y = HEIGHT - 130, length = WIDTH - RIGHT - LEFT;
    if (!d->animation->clock || !d->animation->clock[0])
        return;
    imki_text_put(out, "<g class=\"moving\">\n");
    imki_text_add(out, "<rect x=\"%d\" y=\"%d\" width=\"%d\" height=\"30\" fill=\"#e6e9eb\"/>\n",
                  LEFT, y, length);
    imki_text_add(
        out,
        "<rect x=\"%d\" y=\"%d\" width=\"0\" height=\"30\" fill=\"%s\"><animate "
        "attributeName=\"width\" values=\"0;%d\" dur=\"%dms\" repeatCount=\"indefinite\"/>"
        "</rect>\n",
        LEFT, y, orange, length, milliseconds);
    put_text(out, WIDTH - RIGHT, y - 60, " text-anchor=\"end\" font-size=\"105\"",
             d->animation->clock);
    imki_text_put(out, "</g>\n");
}

/* ---- a path that is walked ------------------------------------------------------------------- */

/* A part of one in millionths. */
static void put_part(imki_text *out, double part)
{
    const long millionths = lround(part * 1e6);
    if (millionths >= 1000000)
        imki_text_put_char(out, '1');
    else
        imki_text_add(out, "0.%06ld", millionths);
}

/* Length walked at a moment, 0 … 1 of the round. */
static double walked_at(const drawing *d, double moment)
{
    const double sample = moment * (double)(d->animation->count - 1);
    size_t low = 0, high = d->count - 1;
    while (high - low > 1) {
        const size_t middle = (low + high) / 2;
        if ((double)d->sample[middle] <= sample)
            low = middle;
        else
            high = middle;
    }
    const double from = (double)d->last[low], to = (double)d->sample[high];
    const double part = to > from ? fmin(fmax((sample - from) / (to - from), 0), 1) : 0;
    return d->walked[low] + part * (d->walked[high] - d->walked[low]);
}

static void put_walk(imki_text *out, const drawing *d, int milliseconds)
{
    const double length = d->walked[d->count - 1], trail = fmin(length / 8, TRAIL_MAX);
    imki_text_add(out,
                  "<defs><path id=\"track\" fill=\"none\" stroke-linejoin=\"round\" d=\"M%d %d",
                  d->px[0], d->py[0]);
    for (size_t i = 1; i < d->count; i++)
        imki_text_add(out, "l%d %d", d->px[i] - d->px[i - 1], d->py[i] - d->py[i - 1]);
    imki_text_add(out,
                  "\"/></defs>\n<use href=\"#track\" xlink:href=\"#track\" stroke=\"%s\" "
                  "stroke-opacity=\"0.5\" stroke-width=\"12\"/>\n<g class=\"moving\">\n",
                  blue);
    imki_text_add(out,
                  "<use href=\"#track\" xlink:href=\"#track\" stroke=\"%s\" "
                  "stroke-width=\"24\" stroke-dasharray=\"%ld %ld\" stroke-dashoffset=\"%ld\">"
                  "<animate attributeName=\"stroke-dashoffset\" dur=\"%dms\" "
                  "repeatCount=\"indefinite\" values=\"",
                  orange, lround(trail), lround(length + trail + 10), lround(trail), milliseconds);
    for (int k = 0; k <= KEYS; k++)
        imki_text_add(out, "%s%ld", k > 0 ? ";" : "",
                      lround(trail - walked_at(d, (double)k / KEYS)));
    imki_text_add(out,
                  "\"/></use>\n<circle r=\"60\" fill=\"%s\" fill-opacity=\"0\">"
                  "<set attributeName=\"fill-opacity\" to=\"1\"/><animateMotion dur=\"%dms\" "
                  "repeatCount=\"indefinite\" calcMode=\"linear\" keyTimes=\"",
                  orange, milliseconds);
    for (int k = 0; k <= KEYS; k++) {
        imki_text_put(out, k > 0 ? ";" : "");
        put_part(out, (double)k / KEYS);
    }
    imki_text_put(out, "\" keyPoints=\"");
    for (int k = 0; k <= KEYS; k++) {
        imki_text_put(out, k > 0 ? ";" : "");
        put_part(out, walked_at(d, (double)k / KEYS) / length);
    }
    imki_text_put(
        out, "\"><mpath href=\"#track\" xlink:href=\"#track\"/></animateMotion></circle>\n</g>\n");
}

/* ---- a path that jumps ----------------------------------------------------------------------- */

static void put_hops(imki_text *out, const drawing *d, const char *attribute, const int *places,
                     int milliseconds, int delay)
{
    const size_t stride = d->count / HOPS_MAX + 1;
    imki_text_add(out,
                  "<animate attributeName=\"%s\" calcMode=\"discrete\" dur=\"%dms\" begin=\"%dms\" "
                  "repeatCount=\"indefinite\" values=\"",
                  attribute, milliseconds, delay);
    for (size_t i = 0; i < d->count; i += stride)
        imki_text_add(out, "%s%d", i > 0 ? ";" : "", places[i]);
    imki_text_put(out, "\" keyTimes=\"");
    for (size_t i = 0; i < d->count; i += stride) {
        imki_text_put(out, i > 0 ? ";" : "");
        put_part(out, (double)d->sample[i] / (double)d->animation->count);
    }
    imki_text_put(out, "\"/>");
}

static void put_jumps(imki_text *out, const drawing *d, int milliseconds)
{
    const size_t hops = d->count < HOPS_MAX ? d->count : HOPS_MAX;
    const int hop = milliseconds / (int)hops;
    imki_text_add(out,
                  "<path fill=\"none\" stroke=\"%s\" stroke-opacity=\"0.45\" stroke-width=\"50\" "
                  "stroke-linecap=\"round\" d=\"",
                  blue);
    for (size_t i = 0; i < d->count; i++)
        imki_text_add(out, "M%d %dh0", d->px[i], d->py[i]);
    imki_text_put(out, "\"/>\n<g class=\"moving\">\n");
    for (int ghost = GHOSTS; ghost >= 0; ghost--) {
        imki_text_add(out,
                      "<circle cx=\"%d\" cy=\"%d\" r=\"%d\" fill=\"%s\" fill-opacity=\"0.%d\">",
                      d->px[0], d->py[0], ghost > 0 ? 55 : 75, orange, ghost > 0 ? 6 - ghost : 95);
        put_hops(out, d, "cx", d->px, milliseconds, ghost * hop);
        put_hops(out, d, "cy", d->py, milliseconds, ghost * hop);
        imki_text_put(out, "</circle>\n");
    }
    imki_text_put(out, "</g>\n");
}

/* ---- all of it ------------------------------------------------------------------------------- */

static imk_status check(const imk_animation *animation, imk_error *error)
{
    if (!animation || animation->count < 2)
        return imk_error_set(error, IMK_ERROR_EMPTY, "animation", "less than two points",
                             "points to draw");
    if (!(animation->duration >= 1 && animation->duration <= 3600))
        return imk_error_set(error, IMK_ERROR_RANGE, "duration", NULL, "1 to 3600 seconds");
    for (size_t i = 0; i < animation->count; i++)
        if (!isfinite(animation->x[i]) || !isfinite(animation->y[i]))
            return imk_error_set(error, IMK_ERROR_NOT_FINITE, "animation", "a point is not finite",
                                 "finite numbers");
    return IMK_OK;
}

/* The line behind the path. */
static void put_law(imki_text *out, const drawing *d)
{
    const imk_animation *a = d->animation;
    if (a->law_count == 0)
        return;
    imki_text_put(out, "<path fill=\"none\" stroke=\"#999\" stroke-width=\"18\" d=\"");
    for (size_t i = 0; i < a->law_count; i++)
        imki_text_add(out, "%c%d %d", i == 0 ? 'M' : 'L', place(&d->x, a->law_x[i]),
                      place(&d->y, a->law_y[i]));
    imki_text_put(out, "\"/>\n");
}

/* The points of the path in tenths of a pixel, without points that fall on the previous one. */
static bool drawing_make(drawing *d, const imk_animation *animation)
{
    const size_t stride = (animation->count + POINTS_MAX - 1) / POINTS_MAX;
    const size_t room = animation->count / stride + 1;
    *d = (drawing){.animation = animation,
                   .x = axis_make(animation, false, LEFT, WIDTH - RIGHT),
                   .y = axis_make(animation, true, HEIGHT - BOTTOM, TOP),
                   .sample = malloc(room * sizeof *d->sample),
                   .last = malloc(room * sizeof *d->last),
                   .px = malloc(room * sizeof *d->px),
                   .py = malloc(room * sizeof *d->py),
                   .walked = malloc(room * sizeof *d->walked)};
    if (!d->sample || !d->last || !d->px || !d->py || !d->walked)
        return false;
    for (size_t i = 0; i < animation->count; i += stride) {
        const int x = place(&d->x, animation->x[i]), y = place(&d->y, animation->y[i]);
        const size_t n = d->count;
        if (n > 0 && x == d->px[n - 1] && y == d->py[n - 1]) {
            d->last[n - 1] = i;
            continue;
        }
        d->sample[n] = d->last[n] = i;
        d->px[n] = x;
        d->py[n] = y;
        d->walked[n] = n > 0 ? d->walked[n - 1] + hypot(x - d->px[n - 1], y - d->py[n - 1]) : 0;
        d->count++;
    }
    return true;
}

static void drawing_free(drawing *d)
{
    free(d->sample);
    free(d->last);
    free(d->px);
    free(d->py);
    free(d->walked);
}

imk_status imk_animation_svg(const imk_animation *animation, char **svg, size_t *size,
                             imk_error *error)
{
    drawing d;
    imki_text text = {.bytes = NULL}, *out = &text;
    imk_status status = check(animation, error);
    if (status != IMK_OK)
        return status;
    if (!drawing_make(&d, animation))
        text.failed = true;
    else if (d.count < 2)
        status = imk_error_set(error, IMK_ERROR_EMPTY, "animation", "nothing moves",
                               "points at different places");
    if (!text.failed && status == IMK_OK) {
        const int milliseconds = (int)lround(1000 * animation->duration);
        put_head(out, &d);
        put_law(out, &d);
        if (animation->points)
            put_jumps(out, &d, milliseconds);
        else
            put_walk(out, &d, milliseconds);
        put_clock(out, &d, milliseconds);
        imki_text_put(out, "</svg>\n");
    }
    drawing_free(&d);
    if (status != IMK_OK)
        return status;
    char *made = imki_text_take(out, size);
    if (!made)
        return imk_error_set(error, IMK_ERROR_MEMORY, "animation", NULL, NULL);
    *svg = made;
    return IMK_OK;
}
