/* SPDX-License-Identifier: Apache-2.0 */
/* Gauss-Markov terms: slow noise that is neither flicker nor random walk.
 *
 * Their variances are amounts of the linear fit; the correlation times are searched on a grid, one
 * term at a time, and then all settled together by scoring steps in log T with
 * dS/d log T = amount dshape/d log T, every amount refitted at each step. */
#include "identify_internal.h"
#include "imukit/elementary.h"
#include "imukit/linear_algebra.h"

#include <math.h>
#include <string.h>

/* Spectra of neighbouring times on the grid correlate by 0.97: nothing falls between. */
static const double GRID_STEP = 1.7;
enum { SETTLE_STEPS = 12, PARAMETERS_MAX = IMKI_TEMPLATES_MAX + IMKI_GAUSS_MARKOV_MAX };

/* From eight samples, below which the term is taken for the output's own filter, to a sixth of the
 * record, above which it is taken for a random walk. */
bool imki_gauss_markov_range(const imki_bands *bands, double *shortest, double *longest)
{
    *shortest = 8 * bands->dt;
    *longest = (double)bands->n * bands->dt / 6;
    return *longest > *shortest;
}

static void set_time(imki_fit *fit, const imki_bands *bands, size_t term, double time)
{
    if (fit->correlation_time[term] != time)
        imki_gauss_markov_shape(fit, bands, time, fit->shape[IMKI_FIRST_GAUSS_MARKOV + term]);
    fit->correlation_time[term] = time;
}

static double refit(imki_fit *fit, const imki_bands *bands, int held)
{
    if (held == IMKI_HELD_NONE)
        return imki_fit_maximise(fit, bands);
    return imki_fit_profile(fit, bands, held,
                            held == IMKI_HELD_RAMP ? fit->ramp : fit->amount[held]);
}

/* dS/d log T by a difference: a ten-thousandth is far from rounding and from curvature. */
static const double *time_column(imki_fit *fit, const imki_bands *bands, size_t term)
{
    const double h = 1e-4;
    double *column = fit->change[term];
    const size_t slot = IMKI_FIRST_GAUSS_MARKOV + term;
    imki_gauss_markov_shape(fit, bands, fit->correlation_time[term] * (1 + h), column);
    for (size_t b = 0; b < bands->count; b++)
        column[b] = fit->amount[slot] * (column[b] - fit->shape[slot][b]) / h;
    return column;
}

/* Scoring step in the logarithms of the `count` times in `terms`; false when they cannot be told.
 * Returns in `promised` the likelihood it should bring. */
static bool time_step(imki_fit *fit, const imki_bands *bands, int held, size_t count,
                      const size_t *terms, double *step, double *promised)
{
    const double *columns[PARAMETERS_MAX] = {0};
    double gradient[PARAMETERS_MAX], h[PARAMETERS_MAX * PARAMETERS_MAX], scale[PARAMETERS_MAX];
    size_t all = 0;
    for (size_t i = 0; i < count; i++)
        columns[all++] = time_column(fit, bands, terms[i]);
    for (size_t j = 0; j < fit->templates; j++)
        if (fit->active[j] && fit->amount[j] > 0 && (int)j != held)
            columns[all++] = fit->shape[j];
    imki_fit_slope(fit, bands, all, columns, gradient, h);
    for (size_t i = 0; i < all; i++)
        scale[i] = h[i * all + i] > 0 ? 1 / sqrt(h[i * all + i]) : 0;
    for (size_t i = 0; i < all; i++) {
        for (size_t j = 0; j < all; j++)
            h[i * all + j] *= scale[i] * scale[j];
        h[i * all + i] += 1e-9;
        /* The amounts are at their maximum, or on their edge: what slope they have is no news. */
        gradient[i] *= i < count ? scale[i] : 0;
    }
    double solution[PARAMETERS_MAX];
    memcpy(solution, gradient, sizeof solution);
    if (imk_cholesky_factor(all, h) != IMK_OK)
        return false;
    imk_cholesky_solve(all, h, solution);
    *promised = 0;
    for (size_t i = 0; i < count; i++) {
        *promised += 0.5 * solution[i] * gradient[i];
        step[i] = fmax(-0.7, fmin(0.7, solution[i] * scale[i])); /* a factor of two at most */
    }
    return true;
}

