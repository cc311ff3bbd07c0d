/* SPDX-License-Identifier: Apache-2.0 */
/* A pool of POSIX threads that sleep until there are work items.
 *
 * One batch at a time: run() publishes it under the mutex, wakes workers, takes items itself, then
 * closes the batch and waits for the workers inside it. A worker that wakes late finds the batch
 * closed and sleeps on, so a short batch never waits for a slow awakening. */
#if defined(__linux__)
#define _GNU_SOURCE /* sched_getaffinity() */
#else
#define _POSIX_C_SOURCE 200809L
#endif
#include "imukit/thread_pool.h"

#include <pthread.h>
#include <sched.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdlib.h>
#include <unistd.h>

enum {
    THREADS_MAX = 65536, /* beyond any machine: a request for more is a mistake */
    /* The core goes 48 KiB deep at most, readers and writers as deep on top of it, work items of
     * the caller's have the rest; sanitizers make frames three times as large. What is not touched
     * costs addresses only. Left to itself, the size is what `ulimit -s` says, or 128 KiB with
     * musl. */
    STACK = 1 << 20
};

struct imk_thread_pool {
    pthread_mutex_t mutex;
    pthread_cond_t awake; /* there is a batch, or the end */
    pthread_cond_t idle;  /* no worker is inside the batch */
    bool ending;
    bool open;     /* the batch takes workers */
    size_t inside; /* workers in the batch */
    size_t count;  /* of items; this, work and work_context are constant while inside > 0 */
    imk_work work;
    void *work_context;
    atomic_size_t next; /* first item nobody has taken */
    size_t workers;
    pthread_t *worker;
};

/* Take items until there are none. */
static void take_items(imk_thread_pool *pool, size_t count, imk_work work, void *work_context)
{
    for (;;) {
        const size_t item = atomic_fetch_add_explicit(&pool->next, 1, memory_order_relaxed);
        if (item >= count)
            return;
        work(work_context, item);
    }
}

static void *worker_main(void *argument)
{
    imk_thread_pool *pool = argument;
    pthread_mutex_lock(&pool->mutex);
    for (;;) {
        while (!pool->open && !pool->ending)
            pthread_cond_wait(&pool->awake, &pool->mutex);
        if (pool->ending)
            break;
        pool->inside++;
        const size_t count = pool->count;
        const imk_work work = pool->work;
        void *work_context = pool->work_context;
        pthread_mutex_unlock(&pool->mutex);
        take_items(pool, count, work, work_context);
        pthread_mutex_lock(&pool->mutex);
        pool->open = false; /* no items are left */
        if (--pool->inside == 0)
            pthread_cond_signal(&pool->idle);
    }
    pthread_mutex_unlock(&pool->mutex);
    return NULL;
}

static void run(void *context, size_t count, imk_work work, void *work_context)
{
    imk_thread_pool *pool = context;
    if (count <= 1 || pool->workers == 0) {
        for (size_t item = 0; item < count; item++)
            work(work_context, item);
        return;
    }
    pthread_mutex_lock(&pool->mutex);
    pool->count = count;
    pool->work = work;
    pool->work_context = work_context;
    atomic_store_explicit(&pool->next, 0, memory_order_relaxed);
    pool->open = true;
    pthread_mutex_unlock(&pool->mutex);
    if (count > pool->workers)
        pthread_cond_broadcast(&pool->awake);
    else
        for (size_t i = 1; i < count; i++)
            pthread_cond_signal(&pool->awake);

    take_items(pool, count, work, work_context);

    pthread_mutex_lock(&pool->mutex);
    pool->open = false;
    while (pool->inside > 0)
        pthread_cond_wait(&pool->idle, &pool->mutex);
    pthread_mutex_unlock(&pool->mutex);
}

/* Processors this process may use. */
static size_t processors(void)
{
#if defined(__linux__)
    /* The mask of a machine with more than CPU_SETSIZE processors needs a larger set. */
    for (int size = CPU_SETSIZE; size <= 1 << 20; size *= 4) {
        cpu_set_t *set = CPU_ALLOC(size);
        const size_t bytes = CPU_ALLOC_SIZE(size);
        if (!set)
            break;
        const int count = sched_getaffinity(0, bytes, set) == 0 ? CPU_COUNT_S(bytes, set) : 0;
        CPU_FREE(set);
        if (count > 0)
            return (size_t)count;
    }
#endif
    const long count = sysconf(_SC_NPROCESSORS_ONLN);
    return count > 0 ? (size_t)count : 1;
}

/* Start the workers, with all signals blocked in them but SIGPIPE: it comes to the thread that
 * writes to a closed pipe, and is to end the process whichever thread that is. */
static bool start_workers(imk_thread_pool *pool, size_t count)
{
    sigset_t all, before;
    pthread_attr_t attributes;
    if (pthread_attr_init(&attributes) != 0)
        return false;
    const bool sized = pthread_attr_setstacksize(&attributes, STACK) == 0;
    sigfillset(&all);
    sigdelset(&all, SIGPIPE);
    pthread_sigmask(SIG_BLOCK, &all, &before);
    while (sized && pool->workers < count &&
           pthread_create(&pool->worker[pool->workers], &attributes, worker_main, pool) == 0)
        pool->workers++;
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    pthread_attr_destroy(&attributes);
    return pool->workers == count;
}

imk_thread_pool *imk_thread_pool_create(size_t threads)
{
    if (threads > THREADS_MAX)
        return NULL;
    const size_t workers = (threads == 0 ? processors() : threads) - 1;
    imk_thread_pool *pool = calloc(1, sizeof *pool);
    if (!pool)
        return NULL;
    pool->worker = calloc(workers + 1, sizeof *pool->worker);
    if (!pool->worker) {
        free(pool);
        return NULL;
    }
    pthread_mutex_init(&pool->mutex, NULL);
    pthread_cond_init(&pool->awake, NULL);
    pthread_cond_init(&pool->idle, NULL);
    atomic_init(&pool->next, 0);
    if (!start_workers(pool, workers)) {
        imk_thread_pool_destroy(pool);
        return NULL;
    }
    return pool;
}

void imk_thread_pool_destroy(imk_thread_pool *pool)
{
    if (!pool)
        return;
    pthread_mutex_lock(&pool->mutex);
    pool->ending = true;
    pthread_mutex_unlock(&pool->mutex);
    pthread_cond_broadcast(&pool->awake);
    for (size_t i = 0; i < pool->workers; i++)
        pthread_join(pool->worker[i], NULL);
    pthread_cond_destroy(&pool->idle);
    pthread_cond_destroy(&pool->awake);
    pthread_mutex_destroy(&pool->mutex);
    free(pool->worker);
    free(pool);
}

size_t imk_thread_pool_threads(const imk_thread_pool *pool)
{
    return pool ? pool->workers + 1 : 1;
}

/* The serial executor runs nothing in parallel and needs no context. */
static void run_serial(void *context, size_t count, imk_work work, void *work_context)
{
    (void)context;
    for (size_t item = 0; item < count; item++)
        work(work_context, item);
}

imk_executor imk_thread_pool_executor(imk_thread_pool *pool)
{
    if (!pool)
        return (imk_executor){.run = run_serial, .context = NULL, .threads = 1};
    return (imk_executor){.run = run, .context = pool, .threads = pool->workers + 1};
}
