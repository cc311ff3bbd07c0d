/* SPDX-License-Identifier: Apache-2.0 */
/* Helpers of the benchmark programs. Include it first: it asks for the GNU interfaces it needs.
 *
 * A benchmark program pins itself to one core, times our code and the yardstick in turns, keeps the
 * shortest time of each (noise of a shared machine only ever adds), and prints rows
 *
 *     name,ours,yardstick,ratio,unit,isa,threads
 *
 * on standard output, nothing else; remarks go to standard error. `ratio` says how many times
 * better we are: ours/yardstick for a speed, yardstick/ours for a time. A yardstick that could not
 * be run is NaN and leaves its cells empty. */
#ifndef IMUKIT_BENCH_H
#define IMUKIT_BENCH_H

#ifndef _GNU_SOURCE
#define _GNU_SOURCE
#endif

#include <math.h>
#include <sched.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

/** Monotonic time [s], not slewed by a clock daemon. */
static inline double bench_now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC_RAW, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/** Core to measure on: IMUKIT_BENCH_CORE, else the one this process runs on. */
static inline int bench_core(void)
{
    const char *text = getenv("IMUKIT_BENCH_CORE");
    return text && *text ? atoi(text) : sched_getcpu();
}

/** Pin this process (and the yardsticks it starts) to one core, and return that core. Where that
 *  is not allowed, the measurement goes on unpinned. */
static inline int bench_pin(void)
{
    int core = bench_core();
    if (core >= 0 && core < CPU_SETSIZE) {
        cpu_set_t set;
        CPU_ZERO(&set);
        CPU_SET(core, &set);
        if (sched_setaffinity(0, sizeof set, &set) != 0)
            fprintf(stderr, "bench: not pinned to core %d\n", core);
    }
    return core;
}

/** Let this process use every core again, for measurements with threads. */
static inline void bench_unpin(void)
{
    cpu_set_t set;
    CPU_ZERO(&set);
    for (int core = 0; core < CPU_SETSIZE; core++)
        CPU_SET(core, &set);
    sched_setaffinity(0, sizeof set, &set);
}

/** A piece of work to time. */
typedef void (*bench_work)(void *context);

/** Time of one run [s]. */
static inline double bench_once(bench_work work, void *context)
{
    double start = bench_now();
    work(context);
    return bench_now() - start;
}

/** Shortest of `repeats` runs [s], after one that warms caches and clock. */
static inline double bench_best(int repeats, bench_work work, void *context)
{
    work(context);
    double best = (double)INFINITY;
    for (int i = 0; i < repeats; i++)
        best = fmin(best, bench_once(work, context));
    return best;
}

/** Speed-up that cores 0 and 1 allow for a piece of work: cores of a shared machine are not equally
 *  fast. The work runs alone on each in turns; two threads can at best add the two speeds, and are
 *  compared with the faster core. Printed as a remark. The process may use every core afterwards.
 */
static inline double bench_two_core_limit(const char *name, int repeats, bench_work work,
                                          void *context)
{
    double best[2] = {(double)INFINITY, (double)INFINITY};
    for (int i = 0; i < repeats; i++)
        for (int core = 0; core < 2; core++) {
            cpu_set_t set;
            CPU_ZERO(&set);
            CPU_SET(core, &set);
            sched_setaffinity(0, sizeof set, &set);
            best[core] = fmin(best[core], bench_once(work, context));
        }
    bench_unpin();
    const double limit = 1 + fmin(best[0], best[1]) / fmax(best[0], best[1]);
    fprintf(stderr,
            "bench: %s: cores 0 and 1 alone take %.3g and %.3g ms: a speed-up of %.2f at best\n",
            name, 1e3 * best[0], 1e3 * best[1], limit);
    return limit;
}

/** Shortest times [s] of ours and the yardstick, run in turns so that both see the same machine.
 *  @param yardstick  NULL when there is none: its time is NaN */
static inline void bench_compare(int repeats, bench_work ours, void *ours_context,
                                 bench_work yardstick, void *yardstick_context, double *ours_time,
                                 double *yardstick_time)
{
    double best_ours = bench_best(1, ours, ours_context);
    double best_yardstick = yardstick ? bench_best(1, yardstick, yardstick_context) : (double)NAN;
    for (int i = 1; i < repeats; i++) {
        best_ours = fmin(best_ours, bench_once(ours, ours_context));
        if (yardstick)
            best_yardstick = fmin(best_yardstick, bench_once(yardstick, yardstick_context));
    }
    *ours_time = best_ours;
    *yardstick_time = best_yardstick;
}

/** Keep a result alive, so that the compiler cannot drop the work that made it. */
static inline void bench_use(const void *pointer)
{
    __asm__ volatile("" : : "g"(pointer) : "memory");
}

/** Number printed by a yardstick program, such as
 *
 *      /usr/bin/python3 SOURCE_DIRECTORY/bench/numpy_normals.py 10000000
 *
 *  NaN when the program cannot be run or prints none. It inherits this process' core. */
static inline double bench_program(const char *command)
{
    double value = (double)NAN;
    fflush(NULL);
    FILE *pipe = popen(command, "r");
    if (!pipe)
        return (double)NAN;
    if (fscanf(pipe, "%lf", &value) != 1)
        value = (double)NAN;
    if (pclose(pipe) != 0)
        value = (double)NAN;
    if (isnan(value))
        fprintf(stderr, "bench: no yardstick from: %s\n", command);
    return value;
}

static inline void bench_print_row(const char *name, double ours, double yardstick, double ratio,
                                   const char *unit, const char *isa, size_t threads)
{
    if (isfinite(yardstick))
        printf("%s,%.4g,%.4g,%.3g,%s,%s,%zu\n", name, ours, yardstick, ratio, unit, isa, threads);
    else
        printf("%s,%.4g,,,%s,%s,%zu\n", name, ours, unit, isa, threads);
    fflush(stdout);
}

/** Row of a speed: more is better ("M/s", "MB/s").
 *  @param isa  imk_kernel_name() where kernels differ, else "-" */
static inline void bench_row_speed(const char *name, double ours, double yardstick,
                                   const char *unit, const char *isa, size_t threads)
{
    bench_print_row(name, ours, yardstick, ours / yardstick, unit, isa, threads);
}

/** Row of a time: less is better ("ms", "ns"). */
static inline void bench_row_time(const char *name, double ours, double yardstick, const char *unit,
                                  const char *isa, size_t threads)
{
    bench_print_row(name, ours, yardstick, yardstick / ours, unit, isa, threads);
}

/** Name of the processor as the kernel gives it, "unknown" where it does not. */
static inline void bench_cpu_name(char *text, size_t size)
{
    snprintf(text, size, "unknown");
    FILE *file = fopen("/proc/cpuinfo", "r");
    if (!file)
        return;
    char line[512];
    while (fgets(line, sizeof line, file)) {
        char *value = strchr(line, ':');
        if (strncmp(line, "model name", 10) == 0 && value) {
            value[strcspn(value, "\n")] = '\0';
            snprintf(text, size, "%s", value + 2);
            break;
        }
    }
    fclose(file);
}

#endif
