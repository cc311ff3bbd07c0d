/* SPDX-License-Identifier: Apache-2.0 */
/* What taking samples and joining shards have in common. */
#ifndef IMUKIT_ALLAN_STREAM_INTERNAL_H
#define IMUKIT_ALLAN_STREAM_INTERNAL_H

#include "imukit/allan_stream.h"

/* sum + step exactly: the rounded sum, and what it lacks [KNUTH1998, 4.2.2]. */
static inline void imki_stream_accumulate(double *sum, double *error, double step)
{
    const double next = *sum + step, part = next - *sum;
    *error += (*sum - (next - part)) + (step - part);
    *sum = next;
}

/* A window's difference: counted unless a block of it is missing (not a number). */
static inline void imki_stream_square(struct imk_allan_stream_squares *squares, double difference)
{
    if (difference != difference)
        return;
    imki_stream_accumulate(&squares->sum, &squares->error, difference * difference);
    squares->count++;
}

/* The block of two halves; a missing half counts as the other one. */
static inline double imki_stream_pair(double left, double right)
{
    const double sum = left + right;
    return sum == sum ? sum : left == left ? 2 * left : 2 * right;
}

static inline double imki_stream_window(double b0, double b1, double b2, double b3, double b4,
                                        double b5, double b6, double b7)
{
    return ((b4 + b5) + (b6 + b7)) - ((b0 + b1) + (b2 + b3));
}

/* First block of a tier that lies wholly at or after a sample. */
static inline uint64_t imki_stream_first_block(uint64_t first, unsigned tier)
{
    return (first + ((UINT64_C(1) << tier) - 1)) >> tier;
}

/* allan_stream_join.c: everything that simply adds up. */
void imki_stream_add_totals(imk_allan_stream *stream, const imk_allan_stream *other);

#endif
