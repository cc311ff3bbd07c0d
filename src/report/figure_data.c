/* SPDX-License-Identifier: Apache-2.0 */
/* The numbers of a panel as JSON, for the script of a page, which draws the panel anew when a
 * reader zooms. The points are those of the drawing. Their digits distinguish a millionth of the
 * axis, and are at least seven. */
#include "figure_internal.h"
#include "markup_internal.h"

#include "imukit/decimal.h"
#include "imukit/units.h"

#include <string.h>

enum { LEAST_DIGITS = 7, MOST_DIGITS = 17 };

static void put_number(imki_text *out, double value, int digits)
{
    char number[IMK_DECIMAL_SIZE];
    if (!isfinite(value)) {
        imki_text_put(out, "null");
        return;
    }
    number[imk_decimal_significant(value, digits, number)] = '\0';
    imki_text_put(out, number);
}

static int digits_of(const imki_axis *axis)
{
    const double largest = fmax(fabs(axis->low), fabs(axis->high));
    const double more = ceil(log10(largest / (axis->high - axis->low)));
    if (axis->logarithmic || !(more > 0))
        return LEAST_DIGITS;
    return more > MOST_DIGITS - LEAST_DIGITS ? MOST_DIGITS : LEAST_DIGITS + (int)more;
}

/* ---- curves ---------------------------------------------------------------------------------- */

/* Writes points one after another: x and y; x, y, lower and upper; of a band x, lower, upper. A
 * gap is a point of nulls. */
typedef struct writer {
    imki_visitor visitor;
    imki_text *out;
    const imk_curve *curve;
    const imk_curve *limits; /* where the interval of each point stands; NULL: nowhere */
    bool is_line;
    int x_digits, y_digits;
    size_t index, stride, written;
} writer;

static void put_value(const writer *w, double value, int digits)
{
    imki_text_put(w->out, ",");
    put_number(w->out, value, digits);
}

static void put_x(writer *w, double value)
{
    if (w->written++ > 0)
        imki_text_put(w->out, ",");
    put_number(w->out, value, w->x_digits);
}

static void write_point(imki_visitor *v, size_t index, double x, double y, bool begins)
{
    writer *w = (writer *)v;
    const imk_curve *curve = w->curve, *limits = w->limits;
    (void)x;
    (void)y;
    if (w->is_line && begins && w->written > 0) {
        put_x(w, (double)NAN);
        for (int i = 1; i < (limits ? 4 : 2); i++)
            put_value(w, (double)NAN, 1);
    }
    if (w->index++ % w->stride != 0)
        return;
    put_x(w, curve->x[index]);
    put_value(w, curve->y[index], w->y_digits);
    if (!limits)
        return;
    put_value(w, limits->lower[index], w->y_digits);
    put_value(w, limits->upper[index], w->y_digits);
}

/* What the points of one column of the drawing cover together. */
typedef struct slice_data {
    bool filled;
    long column;
    double x, lower, upper;
} slice_data;

static void put_slice(writer *w, const slice_data *s)
{
    if (!s->filled || w->index++ % w->stride != 0 || !w->out)
        return;
    put_x(w, s->x);
    put_value(w, s->lower, w->y_digits);
    put_value(w, s->upper, w->y_digits);
}

/* A writer without `out` counts. */
static void walk_band(writer *w, const imki_frame *f)
{
    const imk_curve *curve = w->curve;
    slice_data joined = {.filled = false};
    for (size_t i = 0; i < curve->count; i++) {
        imki_slice s;
        const bool drawable = imki_slice_make(f, curve, i, &s);
        if (drawable && joined.filled && imki_column(s.x) == joined.column) {
            joined.lower = fmin(joined.lower, curve->lower[i]);
            joined.upper = fmax(joined.upper, curve->upper[i]);
            continue;
        }
        put_slice(w, &joined);
        if (!drawable && joined.filled && w->out && w->written > 0)
            imki_text_put(w->out, ",null,null,null");
        joined.filled = drawable;
        if (drawable)
            joined =
                (slice_data){true, imki_column(s.x), curve->x[i], curve->lower[i], curve->upper[i]};
    }
    put_slice(w, &joined);
}

static bool is_line(const imk_curve *curve)
{
    return curve->style == IMK_CURVE_LINE || curve->style == IMK_CURVE_DASHES;
}

/* Points have their intervals themselves; points and lines have them in a band of their colour,
 * without a name, that has the same places. */
static const imk_curve *limits_of(const imk_panel *panel, const imk_curve *curve)
{
    if (!is_line(curve) && curve->lower && curve->upper)
        return curve;
    for (const imk_curve *c = panel->curves; c < panel->curves + panel->curve_count; c++) {
        bool same = c->style == IMK_CURVE_BAND && !c->label[0] && c->color == curve->color &&
                    c->count == curve->count && c->lower && c->upper;
        for (size_t i = 0; same && i < c->count; i++)
            same = c->x[i] == curve->x[i];
        if (same)
            return c;
    }
    return NULL;
}

