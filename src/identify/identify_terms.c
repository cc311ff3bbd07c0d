/* SPDX-License-Identifier: Apache-2.0 */
/* Which terms the record holds, and how much of each. */
#include "identify_internal.h"
#include "imukit/distributions.h"

#include <math.h>
#include <string.h>

static void set_templates(imki_work *w, const imk_identification *result)
{
    imki_fit *fit = w->fit;
    const imki_bands *bands = w->bands;
    memset(fit, 0, sizeof *fit);
    fit->templates = IMKI_FIRST_RESONANCE + (size_t)result->resonance_count;
    for (size_t b = 0; b < bands->count; b++) {
        const double f = bands->frequency[b], dt = bands->dt;
        fit->shape[IMK_NOISE_QUANTIZATION][b] = imk_quantization_sampled_spectrum(1, dt, f);
        fit->shape[IMK_NOISE_WHITE][b] = imk_white_sampled_spectrum(1, dt, f);
        fit->shape[IMK_NOISE_BIAS_INSTABILITY][b] =
            b < bands->singles ? imk_flicker_cosine_spectrum(1, dt, bands->n, b + 1)
                               : imk_flicker_sampled_spectrum(1, dt, f);
        fit->shape[IMK_NOISE_RANDOM_WALK][b] = imk_random_walk_sampled_spectrum(1, dt, f);
    }
    for (int r = 0; r < result->resonance_count; r++)
        imki_resonance_shape(result->resonance[r].frequency, result->resonance[r].q, bands,
                             fit->shape[IMKI_FIRST_RESONANCE + r]);
    for (size_t j = IMK_NOISE_WHITE; j < fit->templates; j++)
        fit->active[j] = j <= IMK_NOISE_RANDOM_WALK ||
                         (j >= IMKI_FIRST_RESONANCE &&
                          result->resonance[j - IMKI_FIRST_RESONANCE].q <= IMKI_NARROW);
    for (int r = 0; r < result->resonance_count; r++)
        fit->amount[IMKI_FIRST_RESONANCE + r] =
            result->resonance[r].sigma * result->resonance[r].sigma;
    /* Start: white from the middle of the spectrum, half the lowest power to each slow term. */
    fit->amount[IMK_NOISE_WHITE] = bands->power[bands->count * 3 / 4];
    const double low = (bands->power[0] + bands->power[1] + bands->power[2] + bands->power[3]) / 8;
    fit->amount[IMK_NOISE_BIAS_INSTABILITY] = low / fit->shape[IMK_NOISE_BIAS_INSTABILITY][3];
    fit->amount[IMK_NOISE_RANDOM_WALK] = low / fit->shape[IMK_NOISE_RANDOM_WALK][1];
}

static double gain_without(imki_work *w, int term)
{
    *w->trial = *w->fit;
    w->trial->active[term] = false;
    w->trial->amount[term] = 0;
    return w->fit->log_likelihood - imki_fit_maximise(w->trial, w->bands);
}

static double gain_with_quantization(imki_work *w)
{
    *w->trial = *w->fit;
    w->trial->active[IMK_NOISE_QUANTIZATION] = true;
    w->trial->amount[IMK_NOISE_QUANTIZATION] =
        0.1 * w->fit->amount[IMK_NOISE_WHITE] * w->bands->dt * w->bands->dt;
    return imki_fit_maximise(w->trial, w->bands) - w->fit->log_likelihood;
}

static double gain_with_ramp(imki_work *w)
{
    *w->trial = *w->fit;
    w->trial->ramp_active = true;
    return imki_fit_maximise(w->trial, w->bands) - w->fit->log_likelihood;
}

/* Frequency and quality of the wide resonances again, now that the rest of the spectrum is known: a
 * filter's slope across a wide resonance shifts it. */
static void refine_resonances(imki_work *w, imk_identification *result)
{
    for (int r = 0; r < result->resonance_count; r++)
        if (result->resonance[r].q <= IMKI_NARROW)
            imki_resonance_refine(w->fit, w->bands, (size_t)r, &result->resonance[r]);
}

/* Output filter and quantization shape the same end of the spectrum: quantization is asked for with
 * the filter that fits best without it, and may then replace the filter. */
