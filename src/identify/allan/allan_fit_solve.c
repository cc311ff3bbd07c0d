/* SPDX-License-Identifier: Apache-2.0 */
/* Amounts of the terms from a table of Allan variances, each weighted by the covariance that the
 * amounts themselves imply:
 *
 *     A^T C(a)^-1 (v - A a) = 0,   a >= 0
 *
 * the quasi-likelihood equations of [WEDDERBURN1974], [MCCULLAGH1983]. Solved by repeating: C of
 * the amounts at hand, then non-negative least squares with it. C is never varied together with
 * the residuals in one minimisation: that would favour models with large variances. */
#include "allan_fit_internal.h"
#include "imukit/linear_algebra.h"

#include <math.h>
#include <string.h>

enum { ITERATIONS = 100 };
/* Relative change of the modelled variances: where to stop, and what will do at the last. */
#define CONVERGED 1e-7
#define ACCEPTED 1e-3

/* Solve the normal equations over the terms in `in`, of the problem's scaled matrix h; false when
 * singular. */
static bool solve_over(const imki_allan_problem *problem, const double *b, const bool *in,
                       double *x)
{
    const size_t terms = problem->terms;
    const double *h = problem->scaled;
    size_t index[IMKI_ALLAN_TERMS], count = 0;
    double *l = problem->factor, y[IMKI_ALLAN_TERMS];
    for (size_t t = 0; t < terms; t++)
        if (in[t])
            index[count++] = t;
    for (size_t i = 0; i < count; i++) {
        y[i] = b[index[i]];
        for (size_t j = 0; j < count; j++)
            l[i * count + j] = h[index[i] * terms + index[j]] * (i == j ? 1 + 1e-13 : 1);
    }
    if (count > 0 && imk_cholesky_factor(count, l) != IMK_OK)
        return false;
    if (count > 0)
        imk_cholesky_solve(count, l, y);
    memset(x, 0, terms * sizeof *x);
    for (size_t i = 0; i < count; i++)
        x[index[i]] = y[i];
    return true;
}

/* min 1/2 x^T H x - b^T x over x >= 0, the diagonal of H being 1, among the candidates
 * [LAWSON1974, ch. 23]. Leaves x. */
static bool non_negative(const imki_allan_problem *problem, const double *b, const bool *candidate,
                         double *x)
{
    const size_t terms = problem->terms;
    const double *h = problem->scaled;
    bool in[IMKI_ALLAN_TERMS] = {false};
    double trial[IMKI_ALLAN_TERMS];
    double size = 0;
    for (size_t t = 0; t < terms; t++)
        size = fmax(size, fabs(b[t]));
    memset(x, 0, terms * sizeof *x);
    for (size_t round = 0; round < 3 * terms + 3; round++) {
        size_t best = terms;
        double steepest = 1e-12 * size;
        for (size_t t = 0; t < terms; t++)
            if (candidate[t] && !in[t]) {
                double slope = b[t];
                for (size_t u = 0; u < terms; u++)
                    slope -= h[t * terms + u] * x[u];
                if (slope > steepest) {
                    steepest = slope;
                    best = t;
                }
            }
        if (best == terms)
            return true;
        in[best] = true;
        for (;;) {
            if (!solve_over(problem, b, in, trial))
                return false;
            double reach = 1;
            for (size_t t = 0; t < terms; t++)
                if (in[t] && trial[t] <= 0)
                    reach = fmin(reach, x[t] / (x[t] - trial[t]));
            const bool inside = reach >= 1;
            for (size_t t = 0; t < terms; t++) {
                x[t] = inside ? trial[t] : x[t] + reach * (trial[t] - x[t]);
                if (in[t] && !inside && (trial[t] <= 0 && x[t] <= 1e-14 * size)) {
                    x[t] = 0;
                    in[t] = false;
                }
            }
            if (inside)
                break;
        }
    }
    return true;
}

/* Whiten: rows of the shapes and the residual by the factor of the covariance of the amounts, or,
 * at the start, by the crude standard deviation of each variance on its own. */
