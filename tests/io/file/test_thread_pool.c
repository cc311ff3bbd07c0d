/* SPDX-License-Identifier: Apache-2.0 */
/* The thread pool: every item exactly once, results visible to the caller, many short batches. Run
 * it under ThreadSanitizer too. */
#if defined(__linux__)
#define _GNU_SOURCE
#else
#define _POSIX_C_SOURCE 200809L
#endif
#include "imukit/thread_pool.h"

#include "check.h"

#include <pthread.h>
#include <sched.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <unistd.h>

/* Each item counts itself without atomics: an item run twice at once, or a result not visible after
 * the batch, is a race that ThreadSanitizer sees and the count usually shows. */
static void count_item(void *context, size_t item)
{
    ((unsigned *)context)[item]++;
}

static void check_batches(imk_thread_pool *pool, size_t batches, size_t items_max)
{
    const imk_executor executor = imk_thread_pool_executor(pool);
    unsigned *counts = calloc(items_max, sizeof *counts);
    assert_non_null(counts);
    size_t expected_total = 0, total = 0;
    for (size_t batch = 0; batch < batches; batch++) {
        const size_t items = batch % (items_max + 1);
        imk_execute(&executor, items, count_item, counts);
        expected_total += items;
    }
    for (size_t item = 0; item < items_max; item++) {
        /* item takes part in every batch with more items than its number */
        size_t expected = 0;
        for (size_t batch = 0; batch < batches; batch++)
            expected += batch % (items_max + 1) > item;
        assert_int_equal(counts[item], expected);
        total += counts[item];
    }
    assert_int_equal(total, expected_total);
    free(counts);
}

static void every_item_runs_once(void **state)
{
    (void)state;
    for (size_t threads = 1; threads <= 8; threads++) {
        imk_thread_pool *pool = imk_thread_pool_create(threads);
        assert_non_null(pool);
        assert_int_equal(imk_thread_pool_threads(pool), threads);
        assert_int_equal(imk_thread_pool_executor(pool).threads, threads);
        check_batches(pool, 1000, 17);
        imk_thread_pool_destroy(pool);
    }
}

static void unused_pool_ends(void **state)
{
    (void)state;
    for (int i = 0; i < 50; i++)
        imk_thread_pool_destroy(imk_thread_pool_create(3));
    imk_thread_pool_destroy(NULL);
}

static void no_pool_is_serial(void **state)
{
    (void)state;
    assert_int_equal(imk_thread_pool_threads(NULL), 1);
    assert_int_equal(imk_thread_pool_executor(NULL).threads, 1);
    check_batches(NULL, 40, 17);
}

/* An impossible number of threads is refused, not half made. */
static void too_many_threads_are_refused(void **state)
{
    (void)state;
    assert_null(imk_thread_pool_create(SIZE_MAX));
}

static void default_is_the_affinity_mask(void **state)
{
    (void)state;
    imk_thread_pool *pool = imk_thread_pool_create(0);
    assert_non_null(pool);
#if defined(__linux__)
    cpu_set_t set;
    assert_int_equal(sched_getaffinity(0, sizeof set, &set), 0);
    assert_int_equal(imk_thread_pool_threads(pool), CPU_COUNT(&set));
#else
    assert_true(imk_thread_pool_threads(pool) >= 1);
#endif
    imk_thread_pool_destroy(pool);
}

/* Two items that wait for each other: ends only when both run at the same time. */
static void meet(void *context, size_t item)
{
    (void)item;
    atomic_int *arrived = context;
    atomic_fetch_add(arrived, 1);
    while (atomic_load(arrived) < 2)
        sched_yield();
}

static void items_run_at_the_same_time(void **state)
{
    (void)state;
    imk_thread_pool *pool = imk_thread_pool_create(2);
    const imk_executor executor = imk_thread_pool_executor(pool);
    for (int i = 0; i < 200; i++) {
        atomic_int arrived = 0;
        imk_execute(&executor, 2, meet, &arrived);
        assert_int_equal(atomic_load(&arrived), 2);
    }
    imk_thread_pool_destroy(pool);
}

typedef struct mask_work {
    pthread_t caller;
    atomic_int workers_seen, unblocked, deaf; /* to a pipe that is closed */
    atomic_size_t stack;
} mask_work;

static void look_at_mask(void *context, size_t item)
{
    mask_work *w = context;
    (void)item;
    sigset_t mask;
    pthread_sigmask(SIG_BLOCK, NULL, &mask);
    if (!pthread_equal(pthread_self(), w->caller)) {
        atomic_fetch_add(&w->workers_seen, 1);
        atomic_fetch_add(&w->unblocked, sigismember(&mask, SIGINT) == 0);
        atomic_fetch_add(&w->deaf, sigismember(&mask, SIGPIPE) == 1);
    }
    while (atomic_load(&w->workers_seen) == 0)
        sched_yield(); /* the caller's item waits until a worker has had one */
}

/* SIGINT must reach the thread that can clean up; SIGPIPE is of the thread that writes. */
static void workers_block_signals(void **state)
{
    (void)state;
    imk_thread_pool *pool = imk_thread_pool_create(2);
    const imk_executor executor = imk_thread_pool_executor(pool);
    mask_work w = {.caller = pthread_self()};
    imk_execute(&executor, 2, look_at_mask, &w);
    assert_true(atomic_load(&w.workers_seen) >= 1);
    assert_int_equal(atomic_load(&w.unblocked), 0);
    assert_int_equal(atomic_load(&w.deaf), 0);
    sigset_t mask;
    pthread_sigmask(SIG_BLOCK, NULL, &mask);
    assert_int_equal(sigismember(&mask, SIGINT), 0);
    imk_thread_pool_destroy(pool);
}

#if defined(__linux__)
static void look_at_stack(void *context, size_t item)
{
    mask_work *w = context;
    (void)item;
    pthread_attr_t attributes;
    void *lowest;
    size_t size;
    if (!pthread_equal(pthread_self(), w->caller)) {
        assert_int_equal(pthread_getattr_np(pthread_self(), &attributes), 0);
        assert_int_equal(pthread_attr_getstack(&attributes, &lowest, &size), 0);
        pthread_attr_destroy(&attributes);
        atomic_store(&w->stack, size);
        atomic_fetch_add(&w->workers_seen, 1);
    }
    while (atomic_load(&w->workers_seen) == 0)
        sched_yield();
}
#endif

/* Left to the system, it is 8 MiB here, 128 KiB there. */
static void workers_have_a_stack_of_a_mebibyte(void **state)
{
    (void)state;
#if defined(__linux__)
    imk_thread_pool *pool = imk_thread_pool_create(2);
    const imk_executor executor = imk_thread_pool_executor(pool);
    mask_work w = {.caller = pthread_self()};
    imk_execute(&executor, 2, look_at_stack, &w);
    assert_in_range(atomic_load(&w.stack), 1 << 20, (1 << 20) + (1 << 16));
    imk_thread_pool_destroy(pool);
#endif
}

int main(void)
{
    /* a deadlock ends the program with SIGALRM instead of hanging the suite */
    alarm(120);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_item_runs_once),
        cmocka_unit_test(unused_pool_ends),
        cmocka_unit_test(no_pool_is_serial),
        cmocka_unit_test(too_many_threads_are_refused),
        cmocka_unit_test(default_is_the_affinity_mask),
        cmocka_unit_test(items_run_at_the_same_time),
        cmocka_unit_test(workers_block_signals),
        cmocka_unit_test(workers_have_a_stack_of_a_mebibyte),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
