/* SPDX-License-Identifier: Apache-2.0 */
/** @file executor.h
 *  Lets the library use threads of the caller; the library makes none itself. */
#ifndef IMUKIT_EXECUTOR_H
#define IMUKIT_EXECUTOR_H

#include "imukit/status.h"

IMK_BEGIN_C

/** One independent piece of work: item 0 … count - 1, in any order, on any thread. */
typedef void (*imk_work)(void *work_context, size_t item);

/** Runs work items and returns when all are done. A NULL executor is serial. thread_pool.h makes
 *  one from POSIX threads. */
typedef struct imk_executor {
    void (*run)(void *context, size_t count, imk_work work, void *work_context);
    void *context;
    size_t threads; /**< how many items can run at once, >= 1 */
} imk_executor;

/** Run the items on an executor, or one after another when it is NULL. */
IMK_API void imk_execute(const imk_executor *executor, size_t count, imk_work work,
                         void *work_context);

IMK_END_C
#endif
