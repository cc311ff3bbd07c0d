/* SPDX-License-Identifier: Apache-2.0 */
/* Allan deviations of a record that passes by.
 *
 * Factors m below IMKI_STRIDE_ONE use every window: a chunk's running sums stand behind the last
 * 2 IMKI_STRIDE_ONE of those before it, and each window is counted where it ends. Longer ones come
 * from the means of `block` samples as a record of its own, at m/block: windows start every block,
 * and their degrees of freedom are those of that record. */
#include "identify/allan/allan_internal.h"
#include "long_record_internal.h"

#include "imukit/elementary.h"

#include <math.h>
#include <string.h>

enum { CARRY = 2 * IMKI_STRIDE_ONE };

static void add_factor(imk_identify_record *r, size_t m)
{
    for (size_t i = 0; i < r->short_count; i++)
        if (r->short_factor[i] == m)
            return;
    r->short_factor[r->short_count++] = m;
}

/* Ten to the decade, and powers of two. */
void imki_record_allan_begin(imk_identify_record *r)
{
    static const imk_allan_grid grids[] = {IMK_ALLAN_DECADE, IMK_ALLAN_OCTAVE};
    size_t factors[IMKI_SHORT_FACTORS];
    for (size_t g = 0; g < 2; g++) {
        /* of a record of CARRY - 1 samples: factors below IMKI_STRIDE_ONE */
        const size_t count = imk_allan_factors(grids[g], CARRY - 1, factors);
        for (size_t i = 0; i < count; i++)
            add_factor(r, factors[i]);
    }
}

void imki_record_allan_add(imk_identify_record *r, size_t count, const double *samples)
{
    double *sums = r->sums + CARRY;
    if (!r->carried)
        sums[0] = 0;
    for (size_t i = 0; i < count; i++)
        sums[i + 1] = sums[i] + samples[i];
    for (size_t f = 0; f < r->short_count; f++) {
        const size_t m = r->short_factor[f], before = r->carried ? 2 * m - 1 : 0;
        const size_t n = count + before;
        double variance;
        if (n < 2 * m || imk_allan_variances(IMK_ALLAN_OVERLAPPING, n, sums - before, 1, &m,
                                             &variance, NULL, NULL) != IMK_OK)
            continue;
        const size_t windows = n - 2 * m + 1;
        r->short_total[f] += variance * (double)windows;
        r->short_windows[f] += windows;
    }
    /* The next chunk's sums begin at 0 again, so that they never grow. */
    const double last = sums[count];
    memmove(r->sums, r->sums + count, (CARRY + 1) * sizeof(double));
    for (size_t i = 0; i <= CARRY; i++)
        r->sums[i] -= last;
    r->carried = count >= CARRY;
}

/* Type by the slope of the variance, which is known to a part in 1e4 here:
 * sigma^2 ~ tau^(-alpha - 1). Phase noises have the same slope nearly; white is taken. */
static imk_power_law type_of_slope(double slope)
{
    if (slope < -1.5)
        return IMK_WHITE_PHASE;
    if (slope < -0.5)
        return IMK_WHITE_RATE;
    return slope < 0.5 ? IMK_FLICKER_RATE : IMK_RANDOM_WALK_RATE;
}

static double short_variance(const imk_identify_record *r, size_t m)
{
    for (size_t f = 0; f < r->short_count; f++)
        if (r->short_factor[f] == m && r->short_windows[f] > 0)
            return r->short_total[f] / (double)r->short_windows[f];
    return 0;
}

static imk_allan_point short_point(const imk_identify_record *r, size_t m, size_t neighbour,
                                   double confidence, const imk_power_law *before)
{
    const double variance = short_variance(r, m), beside = short_variance(r, neighbour);
    imk_allan_point point = {.m = m, .deviation = sqrt(variance)};
    const double slope = imk_ln(beside / variance) / imk_ln((double)neighbour / (double)m);
    point.type = imki_allan_type_at(r->samples / m, type_of_slope(slope), before);
    for (size_t f = 0; f < r->short_count; f++)
        if (r->short_factor[f] == m)
            point.count = r->short_windows[f];
    point.edf = imk_allan_edf_exact(IMK_ALLAN_OVERLAPPING, point.type, point.count + 2 * m - 1, m);
    imk_allan_interval(point.deviation, point.edf, confidence, &point.lower, &point.upper);
    return point;
}

/* Factors of a grid as multiples of the block, ascending. */
static size_t long_factors(size_t block, size_t last, size_t count, size_t *factors)
{
    size_t kept = 0;
    for (size_t i = 0; i < count; i++) {
        const size_t m = (factors[i] + block / 2) / block;
        if (factors[i] >= IMKI_STRIDE_ONE && m * block <= last &&
            (kept == 0 || m > factors[kept - 1]))
            factors[kept++] = m;
    }
    return kept;
}

size_t imki_record_allan_points(const imk_identify_record *r, const double *sums,
                                imk_allan_grid grid, double confidence, size_t last, size_t most,
                                imk_allan_point *points)
{
    size_t factors[IMKI_POINTS_MAX], count = imk_allan_factors(grid, r->samples, NULL), short_ = 0;
    if (count > IMKI_POINTS_MAX || count > most)
        return 0;
    imk_allan_factors(grid, r->samples, factors);
    for (; short_ < count && factors[short_] < IMKI_STRIDE_ONE && factors[short_] <= last; short_++)
        points[short_] = short_point(r, factors[short_],
                                     short_ + 1 < count && factors[short_ + 1] < IMKI_STRIDE_ONE
                                         ? factors[short_ + 1]
                                         : factors[short_ - 1],
                                     confidence, short_ > 0 ? &points[short_ - 1].type : NULL);
    const size_t longer = long_factors(r->block, last, count, factors);
    imk_allan_settings settings = imk_allan_default();
    settings.confidence = confidence;
    settings.before = short_ > 0 ? &points[short_ - 1] : NULL;
    if (longer > 0 && imk_allan_points(&settings, r->mean_count, sums, longer, factors,
                                       points + short_, NULL) != IMK_OK)
        return short_;
    for (size_t i = 0; i < longer; i++)
        points[short_ + i].m *= r->block;
    return short_ + longer;
}
