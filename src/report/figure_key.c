/* SPDX-License-Identifier: Apache-2.0 */
/* The key of a panel: a sample of each curve and its name. */
#include "figure_internal.h"

/* [px] */
static const double sample = 22, gap = 6, between = 16;
/* Longest name, in sizes of the font: longer names are shortened. */
static const double longest_name = 30;

static bool is_named(const imk_curve *curve)
{
    return curve->label && curve->label[0];
}

imki_key imki_key_make(const imk_panel *panel, double font_size, double width, double height,
                       size_t columns_max)
{
    imki_key key = {.font_size = font_size};
    for (size_t c = 0; c < panel->curve_count; c++) {
        if (!is_named(&panel->curves[c]))
            continue;
        const double name =
            fmin(imki_line_width(panel->curves[c].label, font_size), longest_name * font_size);
        key.entry_width = fmax(key.entry_width, sample + gap + name);
        key.entries++;
    }
    if (key.entries == 0)
        return key;
    key.entry_width = fmin(key.entry_width, width);
    key.columns = (size_t)((width + between) / (key.entry_width + between));
    key.columns = key.columns < columns_max ? key.columns : columns_max;
    key.columns = key.columns < key.entries ? key.columns : key.entries;
    key.columns = key.columns > 0 ? key.columns : 1;
    key.rows = (key.entries + key.columns - 1) / key.columns;
    key.pitch = fmin(1.4 * font_size, height / (double)key.rows);
    key.font_size = fmin(font_size, key.pitch / 1.1);
    key.width = (double)key.columns * (key.entry_width + between) - between;
    key.height = (double)key.rows * key.pitch;
    return key;
}

static void put_sample(imki_text *out, const imk_curve *curve, double x, double y, double height)
{
    imki_curve_style(out, curve);
    imki_text_put(out, " d=\"");
    if (imki_curve_is_filled(curve))
        imki_text_add(out, "M%ld %ldh%ldv%ldh%ldz", imki_tenths(x), imki_tenths(y - height / 2),
                      imki_tenths(sample), imki_tenths(height), -imki_tenths(sample));
    else if (curve->style == IMK_CURVE_MARKS)
        imki_put_diamond(out, x + sample / 2, y);
    else if (curve->style == IMK_CURVE_POINTS)
        imki_text_add(out, "M%ld %ldh0", imki_tenths(x + sample / 2), imki_tenths(y));
    else
        imki_text_add(out, "M%ld %ldh%ld", imki_tenths(x), imki_tenths(y), imki_tenths(sample));
    imki_text_put(out, "\"/>\n");
}

void imki_key_draw(imki_text *out, const imki_key *key, const imk_panel *panel, double left,
                   double top)
{
    size_t entry = 0;
    for (size_t c = 0; c < panel->curve_count; c++) {
        const imk_curve *curve = &panel->curves[c];
        if (!is_named(curve))
            continue;
        const double x = left + (double)(entry % key->columns) * (key->entry_width + between);
        const double y = top + ((double)(entry / key->columns) + 0.5) * key->pitch;
        put_sample(out, curve, x, y, 0.6 * key->font_size);
        imki_svg_line(out, x + sample + gap, y + 0.35 * key->font_size, IMKI_START, key->font_size,
                      key->entry_width - sample - gap + 0.5, "", curve->label);
        entry++;
    }
}
