/* SPDX-License-Identifier: Apache-2.0 */
/* Writing models: bytes, texts and keys. */
#include "model_yaml_internal.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void imki_write_bytes(imki_writer *writer, const char *bytes, size_t size)
{
    if (writer->failed || size == 0)
        return;
    if (writer->size + size + 1 > writer->capacity) {
        size_t capacity = 2 * (writer->size + size + 1);
        char *grown = realloc(writer->bytes, capacity);
        if (!grown) {
            writer->failed = true;
            return;
        }
        writer->bytes = grown;
        writer->capacity = capacity;
    }
    memcpy(writer->bytes + writer->size, bytes, size);
    writer->size += size;
    writer->bytes[writer->size] = '\0';
}

void imki_write_text(imki_writer *writer, const char *text)
{
    imki_write_bytes(writer, text, strlen(text));
}

void imki_write_indent(imki_writer *writer)
{
    for (int i = 0; i < writer->indent; i++)
        imki_write_text(writer, " ");
}

/* Double quotes with JSON's escapes, which YAML shares. Characters that YAML does not print, and
 * its extra line ends, are escaped. */
void imki_write_quoted(imki_writer *writer, const char *text)
{
    imki_write_text(writer, "\"");
    for (const unsigned char *c = (const unsigned char *)text; *c; c++) {
        char escape[16] = "";
        bool is_c1 = c[0] == 0xC2 && c[1] < 0xA0;
        bool is_line_end = c[0] == 0xE2 && c[1] == 0x80 && (c[2] == 0xA8 || c[2] == 0xA9);
        bool is_mark =
            c[0] == 0xEF && ((c[1] == 0xBB && c[2] == 0xBF) || (c[1] == 0xBF && c[2] >= 0xBE));
        if (*c == '"' || *c == '\\')
            snprintf(escape, sizeof escape, "\\%c", *c);
        else if (*c < 0x20 || *c == 0x7F)
            snprintf(escape, sizeof escape, "\\u%04x", (unsigned)*c);
        else if (is_c1)
            snprintf(escape, sizeof escape, "\\u%04x", (unsigned)c[1]);
        else if (is_line_end || is_mark)
            snprintf(escape, sizeof escape, "\\u%04x",
                     ((c[0] & 0x0Fu) << 12) | ((c[1] & 0x3Fu) << 6) | (c[2] & 0x3Fu));
        if (escape[0])
            imki_write_text(writer, escape);
        else
            imki_write_bytes(writer, (const char *)c, 1);
        c += is_c1 ? 1 : (is_line_end || is_mark) ? 2 : 0;
    }
    imki_write_text(writer, "\"");
}

/* Texts that mean themselves in YAML without quotes, also to other readers. */
static bool is_plain_text(const char *text)
{
    static const char *const words[] = {"true", "false", "yes", "no", "on",
                                        "off",  "null",  "y",   "n"};
    static const char letters[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ";
    size_t length = strlen(text);
    if (strspn(text, letters) == 0 ||
        strspn(text, "abcdefghijklmnopqrstuvwxyz"
                     "ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789 _./()+-") != length)
        return false;
    char lower[8] = "";
    for (size_t i = 0; i < length && length < sizeof lower; i++)
        lower[i] = (char)(text[i] >= 'A' && text[i] <= 'Z' ? text[i] + 32 : text[i]);
    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++)
        if (strcmp(lower, words[i]) == 0)
            return false;
    return text[length - 1] != ' ';
}

void imki_write_text_value(imki_writer *writer, const char *text)
{
    if (!writer->is_json && is_plain_text(text))
        imki_write_text(writer, text);
    else
        imki_write_quoted(writer, text);
}

void imki_write_key(imki_writer *writer, const char *key)
{
    if (writer->is_json || strchr(key, '['))
        imki_write_quoted(writer, key);
    else
        imki_write_text(writer, key);
    imki_write_text(writer, ":");
}
