/* SPDX-License-Identifier: Apache-2.0 */
/* Is the output low-pass filtered within the band, and how?
 *
 * The white template is replaced by white noise through a first- or second-order filter; bandwidth
 * and damping are searched on the likelihood, all amounts refitted at each point. */
#include "identify_internal.h"

#include "imukit/elementary.h"

#include <math.h>

/* Two parameters must earn ten units of log-likelihood: chance alone does so once in 2e4 records.
 */
static const double GAIN_MIN = 10;
enum { GRID = 14, TURNS = 3, SECTIONS = 12 };

void imki_fit_set_filter(imki_fit *fit, imk_low_pass filter, const imki_bands *bands)
{
    imki_filter_shape(filter, bands, fit->shape[IMK_NOISE_WHITE]);
    fit->floor = filter.bandwidth > 0 ? bands->rounding : 0;
}

static double likelihood_with(imki_fit *fit, const imki_bands *bands, imk_low_pass filter)
{
    imki_fit_set_filter(fit, filter, bands);
    return imki_fit_maximise(fit, bands);
}

typedef struct filter_search {
    imki_fit *fit;
    const imki_bands *bands;
    imk_low_pass *filter;
    double *field; /* of the filter: the one searched, by its logarithm */
} filter_search;

static double height(void *context, double logarithm)
{
    filter_search *s = context;
    *s->field = imk_exp(logarithm);
    return likelihood_with(s->fit, s->bands, *s->filter);
}

static double search(filter_search *s, double *field, double low, double high, double reach)
{
    s->field = field;
    low = fmax(imk_ln(*field) - reach, imk_ln(low));
    high = fmin(imk_ln(*field) + reach, imk_ln(high));
    return height(s, imki_peak(height, s, low, high, SECTIONS));
}

/* First order (damping 0) or second order from a start; the bandwidth by a grid from a hundredth of
 * the sample rate to twice it, then both by turns. */
static double fit_order(imki_fit *fit, const imki_bands *bands, double damping,
                        imk_low_pass *filter)
{
    const double rate = 1 / bands->dt, step = imk_ln(200.0) / (GRID - 1);
    double best = -HUGE_VAL, bandwidth = rate;
    for (int i = 0; i < GRID; i++) {
        const imk_low_pass trial = {0.01 * rate * imk_exp(step * i), damping};
        const double l = likelihood_with(fit, bands, trial);
        bandwidth = l > best ? trial.bandwidth : bandwidth;
        best = l > best ? l : best;
    }
    *filter = (imk_low_pass){bandwidth, damping};
    filter_search s = {fit, bands, filter, NULL};
    for (int turn = 0; turn < (damping > 0 ? TURNS : 1); turn++) {
        const double reach = turn == 0 ? 1 : 0.3;
        best = search(&s, &filter->bandwidth, 1e-3 * rate, 10 * rate, reach * step);
        if (damping > 0) /* from the limit of imk_low_pass */
            best = search(&s, &filter->damping, 0.05, IMKI_OVERDAMPED, reach);
    }
    return best;
}

imk_low_pass imki_filter_find(imki_fit *fit, const imki_bands *bands)
{
    const imk_low_pass none = {0, 0};
    const double plain = likelihood_with(fit, bands, none);
    /* No search without a sign of a filter: a mild one, a middling or a strong one that does
     * better. (Where a strong filter is, a mild one may not help: the plain fit explains the record
     * by slow noise alone.) */
    bool sign = false;
    for (double bandwidth = 2; bandwidth > 0.01 && !sign; bandwidth *= 0.15)
        sign = likelihood_with(fit, bands, (imk_low_pass){bandwidth / bands->dt, 0}) > plain + 1;
    /* A second order far inside the band leaves a fourth power of the frequency, which is no sign
     * of a first order. */
    for (double bandwidth = 0.1; bandwidth > 0.01 && !sign; bandwidth *= 0.5)
        sign = likelihood_with(fit, bands, (imk_low_pass){bandwidth / bands->dt, 0.7}) > plain + 1;
    if (!sign) {
        likelihood_with(fit, bands, none);
        return none;
    }
    imk_low_pass first, second;
    const double one = fit_order(fit, bands, 0, &first);
    const double two = fit_order(fit, bands, 0.7, &second);
    imk_low_pass best = two > one + 3 ? second : first;
    if ((two > one + 3 ? two : one) < plain + GAIN_MIN)
        best = none;
    likelihood_with(fit, bands, best);
    return best;
}
