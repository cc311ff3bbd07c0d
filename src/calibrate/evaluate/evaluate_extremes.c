/* SPDX-License-Identifier: Apache-2.0 */
/* Figures that are the largest of something, T = F(d): of the errors, of the deviations from a line
 * fitted to them, of the differences between up and down. F is convex and homogeneous: the largest
 * of many linear functions of d. With d = truth + e,
 *
 *     T >= truth + c0.e        of the function c0 that is the largest of the truth, so that the
 *                              quantile of one function's noise bounds the truth from above, and
 *     T <= truth + max c.e     over the functions that come near the largest, which bounds it from
 *                              below. Those within 2.5 sigmas of it are taken to share its place
 *                              [ANDREWS2010].
 *
 * Where one level stands out both are Student's interval; where several share the largest value the
 * interval is wider than it need be, since the table cannot tell which of them is the largest. The
 * noise is drawn: f s z with z normal and f^2 = freedom/chi-square. */
#include "base/sort_internal.h"
#include "evaluate_internal.h"

#include "base/sort_internal.h"
#include "imukit/distributions.h"
#include "imukit/elementary.h"

/* Levels nearer to the largest than so many sigmas may share its place. */
static const double near_sigmas = 2.5;
static const double root_two_pi = 2.50662827463100050242;

/* A figure as a function of the levels' values. Into e->shifted goes, where `gradient` is set, the
 * linear function that is the largest. */
typedef double (*largest_of)(imki_evaluation *e, const double *value, bool gradient);

static size_t place_of_largest(const imki_evaluation *e, const double *value)
{
    size_t largest = 0;
    for (size_t k = 1; k < e->levels; k++)
        if (fabs(value[k]) > fabs(value[largest]))
            largest = k;
    return largest;
}

static double largest_value(imki_evaluation *e, const double *value, bool gradient)
{
    double largest = 0.0;
    for (size_t k = 0; k < e->levels; k++) {
        const double amount = fabs(value[k]);
        largest = amount > largest ? amount : largest;
    }
    if (gradient) {
        for (size_t k = 0; k < e->levels; k++)
            e->shifted[k] = 0.0;
        e->shifted[place_of_largest(e, value)] = 1.0;
    }
    return largest;
}

/* From the line of weighted least squares; e->weight, moment and centred prepare it. */
static double largest_residual(imki_evaluation *e, const double *value, bool gradient)
{
    double mean = 0.0, slope = 0.0, largest = 0.0;
    for (size_t k = 0; k < e->levels; k++) {
        mean += e->weight[k] * value[k];
        slope += e->moment[k] * value[k];
    }
    for (size_t k = 0; k < e->levels; k++) {
        const double residual = fabs(value[k] - mean - slope * e->centred[k]);
        largest = residual > largest ? residual : largest;
    }
    if (gradient) {
        /* The pattern is one of residuals: its line is 0. */
        const size_t at = place_of_largest(e, value);
        for (size_t k = 0; k < e->levels; k++)
            e->shifted[k] = (k == at ? 1.0 : 0.0) - e->weight[k] - e->moment[k] * e->centred[at];
    }
    return largest;
}

/* At the alternation a, b, c the deviation is half of the distance of b from the chord. */
static double largest_minimax(imki_evaluation *e, const double *value, bool gradient)
{
    int at[3];
    const double *x = e->reference;
    const double deviation = imk_minimax_line(e->levels, x, value, at, e->hull).deviation;
    for (size_t k = 0; gradient && k < e->levels; k++)
        e->shifted[k] = 0.0;
    if (gradient && at[0] >= 0) {
        const double share = (x[at[2]] - x[at[1]]) / (x[at[2]] - x[at[0]]);
        e->shifted[at[0]] = 0.5 * share;
        e->shifted[at[1]] = 0.5;
        e->shifted[at[2]] = 0.5 * (1.0 - share);
    }
    return deviation;
}

