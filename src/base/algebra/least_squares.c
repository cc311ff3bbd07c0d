/* SPDX-License-Identifier: Apache-2.0 */
/* Bounded nonlinear least squares, minimise |r(x)|^2/2 for lower <= x <= upper.
 *
 * Each step s solves the damped linear problem of Levenberg and Marquardt over the parameters that
 * are free,
 *
 *     | J s + r |^2 + lambda | D s |^2  ->  min,    by QR of [ J ; sqrt(lambda) D ],
 *
 * with D the largest column norms of J so far, which makes the method independent of the units of
 * the parameters [MORE1978]. A parameter is held when it stands at a bound and the gradient points
 * out of it; a step that leaves the box is cut back to it, and is assessed, as cut, by the ratio of
 * the actual to the predicted decrease, which also governs lambda [NIELSEN1999]. */
#include "imukit/least_squares.h"

#include "base/workspace_internal.h"
#include "imukit/linear_algebra.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum { PARAMETERS_MAX = 64, COOKIE = 0x1EA57 };

/* Below this share of the starting cost the residuals are rounding errors. */
static const double negligible_cost = 1e-30;

typedef struct solver {
    const imk_least_squares *problem;
    size_t n, m;           /* parameters, residuals */
    double *x, *trial;     /* best point, and the one tried */
    double *r, *trial_r;   /* residuals there */
    double *jacobian;      /* at x: m x n */
    double *gradient;      /* J^T r */
    double *scale;         /* D */
    double *step;          /* trial - x */
    double *reduced;       /* R and Q^T r of J over the free parameters: max(m, n) x n */
    double *reduced_rhs;   /* max(m, n) */
    double *damped;        /* [R ; sqrt(lambda) D]: 2n x n */
    double *damped_rhs;    /* 2n */
    double *beta, *solved; /* n each */
    size_t free_index[PARAMETERS_MAX];
    size_t free_count;
    double cost;
    imk_least_squares_result result;
} solver;

static size_t larger(size_t a, size_t b)
{
    return a > b ? a : b;
}

imk_least_squares imk_least_squares_default(void)
{
    return (imk_least_squares){
        .cookie = COOKIE, .tolerance_cost = 1e-12, .tolerance_step = 1e-10, .max_iterations = 100};
}

size_t imk_least_squares_workspace_size(const imk_least_squares *problem)
{
    const size_t n = problem->parameter_count, m = problem->residual_count;
    if (n == 0 || n > PARAMETERS_MAX || m > SIZE_MAX / sizeof(double) / (4 * PARAMETERS_MAX))
        return 0;
    const size_t doubles = 7 * n + 2 * m + m * n + larger(m, n) * (n + 1) + 2 * n * (n + 1);
    return doubles * sizeof(double) + IMKI_ALIGNMENT_SLACK;
}

static double *take(double **next, size_t count)
{
    double *const part = *next;
    *next += count;
    return part;
}

static void divide_workspace(solver *s, void *workspace)
{
    double *next = imki_align(workspace);
    s->trial = take(&next, s->n);
    s->r = take(&next, s->m);
    s->trial_r = take(&next, s->m);
    s->jacobian = take(&next, s->m * s->n);
    s->gradient = take(&next, s->n);
    s->scale = take(&next, s->n);
    s->step = take(&next, s->n);
    s->reduced = take(&next, larger(s->m, s->n) * s->n);
    s->reduced_rhs = take(&next, larger(s->m, s->n));
    s->damped = take(&next, 2 * s->n * s->n);
    s->damped_rhs = take(&next, 2 * s->n);
    s->beta = take(&next, s->n);
    s->solved = take(&next, s->n);
}

static double lower_bound(const solver *s, size_t j)
{
    return s->problem->lower ? s->problem->lower[j] : -(double)INFINITY;
}

static double upper_bound(const solver *s, size_t j)
{
    return s->problem->upper ? s->problem->upper[j] : (double)INFINITY;
}

static double clip(const solver *s, size_t j, double x)
{
    return fmin(fmax(x, lower_bound(s, j)), upper_bound(s, j));
}

