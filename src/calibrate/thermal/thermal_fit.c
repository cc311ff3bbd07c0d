/* SPDX-License-Identifier: Apache-2.0 */
/* Fits of some of the columns to one axis: equal weights, and the uncertainty that the correlated
 * noise gives them,
 *
 *     b = (X^T X)^-1 X^T y,     cov b = (X^T X)^-1 X^T V X (X^T X)^-1,
 *     V = white D + flicker F + walk R      (thermal_noise.c)
 *
 * Weights by V^-1 would be the best if the residual were noise only. It is not: what a polynomial
 * and a loop cannot follow looks like slow noise, whose V^-1 gives the long way of the curve away
 * for its short way. Equal weights leave the smallest residual, and cost little where the noise is
 * what it should be.
 *
 * Cross-validation leaves out stretches of time S. The error of predicting them from a fit to the
 * rest follows from the residuals r of the fit to all,
 *
 *     e_S = (I - H_SS)^-1 r_S,     H = X (X^T X)^-1 X^T      [COOK1982] */
#include "imukit/linear_algebra.h"
#include "thermal_internal.h"

#include <math.h>
#include <string.h>

enum { N = IMKI_THERMAL_COLUMNS };

size_t imki_thermal_list(unsigned mask, int index[N])
{
    size_t q = 0;
    for (int c = 0; c < N; c++)
        if (mask >> c & 1u)
            index[q++] = c;
    return q;
}

/* Element i, j of X^T V X. */
static double noise_moment(const imki_thermal_work *work, int axis, int i, int j)
{
    const imki_thermal_variance *v = &work->variance[axis];
    return v->white * work->white_moment[i * N + j] + v->flicker * work->flicker_moment[i * N + j] +
           v->walk * work->walk_moment[i * N + j];
}

/* r^T M r */
static double quadratic(size_t q, const int *index, const double *r, const double *moment)
{
    double sum = 0.0;
    for (size_t i = 0; i < q; i++)
        for (size_t j = 0; j < q; j++)
            sum += r[i] * r[j] * moment[index[i] * N + index[j]];
    return sum;
}

bool imki_thermal_fit(const imki_thermal_work *work, int axis, unsigned mask,
                      imki_thermal_estimate *estimate)
{
    int index[N];
    double a[N * N], inverse[N * N], half[N * N];
    const size_t q = imki_thermal_list(mask & work->available, index);
    for (size_t i = 0; i < q; i++)
        for (size_t j = 0; j < q; j++)
            a[i * q + j] = work->square_moment[index[i] * N + index[j]];
    if (imk_cholesky_factor(q, a) != IMK_OK)
        return false;
    imk_cholesky_inverse(q, a, inverse);
    memset(estimate, 0, sizeof *estimate);
    for (int c = 0; c < N; c++)
        estimate->chance[c] = 1.0;
    for (size_t i = 0; i < q; i++)
        for (size_t j = 0; j < q; j++) {
            estimate->value[index[i]] += inverse[i * q + j] * work->reading_moment[axis][index[j]];
            half[i * q + j] = 0.0;
            for (size_t k = 0; k < q; k++)
                half[i * q + j] +=
                    inverse[i * q + k] * noise_moment(work, axis, index[k], index[j]);
        }
    for (size_t i = 0; i < q; i++)
        for (size_t j = 0; j < q; j++)
            for (size_t k = 0; k < q; k++)
                estimate->covariance[index[i] * N + index[j]] +=
                    half[i * q + k] * inverse[k * q + j];
    for (size_t i = 0; i < q; i++) {
        const double *r = inverse + i * q;
        const double value = estimate->value[index[i]];
        estimate->chance[index[i]] = imki_thermal_chance(
            work, axis, value * value, quadratic(q, index, r, work->white_moment),
            quadratic(q, index, r, work->flicker_moment),
            quadratic(q, index, r, work->walk_moment));
    }
    return true;
}

/* ---- cross-validation ------------------------------------------------------------------------ */

enum { FOLD_MAX = IMKI_THERMAL_BLOCKS / IMKI_THERMAL_FOLDS + 1 };

typedef struct whole {
    size_t q;
    int index[N];
    double l[N * N]; /* factor of X^T X */
    double residual[IMKI_THERMAL_BLOCKS];
} whole;

static bool fit_whole(const imki_thermal_work *work, int axis, unsigned mask, whole *f)
{
    const imki_thermal_blocks *blocks = &work->blocks;
    double b[N];
    f->q = imki_thermal_list(mask & work->available, f->index);
    for (size_t i = 0; i < f->q; i++) {
        for (size_t j = 0; j < f->q; j++)
            f->l[i * f->q + j] = work->square_moment[f->index[i] * N + f->index[j]];
        b[i] = work->reading_moment[axis][f->index[i]];
    }
    if (imk_cholesky_factor(f->q, f->l) != IMK_OK)
        return false;
    imk_cholesky_solve(f->q, f->l, b);
    for (size_t i = 0; i < blocks->count; i++) {
        f->residual[i] = blocks->reading[axis][i];
        for (size_t c = 0; c < f->q; c++)
            f->residual[i] -= b[c] * blocks->column[f->index[c]][i];
    }
    return true;
}

/* Mean square error of predicting blocks begin … end - 1 from the others. */
static double fold_error(const imki_thermal_work *work, const whole *f, size_t begin, size_t end)
{
    const size_t m = end - begin;
    double p[FOLD_MAX * FOLD_MAX], e[FOLD_MAX], square = 0.0;
    for (size_t i = 0; i < m; i++) {
        double row[N];
        for (size_t c = 0; c < f->q; c++)
            row[c] = work->blocks.column[f->index[c]][begin + i];
        imk_cholesky_solve(f->q, f->l, row);
        for (size_t j = 0; j < m; j++) {
            p[i * m + j] = i == j;
            for (size_t c = 0; c < f->q; c++)
                p[i * m + j] -= row[c] * work->blocks.column[f->index[c]][begin + j];
        }
        e[i] = f->residual[begin + i];
    }
    if (imk_cholesky_factor(m, p) != IMK_OK)
        return (double)INFINITY; /* the rest does not determine the fit */
    imk_cholesky_solve(m, p, e);
    for (size_t i = 0; i < m; i++)
        square += e[i] * e[i] / (double)m;
    return square;
}

void imki_thermal_validate(const imki_thermal_work *work, int axis, unsigned mask,
                           double error[IMKI_THERMAL_FOLDS])
{
    whole f;
    const size_t n = work->blocks.count;
    const bool fits = fit_whole(work, axis, mask, &f);
    for (size_t fold = 0; fold < IMKI_THERMAL_FOLDS; fold++)
        error[fold] = fits ? fold_error(work, &f, n * fold / IMKI_THERMAL_FOLDS,
                                        n * (fold + 1) / IMKI_THERMAL_FOLDS)
                           : (double)INFINITY;
}
