/* SPDX-License-Identifier: Apache-2.0 */
/* Noise type of a record with missing samples at one averaging factor: the lag-1 autocorrelation of
 * cluster means [RILEY2004], over those clusters that hold enough samples and have such neighbours.
 */
#include "allan_gaps_internal.h"
#include "allan_internal.h"

#include <math.h>

/* Walks through the d-th differences of neighbouring cluster means. */
typedef struct difference_walk {
    const imki_gap_record *r;
    size_t m, least, from;
    int order, known; /* clusters in a row so far */
    double past[2];   /* their means, the last one first */
} difference_walk;

/* The next difference; `follows` says that it follows the one before at once. False at the end. */
static bool next_difference(difference_walk *w, double *value, bool *follows)
{
    static const double binomial[2][2] = {{1, 0}, {1, -1}};
    for (; w->from + w->m <= w->r->n;) {
        const size_t from = w->from, to = w->from += w->m;
        const uint32_t there = w->r->counts[to] - w->r->counts[from];
        if (there < w->least) {
            w->known = 0;
            continue;
        }
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

/* As for a complete record (allan_type.c). No type where squares overflow. */
bool imki_gap_noise_type(const imki_gap_record *record, size_t m, size_t least, imk_power_law *type)
{
    double r = 0;
    int d = 0;
    for (;; d++) {
        if (lag_one(record, m, least, d, &r) + (size_t)d + 1 < IMKI_ALLAN_CLUSTERS_MIN)
            return false;
        if (r / (1 + r) < 0.25 || d == 1)
            break;
    }
    if (isnan(r))
        return false;
    *type = imki_allan_nearest_type(r, d, m, IMK_RANDOM_WALK_RATE);
    return true;
}
