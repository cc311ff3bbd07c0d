/* SPDX-License-Identifier: Apache-2.0 */
/* Eigenvalues of a small symmetric matrix by cyclic Jacobi rotations [GOLUB2013, sec. 8.5].
 *
 * An element is done when it is negligible beside the geometric mean of its two diagonal elements,
 * not beside the largest element: so the small eigenvalues of a positive definite matrix come out
 * as accurately as its scaling allows [DEMMEL1992]. */
#include "imukit/linear_algebra.h"

#include <float.h>
#include <math.h>
#include <stdbool.h>

enum { SWEEPS_MAX = 60 };

/* Turn rows and columns p < q of A so that a[p][q] becomes 0, and the columns of v with them. */
static void rotate(size_t n, double *a, double *v, size_t p, size_t q)
{
    const double apq = a[p * n + q];
    /* t = tan of the smaller angle with cot(2 angle) = theta. */
    const double theta = (a[q * n + q] - a[p * n + p]) / (2.0 * apq);
    const double t = copysign(1.0, theta) / (fabs(theta) + hypot(1.0, theta));
    const double c = 1.0 / sqrt(1.0 + t * t);
    const double s = t * c;
    a[p * n + p] -= t * apq;
    a[q * n + q] += t * apq;
    a[p * n + q] = a[q * n + p] = 0.0;
    for (size_t k = 0; k < n; k++) {
        if (k == p || k == q)
            continue;
        const double akp = a[p * n + k], akq = a[q * n + k];
        a[p * n + k] = a[k * n + p] = c * akp - s * akq;
        a[q * n + k] = a[k * n + q] = s * akp + c * akq;
    }
    for (size_t k = 0; v && k < n; k++) {
        const double vkp = v[k * n + p], vkq = v[k * n + q];
        v[k * n + p] = c * vkp - s * vkq;
        v[k * n + q] = s * vkp + c * vkq;
    }
}

/* One sweep over all pairs. @return whether anything had to be turned */
static bool sweep(size_t n, double *a, double *v)
{
    bool turned = false;
    for (size_t p = 0; p + 1 < n; p++) {
        for (size_t q = p + 1; q < n; q++) {
            const double small = sqrt(fabs(a[p * n + p])) * sqrt(fabs(a[q * n + q]));
            if (a[p * n + q] == 0.0 || fabs(a[p * n + q]) <= 0.25 * DBL_EPSILON * small)
                continue;
            rotate(n, a, v, p, q);
            turned = true;
        }
    }
    return turned;
}

static void sort_ascending(size_t n, double *eigenvalues, double *v)
{
    for (size_t i = 0; i + 1 < n; i++) {
        size_t smallest = i;
        for (size_t j = i + 1; j < n; j++) {
            if (eigenvalues[j] < eigenvalues[smallest])
                smallest = j;
        }
        const double value = eigenvalues[i];
        eigenvalues[i] = eigenvalues[smallest];
        eigenvalues[smallest] = value;
        for (size_t k = 0; v && k < n; k++) {
            const double element = v[k * n + i];
            v[k * n + i] = v[k * n + smallest];
            v[k * n + smallest] = element;
        }
    }
}

imk_status imk_symmetric_eigen(size_t n, double *a, double *eigenvalues, double *v)
{
    for (size_t i = 0; i < n; i++) {
        for (size_t j = 0; j < n; j++) {
            if (!isfinite(a[i * n + j]))
                return IMK_ERROR_NOT_FINITE;
        }
    }
    for (size_t i = 0; v && i < n * n; i++)
        v[i] = i % (n + 1) == 0 ? 1.0 : 0.0;
    int sweeps = 0;
    while (sweep(n, a, v)) {
        if (++sweeps == SWEEPS_MAX)
            return IMK_ERROR_NO_CONVERGENCE;
    }
    for (size_t i = 0; i < n; i++)
        eigenvalues[i] = a[i * n + i];
    sort_ascending(n, eigenvalues, v);
    return IMK_OK;
}