static double half_square(size_t count, const double *r)
{
    double sum = 0.0;
    for (size_t i = 0; i < count; i++)
        sum += r[i] * r[i];
    return 0.5 * sum;
}

/* Residuals at x and their cost; a cost that is not finite is a failed evaluation. */
static imk_status evaluate(solver *s, const double *x, double *r, double *jacobian, double *cost)
{
    s->result.evaluations++;
    const imk_status status = s->problem->residuals(s->problem->context, x, r, jacobian);
    if (status != IMK_OK)
        return status;
    *cost = half_square(s->m, r);
    return IMK_OK;
}

/* Jacobian at x by forward differences, inwards where the bound is near. The increment balances
 * the rounding of r against the curvature. */
static imk_status difference(solver *s)
{
    const double root_epsilon = 1.4901161193847656e-08;
    memcpy(s->trial, s->x, s->n * sizeof *s->x);
    for (size_t j = 0; j < s->n; j++) {
        double h = root_epsilon * fabs(s->x[j]);
        h = h > 0.0 ? h : root_epsilon;
        if (s->x[j] + h > upper_bound(s, j))
            h = -h;
        if (s->x[j] + h < lower_bound(s, j))
            h = 0.0; /* the box is thinner than the increment: the parameter is as good as fixed */
        s->trial[j] = s->x[j] + h;
        h = s->trial[j] - s->x[j];
        double cost = 0.0;
        if (h != 0.0) {
            const imk_status status = evaluate(s, s->trial, s->trial_r, NULL, &cost);
            if (status != IMK_OK)
                return status;
        }
        for (size_t i = 0; i < s->m; i++)
            s->jacobian[i * s->n + j] = h != 0.0 ? (s->trial_r[i] - s->r[i]) / h : 0.0;
        s->trial[j] = s->x[j];
    }
    return IMK_OK;
}

/* Jacobian at x (if not there already), gradient and scales. */
static imk_status linearise(solver *s)
{
    imk_status status = IMK_OK;
    double cost;
    if (s->problem->has_jacobian)
        status = evaluate(s, s->x, s->r, s->jacobian, &cost);
    else
        status = difference(s);
    if (status != IMK_OK)
        return status;
    memset(s->gradient, 0, s->n * sizeof *s->gradient);
    memset(s->solved, 0, s->n * sizeof *s->solved);
    for (size_t i = 0; i < s->m; i++) {
        for (size_t j = 0; j < s->n; j++) {
            const double element = s->jacobian[i * s->n + j];
            s->gradient[j] += element * s->r[i];
            s->solved[j] += element * element;
        }
    }
    for (size_t j = 0; j < s->n; j++) {
        if (!isfinite(s->solved[j]) || !isfinite(s->gradient[j]))
            return IMK_ERROR_NOT_FINITE;
        s->scale[j] = fmax(s->scale[j], sqrt(s->solved[j]));
    }
    return IMK_OK;
}

/* The parameters not held at a bound, and whether any of them has a slope left: the cosine between
 * r and a column of J, beside rounding. */
static bool find_free(solver *s)
{
    bool slope = false;
    s->free_count = 0;
    for (size_t j = 0; j < s->n; j++) {
        const bool held = (s->x[j] <= lower_bound(s, j) && s->gradient[j] >= 0.0) ||
                          (s->x[j] >= upper_bound(s, j) && s->gradient[j] <= 0.0);
        if (held)
            continue;
        s->free_index[s->free_count++] = j;
        const double column = sqrt(s->solved[j]); /* left there by linearise() */
        slope = slope || fabs(s->gradient[j]) > 4.0 * DBL_EPSILON * column * sqrt(2.0 * s->cost);
    }
    return slope;
}

/* QR of J over the free parameters; R and the top of Q^T r stay in `reduced`. */
static imk_status reduce(solver *s)
{
    const size_t k = s->free_count;
    for (size_t i = 0; i < s->m; i++) {
        for (size_t j = 0; j < k; j++)
            s->reduced[i * k + j] = s->jacobian[i * s->n + s->free_index[j]];
        s->reduced_rhs[i] = s->r[i];
    }
    const size_t rows = larger(s->m, k);
    for (size_t i = s->m; i < rows; i++) {
        memset(s->reduced + i * k, 0, k * sizeof *s->reduced);
        s->reduced_rhs[i] = 0.0;
    }
    const imk_status status = imk_qr_factor(rows, k, s->reduced, s->beta);
    if (status == IMK_OK) /* a singular R is what the damping is for; only Q^T r is wanted */
        (void)imk_qr_solve(rows, k, s->reduced, s->beta, s->reduced_rhs, s->solved);
    return status;
}

