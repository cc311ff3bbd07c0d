/* SPDX-License-Identifier: Apache-2.0 */
/* Does a measured Allan deviation agree with the model that was fitted to the same record?
 *
 * Under the model the measured variance v is a quadratic form of Gaussian samples, with expectation
 * E and a variance that the model states too (allan_covariance.c), of e = 2 E^2/var degrees of
 * freedom. Lower quantiles of v/E are those of chi-square with e degrees, below which a form of
 * unequal weights seldom falls. Its upper tail is longer: by its third moment it is [HALL1983]
 *
 *     1 + sqrt(2/e) (chi^2_d - d)/sqrt(2 d),   d = e/s^2
 *
 * with s the skewness over that of chi-square with e degrees. OADEV has s = 1.3 for white noise and
 * 1.15 for flicker noise and random walk; a resonance has 1.5, which is used for all.
 *
 * A disagreement is one that matters, 5 % of the deviation, and that a right model has at none of
 * the averaging times of one record in ten thousand. The fit knows the record, so it is nearer to
 * it than the truth is: the rate is an upper bound. */
#include "identify/allan/allan_fit_internal.h"
#include "identify_internal.h"
#include "imukit/distributions.h"

#include <math.h>

static const double MATTERS = 0.05, FALSE_ALARMS = 1e-4, SKEWNESS = 1.5;

static imk_allan_noise noise_of(const imk_identification *result)
{
    imk_allan_noise noise = {.filter = result->filter,
                             .gauss_markov_count = result->gauss_markov_count,
                             .sinusoid_count = result->sinusoid_count,
                             .resonance_count = result->resonance_count};
    for (int i = 0; i < IMK_NOISE_TERMS; i++)
        noise.term[i] = result->term[i].value;
    for (int i = 0; i < result->gauss_markov_count; i++)
        noise.gauss_markov[i] = (imk_gauss_markov){result->gauss_markov[i].sigma.value,
                                                   result->gauss_markov[i].correlation_time.value};
    for (int i = 0; i < result->sinusoid_count; i++)
        noise.sinusoid[i] = result->sinusoid[i];
    for (int i = 0; i < result->resonance_count; i++)
        noise.resonance[i] = result->resonance[i];
    return noise;
}

bool imki_allan_is_likely(double ratio, double edf, double tail)
{
    if (ratio < 1)
        return ratio >= imk_chi_square_quantile(tail, edf) / edf;
    const double degrees = edf / (SKEWNESS * SKEWNESS);
    const double above = imk_chi_square_quantile(1 - tail, degrees) - degrees;
    return ratio <= 1 + sqrt(2 / edf) * above / sqrt(2 * degrees);
}

/* Rounding after a filter has independent errors, and adds to the expectation only: with them the
 * variance scatters a little less than it may here. */
static bool agrees(const imki_work *w, const imk_allan_noise *noise, double rounding, size_t count,
                   const imk_allan_point *point)
{
    const double dt = w->settings->dt, expected = imk_allan_noise_variance(noise, dt, point->m);
    const double ratio = point->deviation * point->deviation /
                         (expected + imk_white_sampled_allan_variance(rounding, dt, point->m));
    if (fabs(sqrt(ratio) - 1) < MATTERS)
        return true;
    const size_t stride = w->block > 0 && point->m >= w->block_from ? w->block : 1;
    const double edf =
        2 * expected * expected / imki_allan_variance_of_one(noise, dt, w->n, point->m, stride);
    return edf > 0 && imki_allan_is_likely(ratio, edf, 0.5 * FALSE_ALARMS / (double)count);
}

void imki_agreement(const imki_work *w, const imk_identification *result, size_t count,
                    const imk_allan_point *points, double *from, double *to)
{
    const imk_allan_noise noise = noise_of(result);
    size_t first = 0, length = 0, run = 0;
    for (size_t i = 0; i < count; i++) {
        run = agrees(w, &noise, result->rounding, count, &points[i]) ? run + 1 : 0;
        if (run > length) {
            length = run;
            first = i + 1 - run;
        }
    }
    *from = length > 0 ? (double)points[first].m * w->settings->dt : HUGE_VAL;
    *to = length > 0 ? (double)points[first + length - 1].m * w->settings->dt : 0;
}
