/* SPDX-License-Identifier: Apache-2.0 */
/* Texts of other systems, decoded while they are read: UTF-16 to UTF-8 [RFC2781], and lines that
 * end in CR alone. */
#include "log_text_internal.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

enum { RAW = 1 << 15, PAIRS_LEAST = 8, PAIRS_LOOKED_AT = 64 };

/* Characters of ASCII in each pair of bytes, the other byte zero: nothing else looks so. */
static bool is_wide(const char *begin, size_t size, size_t zero)
{
    const size_t pairs = size / 2 < PAIRS_LOOKED_AT ? size / 2 : PAIRS_LOOKED_AT;
    for (size_t i = 0; i < pairs; i++) {
        const char c = begin[2 * i + 1 - zero];
        if (begin[2 * i + zero] != '\0' ||
            !((c >= ' ' && c < '\x7F') || c == '\t' || c == '\n' || c == '\r'))
            return false;
    }
    return pairs >= PAIRS_LEAST;
}

imki_log_encoding imki_log_encoding_of(const char *begin, size_t size)
{
    if (size >= 2 && memcmp(begin, "\xFF\xFE", 2) == 0)
        return IMKI_LOG_UTF16_LITTLE;
    if (size >= 2 && memcmp(begin, "\xFE\xFF", 2) == 0)
        return IMKI_LOG_UTF16_BIG;
    if (is_wide(begin, size, 1))
        return IMKI_LOG_UTF16_LITTLE;
    if (is_wide(begin, size, 0))
        return IMKI_LOG_UTF16_BIG;
    /* The newline of a last CR may not be seen yet. */
    return size > 0 && memchr(begin, '\r', size - 1) && !memchr(begin, '\n', size) ? IMKI_LOG_CR
                                                                                   : IMKI_LOG_PLAIN;
}

static unsigned unit_at(const imki_log_decoder *d, const char *at)
{
    const unsigned first = (unsigned char)at[0], second = (unsigned char)at[1];
    return d->encoding == IMKI_LOG_UTF16_LITTLE ? first | second << 8 : first << 8 | second;
}

static size_t put_utf8(unsigned c, char *out)
{
    if (c < 0x80) {
        out[0] = (char)c;
        return 1;
    }
    if (c < 0x800) {
        out[0] = (char)(0xC0 | c >> 6);
        out[1] = (char)(0x80 | (c & 0x3F));
        return 2;
    }
    if (c < 0x10000) {
        out[0] = (char)(0xE0 | c >> 12);
        out[1] = (char)(0x80 | (c >> 6 & 0x3F));
        out[2] = (char)(0x80 | (c & 0x3F));
        return 3;
    }
    out[0] = (char)(0xF0 | c >> 18);
    out[1] = (char)(0x80 | (c >> 12 & 0x3F));
    out[2] = (char)(0x80 | (c >> 6 & 0x3F));
    out[3] = (char)(0x80 | (c & 0x3F));
    return 4;
}

/* What is at hand, as far as there is room. A half of a pair waits for the other one. */
static size_t decode(imki_log_decoder *d, char *out, size_t room)
{
    size_t used = 0;
    if (d->encoding == IMKI_LOG_CR) {
        for (; d->raw < d->raw_end && used < room; d->raw++)
            out[used++] = (char)(*d->raw == '\r' ? '\n' : *d->raw);
        return used;
    }
    while (d->raw_end - d->raw >= 2 && room - used >= IMKI_LOG_DECODED_LEAST) {
        unsigned c = unit_at(d, d->raw);
        size_t taken = 2;
        if (c >= 0xD800 && c < 0xDC00) {
            if (d->raw_end - d->raw < 4 && !d->finished)
                break;
            const unsigned low = d->raw_end - d->raw >= 4 ? unit_at(d, d->raw + 2) : 0;
            const bool pair = low >= 0xDC00 && low < 0xE000;
            c = pair ? 0x10000 + ((c - 0xD800) << 10 | (low - 0xDC00)) : 0xFFFD;
            taken = pair ? 4 : 2;
        } else if (c >= 0xDC00 && c < 0xE000) {
            c = 0xFFFD;
        }
        d->raw += taken;
        used += put_utf8(c, out + used);
    }
    return used;
}

imk_status imki_log_decode(imki_log_decoder *d, imki_input *input, char *out, size_t room,
                           size_t *got, imk_error *error)
{
    for (;;) {
        *got = decode(d, out, room);
        if (*got > 0 || d->finished)
            return IMK_OK;
        const size_t kept = (size_t)(d->raw_end - d->raw);
        size_t more;
        memmove(d->buffer, d->raw, kept);
        const imk_status status =
            imki_input_read(input, d->buffer + kept, RAW - kept, &more, error);
        if (status != IMK_OK)
            return status;
        d->raw = d->buffer;
        d->raw_end = d->buffer + kept + more;
        d->finished = more == 0;
    }
}

imk_status imki_log_decoder_start(imki_log_decoder *d, imki_log_encoding encoding,
                                  const char *begin, const char *end, bool finished,
                                  imk_error *error)
{
    const size_t size = (size_t)(end - begin), room = size > RAW ? size : RAW;
    *d = (imki_log_decoder){
        .encoding = encoding, .raw = begin, .raw_end = end, .finished = finished};
    if (finished)
        return IMK_OK;
    d->buffer = malloc(room);
    if (!d->buffer)
        return imk_error_set(error, IMK_ERROR_MEMORY, "", NULL, NULL);
    memcpy(d->buffer, begin, size);
    d->raw = d->buffer;
    d->raw_end = d->buffer + size;
    return IMK_OK;
}