/* Damped step to `trial`, cut to the box. @return predicted decrease of the cost */
static imk_status damped_step(solver *s, double lambda, double *predicted)
{
    const size_t k = s->free_count;
    memset(s->damped, 0, 2 * k * k * sizeof *s->damped);
    for (size_t i = 0; i < k; i++) {
        const double scale = s->scale[s->free_index[i]];
        memcpy(s->damped + i * k + i, s->reduced + i * k + i, (k - i) * sizeof *s->damped);
        s->damped[(k + i) * k + i] = sqrt(lambda) * (scale > 0.0 ? scale : 1.0);
        s->damped_rhs[i] = -s->reduced_rhs[i];
        s->damped_rhs[k + i] = 0.0;
    }
    imk_status status = imk_qr_factor(2 * k, k, s->damped, s->beta);
    if (status == IMK_OK)
        status = imk_qr_solve(2 * k, k, s->damped, s->beta, s->damped_rhs, s->solved);
    if (status != IMK_OK)
        return status;
    memcpy(s->trial, s->x, s->n * sizeof *s->x);
    memset(s->step, 0, s->n * sizeof *s->step);
    double slope = 0.0;
    for (size_t i = 0; i < k; i++) {
        const size_t j = s->free_index[i];
        s->trial[j] = clip(s, j, s->x[j] + s->solved[i]);
        s->step[j] = s->trial[j] - s->x[j];
        slope += s->gradient[j] * s->step[j];
    }
    double curvature = 0.0;
    for (size_t row = 0; row < s->m; row++) {
        double change = 0.0;
        for (size_t j = 0; j < s->n; j++)
            change += s->jacobian[row * s->n + j] * s->step[j];
        curvature += change * change;
    }
    *predicted = -slope - 0.5 * curvature;
    return IMK_OK;
}

static bool step_is_small(const solver *s)
{
    double step = 0.0, size = 0.0;
    for (size_t j = 0; j < s->n; j++) {
        step = fmax(step, s->scale[j] * fabs(s->step[j]));
        size = fmax(size, s->scale[j] * fabs(s->x[j]));
    }
    return step <= s->problem->tolerance_step * size;
}

/* From one accepted point to the next.
 * @return IMK_OK with *done set when the point is the solution */
static imk_status advance(solver *s, double *lambda, double *growth, bool *done)
{
    while (s->result.iterations < s->problem->max_iterations) {
        double predicted, cost = 0.0;
        s->result.iterations++;
        imk_status status = damped_step(s, *lambda, &predicted);
        if (status == IMK_OK) {
            const bool small = step_is_small(s);
            status = evaluate(s, s->trial, s->trial_r, NULL, &cost);
            if (status != IMK_OK)
                return status;
            const double actual = s->cost - cost; /* NaN is rejected below */
            const double ratio = actual / predicted;
            const double limit = s->problem->tolerance_cost * s->cost;
            *done = small || (fabs(actual) <= limit && predicted <= limit && ratio <= 2.0);
            if (ratio > 1e-4 && predicted > 0.0 && cost < s->cost) {
                memcpy(s->x, s->trial, s->n * sizeof *s->x);
                memcpy(s->r, s->trial_r, s->m * sizeof *s->r);
                s->cost = cost;
                const double ease = 2.0 * ratio - 1.0;
                *lambda = fmax(*lambda * fmax(1.0 / 3.0, 1.0 - ease * ease * ease), 1e-16);
                *growth = 2.0;
                return IMK_OK;
            }
            if (*done)
                return IMK_OK;
        }
        *lambda *= *growth;
        *growth *= 2.0;
        if (!(*lambda < 1e200)) {
            *done = true; /* no step however short helps: a minimum to rounding */
            return IMK_OK;
        }
    }
    return IMK_ERROR_NO_CONVERGENCE;
}

