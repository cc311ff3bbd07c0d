/* SPDX-License-Identifier: Apache-2.0 */
/** @file thread_pool.h
 *  POSIX threads behind imk_executor. */
#ifndef IMUKIT_THREAD_POOL_H
#define IMUKIT_THREAD_POOL_H

#include "imukit/executor.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct imk_thread_pool imk_thread_pool;

/** Start `threads` - 1 workers (the caller is the other); 0 takes one per processor this process
 *  may use. NULL when threads cannot be made. */
IMK_API imk_thread_pool *imk_thread_pool_create(size_t threads);
/** NULL is allowed. */
IMK_API void imk_thread_pool_destroy(imk_thread_pool *pool);
/** Executor of a pool, valid while the pool lives; of NULL a serial one. Not reentrant: one
 *  imk_execute() at a time, and none from inside a work item. */
IMK_API imk_executor imk_thread_pool_executor(imk_thread_pool *pool);

#ifdef __cplusplus
}
#endif
#endif