static bool take_time_step(imki_fit *fit, const imki_bands *bands, int held, size_t count,
                           const size_t *terms, const double *step)
{
    const imki_amounts start = imki_fit_keep(fit);
    double shortest, longest;
    imki_gauss_markov_range(bands, &shortest, &longest);
    for (double part = 1; part > 0.05; part *= 0.4) {
        for (size_t i = 0; i < count; i++) {
            const double time = start.correlation_time[terms[i]] * imk_exp(part * step[i]);
            set_time(fit, bands, terms[i], fmax(0.25 * shortest, fmin(2 * longest, time)));
        }
        if (refit(fit, bands, held) > start.log_likelihood)
            return true;
        imki_fit_restore(fit, bands, &start);
    }
    return false;
}

double imki_gauss_markov_settle(imki_fit *fit, const imki_bands *bands, int held, int held_time)
{
    refit(fit, bands, held);
    for (int i = 0; i < SETTLE_STEPS; i++) {
        size_t terms[IMKI_GAUSS_MARKOV_MAX], count = 0;
        double step[IMKI_GAUSS_MARKOV_MAX], promised;
        for (size_t term = 0; term < IMKI_GAUSS_MARKOV_MAX; term++)
            if (fit->active[IMKI_FIRST_GAUSS_MARKOV + term] &&
                fit->amount[IMKI_FIRST_GAUSS_MARKOV + term] > 0 && (int)term != held_time)
                terms[count++] = term;
        const double before = fit->log_likelihood;
        if (count == 0 || !time_step(fit, bands, held, count, terms, step, &promised) ||
            !(promised > 1e-3) || !take_time_step(fit, bands, held, count, terms, step) ||
            !(fit->log_likelihood > before + 1e-3))
            break;
    }
    return fit->log_likelihood;
}

/* A third of the power at the corner. */
static double amount_at_corner(const imki_bands *bands, double time, const double *shape)
{
    size_t b = 0;
    while (b + 1 < bands->count && bands->frequency[b] * time < 0.16)
        b++;
    return 0.3 * bands->power[b] / shape[b];
}

bool imki_gauss_markov_add(imki_fit *fit, const imki_bands *bands, double gain)
{
    const imki_amounts start = imki_fit_keep(fit);
    imki_amounts best = start;
    double shortest, longest;
    size_t term = 0;
    while (term < IMKI_GAUSS_MARKOV_MAX && fit->active[IMKI_FIRST_GAUSS_MARKOV + term])
        term++;
    if (term == IMKI_GAUSS_MARKOV_MAX || !imki_gauss_markov_range(bands, &shortest, &longest))
        return false;
    const size_t slot = IMKI_FIRST_GAUSS_MARKOV + term;
    fit->active[slot] = true;
    fit->amount[slot] = 0;
    const int points = (int)(imk_ln(longest / shortest) / imk_ln(GRID_STEP)) + 2;
    for (int i = 0; i < points; i++) {
        set_time(fit, bands, term,
                 shortest * imk_exp(imk_ln(longest / shortest) * i / (double)(points - 1)));
        if (!(fit->amount[slot] > 0))
            fit->amount[slot] =
                amount_at_corner(bands, fit->correlation_time[term], fit->shape[slot]);
        if (imki_fit_maximise(fit, bands) > best.log_likelihood)
            best = imki_fit_keep(fit);
    }
    imki_fit_restore(fit, bands, &best);
    if (best.active[slot])
        imki_gauss_markov_settle(fit, bands, IMKI_HELD_NONE, IMKI_HELD_NONE);
    if (!(fit->log_likelihood > start.log_likelihood + gain)) {
        imki_fit_restore(fit, bands, &start);
        return false;
    }
    return true;
}