static imk_status minimise(solver *s)
{
    double lambda = 1e-3, growth = 2.0;
    bool done = false;
    imk_status status = evaluate(s, s->x, s->r, NULL, &s->cost);
    if (status != IMK_OK)
        return status;
    if (!isfinite(s->cost))
        return IMK_ERROR_NOT_FINITE;
    s->result.initial_cost = s->cost;
    for (;;) {
        status = linearise(s);
        if (status != IMK_OK)
            return status;
        const bool slope = find_free(s);
        if (done || !slope || s->cost <= negligible_cost * s->result.initial_cost)
            return IMK_OK;
        status = reduce(s);
        if (status == IMK_OK)
            status = advance(s, &lambda, &growth, &done);
        if (status != IMK_OK)
            return status;
    }
}

/* (J^T J)^-1 over the free parameters, spread over the full matrix. */
static imk_status covariance_of(solver *s, double *covariance)
{
    const size_t k = s->free_count;
    if (k > 0) {
        if (s->m < k)
            return IMK_ERROR_SINGULAR;
        imk_status status = reduce(s);
        if (status == IMK_OK)
            status = imk_qr_covariance(s->m, k, s->reduced, s->damped);
        if (status != IMK_OK)
            return IMK_ERROR_SINGULAR;
    }
    memset(covariance, 0, s->n * s->n * sizeof *covariance);
    for (size_t i = 0; i < k; i++) {
        for (size_t j = 0; j < k; j++)
            covariance[s->free_index[i] * s->n + s->free_index[j]] = s->damped[i * k + j];
    }
    return IMK_OK;
}

static imk_status check(const imk_least_squares *problem, const double *x, void *workspace,
                        size_t workspace_size)
{
    const size_t needed = imk_least_squares_workspace_size(problem);
    size_t movable = 0;
    if (needed == 0 || !problem->residuals || !x || !workspace || problem->max_iterations < 1 ||
        !(problem->tolerance_cost >= 0.0) || !(problem->tolerance_step >= 0.0))
        return IMK_ERROR_ARGUMENT;
    if (workspace_size < needed)
        return IMK_ERROR_WORKSPACE;
    for (size_t j = 0; j < problem->parameter_count; j++) {
        const double lower = problem->lower ? problem->lower[j] : -(double)INFINITY;
        const double upper = problem->upper ? problem->upper[j] : (double)INFINITY;
        if (!(lower <= upper))
            return IMK_ERROR_ARGUMENT;
        if (!isfinite(x[j]))
            return IMK_ERROR_NOT_FINITE;
        movable += lower < upper;
    }
    return problem->residual_count >= movable ? IMK_OK : IMK_ERROR_ARGUMENT;
}

imk_status imk_least_squares_solve(const imk_least_squares *problem, double *x, double *covariance,
                                   imk_least_squares_result *result, void *workspace,
                                   size_t workspace_size)
{
    if (!problem)
        return IMK_ERROR_ARGUMENT;
    if (problem->cookie != COOKIE)
        return IMK_ERROR_UNINITIALISED;
    imk_status status = check(problem, x, workspace, workspace_size);
    if (status != IMK_OK)
        return status;
    double start[PARAMETERS_MAX];
    solver s = {.problem = problem,
                .n = problem->parameter_count,
                .m = problem->residual_count,
                .x = x,
                .cost = (double)NAN};
    divide_workspace(&s, workspace);
    memset(s.scale, 0, s.n * sizeof *s.scale);
    memcpy(start, x, s.n * sizeof *x);
    for (size_t j = 0; j < s.n; j++)
        x[j] = clip(&s, j, x[j]);
    status = minimise(&s);
    if (!isfinite(s.cost)) { /* nothing was found: leave the start as it was */
        memcpy(x, start, s.n * sizeof *x);
        return status;
    }
    if (result) {
        s.result.cost = s.cost;
        s.result.free_parameters = (int)s.free_count;
        *result = s.result;
    }
    if (status == IMK_OK && covariance)
        status = covariance_of(&s, covariance);
    return status;
}
