/* SPDX-License-Identifier: Apache-2.0 */
/* Allan variances of a stream by tiers of blocks:
 *
 *     AVAR(m) = 1/(2 m^2 count) sum (b4 + b5 + b6 + b7 - b0 - b1 - b2 - b3)^2
 *
 * with b0 … b7 eight consecutive blocks of m/4 samples. Tier 0, the samples themselves, serves m =
 * 1 and 2 too, with two and four of them. Block q of tier t holds samples 2^t q … 2^t (q + 1) - 1,
 * counted from the record's start, so that the shards of a record have the same blocks. */
#include "allan_stream_internal.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

enum { SLOT = IMK_ALLAN_STREAM_BLOCKS - 1 };

void imk_allan_stream_start(imk_allan_stream *stream, uint64_t first)
{
    memset(stream, 0, sizeof *stream);
    stream->first = stream->next = first;
    stream->minimum = HUGE_VAL;
    stream->maximum = -HUGE_VAL;
}

/* Samples taken at a time: enough for the compiler's vectors, little on the stack. */
enum { CHUNK = 64 };

/* Consecutive blocks of one tier, behind those that were there before. */
typedef struct blocks {
    uint64_t number; /* of the first new one */
    size_t before, count;
    double value[SLOT + CHUNK];
} blocks;

static void count_squares(struct imk_allan_stream_squares *squares, size_t count,
                          const double *difference)
{
    double sum = squares->sum, error = squares->error;
    for (size_t i = 0; i < count; i++) {
        const double d = difference[i] == difference[i] ? difference[i] : 0;
        imki_stream_accumulate(&sum, &error, d * d);
        squares->count += difference[i] == difference[i];
    }
    squares->sum = sum;
    squares->error = error;
}

/* The three factors of tier 0 side by side, so that none waits for the additions of another. */
static void count_samples(struct imk_allan_stream_squares *squares, const blocks *b)
{
    double sum0 = squares[0].sum, sum1 = squares[1].sum, sum2 = squares[2].sum;
    double error0 = squares[0].error, error1 = squares[1].error, error2 = squares[2].error;
    uint64_t count0 = 0, count1 = 0, count2 = 0;
    for (size_t i = 0; i < b->count; i++) {
        const double *v = b->value + i;
        const double pair = v[7] + v[6], pair_before = v[5] + v[4];
        const double d0 = v[7] - v[6], d1 = pair - pair_before;
        const double d2 = imki_stream_window(v[0], v[1], v[2], v[3], v[4], v[5], v[6], v[7]);
        imki_stream_accumulate(&sum0, &error0, d0 == d0 ? d0 * d0 : 0);
        imki_stream_accumulate(&sum1, &error1, d1 == d1 ? d1 * d1 : 0);
        imki_stream_accumulate(&sum2, &error2, d2 == d2 ? d2 * d2 : 0);
        count0 += d0 == d0;
        count1 += d1 == d1;
        count2 += d2 == d2;
    }
    squares[0] = (struct imk_allan_stream_squares){squares[0].count + count0, sum0, error0};
    squares[1] = (struct imk_allan_stream_squares){squares[1].count + count1, sum1, error1};
    squares[2] = (struct imk_allan_stream_squares){squares[2].count + count2, sum2, error2};
}

static void count_pairs(struct imk_allan_stream_squares *squares, const blocks *b, size_t half)
{
    double difference[CHUNK];
    size_t windows = 0;
    const size_t end = b->before + b->count;
    for (size_t i = b->before > 2 * half - 1 ? b->before : 2 * half - 1; i < end; i++) {
        const double *v = b->value + i;
        difference[windows++] = half == 1 ? v[0] - v[-1] : (v[0] + v[-1]) - (v[-2] + v[-3]);
    }
    count_squares(squares, windows, difference);
}

static void count_windows(struct imk_allan_stream_squares *squares, const blocks *b)
{
    double difference[CHUNK];
    const size_t end = b->before + b->count;
    const size_t windows = end > SLOT ? end - SLOT : 0;
    for (size_t i = 0; i < windows; i++) {
        const double *v = b->value + i;
        difference[i] = imki_stream_window(v[0], v[1], v[2], v[3], v[4], v[5], v[6], v[7]);
    }
    count_squares(squares, windows, difference);
}