static void prepare_residuals(imki_evaluation *e)
{
    double middle = 0.0, squares = 0.0;
    for (size_t k = 0; k < e->levels; k++) {
        const imki_cell *cell = &e->cell[k * IMKI_CELLS];
        e->weight[k] = (double)(cell[0].count + cell[1].count + cell[2].count) / (double)e->rows;
        middle += e->weight[k] * e->reference[k];
    }
    for (size_t k = 0; k < e->levels; k++) {
        e->centred[k] = e->reference[k] - middle;
        squares += e->weight[k] * e->centred[k] * e->centred[k];
    }
    for (size_t k = 0; k < e->levels; k++)
        e->moment[k] = e->weight[k] * e->centred[k] / squares;
}

/* ---- interval -------------------------------------------------------------------------------- */

/* What noise adds to the figure of e->shifted, in every draw. */
static void draw_noise(imki_evaluation *e, largest_of largest, double *added)
{
    const double own = largest(e, e->shifted, false);
    for (size_t b = 0; b < e->draws; b++) {
        const double *z = e->draw + b * e->levels;
        for (size_t k = 0; k < e->levels; k++)
            e->trial[k] = e->shifted[k] + e->factor[b] * e->noise[k] * z[k];
        added[b] = largest(e, e->trial, false) - own;
    }
}

static double quantile(imki_evaluation *e, const double *value, double probability)
{
    for (size_t b = 0; b < e->draws; b++)
        e->sorted[b] = value[b];
    imki_sort(e->sorted, e->draws);
    return e->sorted[(size_t)(probability * (double)(e->draws - 1) + 0.5)];
}

/* Half width of the interval of the largest function by itself. */
static double half_width_alone(imki_evaluation *e, largest_of largest)
{
    double variance = 0.0;
    (void)largest(e, e->pattern, true);
    for (size_t k = 0; k < e->levels; k++)
        variance += e->shifted[k] * e->shifted[k] * e->noise[k] * e->noise[k];
    return e->student * sqrt(variance);
}

/* What noise adds where there is nothing else, and to all that may share the largest's place. */
static void draw_figures(imki_evaluation *e, largest_of largest, double value)
{
    for (size_t k = 0; k < e->levels; k++)
        e->shifted[k] = 0.0;
    draw_noise(e, largest, e->none);
    for (size_t k = 0; k < e->levels; k++) {
        const double raised = fmin(value, fabs(e->pattern[k]) + near_sigmas * e->noise[k]);
        e->shifted[k] = copysign(fmax(raised, fabs(e->pattern[k])), e->pattern[k]);
    }
    draw_noise(e, largest, e->near);
}

/* Pattern and noise are set. Levels may agree by chance better than their noise lets one expect,
 * which says nothing of the figure: for the upper limit it is raised to what noise alone exceeds
 * with the confidence. A figure that noise alone may show has the lower limit 0. */
static imk_evaluation_figure interval(imki_evaluation *e, largest_of largest)
{
    const double value = largest(e, e->pattern, false), confidence = e->settings->confidence;
    const double tail = 0.5 - 0.5 * confidence;
    if (e->result->source == IMK_SCATTER_RESIDUALS || e->result->source == IMK_SCATTER_NONE)
        return (imk_evaluation_figure){value, (double)NAN, (double)NAN};
    if (!(largest_value(e, e->noise, false) > 0.0) || !(value > 0.0))
        return (imk_evaluation_figure){value, value, value};
    const double above = half_width_alone(e, largest);
    draw_figures(e, largest, value);
    const double least = quantile(e, e->none, 1.0 - confidence);
    const bool nothing = value <= quantile(e, e->none, 1.0 - tail);
    const double below = quantile(e, e->near, 1.0 - tail);
    return (imk_evaluation_figure){value, nothing ? 0.0 : fmax(0.0, value - below),
                                   fmax(value, least) + above};
}

/* ---- figures --------------------------------------------------------------------------------- */

static imk_evaluation_figure of_scale(const imki_evaluation *e, imk_evaluation_figure f)
{
    const double scale = fabs(e->result->line.sensitivity) * e->scale;
    return (imk_evaluation_figure){f.value / scale, f.lower / scale, f.upper / scale};
}

/* Half width about 0 that holds a part of normal values with this mean and sigma: Newton's steps,
 * halved intervals where they leave the bracket. */
