/* SPDX-License-Identifier: Apache-2.0 */
/* Theo1 [RILEY2008, (30)]: every pair of equal stretches within m + 1 sums, weighted by 1/length.
 *
 *     Theo1(m) = 1/(0.75 (n + 1 - m) m^2) sum_{i=0}^{n-m} sum_{k=1}^{m/2}
 *                1/k ((s[i] - s[i+k]) + (s[i+m] - s[i+m-k]))^2
 *
 * at tau = 0.75 m dt, m even; k is m/2 - delta of the definition. Summed as it stands, by vectors
 * over i, for small m; allan_theo_fast.c does the rest. */
#include "allan_internal.h"

IMKI_INLINED double lag_squares(const double *s, size_t m, size_t k, size_t count)
{
    const double *near = s + k, *far = s + m - k, *end = s + m;
    double lane[IMKI_ALLAN_LANES] = {0};
    size_t i = 0;
    for (; i + IMKI_ALLAN_LANES <= count; i += IMKI_ALLAN_LANES)
        for (size_t l = 0; l < IMKI_ALLAN_LANES; l++) {
            const double d = (s[i + l] - near[i + l]) + (end[i + l] - far[i + l]);
            lane[l] += d * d;
        }
    for (; i < count; i++) {
        const double d = (s[i] - near[i]) + (end[i] - far[i]);
        lane[0] += d * d;
    }
    return imki_sum_lanes(lane);
}

IMKI_INLINED double block_squares(const double *s, size_t m, size_t count)
{
    double total = 0;
    for (size_t k = 1; k <= m / 2; k++)
        total += lag_squares(s, m, k, count) / (double)k;
    return total;
}

IMKI_ALLAN_VERSIONS(block_squares, (const double *s, size_t m, size_t count), s, m, count)

static double by_definition(imk_kernel kernel, const double *sums, size_t m, size_t count)
{
    double total = 0;
    for (size_t i = 0; i < count; i += IMKI_ALLAN_BLOCK)
        total += IMKI_ALLAN_CALL(kernel, block_squares, sums + i, m,
                                 count - i < IMKI_ALLAN_BLOCK ? count - i : IMKI_ALLAN_BLOCK);
    return total;
}

double imki_allan_theo(size_t n, const double *sums, size_t m, size_t *count, imk_kernel kernel,
                       double *scratch)
{
    *count = n + 1 - m;
    const double total = imki_allan_theo_doubles(n, m) > 0
                             ? imki_allan_theo_fast(n, sums, m, scratch)
                             : by_definition(kernel, sums, m, *count);
    return total / (0.75 * (double)*count * (double)m * (double)m);
}
