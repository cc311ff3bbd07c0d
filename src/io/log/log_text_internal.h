/* SPDX-License-Identifier: Apache-2.0 */
/* The bytes of a log at hand, a window that moves through an input of any length. */
#ifndef IMUKIT_LOG_TEXT_INTERNAL_H
#define IMUKIT_LOG_TEXT_INTERNAL_H

#include "imukit/status.h"
#include "io/file/input_stream_internal.h"

#include <stdbool.h>

enum { IMKI_LINE_MAX = 1 << 20 };

/* How the bytes are characters. */
typedef enum imki_log_encoding {
    IMKI_LOG_PLAIN = 0,
    IMKI_LOG_UTF16_LITTLE,
    IMKI_LOG_UTF16_BIG,
    IMKI_LOG_CR /* lines end in CR alone */
} imki_log_encoding;

/* The encoding of a text by its first bytes. */
imki_log_encoding imki_log_encoding_of(const char *begin, size_t size);

typedef struct imki_log_decoder {
    imki_log_encoding encoding;
    const char *raw, *raw_end; /* at hand and not decoded yet */
    char *buffer;              /* holds them; NULL when the whole text is in memory */
    bool finished;             /* there is no more */
} imki_log_decoder;

/* Begin with the bytes at hand. @param finished  these are all, and they stay where they are */
imk_status imki_log_decoder_start(imki_log_decoder *decoder, imki_log_encoding encoding,
                                  const char *begin, const char *end, bool finished,
                                  imk_error *error);
enum { IMKI_LOG_DECODED_LEAST = 4 }; /* room that a character may need */

/* Decode some more.
 * @param room  at least IMKI_LOG_DECODED_LEAST
 * @param got   bytes put into `out`; 0 at the end */
imk_status imki_log_decode(imki_log_decoder *decoder, imki_input *input, char *out, size_t room,
                           size_t *got, imk_error *error);

typedef struct imki_log_text {
    imki_input *input;
    const char *base;      /* bytes from here on may be read */
    const char *next;      /* the first one not consumed */
    const char *lines_end; /* behind the last newline at hand, or next when there is none */
    const char *end;       /* behind the last byte at hand */
    const char *hold;      /* keep from here on, to come back; or NULL */
    bool finished;         /* the input has no more */
    size_t line;           /* number of the line at next, from 1 */
    uint64_t taken;        /* bytes of the (decompressed) text before base */
    char *buffer;          /* NULL when the whole text is in memory */
    size_t capacity;
    imki_log_decoder decoder; /* IMKI_LOG_PLAIN: there is none */
    uint64_t raw_size;        /* bytes that are decoded, of a text in memory */
} imki_log_text;

/* Start on an open input, which belongs to the text from now on, also on error. */
imk_status imki_log_text_start(imki_log_text *text, imki_input *input, imk_error *error);
void imki_log_text_stop(imki_log_text *text);

/* Decode from `next` on. Pointers into the window are void. */
imk_status imki_log_text_decode(imki_log_text *text, imki_log_encoding encoding, imk_error *error);

/* Have `size` bytes at hand, or all that come. Moves the window: pointers into it are void. */
imk_status imki_log_text_need(imki_log_text *text, size_t size, imk_error *error);

/* Byte of the (decompressed) input at which `next` is. */
uint64_t imki_log_text_place(const imki_log_text *text);

/* Bytes of a plain file or of memory; 0 when it is not known. */
uint64_t imki_log_text_size(const imki_log_text *text);
/* Bytes of the input consumed and its size (0 when not known). */
void imki_log_text_progress(const imki_log_text *text, uint64_t *done, uint64_t *size);

/* Go to a byte of a plain file or of memory; lines count from 1 again. Pointers into the window are
 * void. @return as imki_input_seek(); IMK_ERROR_UNSUPPORTED for a text that is decoded */
imk_status imki_log_text_seek(imki_log_text *text, uint64_t place, imk_error *error);

/* Have a whole line at hand, the last one may be without newline; none at the end of the input.
 * @return IMK_ERROR_FORMAT for a line beyond IMKI_LINE_MAX, or what the input says */
imk_status imki_log_text_need_line(imki_log_text *text, imk_error *error);

/* The line at hand without its end; *whole is whether it had a newline. Consumes it. False: none.
 */
bool imki_log_text_take_line(imki_log_text *text, const char **begin, const char **end,
                             bool *whole);

#endif
