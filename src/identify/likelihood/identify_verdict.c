/* SPDX-License-Identifier: Apache-2.0 */
/* How far the identified model and the measured Allan deviation agree. */
#include "identify_internal.h"

#include <math.h>

int imk_identification_count(const imk_identification *result, imk_identified_kind kind)
{
    const int count[IMK_IDENTIFIED_KINDS] = {result->gauss_markov_count, result->sinusoid_count,
                                             result->resonance_count, result->rounding > 0};
    return count[kind];
}

double imk_identification_part_allan_variance(const imk_identification *result,
                                              imk_identified_kind kind, int index, double dt,
                                              size_t m)
{
    if (kind == IMK_IDENTIFIED_ROUNDING)
        return imk_white_sampled_allan_variance(result->rounding, dt, m);
    if (kind == IMK_IDENTIFIED_SINUSOID)
        return imk_sinusoid_sampled_allan_variance(result->sinusoid[index], dt, m);
    if (kind == IMK_IDENTIFIED_RESONANCE)
        return imk_resonance_sampled_allan_variance(result->resonance[index], dt, m);
    const imk_gauss_markov g = {result->gauss_markov[index].sigma.value,
                                result->gauss_markov[index].correlation_time.value};
    return imk_gauss_markov_sampled_allan_variance(g, dt, m);
}

double imk_identification_allan_variance(const imk_identification *result, double dt, size_t m,
                                         int term)
{
    const imk_estimate *t = result->term;
    const double part[IMK_NOISE_TERMS] = {
        imk_quantization_sampled_allan_variance(t[IMK_NOISE_QUANTIZATION].value, dt, m),
        result->filter.bandwidth > 0
            ? imk_filtered_white_sampled_allan_variance(t[IMK_NOISE_WHITE].value, result->filter,
                                                        dt, m)
            : imk_white_sampled_allan_variance(t[IMK_NOISE_WHITE].value, dt, m),
        imk_flicker_sampled_allan_variance((imk_flicker){t[IMK_NOISE_BIAS_INSTABILITY].value, 0},
                                           dt, m),
        imk_random_walk_sampled_allan_variance(t[IMK_NOISE_RANDOM_WALK].value, dt, m),
        imk_ramp_allan_variance(t[IMK_NOISE_RAMP].value, (double)m * dt)};
    if (term >= 0 && term < IMK_NOISE_TERMS)
        return part[term];
    double sum = imk_white_sampled_allan_variance(result->rounding, dt, m);
    for (int i = 0; i < IMK_NOISE_TERMS; i++)
        sum += part[i];
    for (int kind = 0; kind < IMK_IDENTIFIED_ROUNDING; kind++)
        for (int i = 0; i < imk_identification_count(result, (imk_identified_kind)kind); i++)
            sum +=
                imk_identification_part_allan_variance(result, (imk_identified_kind)kind, i, dt, m);
    return sum;
}

/* Allan deviations of the samples; 0 when there is no room for them. */
static size_t measure(imki_work *w)
{
    size_t factors[IMKI_POINTS_MAX], count = imk_allan_factors(IMK_ALLAN_DECADE, w->n, NULL);
    if (count > IMKI_POINTS_MAX)
        return 0;
    imk_allan_factors(IMK_ALLAN_DECADE, w->n, factors);
    while (count > 1 && factors[count - 1] > w->n / 9)
        count--;
    const imk_allan_settings settings = imk_allan_default();
    imk_allan_sums(w->n, w->samples, w->cumulative, NULL);
    imk_allan_points(&settings, w->n, w->cumulative, count, factors, w->points, NULL);
    return count;
}

static void compare_with_allan(imki_work *w, imk_identification *result)
{
    const size_t count = w->point_count > 0 ? w->point_count : measure(w);
    const imk_allan_point *points = w->points;
    if (count == 0)
        return;
    double least = points[0].deviation;
    for (size_t i = 0; i < count; i++)
        least = fmin(least, points[i].deviation);
    result->minimum_floor = least / sqrt(imk_flicker_allan_variance(1, 1));
    result->longest = (double)points[count - 1].m * w->settings->dt;
    imki_agreement(w, result, count, points, &result->valid_from, &result->valid_to);

    imk_identification five = *result;
    five.gauss_markov_count = five.sinusoid_count = five.resonance_count = 0;
    five.filter = (imk_low_pass){0, 0};
    five.rounding = 0;
    double five_terms_to;
    imki_agreement(w, &five, count, points, &result->five_terms_from, &five_terms_to);
}

/* Are the steps of the output so large that rounding errors are not white? Then nobody knows how
 * much of the noise is theirs. */
static void assess_steps(const imki_work *w, imk_identification *result)
{
    const imk_allan_point *first = w->points;
    const double step = result->resolution * w->scale;
    const double most = result->filter.bandwidth > 0 ? IMKI_STEP_FILTERED : IMKI_STEP_WHITE;
    if (!w->points || first->m != 1)
        return;
    result->verdict &= ~(unsigned)IMK_VERDICT_COARSE;
    if (step > most * first->deviation)
        result->verdict |= IMK_VERDICT_COARSE;
}

void imki_identify_assess(imki_work *w, imk_identification *result)
{
    compare_with_allan(w, result);
    assess_steps(w, result);
    if (result->sinusoid_count > 0)
        result->verdict |= IMK_VERDICT_LINES;
    if (result->resonance_count > 0)
        result->verdict |= IMK_VERDICT_RESONANCE;
    if (result->filter.bandwidth > 0)
        result->verdict |= IMK_VERDICT_FILTERED;
    if (result->valid_from > 1.5 * w->settings->dt || result->valid_to < 0.99 * result->longest)
        result->verdict |= IMK_VERDICT_MISFIT;
}