static void fit_fast_end(imki_work *w, imk_identification *result, double needed)
{
    imki_fit_maximise(w->fit, w->bands);
    if (gain_with_quantization(w) > needed) {
        *w->fit = *w->trial;
        w->fit->active[IMK_NOISE_QUANTIZATION] = true;
    }
    if (w->settings->shape) {
        result->filter = imki_filter_find(w->fit, w->bands);
        refine_resonances(w, result);
        if (result->resonance_count > 0 && result->filter.bandwidth > 0)
            result->filter = imki_filter_find(w->fit, w->bands);
    }
    if (result->filter.bandwidth > 0 && w->fit->active[IMK_NOISE_QUANTIZATION] &&
        gain_without(w, IMK_NOISE_QUANTIZATION) < needed)
        *w->fit = *w->trial;
}

/* Backward elimination of the random terms, each by its likelihood ratio; the threshold is that of
 * a parameter on its boundary, where the ratio is half a chi-square [SELF1987]. */
static void choose_terms(imki_work *w, double needed)
{
    for (;;) {
        int weakest = -1;
        double least = needed;
        for (int term = IMK_NOISE_QUANTIZATION; term <= IMK_NOISE_RANDOM_WALK; term++)
            if (w->fit->active[term]) {
                const double gain = gain_without(w, term);
                weakest = gain < least ? term : weakest;
                least = gain < least ? gain : least;
            }
        if (weakest < 0)
            break;
        gain_without(w, weakest);
        *w->fit = *w->trial;
    }
    for (size_t term = 0; term < IMKI_GAUSS_MARKOV_MAX; term++)
        if (w->fit->active[IMKI_FIRST_GAUSS_MARKOV + term])
            w->correlation_times[term] =
                imki_gauss_markov_refine(w->fit, w->bands, term, w->correlation_times[term], 1.5);
}

/* Gain in log-likelihood that a ramp must bring. Its estimate is judged against slow noise that is
 * itself known from a few coefficients, so that the ratio follows Student's t with v degrees, where
 * v = 2 S^2/var S for the fitted spectrum at the lowest frequency. With Wallace's normal
 * approximation of t [WALLACE1959], z ~ (8v + 1)/(8v + 3) sqrt(v log(1 + t^2/v)):
 *
 *     2 gain = (v + 1) log(1 + t^2/v) ~ (v + 1)/v [(8v + 3)/(8v + 1)]^2 z^2 */
static double needed_for_ramp(const imki_work *w, double significance)
{
    const imki_fit *fit = w->fit;
    const size_t t = fit->templates;
    double covariance[IMKI_TEMPLATES_MAX * IMKI_TEMPLATES_MAX], variance = 0;
    imki_fit_covariance(fit, w->bands, covariance);
    for (size_t i = 0; i < t; i++)
        for (size_t j = 0; j < t; j++)
            variance += covariance[i * t + j] * fit->shape[i][0] * fit->shape[j][0];
    const double spectrum = imki_fit_spectrum(fit, 0);
    const double v = fmax(1, 2 * spectrum * spectrum / variance);
    const double z = imk_normal_quantile(1 - 0.5 * significance);
    const double ratio = (8 * v + 3) / (8 * v + 1);
    return 0.5 * (v + 1) / v * ratio * ratio * z * z;
}

void imki_identify_terms(imki_work *w, imk_identification *result)
{
    const double significance = w->settings->significance;
    imki_bands_build(w->bands, w->n, w->settings->dt, w->coefficients, w->cumulative, w->line_count,
                     w->lines, (size_t)result->resonance_count, result->resonance);
    set_templates(w, result);
    const double needed = 0.5 * imk_chi_square_quantile(1 - 2 * significance, 1);
    fit_fast_end(w, result, needed);
    imki_gauss_markov_find(w->fit, w->trial, w->bands, w->correlation_times);
    choose_terms(w, needed);
    /* In one record a ramp and a random walk look much alike, and a ramp that is not there takes
     * the walk's place: it must be ten times less likely by chance than the other terms. */
    if (gain_with_ramp(w) > needed_for_ramp(w, 0.1 * significance)) {
        *w->fit = *w->trial;
        choose_terms(w, needed);
    }
}
