/* SPDX-License-Identifier: Apache-2.0 */
/* Text of the caller inside HTML and SVG. */
#include "markup_internal.h"

#include "imukit/utf8.h"

void imki_markup_escape(imki_text *out, const char *text)
{
    size_t length;
    for (const char *c = text ? text : ""; *c; c += length > 0 ? length : 1) {
        length = imk_utf8_length(c);
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
            if (length == 0)
                imki_text_put(out, IMK_UTF8_REPLACEMENT);
            else if ((unsigned char)*c >= 0x20 || *c == '\n' || *c == '\t')
                imki_text_put_bytes(out, c, length);
        }
    }
}
