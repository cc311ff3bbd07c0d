/* SPDX-License-Identifier: Apache-2.0 */
/* Lines of text in a figure must fit, but their width cannot be measured here: widths are those of
 * DejaVu Sans, the first font that the drawing asks for. Verdana, the second font, is as wide. */
#include "figure_internal.h"
#include "markup_internal.h"

#include "imukit/utf8.h"

#include <string.h>

/* Advance widths of DejaVu Sans from the space to the tilde, in thousandths of the font's size. */
static const short advance[] = {
    318, 401, 460, 838, 636, 950, 780, 275, 390, 390, 500, 838, 318, 361,  318, 337, 636, 636, 636,
    636, 636, 636, 636, 636, 636, 636, 337, 337, 838, 838, 838, 531, 1000, 684, 686, 698, 770, 632,
    575, 775, 752, 295, 295, 656, 557, 863, 748, 787, 603, 787, 695, 635,  611, 732, 684, 989, 685,
    611, 685, 390, 337, 390, 838, 500, 500, 613, 635, 550, 635, 615, 352,  635, 634, 278, 278, 579,
    278, 974, 634, 612, 635, 635, 411, 521, 392, 634, 592, 818, 592, 592,  525, 636, 337, 636, 838};

/* Letters of other alphabets are 600 to 670 wide on average; characters of three bytes or more can
 * be as wide as high, such as those of East Asia. */
static const short other_letter = 680, sign = 1000;

/* A line is drawn smaller, down to this part of its size, before letters are left out. */
static const double least_part = 0.75;

/* The longest line, in bytes. */
enum { LONGEST_LINE = 400 };

double imki_line_width(const char *text, double font_size)
{
    double width = 0;
    size_t length;
    for (const char *c = text ? text : ""; *c; c += length > 0 ? length : 1) {
        length = imk_utf8_length(c);
        if (length == 1 && *c >= ' ' && *c <= '~')
            width += advance[*c - ' '];
        else
            width += length == 2 ? other_letter : sign;
    }
    return 1e-3 * width * font_size;
}

void imki_svg_line(imki_text *out, double x, double y, imki_anchor anchor, double font_size,
                   double width, const char *more, const char *text)
{
    static const char *const anchors[] = {"", " text-anchor=\"middle\"", " text-anchor=\"end\""};
    char line[LONGEST_LINE];
    imk_utf8_shorten(text ? text : "", line, sizeof line);
    double needed = imki_line_width(line, font_size);
    if (needed > width) {
        font_size *= fmax(width / needed, least_part);
        while ((needed = imki_line_width(line, font_size)) > width && strlen(line) > 4) {
            const double part = fmin(width / needed, 0.98);
            const size_t room = (size_t)(part * (double)strlen(line));
            imk_utf8_shorten(text, line, room > 4 ? room + 1 : 5);
        }
    }
    if (!*line)
        return;
    imki_text_add(out, "<text x=\"%ld\" y=\"%ld\" font-size=\"%ld\"%s%s>", imki_tenths(x),
                  imki_tenths(y), imki_tenths(font_size), anchors[anchor], more);
    imki_markup_escape(out, line);
    imki_text_put(out, "</text>\n");
}
