/* SPDX-License-Identifier: Apache-2.0 */
/* Householder QR and what least squares needs of it [GOLUB2013, alg. 5.1.1, 5.2.1].
 *
 * Reflector k is I - beta v v^T with v[k] = 1 and the rest of v below the diagonal of column k. */
#include "imukit/linear_algebra.h"

#include <float.h>
#include <math.h>
#include <stdbool.h>

/* Norm of `count` numbers, `stride` apart, without overflow. */
static double column_norm(size_t count, const double *x, size_t stride)
{
    double sum = 0.0, largest = 0.0;
    for (size_t i = 0; i < count; i++)
        sum += x[i * stride] * x[i * stride];
    if (sum > 1e-280 && sum < 1e280)
        return sqrt(sum);
    for (size_t i = 0; i < count; i++)
        largest = fmax(largest, fabs(x[i * stride]));
    if (isnan(sum) || !(largest > 0.0) || isinf(largest))
        return isnan(sum) ? sum : largest;
    sum = 0.0;
    for (size_t i = 0; i < count; i++)
        sum += (x[i * stride] / largest) * (x[i * stride] / largest);
    return largest * sqrt(sum);
}

imk_status imk_qr_factor(size_t rows, size_t columns, double *a, double *beta)
{
    if (rows < columns)
        return IMK_ERROR_ARGUMENT;
    for (size_t k = 0; k < columns; k++) {
        double *const top = a + k * columns + k;
        const double norm = column_norm(rows - k, top, columns);
        if (!isfinite(norm))
            return IMK_ERROR_NOT_FINITE;
        beta[k] = 0.0;
        if (norm == 0.0)
            continue;
        /* The sign that adds: v0 = x0 + sign(x0) |x| does not cancel. */
        const double alpha = *top < 0.0 ? norm : -norm;
        const double v0 = *top - alpha;
        for (size_t i = k + 1; i < rows; i++)
            a[i * columns + k] /= v0;
        *top = alpha;
        beta[k] = -v0 / alpha;
        /* w = beta v^T A over the columns to the right, kept in the part of beta not yet used. */
        for (size_t j = k + 1; j < columns; j++)
            beta[j] = a[k * columns + j];
        for (size_t i = k + 1; i < rows; i++) {
            const double v = a[i * columns + k];
            for (size_t j = k + 1; j < columns; j++)
                beta[j] += v * a[i * columns + j];
        }
        for (size_t j = k + 1; j < columns; j++) {
            beta[j] *= beta[k];
            a[k * columns + j] -= beta[j];
        }
        for (size_t i = k + 1; i < rows; i++) {
            const double v = a[i * columns + k];
            for (size_t j = k + 1; j < columns; j++)
                a[i * columns + j] -= v * beta[j];
        }
    }
    return IMK_OK;
}

/* A diagonal element of R that is rounding error beside the largest. */
static bool is_singular(size_t rows, size_t columns, const double *qr)
{
    double largest = 0.0;
    for (size_t k = 0; k < columns; k++)
        largest = fmax(largest, fabs(qr[k * columns + k]));
    for (size_t k = 0; k < columns; k++) {
        if (!(fabs(qr[k * columns + k]) > (double)rows * DBL_EPSILON * largest))
            return true;
    }
    return false;
}

imk_status imk_qr_solve(size_t rows, size_t columns, const double *qr, const double *beta,
                        double *b, double *x)
{
    if (rows < columns)
        return IMK_ERROR_ARGUMENT;
    for (size_t k = 0; k < columns; k++) {
        double sum = b[k];
        for (size_t i = k + 1; i < rows; i++)
            sum += qr[i * columns + k] * b[i];
        sum *= beta[k];
        b[k] -= sum;
        for (size_t i = k + 1; i < rows; i++)
            b[i] -= sum * qr[i * columns + k];
    }
    if (is_singular(rows, columns, qr))
        return IMK_ERROR_SINGULAR;
    for (size_t k = columns; k-- > 0;) {
        double sum = b[k];
        for (size_t j = k + 1; j < columns; j++)
            sum -= qr[k * columns + j] * x[j];
        x[k] = sum / qr[k * columns + k];
    }
    return IMK_OK;
}

imk_status imk_qr_covariance(size_t rows, size_t columns, const double *qr, double *covariance)
{
    const size_t n = columns;
    if (rows < columns)
        return IMK_ERROR_ARGUMENT;
    if (is_singular(rows, columns, qr))
        return IMK_ERROR_SINGULAR;
    /* R^-1 in the upper triangle, */
    for (size_t j = 0; j < n; j++) {
        covariance[j * n + j] = 1.0 / qr[j * n + j];
        for (size_t i = j; i-- > 0;) {
            double sum = 0.0;
            for (size_t k = i + 1; k <= j; k++)
                sum += qr[i * n + k] * covariance[k * n + j];
            covariance[i * n + j] = -sum / qr[i * n + i];
        }
    }
    /* then R^-1 R^-T from the top: element (i, j) needs the columns from j on only. */
    for (size_t i = 0; i < n; i++) {
        for (size_t j = i; j < n; j++) {
            double sum = 0.0;
            for (size_t k = j; k < n; k++)
                sum += covariance[i * n + k] * covariance[j * n + k];
            covariance[i * n + j] = sum;
        }
    }
    for (size_t i = 0; i < n; i++) {
        for (size_t j = 0; j < i; j++)
            covariance[i * n + j] = covariance[j * n + i];
    }
    return IMK_OK;
}
