/* SPDX-License-Identifier: Apache-2.0 */
/* The fast end of the spectrum to some tenths of a percent.
 *
 * A resonance whose frequency drifts with temperature, or two that overlap, has
 * no resonance's shape, and at short averaging times the Allan deviation of a
 * long record shows it: its interval there is narrower than a percent. Wide
 * resonances are a basis for such shapes. One is added where it brings most,
 * everything is fitted again jointly (joint_shape.c), and it stays if the
 * likelihood has risen enough. Where it goes is found by the score test: a
 * template h, with its own a = h.h and c = h.D in the product of the
 * information, is worth about
 *
 *     gain = (h.(P - S))^2/(2 (a - c^T H^-1 c))
 *
 * What no sum of resonances fits is then given the weight that its residuals
 * show it to deserve, so that it does not bend the rest of the spectrum. */
#include "identify/joint/joint_shape_internal.h"

#include "imukit/elementary.h"
#include "imukit/linear_algebra.h"

#include <math.h>

/* What a resonance's three parameters must be worth. Frequencies and qualities
 * make some 200 places that differ; chance alone brings 15 units in one of them
 * once in 1e5 records (half a chi-square of one degree at each place, frequency
 * and quality having been chosen). */
static const double GAIN_MIN = 15;
/* The score test is of first order: what it finds worth half of that is tried.
 */
static const double GAIN_TRIED = 7.5;
/* A gain that needs no comparison with the best fit without. */
static const double GAIN_CLEAR = 80;
/* Likelihood that a step of the joint fit must bring while resonances are compared, and at the end:
 * a fiftieth of a unit is a fifth of a standard deviation. */
static const double ROUGHLY = 0.5, FINALLY = 0.02;
/* What a filter of first and of second order must be worth, as in
 * output_filter.c. */
static const double FIRST_ORDER = 10, SECOND_ORDER = 13;
/* Frequencies tried, in sample rates: below are the slow terms and the lines,
 * above is folding. */
static const double LOWEST = 0.01, HIGHEST = 0.49;
static const double Q_LAST = 20;
enum { FREQUENCIES = 48, QUALITIES = 6 };

/* Mean square of a band's residuals over their neighbourhood's, in standard
 * deviations, above which they are no chance: fifteen bands pass it once in 2e4
 * times. */
static const double DISPERSED = 3;
enum { NEIGHBOURS = 7, TEMPERINGS = 2 };

/* Score test of one further template; the information is factored. */
static double score_gain(const imki_joint_fit *j, const double *scale, double *shape,
                         double *amount)
{
    const size_t p = j->count, bands = j->w->bands->count;
    const double *weight = imki_joint_fit_row(j, IMKI_SHAPE_WEIGHT);
    const double *excess = imki_joint_fit_row(j, IMKI_SHAPE_EXCESS);
    double slope = 0, square = 0, c[IMKI_SHAPE_PARAMETERS], solved[IMKI_SHAPE_PARAMETERS];
    for (size_t b = 0; b < bands; b++) {
        const double weighted = weight[b] * shape[b];
        slope += weighted * excess[b];
        square += weighted * shape[b];
        shape[b] = weighted;
    }
    for (size_t i = 0; i < p; i++) {
        const double *row = imki_joint_fit_row(j, i);
        double sum = 0;
        for (size_t b = 0; b < bands; b++)
            sum += shape[b] * row[b];
        solved[i] = c[i] = sum * scale[i];
    }
    imk_cholesky_solve(p, imki_joint_fit_row(j, IMKI_SHAPE_FACTOR), solved);
    double left = square;
    for (size_t i = 0; i < p; i++)
        left -= c[i] * solved[i];
    if (!(slope > 0) || !(left > 1e-6 * square))
        return 0;
    *amount = slope / left;
    return 0.5 * slope * slope / left;
}

/* The resonance that the residuals ask for most, of quality `widest` or more. @return its gain,
 * about */
static double best_resonance(imki_joint_fit *j, double widest, imk_resonance *best)
{
    const imki_bands *bands = j->w->bands;
    double *shape = imki_joint_fit_row(j, IMKI_SHAPE_SCRATCH);
    double scale[IMKI_SHAPE_PARAMETERS], top = 0;
    imki_joint_fit_linearise(j);
    if (!imki_joint_fit_factor(j, 1e-9, scale))
        return 0;
    for (int i = 0; i < FREQUENCIES; i++) {
        const double part = (double)i / (FREQUENCIES - 1);
        const double f = LOWEST / bands->dt * imk_exp(imk_ln(HIGHEST / LOWEST) * part);
        for (int k = 0; k < QUALITIES; k++) {
            const double q = widest * imk_exp(imk_ln(Q_LAST / widest) * k / (QUALITIES - 1));
            double amount = 0;
            imki_resonance_shape(f, q, bands, shape);
            const double gain = score_gain(j, scale, shape, &amount);
            if (gain > top) {
                top = gain;
                *best = (imk_resonance){sqrt(amount), f, q};
            }
        }
    }
    return top;
}

