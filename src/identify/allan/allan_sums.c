/* SPDX-License-Identifier: Apache-2.0 */
/* Running sums of a rate record less its mean, right to the last digit however long it is. */
#include "allan_internal.h"

/* Sums of blocks in LANES parts, about a shift near the mean so that a large constant costs no
 * digits; the blocks' sums with the rounding error of each addition carried along
 * [KNUTH1998, 4.2.2]. The lanes let the compiler use vectors, several at a time; their order, and
 * so the result, is the same on every machine. */
enum { LANES = IMKI_ALLAN_LANES, BLOCK = 2048 };

static double block_sum(const double *values, size_t count, double shift)
{
    double lane[LANES] = {0};
    size_t i = 0;
    for (; i + LANES <= count; i += LANES)
        for (size_t l = 0; l < LANES; l++)
            lane[l] += values[i + l] - shift;
    for (; i < count; i++)
        lane[0] += values[i] - shift;
    return imki_sum_lanes(lane);
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
