/* SPDX-License-Identifier: Apache-2.0 */
/* Covariance of Allan variances at different tau.
 *
 * v_i is the mean of z_i^2/(2 m_i^2) over M_i second differences. For Gaussian z with means mu
 * [ISSERLIS1918],
 *
 *     cov(v1, v2) = 1/(4 m1^2 m2^2 M1 M2) sum_l W(l) [2 rho(l)^2 + 4 rho(l) mu1 mu2]
 *
 * rho being a sum over the terms of amount times the term's own, the covariance is a quadratic form
 * in the amounts. Its coefficients, one for each pair of tau and pair of terms, are made once;
 * after that a covariance for other amounts costs a few thousand multiplications. That is what
 * makes iteration, profiles and bootstraps cheap.
 *
 * rho is smooth but for kinks at the lags where an end of one difference meets an end of the other,
 * near which it varies on the scale of the shorter one. So the sum over lags is taken in pieces
 * that grow by 4 away from the kinks: short ones lag by lag, long ones as an integral by six
 * Gauss-Legendre nodes (Euler-Maclaurin's next correction, 1/12 of the jump of the slope, is below
 * 4e-4 of the piece at 16 lags). Their number grows with the logarithm of the record. */
#include "allan_fit_internal.h"
#include "imukit/elementary.h"

#include <math.h>
#include <string.h>

enum {
    LAG_BY_LAG = 16, /* longest piece that is summed lag by lag */
    KINKS = 13,      /* nine of rho, four of W */
    PAIRS_OF_TERMS = IMKI_ALLAN_TERMS * (IMKI_ALLAN_TERMS + 1) / 2
};
/* Lags beyond the last kink, in longer factors: what flicker noise still adds there, whose rho
 * falls with the square of the lag, is 1e-6. */
#define REACH 256.0

static size_t pair_index(size_t i, size_t j) /* j <= i */
{
    return i * (i + 1) / 2 + j;
}

size_t imki_allan_combinations(size_t terms)
{
    return terms * (terms + 1) / 2;
}

static double squares(size_t length, size_t factor, size_t stride)
{
    return stride < 1 || length < 2 * factor ? 0 : (double)((length - 2 * factor) / stride + 1);
}

size_t imki_allan_stride(const imk_allan_table *table, size_t i)
{
    return table->strides ? table->strides[i] : 1;
}

double imki_allan_squares(const imk_allan_table *table, size_t i)
{
    double sum = 0;
    for (size_t r = 0; r < table->record_count; r++)
        sum += squares(table->lengths[r], table->factors[i], imki_allan_stride(table, i));
    return sum;
}

/* One pair of tau at work. */
typedef struct pair_work {
    const imki_allan_problem *problem;
    size_t first;  /* only pairs of terms whose second is this or later */
    int nodes;     /* of a quadrature piece: 6 or 3 */
    double reach;  /* lags around each kink that are summed one by one, ringing and all; 0:
                      ringing parts are added in closed form instead */
    double m1, m2; /* m1 <= m2 */
    double stride1, stride2, step; /* step: of the lags, the strides' common divisor */
    size_t i1, i2;                 /* places in the table */
    double sum[PAIRS_OF_TERMS];
} pair_work;

static size_t common_divisor(size_t a, size_t b)
{
    while (b > 0) {
        const size_t rest = a % b;
        a = b;
        b = rest;
    }
    return a;
}

/* Pairs of second differences at a lag, all records. */
static double pairs_at(const pair_work *w, double lag)
{
    const imk_allan_table *table = w->problem->table;
    double sum = 0;
    for (size_t r = 0; r < table->record_count; r++) {
        const size_t n = table->lengths[r];
        const double end1 = w->stride1 * squares(n, table->factors[w->i1], (size_t)w->stride1);
        const double end2 = w->stride2 * squares(n, table->factors[w->i2], (size_t)w->stride2);
        const double from = lag < 0 ? -lag : 0, to = end1 < end2 - lag ? end1 : end2 - lag;
        sum += to > from ? to - from : 0;
    }
    return sum * w->step / (w->stride1 * w->stride2);
}

static double lag_difference(const imki_lag_term *term, double lag, double m1, double m2,
                             double (*form)(const imki_lag_term *, double))
{
    static const double c[3] = {1, -2, 1};
    double sum = 0;
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++)
            sum += c[a] * c[b] * form(term, lag + b * m2 - a * m1);
    return sum;
}