static void put_points(writer *w, imki_text *out, const imki_frame *f)
{
    const imk_curve *curve = w->curve;
    if (imki_curve_is_filled(curve)) {
        walk_band(w, f);
        w->stride = imki_stride_for(w->index);
        w->index = 0;
        w->out = out;
        walk_band(w, f);
        return;
    }
    w->out = out;
    if (w->is_line) {
        w->stride = imki_line_stride(f, curve);
        imki_line_walk(f, curve, &w->visitor);
    } else if (!imki_points_walk(f, curve, &w->visitor)) {
        out->failed = true;
    }
}

static void put_curve(imki_text *out, const imki_frame *f, const imk_panel *panel,
                      const imk_curve *curve)
{
    static const char *const styles[] = {"line", "points", "dashes", "band", "layer", "marks"};
    const bool filled = imki_curve_is_filled(curve);
    const imk_curve *limits = filled ? NULL : limits_of(panel, curve);
    writer w = {.visitor = {write_point},
                .curve = curve,
                .limits = limits,
                .is_line = is_line(curve),
                .x_digits = digits_of(&f->x),
                .y_digits = digits_of(&f->y),
                .stride = 1};
    imki_text_put(out, "{\"label\":");
    imki_markup_quote(out, curve->label);
    imki_text_add(out, ",\"style\":\"%s\",\"color\":%u,\"bars\":%s,\"width\":%d,\"points\":[",
                  styles[curve->style], (unsigned)curve->color % IMKI_PALETTE_SIZE,
                  limits == curve ? "true" : "false",
                  filled   ? 3
                  : limits ? 4
                           : 2);
    put_points(&w, out, f);
    imki_text_put(out, "]}");
}

/* ---- a panel --------------------------------------------------------------------------------- */

static void put_axis(imki_text *out, const char *name, const char *label, const imki_axis *axis)
{
    imki_text_add(out, "\"%s\":{\"label\":", name);
    imki_markup_quote(out, label ? label : "");
    imki_text_add(out, ",\"log\":%s,\"low\":", axis->logarithmic ? "true" : "false");
    put_number(out, axis->low, MOST_DIGITS);
    imki_text_put(out, ",\"high\":");
    put_number(out, axis->high, MOST_DIGITS);
    imki_text_put(out, "},");
}

static void put_region(imki_text *out, const imk_region *r)
{
    const double limits[] = {r->x_low, r->x_high, r->y_low, r->y_high};
    imki_text_put(out, "{\"label\":");
    imki_markup_quote(out, r->label);
    imki_text_add(out, ",\"color\":%u,\"right\":%s,\"dashed\":%s,\"limits\":[",
                  (unsigned)r->color % IMKI_PALETTE_SIZE, r->label_right ? "true" : "false",
                  r->dashed ? "true" : "false");
    for (int i = 0; i < 4; i++) {
        imki_text_put(out, i > 0 ? "," : "");
        put_number(out, limits[i], LEAST_DIGITS);
    }
    imki_text_put(out, "]}");
}

/* The unit in brackets at the end of an axis' label, so that curves in other units can be laid
 * over: its size in SI units, and these. */
static void put_unit(imki_text *out, const char *label)
{
    const char *open = label ? strrchr(label, '[') : NULL, *close = open ? strchr(open, ']') : NULL;
    imk_unit unit;
    imk_error error;
    char si[64];
    if (!close || imk_unit_parse(open + 1, close, &unit, &error) != IMK_OK ||
        imk_dimension_si(unit.dimension, si, sizeof si) == 0)
        return;
    imki_text_put(out, "\"unit\":{\"scale\":");
    put_number(out, unit.scale, MOST_DIGITS);
    imki_text_put(out, ",\"si\":");
    imki_markup_quote(out, si);
    imki_text_put(out, "},");
}

void imki_panel_data(imki_text *out, const imk_panel *panel, bool alone)
{
    const imki_frame f = imki_panel_frame(panel, alone);
    imki_text_put(out, "{\"title\":");
    imki_markup_quote(out, panel->title ? panel->title : "");
    imki_text_put(out, ",\"note\":");
    imki_markup_quote(out, panel->note ? panel->note : "");
    imki_text_put(out, ",");
    put_axis(out, "x", panel->x_label, &f.x);
    put_axis(out, "y", panel->y_label, &f.y);
    if (panel->allan_deviation) {
        imki_text_put(out, "\"allan\":true,");
        put_unit(out, panel->y_label);
    }
    imki_text_put(out, "\"curves\":[");
    for (size_t c = 0; c < panel->curve_count; c++) {
        imki_text_put(out, c > 0 ? ",\n" : "");
        put_curve(out, &f, panel, &panel->curves[c]);
    }
    imki_text_put(out, "],\"regions\":[");
    for (size_t r = 0; r < panel->region_count; r++) {
        imki_text_put(out, r > 0 ? ",\n" : "");
        put_region(out, &panel->regions[r]);
    }
    imki_text_put(out, "]}");
}
