/* SPDX-License-Identifier: Apache-2.0 */
/* Memory in blocks, given back all at once. Small pieces share a block; a large one has its own. */
#include "arena_internal.h"

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ALIGNMENT = 64, SMALL_ALIGNMENT = 16, SMALL_SIZE = 256, SHARED_SIZE = 1 << 16 };

typedef struct imki_arena_block {
    struct imki_arena_block *next;
    size_t used, size; /* of what follows */
} imki_arena_block;

void *imki_resize(const imk_allocator *allocator, void *at, size_t size)
{
    if (allocator->resize)
        return allocator->resize(allocator->context, at, size);
    if (size > 0)
        return realloc(at, size);
    free(at);
    return NULL;
}

static size_t aligned_place(const imki_arena_block *block, size_t size)
{
    const uintptr_t start = (uintptr_t)(block + 1);
    const uintptr_t alignment = size < SMALL_SIZE ? SMALL_ALIGNMENT : ALIGNMENT;
    return (size_t)((start + block->used + alignment - 1) / alignment * alignment - start);
}

/* A block with room for a piece behind those that are there: it becomes the first unless the one
 * that is first has more room left. */
static imki_arena_block *add_block(imki_arena *arena, size_t size)
{
    const bool shared = size <= SHARED_SIZE / 4;
    const size_t room = (shared ? SHARED_SIZE : size) + ALIGNMENT;
    imki_arena_block *block =
        size < SIZE_MAX / 2 ? imki_resize(&arena->allocator, NULL, sizeof *block + room) : NULL;
    if (!block) {
        arena->failed = true;
        return NULL;
    }
    *block = (imki_arena_block){.size = room};
    if (shared || !arena->blocks) {
        block->next = arena->blocks;
        arena->blocks = block;
    } else {
        block->next = arena->blocks->next;
        arena->blocks->next = block;
    }
    return block;
}

void *imki_arena_room(imki_arena *arena, size_t size)
{
    imki_arena_block *block = arena->blocks;
    size_t place = block ? aligned_place(block, size) : 0;
    if (!block || place > block->size || block->size - place < size) {
        block = add_block(arena, size);
        place = block ? aligned_place(block, size) : 0;
    }
    if (!block)
        return NULL;
    block->used = place + size;
    return (char *)(block + 1) + place;
}

void *imki_arena_take(imki_arena *arena, size_t size)
{
    void *place = imki_arena_room(arena, size);
    return place ? memset(place, 0, size) : NULL;
}

void *imki_arena_extend(imki_arena *arena, void *at, size_t items, size_t size)
{
    if (items > 0 && (items & (items - 1)) != 0)
        return at; /* room was made up to the next power of two */
    void *larger = imki_arena_take(arena, (items > 0 ? 2 * items : 1) * size);
    if (larger && items > 0)
        memcpy(larger, at, items * size);
    return larger;
}

char *imki_arena_text(imki_arena *arena, const char *text)
{
    const size_t size = text ? strlen(text) + 1 : 0;
    char *copy = text ? imki_arena_room(arena, size) : NULL;
    return copy ? memcpy(copy, text, size) : NULL;
}

double *imki_arena_numbers(imki_arena *arena, const double *values, size_t count, double scale)
{
    double *copy = values ? imki_arena_room(arena, (count + 1) * sizeof *copy) : NULL;
    for (size_t i = 0; copy && i < count; i++)
        copy[i] = values[i] / scale;
    return copy;
}

const char *imki_arena_format(imki_arena *arena, const char *format, va_list arguments)
{
    va_list again;
    va_copy(again, arguments);
    const int length = vsnprintf(NULL, 0, format, again);
    va_end(again);
    char *text = length >= 0 ? imki_arena_room(arena, (size_t)length + 1) : NULL;
    if (!text)
        return "";
    vsnprintf(text, (size_t)length + 1, format, arguments);
    return text;
}

void imki_arena_free(imki_arena *arena)
{
    while (arena->blocks) {
        imki_arena_block *next = arena->blocks->next;
        imki_resize(&arena->allocator, arena->blocks, 0);
        arena->blocks = next;
    }
}
