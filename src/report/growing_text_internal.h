/* SPDX-License-Identifier: Apache-2.0 */
/* Text that grows in memory while it is written. */
#ifndef IMUKIT_REPORT_GROWING_TEXT_INTERNAL_H
#define IMUKIT_REPORT_GROWING_TEXT_INTERNAL_H

#include <stdbool.h>
#include <stddef.h>

/* Starts as {.bytes = NULL}; the owner frees the bytes. */
typedef struct imki_text {
    char *bytes; /* ends with a zero */
    size_t size, capacity;
    bool failed; /* memory is exhausted */
} imki_text;

void imki_text_put(imki_text *text, const char *words);
void imki_text_put_char(imki_text *text, char letter);
void imki_text_put_bytes(imki_text *text, const char *bytes, size_t size);
void imki_text_add(imki_text *text, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* The text, which the caller then owns; NULL when memory was exhausted. */
char *imki_text_take(imki_text *text, size_t *size);

#endif
