/* SPDX-License-Identifier: Apache-2.0 */
/* Allan deviations of 1e7 samples at octave tau, running sums included.
 *
 * - OADEV and MDEV against NumPy's cumsum, slices and np.sum(d**2), on one core and on two threads.
 * - OADEV against the way of tools that take 9999 linear tau, averaging the record anew for each:
 *   timed at 20 of them, evenly spread, and scaled.
 * - The others, without yardstick.
 *
 * How near memory's limit: a pass that reads the record and writes the sums, and a pass that only
 * reads, are timed too (remarks). The sums have an array of their own, so that the record can be
 * used again. */
#include "bench.h"

#include "imukit/allan.h"
#include "imukit/random.h"
#include "imukit/thread_pool.h"

#include <sys/resource.h>

enum { SAMPLES = 10000000, REPEATS = 5, LINEAR_TAU = 9999, LINEAR_TIMED = 20 };

typedef struct allan_run {
    double *rate, *sums;
    const imk_executor *executor;
    imk_allan_statistic statistic;
    size_t count;
    size_t factors[64];
    double variances[64];
    void *workspace;
    size_t workspace_size;
} allan_run;

static void run(void *context)
{
    allan_run *r = context;
    imk_allan_sums(SAMPLES, r->rate, r->sums, r->executor);
    imk_allan_compute(r->statistic, SAMPLES, r->sums, r->count, r->factors, r->variances, NULL,
                      r->executor, r->workspace, r->workspace_size);
}

static void set_statistic(allan_run *r, imk_allan_statistic statistic)
{
    r->statistic = statistic;
    r->count = imk_allan_factors_for(statistic, IMK_ALLAN_OCTAVE, SAMPLES, r->factors);
}

/* Averages over clusters of m, then their differences, for a spread of linear tau. */
static void run_linear(void *context)
{
    allan_run *r = context;
    for (size_t t = 0; t < LINEAR_TIMED; t++) {
        const size_t m = 1 + t * (LINEAR_TAU - 1) / (LINEAR_TIMED - 1);
        double last = 0, total = 0;
        size_t clusters = 0;
        for (size_t i = 0; i + m <= SAMPLES; i += m, clusters++) {
            double sum = 0;
            for (size_t k = 0; k < m; k++)
                sum += r->rate[i + k];
            const double mean = sum / (double)m, d = mean - last;
            total += clusters > 0 ? d * d : 0;
            last = mean;
        }
        r->variances[t] = total / (2.0 * (double)(clusters - 1));
    }
}

static void run_copy(void *context)
{
    allan_run *r = context;
    memcpy(r->sums, r->rate, SAMPLES * sizeof(double));
    bench_use(r->sums);
}

static void bench_statistic(allan_run *r, imk_allan_statistic statistic, const imk_executor *two)
{
    const char *name = imk_allan_name(statistic);
    char command[512], row[64];
    set_statistic(r, statistic);
    bench_pin();
    snprintf(command, sizeof command, "/usr/bin/python3 %s/bench/numpy_allan.py %d %s",
             SOURCE_DIRECTORY, SAMPLES, name);
    const double ours = bench_best(REPEATS, run, r);
    const double yardstick = bench_program(command);
    const double best = fmin(ours, bench_best(REPEATS, run, r));
    snprintf(row, sizeof row, "%s_octave_1e7", name);
    bench_row_time(row, 1e3 * best, 1e3 * yardstick, "ms", "-", 1);
    snprintf(row, sizeof row, "%s_per_sample_and_tau", name);
    bench_row_time(row, 1e9 * best / SAMPLES / (double)r->count,
                   1e9 * yardstick / SAMPLES / (double)r->count, "ns", "-", 1);
    bench_unpin();
    r->executor = two;
    const double both = bench_best(REPEATS, run, r);
    snprintf(row, sizeof row, "%s_octave_1e7_two_threads", name);
    bench_row_time(row, 1e3 * both, 1e3 * yardstick, "ms", "-", 2);
    r->executor = NULL;
}

static void bench_linear(allan_run *r, const imk_executor *two)
{
    set_statistic(r, IMK_ALLAN_OVERLAPPING);
    bench_pin();
    const double ours = bench_best(REPEATS, run, r);
    const double linear = bench_best(1, run_linear, r) * LINEAR_TAU / LINEAR_TIMED;
    bench_row_time("oadev_curve_against_9999_linear_tau", 1e3 * ours, 1e3 * linear, "ms", "-", 1);
    bench_unpin();
    r->executor = two;
    const double both = bench_best(REPEATS, run, r);
    bench_row_time("oadev_curve_against_9999_linear_tau", 1e3 * both, 1e3 * linear, "ms", "-", 2);
    r->executor = NULL;
}

static void bench_others(allan_run *r)
{
    static const imk_allan_statistic others[] = {IMK_ALLAN_HADAMARD, IMK_ALLAN_PARABOLIC,
                                                 IMK_ALLAN_TOTAL, IMK_ALLAN_MODIFIED_TOTAL,
                                                 IMK_ALLAN_HADAMARD_TOTAL};
    bench_pin();
    for (size_t i = 0; i < sizeof others / sizeof others[0]; i++) {
        char row[64];
        set_statistic(r, others[i]);
        r->workspace_size = imk_allan_workspace_size(others[i], SAMPLES, r->count, r->factors, 1);
        r->workspace = malloc(r->workspace_size + 1);
        snprintf(row, sizeof row, "%s_octave_1e7", imk_allan_name(others[i]));
        bench_row_time(row, 1e3 * bench_best(1, run, r), (double)NAN, "ms", "-", 1);
        free(r->workspace);
        r->workspace = NULL;
    }
}

int main(void)
{
    bench_pin();
    allan_run r = {.rate = malloc(SAMPLES * sizeof(double)),
                   .sums = malloc((SAMPLES + 1) * sizeof(double))};
    imk_random_normals(imk_random_seeded(1), 1, 0, SAMPLES, r.rate);
    imk_thread_pool *pool = imk_thread_pool_create(2);
    const imk_executor two = imk_thread_pool_executor(pool);
    const double copy = bench_best(REPEATS, run_copy, &r);
    fprintf(stderr,
            "bench_allan: memory: a copy of the record takes %.1f ms; the sums read it twice and "
            "write once, the variances read at least once: %.1f ms is the limit on one core\n",
            1e3 * copy, 2e3 * copy);
    bench_statistic(&r, IMK_ALLAN_OVERLAPPING, &two);
    struct rusage usage;
    getrusage(RUSAGE_SELF, &usage);
    fprintf(stderr, "bench_allan: peak memory %ld MB for an input of %d MB\n",
            usage.ru_maxrss / 1024, (int)(SAMPLES * sizeof(double) / 1000000));
    bench_statistic(&r, IMK_ALLAN_MODIFIED, &two);
    bench_linear(&r, &two);
    bench_others(&r);
    imk_thread_pool_destroy(pool);
    free(r.rate);
    free(r.sums);
    return 0;
}
