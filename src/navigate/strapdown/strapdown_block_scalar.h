/* SPDX-License-Identifier: Apache-2.0 */
/* The mechanisation in blocks with plain doubles. No include guard: once in a file. */
#include <math.h>
#include <stddef.h>

#define LANES 1

typedef double real;

static inline real square_root(real a)
{
    return sqrt(a);
}

static inline real fused(real a, real b, real c)
{
    return fma(a, b, c);
}

static inline real fused_from(real a, real b, real c)
{
    return fma(-a, b, c);
}

static inline real larger(real a, real b)
{
    return a > b ? a : b;
}

static inline void load_across(const double *const (*channel)[6], size_t j, size_t first,
                               real out[LANES])
{
    out[0] = channel[0][j][first];
}

#include "strapdown_block_loop.h"

/* A sample that waited for another is taken as two halves on the straight line through it and the
 * one before: with G their sum, which is of half the length, and V the velocity before, the way
 * that the next pair would give is V/2 + 3/8 G. */
static void take_alone(const imki_sample_constants *half, bool known, carrier *c)
{
    gathered g = {.turn = c->block.turn};
    reading pair[2];
    for (int j = 0; j < 6; j++) {
        const double growth = known ? c->last.channel[j] - c->before.channel[j] : 0.0;
        pair[0].channel[j] = c->last.channel[j] - 0.25 * growth;
        pair[1].channel[j] = c->last.channel[j] + 0.25 * growth;
    }
    take_pairs(half, pair, 1, &g);
    c->block.turn = g.turn;
    for (int i = 0; i < 3; i++) {
        c->block.way.v[i] += 0.5 * c->block.gain.v[i] + 0.375 * g.gain.v[i];
        c->block.gain.v[i] += 0.5 * g.gain.v[i];
    }
}

static void end_single(const imki_block_end *end, double *carried)
{
    carrier c;
    load_carrier(carried, 1, &c);
    if (end->alone)
        take_alone(&end->half, end->known, &c);
    const place at = place_halfway(&end->block, &c);
    end_block(&end->block, end->hold_height, &at, &c);
    store_carrier(&c, carried, 1);
}
