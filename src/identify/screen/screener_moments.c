/* SPDX-License-Identifier: Apache-2.0 */
/* Extremes, mean and variances of the chunks of a record, in lanes that the compiler makes vectors
 * of. */
#include "screener_internal.h"

#include <math.h>

enum { BLOCK = IMKI_BLOCK };

void imki_screen_extremes(size_t count, const double *x, double *low, double *high)
{
    enum { LANES = 8 };
    double least[LANES], most[LANES];
    for (size_t l = 0; l < LANES; l++) {
        least[l] = HUGE_VAL;
        most[l] = -HUGE_VAL;
    }
    for (size_t i = 0; i < count; i += LANES) {
        const size_t width = count - i < LANES ? count - i : LANES;
        for (size_t l = 0; l < width; l++) {
            least[l] = x[i + l] < least[l] ? x[i + l] : least[l];
            most[l] = x[i + l] > most[l] ? x[i + l] : most[l];
        }
    }
    *low = least[0];
    *high = most[0];
    for (size_t l = 1; l < LANES; l++) {
        *low = least[l] < *low ? least[l] : *low;
        *high = most[l] > *high ? most[l] : *high;
    }
}

static double root_sum(double a, double b)
{
    const double large = fmax(a, b), small = fmin(a, b);
    return large > 0 ? large * sqrt(1 + small / large * (small / large)) : 0;
}

/* Sum and squares of scaled distances from an origin, of what is there. */
static void sum_moments(size_t count, const double *x, double scale, double origin, double *sum,
                        double *squares)
{
    enum { LANES = 8 };
    double total[LANES] = {0}, square[LANES] = {0};
    for (size_t i = 0; i < count; i += LANES) {
        const size_t width = count - i < LANES ? count - i : LANES;
        for (size_t l = 0; l < width; l++) {
            const double distance = x[i + l] * scale - origin;
            const double d = distance == distance ? distance : 0;
            total[l] += d;
            square[l] += d * d;
        }
    }
    *sum = *squares = 0;
    for (size_t l = 0; l < LANES; l++) {
        *sum += total[l];
        *squares += square[l];
    }
}

/* Mean and root sum of squares about it, joined with those before [CHAN1983, (2.1)]; scaled, so
 * that squares neither overflow nor vanish. */
void imki_screen_moments(imk_screener *s, int at, size_t missing)
{
    const size_t count = s->count[at];
    const double present = (double)(count - missing), *samples = s->raw[at];
    double sum, squares;
    int exponent;
    imki_screen_extremes(count, samples, &s->lowest[at], &s->highest[at]);
    if (missing == count)
        return;
    const double low = s->lowest[at], high = s->highest[at];
    frexp(fmax(fabs(low), fabs(high)), &exponent);
    const double scale = ldexp(1, exponent < -1000 ? 1000 : -exponent), origin = low * scale;
    sum_moments(count, samples, scale, origin, &sum, &squares);
    const double variance = squares - sum * sum / present;
    const double norm = high > low && variance > 0 ? sqrt(variance) / scale : 0;
    const double before = (double)s->found.present, all = before + present;
    const double mean = low + sum / present / scale, apart = before > 0 ? mean - s->mean : 0;
    s->norm = root_sum(root_sum(s->norm, norm), fabs(apart) * sqrt(before / all * present));
    s->mean = before > 0 ? s->mean + apart * (present / all) : mean;
    s->found.present += count - missing;
}

/* Sum of the variances of whole blocks, and how many there are. */
static size_t fast_variance(size_t count, const double *samples, double *total)
{
    size_t blocks = 0;
    for (size_t i = 0; i + BLOCK <= count; i += BLOCK) {
        const double origin = samples[i];
        double sum[8] = {0}, square[8] = {0};
        for (size_t k = i; k < i + BLOCK; k += 8)
            for (size_t l = 0; l < 8; l++) {
                const double d = samples[k + l] - origin;
                sum[l] += d;
                square[l] += d * d;
            }
        for (size_t l = 1; l < 8; l++) {
            sum[0] += sum[l];
            square[0] += square[l];
        }
        const double variance = (square[0] - sum[0] * sum[0] / BLOCK) / (BLOCK - 1);
        const bool whole = variance == variance;
        *total += whole ? variance : 0;
        blocks += whole;
    }
    return blocks;
}

static void add_batch(imki_batches *b, double blocks, double sum, double enough)
{
    b->blocks += blocks;
    b->sum += sum;
    if (b->blocks < enough)
        return;
    const double mean = b->sum / b->blocks;
    b->count++;
    b->total += mean;
    b->squares += mean * mean;
    b->blocks = b->sum = 0;
}

static void add_batches(imki_batches *batches, double blocks, double sum)
{
    if (!(blocks > 0))
        return;
    for (int b = 0; b < IMKI_SCREEN_BATCHES; b++)
        add_batch(&batches[b], blocks, sum, b == 0 ? 16 : b == 1 ? 200 : 1600);
}

/* Fast variance in batches of about 1024, 8192 and 65536 samples. */
void imki_screen_variances(imk_screener *s)
{
    enum { PIECE = 1024 };
    for (size_t from = 0; from < s->count[0]; from += PIECE) {
        const size_t left = s->count[0] - from, count = left < PIECE ? left : PIECE;
        double sum = 0, clean = 0;
        const double here = (double)fast_variance(count, s->loose + from, &sum);
        s->fast += sum;
        s->fast_blocks += here;
        add_batches(s->batches[0], here, sum);
        const double there =
            s->marked ? (double)fast_variance(count, s->clean + from, &clean) : here;
        add_batches(s->batches[1], there, s->marked ? clean : sum);
    }
}

static const double tail_begins = 3.5, tail_far = 5;

/* Samples of the chunk that are far from the mean of their block without its ends, and very far, by
 * the standard deviation of most. */
static void count_tails(imk_screener *s, double core)
{
    for (size_t i = 0; i + BLOCK <= s->count[0]; i += BLOCK) {
        const double *x = s->loose + i;
        double sum = 0, low = 0, high = 0;
        size_t far = 0, very_far = 0;
        for (size_t k = 0; k < BLOCK; k++) {
            const double d = x[k] - x[0];
            sum += d;
            low = d < low ? d : low;
            high = d > high ? d : high;
        }
        const double mean = x[0] + (sum - low - high) / (BLOCK - 2);
        for (size_t k = 0; k < BLOCK; k++) {
            far += fabs(x[k] - mean) > tail_begins * core;
            very_far += fabs(x[k] - mean) > tail_far * core;
        }
        s->tail_samples += mean == mean ? BLOCK : 0;
        s->far[0] += (double)(far - very_far);
        s->far[1] += (double)very_far;
    }
}

/* Median distance of one sample of each block from the mean of the block. */
void imki_screen_core(imk_screener *s)
{
    double *distance = s->value;
    size_t blocks = 0;
    for (size_t i = 0, turn = 0; i + BLOCK <= s->count[0]; i += BLOCK, turn++) {
        double sum = 0;
        for (size_t k = i; k < i + BLOCK; k++)
            sum += s->loose[k] - s->loose[i];
        const double d = s->loose[i + turn % BLOCK] - s->loose[i] - sum / BLOCK;
        distance[blocks] = fabs(d);
        blocks += d == d;
    }
    if (blocks < BLOCK)
        return;
    imki_sort(distance, blocks);
    s->core_sum += distance[blocks / 2];
    s->core_count++;
    count_tails(s, 1.4826 * distance[blocks / 2]);
}
