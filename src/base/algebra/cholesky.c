/* SPDX-License-Identifier: Apache-2.0 */
/* Cholesky factorisation A = L L^T of a small symmetric positive definite matrix, by rows:
 *
 *     l[i][j] = (a[i][j] - sum_{k<j} l[i][k] l[j][k]) / l[j][j]
 *     l[i][i] = sqrt(a[i][i] - sum_{k<i} l[i][k]^2)                    [GOLUB2013, sec. 4.2] */
#include "imukit/elementary.h"
#include "imukit/linear_algebra.h"

#include "vector_internal.h"

#include <float.h>
#include <math.h>

imk_status imk_cholesky_factor(size_t n, double *a)
{
    for (size_t i = 0; i < n; i++) {
        double *row = a + i * n;
        const double diagonal = row[i];
        for (size_t j = 0; j < i; j++)
            row[j] = (row[j] - imki_dot(j, row, a + j * n)) / a[j * n + j];
        const double pivot = diagonal - imki_dot(i, row, row);
        /* A pivot this small beside its diagonal element is made of rounding errors only. */
        if (!(pivot > DBL_EPSILON * diagonal) || !isfinite(pivot))
            return IMK_ERROR_SINGULAR;
        row[i] = sqrt(pivot);
        for (size_t j = i + 1; j < n; j++)
            row[j] = 0.0;
    }
    return IMK_OK;
}

void imk_cholesky_solve(size_t n, const double *l, double *b)
{
    for (size_t i = 0; i < n; i++)
        b[i] = (b[i] - imki_dot(i, l + i * n, b)) / l[i * n + i];
    for (size_t i = n; i-- > 0;) {
        b[i] /= l[i * n + i];
        for (size_t j = 0; j < i; j++)
            b[j] -= l[i * n + j] * b[i];
    }
}

void imk_cholesky_inverse(size_t n, const double *l, double *inverse)
{
    /* L^-1 in the lower triangle, column by column, */
    for (size_t j = 0; j < n; j++) {
        inverse[j * n + j] = 1.0 / l[j * n + j];
        for (size_t i = j + 1; i < n; i++) {
            double sum = 0.0;
            for (size_t k = j; k < i; k++)
                sum += l[i * n + k] * inverse[k * n + j];
            inverse[i * n + j] = -sum / l[i * n + i];
        }
    }
    /* then A^-1 = L^-T L^-1 from the top: row i needs the rows of L^-1 from i on only. */
    for (size_t i = 0; i < n; i++) {
        for (size_t j = 0; j <= i; j++) {
            double sum = 0.0;
            for (size_t k = i; k < n; k++)
                sum += inverse[k * n + i] * inverse[k * n + j];
            inverse[i * n + j] = sum;
        }
    }
    for (size_t i = 0; i < n; i++) {
        for (size_t j = i + 1; j < n; j++)
            inverse[i * n + j] = inverse[j * n + i];
    }
}

double imk_cholesky_log_determinant(size_t n, const double *l)
{
    double sum = 0.0;
    for (size_t i = 0; i < n; i++)
        sum += imk_ln(l[i * n + i]);
    return 2.0 * sum;
}
