/* SPDX-License-Identifier: Apache-2.0 */
/* Intervals that hold for whichever set of terms is right.
 *
 * A random walk or a ramp, bias instability or a Gauss-Markov term: often two sets of terms explain
 * a record about as well, and the intervals of the chosen one state as known what it leaves out.
 * With m a set, L_m(x) its likelihood with a parameter held at x and p_m its number of parameters,
 * the interval is where
 *
 *     max_m [L_m(x) - p_m] >= max_m [L_m - p_m] - drop
 *
 * among the sets that the search has met: the charge of one unit for a parameter makes likelihoods
 * of different sets comparable [AKAIKE1978]. A term whose interval then begins at zero is not
 * certain: the record could hold something else in its place. */
#include "identify_internal.h"

#include <math.h>

static size_t count_gauss_markov(const imki_fit *fit)
{
    size_t count = 0;
    for (size_t i = IMKI_FIRST_GAUSS_MARKOV; i < IMKI_FIRST_RESONANCE; i++)
        count += fit->active[i] && fit->amount[i] > 0;
    return count;
}

/* What a set costs; bias instability and random walk are in all. A ramp, which is not a strength
 * and can take the place of any slow noise, costs two. A Gauss-Markov term has two parameters, but
 * of its time a record often tells little: with 1.5, bias instability that is one is claimed
 * without an alternative in 3 % of records, with 2 in 6 % (experiments/coverage_mixtures.c). */
static double cost_of(bool ramp, size_t gauss_markov)
{
    return 2 * (double)ramp + 1.5 * (double)gauss_markov;
}

static double worth(const imki_fit *fit)
{
    return fit->log_likelihood - cost_of(fit->ramp_active, count_gauss_markov(fit));
}

/* The interval of a strength covers that of the fit's set, too. */
static void join_strength(imki_work *w, int term, double drop, imk_estimate *e)
{
    const imki_amounts best = imki_fit_keep(w->fit);
    double centre, step;
    const imki_interval_profile p = imki_interval_profile_at(w, term, drop, &centre, &step);
    if (centre > e->upper || imki_interval_beyond(&p, e->upper) < 0)
        e->upper = fmax(e->upper, imki_interval_end(&p, centre, step, HUGE_VAL));
    imki_fit_restore(w->fit, w->bands, &best);
    if (e->lower > 0 && (centre < e->lower || imki_interval_beyond(&p, e->lower) < 0))
        e->lower = centre > 0 ? fmin(e->lower, imki_interval_end(&p, centre, -step, 0)) : 0;
    imki_fit_restore(w->fit, w->bands, &best);
}

static void join_ramp(const imki_fit *fit, imk_estimate *e)
{
    if (!e->present || fit->ramp_active)
        return;
    e->lower = fmin(e->lower, 0);
    e->upper = fmax(e->upper, 0);
}

/* A Gauss-Markov term of which the set has none with a time inside its interval. */
static void join_gauss_markov(const imki_fit *fit, const imk_estimate *time, imk_estimate *sigma)
{
    for (size_t i = 0; i < IMKI_GAUSS_MARKOV_MAX; i++) {
        const size_t slot = IMKI_FIRST_GAUSS_MARKOV + i;
        if (fit->active[slot] && fit->amount[slot] > 0 && fit->correlation_time[i] >= time->lower &&
            fit->correlation_time[i] <= time->upper)
            return;
    }
    sigma->lower = 0;
}

/* Terms of the set that were not chosen. */
static unsigned others_of(const imki_fit *fit, const imk_identification *result)
{
    unsigned others = 0;
    for (int term = IMK_NOISE_BIAS_INSTABILITY; term <= IMK_NOISE_RANDOM_WALK; term++)
        if (fit->amount[term] > 0 && !result->term[term].present)
            others |= 1u << term;
    if (fit->ramp_active && !result->term[IMK_NOISE_RAMP].present)
        others |= 1u << IMK_NOISE_RAMP;
    if (count_gauss_markov(fit) > (size_t)result->gauss_markov_count)
        others |= IMK_AMBIGUOUS_GAUSS_MARKOV;
    return others;
}

static unsigned uncertain_of(const imk_identification *result)
{
    unsigned uncertain = 0;
    for (int term = IMK_NOISE_WHITE; term < IMK_NOISE_TERMS; term++) {
        const imk_estimate *e = &result->term[term];
        if (e->present && e->lower <= 0 && e->upper >= 0)
            uncertain |= 1u << term;
    }
    for (int i = 0; i < result->gauss_markov_count; i++)
        if (!(result->gauss_markov[i].sigma.lower > 0))
            uncertain |= IMK_AMBIGUOUS_GAUSS_MARKOV;
    return uncertain;
}

static void join_set(imki_work *w, imk_identification *result, double drop)
{
    imki_fit *fit = w->fit;
    const unsigned others = others_of(fit, result), before = uncertain_of(result);
    for (int term = IMK_NOISE_WHITE; term <= IMK_NOISE_RANDOM_WALK; term++)
        join_strength(w, term, drop, &result->term[term]);
    join_ramp(fit, &result->term[IMK_NOISE_RAMP]);
    for (int i = 0; i < result->gauss_markov_count; i++)
        join_gauss_markov(fit, &result->gauss_markov[i].correlation_time,
                          &result->gauss_markov[i].sigma);
    if (uncertain_of(result) & ~before)
        result->instead |= others;
}

/* Among the sets met, one with more terms is never behind by chance alone: what search and fit left
 * of its likelihood is less than this. */
static const double UNSETTLED = 3;

void imki_intervals_join(imki_work *w, imk_identification *result, double drop)
{
    imki_fit *fit = w->fit;
    const imki_alternatives *met = w->alternatives;
    const imki_amounts chosen = imki_fit_keep(fit);
    result->ambiguous = uncertain_of(result);
    imki_intervals_free(w, IMKI_HELD_NONE);
    result->instead = result->ambiguous ? others_of(fit, result) : 0;
    const double best = worth(fit);
    const size_t count = count_gauss_markov(fit);
    for (size_t ramp = 0; ramp < 2; ramp++)
        for (size_t i = 0; i < IMKI_ALTERNATIVE_COUNTS; i++) {
            const double cost = cost_of(ramp > 0, i);
            if ((ramp == chosen.ramp_active && i == count) ||
                !(met->log_likelihood[ramp][i] - cost + UNSETTLED > best - drop))
                continue;
            imki_fit_restore(fit, w->bands, &met->set[ramp][i]);
            imki_intervals_free(w, IMKI_HELD_NONE);
            const double left = drop - (best - worth(fit));
            if (left > 0.01 * drop)
                join_set(w, result, fmin(left, drop));
        }
    imki_fit_restore(fit, w->bands, &chosen);
    result->ambiguous = uncertain_of(result);
}