/* Bands that resolve the resonances as they are now, and all shapes at them. */
static void resolve(imki_joint_fit *j)
{
    imki_fit *fit = j->w->fit;
    imki_identify_bands(j->w, j->result);
    imki_templates_set(fit, j->w->bands);
    for (size_t i = 0; i < IMKI_GAUSS_MARKOV_MAX; i++)
        if (fit->active[IMKI_FIRST_GAUSS_MARKOV + i])
            imki_gauss_markov_shape(fit, j->w->bands, fit->correlation_time[i],
                                    fit->shape[IMKI_FIRST_GAUSS_MARKOV + i]);
    for (size_t r = 0; IMKI_FIRST_RESONANCE + r < fit->templates; r++)
        imki_resonance_shape(j->result->resonance[r].frequency, j->result->resonance[r].q,
                             j->w->bands, fit->shape[IMKI_FIRST_RESONANCE + r]);
    imki_joint_fit_update(j);
}

/* A state of the fit to come back to, at the same bands. */
typedef struct shape_state {
    imki_amounts amounts;
    imk_identification result;
} shape_state;

static shape_state keep(const imki_joint_fit *j)
{
    return (shape_state){imki_fit_keep(j->w->fit), *j->result};
}

static void restore(imki_joint_fit *j, const shape_state *state)
{
    *j->result = state->result;
    j->w->fit->templates = IMKI_FIRST_RESONANCE + (size_t)j->result->resonance_count;
    imki_fit_restore(j->w->fit, j->w->bands, &state->amounts);
    imki_joint_fit_update(j);
}

/* Takes a resonance off the list. */
static void drop(imki_joint_fit *j, size_t index)
{
    imki_fit *fit = j->w->fit;
    imk_resonance *list = j->result->resonance;
    const size_t count = (size_t)--j->result->resonance_count;
    for (size_t r = index; r < count; r++) {
        const size_t slot = IMKI_FIRST_RESONANCE + r;
        list[r] = list[r + 1];
        fit->active[slot] = fit->active[slot + 1];
        fit->amount[slot] = fit->amount[slot + 1];
    }
    list[count] = (imk_resonance){0, 0, 0};
    j->w->resonant_lines -= (int)index < j->w->resonant_lines;
    fit->active[IMKI_FIRST_RESONANCE + count] = false;
    fit->amount[IMKI_FIRST_RESONANCE + count] = 0;
    fit->templates = IMKI_FIRST_RESONANCE + count;
    imki_joint_fit_update(j);
}

/* Wide resonances side by side can stand for white noise and its filter; they shall not. `white` is
 * the most white noise that a state had. */
static bool displaces_white(const imki_joint_fit *j, const shape_state *before, double white)
{
    const double was = before->result.filter.bandwidth, is = j->result->filter.bandwidth;
    const double left = j->w->fit->amount[IMK_NOISE_WHITE];
    const bool filtered = is > 0 && is < (was > 0 ? 0.5 * was : 0.5 / j->w->bands->dt);
    return left < 0.9 * white || (filtered && left < before->amounts.amount[IMK_NOISE_WHITE]);
}

/* One more resonance, of quality `widest` or more, and whether it stays. */
static bool add_resonance(imki_joint_fit *j, double widest, double *white)
{
    imki_fit *fit = j->w->fit;
    imk_resonance candidate = {0, 0, 0};
    if (j->result->resonance_count == IMK_TERMS_MAX ||
        best_resonance(j, widest, &candidate) < GAIN_TRIED)
        return false;
    const size_t index = (size_t)j->result->resonance_count++;
    const size_t slot = IMKI_FIRST_RESONANCE + index;
    j->result->resonance[index] = candidate;
    fit->templates = slot + 1;
    fit->active[slot] = false;
    fit->amount[slot] = 0;
    resolve(j);
    double without = imki_fit_maximise(fit, j->w->bands);
    const shape_state before = keep(j);
    fit->active[slot] = true;
    fit->amount[slot] = candidate.sigma * candidate.sigma;
    const double with = imki_joint_fit_maximise(j);
    const bool fair = !displaces_white(j, &before, *white);
    const double most = fmax(*white, fit->amount[IMK_NOISE_WHITE]);
    if (fair && with > without + GAIN_CLEAR) {
        *white = most;
        return true;
    }
    /* What the joint fit gains without it, at these bands, is not its own. */
    const shape_state after = keep(j);
    restore(j, &before);
    without = imki_joint_fit_maximise(j);
    if (fair && with > without + GAIN_MIN) {
        restore(j, &after);
        *white = most;
        return true;
    }
    drop(j, index);
    return false;
}

static double worth(const imki_joint_fit *j)
{
    const imk_low_pass filter = j->result->filter;
    const double cost = filter.damping > 0 ? SECOND_ORDER : FIRST_ORDER;
    return j->w->fit->log_likelihood - (filter.bandwidth > 0 ? cost : 0);
}

