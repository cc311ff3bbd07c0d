/* SPDX-License-Identifier: Apache-2.0 */
/** @file allocator.h
 *  The memory functions that jobs and results use. libimukit itself allocates nothing. */
#ifndef IMUKIT_ALLOCATOR_H
#define IMUKIT_ALLOCATOR_H

#include <stddef.h>

/** A memory function like realloc(). With `at` NULL it takes new memory; with `size` 0 it frees the
 *  memory and returns NULL. NULL for a size above 0 means that memory is exhausted. Addresses must
 *  be multiples of alignof(max_align_t). If a job has several threads, they may call it at once. A
 *  structure of zeros stands for realloc() and free(). */
typedef struct imk_allocator {
    void *(*resize)(void *context, void *at, size_t size);
    void *context;
} imk_allocator;

#endif
