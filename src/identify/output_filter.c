/* SPDX-License-Identifier: Apache-2.0 */
/* Is the output low-pass filtered within the band, and how?
 *
 * The white template is replaced by white noise through a first- or second-order filter; bandwidth
 * and damping are searched on the likelihood, all amounts refitted at each point. */
#include "identify_internal.h"

#include <math.h>

/* Two parameters must earn ten units of log-likelihood: chance alone does so once in 2e4 records.
 */
static const double GAIN_MIN = 10;
enum { GRID = 14, TURNS = 3, SECTIONS = 12 };

static double likelihood_with(imki_fit *fit, const imki_bands *bands, imk_low_pass filter)
{
    imki_filter_shape(filter, bands, fit->shape[IMK_NOISE_WHITE]);
    return imki_fit_maximise(fit, bands);
}

static double search(imki_fit *fit, const imki_bands *bands, imk_low_pass *filter, double *field,
                     double reach)
{
    const double golden = 0.6180339887498949;
    double low = log(*field) - reach, high = log(*field) + reach, best = -HUGE_VAL;
    double a = high - golden * (high - low), b = low + golden * (high - low);
    *field = exp(a);
    double at_a = likelihood_with(fit, bands, *filter);
    *field = exp(b);
    double at_b = likelihood_with(fit, bands, *filter);
    for (int i = 0; i < SECTIONS; i++) {
        const bool left = at_a > at_b;
        if (left) {
            high = b, b = a, at_b = at_a;
            a = high - golden * (high - low);
        } else {
            low = a, a = b, at_a = at_b;
            b = low + golden * (high - low);
        }
        *field = exp(left ? a : b);
        *(left ? &at_a : &at_b) = likelihood_with(fit, bands, *filter);
    }
    *field = exp(0.5 * (low + high));
    best = likelihood_with(fit, bands, *filter);
    return best;
}

/* First order (damping 0) or second order from a start; the bandwidth by a grid from a hundredth of
 * the sample rate to twice it, then both by turns. */
static double fit_order(imki_fit *fit, const imki_bands *bands, double damping,
                        imk_low_pass *filter)
{
    const double rate = 1 / bands->dt, step = log(200.0) / (GRID - 1);
    double best = -HUGE_VAL, bandwidth = rate;
    for (int i = 0; i < GRID; i++) {
        const imk_low_pass trial = {0.01 * rate * exp(step * i), damping};
        const double l = likelihood_with(fit, bands, trial);
        bandwidth = l > best ? trial.bandwidth : bandwidth;
        best = l > best ? l : best;
    }
    *filter = (imk_low_pass){bandwidth, damping};
    for (int turn = 0; turn < TURNS; turn++) {
        best = search(fit, bands, filter, &filter->bandwidth, turn == 0 ? step : 0.3 * step);
        if (damping > 0)
            best = search(fit, bands, filter, &filter->damping, turn == 0 ? 1.0 : 0.3);
        else
            break;
    }
    filter->damping = damping > 0 ? fmin(fmax(filter->damping, 0.05), 50) : 0;
    return best;
}

imk_low_pass imki_filter_find(imki_fit *fit, const imki_bands *bands)
{
    const imk_low_pass none = {0, 0};
    const double plain = likelihood_with(fit, bands, none);
    /* A mild filter does better wherever a filter is there at all: no search without a slope. */
    const imk_low_pass mild = {2 / bands->dt, 0};
    if (likelihood_with(fit, bands, mild) < plain + 1) {
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