/* The filter was found beside another shape: is there a better one now? */
static bool change_filter(imki_joint_fit *j, double white)
{
    const double bandwidth =
        j->result->filter.bandwidth > 0 ? j->result->filter.bandwidth : 0.5 / j->w->bands->dt;
    const imk_low_pass starts[3] = {{bandwidth, 0}, {bandwidth, 0.7}, {0, 0}};
    bool changed = false;
    for (int i = 0; i < 3; i++) {
        const shape_state before = keep(j);
        const double least = worth(j) + 0.1;
        j->result->filter = starts[i];
        imki_joint_fit_maximise(j);
        if (worth(j) > least && !displaces_white(j, &before, white))
            changed = true;
        else
            restore(j, &before);
    }
    return changed;
}

/* The slower pole of an overdamped second order. */
static imk_low_pass first_order_of(imk_low_pass filter)
{
    const double z = filter.damping;
    return (imk_low_pass){filter.bandwidth * (z - sqrt(z * z - 1)), 0};
}

static void add_resonances(imki_joint_fit *j)
{
    const int before = j->result->resonance_count;
    double white = j->w->fit->amount[IMK_NOISE_WHITE];
    while (add_resonance(j, IMKI_WIDEST, &white) || add_resonance(j, 2 * IMKI_WIDEST, &white))
        if (j->result->filter.damping >= IMKI_OVERDAMPED)
            j->result->filter = first_order_of(j->result->filter);
    const bool beside = j->result->filter.bandwidth > 0 && j->result->resonance_count > 0;
    if ((j->result->resonance_count > before || beside) && change_filter(j, white))
        while (add_resonance(j, 2 * IMKI_WIDEST, &white))
            continue;
    for (int r = j->result->resonance_count - 1; r >= 0; r--) {
        const size_t slot = IMKI_FIRST_RESONANCE + (size_t)r;
        if (j->w->fit->active[slot] && !(j->w->fit->amount[slot] > 0))
            drop(j, (size_t)r);
    }
}

static void set_slow_aside(imki_fit *fit)
{
    for (size_t i = 0; i < IMKI_GAUSS_MARKOV_MAX; i++) {
        fit->active[IMKI_FIRST_GAUSS_MARKOV + i] = false;
        fit->amount[IMKI_FIRST_GAUSS_MARKOV + i] = 0;
    }
}

/* The Gauss-Markov term was found beside an unfinished shape: is it needed beside this one? If not,
 * it would bend filter and resonances. */
static void doubt_slow(imki_joint_fit *j)
{
    if (!j->w->fit->active[IMKI_FIRST_GAUSS_MARKOV])
        return;
    const shape_state with = keep(j);
    set_slow_aside(j->w->fit);
    if (imki_joint_fit_maximise(j) + GAIN_TRIED < with.amounts.log_likelihood)
        restore(j, &with);
}

/* Where the residuals of the fast end scatter more than their degrees of
 * freedom allow, these are reduced by the ratio. */
static void temper(imki_joint_fit *j)
{
    imki_bands *bands = j->w->bands;
    double *square = imki_joint_fit_row(j, IMKI_SHAPE_SCRATCH);
    resolve(j);
    for (size_t b = 0; b < bands->count; b++) {
        const double r = bands->power[b] / imki_fit_spectrum(j->w->fit, b) - 1;
        square[b] = 0.5 * bands->degrees[b] * r * r;
    }
    for (size_t b = 0; b < bands->count; b++) {
        if (bands->frequency[b] * bands->dt < LOWEST)
            continue;
        const size_t first = b > NEIGHBOURS ? b - NEIGHBOURS : 0;
        const size_t end = b + NEIGHBOURS < bands->count ? b + NEIGHBOURS + 1 : bands->count;
        double mean = 0;
        for (size_t i = first; i < end; i++)
            mean += square[i] / (double)(end - first);
        if (mean > DISPERSED)
            imki_bands_weigh(bands, b, 1 / mean);
    }
    imki_joint_fit_maximise(j);
}

int imki_fast_shape_refine(imki_work *w, imk_identification *result)
{
    imki_joint_fit joint = {.w = w, .result = result, .enough = ROUGHLY}, *j = &joint;
    imki_fit *fit = w->fit;
    const int before = result->resonance_count;
    /* Slow noise that levels off has a tail here: no resonance shall take its
     * place. */
    if (imki_gauss_markov_add(fit, w->bands, GAIN_TRIED))
        imki_gauss_markov_settle(fit, w->bands, IMKI_HELD_NONE, IMKI_HELD_NONE);
    imki_joint_fit_maximise(j);
    add_resonances(j);
    j->enough = FINALLY;
    doubt_slow(j);
    for (int i = 0; i < TEMPERINGS; i++)
        temper(j);
    /* The slow terms are chosen later, all together. */
    set_slow_aside(fit);
    imki_fit_maximise(fit, w->bands);
    return result->resonance_count - before;
}
