/* SPDX-License-Identifier: Apache-2.0 */
/* A workspace given at any address, used from the next cache line. */
#ifndef IMUKIT_WORKSPACE_INTERNAL_H
#define IMUKIT_WORKSPACE_INTERNAL_H

#include <stddef.h>
#include <stdint.h>

/** Bytes to ask for beyond the doubles themselves. */
enum { IMKI_ALIGNMENT_SLACK = 64 };

static inline void *imki_align(void *workspace)
{
    const uintptr_t address = (uintptr_t)workspace;
    const uintptr_t aligned = (address + 63) & ~(uintptr_t)63;
    return (char *)workspace + (aligned - address);
}

/** Bytes of the cache lines that so many bytes take. */
static inline size_t imki_lines(size_t size)
{
    return (size + 63) / 64 * 64;
}

/** The first of these lines; memory goes on behind the last. */
static inline void *imki_take(unsigned char **memory, size_t size)
{
    void *taken = *memory;
    *memory += imki_lines(size);
    return taken;
}

#endif
