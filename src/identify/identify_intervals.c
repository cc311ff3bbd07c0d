/* SPDX-License-Identifier: Apache-2.0 */
/* Values, standard deviations and profile-likelihood intervals of the chosen terms. */
#include "identify_internal.h"
#include "imukit/distributions.h"

#include <math.h>
#include <string.h>

/* Largest distance from the estimate, in one direction, at which the profile likelihood has fallen
 * by `drop`. Works on the amplitude (square root of the amount; the ramp as it is). */
static double profile_end(const imki_fit *best, imki_fit *trial, const imki_bands *bands, int held,
                          double start, double step, double drop)
{
    const bool ramp = held == IMKI_HELD_RAMP;
    double inside = start, outside = start;
    for (int i = 0; i < 60; i++) {
        outside = start + step;
        if (!ramp && outside <= 0)
            outside = 0;
        *trial = *best;
        const double l = imki_fit_profile(trial, bands, held, ramp ? outside : outside * outside);
        if (best->log_likelihood - l > drop)
            break;
        if (!ramp && outside == 0)
            return 0;
        inside = outside;
        step *= 2;
    }
    for (int i = 0; i < 24 && fabs(outside - inside) > 1e-4 * fabs(step); i++) {
        const double middle = 0.5 * (inside + outside);
        *trial = *best;
        const double l = imki_fit_profile(trial, bands, held, ramp ? middle : middle * middle);
        *(best->log_likelihood - l > drop ? &outside : &inside) = middle;
    }
    return 0.5 * (inside + outside);
}

/* Values, sigmas and correlations of the chosen terms. */
static void store_values(const imki_work *w, imk_identification *result)
{
    const imki_fit *fit = w->fit;
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

/* Intervals are those of the model in which white noise, bias instability, random walk and the term
 * itself are all free, whether they were called present or not: leaving a term out would claim to
 * know that it is zero. */
static void store_interval(imki_work *w, imk_identification *result, int term, double drop)
{
    static const bool always[IMK_NOISE_TERMS] = {false, true, true, true, false};
    imki_fit *best = w->trial, *scratch = w->fit;
    imk_estimate *e = &result->term[term];
    *w->chosen = *w->fit;
    *best = *w->chosen;
    for (int j = 0; j < IMKI_FIRST_GAUSS_MARKOV; j++)
        if ((always[j] || j == term) && !best->active[j]) {
            best->active[j] = true;
            best->amount[j] = 1e-6 * w->bands->power[0] / best->shape[j][0];
        }
    best->ramp_active = best->ramp_active || term == IMK_NOISE_RAMP;
    imki_fit_maximise(best, w->bands);

    const int held = term == IMK_NOISE_RAMP ? IMKI_HELD_RAMP : term;
    double centre, step;
    if (held == IMKI_HELD_RAMP) {
        centre = best->ramp;
        step = 1 / sqrt(imki_fit_ramp_information(best, w->bands));
    } else {
        double covariance[IMKI_TEMPLATES_MAX * IMKI_TEMPLATES_MAX];
        imki_fit_covariance(best, w->bands, covariance);
        const double sd = sqrt(covariance[(size_t)term * best->templates + (size_t)term]);
        centre = sqrt(best->amount[term]);
        step = sqrt(best->amount[term] + sd) - centre;
        drop *= small_sample_factor(best->amount[term], sd);
    }
    e->upper = profile_end(best, scratch, w->bands, held, centre, step, drop);
    e->lower = centre == 0 && held != IMKI_HELD_RAMP
                   ? 0
                   : profile_end(best, scratch, w->bands, held, centre, -step, drop);
    if (!e->present && term == IMK_NOISE_RAMP) {
        e->upper = fmax(fabs(e->lower), fabs(e->upper));
        e->lower = 0;
    } else if (!e->present) {
        e->lower = 0;
    }
    *w->fit = *w->chosen;
}

/* End of the interval of a correlation time, in one direction: the factor at which the likelihood,
 * all amounts refitted, has fallen by `drop`; at most a hundred. */
static double time_end(imki_work *w, size_t term, double time, double direction, double drop)
{
    const double needed = w->chosen->log_likelihood - drop;
    double inside = 0, outside = 0.1;
    for (;; inside = outside, outside *= 2) {
        *w->trial = *w->chosen;
        if (imki_gauss_markov_set(w->trial, w->bands, term, time * exp(direction * outside)) <
            needed)
            break;
        if (outside > 4.6)
            return time * exp(direction * outside);
    }
    for (int i = 0; i < 16; i++) {
        const double middle = 0.5 * (inside + outside);
        *w->trial = *w->chosen;
        const double l =
            imki_gauss_markov_set(w->trial, w->bands, term, time * exp(direction * middle));
        *(l < needed ? &outside : &inside) = middle;
    }
    return time * exp(direction * 0.5 * (inside + outside));
}

static void store_gauss_markov(imki_work *w, imk_identification *result, size_t term, double drop)
{
    const size_t slot = IMKI_FIRST_GAUSS_MARKOV + term, t = w->fit->templates;
    if (!w->fit->active[slot] || !(w->fit->amount[slot] > 0))
        return;
    double covariance[IMKI_TEMPLATES_MAX * IMKI_TEMPLATES_MAX];
    imki_fit_covariance(w->fit, w->bands, covariance);
    struct imk_gauss_markov_estimate *g = &result->gauss_markov[result->gauss_markov_count++];
    const double sigma = sqrt(w->fit->amount[slot]), sd = sqrt(covariance[slot * t + slot]);
    *w->chosen = *w->fit;
    g->sigma = (imk_estimate){true, sigma, sd / (2 * sigma), 0, 0};
    const double step = sqrt(w->fit->amount[slot] + sd) - sigma;
    g->sigma.lower = profile_end(w->chosen, w->fit, w->bands, (int)slot, sigma, -step, drop);
    g->sigma.upper = profile_end(w->chosen, w->fit, w->bands, (int)slot, sigma, step, drop);

    const double time = w->correlation_times[term];
    g->correlation_time = (imk_estimate){.present = true, .value = time};
    g->correlation_time.lower = time_end(w, term, time, -1, drop);
    g->correlation_time.upper = time_end(w, term, time, 1, drop);
    g->correlation_time.sigma =
        (g->correlation_time.upper - g->correlation_time.lower) / (2 * sqrt(2 * drop));
    *w->fit = *w->chosen;
}

void imki_identify_intervals(imki_work *w, imk_identification *result)
{
    const double drop = 0.5 * imk_chi_square_quantile(w->settings->confidence, 1);
    store_values(w, result);
    for (int term = 0; term < IMK_NOISE_TERMS; term++)
        store_interval(w, result, term, drop);
    for (size_t term = 0; term < IMKI_GAUSS_MARKOV_MAX; term++)
        store_gauss_markov(w, result, term, drop);
}