/* Smooth part of rho for one term. */
static double smooth_rho(const pair_work *w, const imki_lag_term *term, double lag)
{
    switch (term->kind) {
    case IMKI_LAG_LINEAR:
    case IMKI_LAG_CUBIC:
    case IMKI_LAG_RINGING: /* nothing is shared by stretches that do not overlap */
        if (lag <= -2 * w->m2 || lag >= 2 * w->m1)
            return 0;
        break;
    case IMKI_LAG_RAMP:
        return term->scale * w->m1 * w->m1 * w->m2 * w->m2;
    case IMKI_LAG_DELTA:
    case IMKI_LAG_SINUSOID:
        return 0;
    case IMKI_LAG_FILTERED:
    case IMKI_LAG_LOGARITHM:
    case IMKI_LAG_DECAY:
        break;
    }
    return lag_difference(term, lag, w->m1, w->m2, imki_lag_smooth);
}

/* Add weight * rho_t rho_u at a lag for all pairs of terms. */
static void add_lag(pair_work *w, double lag, double weight)
{
    double rho[IMKI_ALLAN_TERMS];
    const size_t terms = w->problem->terms;
    for (size_t t = 0; t < terms; t++)
        rho[t] = smooth_rho(w, &w->problem->term[t], lag);
    for (size_t t = 0; t < terms && w->reach > 0; t++)
        if (w->problem->term[t].kind == IMKI_LAG_RINGING)
            rho[t] += lag_difference(&w->problem->term[t], lag, w->m1, w->m2, imki_lag_ringing);
    weight *= pairs_at(w, lag);
    for (size_t t = w->first; t < terms; t++)
        for (size_t u = 0; u <= t; u++)
            w->sum[pair_index(t, u)] += weight * rho[t] * rho[u];
}

static void quadrature(pair_work *w, double from, double to)
{
    static const double place6[3] = {0.2386191860831969, 0.6612093864662645, 0.9324695142031521};
    static const double weight6[3] = {0.46791393457269104, 0.3607615730481386, 0.17132449237917036};
    const double centre = 0.5 * (from + to), half = 0.5 * (to - from);
    if (w->nodes == 3) {
        add_lag(w, centre, 8.0 / 9 * half / w->step);
        for (int side = -1; side <= 1; side += 2)
            add_lag(w, centre + side * half * 0.7745966692414834, 5.0 / 9 * half / w->step);
        return;
    }
    for (int k = 0; k < 3; k++)
        for (int side = -1; side <= 1; side += 2)
            add_lag(w, centre + side * half * place6[k], weight6[k] * half / w->step);
}

static void one_by_one(pair_work *w, double from, double to)
{
    for (double lag = from; lag <= to && to > from; lag += w->step)
        add_lag(w, lag, lag == from || lag == to ? 0.5 : 1);
}

/* Between two kinks. */
static void add_piece(pair_work *w, double from, double to, bool kink_from, bool kink_to)
{
    if (to - from <= fmax(LAG_BY_LAG * w->step, 2 * w->reach)) {
        one_by_one(w, from, to);
        return;
    }
    if (w->reach > 0) {
        const double low = kink_from ? from + w->reach : from, high = kink_to ? to - w->reach : to;
        one_by_one(w, from, low);
        one_by_one(w, high, to);
        from = low;
        to = high;
    }
    const double length = to - from;
    const double middle = kink_from && kink_to ? from + 0.5 * length : kink_from ? to : from;
    double x = from;
    if (kink_from) {
        for (double step = w->m1; x + 1.5 * step < middle; step = 3 * (x - from)) {
            quadrature(w, x, x + step);
            x += step;
        }
        quadrature(w, x, middle);
    }
    x = to;
    if (kink_to) {
        for (double step = w->m1; x - 1.5 * step > middle; step = 3 * (to - x)) {
            quadrature(w, x - step, x);
            x -= step;
        }
        quadrature(w, middle, x);
    }
}

static int sort_kinks(double *kink, int count, double low, double high)
{
    int kept = 0;
    for (int i = 0; i < count; i++) {
        const double x = kink[i] < low ? low : kink[i] > high ? high : kink[i];
        int place = kept;
        while (place > 0 && kink[place - 1] > x)
            place--;
        if (place > 0 && kink[place - 1] == x)
            continue;
        memmove(&kink[place + 1], &kink[place], (size_t)(kept - place) * sizeof *kink);
        kink[place] = x;
        kept++;
    }
    return kept;
}