/* Puts the blocks before the new ones in place; keeps the new ones in the tier's memory. */
static void enter(imk_allan_stream *stream, unsigned tier, blocks *b)
{
    const uint64_t since = b->number - imki_stream_first_block(stream->first, tier);
    const size_t before = since < SLOT ? (size_t)since : SLOT;
    memmove(b->value + before, b->value, b->count * sizeof *b->value);
    for (size_t i = 0; i < before; i++)
        b->value[i] = stream->last[tier][(b->number - before + i) & SLOT];
    b->before = before;
    for (size_t i = b->count > SLOT ? b->count - SLOT - 1 : 0; i < b->count; i++)
        stream->last[tier][(b->number + i) & SLOT] = b->value[before + i];
    for (size_t i = 0; i < b->count && since + i < SLOT; i++)
        stream->head[tier][since + i] = b->value[before + i];
}

/* The blocks of the next tier that the new ones complete. */
static void pair_up(const blocks *b, blocks *parents)
{
    const size_t odd = (size_t)(b->number & 1);
    size_t left = odd ? b->before - 1 : b->before;
    if (odd && b->before == 0)
        left = 1; /* its left half was in the shard before */
    parents->number = (b->number + left - b->before) >> 1; /* size_t may be narrower */
    parents->count = 0;
    for (; left + 1 < b->before + b->count; left += 2)
        parents->value[parents->count++] = imki_stream_pair(b->value[left], b->value[left + 1]);
}

static void take_samples(imk_allan_stream *stream, size_t count, const double *samples,
                         double *value)
{
    double sum = stream->sum, error = stream->sum_error;
    double minimum = stream->minimum, maximum = stream->maximum;
    size_t present = 0;
    for (size_t i = 0; i < count; i++) {
        const double sample = samples[i];
        const bool there = fabs(sample) < HUGE_VAL;
        value[i] = there ? sample : (double)NAN;
        if (!there)
            continue;
        imki_stream_accumulate(&sum, &error, sample);
        present++;
        minimum = sample < minimum ? sample : minimum;
        maximum = sample > maximum ? sample : maximum;
    }
    stream->sum = sum;
    stream->sum_error = error;
    stream->minimum = minimum;
    stream->maximum = maximum;
    stream->present += present;
    stream->missing = stream->next + count - stream->first - stream->present;
}

static void take_chunk(imk_allan_stream *stream, size_t count, const double *samples)
{
    blocks tiers[2];
    tiers[0].number = stream->next;
    tiers[0].count = count;
    tiers[1].count = 0;
    take_samples(stream, count, samples, tiers[0].value);
    for (unsigned tier = 0; tier < IMK_ALLAN_STREAM_TIERS; tier++) {
        blocks *b = &tiers[tier & 1];
        if (b->count == 0)
            break;
        enter(stream, tier, b);
        if (tier == 0 && b->before == SLOT) {
            count_samples(stream->squares, b);
        } else {
            if (tier == 0) {
                count_pairs(&stream->squares[0], b, 1);
                count_pairs(&stream->squares[1], b, 2);
            }
            count_windows(&stream->squares[tier + 2], b);
        }
        pair_up(b, &tiers[(tier + 1) & 1]);
    }
    stream->next += count;
}

void imk_allan_stream_add(imk_allan_stream *stream, size_t count, const double *samples)
{
    for (size_t i = 0; i < count; i += CHUNK)
        take_chunk(stream, count - i < CHUNK ? count - i : CHUNK, samples + i);
}

void imk_allan_stream_pool(imk_allan_stream *stream, const imk_allan_stream *other)
{
    imki_stream_add_totals(stream, other);
    stream->first = stream->next = UINT64_MAX;
}

size_t imk_allan_stream_points(const imk_allan_stream *stream, imk_allan_stream_point *points)
{
    size_t count = 0;
    for (size_t k = 0; k < IMK_ALLAN_STREAM_FACTORS; k++) {
        const struct imk_allan_stream_squares *s = &stream->squares[k];
        if (s->count == 0)
            continue;
        const size_t m = (size_t)1 << k;
        const double scale = 2.0 * (double)m * (double)m * (double)s->count;
        points[count++] = (imk_allan_stream_point){
            m, m > IMK_ALLAN_STREAM_OVERLAP ? m / IMK_ALLAN_STREAM_OVERLAP : 1, s->count,
            (s->sum + s->error) / scale};
    }
    return count;
}

double imk_allan_stream_mean(const imk_allan_stream *stream)
{
    return (stream->sum + stream->sum_error) / (double)stream->present;
}
