/* SPDX-License-Identifier: Apache-2.0 */
/* Modified Allan variance [RILEY2008, (14)]: second differences of means of m sums.
 *
 *     MVAR(m) = 1/(2 m^4 M) sum_{j=0}^{M-1} D_j^2,   M = n - 3m + 2
 *     D_j = sum_{i=j}^{j+m-1} (s[i+2m] - 2 s[i+m] + s[i])
 *     D_{j+1} = D_j + s[j+3m] - 3 s[j+2m] + 3 s[j+m] - s[j]
 *
 * The recursion costs O(n) whatever m. D is summed afresh every 8m terms (or 16 blocks), so
 * that rounding errors do not pile up. */
#include "allan_internal.h"
#include "allan_running.h"

enum { REFRESH = 16 * IMKI_ALLAN_BLOCK };

IMKI_INLINED double window_sum(const double *s, size_t m)
{
    double lane[IMKI_ALLAN_LANES] = {0};
    size_t i = 0;
    for (; i + IMKI_ALLAN_LANES <= m; i += IMKI_ALLAN_LANES)
        for (size_t l = 0; l < IMKI_ALLAN_LANES; l++) {
            const double middle = s[i + l + m];
            lane[l] += (s[i + l + 2 * m] - middle) - (middle - s[i + l]);
        }
    for (; i < m; i++)
        lane[0] += (s[i + 2 * m] - s[i + m]) - (s[i + m] - s[i]);
    return imki_sum_lanes(lane);
}

IMKI_INLINED double modified_block(imki_allan_cursor *c, const double *sums, size_t first,
                                   size_t size)
{
    _Alignas(64) double step[IMKI_ALLAN_BLOCK];
    const size_t m = c->m;
    const double *s = sums + first;
    if (first == 0 || first - c->exact >= (8 * m > REFRESH ? 8 * m : REFRESH)) {
        c->exact = first;
        c->window = window_sum(s, m);
    }
    /* The step out of the last term there is would read beyond the record. */
    const bool whole = first + size < c->count;
    const size_t steps = whole ? size : size - 1;
    const double *a = s, *b = s + m, *d = s + 2 * m, *e = s + 3 * m;
    for (size_t j = 0; j < steps; j++)
        step[j] = (e[j] - a[j]) - 3 * (d[j] - b[j]);
    const double last =
        whole ? (e[steps - 1] - a[steps - 1]) - 3 * (d[steps - 1] - b[steps - 1]) : 0;
    double square = 0;
    c->window = imki_running_squares(c->window, step, size, &square) + last;
    return square;
}

/* By itself: its arrays would stand on the stack beside those of the others. */
IMKI_ALLAN_VERSIONS(modified_block,
                    (imki_allan_cursor * c, const double *sums, size_t first, size_t size), c, sums,
                    first, size)

void imki_allan_modified_block(imki_allan_cursor *c, imk_kernel kernel, const double *sums,
                               size_t first, size_t size)
{
    c->total += IMKI_ALLAN_CALL(kernel, modified_block, c, sums, first, size);
}
