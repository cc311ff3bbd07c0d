/* SPDX-License-Identifier: Apache-2.0 */
/* Lines of a text of any length in a window of bounded size. */
#include "log_text_internal.h"

#include <stdlib.h>
#include <string.h>

enum { WINDOW = 1 << 16 };

/* The last newline at or after `from`. */
static void find_lines_end(imki_log_text *text, const char *from)
{
    for (const char *p = text->end; p > from; p--)
        if (p[-1] == '\n') {
            text->lines_end = p;
            return;
        }
}

imk_status imki_log_text_start(imki_log_text *text, imki_input *input, imk_error *error)
{
    *text = (imki_log_text){.input = input, .line = 1};
    size_t size;
    const char *whole = imki_input_mapped(input, &size);
    if (whole) {
        text->base = text->next = text->lines_end = whole;
        text->end = whole + size;
        text->finished = true;
        find_lines_end(text, whole);
        return IMK_OK;
    }
    text->buffer = malloc(WINDOW);
    if (!text->buffer)
        return imk_error_set(error, IMK_ERROR_MEMORY, "", NULL, NULL);
    text->capacity = WINDOW;
    text->base = text->next = text->lines_end = text->end = text->buffer;
    return IMK_OK;
}

void imki_log_text_stop(imki_log_text *text)
{
    imki_input_close(text->input);
    free(text->buffer);
    free(text->decoder.buffer);
    *text = (imki_log_text){0};
}

/* Drop what is consumed, and make room for more. */
static bool make_room(imki_log_text *text)
{
    const char *keep = text->hold ? text->hold : text->next;
    const size_t kept = (size_t)(text->end - keep);
    const size_t next = (size_t)(text->next - keep);
    size_t lines_end = text->lines_end > keep ? (size_t)(text->lines_end - keep) : 0;
    text->taken += (uint64_t)(keep - text->base);
    memmove(text->buffer, keep, kept);
    if (kept > text->capacity / 2) {
        char *larger = realloc(text->buffer, 2 * text->capacity);
        if (larger) {
            text->buffer = larger;
            text->capacity *= 2;
        }
    }
    text->base = text->buffer;
    text->next = text->base + next;
    text->lines_end = text->base + lines_end;
    text->end = text->base + kept;
    text->hold = text->hold ? text->base : NULL;
    return kept < text->capacity;
}

static imk_status read_more(imki_log_text *text, imk_error *error)
{
    if (!make_room(text))
        return imk_error_set(error, IMK_ERROR_MEMORY, "", NULL, NULL);
    char *room = text->buffer + (text->end - text->base);
    const size_t size = text->capacity - (size_t)(text->end - text->base);
    size_t got;
    if (text->decoder.encoding != IMKI_LOG_PLAIN && size < IMKI_LOG_DECODED_LEAST)
        return imk_error_set(error, IMK_ERROR_MEMORY, "", NULL, NULL);
    const imk_status status =
        text->decoder.encoding != IMKI_LOG_PLAIN
            ? imki_log_decode(&text->decoder, text->input, room, size, &got, error)
            : imki_input_read(text->input, room, size, &got, error);
    if (status != IMK_OK)
        return status;
    text->finished = got == 0;
    text->end += got;
    find_lines_end(text, room);
    return IMK_OK;
}

imk_status imki_log_text_decode(imki_log_text *text, imki_log_encoding encoding, imk_error *error)
{
    imki_log_decoder decoder;
    char *buffer = malloc(WINDOW);
    imk_status status = buffer ? IMK_OK : imk_error_set(error, IMK_ERROR_MEMORY, "", NULL, NULL);
    if (status == IMK_OK)
        status =
            imki_log_decoder_start(&decoder, encoding, text->next, text->end, !text->buffer, error);
    if (status != IMK_OK) {
        free(buffer);
        return status;
    }
    text->raw_size = text->buffer ? 0 : (uint64_t)(text->end - text->base);
    free(text->buffer);
    text->buffer = buffer;
    text->capacity = WINDOW;
    text->decoder = decoder;
    text->base = text->next = text->lines_end = text->end = text->buffer;
    text->finished = false;
    text->taken = 0;
    return IMK_OK;
}

imk_status imki_log_text_need(imki_log_text *text, size_t size, imk_error *error)
{
    while (!text->finished && (size_t)(text->end - text->next) < size) {
        const imk_status status = read_more(text, error);
        if (status != IMK_OK)
            return status;
    }
    return IMK_OK;
}

uint64_t imki_log_text_place(const imki_log_text *text)
{
    return text->taken + (uint64_t)(text->next - text->base);
}

void imki_log_text_progress(const imki_log_text *text, uint64_t *done, uint64_t *size)
{
    if (text->raw_size > 0) {
        *size = text->raw_size;
        *done = *size - (uint64_t)(text->decoder.raw_end - text->decoder.raw);
    } else if (text->buffer) {
        const uint64_t consumed = text->taken + (uint64_t)(text->next - text->base);
        const uint64_t fetched = text->taken + (uint64_t)(text->end - text->base);
        imki_input_progress(text->input, done, size);
        if (*done == fetched) /* it is not compressed */
            *done = consumed;
    } else {
        *done = (uint64_t)(text->next - text->base);
        *size = (uint64_t)(text->end - text->base);
    }
}

uint64_t imki_log_text_size(const imki_log_text *text)
{
    uint64_t done, size;
    imki_log_text_progress(text, &done, &size);
    return size;
}

imk_status imki_log_text_seek(imki_log_text *text, uint64_t place, imk_error *error)
{
    if (text->decoder.encoding != IMKI_LOG_PLAIN)
        return imk_error_set(error, IMK_ERROR_UNSUPPORTED, "",
                             "a text that is decoded is read from its beginning", "");
    text->line = 1;
    text->hold = NULL;
    if (!text->buffer) {
        const uint64_t size = (uint64_t)(text->end - text->base);
        text->next = text->base + (place < size ? place : size);
        text->lines_end = text->next;
        find_lines_end(text, text->next);
        return IMK_OK;
    }
    const imk_status status = imki_input_seek(text->input, place, error);
    if (status != IMK_OK)
        return status;
    text->base = text->next = text->lines_end = text->end = text->buffer;
    text->taken = place;
    text->finished = false;
    return IMK_OK;
}

imk_status imki_log_text_need_line(imki_log_text *text, imk_error *error)
{
    while (!text->finished && text->lines_end <= text->next &&
           text->end - text->next <= IMKI_LINE_MAX) {
        const imk_status status = read_more(text, error);
        if (status != IMK_OK)
            return status;
    }
    const size_t at_hand = (size_t)(text->end - text->next);
    if (at_hand > IMKI_LINE_MAX && !memchr(text->next, '\n', IMKI_LINE_MAX)) {
        imk_error_set(error, IMK_ERROR_FORMAT, "", "a line is longer than 1 MiB",
                      "a text log with one row per line");
        if (error)
            error->line = text->line;
        return IMK_ERROR_FORMAT;
    }
    return IMK_OK;
}

bool imki_log_text_take_line(imki_log_text *text, const char **begin, const char **end, bool *whole)
{
    if (text->next == text->end)
        return false;
    const char *newline = memchr(text->next, '\n', (size_t)(text->end - text->next));
    *whole = newline != NULL;
    *begin = text->next;
    *end = newline ? newline : text->end;
    text->next = newline ? newline + 1 : text->end;
    if (*end > *begin && (*end)[-1] == '\r')
        (*end)--;
    text->line++;
    return true;
}
