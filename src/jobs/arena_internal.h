/* SPDX-License-Identifier: Apache-2.0 */
/* Memory that is given back all at once: everything a job or a result holds. */
#ifndef IMUKI_ARENA_INTERNAL_H
#define IMUKI_ARENA_INTERNAL_H

#include "imukit/allocator.h"

#include <stdarg.h>
#include <stdbool.h>

/* From {.allocator = …} on. What fails is remembered, so that only who hands the result on need
 * look. */
typedef struct imki_arena {
    imk_allocator allocator;
    struct imki_arena_block *blocks;
    bool failed; /* memory is exhausted */
} imki_arena;

/* Zeroed memory, its address a multiple of 64 from 256 bytes on, of 16 below; NULL when memory is
 * exhausted. */
void *imki_arena_take(imki_arena *arena, size_t size);
/* The same, of any content: for what is written before it is read. */
void *imki_arena_room(imki_arena *arena, size_t size);
/* `items` of `size` bytes each as part of a growing array: its room doubles when it is full.
 * @param at  the array, or NULL; its items are moved. @return NULL when memory is exhausted */
void *imki_arena_extend(imki_arena *arena, void *at, size_t items, size_t size);
/* Copies of a text and of numbers; NULL of NULL. */
char *imki_arena_text(imki_arena *arena, const char *text);
double *imki_arena_numbers(imki_arena *arena, const double *values, size_t count, double scale);
/* A formatted text; "" when memory is exhausted. */
const char *imki_arena_format(imki_arena *arena, const char *format, va_list arguments)
    __attribute__((format(printf, 2, 0)));
void imki_arena_free(imki_arena *arena);

/* One piece of memory that grows: as realloc(). */
void *imki_resize(const imk_allocator *allocator, void *at, size_t size);

#endif
