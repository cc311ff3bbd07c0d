/* SPDX-License-Identifier: Apache-2.0 */
/* The words of schematics: names, scales, times. */
#include "report/markup_internal.h"
#include "schematic_internal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* ---- texts ----------------------------------------------------------------------------------- */

/* The end of what `_` or `^` lowers or raises: one character, or what braces hold. */
static const char *end_of(const char *text)
{
    if (*text == '{')
        return strchr(text, '}');
    text++;
    while (((unsigned char)*text & 0xC0) == 0x80)
        text++;
    return text;
}

static void put_piece(imki_text *out, const char *begin, const char *end)
{
    char piece[200];
    const size_t length = (size_t)(end - begin) < sizeof piece ? (size_t)(end - begin) : 0;
    memcpy(piece, begin, length);
    piece[length] = '\0';
    imki_markup_escape(out, piece);
}

static void put_words(imki_text *out, const char *text)
{
    int shift = 0; /* of what was written last [px] */
    for (const char *c = text; *c;) {
        const size_t plain = strcspn(c, "_^");
        if (plain > 0 && shift != 0)
            imki_text_add(out, "<tspan dy=\"%d\">", -shift);
        put_piece(out, c, c + plain);
        if (plain > 0 && shift != 0)
            imki_text_put(out, "</tspan>");
        shift = plain > 0 ? 0 : shift;
        c += plain;
        if (!*c)
            return;
        const int to = *c == '_' ? 5 : -7;
        const char *begin = c + 1, *end = end_of(begin);
        if (!end || end == begin)
            return;
        const bool braces = *begin == '{';
        imki_text_add(out, "<tspan class=\"s-small\" dy=\"%d\">", to - shift);
        put_piece(out, begin + braces, end);
        imki_text_put(out, "</tspan>");
        c = end + braces;
        shift = to;
    }
}

static void put_text(imki_drawing *d, const char *class, imki_side side, double x, double y,
                     const char *text)
{
    static const char *const anchors[] = {"", " text-anchor=\"middle\"", " text-anchor=\"end\""};
    imki_text_put(&d->text, "<text x=\"");
    imki_put_tenths(&d->text, x);
    imki_text_put(&d->text, "\" y=\"");
    imki_put_tenths(&d->text, y);
    imki_text_add(&d->text, "\"%s%s>", anchors[side], class);
    put_words(&d->text, text);
    imki_text_put(&d->text, "</text>\n");
}

void imki_draw_text(imki_drawing *d, imki_side side, double x, double y, const char *text)
{
    put_text(d, "", side, x, y, text);
}

void imki_draw_note(imki_drawing *d, imki_side side, double x, double y, const char *text)
{
    put_text(d, " class=\"s-note\"", side, x, y, text);
}

void imki_draw_label(imki_drawing *d, imki_side side, double x, double y, const char *text,
                     double x1, double y1, double x2, double y2)
{
    imki_draw_line(d, "thin", x1, y1, x2, y2);
    imki_draw_circle(d, "dot", x2, y2, 2.5);
    imki_draw_text(d, side, x, y, text);
}

/* ---- scales ---------------------------------------------------------------------------------- */

