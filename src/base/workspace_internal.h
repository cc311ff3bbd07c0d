/* SPDX-License-Identifier: Apache-2.0 */
/* A workspace given at any address, used from the next cache line, in parts that begin with one. */
#ifndef IMUKIT_WORKSPACE_INTERNAL_H
#define IMUKIT_WORKSPACE_INTERNAL_H

#include <stddef.h>
#include <stdint.h>

/** Bytes to ask for beyond the doubles themselves. */
enum { IMKI_ALIGNMENT_SLACK = 64 };

static inline double *imki_align(void *workspace)
{
    const uintptr_t address = (uintptr_t)workspace;
    const uintptr_t aligned = (address + 63) & ~(uintptr_t)63;
    return (double *)(void *)((char *)workspace + (aligned - address));
}

/* A part's size up to the next cache line. */
static inline size_t imki_aligned(size_t size)
{
    return (size + 63) / 64 * 64;
}

/* What parts are taken from one after the other; without memory, only their size is added up. */
typedef struct imki_arena {
    char *memory;
    size_t used;
} imki_arena;

/* Of a workspace, which has bytes for imki_arena_size(); NULL: only sizes are wanted. */
static inline imki_arena imki_arena_of(void *workspace)
{
    return (imki_arena){(char *)imki_align(workspace), 0};
}

static inline size_t imki_arena_size(const imki_arena *arena)
{
    return arena->used + IMKI_ALIGNMENT_SLACK;
}

static inline void *imki_take(imki_arena *arena, size_t size)
{
    void *part = arena->memory ? arena->memory + arena->used : NULL;
    arena->used += imki_aligned(size);
    return part;
}

#endif
