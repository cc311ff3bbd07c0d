/* SPDX-License-Identifier: Apache-2.0 */
/* Is there slow noise that is neither flicker nor random walk?
 *
 * A Gauss-Markov term is added where the likelihood asks for one; its correlation time is searched,
 * its variance is one more amount of the linear fit. Without it, noise that levels off below some
 * frequency would be taken for a random walk, which overstates long averages. */
#include "identify_internal.h"

#include <math.h>

/* Log-likelihood that a term's two parameters must be worth; with a dozen independent correlation
 * times tried, chance alone brings that in about one record in 300. */
static const double GAIN_MIN = 5;
enum { GRID = 24, SECTIONS = 14 };

double imki_gauss_markov_set(imki_fit *fit, const imki_bands *bands, size_t term,
                             double correlation_time)
{
    const size_t slot = IMKI_FIRST_GAUSS_MARKOV + term;
    const imk_gauss_markov unit = {1, correlation_time};
    for (size_t b = 0; b < bands->count; b++)
        fit->shape[slot][b] =
            b < bands->singles
                ? imk_gauss_markov_cosine_spectrum(unit, bands->dt, bands->n, b + 1)
                : imk_gauss_markov_sampled_spectrum(unit, bands->dt, bands->frequency[b]);
    fit->active[slot] = true;
    if (fit->amount[slot] <= 0) {
        /* A third of the power at the corner. */
        size_t b = 0;
        while (b + 1 < bands->count && bands->frequency[b] * correlation_time < 0.16)
            b++;
        fit->amount[slot] = 0.3 * bands->power[b] / fit->shape[slot][b];
    }
    return imki_fit_maximise(fit, bands);
}

typedef struct time_search {
    imki_fit *fit;
    const imki_bands *bands;
    size_t term;
} time_search;

static double height(void *context, double logarithm)
{
    const time_search *s = context;
    return imki_gauss_markov_set(s->fit, s->bands, s->term, exp(logarithm));
}

double imki_gauss_markov_refine(imki_fit *fit, const imki_bands *bands, size_t term, double start,
                                double reach)
{
    time_search search = {fit, bands, term};
    const double best =
        imki_peak(height, &search, log(start / reach), log(start * reach), SECTIONS);
    height(&search, best);
    return exp(best);
}

size_t imki_gauss_markov_find(imki_fit *fit, imki_fit *trial, const imki_bands *bands,
                              double *correlation_times)
{
    const double shortest = 50 * bands->dt, longest = (double)bands->n * bands->dt / 6;
    if (!(longest > shortest))
        return 0;
    const double step = log(longest / shortest) / (GRID - 1);
    for (size_t term = 0; term < IMKI_GAUSS_MARKOV_MAX; term++) {
        double best = fit->log_likelihood, time = 0;
        *trial = *fit;
        for (int i = 0; i < GRID; i++) {
            const double t = shortest * exp(step * i);
            trial->amount[IMKI_FIRST_GAUSS_MARKOV + term] = 0;
            const double l = imki_gauss_markov_set(trial, bands, term, t);
            time = l > best ? t : time;
            best = l > best ? l : best;
        }
        if (time > 0)
            time = imki_gauss_markov_refine(trial, bands, term, time, exp(step));
        if (!(time > 0) || trial->log_likelihood < fit->log_likelihood + GAIN_MIN)
            return term;
        *fit = *trial;
        correlation_times[term] = time;
    }
    return IMKI_GAUSS_MARKOV_MAX;
}
