/* SPDX-License-Identifier: Apache-2.0 */
/* Which terms the record holds, and how much of each: the fast end of the spectrum first
 * (quantization, output filter, resonances), then the set of terms (term_search.c). */
#include "identify_internal.h"

#include <math.h>
#include <string.h>

/* Wide resonances, and narrow ones that were not left out of the bands. */
static bool takes_part(const imki_bands *bands, const imk_resonance *r)
{
    for (size_t b = 0; b < bands->count; b++)
        if (fabs(bands->frequency[b] - r->frequency) < r->frequency / r->q)
            return true;
    return r->q <= IMKI_NARROW;
}

static void set_templates(imki_work *w, const imk_identification *result)
{
    imki_fit *fit = w->fit;
    const imki_bands *bands = w->bands;
    memset(fit, 0, sizeof *fit);
    fit->templates = IMKI_FIRST_RESONANCE + (size_t)result->resonance_count;
    imki_templates_set(fit, bands);
    for (int r = 0; r < result->resonance_count; r++)
        imki_resonance_shape(result->resonance[r].frequency, result->resonance[r].q, bands,
                             fit->shape[IMKI_FIRST_RESONANCE + r]);
    for (size_t j = IMK_NOISE_WHITE; j < fit->templates; j++)
        fit->active[j] = j <= IMK_NOISE_RANDOM_WALK ||
                         (j >= IMKI_FIRST_RESONANCE &&
                          takes_part(bands, &result->resonance[j - IMKI_FIRST_RESONANCE]));
    for (int r = 0; r < result->resonance_count; r++)
        fit->amount[IMKI_FIRST_RESONANCE + r] =
            result->resonance[r].sigma * result->resonance[r].sigma;
    /* Start: white from the middle of the spectrum, half the lowest power to each slow term. */
    fit->amount[IMK_NOISE_WHITE] = bands->power[bands->count * 3 / 4];
    const double low = (bands->power[0] + bands->power[1] + bands->power[2] + bands->power[3]) / 8;
    fit->amount[IMK_NOISE_BIAS_INSTABILITY] = low / fit->shape[IMK_NOISE_BIAS_INSTABILITY][3];
    fit->amount[IMK_NOISE_RANDOM_WALK] = low / fit->shape[IMK_NOISE_RANDOM_WALK][1];
}

/* Quantization into the fit, or out of it, where that is worth `needed`. */
static void try_quantization(imki_work *w, double needed)
{
    imki_fit *fit = w->fit;
    const imki_amounts before = imki_fit_keep(fit);
    const bool on = !fit->active[IMK_NOISE_QUANTIZATION];
    fit->active[IMK_NOISE_QUANTIZATION] = on;
    fit->amount[IMK_NOISE_QUANTIZATION] =
        on ? 0.1 * fit->amount[IMK_NOISE_WHITE] * w->bands->dt * w->bands->dt : 0;
    const double gain = imki_fit_maximise(fit, w->bands) - before.log_likelihood;
    if (!(gain > (on ? needed : -needed)))
        imki_fit_restore(fit, w->bands, &before);
}

/* Output filter and quantization shape the same end of the spectrum: quantization is asked for with
 * the filter that fits best without it, and may then replace the filter. */
static void fit_fast_end(imki_work *w, imk_identification *result, double needed)
{
    imki_fit_maximise(w->fit, w->bands);
    try_quantization(w, needed);
    if (w->settings->shape) {
        result->filter = imki_filter_find(w->fit, w->bands);
        w->resonant_lines = result->resonance_count;
        imki_fast_shape_refine(w, result);
    }
    const bool shaped = result->filter.bandwidth > 0 || result->resonance_count > 0;
    if (shaped && w->fit->active[IMK_NOISE_QUANTIZATION])
        try_quantization(w, needed);
}

static bool is_deep(imk_low_pass filter, const imki_bands *bands)
{
    return filter.bandwidth * bands->dt < 0.1;
}

static bool has_gauss_markov(const imki_fit *fit)
{
    for (size_t i = IMKI_FIRST_GAUSS_MARKOV; i < IMKI_FIRST_RESONANCE; i++)
        if (fit->active[i] && fit->amount[i] > 0)
            return true;
    return false;
}

/* A low-pass far inside the band looks like a Gauss-Markov term above white noise, and the other
 * way round; a filter and a Gauss-Markov term can stand for one of a few samples. Both are tried to
 * the end. The filter costs what it had to earn. */
static double choose_without_filter(imki_work *w, const imki_penalties *penalties)
{
    imki_fit *fit = w->fit;
    imki_fit_set_filter(fit, (imk_low_pass){0, 0}, w->bands);
    fit->active[IMK_NOISE_BIAS_INSTABILITY] = fit->active[IMK_NOISE_RANDOM_WALK] = true;
    fit->amount[IMK_NOISE_WHITE] = w->bands->power[w->bands->count * 3 / 4];
    imki_gauss_markov_add(fit, w->bands, 0);
    imki_gauss_markov_settle(fit, w->bands, IMKI_HELD_NONE, IMKI_HELD_NONE);
    try_quantization(w, penalties->term);
    return imki_terms_choose(fit, w->bands, penalties, w->alternatives);
}

static void choose_terms(imki_work *w, imk_identification *result)
{
    /* What imki_filter_find() asks for its two parameters, or three. */
    const double filter_penalty = result->filter.damping > 0 ? 13 : 10;
    const imki_penalties penalties = imki_penalties_of(w->bands, w->settings->significance);
    const bool filtered = result->filter.bandwidth > 0;
    if (filtered)
        imki_fit_copy(w->trial, w->fit, w->bands);
    const double score =
        imki_terms_choose(w->fit, w->bands, &penalties, w->alternatives) - filter_penalty;
    if (!filtered || !(is_deep(result->filter, w->bands) || has_gauss_markov(w->fit)))
        return;
    imki_fit *chosen = w->fit;
    imki_alternatives *met = w->alternatives;
    w->fit = w->trial;
    w->trial = chosen;
    w->alternatives = w->spare;
    w->spare = met;
    if (choose_without_filter(w, &penalties) > score) {
        result->filter = (imk_low_pass){0, 0};
    } else {
        w->trial = w->fit;
        w->fit = chosen;
        w->spare = w->alternatives;
        w->alternatives = met;
    }
}

void imki_identify_terms(imki_work *w, imk_identification *result)
{
    imki_identify_bands(w, result);
    set_templates(w, result);
    fit_fast_end(w, result, imki_penalties_of(w->bands, w->settings->significance).term);
    choose_terms(w, result);
    result->rounding = sqrt(w->fit->floor);
}
