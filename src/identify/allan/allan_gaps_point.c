/* SPDX-License-Identifier: Apache-2.0 */
/* The Allan variance of a record with missing samples at one averaging factor.
 *
 * Cluster means over what is there, S_1/n_1 and S_2/n_2, make one term a pair,
 *
 *     t = w (S_2/n_2 - S_1/n_1)^2,   w = (2/m)/(1/n_1 + 1/n_2),
 *
 * whose expectation for white noise does not depend on how full the clusters are. The mean of n
 * values drawn at random out of m scatters about the mean of all m by (1/n - 1/m) s^2, with s^2 the
 * variance inside the cluster, whatever the values are [COCHRAN1977, (2.11)]. So
 *
 *     AVAR(m) = 1/2 sum t / sum w - (s^2/m) (1/w_mean - 1)
 *
 * has no bias where samples are missing one by one. A longer hole does not leave a random choice:
 * allan_gaps_lags.c has the factor of the subtraction that takes care of it inside clusters.
 * Between clusters there remains, of a random walk's variance, less than 0.6 (h/m)^2 for a pair
 * that holds a hole of h samples. Pairs that touch a hole longer than a limit are left out, and the
 * limit is as large as the statistical error allows. */
#include "allan_gaps_internal.h"

#include <math.h>

enum { LAGS = 32 };

/* Bias of a record by holes of up to a class, as a share of a random walk's variance, is
 * 0.6 sum h^2/(m n), since a hole is in 2 m of n pairs and adds 0.6 (h/m)^2/2 to the mean; a tenth
 * of the standard error sqrt(2 m/n) bounds it. Holes beyond half a cluster are never bridged. */
static unsigned class_limit(const imki_gap_record *r, size_t m)
{
    const double length = (double)m, n = (double)r->n;
    const double most = 0.1 * sqrt(2 * length / n) * length * n / 0.6;
    double squares = 0;
    unsigned limit = 1;
    for (unsigned c = 2; c < IMKI_HOLE_CLASSES && ldexp(1, (int)c - 1) <= length / 2 + 1; c++) {
        squares += r->squares[c];
        if (squares > most)
            break;
        limit = c;
    }
    return limit;
}

/* A walk over all pairs of clusters: those whose clusters hold at least `least` samples and touch
 * no hole beyond the limit. */
typedef struct pair_walk {
    const imki_gap_record *r;
    size_t m, least, barred;
    unsigned limit;
} pair_walk;

static bool is_barred(const pair_walk *w, size_t i)
{
    return w->r->holes[i] > w->limit;
}

static void walk_begin(pair_walk *w)
{
    w->barred = 0;
    for (size_t i = 0; i < 2 * w->m; i++)
        w->barred += is_barred(w, i);
}

/* From pair j to pair j + 1, where there is one. */
static inline void walk_step(pair_walk *w, size_t j)
{
    if (w->limit < IMKI_HOLE_CLASSES && j + 2 * w->m < w->r->n)
        w->barred += (size_t)is_barred(w, j + 2 * w->m) - (size_t)is_barred(w, j);
}

static inline bool pair_counts(const pair_walk *w, size_t j, double *n1, double *n2)
{
    const uint32_t *c = w->r->counts + j;
    const uint32_t middle = c[w->m], first = middle - c[0], second = c[2 * w->m] - middle;
    *n1 = (double)first;
    *n2 = (double)second;
    return w->barred == 0 && first >= w->least && second >= w->least;
}

typedef struct pair_sums {
    double weights, terms, fullness;
    size_t count;
} pair_sums;

/* Sums over the pairs; terms beyond `most` count as `most`. */
static pair_sums add_pairs(pair_walk *w, double most)
{
    pair_sums sum = {0};
    const size_t m = w->m;
    const double two_over_m = 2 / (double)m;
    walk_begin(w);
    for (size_t j = 0; j + 2 * m <= w->r->n; walk_step(w, j), j++) {
        double n1, n2;
        if (!pair_counts(w, j, &n1, &n2))
            continue;
        const double *s = w->r->sums + j, middle = s[m];
        const double cross = (s[2 * m] - middle) * n1 - (middle - s[0]) * n2;
        const double both = n1 + n2, scale = two_over_m / (n1 * n2 * both);
        const double term = cross * cross * scale;
        sum.weights += n1 * n2 * n1 * n2 * scale;
        sum.terms += term < most ? term : most;
        sum.fullness += both;
        sum.count++;
    }
    return sum;
}

/* Mean square of Gaussian terms of which those beyond k^2 times it count as that: solves
 * mean min(t, k^2 e) = kappa e with kappa = E min(x^2, k^2), k = 2.5. The share of a term that goes
 * beyond is small, so the fixed point is reached in a few rounds from any start. */
