/* SPDX-License-Identifier: Apache-2.0 */
/* Every statistic of the Allan family as it is defined, term by term in long double: slow and
 * plain, to compare the fast ones with. x are n + 1 phase values (sums of the rates), in units of
 * the sampling interval. Returns the variance; TVAR in rate units times the interval, squared. */
#ifndef ALLAN_ORACLE_H
#define ALLAN_ORACLE_H

#include "imukit/allan.h"

static long double oracle_differences(size_t n, const long double *x, size_t m, int order,
                                      size_t stride)
{
    long double total = 0;
    size_t count = 0;
    for (size_t j = 0; j + (size_t)order * m <= n; j += stride, count++) {
        const long double *p = x + j;
        const long double d =
            order == 2 ? p[2 * m] - 2 * p[m] + p[0] : p[3 * m] - 3 * p[2 * m] + 3 * p[m] - p[0];
        total += d * d;
    }
    return total / ((order == 2 ? 2 : 6) * (long double)m * (long double)m * (long double)count);
}

static long double oracle_modified(size_t n, const long double *x, size_t m)
{
    long double total = 0;
    size_t count = 0;
    for (size_t j = 0; j + 3 * m <= n + 1; j++, count++) {
        long double d = 0;
        for (size_t i = j; i < j + m; i++)
            d += x[i + 2 * m] - 2 * x[i + m] + x[i];
        total += d * d;
    }
    const long double square = (long double)m * (long double)m;
    return total / (2 * square * square * (long double)count);
}

static long double oracle_total(size_t n, const long double *x, size_t m)
{
    long double total = 0;
    for (size_t i = 1; i < n; i++) {
        const long double low = i >= m ? x[i - m] : 2 * x[0] - x[m - i];
        const long double high = i + m <= n ? x[i + m] : 2 * x[n] - x[2 * n - i - m];
        const long double d = low - 2 * x[i] + high;
        total += d * d;
    }
    return total / (2 * (long double)m * (long double)m * (long double)(n - 1));
}

/* Mean over stretches of 3m values of the mean square of the 6m second differences of means over m
 * of the stretch, its trend between halves removed, between its mirror images. */
static long double oracle_stretches(size_t values, const long double *v, size_t m)
{
    enum { LONGEST = 2048 };
    const size_t length = 3 * m, half = length / 2;
    static long double extended[3 * LONGEST];
    long double total = 0;
    size_t count = 0;
    for (size_t p = 0; p + length <= values; p++, count++) {
        long double left = 0, right = 0;
        for (size_t k = 0; k < half; k++) {
            left += v[p + k] / (long double)half;
            right += v[p + length - 1 - k] / (long double)half;
        }
        const long double slope = (right - left) / (long double)(length - half);
        for (size_t k = 0; k < length; k++) {
            const long double value = v[p + k] - slope * (long double)k;
            extended[length + k] = value;
            extended[length - 1 - k] = value;
            extended[3 * length - 1 - k] = value;
        }
        for (size_t i = 0; i < 6 * m; i++) {
            long double z = 0;
            for (size_t k = 0; k < m; k++)
                z += extended[i + k] - 2 * extended[i + m + k] + extended[i + 2 * m + k];
            z /= (long double)m;
            total += z * z / (6 * (long double)m);
        }
    }
    return total / (long double)count;
}

static long double oracle_theo(size_t n, const long double *x, size_t m)
{
    long double total = 0;
    for (size_t i = 0; i + m <= n; i++)
        for (size_t delta = 0; delta < m / 2; delta++) {
            const long double d = (x[i] - x[i - delta + m / 2]) + (x[i + m] - x[i + delta + m / 2]);
            total += d * d / (long double)(m / 2 - delta);
        }
    return total / (0.75L * (long double)(n + 1 - m) * (long double)m * (long double)m);
}

static long double oracle_parabolic(size_t n, const long double *x, size_t m)
{
    if (m == 1)
        return oracle_differences(n, x, 1, 2, 1);
    long double total = 0;
    size_t count = 0;
    for (size_t j = 0; j + 2 * m <= n + 1; j++, count++) {
        long double a = 0;
        for (size_t k = 0; k < m; k++)
            a += (((long double)m - 1) / 2 - (long double)k) * (x[j + k] - x[j + k + m]);
        total += a * a;
    }
    const long double cube = (long double)m * (long double)m * (long double)m;
    return 72 * total / (cube * cube * (long double)count);
}

/* @param rate  the n rates that x are the sums of */
static long double oracle(imk_allan_statistic statistic, size_t n, const long double *x,
                          const long double *rate, size_t m)
{
    const long double square = (long double)m * (long double)m;
    switch (statistic) {
    case IMK_ALLAN_OVERLAPPING:
        return oracle_differences(n, x, m, 2, 1);
    case IMK_ALLAN_PLAIN:
        return oracle_differences(n, x, m, 2, m);
    case IMK_ALLAN_MODIFIED:
        return oracle_modified(n, x, m);
    case IMK_ALLAN_TIME:
        return square / 3 * oracle_modified(n, x, m);
    case IMK_ALLAN_HADAMARD:
        return oracle_differences(n, x, m, 3, 1);
    case IMK_ALLAN_HADAMARD_PLAIN:
        return oracle_differences(n, x, m, 3, m);
    case IMK_ALLAN_TOTAL:
        return oracle_total(n, x, m);
    case IMK_ALLAN_MODIFIED_TOTAL:
        return oracle_stretches(n + 1, x, m) / (2 * square);
    case IMK_ALLAN_HADAMARD_TOTAL:
        return oracle_stretches(n, rate, m) / 6;
    case IMK_ALLAN_THEO1:
        return oracle_theo(n, x, m);
    case IMK_ALLAN_PARABOLIC:
        return oracle_parabolic(n, x, m);
    case IMK_ALLAN_HAAR:
        return oracle_differences(n, x, m, 2, 1) / 2;
    default:
        return -1;
    }
}

#endif