static void add_smooth(pair_work *w)
{
    double kink[KINKS + 1];
    int count = 0;
    double end1 = 0, end2 = 0;
    const imk_allan_table *table = w->problem->table;
    for (size_t r = 0; r < table->record_count; r++) {
        const size_t n = table->lengths[r];
        end1 = fmax(end1, w->stride1 * squares(n, table->factors[w->i1], (size_t)w->stride1));
        end2 = fmax(end2, w->stride2 * squares(n, table->factors[w->i2], (size_t)w->stride2));
    }
    const double low = fmax(-end1, -(2 + REACH) * w->m2);
    const double high = fmin(end2, 2 * w->m1 + REACH * w->m2);
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++)
            kink[count++] = a * w->m1 - b * w->m2;
    kink[count++] = 0;
    kink[count++] = end2 - end1;
    kink[count++] = low;
    kink[count++] = high;
    /* Sorting in place reads ahead of what it has written: one element at a time is safe. */
    const int kept = sort_kinks(kink, count, low, high);
    for (int i = 0; i + 1 < kept; i++)
        add_piece(w, kink[i], kink[i + 1], kink[i] > low, kink[i + 1] < high);
}

/* rho of a term that is a sum of impulses at the nine kinks (quantization; a resonance's ringing
 * part as far as smooth terms see it): distinct lags and their coefficients. */
static int impulses(const pair_work *w, double *lag, double *coefficient)
{
    static const double c[3] = {1, -2, 1};
    int count = 0;
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++) {
            const double place = a * w->m1 - b * w->m2;
            int i = 0;
            while (i < count && lag[i] != place)
                i++;
            if (i == count) {
                lag[count] = place;
                coefficient[count++] = 0;
            }
            coefficient[i] += c[a] * c[b];
        }
    return count;
}

/* All that involves term t where it is impulses of size `scale`. */
static void add_impulses(pair_work *w, size_t t, double scale)
{
    double lag[9], coefficient[9];
    const int count = impulses(w, lag, coefficient);
    const imki_allan_problem *problem = w->problem;
    const bool delta = problem->term[t].kind == IMKI_LAG_DELTA;
    for (int i = 0; i < count; i++) {
        const double weight = scale * coefficient[i] * pairs_at(w, lag[i]);
        for (size_t u = 0; u < problem->terms; u++) {
            if ((t > u ? t : u) < w->first)
                continue;
            const imki_lag_term *other = &problem->term[u];
            double rho = smooth_rho(w, other, lag[i]);
            if (u == t && delta)
                rho = scale * coefficient[i];
            else if (u == t)
                rho *= 2; /* the square of a sum: its mixed product counts twice */
            else if (delta && other->kind == IMKI_LAG_RINGING)
                rho += lag_difference(other, lag[i], w->m1, w->m2, imki_lag_ringing);
            else if (other->kind == IMKI_LAG_DELTA)
                continue; /* counted from its side */
            w->sum[t > u ? pair_index(t, u) : pair_index(u, t)] += weight * rho;
        }
    }
}

/* A resonance's ringing part with itself, the number of pairs taken at the middle of the lags. */
static void add_ringing(pair_work *w, size_t t)
{
    if (t < w->first)
        return;
    double lag[9], coefficient[9], sum = 0;
    const int count = impulses(w, lag, coefficient);
    for (int i = 0; i < count; i++)
        for (int j = 0; j < count; j++)
            sum += coefficient[i] * coefficient[j] *
                   imki_ringing_product(&w->problem->term[t], fabs(lag[i] - lag[j]));
    w->sum[pair_index(t, t)] += sum * pairs_at(w, w->m1 - w->m2) / w->step;
}

/* A sinusoid is a mean of random phase: sum_l rho_u(l) mu1 mu2(l) picks the other term's spectrum
 * at its frequency, with w = 2 pi f dt and F = 16 sin^2(w m1/2) sin^2(w m2/2):
 *
 *     F/(8 sin^2(w/2)) * S_u(f)/dt * F/(4 sin^2(w/2)) */
