/* SPDX-License-Identifier: Apache-2.0 */
/* Allan variances from running sums of a rate record.
 *
 *     OAVAR(m) = 1/(2 m^2 M) sum_{j=0}^{M-1} (s[j+2m] - 2 s[j+m] + s[j])^2,   M = n - 2m + 1
 *
 * [RILEY2008, eq. (11)] with s the sums (phase/dt); the plain variance takes every m-th term only.
 */
#include "imukit/allan.h"
#include "imukit/random.h"

#include <math.h>
#include <string.h>

size_t imk_allan_factors(imk_allan_grid grid, size_t n, size_t *factors)
{
    const size_t per_decade = 10;
    size_t count = 0, last = 0;
    for (size_t step = 0;; step++) {
        size_t m = step + 1;
        if (grid == IMK_ALLAN_OCTAVE)
            m = step < 63 ? (size_t)1 << step : n;
        else if (grid == IMK_ALLAN_DECADE)
            m = (size_t)(pow(10.0, (double)step / (double)per_decade) + 0.5);
        if (m > n / 2)
            return count;
        if (m == last)
            continue;
        if (factors)
            factors[count] = m;
        count++;
        last = m;
    }
}

/* Sums of blocks in LANES parts, about a shift near the mean so that a large constant costs no
 * digits; the blocks' sums with the rounding error of each addition carried along
 * [KNUTH1998, 4.2.2]. The lanes let the compiler use vectors, several at a time; their order, and
 * so the result, is the same on every machine. */
enum { LANES = 16, BLOCK = 2048 };

/* Sum of the lanes, which are used up, in a fixed order. */
static inline double sum_lanes(double *lane)
{
    for (size_t half = LANES / 2; half > 0; half /= 2)
        for (size_t l = 0; l < half; l++)
            lane[l] += lane[l + half];
    return lane[0];
}

static double block_sum(const double *values, size_t count, double shift)
{
    double lane[LANES] = {0};
    size_t i = 0;
    for (; i + LANES <= count; i += LANES)
        for (size_t l = 0; l < LANES; l++)
            lane[l] += values[i + l] - shift;
    for (; i < count; i++)
        lane[0] += values[i] - shift;
    return sum_lanes(lane);
}

/* sum + step exactly: the rounded sum, and what it lacks. */
static double add_exactly(double sum, double step, double *error)
{
    const double next = sum + step, part = next - sum;
    *error += (sum - (next - part)) + (step - part);
    return next;
}

/* The record is cut into SEGMENTS, which threads take one by one: their sums first, then, when it
 * is known where each begins, the running sums inside. */
enum { SEGMENTS = 64 };

typedef struct sums_work {
    size_t n;
    const double *rate;
    double *sums;
    double shift, mean;                      /* a sample of the record; the mean less the shift */
    double first[SEGMENTS];                  /* sample that the segment before may overwrite */
    double total[SEGMENTS], error[SEGMENTS]; /* of a segment, later of all before it */
} sums_work;

static size_t segment_begin(const sums_work *w, size_t segment)
{
    return w->n / SEGMENTS * segment + w->n % SEGMENTS * segment / SEGMENTS;
}

static void segment_total(void *context, size_t segment)
{
    sums_work *w = context;
    const size_t end = segment_begin(w, segment + 1);
    double sum = 0, error = 0;
    for (size_t i = segment_begin(w, segment); i < end; i += BLOCK)
        sum = add_exactly(sum, block_sum(w->rate + i, end - i < BLOCK ? end - i : BLOCK, w->shift),
                          &error);
    w->total[segment] = sum;
    w->error[segment] = error;
}

/* The error of every addition is carried along: a sum is right to its last digit however long the
 * record. Reading stays ahead of writing, so that sums and record may share memory. */
static void segment_sums(void *context, size_t segment)
{
    const sums_work *w = context;
    const size_t begin = segment_begin(w, segment), end = segment_begin(w, segment + 1);
    double sum = w->total[segment], error = w->error[segment], value = w->first[segment];
    for (size_t i = begin; i < end; i++) {
        sum = add_exactly(sum, (value - w->shift) - w->mean, &error);
        if (i + 1 < end)
            value = w->rate[i + 1];
        w->sums[i + 1] = sum + error;
    }
}

void imk_allan_sums(size_t n, const double *rate, double *sums, const imk_executor *executor)
{
    sums_work w = {.n = n, .rate = rate, .sums = sums, .shift = n > 0 ? rate[0] : 0};
    imk_execute(executor, SEGMENTS, segment_total, &w);
    double sum = 0, error = 0;
    for (size_t segment = 0; segment < SEGMENTS; segment++) {
        sum = add_exactly(sum, w.total[segment], &error);
        error += w.error[segment];
    }
    w.mean = n > 0 ? (sum + error) / (double)n : 0;
    sum = error = 0;
    for (size_t segment = 0; segment < SEGMENTS; segment++) {
        const size_t begin = segment_begin(&w, segment), end = segment_begin(&w, segment + 1);
        const double total = w.total[segment] - (double)(end - begin) * w.mean;
        const double rest = w.error[segment];
        w.first[segment] = begin < n ? rate[begin] : 0;
        w.total[segment] = sum;
        w.error[segment] = error;
        sum = add_exactly(sum, total, &error);
        error += rest;
    }
    sums[0] = 0;
    imk_execute(executor, SEGMENTS, segment_sums, &w);
}

