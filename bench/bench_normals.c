/* SPDX-License-Identifier: Apache-2.0 */
/* Standard normals from each kernel of this machine, 1e7 into an array that exists, against NumPy's
 * default_rng().standard_normal(out=) on the same core, in turns; ranges that are not aligned to
 * groups; short calls; and words of Philox4x32-10 against NumPy's. */
#include "bench.h"

#include "imukit/random.h"

enum { COUNT = 10000000, TURNS = 3, REPEATS = 5, KERNELS = 4, SHORT_CALLS = 20000 };

typedef struct normals_run {
    imk_random source;
    uint64_t first;
    size_t count, calls;
    double *out;
    uint32_t *words;
} normals_run;

static void draw_normals(void *context)
{
    normals_run *r = context;
    for (size_t i = 0; i < r->calls; i++)
        imk_random_normals(r->source, 1, r->first, r->count, r->out);
}

static void draw_words(void *context)
{
    normals_run *r = context;
    imk_random_words(r->source, 1, r->first, r->count, r->words);
}

/* Best time [s] of NumPy for COUNT numbers. */
static double numpy_time(const char *what)
{
    char command[512];
    snprintf(command, sizeof command, "/usr/bin/python3 %s/bench/numpy_normals.py %d %s",
             SOURCE_DIRECTORY, COUNT, what);
    return bench_program(command);
}

static size_t sources_here(imk_random sources[KERNELS])
{
    size_t count = 0;
    for (int i = 0; i < KERNELS; i++) {
        setenv("IMUKIT_ISA", imk_kernel_name((imk_kernel)i), 1);
        const imk_random source = imk_random_seeded(1);
        if (source.kernel == (imk_kernel)i)
            sources[count++] = source;
    }
    unsetenv("IMUKIT_ISA");
    return count;
}

/* Best time of a run, ns for each of its numbers. */
static double ns_each(bench_work work, normals_run *r)
{
    return 1e9 * bench_best(REPEATS, work, r) / ((double)r->count * (double)r->calls);
}

int main(void)
{
    bench_pin();
    imk_random sources[KERNELS];
    double ours[KERNELS], numpy = (double)INFINITY;
    const size_t kernels = sources_here(sources);
    normals_run r = {.calls = 1, .count = COUNT, .out = malloc(COUNT * sizeof(double))};
    memset(r.out, 0,
           COUNT * sizeof(double)); /* touch the pages, as NumPy's zeros are by its first run */
    for (size_t i = 0; i < kernels; i++)
        ours[i] = (double)INFINITY;
    for (int turn = 0; turn < TURNS; turn++) {
        for (size_t i = 0; i < kernels; i++) {
            r.source = sources[i];
            ours[i] = fmin(ours[i], bench_best(REPEATS, draw_normals, &r));
        }
        numpy = fmin(numpy,
                     numpy_time("normals")); /* the smaller one of a number and NaN is the number */
    }
    if (isinf(numpy))
        numpy = (double)NAN;
    for (size_t i = 0; i < kernels; i++) {
        const char *isa = imk_kernel_name(sources[i].kernel);
        bench_row_speed("normals_1e7", 1e-6 * COUNT / ours[i], 1e-6 * COUNT / numpy, "M/s", isa, 1);
        bench_row_time("normal", 1e9 * ours[i] / COUNT, 1e9 * numpy / COUNT, "ns", isa, 1);
    }
    for (size_t i = 0; i < kernels; i++) {
        const char *isa = imk_kernel_name(sources[i].kernel);
        normals_run part = {.source = sources[i], .count = 4096, .calls = 500, .out = r.out};
        bench_row_time("normal_in_4096_aligned", ns_each(draw_normals, &part), (double)NAN, "ns",
                       isa, 1);
        part.first = 13;
        bench_row_time("normal_in_4096_unaligned", ns_each(draw_normals, &part), (double)NAN, "ns",
                       isa, 1);
        part = (normals_run){.source = sources[i], .count = 32, .calls = SHORT_CALLS, .out = r.out};
        bench_row_time("call_of_32_normals", 32 * ns_each(draw_normals, &part), (double)NAN, "ns",
                       isa, 1);
    }
    normals_run words = {.calls = 1, .count = COUNT, .words = malloc(COUNT * sizeof(uint32_t))};
    const double word = ns_each(draw_words, &words);
    bench_row_time("philox_word", word, 1e9 * numpy_time("words") / COUNT, "ns", "scalar", 1);
    free(words.words);
    free(r.out);
    return 0;
}