static imk_status normal_equations(const imki_allan_problem *problem, const double *amount,
                                   bool start, double *h, double *b, double *square)
{
    const size_t n = problem->table->count, terms = problem->terms, first = problem->first;
    double *restrict matrix = problem->matrix, *restrict white = problem->white;
    if (start) {
        memset(matrix, 0, n * n * sizeof *matrix);
        for (size_t i = 0; i < n; i++) {
            const double m = (double)problem->table->factors[i];
            const double degrees = fmax(1, imki_allan_squares(problem->table, i) / m);
            matrix[i * n + i] = 2 * problem->variances[i] * problem->variances[i] / degrees;
        }
    } else {
        imki_allan_matrix(problem, amount, matrix);
    }
    for (size_t i = 0; i < n; i++) {
        const double admitted = 2 * problem->tolerance * problem->variances[i];
        matrix[i * n + i] *= 1 + 1e-10; /* the sums' own accuracy is no better */
        matrix[i * n + i] += admitted * admitted;
        for (size_t j = 0; i < first && j < n; j++) /* not used: apart from the rest */
            matrix[i * n + j] = matrix[j * n + i] = i == j;
    }
    const imk_status status = imk_cholesky_factor(n, matrix);
    if (status != IMK_OK)
        return status;
    for (size_t t = 0; t <= terms; t++)
        for (size_t i = 0; i < n; i++) {
            double sum = i < first   ? 0
                         : t < terms ? problem->shape[i * problem->capacity + t]
                                     : problem->variances[i];
            for (size_t k = 0; k < i; k++)
                sum -= matrix[i * n + k] * white[t * n + k];
            white[t * n + i] = sum / matrix[i * n + i];
        }
    *square = 0;
    for (size_t i = 0; i < n; i++)
        *square += white[terms * n + i] * white[terms * n + i];
    for (size_t t = 0; t < terms; t++) {
        b[t] = 0;
        for (size_t i = 0; i < n; i++)
            b[t] += white[t * n + i] * white[terms * n + i];
        for (size_t u = 0; u <= t; u++) {
            double sum = 0;
            for (size_t i = 0; i < n; i++)
                sum += white[t * n + i] * white[u * n + i];
            h[t * terms + u] = h[u * terms + t] = sum;
        }
    }
    return IMK_OK;
}

/* Non-negative least squares with one amount held; amounts are scaled by their columns. */
static bool least_squares(const imki_allan_problem *problem, const double *h, const double *b,
                          const bool *active, int held, double value, double *amount)
{
    const size_t terms = problem->terms;
    double *scaled = problem->scaled, right[IMKI_ALLAN_TERMS];
    double scale[IMKI_ALLAN_TERMS], x[IMKI_ALLAN_TERMS];
    bool candidate[IMKI_ALLAN_TERMS];
    for (size_t t = 0; t < terms; t++) {
        scale[t] = h[t * terms + t] > 0 ? 1 / sqrt(h[t * terms + t]) : 0;
        candidate[t] = active[t] && (int)t != held && scale[t] > 0;
    }
    for (size_t t = 0; t < terms; t++) {
        right[t] = scale[t] * (b[t] - (held >= 0 ? h[t * terms + (size_t)held] * value : 0));
        for (size_t u = 0; u < terms; u++)
            scaled[t * terms + u] = scale[t] * scale[u] * h[t * terms + u];
    }
    for (size_t t = 0; t < terms; t++)
        right[t] = candidate[t] ? right[t] : 0;
    if (!non_negative(problem, right, candidate, x))
        return false;
    for (size_t t = 0; t < terms; t++)
        amount[t] = candidate[t] ? scale[t] * x[t] : 0;
    if (held >= 0)
        amount[held] = value;
    return true;
}

/* Largest relative change of the modelled variances. */
static double change(const imki_allan_problem *problem, const double *before, const double *after)
{
    double largest = 0;
    for (size_t i = 0; i < problem->table->count; i++) {
        double old = 0, new = 0;
        for (size_t t = 0; t < problem->terms; t++) {
            old += before[t] * problem->shape[i * problem->capacity + t];
            new += after[t] * problem->shape[i * problem->capacity + t];
        }
        largest = fmax(largest, fabs(new - old) / fmax(fabs(old), 1e-300));
    }
    return largest;
}

/* What random terms leave zero has no covariance: white noise far below the smallest variance. */
static void keep_regular(const imki_allan_problem *problem, double *amount)
{
    const size_t n = problem->table->count, terms = problem->terms;
    double random = 0, least = (double)INFINITY;
    for (size_t t = 0; t < terms; t++)
        if (problem->term[t].kind < IMKI_LAG_RAMP)
            random += amount[t];
    for (size_t i = 0; i < n; i++)
        least = fmin(least, problem->variances[i]);
    for (size_t t = 0; t < terms && !(random > 0); t++)
        if (problem->term[t].kind < IMKI_LAG_RAMP) {
            amount[t] = 1e-3 * least / problem->shape[t];
            random = amount[t];
        }
}

/* One round of the iteration is a fixed-point map whose errors shrink by a constant factor, slowly
 * where the model does not fit: extrapolate along the last two steps [ANDERSON1965], depth one,
 * amounts weighted by their information; a negative amount says the step was too long. */