/* Sum of squared second differences of `count` (<= BLOCK) consecutive terms. */
static inline double overlapping_block(const double *s, size_t m, size_t count)
{
    const double *a = s, *b = s + m, *c = s + 2 * m;
    double lane[LANES] = {0};
    size_t j = 0;
    for (; j + LANES <= count; j += LANES)
        for (size_t l = 0; l < LANES; l++) {
            const double middle = b[j + l], d = (c[j + l] - middle) - (middle - a[j + l]);
            lane[l] += d * d;
        }
    for (; j < count; j++) {
        const double middle = b[j], d = (c[j] - middle) - (middle - a[j]);
        lane[0] += d * d;
    }
    return sum_lanes(lane);
}

#if defined(__x86_64__) && defined(__GNUC__)
__attribute__((target("avx512f"))) static double block_avx512(const double *s, size_t m,
                                                              size_t count)
{
    return overlapping_block(s, m, count);
}

__attribute__((target("avx2"))) static double block_avx2(const double *s, size_t m, size_t count)
{
    return overlapping_block(s, m, count);
}
#endif

static double block_for(imk_kernel kernel, const double *s, size_t m, size_t count)
{
#if defined(__x86_64__) && defined(__GNUC__)
    if (kernel == IMK_KERNEL_AVX512)
        return block_avx512(s, m, count);
    if (kernel == IMK_KERNEL_AVX2)
        return block_avx2(s, m, count);
#endif
    (void)kernel;
    return overlapping_block(s, m, count);
}

static double plain_sum(const double *s, size_t m, size_t count)
{
    double total = 0;
    for (size_t j = 0; j < count; j++) {
        const double *a = s + j * m;
        double d = (a[2 * m] - a[m]) - (a[m] - a[0]);
        total += d * d;
    }
    return total;
}

/* Factors in a group share a walk through the record, a block at a time, so that it comes from
 * memory once for all of them. A short list (octaves) is dealt out to as many groups as there are
 * threads, large and small factors alike; a long one is cut into neighbours, whose windows overlap.
 */
enum { DEALT_MAX = 64, NEIGHBOURS = 8 };

typedef struct variance_work {
    imk_allan_statistic statistic;
    imk_kernel kernel;
    size_t n, factor_count, groups;
    const double *sums;
    const size_t *factors;
    double *variances;
    size_t *counts;
} variance_work;

static void variance_group(void *context, size_t item)
{
    const variance_work *w = context;
    const bool dealt = w->factor_count <= DEALT_MAX;
    const size_t first = dealt ? item : item * NEIGHBOURS, stride = dealt ? w->groups : 1;
    const size_t most = dealt ? DEALT_MAX : NEIGHBOURS;
    double total[DEALT_MAX] = {0};
    size_t count[DEALT_MAX], size = 0, longest = 0;
    for (size_t i = first; i < w->factor_count && size < most; i += stride, size++) {
        const size_t m = w->factors[i];
        count[size] = w->statistic == IMK_ALLAN_PLAIN ? w->n / m - 1 : w->n - 2 * m + 1;
        longest = count[size] > longest ? count[size] : longest;
    }
    if (w->statistic == IMK_ALLAN_PLAIN)
        for (size_t i = 0; i < size; i++)
            total[i] = plain_sum(w->sums, w->factors[first + i * stride], count[i]);
    else
        for (size_t j = 0; j < longest; j += BLOCK)
            for (size_t i = 0; i < size; i++)
                if (j < count[i])
                    total[i] += block_for(w->kernel, w->sums + j, w->factors[first + i * stride],
                                          count[i] - j < BLOCK ? count[i] - j : BLOCK);
    for (size_t i = 0; i < size; i++) {
        const size_t place = first + i * stride;
        const double m = (double)w->factors[place];
        w->variances[place] = total[i] / (2.0 * m * m * (double)count[i]);
        if (w->counts)
            w->counts[place] = count[i];
    }
}

imk_status imk_allan_variances(imk_allan_statistic statistic, size_t n, const double *sums,
                               size_t factor_count, const size_t *factors, double *variances,
                               size_t *counts, const imk_executor *executor)
{
    for (size_t i = 0; i < factor_count; i++)
        if (factors[i] < 1 || factors[i] > n / 2)
            return n < 2 ? IMK_ERROR_TOO_SHORT : IMK_ERROR_RANGE;
    const size_t threads = executor && executor->threads > 0 ? executor->threads : 1;
    const size_t groups = factor_count > DEALT_MAX ? (factor_count + NEIGHBOURS - 1) / NEIGHBOURS
                          : threads < factor_count ? threads
                                                   : factor_count;
    variance_work work = {
        statistic, imk_random_seeded(0).kernel, n, factor_count, groups, sums, factors, variances,
        counts};
    imk_execute(executor, groups, variance_group, &work);
    return IMK_OK;
}
