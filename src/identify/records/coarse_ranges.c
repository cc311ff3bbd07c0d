/* SPDX-License-Identifier: Apache-2.0 */
/* Ranges of short blocks, and medians of ranges and distances that rounding has made coarse. */
#include "screen_internal.h"

enum { LANES = 8 }; /* the compiler makes vectors of them */

double imki_block_range(const double *value)
{
    double low[LANES], high[LANES];
    for (size_t l = 0; l < LANES; l++)
        low[l] = high[l] = value[l];
    for (size_t i = LANES; i < IMKI_BLOCK; i += LANES)
        for (size_t l = 0; l < LANES; l++) {
            const double v = value[i + l];
            low[l] = v < low[l] ? v : low[l];
            high[l] = v > high[l] ? v : high[l];
        }
    for (size_t l = 1; l < LANES; l++) {
        low[0] = low[l] < low[0] ? low[l] : low[0];
        high[0] = high[l] > high[0] ? high[l] : high[0];
    }
    return high[0] - low[0];
}

double imki_coarse_step(size_t count, const double *sorted, double resolution)
{
    size_t i = 0;
    while (i < count && sorted[i] == 0)
        i++;
    return resolution > 0 || 2 * i < count || i == count ? resolution : sorted[i];
}

double imki_median_on_steps(size_t count, const double *sorted, double step)
{
    const double median = sorted[count / 2];
    if (!(step > 0))
        return median;
    size_t below = 0, end = 0;
    while (sorted[below] < median - step / 4)
        below++;
    for (end = below; end < count && sorted[end] < median + step / 4;)
        end++;
    const double low = median > step / 4 ? median - step / 2 : 0, high = median + step / 2;
    return low + (high - low) * (0.5 * (double)count - (double)below) / (double)(end - below);
}
