/* SPDX-License-Identifier: Apache-2.0 */
/* What the estimate of a channel owes to faults that were left in the samples.
 *
 * Clipped noise (clipped_normal.c): fast noise is larger by the ratio of the deviations, what is
 * slow by that of the gain. The normal distribution is an assumption, so a quarter of the
 * correction, and what the deviation of the samples differs from the expected one, are added to the
 * interval.
 *
 * Heavy tails: the spectrum of n independent samples of kurtosis k scatters as that of 2 n/(k - 1)
 * normal ones, and bursts make it worse. The variance within blocks, which is what white noise is,
 * shows both by its scatter between batches. Where this is much wider than the interval, the
 * interval is made as wide, whatever the tails. */
#include "screener_internal.h"

#include "imukit/distributions.h"

#include <math.h>

static void stretch(imk_estimate *e, double factor, double wider)
{
    e->value *= factor;
    e->sigma *= factor;
    e->free_value *= factor;
    e->upper *= factor * (1 + wider);
    e->lower *= factor * fmax(0, 1 - wider);
}

static void undo_clipping(const imk_screen *found, imk_identification *r)
{
    const double ratio = found->clipped_deviation, wider = found->clipped_misfit;
    const double slow = 1 / found->clipped_gain;
    stretch(&r->term[IMK_NOISE_QUANTIZATION], ratio, 0.25 * (ratio - 1) + wider);
    stretch(&r->term[IMK_NOISE_WHITE], ratio, 0.25 * (ratio - 1) + wider);
    for (int term = IMK_NOISE_BIAS_INSTABILITY; term < IMK_NOISE_TERMS; term++)
        stretch(&r->term[term], slow, 0.25 * (slow - 1) + wider);
    for (int i = 0; i < r->gauss_markov_count; i++)
        stretch(&r->gauss_markov[i].sigma, slow, 0.25 * (slow - 1) + wider);
}

/* By chance the scatter of ten batches is half as much again. */
static void widen_white(const imk_screen *found, double confidence, imk_identification *r)
{
    imk_estimate *white = &r->term[IMK_NOISE_WHITE];
    const double z = -imk_normal_quantile(0.5 * (1 - confidence));
    const double half = 0.5 * found->noise_scatter * z * white->value;
    if (!found->heavy_tails && half < 0.75 * (white->upper - white->lower))
        return;
    white->lower = fmin(white->lower, fmax(0, white->value - half));
    white->upper = fmax(white->upper, white->value + half);
    white->sigma = fmax(white->sigma, half / z);
}

/* Does the correction for clipping move white noise out of its interval? */
static bool clipping_matters(const imk_screen *found, const imk_identification *r)
{
    const imk_estimate *white = &r->term[IMK_NOISE_WHITE];
    return white->value * found->clipped_deviation > white->upper;
}

void imk_screen_adjust(const imk_screen *found, unsigned what, double confidence,
                       imk_identification *result)
{
    const bool clipped = found->clipped_deviation > 1 && found->saturated.count > 0;
    result->verdict &= ~(unsigned)IMK_VERDICT_SATURATED;
    if (clipped && (clipping_matters(found, result) || found->clipped_misfit > 0.05))
        result->verdict |= IMK_VERDICT_SATURATED;
    if (clipped && (what & IMK_SCREEN_SATURATED))
        undo_clipping(found, result);
    if (result->term[IMK_NOISE_WHITE].present)
        widen_white(found, confidence, result);
}
