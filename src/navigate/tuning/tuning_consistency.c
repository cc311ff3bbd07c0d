/* SPDX-License-Identifier: Apache-2.0 */
/* How a filter's covariance compares with that of the errors. */
#include "tuning_internal.h"

#include "imukit/distributions.h"
#include "imukit/linear_algebra.h"

#include <math.h>
#include <string.h>

enum { STATES = 9 };

const char *imk_filter_answer_name(imk_filter_answer_kind kind)
{
    static const char *const names[IMK_FILTER_ANSWERS] = {
        "data sheet", "data sheet x10", "fit", "safe", "fit, scale factors", "safe, scale factors"};
    return (unsigned)kind < IMK_FILTER_ANSWERS ? names[kind] : NULL;
}

/* b <- L^-1 b L^-T, symmetric */
static bool reduce(const double p[9][9], double b[9][9], double l[9][9])
{
    memcpy(l, p, 81 * sizeof(double));
    if (imk_cholesky_factor(STATES, &l[0][0]) != IMK_OK)
        return false;
    for (int side = 0; side < 2; side++) {
        for (int j = 0; j < STATES; j++)
            for (int i = 0; i < STATES; i++) {
                for (int k = 0; k < i; k++)
                    b[i][j] -= l[i][k] * b[k][j];
                b[i][j] /= l[i][i];
            }
        for (int i = 0; i < STATES; i++)
            for (int j = 0; j < i; j++) {
                const double swap = b[i][j];
                b[i][j] = b[j][i];
                b[j][i] = swap;
            }
    }
    return true;
}

bool imki_tuning_ratio(const double p[9][9], const double a[9][9], double ratio[9][9],
                       double eigenvalue[9])
{
    double l[9][9], spent[9][9];
    memcpy(ratio, a, 81 * sizeof(double));
    if (!reduce(p, ratio, l))
        return false;
    for (int i = 0; i < STATES; i++)
        for (int j = 0; j < STATES; j++)
            spent[i][j] = 0.5 * (ratio[i][j] + ratio[j][i]);
    return imk_symmetric_eigen(STATES, &spent[0][0], eigenvalue, NULL) == IMK_OK;
}

double imki_tuning_trace(const double p[9][9], const double a[9][9])
{
    double l[9][9], ratio[9][9], sum = 0.0;
    memcpy(ratio, a, sizeof ratio);
    if (!reduce(p, ratio, l))
        return (double)NAN;
    for (int i = 0; i < STATES; i++)
        sum += ratio[i][i];
    return sum;
}

/* tr(p^-1 a) of a block of three, over three. */
static double of_block(const double p[9][9], const double a[9][9], int first)
{
    double l[3][3], inverse[3][3], sum = 0.0;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            l[i][j] = p[first + i][first + j];
    if (imk_cholesky_factor(3, &l[0][0]) != IMK_OK)
        return (double)NAN;
    imk_cholesky_inverse(3, &l[0][0], &inverse[0][0]);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            sum += inverse[i][j] * a[first + j][first + i];
    return sum / 3.0;
}

bool imki_tuning_compare(const double model[9][9], const double truth[9][9],
                         imk_filter_consistency *consistency)
{
    double ratio[9][9], eigenvalue[9], sum = 0.0;
    if (!imki_tuning_ratio(model, truth, ratio, eigenvalue))
        return false;
    for (int i = 0; i < STATES; i++) {
        sum += ratio[i][i];
        consistency->axis[i] = truth[i][i] / model[i][i];
    }
    consistency->nees = sum / STATES;
    consistency->smallest = fmax(eigenvalue[0], 0.0); /* rounding */
    consistency->largest = eigenvalue[STATES - 1];
    for (int block = 0; block < 3; block++)
        consistency->block[block] = of_block(model, truth, 3 * block);
    return true;
}

/* Q = sum lambda_i (n_i + m_i)^2 by the first three of its cumulants: with
 * c_k = sum lambda_i^k (1 + k m_i^2) it is nearly c_2/c_3' … of chi-square with c_2^3/c_3^2 degrees
 * [IMHOF1961, formula of Pearson]. */
double imki_tuning_beyond(const double p[9][9], const double covariance[9][9], const double mean[9])
{
    double l[9][9], ratio[9][9], power[9][9], shift[9], moved[9], c[3];
    memcpy(ratio, covariance, sizeof ratio);
    if (!reduce(p, ratio, l))
        return (double)NAN;
    for (int i = 0; i < STATES; i++) {
        shift[i] = mean[i];
        for (int k = 0; k < i; k++)
            shift[i] -= l[i][k] * shift[k];
        shift[i] /= l[i][i];
    }
    memcpy(power, ratio, sizeof power);
    memcpy(moved, shift, sizeof moved);
    for (int k = 0; k < 3; k++) {
        double next[9][9] = {{0.0}}, on[9] = {0.0};
        c[k] = 0.0;
        for (int i = 0; i < STATES; i++) {
            c[k] += power[i][i] + (k + 1.0) * shift[i] * moved[i];
            for (int j = 0; j < STATES; j++) {
                on[i] += ratio[i][j] * moved[j];
                for (int n = 0; n < STATES; n++)
                    next[i][j] += power[i][n] * ratio[n][j];
            }
        }
        memcpy(power, next, sizeof power);
        memcpy(moved, on, sizeof moved);
    }
    const double limit = imk_chi_square_quantile(0.95, STATES);
    if (!(c[1] > 0.0) || !(c[2] > 0.0)) /* nothing at random */
        return c[0] > limit ? 1.0 : 0.0;
    const double degrees = c[1] * c[1] * c[1] / (c[2] * c[2]);
    const double at = (limit - c[0]) * sqrt(degrees / c[1]) + degrees;
    return at > 0.0 ? 1.0 - imk_chi_square_probability(at, degrees) : 1.0;
}
