/* SPDX-License-Identifier: Apache-2.0 */
/* What information is worth. Parameters have different units and some are not determined at first,
 * so a little is added to each, R = 1e-8 of the most that a single step tells about it, and
 * everything is scaled by it:
 *
 *     A = R^-1/2 F R^-1/2 + I,     log det A,     sigma_p^2 = (A^-1)_pp/R_pp
 *
 * A parameter whose sigma is that of R alone, within a hundredth part, is not determined. */
#include "plan_internal.h"

#include "imukit/linear_algebra.h"

#include <math.h>

void imki_plan_regularise(size_t n, const double *most, double *regular)
{
    for (size_t p = 0; p < n; p++)
        regular[p] = most[p] > 0.0 ? 1e-8 * most[p] : 1.0;
}

static void scale(size_t n, const double *information, const double *regular, double *scaled)
{
    for (size_t p = 0; p < n; p++)
        for (size_t q = 0; q < n; q++)
            scaled[p * n + q] =
                information[p * n + q] / sqrt(regular[p] * regular[q]) + (p == q ? 1.0 : 0.0);
}

double imki_plan_log_determinant(size_t n, const double *information, const double *regular,
                                 double *work)
{
    scale(n, information, regular, work);
    return imk_cholesky_factor(n, work) == IMK_OK ? imk_cholesky_log_determinant(n, work)
                                                  : -(double)INFINITY;
}

void imki_plan_sigmas(size_t n, const double *information, const double *regular, double *work,
                      double *sigma)
{
    scale(n, information, regular, work);
    const bool valid = imk_cholesky_factor(n, work) == IMK_OK;
    if (valid)
        imk_cholesky_inverse(n, work, work + n * n);
    for (size_t p = 0; p < n; p++) {
        const double variance = valid ? work[n * n + p * n + p] : 1.0;
        sigma[p] = variance < 0.01 ? sqrt(variance / regular[p]) : (double)NAN;
    }
}
