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

/* Segments run side by side, so that vectors take a sample of each: an addition waits for the one
 * before it in its segment. The error of every addition is carried along: a sum is right to its
 * last digit however long the record. A tile of samples is read before its sums are written, so
 * that sums and record may share memory. */
enum { TOGETHER = 8, TILE = 32 };

typedef struct running_sum {
    size_t place;
    double sum, error, value; /* up to `place`, and the sample there */
} running_sum;

IMKI_INLINED void step(const sums_work *w, running_sum *r)
{
    r->sum = add_exactly(r->sum, (r->value - w->shift) - w->mean, &r->error);
    r->place++;
    r->value = r->place < w->n ? w->rate[r->place] : 0;
    w->sums[r->place] = r->sum + r->error;
}

/* Returns the first segment's last sum. */
IMKI_INLINED double tile_sums(const sums_work *w, running_sum *running)
{
    double tile[TILE][TOGETHER], sum[TOGETHER], error[TOGETHER];
    for (size_t l = 0; l < TOGETHER; l++) {
        running_sum *r = &running[l];
        tile[0][l] = r->value;
        for (size_t i = 1; i < TILE; i++)
            tile[i][l] = w->rate[r->place + i];
        r->place += TILE;
        r->value = r->place < w->n ? w->rate[r->place] : 0;
        sum[l] = r->sum;
        error[l] = r->error;
    }
    for (size_t i = 0; i < TILE; i++)
        for (size_t l = 0; l < TOGETHER; l++) {
            sum[l] = add_exactly(sum[l], (tile[i][l] - w->shift) - w->mean, &error[l]);
            tile[i][l] = sum[l] + error[l];
        }
    for (size_t l = 0; l < TOGETHER; l++) {
        running_sum *r = &running[l];
        for (size_t i = 0; i < TILE; i++)
            w->sums[r->place - TILE + 1 + i] = tile[i][l];
        r->sum = sum[l];
        r->error = error[l];
    }
    return sum[0];
}

IMKI_ALLAN_VERSIONS(tile_sums, (const sums_work *w, running_sum *running), w, running)

static void segment_sums(void *context, size_t item)
{
    const sums_work *w = context;
    const size_t first = item * TOGETHER, shortest = w->n / SEGMENTS;
    const imk_kernel kernel = imk_random_seeded(0).kernel;
    running_sum running[TOGETHER];
    for (size_t l = 0; l < TOGETHER; l++)
        running[l] = (running_sum){segment_begin(w, first + l), w->total[first + l],
                                   w->error[first + l], w->first[first + l]};
    for (size_t done = 0; done + TILE <= shortest; done += TILE)
        (void)IMKI_ALLAN_CALL(kernel, tile_sums, w, running);
    for (size_t l = 0; l < TOGETHER; l++)
        while (running[l].place < segment_begin(w, first + l + 1))
            step(w, &running[l]);
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
    imk_execute(executor, SEGMENTS / TOGETHER, segment_sums, &w);
}
