/* SPDX-License-Identifier: Apache-2.0 */
/* Moving parts of a schematic: groups with what a page moves them by, or with their places at the
 * moments of an animation. */
#include "schematic_internal.h"

#include "imukit/decimal.h"

#include <math.h>
#include <string.h>

static bool scales(imk_move move)
{
    return move == IMK_MOVE_STRETCH_X || move == IMK_MOVE_STRETCH_Y || move == IMK_MOVE_SQUEEZE;
}

static void put_number(imki_text *out, const char *name, double value)
{
    char text[IMK_DECIMAL_SIZE];
    imk_decimal_shortest(value, text);
    imki_text_add(out, " %s=\"%s\"", name, text);
}

/* ` translate(x y)` about which a part is stretched; before it with the sign -1. */
static void put_translated(imki_drawing *d, const imk_schematic_part *p, int sign)
{
    imki_text_put(&d->text, sign > 0 ? "<g class=\"s-elastic\" transform=\"translate("
                                     : "<g transform=\"translate(");
    imki_put_tenths(&d->text, sign * p->x);
    imki_text_put_char(&d->text, ' ');
    imki_put_tenths(&d->text, sign * p->y);
    imki_text_put(&d->text, ")\">");
}

/* The value of a part as the number of its transform. */
static void put_value(imki_text *out, const imk_schematic_part *p, double value)
{
    char text[IMK_DECIMAL_SIZE];
    const double least = 1e-3; /* of a stretch */
    if (p->move == IMK_MOVE_STRETCH_X || p->move == IMK_MOVE_STRETCH_Y)
        value = fabs(value) >= least ? value : value < 0 ? -least : least;
    if (p->move == IMK_MOVE_GLOW)
        value = fmin(fmax(value, 0), 1);
    imk_decimal_fixed(value, scales(p->move) || p->move == IMK_MOVE_GLOW ? 3 : 1, text);
    char *end = text + strlen(text);
    while (strchr(text, '.') && (end[-1] == '0' || end[-1] == '.')) { /* 1.500, 2.0 */
        const bool point = *--end == '.';
        *end = '\0';
        if (point)
            break;
    }
    imki_text_put(out, strcmp(text, "-0") == 0 ? "0" : text);
}

/* All numbers of a transform: "12 270 200". */
static void put_numbers(imki_text *out, const imk_schematic_part *p, double value)
{
    switch (p->move) {
    case IMK_MOVE_TURN:
        put_value(out, p, value);
        imki_text_put_char(out, ' ');
        imki_put_tenths(out, p->x);
        imki_text_put_char(out, ' ');
        imki_put_tenths(out, p->y);
        break;
    case IMK_MOVE_SHIFT_Y:
        imki_text_put(out, "0 ");
        put_value(out, p, value);
        break;
    case IMK_MOVE_STRETCH_Y:
        imki_text_put(out, "1 ");
        put_value(out, p, value);
        break;
    case IMK_MOVE_STRETCH_X:
        put_value(out, p, value);
        imki_text_put(out, " 1");
        break;
    case IMK_MOVE_SQUEEZE:
        put_value(out, p, 1 + value);
        imki_text_put_char(out, ' ');
        put_value(out, p, 1 - value);
        break;
    default:
        put_value(out, p, value);
    }
}

static const char *transform_of(imk_move move)
{
    return move == IMK_MOVE_TURN ? "rotate" : scales(move) ? "scale" : "translate";
}

/* Where the part is in the still drawing. */
static void put_still(imki_drawing *d, const imk_schematic_part *p, double value)
{
    if (p->move == IMK_MOVE_FLOW || p->move == IMK_MOVE_GLOW) {
        imki_text_add(&d->text, " %s=\"",
                      p->move == IMK_MOVE_FLOW ? "stroke-dashoffset" : "opacity");
        put_value(&d->text, p, value);
        imki_text_put_char(&d->text, '"');
        return;
    }
    imki_text_add(&d->text, " transform=\"%s(", transform_of(p->move));
    put_numbers(&d->text, p, value);
    imki_text_put(&d->text, ")\"");
}

/* And where it is at the moments of an animation. */
static void put_film(imki_drawing *d, const imk_schematic_part *p, const double *value)
{
    imki_text *out = &d->text;
    if (p->move == IMK_MOVE_FLOW || p->move == IMK_MOVE_GLOW)
        imki_text_add(out, "<animate attributeName=\"%s\"",
                      p->move == IMK_MOVE_FLOW ? "stroke-dashoffset" : "opacity");
    else
        imki_text_add(out, "<animateTransform attributeName=\"transform\" type=\"%s\"",
                      transform_of(p->move));
    imki_text_add(out, " dur=\"%ldms\" repeatCount=\"indefinite\" values=\"",
                  d->film->milliseconds);
    for (size_t k = 0; k < d->film->frames; k++) {
        imki_text_put(out, k > 0 ? ";" : "");
        put_numbers(out, p, value[k]);
    }
    imki_text_put(out, "\"/>\n");
}

void imki_part_begin(imki_drawing *d, size_t part)
{
    const imk_schematic_part *p = &d->schematic->parts[part];
    if (scales(p->move))
        put_translated(d, p, 1);
    imki_text_put(&d->text, "<g");
    if (!d->film) {
        imki_text_add(&d->text, " id=\"%s\" class=\"part\" data-move=\"%s\" data-signal=\"%s\"",
                      p->id, imk_move_name(p->move), p->signal);
        put_number(&d->text, "data-gain", imk_schematic_gain(d->schematic, d->design, part));
        put_number(&d->text, "data-base", p->base);
        imki_text_put(&d->text, " data-origin=\"");
        imki_put_tenths(&d->text, p->x);
        imki_text_put_char(&d->text, ' ');
        imki_put_tenths(&d->text, p->y);
        imki_text_put_char(&d->text, '"');
    }
    put_still(d, p, imki_still_value(d->schematic, d->design, part));
    imki_text_put(&d->text, ">\n");
    if (d->film)
        put_film(d, p, d->film->value + part * d->film->frames);
    if (scales(p->move))
        put_translated(d, p, -1);
    d->begun[d->depth++] = (int)part;
}

void imki_part_end(imki_drawing *d)
{
    const imk_schematic_part *p = &d->schematic->parts[d->begun[--d->depth]];
    imki_text_put(&d->text, scales(p->move) ? "</g></g></g>\n" : "</g>\n");
}
