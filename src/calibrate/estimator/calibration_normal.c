/* SPDX-License-Identifier: Apache-2.0 */
/* Normal equations of the estimator: a banded matrix A of the local unknowns, bordered by E, and
 * the globals C:
 *
 *     | A    E | |da|   |ga|        A = L L^T,  Y = L^-1 E,  S = C - Y^T Y
 *     | E^T  C | |dc| = |gc|        dc = S^-1 (gc - Y^T L^-1 ga),  da = L^-T (L^-1 ga - Y dc)
 *
 * [BJORCK1996, sec. 6.3]. The covariance is S^-1 for the globals; of the locals only what a row can
 * reach is needed, A^-1 within its band, by the recursion
 *
 *     Z_ij = (1/L_ii) (delta_ij/L_ii - sum over k > i within the band of L_ki Z_kj),
 *
 * from the last row up [TAKAHASHI1973]. */
#include "estimator_internal.h"

#include "imukit/elementary.h"
#include "imukit/linear_algebra.h"

#include <math.h>
#include <string.h>

static size_t least(size_t a, size_t b)
{
    return a < b ? a : b;
}

/* Element (i, j), i - width <= j <= i, of a band. */
static inline size_t at(const imki_normal *n, size_t i, size_t j)
{
    return i * (n->width + 1) + n->width + j - i;
}

void imki_normal_clear(imki_normal *n)
{
    memset(n->band, 0, n->locals * (n->width + 1) * sizeof *n->band);
    memset(n->border, 0, n->locals * n->globals * sizeof *n->border);
    memset(n->core, 0, n->globals * n->globals * sizeof *n->core);
    memset(n->local_gradient, 0, n->locals * sizeof *n->local_gradient);
    memset(n->global_gradient, 0, n->globals * sizeof *n->global_gradient);
}

void imki_normal_add(imki_normal *n, const imki_row *row, double information)
{
    for (int a = 0; a < row->locals; a++) {
        const size_t i = row->local[a];
        const double weighted = information * row->by_local[a];
        n->local_gradient[i] += weighted * row->residual;
        for (int b = 0; b < row->locals; b++)
            if (row->local[b] <= i)
                n->band[at(n, i, row->local[b])] += weighted * row->by_local[b];
        for (int b = 0; b < row->globals; b++)
            n->border[i * n->globals + (size_t)row->global[b]] += weighted * row->by_global[b];
    }
    for (int a = 0; a < row->globals; a++) {
        const size_t i = (size_t)row->global[a];
        const double weighted = information * row->by_global[a];
        n->global_gradient[i] += weighted * row->residual;
        for (int b = 0; b < row->globals; b++)
            n->core[i * n->globals + (size_t)row->global[b]] += weighted * row->by_global[b];
    }
}

static imk_status factor_band(imki_normal *n, double damping)
{
    /* Angles that nothing determines stay where they are: 1 sigma of 1e3 rad about that. */
    const double free_angle = 1e-6;
    for (size_t i = 0; i < n->locals; i++) {
        const size_t first = i > n->width ? i - n->width : 0;
        for (size_t j = first; j <= i; j++) {
            double sum = n->band[at(n, i, j)];
            if (i == j)
                sum += damping * sum + free_angle;
            const size_t from = j > n->width && j - n->width > first ? j - n->width : first;
            for (size_t k = from; k < j; k++)
                sum -= n->factor[at(n, i, k)] * n->factor[at(n, j, k)];
            if (j < i) {
                n->factor[at(n, i, j)] = sum / n->factor[at(n, j, j)];
            } else {
                if (!(sum > 0.0) || !(sum < HUGE_VAL))
                    return IMK_ERROR_SINGULAR;
                n->factor[at(n, i, i)] = sqrt(sum);
            }
        }
    }
    return IMK_OK;
}

/* L^-1 applied to each column of a locals x columns matrix. */
static void forward(const imki_normal *n, size_t columns, double *x)
{
    for (size_t i = 0; i < n->locals; i++) {
        double *row = x + i * columns;
        for (size_t k = i > n->width ? i - n->width : 0; k < i; k++) {
            const double l = n->factor[at(n, i, k)];
            const double *above = x + k * columns;
            for (size_t c = 0; l != 0.0 && c < columns; c++)
                row[c] -= l * above[c];
        }
        const double pivot = 1.0 / n->factor[at(n, i, i)];
        for (size_t c = 0; c < columns; c++)
            row[c] *= pivot;
    }
}

/* L^-T likewise. */
static void backward(const imki_normal *n, size_t columns, double *x)
{
    for (size_t i = n->locals; i-- > 0;) {
        double *row = x + i * columns;
        for (size_t k = i + 1; k < least(n->locals, i + n->width + 1); k++) {
            const double l = n->factor[at(n, k, i)];
            const double *below = x + k * columns;
            for (size_t c = 0; l != 0.0 && c < columns; c++)
                row[c] -= l * below[c];
        }
        const double pivot = 1.0 / n->factor[at(n, i, i)];
        for (size_t c = 0; c < columns; c++)
            row[c] *= pivot;
    }
}

imk_status imki_normal_factor(imki_normal *n, double damping)
{
    const size_t g = n->globals;
    const imk_status status = factor_band(n, damping);
    if (status != IMK_OK)
        return status;
    memcpy(n->half, n->border, n->locals * g * sizeof *n->half);
    forward(n, g, n->half);
    memcpy(n->schur, n->core, g * g * sizeof *n->schur);
    for (size_t i = 0; i < g; i++)
        n->schur[i * g + i] *= 1.0 + damping;
    for (size_t k = 0; k < n->locals; k++) {
        const double *row = n->half + k * g;
        for (size_t i = 0; i < g; i++) {
            const double weight = row[i];
            double *restrict sum = n->schur + i * g;
            for (size_t j = 0; weight != 0.0 && j <= i; j++)
                sum[j] -= weight * row[j];
        }
    }
    return imk_cholesky_factor(g, n->schur);
}

