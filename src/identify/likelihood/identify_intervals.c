/* SPDX-License-Identifier: Apache-2.0 */
/* Values, standard deviations and profile-likelihood intervals of the chosen terms. */
#include "identify_internal.h"
#include "imukit/distributions.h"

#include <math.h>
#include <string.h>

/* A likelihood held at places of one parameter: a strength (by its square root), the ramp, or the
 * correlation time of a Gauss-Markov term (by its logarithm). */
typedef struct profile {
    imki_fit *fit;
    const imki_bands *bands;
    int held, held_time;
    imki_amounts best;
    double drop; /* of the log-likelihood, at the interval's end */
} profile;

/* Signed root of twice the fall of the likelihood, less what it is at the interval's end: nearly
 * linear in the place. The fit is left at the place, so that the next one starts from there. */
static double beyond(const profile *p, double place)
{
    if (p->held_time >= 0) {
        const size_t term = (size_t)p->held_time;
        p->fit->correlation_time[term] = exp(place);
        imki_gauss_markov_shape(p->fit, p->bands, exp(place),
                                p->fit->shape[IMKI_FIRST_GAUSS_MARKOV + term]);
    } else if (p->held == IMKI_HELD_RAMP) {
        p->fit->ramp = place;
    } else {
        p->fit->amount[p->held] = place * place;
    }
    const double fall =
        p->best.log_likelihood - imki_gauss_markov_settle(p->fit, p->bands, p->held, p->held_time);
    return sqrt(fmax(0, 2 * fall)) - sqrt(2 * p->drop);
}

/* End of the interval in the direction of `step`, at most at `limit`: bracketed by growing steps,
 * then by regula falsi, the value of an end that stays halved [DOWELL1971]. */
static double profile_end(const profile *p, double start, double step, double limit)
{
    double inside = start, outside = start, at_inside = -sqrt(2 * p->drop), at_outside = 0;
    imki_fit_restore(p->fit, p->bands, &p->best);
    for (int i = 0; i < 60; i++) {
        outside = step > 0 ? fmin(outside + step, limit) : fmax(outside + step, limit);
        at_outside = beyond(p, outside);
        if (at_outside > 0)
            break;
        if (outside == limit)
            return limit;
        inside = outside;
        at_inside = at_outside;
        step *= at_inside < -0.8 * sqrt(2 * p->drop) ? 4 : 1.5;
    }
    for (int i = 0, side = 0; i < 30 && fabs(outside - inside) > 1e-4 * fabs(outside - start);
         i++) {
        double place = inside - at_inside * (outside - inside) / (at_outside - at_inside);
        if (!(fabs(place - inside) < fabs(outside - inside)))
            place = 0.5 * (inside + outside);
        const double at = beyond(p, place);
        if (fabs(at) < 1e-4)
            return place;
        if (at > 0) {
            outside = place;
            at_outside = at;
            at_inside *= side > 0 ? 0.5 : 1;
            side = 1;
        } else {
            inside = place;
            at_inside = at;
            at_outside *= side < 0 ? 0.5 : 1;
            side = -1;
        }
    }
    return 0.5 * (inside + outside);
}

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

/* Bartlett's factor of the likelihood ratio [BARTLETT1937]: for a variance estimated with v degrees
 * of freedom its mean is v [log(v/2) - digamma(v/2)] ~ 1 + 1/(3v), not 1. Here v = 2 (amount/sd)^2,
 * at least 2. */
static double small_sample_factor(double amount, double sd)
{
    const double degrees = 2 * (amount / sd) * (amount / sd);
    return 1 + 1 / (3 * (degrees > 2 ? degrees : 2));
}

/* Everything that was chosen, with white noise, bias instability, random walk and the term itself
 * free as well. */
static void set_free(imki_work *w, int term)
{
    static const bool always[IMK_NOISE_TERMS] = {false, true, true, true, false};
    imki_fit *fit = w->fit;
    for (int j = 0; j < IMKI_FIRST_GAUSS_MARKOV; j++)
        if ((always[j] || j == term) && !fit->active[j]) {
            fit->active[j] = true;
            fit->amount[j] = 1e-6 * w->bands->power[0] / fit->shape[j][0];
        }
    fit->ramp_active = fit->ramp_active || term == IMK_NOISE_RAMP;
    imki_gauss_markov_settle(fit, w->bands, IMKI_HELD_NONE, IMKI_HELD_NONE);
}

/* Centre of the interval of a strength or of the ramp at the fit, and a first step from it; allows
 * for a strength known from few coefficients in the drop. */
