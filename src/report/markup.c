/* SPDX-License-Identifier: Apache-2.0 */
/* Text of the caller inside HTML and SVG. */
#include "markup_internal.h"

void imki_markup_escape(imki_text *out, const char *text)
{
    for (const char *c = text ? text : ""; *c; c++) {
        switch (*c) {
        case '&':
            imki_text_put(out, "&amp;");
            break;
        case '<':
            imki_text_put(out, "&lt;");
            break;
        case '>':
            imki_text_put(out, "&gt;");
            break;
        case '"':
            imki_text_put(out, "&quot;");
            break;
        default:
            if ((unsigned char)*c >= 0x20 || *c == '\n' || *c == '\t')
                imki_text_put_char(out, *c);
        }
    }
}
