/* SPDX-License-Identifier: Apache-2.0 */
/** @file thread_pool.h
 *  POSIX threads behind imk_executor. */
#ifndef IMUKIT_THREAD_POOL_H
#define IMUKIT_THREAD_POOL_H

#include "imukit/executor.h"

IMK_BEGIN_C

typedef struct imk_thread_pool imk_thread_pool;

/** Start `threads` - 1 workers (the caller is the other); 0 takes one per processor this process
 *  may use (its affinity mask, as taskset and containers set it). Workers sleep while there is no
 *  work and block all signals but SIGPIPE, so that handlers run on the caller's threads. Each has a
 *  stack of 1 MiB, whatever the limits of the process are.
 *  @return NULL when so many threads cannot be made */
IMK_API imk_thread_pool *imk_thread_pool_create(size_t threads);
/** Ends the workers and waits for them. NULL is allowed. */
IMK_API void imk_thread_pool_destroy(imk_thread_pool *pool);
/** Number of threads of a pool, its creator's included; 1 for NULL. */
IMK_API size_t imk_thread_pool_threads(const imk_thread_pool *pool);

/** Executor of a pool, valid while the pool lives; of NULL a serial one. Items are taken from a
 *  common counter, so unequal items balance; everything an item wrote is visible to the caller when
 *  imk_execute() returns. Not reentrant: one imk_execute() at a time, and none from inside a work
 *  item. */
IMK_API imk_executor imk_thread_pool_executor(imk_thread_pool *pool);

IMK_END_C
#endif