static void accelerate(size_t terms, const double *h, const double *step, const double *last_step,
                       const double *next, const double *last_next, double *amount)
{
    double along = 0, square = 0;
    for (size_t t = 0; t < terms; t++) {
        const double weight = h[t * terms + t], change_of_step = step[t] - last_step[t];
        along += weight * change_of_step * step[t];
        square += weight * change_of_step * change_of_step;
    }
    const double share = square > 0 ? fmin(fmax(along / square, -20), 1) : 0;
    bool inside = true;
    for (size_t t = 0; t < terms; t++) {
        amount[t] = next[t] - share * (next[t] - last_next[t]);
        inside = inside && amount[t] >= 0;
    }
    if (!inside)
        memcpy(amount, next, terms * sizeof *amount);
}

/* Information, score and chi-square at the amounts. */
static void conclude(size_t terms, const double *b, double square, imki_allan_state *state)
{
    state->chi_square = square;
    for (size_t t = 0; t < terms; t++) {
        state->score[t] = b[t];
        state->chi_square -= 2 * b[t] * state->amount[t];
        for (size_t u = 0; u < terms; u++) {
            const double h = state->information[t * terms + u];
            state->score[t] -= h * state->amount[u];
            state->chi_square += h * state->amount[t] * state->amount[u];
        }
    }
}

void imki_allan_solve(const imki_allan_problem *problem, imki_allan_state *state, int held,
                      double value)
{
    const size_t terms = problem->terms;
    double b[IMKI_ALLAN_TERMS] = {0}, square = 0, next[IMKI_ALLAN_TERMS],
           last_next[IMKI_ALLAN_TERMS];
    double step[IMKI_ALLAN_TERMS], last_step[IMKI_ALLAN_TERMS], weights[IMKI_ALLAN_TERMS];
    bool start = !problem->held;
    for (size_t t = 0; t < terms; t++) {
        start = start && !(state->amount[t] > 0);
        if (!state->active[t] && (int)t != held)
            state->amount[t] = 0;
    }
    if (held >= 0)
        state->amount[held] = value;
    state->status = IMK_ERROR_NO_CONVERGENCE;
    double moved = (double)INFINITY;
    for (int i = 0; i < ITERATIONS && moved > CONVERGED; i++) {
        memcpy(weights, problem->held ? problem->held : state->amount, terms * sizeof *weights);
        keep_regular(problem, weights);
        const imk_status status =
            normal_equations(problem, weights, start, state->information, b, &square);
        if (status != IMK_OK ||
            !least_squares(problem, state->information, b, state->active, held, value, next)) {
            state->status = status != IMK_OK ? status : IMK_ERROR_SINGULAR;
            return;
        }
        moved = problem->held ? 0 : start ? (double)INFINITY : change(problem, state->amount, next);
        for (size_t t = 0; t < terms; t++)
            step[t] = next[t] - state->amount[t];
        if (i < 2)
            memcpy(state->amount, next, terms * sizeof *next);
        else
            accelerate(terms, state->information, step, last_step, next, last_next, state->amount);
        if (i > ITERATIONS / 2 && moved > 1e-3) /* swings between two sets of terms: halfway */
            for (size_t t = 0; t < terms; t++)
                state->amount[t] = next[t] - 0.7 * step[t];
        memcpy(last_step, step, terms * sizeof *step);
        memcpy(last_next, next, terms * sizeof *next);
        start = false;
    }
    if (moved < ACCEPTED)
        state->status = IMK_OK;
    conclude(terms, b, square, state);
}

void imki_allan_spread(const imki_allan_problem *problem, const imki_allan_state *state,
                       double *covariance)
{
    const size_t terms = problem->terms;
    double *l = problem->factor, *inverse = problem->scaled;
    size_t index[IMKI_ALLAN_TERMS], count = 0;
    memset(covariance, 0, terms * terms * sizeof *covariance);
    for (size_t t = 0; t < terms; t++)
        if (state->active[t] && state->information[t * terms + t] > 0)
            index[count++] = t;
    double scale[IMKI_ALLAN_TERMS];
    for (size_t i = 0; i < count; i++)
        scale[i] = 1 / sqrt(state->information[index[i] * terms + index[i]]);
    for (size_t i = 0; i < count; i++)
        for (size_t j = 0; j < count; j++)
            l[i * count + j] =
                scale[i] * scale[j] * state->information[index[i] * terms + index[j]];
    for (size_t i = 0; i < count; i++)
        l[i * count + i] *= 1 + 1e-13;
    if (count == 0 || imk_cholesky_factor(count, l) != IMK_OK)
        return;
    imk_cholesky_inverse(count, l, inverse);
    for (size_t i = 0; i < count; i++)
        for (size_t j = 0; j < count; j++)
            covariance[index[i] * terms + index[j]] = scale[i] * scale[j] * inverse[i * count + j];
}
