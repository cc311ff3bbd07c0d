/* SPDX-License-Identifier: Apache-2.0 */
/** @file thread_pool.h
 *  POSIX threads behind imk_executor. */
#ifndef IMUKIT_THREAD_POOL_H
#define IMUKIT_THREAD_POOL_H

#include "imukit/executor.h"

IMK_BEGIN_C

typedef struct imk_thread_pool imk_thread_pool;

/** Start `threads` - 1 workers; the calling thread works, too. 0: one thread per processor that
 *  this process may use (its affinity mask, as set by taskset and containers). Workers sleep while
 *  there is no work and block all signals but SIGPIPE, so that handlers run on the caller's
 *  threads. Each has a stack of 1 MiB, independent of the limits of the process.
 *  @return NULL when the threads cannot be created */
IMK_API imk_thread_pool *imk_thread_pool_create(size_t threads);
/** End the workers and wait for them. NULL is allowed. */
IMK_API void imk_thread_pool_destroy(imk_thread_pool *pool);
/** Number of threads of a pool, including the caller's; 1 for NULL. */
IMK_API size_t imk_thread_pool_threads(const imk_thread_pool *pool);

/** Executor of a pool, valid while the pool exists; for NULL a serial one. Threads take items from
 *  a common counter, so unequal items are balanced; everything an item wrote is visible to the
 *  caller when imk_execute() returns. Not reentrant: one imk_execute() at a time, and none from
 *  inside a work item. */
IMK_API imk_executor imk_thread_pool_executor(imk_thread_pool *pool);

IMK_END_C
#endif
