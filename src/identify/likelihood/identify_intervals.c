/* SPDX-License-Identifier: Apache-2.0 */
/* Values, standard deviations and profile-likelihood intervals of the chosen terms. */
#include "identify_internal.h"
#include "imukit/distributions.h"
#include "imukit/elementary.h"

#include <math.h>
#include <string.h>

/* Values, sigmas and correlations of the chosen terms. */
static void store_values(const imki_work *w, imk_identification *result)
{
    imki_fit *fit = w->fit;
    const size_t t = fit->templates;
    double covariance[IMKI_TEMPLATES_MAX * IMKI_TEMPLATES_MAX];
    imki_fit_covariance(fit, w->bands, covariance);
    for (size_t i = 0; i < IMKI_FIRST_GAUSS_MARKOV; i++) {
        imk_estimate *e = &result->term[i];
        e->present = fit->active[i] && fit->amount[i] > 0;
        e->value = e->present ? sqrt(fit->amount[i]) : 0;
        e->sigma = e->present ? sqrt(covariance[i * t + i]) / (2 * e->value) : 0;
        for (size_t j = 0; j < IMKI_FIRST_GAUSS_MARKOV; j++) {
            const double product = covariance[i * t + i] * covariance[j * t + j];
            result->correlation[i][j] =
                product > 0 ? covariance[i * t + j] / sqrt(product) : i == j;
        }
    }
    imk_estimate *ramp = &result->term[IMK_NOISE_RAMP];
    ramp->present = fit->ramp_active;
    ramp->value = fit->ramp_active ? fit->ramp : 0;
    ramp->sigma = 1 / sqrt(imki_fit_ramp_information(fit, w->bands));
    result->correlation[IMK_NOISE_RAMP][IMK_NOISE_RAMP] = 1;
    for (int r = 0; r < result->resonance_count; r++)
        if (fit->active[IMKI_FIRST_RESONANCE + r])
            result->resonance[r].sigma = sqrt(fit->amount[IMKI_FIRST_RESONANCE + r]);
    result->log_likelihood = fit->log_likelihood;
}

/* Interval of a strength or the ramp around the maximum at which the fit is. */
static void interval_at(const imki_work *w, int held, double drop, imk_estimate *e)
{
    const bool ramp = held == IMKI_HELD_RAMP;
    double centre, step;
    const imki_interval_profile p = imki_interval_profile_at(w, held, drop, &centre, &step);
    e->free_value = centre;
    e->upper = imki_interval_end(&p, centre, step, HUGE_VAL);
    e->lower =
        centre == 0 && !ramp ? 0 : imki_interval_end(&p, centre, -step, ramp ? -HUGE_VAL : 0);
}

/* Whether quantization was called present, just or just not, moves white noise by more than its
 * interval is wide. Where the choice was close, the centre is the mean of the two, each with the
 * likelihood less penalty as the logarithm of its weight [AKAIKE1978]. */
static void average_with_quantization(imki_work *w, imk_estimate *e)
{
    imki_fit *fit = w->fit;
    const double drop = 0.5 * imk_chi_square_quantile(w->settings->confidence, 1);
    const double needed = 0.5 * imk_chi_square_quantile(1 - 2 * w->settings->significance, 1);
    const double chosen = fit->log_likelihood;
    const bool on = !fit->active[IMK_NOISE_QUANTIZATION];
    imki_quantization_switch(w);
    const double behind = chosen - fit->log_likelihood, ahead = behind + (on ? needed : -needed);
    if (!(ahead < drop && behind < drop + 1)) /* far from the other, whose centre is outside */
        return;
    const double weight = 1 / (1 + imk_exp(-ahead)), other = fit->amount[IMK_NOISE_WHITE];
    e->free_value = sqrt(weight * e->free_value * e->free_value + (1 - weight) * other);
}

/* Intervals are those of the model in which white noise, bias instability, random walk and the term
 * itself are all free, whether they were called present or not: leaving a term out would claim to
 * know that it is zero. */
static void store_interval(imki_work *w, imk_identification *result, int term, double drop)
{
    imk_estimate *e = &result->term[term];
    const imki_amounts chosen = imki_fit_keep(w->fit);
    imki_intervals_free(w, term);
    const imki_amounts freed = imki_fit_keep(w->fit);
    interval_at(w, term == IMK_NOISE_RAMP ? IMKI_HELD_RAMP : term, drop, e);
    if (term == IMK_NOISE_WHITE) {
        imki_fit_restore(w->fit, w->bands, &freed);
        average_with_quantization(w, e);
    }
    if (!e->present && term == IMK_NOISE_RAMP)
        e->upper = fmax(fabs(e->lower), fabs(e->upper));
    if (!e->present)
        e->lower = 0;
    imki_fit_restore(w->fit, w->bands, &chosen);
}

