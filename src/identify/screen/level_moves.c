/* SPDX-License-Identifier: Apache-2.0 */
/* Stretches in which the sensor was moved: handled before it was set down, bumped into, carried
 * away before the log was stopped.
 *
 * Between neighbouring means of the level, a change beyond 25 times the median one is no noise: of
 * walks, flicker and tones, the median contains most. A single such change is a jump, and changes
 * of one sign are a drift. Three or more of both signs, with at most 8 ordinary ones between them,
 * are a movement; it begins one mean before its first change and ends one behind its last one.
 * Among a few means at either end one change is enough: whether it is a jump does not matter there.
 */
#include "screener_internal.h"

#include <math.h>

enum { APART = 8, CHANGES_MIN = 3, MEANS_MIN = 50 };
static const double beyond = 25;

/* Median change between means that are there; those on lines over holes change least. */
static double median_change(size_t n, const double *mean, double empty, double *room)
{
    for (size_t i = 1; i < n; i++)
        room[i - 1] = fabs(mean[i] - mean[i - 1]);
    imki_sort(room, n - 1);
    return room[(size_t)(0.5 * (1 + empty) * (double)(n - 2))];
}

/* Do the changes from mean `from` to mean `to` have both signs, and are they enough? */
static bool is_movement(const double *mean, size_t from, size_t to, double limit)
{
    size_t up = 0, down = 0;
    for (size_t i = from; i <= to; i++) {
        const double change = mean[i] - mean[i - 1];
        up += change > limit;
        down += change < -limit;
    }
    return up > 0 && down > 0 && up + down >= CHANGES_MIN;
}

size_t imki_moves_find(size_t n, const double *mean, double empty, double least, size_t edge,
                       double *room, imki_move *move, size_t most)
{
    size_t count = 0;
    if (n < MEANS_MIN)
        return 0;
    const double limit = beyond * fmax(median_change(n, mean, empty, room), least);
    for (size_t i = 1; limit > 0 && i < n && count < most; i++) {
        if (!(fabs(mean[i] - mean[i - 1]) > limit))
            continue;
        size_t last = i;
        for (size_t k = i + 1; k < n && k <= last + APART + 1; k++)
            last = fabs(mean[k] - mean[k - 1]) > limit ? k : last;
        const bool starts = last <= edge, stops = i + edge >= n;
        if (starts || stops || is_movement(mean, i, last, limit))
            move[count++] = (imki_move){starts ? 0 : i - 1, stops || last + 1 > n ? n : last + 1};
        i = last;
    }
    return count;
}