static double centre_of(const imki_work *w, int held, profile *p, double *step)
{
    imki_fit *fit = w->fit;
    if (held == IMKI_HELD_RAMP) {
        *step = 1 / sqrt(imki_fit_ramp_information(fit, w->bands));
        return fit->ramp;
    }
    double covariance[IMKI_TEMPLATES_MAX * IMKI_TEMPLATES_MAX];
    imki_fit_covariance(fit, w->bands, covariance);
    const double sd = sqrt(covariance[(size_t)held * fit->templates + (size_t)held]);
    const double centre = sqrt(fit->amount[held]);
    p->drop *= small_sample_factor(fit->amount[held], sd);
    *step = 2 * (sqrt(fit->amount[held] + sd) - centre); /* near the end of 95 % */
    return centre;
}

/* Interval of a strength or the ramp around the maximum at which the fit is. */
static void interval_at(const imki_work *w, int held, double drop, imk_estimate *e)
{
    profile p = {w->fit, w->bands, held, IMKI_HELD_NONE, imki_fit_keep(w->fit), drop};
    const bool ramp = held == IMKI_HELD_RAMP;
    double step;
    const double centre = centre_of(w, held, &p, &step);
    e->free_value = centre;
    e->upper = profile_end(&p, centre, step, HUGE_VAL);
    e->lower = centre == 0 && !ramp ? 0 : profile_end(&p, centre, -step, ramp ? -HUGE_VAL : 0);
}

/* Whether quantization was called present, just or just not, moves white noise by more than its
 * interval is wide. Where the choice was close, the interval covers both: of the other model what
 * lies within the same drop of the likelihood less penalty; and its centre is the mean of the two,
 * each with the likelihood less penalty as the logarithm of its weight [AKAIKE1978]. */
static void widen_for_quantization(imki_work *w, double drop, imk_estimate *e)
{
    imki_fit *fit = w->fit;
    const double needed = 0.5 * imk_chi_square_quantile(1 - 2 * w->settings->significance, 1);
    const double chosen = fit->log_likelihood;
    const bool on = !fit->active[IMK_NOISE_QUANTIZATION];
    fit->active[IMK_NOISE_QUANTIZATION] = on;
    fit->amount[IMK_NOISE_QUANTIZATION] =
        on ? 0.1 * fit->amount[IMK_NOISE_WHITE] * w->bands->dt * w->bands->dt : 0;
    const double other = imki_gauss_markov_settle(fit, w->bands, IMKI_HELD_NONE, IMKI_HELD_NONE);
    const double ahead = chosen - other + (on ? needed : -needed), left = drop - ahead;
    imk_estimate too;
    if (!(left > 0.01 * drop))
        return;
    interval_at(w, IMK_NOISE_WHITE, fmin(left, drop), &too);
    e->lower = fmin(e->lower, too.lower);
    e->upper = fmax(e->upper, too.upper);
    const double weight = 1 / (1 + exp(-ahead));
    e->free_value = sqrt(weight * e->free_value * e->free_value +
                         (1 - weight) * too.free_value * too.free_value);
}

/* Intervals are those of the model in which white noise, bias instability, random walk and the term
 * itself are all free, whether they were called present or not: leaving a term out would claim to
 * know that it is zero. */
static void store_interval(imki_work *w, imk_identification *result, int term, double drop)
{
    imk_estimate *e = &result->term[term];
    const imki_amounts chosen = imki_fit_keep(w->fit);
    set_free(w, term);
    const imki_amounts freed = imki_fit_keep(w->fit);
    interval_at(w, term == IMK_NOISE_RAMP ? IMKI_HELD_RAMP : term, drop, e);
    if (term == IMK_NOISE_WHITE) {
        imki_fit_restore(w->fit, w->bands, &freed);
        widen_for_quantization(w, drop, e);
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
    set_free(w, IMK_NOISE_WHITE);
    profile p = {w->fit, w->bands, (int)slot, IMKI_HELD_NONE, imki_fit_keep(w->fit), drop};
    double step;
    const double sigma = centre_of(w, (int)slot, &p, &step);
    g->sigma.free_value = sigma;
    g->sigma.lower = sigma > 0 ? profile_end(&p, sigma, -step, 0) : 0;
    g->sigma.upper = profile_end(&p, sigma, step, HUGE_VAL);
    g->sigma.sigma = (g->sigma.upper - g->sigma.lower) / (2 * sqrt(2 * drop));

    /* A correlation time beyond a hundred times the estimate is not told. */
    p.held = IMKI_HELD_NONE;
    p.held_time = (int)term;
    p.drop = drop;
    imk_estimate *t = &g->correlation_time;
    const double free_time = p.best.correlation_time[term], place = log(free_time);
    t->free_value = free_time;
    t->lower = exp(profile_end(&p, place, -0.3, place - 4.6));
    t->upper = exp(profile_end(&p, place, 0.3, place + 4.6));
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

void imki_identify_intervals(imki_work *w, imk_identification *result)
{
    const double drop = 0.5 * imk_chi_square_quantile(w->settings->confidence, 1);
    store_values(w, result);
    for (int term = 0; term < IMK_NOISE_TERMS; term++)
        store_interval(w, result, term, drop);
    store_gauss_markovs(w, result, drop);
    imki_identify_widen(w, result);
}
