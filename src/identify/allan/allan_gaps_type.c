/* SPDX-License-Identifier: Apache-2.0 */
/* Noise type of a record with missing samples at one averaging factor: the lag-1 autocorrelation of
 * cluster means [RILEY2004], over those clusters that hold enough samples and have such neighbours.
 */
#include "allan_gaps_internal.h"

#include <math.h>

enum { NEIGHBOURS_MIN = 30 };

/* Walks through the d-th differences of neighbouring cluster means. */
typedef struct difference_walk {
    const imki_gap_record *r;
    size_t m, least, from;
    int order, known; /* clusters in a row so far */
    double past[3];   /* their means, the last one first */
} difference_walk;

/* The next difference; `follows` says that it follows the one before at once. False at the end. */
static bool next_difference(difference_walk *w, double *value, bool *follows)
{
    static const double binomial[3][3] = {{1, 0, 0}, {1, -1, 0}, {1, -2, 1}};
    for (; w->from + w->m <= w->r->n;) {
        const size_t from = w->from, to = w->from += w->m;
        const uint32_t there = w->r->counts[to] - w->r->counts[from];
        if (there < w->least) {
            w->known = 0;
            continue;
        }
        w->past[2] = w->past[1];
        w->past[1] = w->past[0];
        w->past[0] = (w->r->sums[to] - w->r->sums[from]) / (double)there;
        if (++w->known <= w->order)
            continue;
        *value = 0;
        for (int k = 0; k <= w->order; k++)
            *value += binomial[w->order][k] * w->past[k];
        *follows = w->known > w->order + 1;
        return true;
    }
    return false;
}

/* @return how many neighbours there are */
static size_t lag_one(const imki_gap_record *r, size_t m, size_t least, int order,
                      double *correlation)
{
    const difference_walk start = {.r = r, .m = m, .least = least, .order = order};
    difference_walk w = start;
    double z, mean = 0, product = 0, square = 0, previous = 0;
    size_t count = 0, neighbours = 0;
    bool follows;
    for (; next_difference(&w, &z, &follows); count++)
        mean += z;
    mean /= count > 0 ? (double)count : 1;
    for (w = start; next_difference(&w, &z, &follows); previous = z - mean) {
        square += (z - mean) * (z - mean);
        product += follows ? (z - mean) * previous : 0;
        neighbours += follows;
    }
    *correlation = square > 0 && neighbours > 0
                       ? product / (double)neighbours / (square / (double)(count - 1))
                       : 0;
    return neighbours;
}

/* Differences until delta = r/(1 + r) < 1/4; then alpha = -2 (delta + d). No type where squares
 * overflow. */
bool imki_gap_noise_type(const imki_gap_record *record, size_t m, size_t least, imk_power_law *type)
{
    double delta = 0, r = 0;
    int d = 0;
    for (;; d++) {
        if (lag_one(record, m, least, d, &r) + (size_t)d + 1 < NEIGHBOURS_MIN)
            return false;
        delta = r / (1 + r);
        if (delta < 0.25 || d == 2)
            break;
    }
    if (isnan(delta))
        return false;
    const double alpha = floor(-2 * (delta + d) + 0.5);
    *type = (imk_power_law)(alpha > 2 ? 2 : alpha < -2 ? -2 : alpha);
    return true;
}