/* A power of ten, correctly rounded. */
static double power_of_ten(int exponent)
{
    static const double table[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                   1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                   1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
    const int largest = (int)(sizeof table / sizeof table[0]) - 1;
    const int size = exponent < 0 ? -exponent : exponent;
    const double power = table[size > largest ? largest : size];
    return exponent < 0 ? 1 / power : power;
}

double imki_round_down(double value)
{
    static const double digits[] = {5, 3, 2, 1};
    int exponent = 22;
    while (exponent > -22 && !(power_of_ten(exponent) <= value))
        exponent--;
    for (int i = 0; i < 4; i++) {
        const double round =
            exponent < 0 ? digits[i] / power_of_ten(-exponent) : digits[i] * power_of_ten(exponent);
        if (round <= value * (1 + 1e-12))
            return round;
    }
    return value;
}

/* The exponent of the power of ten that is not above a number > 0. */
static int exponent_of(double value)
{
    int exponent = 0;
    for (; value >= 10 && exponent < 400; exponent++)
        value /= 10;
    for (; value < 1 && exponent > -400; exponent--)
        value *= 10;
    return exponent;
}

/* A digit and a power of ten, "2·10^{15}". */
static void power_text(double value, const char *unit, char *text, size_t size)
{
    int exponent = exponent_of(value);
    double scaled = value;
    for (int i = 0; i < exponent; i++)
        scaled /= 10;
    for (int i = 0; i > exponent; i--)
        scaled *= 10;
    long digit = lround(scaled);
    exponent += digit == 10;
    digit = digit == 10 ? 1 : digit;
    if (digit == 1)
        snprintf(text, size, "10^{%d}%s", exponent, unit);
    else
        snprintf(text, size, "%ld·10^{%d}%s", digit, exponent, unit);
}

/* "200 pm" of a round length [m]. */
static void length_text(double length, char *text, size_t size)
{
    static const char *const names[] = {"km", "m", "mm", "µm", "nm", "pm", "fm"};
    int i = 0;
    double unit = 1e3;
    while (i < 6 && length < unit * (1 - 1e-9)) {
        unit /= 1e3;
        i++;
    }
    const double number = length / unit;
    if (number >= 0.5 && number < 1e4)
        snprintf(text, size, "%ld %s", lround(number), names[i]);
    else
        power_text(length, " m", text, size);
}

void imki_scale_bar(imki_drawing *d, size_t part, double x, double y)
{
    const imk_schematic_part *p = &d->schematic->parts[part];
    const double gain = fabs(imk_schematic_gain(d->schematic, d->design, part));
    if (!(gain > 0))
        return;
    const bool upright = p->move == IMK_MOVE_SHIFT_Y || p->move == IMK_MOVE_STRETCH_Y;
    const double length = imki_round_down((upright ? 42 : 60) / gain), half = 0.5 * length * gain;
    char text[40];
    length_text(length, text, sizeof text);
    if (upright) {
        imki_draw_line(d, "bar", x, y - half, x, y + half);
        imki_draw_line(d, "bar", x - 4, y - half, x + 4, y - half);
        imki_draw_line(d, "bar", x - 4, y + half, x + 4, y + half);
        imki_draw_note(d, IMKI_START, x + 9, y + 7, text);
    } else {
        imki_draw_line(d, "bar", x - half, y, x + half, y);
        imki_draw_line(d, "bar", x - half, y - 4, x - half, y + 4);
        imki_draw_line(d, "bar", x + half, y - 4, x + half, y + 4);
        imki_draw_note(d, IMKI_MIDDLE, x, y + 21, text);
    }
}

/* "21 000" with two digits that count, in groups of three; from a million on a power of ten. */
static void large_text(double value, char *text, size_t size)
{
    char digits[40];
    double round = 1;
    if (!(value < 1e6)) {
        power_text(value, "", text, size);
        return;
    }
    while (value / round >= 100)
        round *= 10;
    const int length = snprintf(digits, sizeof digits, "%.0f", floor(value / round + 0.5) * round);
    size_t used = 0;
    for (int i = 0; i < length && used + 4 < size; i++) {
        if (i > 0 && (length - i) % 3 == 0 && length > 4) {
            memcpy(text + used, "\xC2\xA0", 2); /* a blank that does not break */
            used += 2;
        }
        text[used++] = digits[i];
    }
    text[used] = '\0';
}

void imki_magnified(imki_drawing *d, size_t part, imki_side side, double x, double y,
                    const char *words)
{
    const double radian = 180 / 3.14159265358979323846;
    const double gain = fabs(imk_schematic_gain(d->schematic, d->design, part)) / radian;
    char number[60], text[120];
    if (!(gain > 0))
        return;
    large_text(gain >= 1 ? gain : 1 / gain, number, sizeof number);
    snprintf(text, sizeof text, gain >= 1 ? "%s × %s" : "%s × 1/%s", words, number);
    imki_draw_note(d, side, x, y, text);
}

void imki_draw_title(imki_drawing *d)
{
    char title[80];
    snprintf(title, sizeof title, "%s", d->schematic->instrument->title);
    if (title[0] >= 'a' && title[0] <= 'z')
        title[0] = (char)(title[0] - 'a' + 'A');
    put_text(d, " font-weight=\"bold\"", IMKI_START, 10, 26, title);
}

void imki_draw_time(imki_drawing *d)
{
    const double pace = imk_schematic_pace(d->schematic, d->design);
    char number[60], text[120];
    large_text(pace < 1 ? 1 / pace : pace, number, sizeof number);
    snprintf(text, sizeof text,
             pace < 0.95   ? "time slowed %s ×"
             : pace > 1.05 ? "time sped up %s ×"
                           : "true time",
             number);
    put_text(d, " class=\"s-note pace\"", IMKI_START, 10, 390, text);
}