static double bounded_mean(pair_walk *w, const pair_sums *plain)
{
    const double clip = 6.25, kappa = 0.97755927;
    double mean = plain->terms / (double)plain->count;
    for (int round = 0; round < 8; round++) {
        const pair_sums sum = add_pairs(w, clip * mean);
        mean = sum.terms / (double)sum.count / kappa;
    }
    return mean;
}

/* Mean variance inside clusters of m, by degrees of freedom. */
static double inside_variance(const pair_walk *w)
{
    const imki_gap_record *r = w->r;
    double squares = 0, degrees = 0;
    for (size_t from = 0; from + w->m <= r->n; from += w->m) {
        const size_t to = from + w->m;
        const uint32_t there = r->counts[to] - r->counts[from];
        if (there < 2)
            continue;
        const double mean = (r->sums[to] - r->sums[from]) / (double)there;
        for (size_t i = from; i < to; i++) {
            const double d = (r->sums[i + 1] - r->sums[i]) - mean;
            squares += r->counts[i + 1] > r->counts[i] ? d * d : 0;
        }
        degrees += there - 1.0;
    }
    return degrees > 0 ? squares / degrees : 0;
}

/* Correlation of neighbouring pairs of white noise, lag in clusters. */
static double pair_correlation(double lag)
{
    return lag < 1 ? 1 - 1.5 * lag : lag < 2 ? 0.5 * lag - 1 : 0;
}

/* Degrees of freedom of the pairs that count, as a share of those of all pairs: with a_j = 1 where
 * a pair counts,
 *
 *     edf = (sum a_j)^2 / sum_jl a_j a_l rho^2(j - l)
 *
 * taken at every (m/16)-th pair, with rho of white noise. */
static double share_of_edf(pair_walk *w)
{
    const size_t pairs = w->r->n - 2 * w->m + 1, stride = (w->m + 15) / 16;
    uint64_t together[LAGS] = {0}, taken = 0, all = 0;
    uint32_t before = 0;
    walk_begin(w);
    for (size_t j = 0, next = 0; j < pairs; walk_step(w, j), j++) {
        if (j != next)
            continue;
        next += stride;
        all++;
        double n1, n2;
        const bool counts = pair_counts(w, j, &n1, &n2);
        if (counts)
            for (unsigned lag = 1; lag < LAGS; lag++)
                together[lag] += (before >> (lag - 1)) & 1u;
        taken += counts;
        before = before << 1 | (uint32_t)counts;
    }
    double with = (double)taken, without = (double)all;
    for (unsigned lag = 1; lag < LAGS && lag < all; lag++) {
        const double rho = pair_correlation((double)lag * (double)stride / (double)w->m);
        with += 2 * rho * rho * (double)together[lag];
        without += 2 * rho * rho * (double)(all - lag);
    }
    return taken > 0 ? (double)taken * (double)taken / with / ((double)all * (double)all / without)
                     : 0;
}

/* The limit on holes, raised where it leaves less than a quarter of the pairs: better an estimate
 * with some bias from long holes than none. */
static pair_sums choose_pairs(pair_walk *w)
{
    const size_t pairs = w->r->n - 2 * w->m + 1;
    w->limit = class_limit(w->r, w->m);
    pair_sums sum = add_pairs(w, HUGE_VAL);
    while (4 * sum.count < pairs && ldexp(1, (int)w->limit - 1) < 2 * (double)w->m) {
        w->limit++;
        sum = add_pairs(w, HUGE_VAL);
    }
    return sum;
}

imki_gap_estimate imki_gap_estimate_at(const imki_gap_record *record, bool robust, size_t m)
{
    /* Half as full as the record is on average, at least. */
    const double share = (double)record->present / (double)record->n;
    const double least = ceil(0.5 * share * (double)m);
    pair_walk walk = {.r = record, .m = m, .least = least > 1 ? (size_t)least : 1}, *w = &walk;
    const pair_sums sum = choose_pairs(w);
    imki_gap_estimate e = {.m = m, .count = sum.count};
    if (sum.count == 0)
        return e;
    const double mean_weight = sum.weights / (double)sum.count;
    const double mean_term = robust ? bounded_mean(w, &sum) : sum.terms / (double)sum.count;
    e.variance = mean_term / mean_weight / 2;
    e.used = (double)sum.count / (double)(record->n - 2 * m + 1);
    e.fullness = sum.fullness / (2 * (double)m * (double)sum.count);
    if (mean_weight < 1 - 1e-12) {
        const double inside = inside_variance(w);
        const double simple = inside / (double)m * (1 / mean_weight - 1);
        double error = 0;
        const double factor =
            w->limit > 1 ? imki_gap_hole_factor(record, m, w->least, inside, &error) : 1;
        e.correction = simple * factor;
        e.correction_error = simple * error;
    }
    e.told = imki_gap_noise_type(record, m, w->least, &e.type);
    e.share = share_of_edf(w) * (robust ? 0.96 : 1);
    return e;
}
