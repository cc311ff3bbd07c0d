/* SPDX-License-Identifier: Apache-2.0 */
/* A workspace given at any address, used from the next cache line, in parts that begin with one. */
#ifndef IMUKIT_WORKSPACE_INTERNAL_H
#define IMUKIT_WORKSPACE_INTERNAL_H

#include <stddef.h>
#include <stdint.h>

/* Bytes to ask for beyond the parts. */
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
typedef struct imki_parts {
    char *memory;
    size_t used;
} imki_parts;

/* Of a workspace, which has bytes for imki_parts_size(); NULL: only sizes are wanted. */
static inline imki_parts imki_parts_of(void *workspace)
{
    return (imki_parts){(char *)imki_align(workspace), 0};
}

static inline size_t imki_parts_size(const imki_parts *parts)
{
    return parts->used + IMKI_ALIGNMENT_SLACK;
}

static inline void *imki_take(imki_parts *parts, size_t size)
{
    void *part = parts->memory ? parts->memory + parts->used : NULL;
    parts->used += imki_aligned(size);
    return part;
}

#endif