static void add_sinusoid(pair_work *w, size_t t)
{
    const imki_allan_problem *problem = w->problem;
    const imki_lag_term *term = &problem->term[t];
    const double s1 = imk_sin(0.5 * term->rate * w->m1), s2 = imk_sin(0.5 * term->rate * w->m2);
    const double filter = 16 * s1 * s1 * s2 * s2, weight = pairs_at(w, w->m1 - w->m2) / w->step;
    for (size_t u = 0; u < problem->terms; u++)
        if ((t > u ? t : u) >= w->first && problem->term[u].kind < IMKI_LAG_RAMP)
            w->sum[t > u ? pair_index(t, u) : pair_index(u, t)] +=
                weight * filter * filter * 2 * term->scale * term->scale *
                problem->spectrum[problem->origin[t]][u] / problem->table->dt;
}

/* Where the shorter factor is not long beside a resonance's memory 1/Re lambda, the kinks are seen
 * through its ringing: up to where that has fallen to e^-4, lag by lag. */
static double ringing_reach(const pair_work *w)
{
    enum { LAGS_MAX = 2048 };
    double reach = 0;
    for (size_t t = 0; t < w->problem->terms; t++)
        if (w->problem->term[t].kind == IMKI_LAG_RINGING) {
            const double memory = 1 / w->problem->term[t].lambda[0][0];
            if (w->m1 < 8 * memory)
                reach = fmax(reach, 4 * memory);
        }
    return w->step * fmin(LAGS_MAX, ceil(reach / w->step));
}

static void sum_pair(pair_work *w)
{
    memset(w->sum, 0, sizeof w->sum);
    w->reach = ringing_reach(w);
    add_smooth(w);
    for (size_t t = 0; t < w->problem->terms; t++) {
        const imki_lag_term *term = &w->problem->term[t];
        if (term->kind == IMKI_LAG_DELTA)
            add_impulses(w, t, term->scale);
        if (term->kind == IMKI_LAG_RINGING && w->reach == 0) {
            add_impulses(w, t, imki_ringing_sum(term) / w->step);
            add_ringing(w, t);
        }
        if (term->kind == IMKI_LAG_SINUSOID)
            add_sinusoid(w, t);
    }
}

/* Two means do not vary; 2 rho^2 makes 2 for a term with itself and 4 for two; so does 4 rho mu. */
static double multiplicity(const imki_allan_problem *problem, size_t t, size_t u)
{
    if (problem->term[t].kind >= IMKI_LAG_RAMP && problem->term[u].kind >= IMKI_LAG_RAMP)
        return 0;
    return t == u ? 2 : 4;
}

void imki_allan_sums(imki_allan_problem *problem, size_t first, bool coarse)
{
    const imk_allan_table *table = problem->table;
    const size_t terms = problem->terms, combinations = imki_allan_combinations(problem->capacity);
    pair_work w = {.problem = problem, .first = first, .nodes = coarse ? 3 : 6};
    for (size_t i = 0; i < table->count; i++)
        for (size_t j = 0; j <= i; j++) {
            w.i1 = j;
            w.i2 = i;
            w.m1 = (double)table->factors[j];
            w.m2 = (double)table->factors[i];
            const size_t stride1 = imki_allan_stride(table, j),
                         stride2 = imki_allan_stride(table, i);
            w.stride1 = (double)stride1;
            w.stride2 = (double)stride2;
            w.step = (double)common_divisor(stride1, stride2);
            sum_pair(&w);
            const double scale = 1 / (4 * w.m1 * w.m1 * w.m2 * w.m2) /
                                 (imki_allan_squares(table, i) * imki_allan_squares(table, j));
            double *out = &problem->sums[pair_index(i, j) * combinations];
            for (size_t t = first; t < terms; t++)
                for (size_t u = 0; u <= t; u++)
                    out[pair_index(t, u)] =
                        scale * multiplicity(problem, t, u) * w.sum[pair_index(t, u)];
        }
}

void imki_allan_matrix(const imki_allan_problem *problem, const double *amount, double *matrix)
{
    const size_t n = problem->table->count, terms = problem->terms;
    const size_t combinations = imki_allan_combinations(terms);
    double product[PAIRS_OF_TERMS];
    for (size_t t = 0; t < terms; t++)
        for (size_t u = 0; u <= t; u++)
            product[pair_index(t, u)] = amount[t] * amount[u];
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j <= i; j++) {
            const double *sums =
                &problem->sums[pair_index(i, j) * imki_allan_combinations(problem->capacity)];
            double sum = 0;
            for (size_t k = 0; k < combinations; k++)
                sum += product[k] * sums[k];
            matrix[i * n + j] = matrix[j * n + i] = sum;
        }
}
