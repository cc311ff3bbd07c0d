/* SPDX-License-Identifier: Apache-2.0 */
/* Does the level move as much as the model says?
 *
 * A high-pass filter, an automatic zero or a subtracted running mean take power from the lowest
 * coefficients of the cosine spectrum. The terms of a model rise toward low frequencies or stay, so
 * no fit follows such a loss. Under the model the sum of v_b P_b/S_b over the bands of the lowest
 * coefficients is chi-square with as many degrees as coefficients; the fit knows the record, so it
 * is nearer to them than that. A ramp in the fit takes one. */
#include "identify_internal.h"
#include "imukit/distributions.h"

#include <math.h>

void imki_identify_level(imki_work *w, imk_identification *result)
{
    enum { FEWEST = 8 };                /* coefficients of the first sum */
    static const double highest = 0.05; /* of the sampling rate: faster noise is not the level's */
    const imki_bands *bands = w->bands;
    const imki_evaluation *e = &w->fit->evaluation;
    double power = w->fit->ramp_active ? 1 : 0, degrees = 0, next = FEWEST;
    size_t sums = 0;
    for (size_t k = 0; k < IMK_LEVEL_SUMS; k++)
        result->level[k] = (imk_level_sum){0, 0, 0};
    if (w->bands_given)
        return; /* of several records, one after the other */
    imki_fit_slope(w->fit, bands, 0, NULL, NULL, NULL); /* evaluates the fit */
    for (size_t b = 0; b < bands->count && bands->frequency[b] * bands->dt < highest; b++) {
        power += bands->degrees[b] * e->power[b] / e->spectrum[b];
        degrees += bands->degrees[b];
        if (degrees < next || sums == IMK_LEVEL_SUMS)
            continue;
        next *= 2;
        result->level[sums++] = (imk_level_sum){degrees, power, 1 / bands->frequency[b]};
    }
}

imk_level_sum imk_level_loss(size_t count, const imk_identification *const *channels)
{
    /* Of one sum. Only the first four can be as low as that and hold as much by chance: a log of
     * six channels has a false alarm with a chance of 1e-4. */
    static const double significance = 4e-6;
    static const double loss = 0.3; /* of the power, that matters */
    imk_level_sum least = {0, 0, 0};
    double lowest = significance;
    for (size_t k = 0; k < IMK_LEVEL_SUMS; k++) {
        imk_level_sum all = {0, 0, 0};
        for (size_t c = 0; c < count; c++) {
            all.degrees += channels[c]->level[k].degrees;
            all.power += channels[c]->level[k].power;
            all.period = channels[c]->level[k].period;
        }
        const double chance = imk_chi_square_probability(all.power, all.degrees);
        if (!(all.degrees > 0) || all.power > (1 - loss) * all.degrees || chance > lowest)
            continue;
        lowest = chance;
        least = all;
    }
    return least;
}
