/* SPDX-License-Identifier: Apache-2.0 */
/* Joins two shards of a record. What lies within either is counted already; what is missing are the
 * windows across the border. A tier's blocks around it are the last seven of the left shard, the
 * first seven of the right one, and between them the block that the border cuts, if there is one:
 * it is the pair of two blocks of the tier below, which are among those around the border there. */
#include "allan_stream_internal.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

enum { SLOT = IMK_ALLAN_STREAM_BLOCKS - 1, AROUND = 2 * SLOT + 1 };

/* Consecutive blocks of a tier around the border. */
typedef struct border {
    uint64_t first; /* number of the first one */
    size_t count;
    size_t left, right; /* how many are wholly in the left and in the right shard */
    double block[AROUND];
} border;

static uint64_t blocks_of(const imk_allan_stream *s, unsigned tier)
{
    const uint64_t from = imki_stream_first_block(s->first, tier), to = s->next >> tier;
    return to > from ? to - from : 0;
}

/* The block that the border cuts, when both shards together hold all of it. */
static bool cut_block(const imk_allan_stream *a, const imk_allan_stream *b, unsigned tier,
                      const border *below, double *value)
{
    const uint64_t block = b->first >> tier;
    if ((block << tier) == b->first || block < imki_stream_first_block(a->first, tier) ||
        block >= b->next >> tier)
        return false;
    const size_t child = (size_t)(2 * block - below->first);
    *value = imki_stream_pair(below->block[child], below->block[child + 1]);
    return true;
}

static void gather(border *g, const imk_allan_stream *a, const imk_allan_stream *b, unsigned tier,
                   const border *below)
{
    const uint64_t left = blocks_of(a, tier), right = blocks_of(b, tier), end = a->next >> tier;
    g->left = left < SLOT ? (size_t)left : SLOT;
    g->right = right < SLOT ? (size_t)right : SLOT;
    g->first = end - g->left;
    g->count = 0;
    for (; g->count < g->left; g->count++)
        g->block[g->count] = a->last[tier][(g->first + g->count) & SLOT];
    double cut;
    if (cut_block(a, b, tier, below, &cut)) {
        if (g->left == 0)
            g->first = b->first >> tier;
        g->block[g->count++] = cut;
    } else if (g->left == 0) {
        g->first = imki_stream_first_block(b->first, tier);
    }
    for (size_t i = 0; i < g->right; i++)
        g->block[g->count++] = b->head[tier][i];
}

/* Windows of 2 half blocks that begin in the left shard or the cut block and end behind it. */
static void count_windows(struct imk_allan_stream_squares *squares, const border *g, size_t half)
{
    for (size_t end = g->left; end < g->count; end++) {
        if (end + 1 < 2 * half)
            continue;
        const double *b = g->block + (end + 1 - 2 * half);
        if ((size_t)(b - g->block) >= g->count - g->right)
            return;
        imki_stream_square(squares, half == 1   ? b[1] - b[0]
                                    : half == 2 ? (b[3] + b[2]) - (b[1] + b[0])
                                                : imki_stream_window(b[0], b[1], b[2], b[3], b[4],
                                                                     b[5], b[6], b[7]));
    }
}

/* Ends of the joined shard: its first blocks and its last ones. */
static void renew_ends(imk_allan_stream *a, const imk_allan_stream *b, unsigned tier,
                       const border *g, uint64_t left, uint64_t right)
{
    for (size_t i = g->left; left < SLOT && i < g->count && i < SLOT; i++)
        a->head[tier][i] = g->block[i];
    if (right >= IMK_ALLAN_STREAM_BLOCKS) {
        memcpy(a->last[tier], b->last[tier], sizeof a->last[tier]);
        return;
    }
    for (size_t i = g->left; i < g->count; i++)
        a->last[tier][(g->first + i) & SLOT] = g->block[i];
}

void imki_stream_add_totals(imk_allan_stream *stream, const imk_allan_stream *other)
{
    stream->present += other->present;
    stream->missing += other->missing;
    imki_stream_accumulate(&stream->sum, &stream->sum_error, other->sum);
    stream->sum_error += other->sum_error;
    stream->minimum = fmin(stream->minimum, other->minimum);
    stream->maximum = fmax(stream->maximum, other->maximum);
    for (size_t k = 0; k < IMK_ALLAN_STREAM_FACTORS; k++) {
        struct imk_allan_stream_squares *to = &stream->squares[k];
        imki_stream_accumulate(&to->sum, &to->error, other->squares[k].sum);
        to->error += other->squares[k].error;
        to->count += other->squares[k].count;
    }
}

imk_status imk_allan_stream_join(imk_allan_stream *stream, const imk_allan_stream *following)
{
    if (following->first != stream->next || stream->next == UINT64_MAX)
        return IMK_ERROR_ARGUMENT;
    border tiers[2] = {{0}};
    for (unsigned tier = 0; tier < IMK_ALLAN_STREAM_TIERS; tier++) {
        border *g = &tiers[tier & 1];
        const border *below = &tiers[(tier + 1) & 1];
        const uint64_t left = blocks_of(stream, tier), right = blocks_of(following, tier);
        gather(g, stream, following, tier, below);
        if (tier == 0) {
            count_windows(&stream->squares[0], g, 1);
            count_windows(&stream->squares[1], g, 2);
        }
        count_windows(&stream->squares[tier + 2], g, 4);
        renew_ends(stream, following, tier, g, left, right);
    }
    stream->next = following->next;
    imki_stream_add_totals(stream, following);
    return IMK_OK;
}
