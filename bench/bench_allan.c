/* SPDX-License-Identifier: Apache-2.0 */
/* Overlapped Allan deviation of 1e7 samples at octave tau, running sums included, against NumPy's
 * cumsum, slices and np.sum(d**2). The sums have an array of their own, so that the record can be
 * used again: peak memory, printed as a remark, is the input and that array. */
#include "bench.h"

#include "imukit/allan.h"
#include "imukit/random.h"
#include "imukit/thread_pool.h"

#include <sys/resource.h>

enum { SAMPLES = 10000000, REPEATS = 5 };

typedef struct allan_run {
    double *rate, *sums;
    const imk_executor *executor;
    size_t count;
    size_t factors[64];
    double variances[64];
} allan_run;

static void run(void *context)
{
    allan_run *r = context;
    imk_allan_sums(SAMPLES, r->rate, r->sums, r->executor);
    imk_allan_variances(IMK_ALLAN_OVERLAPPING, SAMPLES, r->sums, r->count, r->factors, r->variances,
                        NULL, r->executor);
}

int main(void)
{
    bench_pin();
    allan_run r = {.rate = malloc(SAMPLES * sizeof(double)),
                   .sums = malloc((SAMPLES + 1) * sizeof(double))};
    imk_random_normals(imk_random_seeded(1), 1, 0, SAMPLES, r.rate);
    r.count = imk_allan_factors(IMK_ALLAN_OCTAVE, SAMPLES, r.factors);

    char command[512];
    snprintf(command, sizeof command, "/usr/bin/python3 %s/bench/numpy_allan.py %d",
             SOURCE_DIRECTORY, SAMPLES);
    const double ours = bench_best(REPEATS, run, &r);
    const double yardstick = bench_program(command);
    const double again = bench_best(REPEATS, run, &r);
    const double best = fmin(ours, again);
    bench_row_time("oadev_octave_1e7", 1e3 * best, 1e3 * yardstick, "ms", "-", 1);
    bench_row_time("oadev_per_sample_and_tau", 1e9 * best / SAMPLES / (double)r.count,
                   1e9 * yardstick / SAMPLES / (double)r.count, "ns", "-", 1);
    struct rusage usage;
    getrusage(RUSAGE_SELF, &usage);
    fprintf(stderr, "bench_allan: peak memory %ld MB for an input of %d MB\n",
            usage.ru_maxrss / 1024, (int)(SAMPLES * sizeof(double) / 1000000));

    bench_unpin();
    imk_thread_pool *pool = imk_thread_pool_create(2);
    const imk_executor executor = imk_thread_pool_executor(pool);
    r.executor = &executor;
    const double two = bench_best(REPEATS, run, &r);
    bench_row_time("oadev_octave_1e7_two_threads", 1e3 * two, 1e3 * best, "ms", "-", 2);
    imk_thread_pool_destroy(pool);
    return 0;
}