double imki_normal_log_determinant(const imki_normal *n)
{
    double sum = 0.0;
    for (size_t i = 0; i < n->locals; i++)
        sum += 2.0 * imk_ln(n->factor[at(n, i, i)]);
    for (size_t i = 0; i < n->globals; i++)
        sum += 2.0 * imk_ln(n->schur[i * n->globals + i]);
    return sum;
}

void imki_normal_solve(imki_normal *n)
{
    const size_t g = n->globals;
    memcpy(n->local_step, n->local_gradient, n->locals * sizeof *n->local_step);
    memcpy(n->global_step, n->global_gradient, g * sizeof *n->global_step);
    forward(n, 1, n->local_step);
    for (size_t k = 0; k < n->locals; k++)
        for (size_t i = 0; i < g; i++)
            n->global_step[i] -= n->half[k * g + i] * n->local_step[k];
    imk_cholesky_solve(g, n->schur, n->global_step);
    for (size_t k = 0; k < n->locals; k++)
        for (size_t i = 0; i < g; i++)
            n->local_step[k] -= n->half[k * g + i] * n->global_step[i];
    backward(n, 1, n->local_step);
}

static void invert_band(imki_normal *n)
{
    double *z = n->local_inverse;
    for (size_t i = n->locals; i-- > 0;) {
        const size_t last = least(n->locals - 1, i + n->width);
        const double pivot = 1.0 / n->factor[at(n, i, i)];
        for (size_t j = last + 1; j-- > i;) {
            double sum = i == j ? pivot : 0.0;
            for (size_t k = i + 1; k <= last; k++)
                sum -= n->factor[at(n, k, i)] * (k >= j ? z[at(n, k, j)] : z[at(n, j, k)]);
            z[at(n, j, i)] = sum * pivot;
        }
    }
}

void imki_normal_invert(imki_normal *n)
{
    memcpy(n->whole, n->half, n->locals * n->globals * sizeof *n->whole);
    backward(n, n->globals, n->whole);
    invert_band(n);
    imk_cholesky_inverse(n->globals, n->schur, n->covariance);
}

/* The row as the globals see it when the locals have given way: g - (A^-1 E)^T a. @return how many
 * elements are not 0, their places in `place` */
static int project(const imki_normal *n, const imki_row *row, double *seen, int *place)
{
    memset(seen, 0, n->globals * sizeof *seen);
    for (int b = 0; b < row->globals; b++)
        seen[row->global[b]] += row->by_global[b];
    if (row->locals == 0) {
        memcpy(place, row->global, (size_t)row->globals * sizeof *place);
        return row->globals;
    }
    for (int a = 0; a < row->locals; a++) {
        const double *whole = n->whole + row->local[a] * n->globals;
        for (size_t c = 0; c < n->globals; c++)
            seen[c] -= row->by_local[a] * whole[c];
    }
    for (size_t c = 0; c < n->globals; c++)
        place[c] = (int)c;
    return (int)n->globals;
}

/* Cov of the globals applied to a row: by columns, which are rows. */
static void apply_covariance(const imki_normal *n, int count, const int *place, const double *seen,
                             double *moved)
{
    memset(moved, 0, n->globals * sizeof *moved);
    for (int k = 0; k < count; k++) {
        const double weight = seen[place[k]];
        const double *column = n->covariance + (size_t)place[k] * n->globals;
        for (size_t c = 0; weight != 0.0 && c < n->globals; c++)
            moved[c] += weight * column[c];
    }
}

void imki_row_project(const imki_normal *n, const imki_row *row, double *seen)
{
    int place[IMKI_GLOBALS_MAX];
    (void)project(n, row, seen, place);
}

/* The part of the locals. */
double imki_through_locals(const imki_normal *n, const imki_row *x, const imki_row *y)
{
    double sum = 0.0;
    for (int a = 0; a < x->locals; a++)
        for (int b = 0; b < y->locals; b++) {
            const size_t p = x->local[a], q = y->local[b];
            sum += x->by_local[a] * y->by_local[b] *
                   n->local_inverse[p >= q ? at(n, p, q) : at(n, q, p)];
        }
    return sum;
}

void imki_rows_covariance(const imki_normal *n, const imki_row *row, int count, double *matrix,
                          double *by_globals)
{
    double seen[IMKI_ROWS_MAX][IMKI_GLOBALS_MAX], own[IMKI_GLOBALS_MAX];
    int place[IMKI_ROWS_MAX][IMKI_GLOBALS_MAX], places[IMKI_ROWS_MAX];
    for (int i = 0; i < count; i++) {
        double *moved = by_globals ? by_globals + (size_t)i * n->globals : own;
        places[i] = project(n, &row[i], seen[i], place[i]);
        apply_covariance(n, places[i], place[i], seen[i], moved);
        for (int k = 0; k <= i; k++) {
            double sum = imki_through_locals(n, &row[i], &row[k]);
            for (int c = 0; c < places[k]; c++)
                sum += moved[place[k][c]] * seen[k][place[k][c]];
            matrix[i * count + k] = matrix[k * count + i] = sum;
        }
    }
}
