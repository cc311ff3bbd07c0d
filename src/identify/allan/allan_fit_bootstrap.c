/* SPDX-License-Identifier: Apache-2.0 */
/* Parametric bootstrap of a fit to a table of Allan variances.
 *
 * A variance v of expectation E and variance C has nearly the distribution of E chi-square(d)/d,
 * d = 2 E^2/C. Correlated ones are drawn through a Gaussian copula: z = L e with L L^T the
 * correlations of the model's covariance, u = Phi(z), v = E quantile(u; d)/d. Correlations of the
 * drawn v are then the model's but for the curvature of the quantile, some percent at d of a few.
 */
#include "allan_fit_internal.h"
#include "base/sort_internal.h"
#include "imukit/distributions.h"
#include "imukit/linear_algebra.h"

#include <math.h>
#include <string.h>

/* Five terms of a problem by their places, as in allan_fit.c, and the model to draw from. */
typedef struct bootstrap_work {
    imki_allan_problem *problem;
    imki_allan_state *truth;
    int place[IMK_NOISE_TERMS];
    double expected[IMKI_ALLAN_TAUS], degrees[IMKI_ALLAN_TAUS];
    double *factor; /* count x count */
    double drawn[IMKI_ALLAN_TAUS];
} bootstrap_work;

/* The fit's model in a problem, shapes as they were found, and its covariance's factor. */
static imk_status prepare(bootstrap_work *w, const imk_allan_fit *fit)
{
    imki_allan_problem *problem = w->problem;
    problem->noise = fit->noise;
    for (int i = 0; i < fit->noise.gauss_markov_count; i++) {
        problem->origin[problem->terms] = i;
        problem->term[problem->terms++] = (imki_lag_term){.kind = IMKI_LAG_DECAY};
    }
    for (size_t t = 0; t < problem->terms; t++)
        imki_allan_term_set(problem, t);
    imki_allan_sums(problem, 0, false);
    const size_t n = problem->table->count;
    for (size_t t = 0; t < problem->terms; t++) {
        w->truth->amount[t] = imki_allan_amount(problem, &fit->noise, t);
        w->truth->active[t] = w->truth->amount[t] > 0;
        const imki_lag_kind kind = problem->term[t].kind;
        if (kind != IMKI_LAG_DECAY && kind != IMKI_LAG_RINGING && kind != IMKI_LAG_SINUSOID &&
            w->truth->active[t])
            w->place[problem->origin[t]] = (int)t;
    }
    imki_allan_matrix(problem, w->truth->amount, w->factor);
    double sd[IMKI_ALLAN_TAUS];
    for (size_t i = 0; i < n; i++) {
        w->expected[i] = 0;
        for (size_t t = 0; t < problem->terms; t++)
            w->expected[i] += w->truth->amount[t] * problem->shape[i * problem->capacity + t];
        const double admitted = 2 * problem->tolerance * w->expected[i];
        w->factor[i * n + i] += admitted * admitted;
        sd[i] = sqrt(w->factor[i * n + i]);
        w->degrees[i] = 2 * w->expected[i] * w->expected[i] / w->factor[i * n + i];
    }
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < n; j++)
            w->factor[i * n + j] /= sd[i] * sd[j];
    for (size_t i = 0; i < n; i++)
        w->factor[i * n + i] *= 1 + 1e-10;
    return imk_cholesky_factor(n, w->factor);
}

static void draw(bootstrap_work *w, imk_random random, size_t number)
{
    const size_t n = w->problem->table->count;
    double e[IMKI_ALLAN_TAUS];
    imk_random_normals(random, number, 0, n, e);
    for (size_t i = 0; i < n; i++) {
        double z = 0;
        for (size_t k = 0; k <= i; k++)
            z += w->factor[i * n + k] * e[k];
        const double u = fmin(fmax(imk_normal_probability(z), 1e-12), 1 - 1e-12);
        /* Above a million degrees chi-square is normal to 1e-3 of its deviation. */
        w->drawn[i] =
            w->degrees[i] < 1e6
                ? w->expected[i] * imk_chi_square_quantile(u, w->degrees[i]) / w->degrees[i]
                : w->expected[i] * (1 + z * sqrt(2 / w->degrees[i]));
    }
    w->problem->variances = w->drawn;
}

static void summarise(const bootstrap_work *w, double *values, double confidence, size_t draws,
                      int term, struct imk_allan_bootstrap_term *out)
{
    const double truth = w->truth->amount[w->place[term]];
    double mean = 0, square = 0;
    for (size_t i = 0; i < draws; i++)
        mean += values[i] / truth / (double)draws;
    for (size_t i = 0; i < draws; i++)
        square += (values[i] / truth - mean) * (values[i] / truth - mean) / (double)(draws - 1);
    out->bias = mean - 1;
    out->sigma = sqrt(square);
    imki_sort(values, draws);
    const double tail = 0.5 * (1 - confidence) * (double)(draws - 1);
    const size_t low = (size_t)floor(tail), high = draws - 1 - low;
    out->lower = sqrt(values[low]);
    out->upper = sqrt(values[high]);
}

imk_status imk_allan_fit_bootstrap(const imk_allan_fit_settings *settings,
                                   const imk_allan_table *table, const imk_allan_fit *fit,
                                   imk_random random, size_t draws, imk_allan_bootstrap *result,
                                   void *workspace, size_t workspace_size)
{
    if (draws < 20)
        return IMK_ERROR_RANGE;
    imki_allan_work *work = NULL;
    imk_status status = imki_allan_fit_start(settings, table, workspace, workspace_size, &work);
    if (status == IMK_OK &&
        workspace_size < imk_allan_fit_workspace_size(settings, table->count, draws))
        status = IMK_ERROR_WORKSPACE;
    if (status != IMK_OK)
        return status;
    imki_allan_problem *problem = &work->problem;
    imki_allan_state *state = &work->other;
    problem->first = fit->first;
    bootstrap_work w = {.problem = problem,
                        .truth = &work->state,
                        .place = {-1, -1, -1, -1, -1},
                        .factor = work->rest};
    double *values = work->rest + table->count * table->count;
    status = prepare(&w, fit);
    if (status != IMK_OK)
        return status;
    const double drop = imk_chi_square_quantile(settings->confidence, 1);
    imk_allan_bootstrap found = {.draws = draws};
    for (size_t d = 0; d < draws; d++) {
        draw(&w, random, d);
        *state = *w.truth;
        imki_allan_solve(problem, state, IMKI_ALLAN_NONE, 0);
        if (state->status != IMK_OK)
            return state->status;
        found.probability += (state->chi_square > fit->chi_square) / (double)draws;
        for (int term = 0; term < IMK_NOISE_TERMS; term++)
            if (w.place[term] >= 0) {
                const int t = w.place[term];
                values[(size_t)term * draws + d] = state->amount[t];
                found.term[term].covered +=
                    (imki_allan_deviance(problem, state, t, w.truth->amount[t]) <= drop) /
                    (double)draws;
            }
    }
    for (int term = 0; term < IMK_NOISE_TERMS; term++)
        if (w.place[term] >= 0)
            summarise(&w, values + (size_t)term * draws, settings->confidence, draws, term,
                      &found.term[term]);
    *result = found;
    return IMK_OK;
}
