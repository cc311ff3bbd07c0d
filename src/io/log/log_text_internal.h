/* SPDX-License-Identifier: Apache-2.0 */
/* The bytes of a log at hand, a window that moves through an input of any length. */
#ifndef IMUKIT_LOG_TEXT_INTERNAL_H
#define IMUKIT_LOG_TEXT_INTERNAL_H

#include "imukit/status.h"
#include "io/file/input_stream_internal.h"

#include <stdbool.h>

enum { IMKI_LINE_MAX = 1 << 20 };

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
} imki_log_text;

/* Start on an open input, which belongs to the text from now on, also on error. */
imk_status imki_log_text_start(imki_log_text *text, imki_input *input, imk_error *error);
void imki_log_text_stop(imki_log_text *text);

/* Have `size` bytes at hand, or all that come. Moves the window: pointers into it are void. */
imk_status imki_log_text_need(imki_log_text *text, size_t size, imk_error *error);

/* Byte of the (decompressed) input at which `next` is. */
uint64_t imki_log_text_place(const imki_log_text *text);

/* Bytes of a plain file or of memory; 0 when it is not known. */
uint64_t imki_log_text_size(const imki_log_text *text);

/* Go to a byte of a plain file or of memory; lines count from 1 again. Pointers into the window are
 * void. @return as imki_input_seek() */
imk_status imki_log_text_seek(imki_log_text *text, uint64_t place, imk_error *error);

/* Have a whole line at hand, the last one may be without newline; none at the end of the input.
 * @return IMK_ERROR_FORMAT for a line beyond IMKI_LINE_MAX, or what the input says */
imk_status imki_log_text_need_line(imki_log_text *text, imk_error *error);

/* The line at hand without its end; *whole is whether it had a newline. Consumes it. False: none.
 */
bool imki_log_text_take_line(imki_log_text *text, const char **begin, const char **end,
                             bool *whole);

#endif