static double half_width(double mean, double sigma, double part)
{
    double low = 0.0, high = fabs(mean) + imk_normal_quantile(0.5 + 0.5 * part) * sigma;
    double w = high;
    if (!(sigma > 0.0))
        return fabs(mean);
    for (int i = 0; i < 60 && high - low > 1e-9 * high; i++) {
        const double a = (w - mean) / sigma, b = (w + mean) / sigma;
        const double missing = part - imk_normal_probability(a) + imk_normal_probability(-b);
        *(missing > 0.0 ? &low : &high) = w;
        const double density = (imk_exp(-0.5 * a * a) + imk_exp(-0.5 * b * b)) / root_two_pi;
        const double step = missing * sigma / density;
        if (fabs(step) < 1e-9 * w)
            return w;
        w = w + step > low && w + step < high ? w + step : 0.5 * (low + high);
    }
    return w;
}

/* Interval by the generalised pivot: mean and sigma of the readings as their own distributions
 * leave them open [WEERAHANDI1993]. The noise of the accuracy has been drawn. */
static void put_coverage(imki_evaluation *e)
{
    const double part = e->settings->confidence, tail = 0.5 - 0.5 * part;
    const double error = e->result->accuracy.value;
    const size_t worst = (size_t)e->result->accuracy_level;
    if (e->result->source != IMK_SCATTER_REPLICATES || !isfinite(e->result->accuracy.lower))
        return;
    const double value = half_width(error, e->sigma, part);
    if (!(e->sigma > 0.0) || !(error > 0.0)) {
        e->result->coverage = (imk_evaluation_figure){value, value, value};
        return;
    }
    for (size_t b = 0; b < e->draws; b++) {
        const double f = e->factor[b], alone = f * e->noise[worst] * e->draw[b * e->levels + worst];
        e->near[b] = half_width(fmax(0.0, error - e->near[b]), f * e->sigma, part);
        e->none[b] = half_width(error - alone, f * e->sigma, part);
    }
    e->result->coverage = (imk_evaluation_figure){value, quantile(e, e->near, tail),
                                                  quantile(e, e->none, 1.0 - tail)};
}

static void put_accuracy(imki_evaluation *e)
{
    double variance;
    for (size_t k = 0; k < e->levels; k++) {
        e->pattern[k] = imki_level_mean(e, k, &variance) - e->reference[k];
        e->noise[k] = e->level_sigma[k];
    }
    e->result->accuracy_level = (int)place_of_largest(e, e->pattern);
    e->result->accuracy = interval(e, largest_value);
    put_coverage(e);
}

static void put_linearity(imki_evaluation *e)
{
    imk_evaluation *r = e->result;
    double variance;
    prepare_residuals(e);
    for (size_t k = 0; k < e->levels; k++) {
        e->pattern[k] =
            imki_level_mean(e, k, &variance) - r->line.zero - r->line.sensitivity * e->reference[k];
        e->noise[k] = e->level_sigma[k];
    }
    r->best = imk_minimax_line(e->levels, e->reference, e->pattern, r->alternation, e->hull);
    r->best.zero += r->line.zero;
    r->best.sensitivity += r->line.sensitivity;
    if (e->levels < 3)
        return;
    r->linearity_level = (int)place_of_largest(e, e->pattern);
    r->linearity = of_scale(e, interval(e, largest_residual));
    for (size_t k = 0; k < e->levels; k++)
        e->pattern[k] =
            imki_level_mean(e, k, &variance) - r->best.zero - r->best.sensitivity * e->reference[k];
    r->linearity_best = of_scale(e, interval(e, largest_minimax));
}

static void put_hysteresis(imki_evaluation *e)
{
    bool any = false;
    for (size_t k = 0; k < e->levels; k++) {
        const imki_cell *down = &e->cell[k * IMKI_CELLS], *up = down + 2;
        const bool both = down->count > 0 && up->count > 0;
        any = any || both;
        e->pattern[k] = both ? up->mean - down->mean : 0.0;
        e->noise[k] = both ? sqrt(up->variance + down->variance) : 0.0;
    }
    if (!any)
        return;
    e->result->hysteresis_level = (int)place_of_largest(e, e->pattern);
    e->result->hysteresis = of_scale(e, interval(e, largest_value));
}

void imki_extremes(imki_evaluation *e)
{
    if (e->settings->same_unit)
        put_accuracy(e);
    if (e->levels < 2)
        return;
    put_linearity(e);
    put_hysteresis(e);
}