/* Strength and correlation time of a Gauss-Markov term, each with the other, and with white noise,
 * bias instability and random walk, free. */
static void store_gauss_markov(imki_work *w, imk_identification *result, size_t term, double drop)
{
    const size_t slot = IMKI_FIRST_GAUSS_MARKOV + term;
    struct imk_gauss_markov_estimate *g = &result->gauss_markov[result->gauss_markov_count++];
    const imki_amounts chosen = imki_fit_keep(w->fit);
    const double time = chosen.correlation_time[term];
    g->sigma = (imk_estimate){.present = true, .value = sqrt(chosen.amount[slot])};
    g->correlation_time = (imk_estimate){.present = true, .value = time};
    imki_intervals_free(w, IMK_NOISE_WHITE);
    double sigma, step;
    imki_interval_profile p = imki_interval_profile_at(w, (int)slot, drop, &sigma, &step);
    g->sigma.free_value = sigma;
    g->sigma.lower = sigma > 0 ? imki_interval_end(&p, sigma, -step, 0) : 0;
    g->sigma.upper = imki_interval_end(&p, sigma, step, HUGE_VAL);
    g->sigma.sigma = (g->sigma.upper - g->sigma.lower) / (2 * sqrt(2 * drop));

    /* A correlation time beyond a hundred times the estimate is not told. */
    p.held = IMKI_HELD_NONE;
    p.held_time = (int)term;
    p.drop = drop;
    imk_estimate *t = &g->correlation_time;
    const double free_time = p.best.correlation_time[term], place = imk_ln(free_time);
    t->free_value = free_time;
    t->lower = imk_exp(imki_interval_end(&p, place, -0.3, place - 4.6));
    t->upper = imk_exp(imki_interval_end(&p, place, 0.3, place + 4.6));
    t->sigma = (t->upper - t->lower) / (2 * sqrt(2 * drop));
    imki_fit_restore(w->fit, w->bands, &chosen);
}

/* Shortest correlation time first. */
static void store_gauss_markovs(imki_work *w, imk_identification *result, double drop)
{
    const imki_fit *fit = w->fit;
    bool stored[IMKI_GAUSS_MARKOV_MAX] = {false};
    for (;;) {
        size_t next = IMKI_GAUSS_MARKOV_MAX;
        for (size_t term = 0; term < IMKI_GAUSS_MARKOV_MAX; term++)
            if (fit->active[IMKI_FIRST_GAUSS_MARKOV + term] &&
                fit->amount[IMKI_FIRST_GAUSS_MARKOV + term] > 0 && !stored[term] &&
                (next == IMKI_GAUSS_MARKOV_MAX ||
                 fit->correlation_time[term] < fit->correlation_time[next]))
                next = term;
        if (next == IMKI_GAUSS_MARKOV_MAX)
            return;
        stored[next] = true;
        store_gauss_markov(w, result, next, drop);
    }
}

/* Slow noise is told when there is some, and bias instability, if it is that, to a factor of 3. */
static bool is_short(const imk_identification *result)
{
    const imk_estimate *b = &result->term[IMK_NOISE_BIAS_INSTABILITY];
    const bool other = result->term[IMK_NOISE_RANDOM_WALK].present ||
                       result->term[IMK_NOISE_RAMP].present || result->gauss_markov_count > 0;
    return b->present ? b->upper > 3 * b->lower : !other;
}

/* Known to no better than a factor of three up and down: filter, resonances or another term take
 * its place. White noise of which only another set of terms has less is ambiguous instead. */
static bool is_undetermined(const imk_estimate *e)
{
    return e->present && !(e->upper <= 9 * e->lower);
}

void imki_identify_intervals(imki_work *w, imk_identification *result)
{
    const double drop = 0.5 * imk_chi_square_quantile(w->settings->confidence, 1);
    store_values(w, result);
    imki_identify_level(w, result);
    for (int term = 0; term < IMK_NOISE_TERMS; term++)
        store_interval(w, result, term, drop);
    store_gauss_markovs(w, result, drop);
    if (is_short(result))
        result->verdict |= IMK_VERDICT_SHORT;
    const bool white_alone = is_undetermined(&result->term[IMK_NOISE_WHITE]);
    imki_intervals_join(w, result, drop);
    imki_identify_widen(w, result);
    imki_intervals_join_shape(w, result);
    const bool ambiguous = !white_alone && (result->ambiguous >> IMK_NOISE_WHITE & 1);
    if ((is_undetermined(&result->term[IMK_NOISE_WHITE]) && !ambiguous) ||
        is_undetermined(&result->term[IMK_NOISE_QUANTIZATION]))
        result->verdict |= IMK_VERDICT_UNDETERMINED;
}
