/* SPDX-License-Identifier: Apache-2.0 */
/* A workspace given at any address, used from the next cache line. */
#ifndef IMUKIT_WORKSPACE_INTERNAL_H
#define IMUKIT_WORKSPACE_INTERNAL_H

#include <stdint.h>

/** Bytes to ask for beyond the doubles themselves. */
enum { IMKI_ALIGNMENT_SLACK = 64 };

static inline double *imki_align(void *workspace)
{
    const uintptr_t address = (uintptr_t)workspace;
    const uintptr_t aligned = (address + 63) & ~(uintptr_t)63;
    return (double *)(void *)((char *)workspace + (aligned - address));
}

#endif
