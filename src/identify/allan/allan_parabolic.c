/* SPDX-License-Identifier: Apache-2.0 */
/* Parabolic variance [VERNOTTE2016]: half the mean square difference of least-squares slopes of
 * neighbouring stretches of m sums.
 *
 *     PVAR(m) = 72/(m^6 M) sum_{j=0}^{M-1} A_j^2,   M = n - 2m + 2;   PVAR(1) = OAVAR(1)
 *     A_j = sum_{k<m} ((m-1)/2 - k) g_{j+k},   g_i = s[i] - s[i+m]
 *
 * as published, with m^3 where the least-squares slope has m (m^2 - 1): below it by 1 - 2/m^2. With
 * G_j = sum_{k<m} g_{j+k} both sums go on by
 *
 *     A_{j+1} = A_j + G_j - (m+1)/2 g_j - (m-1)/2 g_{j+m},   G_{j+1} = G_j + g_{j+m} - g_j
 *
 * in O(n) whatever m. They are summed afresh every 8m terms (or 16 blocks), so that rounding errors
 * do not pile up. */
#include "allan_internal.h"
#include "allan_running.h"

enum { REFRESH = 16 * IMKI_ALLAN_BLOCK };

IMKI_INLINED void window_sums(imki_allan_cursor *c, const double *s)
{
    double window[IMKI_ALLAN_LANES] = {0}, slope[IMKI_ALLAN_LANES] = {0};
    const double middle = 0.5 * ((double)c->m - 1);
    const size_t m = c->m;
    size_t k = 0;
    for (; k + IMKI_ALLAN_LANES <= m; k += IMKI_ALLAN_LANES)
        for (size_t l = 0; l < IMKI_ALLAN_LANES; l++) {
            const double g = s[k + l] - s[k + l + m];
            window[l] += g;
            slope[l] += (middle - (double)(k + l)) * g;
        }
    for (; k < m; k++) {
        const double g = s[k] - s[k + m];
        window[0] += g;
        slope[0] += (middle - (double)k) * g;
    }
    c->window = imki_sum_lanes(window);
    c->slope = imki_sum_lanes(slope);
}

IMKI_INLINED double parabolic_block(imki_allan_cursor *c, const double *sums, size_t first,
                                    size_t size)
{
    _Alignas(64) double step[IMKI_ALLAN_BLOCK], near[IMKI_ALLAN_BLOCK], value[IMKI_ALLAN_BLOCK];
    const size_t m = c->m;
    const double *a = sums + first, *b = a + m, *d = a + 2 * m;
    if (first == 0 || first - c->exact >= (8 * m > REFRESH ? 8 * m : REFRESH)) {
        c->exact = first;
        window_sums(c, a);
    }
    if (size == 0)
        return 0;
    const double before = 0.5 * ((double)m + 1), after = 0.5 * ((double)m - 1);
    const size_t steps = first + size < c->count ? size : size - 1;
    for (size_t j = 0; j < steps; j++) {
        const double g = a[j] - b[j], next = b[j] - d[j];
        step[j] = next - g;
        near[j] = before * g + after * next;
    }
    const double last = steps == size ? step[size - 1] : 0;
    imki_running(c->window, step, size, value);
    c->window = value[size - 1] + last;
    for (size_t j = 0; j < steps; j++)
        step[j] = value[j] - near[j];
    const double end = steps == size ? step[size - 1] : 0;
    double square = 0;
    c->slope = imki_running_squares(c->slope, step, size, &square) + end;
    return square;
}

/* By itself: its arrays would stand on the stack beside those of the others. */
IMKI_ALLAN_VERSIONS(parabolic_block,
                    (imki_allan_cursor * c, const double *sums, size_t first, size_t size), c, sums,
                    first, size)

void imki_allan_parabolic_block(imki_allan_cursor *c, imk_kernel kernel, const double *sums,
                                size_t first, size_t size)
{
    c->total += IMKI_ALLAN_CALL(kernel, parabolic_block, c, sums, first, size);
}
