/* SPDX-License-Identifier: Apache-2.0 */
/* Means of a spectrum over logarithmically spaced bands, with chi-square intervals.
 *
 * A mean of m neighbouring bins of v degrees each, of which every c carry one independent value,
 * has v m/c' degrees, c' rising from 1 (one bin) to c (many): 1 + (c - 1)(1 - 1/m). */
#include "spectrum_internal.h"

#include "imukit/distributions.h"
#include "imukit/elementary.h"

#include <math.h>

static const double LN10 = 2.302585092994045684;

void imk_spectrum_interval(double density, double degrees, double confidence, double *lower,
                           double *upper)
{
    const double tail = 0.5 * (1 - confidence);
    *lower = density * degrees / imk_chi_square_quantile(1 - tail, degrees);
    *upper = density * degrees / imk_chi_square_quantile(tail, degrees);
}

static bool in_line(size_t bin, size_t line_count, const imk_spectrum_line *lines)
{
    for (size_t i = 0; i < line_count; i++)
        if (bin >= lines[i].first && bin <= lines[i].last)
            return true;
    return false;
}

size_t imk_spectrum_bands(const imk_spectrum *spectrum, int per_decade, double confidence,
                          size_t line_count, const imk_spectrum_line *lines, size_t capacity,
                          imk_spectrum_band *bands)
{
    const double ratio = imk_exp(LN10 / per_decade);
    size_t made = 0, first = 1;
    double edge = 1.5; /* [bins], between two of them */
    while (first < spectrum->count && made < capacity) {
        size_t last = first;
        while (last + 1 < spectrum->count && (double)(last + 1) < edge)
            last++;
        double sum = 0, degrees = 0, used = 0;
        for (size_t bin = first; bin <= last; bin++)
            if (!in_line(bin, lines ? line_count : 0, lines)) {
                sum += spectrum->density[bin];
                degrees += spectrum->degrees[bin];
                used += 1;
            }
        if (used > 0) {
            imk_spectrum_band *b = &bands[made++];
            b->degrees = degrees / (1 + (spectrum->correlation - 1) * (1 - 1 / used));
            b->from = ((double)first - 0.5) * spectrum->step;
            b->to = fmin(((double)last + 0.5) * spectrum->step, 0.5 / spectrum->dt);
            b->frequency = first == last ? (double)first * spectrum->step : sqrt(b->from * b->to);
            b->density = sum / used;
            imk_spectrum_interval(b->density, b->degrees, confidence, &b->lower, &b->upper);
        }
        first = last + 1;
        edge = fmax(edge * ratio, (double)first + 0.5);
    }
    return made;
}
