/* SPDX-License-Identifier: Apache-2.0 */
/* Sudden lasting changes of the level.
 *
 * The record is cut into blocks, each represented by its mean; at every border between blocks the
 * mean of the 4 blocks behind it less that of the 4 before. Slow noise makes such differences too,
 * and sets their scale (by their median); a step stands out of it. */
#include "imukit/distributions.h"
#include "screen_internal.h"

#include <math.h>

enum { BLOCKS_MIN = 64, BLOCKS_MAX = 4096, SIDE = 4, BLOCK_MIN = 16 };

/* Means of blocks of what is there; empty ones repeat the one before. */
static void block_means(size_t n, const double *samples, size_t blocks, double *mean)
{
    double last = 0;
    for (size_t i = n; i-- > 0;)
        last = imki_is_there(samples[i]) ? samples[i] : last;
    for (size_t b = 0; b < blocks; b++) {
        const size_t from = b * (n / blocks), to = from + n / blocks;
        double sum = 0;
        size_t count = 0;
        for (size_t i = from; i < to; i++) {
            const bool there = imki_is_there(samples[i]);
            sum += there ? samples[i] - last : 0;
            count += there;
        }
        last += count > 0 ? sum / (double)count : 0;
        mean[b] = last;
    }
}

static double change_at(const double *mean, size_t border)
{
    double sum = 0;
    for (size_t k = 0; k < SIDE; k++)
        sum += mean[border + k] - mean[border - 1 - k];
    return sum / SIDE;
}

void imki_steps_find(size_t n, const double *samples, double significance, imk_screen *found,
                     double *scratch)
{
    found->steps = (imk_screen_count){0, 0, n};
    size_t blocks = n / BLOCK_MIN;
    blocks = blocks > BLOCKS_MAX ? BLOCKS_MAX : blocks;
    if (blocks < BLOCKS_MIN)
        return;
    double *mean = scratch, *sorted = scratch + BLOCKS_MAX;
    block_means(n, samples, blocks, mean);
    size_t count = 0;
    for (size_t b = SIDE; b + SIDE <= blocks; b++)
        sorted[count++] = fabs(change_at(mean, b));
    imki_sort(sorted, count);
    const double scale = 1.4826 * sorted[count / 2];
    /* The differences are correlated over 2 SIDE borders, which makes their median less sure: 1.3
     * covers its scatter in the shortest record. */
    const double threshold = -1.3 * imk_normal_quantile(significance / (2 * (double)count)) * scale;
    for (size_t b = SIDE; b + SIDE <= blocks; b++) {
        const double size = fabs(change_at(mean, b));
        bool highest = size > threshold;
        for (size_t k = b > 2 * SIDE ? b - SIDE : SIDE;
             highest && k <= b + SIDE && k + SIDE <= blocks; k++) {
            const double other = fabs(change_at(mean, k));
            highest = k < b ? other < size : other <= size;
        }
        if (!highest)
            continue;
        found->steps.count++;
        found->steps.runs++;
        if (size > fabs(found->largest_step)) {
            found->largest_step = change_at(mean, b);
            found->steps.first = b * (n / blocks);
        }
    }
}
