/* SPDX-License-Identifier: Apache-2.0 */
/* The minimax line. The width of the strip of slope k that holds all points,
 *
 *     w(k) = max (y - k x) - min (y - k x),   dw/dk = x_low - x_high,
 *
 * is convex and changes its slope where a corner of the upper or the lower hull is passed. As k
 * grows the touching corner of the upper hull moves to the left and that of the lower one to the
 * right; where they pass each other the strip is narrowest, and its three contacts, two on one
 * side, the third between them on the other, are the alternation that proves it [CHENEY1966]. */
#include "imukit/evaluate.h"

#include <math.h>

/* Corners of the hull below (turn 1) or above (-1) the points, left to right. */
static int hull(size_t n, const double *x, const double *y, double turn, int *corner)
{
    int count = 0;
    for (int i = 0; i < (int)n; i++) {
        while (count > 1) {
            const int a = corner[count - 2], b = corner[count - 1];
            const double cross = (x[b] - x[a]) * (y[i] - y[a]) - (y[b] - y[a]) * (x[i] - x[a]);
            if (turn * cross > 0.0)
                break;
            count--;
        }
        corner[count++] = i;
    }
    return count;
}

static double slope(const double *x, const double *y, int a, int b)
{
    return (y[b] - y[a]) / (x[b] - x[a]);
}

imk_evaluation_line imk_minimax_line(size_t n, const double *x, const double *y, int alternation[3],
                                     int *scratch)
{
    int *low = scratch, *high = scratch + n;
    const int lows = hull(n, x, y, 1.0, low);
    int h = hull(n, x, y, -1.0, high) - 1, l = 0;
    double k = 0.0;
    int before[2] = {low[0], high[h]}, after[2] = {low[0], high[h]};
    while (x[after[0]] < x[after[1]]) {
        const double up = h > 0 ? slope(x, y, high[h - 1], high[h]) : HUGE_VAL;
        const double down = l + 1 < lows ? slope(x, y, low[l], low[l + 1]) : HUGE_VAL;
        before[0] = after[0], before[1] = after[1];
        k = fmin(up, down);
        if (up <= down)
            after[1] = high[--h];
        else
            after[0] = low[++l];
    }
    const double y_low = y[before[0]] - k * x[before[0]];
    const double y_high = y[before[1]] - k * x[before[1]];
    const bool strip = y_high > y_low && n > 2;
    const int moved = after[0] == before[0]; /* the upper corner */
    alternation[0] = strip ? (moved ? after[1] : before[0]) : -1;
    alternation[1] = strip ? (moved ? before[0] : before[1]) : -1;
    alternation[2] = strip ? (moved ? before[1] : after[0]) : -1;
    return (imk_evaluation_line){0.5 * (y_low + y_high), k, strip ? 0.5 * (y_high - y_low) : 0.0};
}
