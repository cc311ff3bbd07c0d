/* SPDX-License-Identifier: Apache-2.0 */
/** @file allocator.h
 *  Where jobs and results take their memory. libimukit itself allocates nothing. */
#ifndef IMUKIT_ALLOCATOR_H
#define IMUKIT_ALLOCATOR_H

#include <stddef.h>

/** Memory as of realloc(): `at` NULL takes some, `size` 0 gives it back and returns NULL. NULL for
 * a size above 0 means that memory is exhausted. The address is a multiple of alignof(max_align_t).
 * Several threads call it at once where a job has several. A structure of zeros stands for
 * realloc() and free(). */
typedef struct imk_allocator {
    void *(*resize)(void *context, void *at, size_t size);
    void *context;
} imk_allocator;

#endif
