/* SPDX-License-Identifier: Apache-2.0 */
/* Text of the caller inside HTML and SVG. */
#include "markup_internal.h"

void imki_markup_escape(FILE *out, const char *text)
{
    for (const char *c = text ? text : ""; *c; c++) {
        switch (*c) {
        case '&':
            fputs("&amp;", out);
            break;
        case '<':
            fputs("&lt;", out);
            break;
        case '>':
            fputs("&gt;", out);
            break;
        case '"':
            fputs("&quot;", out);
            break;
        default:
            if ((unsigned char)*c >= 0x20 || *c == '\n' || *c == '\t')
                fputc(*c, out);
        }
    }
}
