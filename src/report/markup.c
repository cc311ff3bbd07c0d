/* SPDX-License-Identifier: Apache-2.0 */
/* Text of the caller inside HTML, SVG and JSON. */
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

void imki_markup_quote(imki_text *out, const char *text)
{
    static const char short_forms[] = "\"\\\b\f\n\r\t", letters[] = "\"\\bfnrt";
    imki_text_put_char(out, '"');
    for (const char *c = text; *c; c++) {
        size_t k = 0;
        while (short_forms[k] && short_forms[k] != *c)
            k++;
        if (short_forms[k])
            imki_text_put_bytes(out, (const char[]){'\\', letters[k]}, 2);
        else if ((unsigned char)*c < 0x20)
            imki_text_add(out, "\\u%04X", (unsigned)*c);
        else
            imki_text_put_char(out, *c);
    }
    imki_text_put_char(out, '"');
}

void imki_markup_data(imki_text *out, const char *json)
{
    size_t length;
    for (const char *c = json; *c; c += length > 0 ? length : 1) {
        length = imk_utf8_length(c);
        if (length == 0)
            imki_text_put(out, IMK_UTF8_REPLACEMENT);
        else if (*c == '<') /* within a string */
            imki_text_put(out, "\\u003c");
        else
            imki_text_put_bytes(out, c, length);
    }
}
