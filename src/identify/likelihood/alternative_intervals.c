/* SPDX-License-Identifier: Apache-2.0 */
/* Intervals that hold for whichever set of terms is right.
 *
 * A random walk or a ramp, bias instability or a Gauss-Markov term: often two sets of terms explain
 * a record about as well, and the intervals of the chosen one state as known what it leaves out.
 * With m a set, 0 the chosen one, L_m(x) the likelihood with a parameter held at x and c_m the cost
 * of a set, the interval is where one of the sets that the search has met has
 *
 *     L_m(x) >= L_m - drop + max(0, [L_0 - c_0] - [L_m - c_m])
 *
 * A cost of about one unit for a parameter makes likelihoods of different sets comparable
 * [AKAIKE1978]. A term whose interval then begins at zero is not certain: the record could hold
 * something else in its place. */
#include "identify/joint/joint_shape_internal.h"

#include <math.h>

static size_t count_gauss_markov(const imki_fit *fit)
{
    size_t count = 0;
    for (size_t i = IMKI_FIRST_GAUSS_MARKOV; i < IMKI_FIRST_RESONANCE; i++)
        count += fit->active[i] && fit->amount[i] > 0;
    return count;
}

/* What a set costs; bias instability and random walk are in all. A cost keeps intervals short
 * where the term is not there, and makes them too short where it is there but was not chosen: next
 * to quantization of two of its standard deviations the interval of white noise held in 91 % with a
 * cost of 1, and holds in 94 % with 0.25 (docs/theory/identification.md). A ramp, which is not a
 * strength and can take the place of any slow noise, costs two. A Gauss-Markov term has two
 * parameters, but of its time a record often tells little: with 1, bias instability that is one is
 * claimed without an alternative in 3 % of records (experiments/coverage_mixtures.c). */
static const double RAMP = 2, GAUSS_MARKOV = 1, QUANTIZATION = 0.25;

static double cost_of(bool ramp, size_t gauss_markov)
{
    return RAMP * (double)ramp + GAUSS_MARKOV * (double)gauss_markov;
}

static bool has_quantization(const imki_fit *fit)
{
    return fit->active[IMK_NOISE_QUANTIZATION] && fit->amount[IMK_NOISE_QUANTIZATION] > 0;
}

