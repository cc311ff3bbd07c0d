/* SPDX-License-Identifier: Apache-2.0 */
/* Do several records have the same noise? The likelihood of each record alone, the joint model's
 * terms with strengths of its own, against that of the joint strengths:
 *
 *     2 sum_r [ l_r(own) - l_r(joint) ] ~ chi-square, strengths x (records - 1) degrees
 *
 * and, term by term, the difference of a record's strength from the joint one. The joint estimate
 * holds the record's own, so that the variance of the difference is that of the one less that of
 * the other. */
#include "imukit/distributions.h"
#include "joint_internal.h"

#include <math.h>
#include <string.h>

/* The joint model on the bands of one record, with the joint strengths. */
static void begin(const imki_work *w, const imk_identification *joint, const imki_bands *bands,
                  imki_fit *fit)
{
    const imki_fit *from = w->fit;
    memset(fit, 0, sizeof *fit);
    fit->templates = from->templates;
    imki_templates_set(fit, bands);
    if (joint->filter.bandwidth > 0)
        imki_filter_shape(joint->filter, bands, fit->shape[IMK_NOISE_WHITE]);
    for (int r = 0; r < joint->resonance_count; r++)
        imki_resonance_shape(joint->resonance[r].frequency, joint->resonance[r].q, bands,
                             fit->shape[IMKI_FIRST_RESONANCE + r]);
    for (size_t i = 0; i < IMKI_GAUSS_MARKOV_MAX; i++)
        if (from->active[IMKI_FIRST_GAUSS_MARKOV + i])
            imki_gauss_markov_shape(fit, bands, from->correlation_time[i],
                                    fit->shape[IMKI_FIRST_GAUSS_MARKOV + i]);
    memcpy(fit->active, from->active, sizeof fit->active);
    memcpy(fit->amount, from->amount, sizeof fit->amount);
    memcpy(fit->correlation_time, from->correlation_time, sizeof fit->correlation_time);
}

static double likelihood(const imki_fit *fit, const imki_bands *bands)
{
    double sum = 0;
    for (size_t b = 0; b < bands->count; b++) {
        const double s = imki_fit_spectrum(fit, b);
        sum += bands->degrees[b] * imki_deviance(bands->power[b], s);
    }
    return -0.5 * sum;
}

/* Strengths of a record beside the joint ones, whose variances are given. */
static void compare(const imki_work *w, imki_fit *own, const imki_bands *bands, size_t record,
                    const double *joint_covariance, imk_joint_agreement *a)
{
    double covariance[IMKI_TEMPLATES_MAX * IMKI_TEMPLATES_MAX];
    const size_t t = own->templates;
    imki_fit_covariance(own, bands, covariance);
    for (size_t term = 0; term < IMK_NOISE_RAMP; term++) {
        if (!own->active[term])
            continue;
        const double variance = covariance[term * t + term];
        const double value = sqrt(own->amount[term]);
        a->value[record][term] = value / w->scale;
        a->sigma[record][term] =
            (value > 0 ? sqrt(variance) / (2 * value) : sqrt(sqrt(variance))) / w->scale;
        /* Assessed at the joint strength: a record's own small strength would claim to be well
         * known.
         */
        const double ratio = own->amount[term] > 0 ? w->fit->amount[term] / own->amount[term] : 1;
        const double spread = variance * fmax(1, ratio * ratio) - joint_covariance[term * t + term];
        const double sigmas = fabs(own->amount[term] - w->fit->amount[term]) / sqrt(spread);
        if (spread > 0 && sigmas > a->sigmas) {
            a->sigmas = sigmas;
            a->record = (int)record;
            a->term = (int)term;
        }
    }
}

void imki_joint_agreement(imki_work *w, const imk_identification *joint, size_t count,
                          const imk_spectral_summary *const *summaries, imki_bands *bands,
                          imk_joint_agreement *a)
{
    double covariance[IMKI_TEMPLATES_MAX * IMKI_TEMPLATES_MAX];
    imki_fit_covariance(w->fit, w->bands, covariance);
    imki_fit *own = w->trial;
    for (size_t r = 0; r < count; r++) {
        const double factor = w->scale / summaries[r]->scale;
        *bands = summaries[r]->bands;
        bands->n = w->bands->n;
        for (size_t b = 0; b < bands->count; b++)
            bands->power[b] *= factor * factor;
        begin(w, joint, bands, own);
        const double common = likelihood(own, bands);
        imki_fit_maximise(own, bands);
        a->chi_square += 2 * fmax(0, likelihood(own, bands) - common);
        compare(w, own, bands, r, covariance, a);
    }
    size_t strengths = 0;
    for (size_t j = 0; j < w->fit->templates; j++)
        strengths += w->fit->active[j];
    a->degrees = strengths * (count - 1);
    a->probability =
        a->degrees > 0 ? imk_gamma_upper(0.5 * (double)a->degrees, 0.5 * a->chi_square) : 1;
}