static double worth(const imki_fit *fit)
{
    return fit->log_likelihood - cost_of(fit->ramp_active, count_gauss_markov(fit)) -
           QUANTIZATION * (double)has_quantization(fit);
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
    imki_fit_polish(fit, w->bands);
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

/* Worth of the chosen set, and most of those met. */
typedef struct standing {
    double chosen, most;
} standing;

static void join_near(imki_work *w, imk_identification *result, standing *s, double drop)
{
    const double here = worth(w->fit), left = drop - (s->chosen - here);
    s->most = fmax(s->most, here);
    if (left > 0.01 * drop)
        join_set(w, result, fmin(left, drop));
}

/* The fit's set with quantization or without, the other way round. */
static void join_quantization(imki_work *w, imk_identification *result, standing *s, double drop)
{
    imki_fit *fit = w->fit;
    const bool without = !fit->active[IMK_NOISE_QUANTIZATION];
    imki_quantization_switch(w);
    if (!without || has_quantization(fit)) /* else the same set */
        join_near(w, result, s, drop);
}

/* White noise is the same in all sets: the chosen one, too, adds to its interval only what is left
 * to it behind the set that is worth most. Of a slow term the chosen set keeps its whole interval:
 * the others differ in what they leave to that term. */
static void begin_white(imk_estimate *e)
{
    e->lower = fmin(e->value, e->free_value);
    e->upper = fmax(e->value, e->free_value);
}

static void end_white(imki_work *w, const standing *s, double drop, imk_estimate *e)
{
    const double left = drop - (s->most - s->chosen);
    if (left > 0.01 * drop)
        join_strength(w, IMK_NOISE_WHITE, left, e);
}

/* A resonance at the least quality that is tried is a wider one, or another shape. What it leaves
 * over has its frequencies, and a Gauss-Markov term with a corner there may be nothing else. */
static bool is_rest(const imk_identification *result, double correlation_time)
{
    const double corner = 1 / (6.283185307179586 * correlation_time);
    for (int r = 0; r < result->resonance_count; r++) {
        const double ratio = corner / result->resonance[r].frequency;
        if (result->resonance[r].q < 1.001 * IMKI_WIDEST && ratio > 0.1 && ratio < 10)
            return true;
    }
    return false;
}

/* Such a term takes white noise and bias instability below its corner: their intervals cover those
 * without it, however much it adds to the likelihood. */
static void join_without_rest(imki_work *w, imk_identification *result, double drop)
{
    imki_fit *fit = w->fit;
    bool any = false;
    for (int i = 0; i < result->gauss_markov_count; i++)
        if (is_rest(result, result->gauss_markov[i].correlation_time.value)) {
            result->gauss_markov[i].sigma.lower = 0;
            any = true;
        }
    if (!any)
        return;
    for (size_t i = 0; i < IMKI_GAUSS_MARKOV_MAX; i++) {
        const size_t slot = IMKI_FIRST_GAUSS_MARKOV + i;
        if (fit->active[slot] && is_rest(result, fit->correlation_time[i])) {
            fit->active[slot] = false;
            fit->amount[slot] = 0;
        }
    }
    imki_intervals_free(w, IMKI_HELD_NONE);
    join_set(w, result, drop);
}

/* Where resonances are needed that were no lines, they all describe what the filter leaves, as
 * behind a moving average. What they have at frequency 0 is then white noise that went through it.
 */
void imki_intervals_join_shape(const imki_work *w, imk_identification *result)
{
    const imki_fit *fit = w->fit;
    imk_estimate *white = &result->term[IMK_NOISE_WHITE];
    double low = 0;
    for (int r = 0; r < result->resonance_count; r++) {
        const size_t slot = IMKI_FIRST_RESONANCE + (size_t)r;
        low += fit->active[slot] ? fit->amount[slot] * fit->shape[slot][0] : 0;
    }
    if (result->resonance_count <= w->resonant_lines)
        return;
    white->upper = sqrt(white->upper * white->upper + low);
    result->plateau = sqrt(white->value * white->value + low);
}

void imki_intervals_join(imki_work *w, imk_identification *result, double drop)
{
    imki_fit *fit = w->fit;
    const imki_alternatives *met = w->alternatives;
    const imki_amounts chosen = imki_fit_keep(fit);
    result->ambiguous = uncertain_of(result);
    imki_intervals_free(w, IMKI_HELD_NONE);
    result->instead = result->ambiguous ? others_of(fit, result) : 0;
    const imki_amounts freed = imki_fit_keep(fit);
    standing s = {worth(fit), worth(fit)};
    const size_t count = count_gauss_markov(fit);
    begin_white(&result->term[IMK_NOISE_WHITE]);
    join_quantization(w, result, &s, drop);
    for (size_t ramp = 0; ramp < 2; ramp++)
        for (size_t i = 0; i < IMKI_ALTERNATIVE_COUNTS; i++) {
            const double cost = cost_of(ramp > 0, i);
            if ((ramp == chosen.ramp_active && i == count) ||
                !(met->log_likelihood[ramp][i] - cost + UNSETTLED > s.chosen - drop))
                continue;
            imki_fit_restore(fit, w->bands, &met->set[ramp][i]);
            imki_intervals_free(w, IMKI_HELD_NONE);
            join_near(w, result, &s, drop);
            join_quantization(w, result, &s, drop);
        }
    imki_fit_restore(fit, w->bands, &freed);
    end_white(w, &s, drop, &result->term[IMK_NOISE_WHITE]);
    imki_fit_restore(fit, w->bands, &chosen);
    join_without_rest(w, result, drop);
    imki_fit_restore(fit, w->bands, &chosen);
    result->ambiguous = uncertain_of(result);
}
