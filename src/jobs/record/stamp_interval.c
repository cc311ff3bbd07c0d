/* SPDX-License-Identifier: Apache-2.0 */
/* Sample intervals that stamps suggest.
 *
 * steps:     mean of the steps near their median, where at least half of all steps are: clocks that
 *            stamp each row, some of them late
 * groups:    interval between groups of rows with (nearly) one stamp, over the rows that most
 *            groups have: stamps that are coarse or come in bunches, with rows lost here and there
 * long run:  most frequent slope between points of the lower envelope of time against row number:
 *            all others. The mode of the slopes by repeated halving [BICKEL2006] passes over those
 *            across a loss. */
#include "record_stamps_internal.h"

#include "base/sort_internal.h"

#include <math.h>

enum { SAMPLE = 4096, GROUPS = 1 << 16, BLOCKS = 64, BLOCK_ROWS = 32 };

static const double near_median_from = 0.4, near_median_to = 1.6, majority = 0.5;
/* Steps below this share of the mean interval are within a group. */
static const double within_group = 0.25;

typedef struct stamp_rows {
    size_t n;
    const double *time;
} stamp_rows;

/* Median of sampled steps of the rows; of positive ones only. 0: there is none. */
static double median_step(stamp_rows s, bool positive, double *scratch)
{
    const size_t stride = 1 + s.n / SAMPLE;
    size_t count = 0;
    for (size_t i = 1; i < s.n && count < SAMPLE; i += stride) {
        /* a positive one: the next there is */
        double step = s.time[i] - s.time[i - 1];
        for (size_t k = 1; positive && !(step > 0) && k < stride + SAMPLE && i + k < s.n; k++)
            step = s.time[i + k] - s.time[i + k - 1];
        if (isfinite(step) && (step > 0 || !positive))
            scratch[count++] = step;
    }
    if (count == 0)
        return 0;
    imki_sort(scratch, count);
    return scratch[(count - 1) / 2];
}

static double interval_by_steps(stamp_rows s, double *scratch)
{
    const double median = median_step(s, false, scratch);
    size_t near = 0, all = 0;
    double sum = 0;
    if (!(median > 0))
        return 0;
    for (size_t i = 1; i < s.n; i++) {
        const double step = s.time[i] - s.time[i - 1];
        const bool is_near = step >= near_median_from * median && step <= near_median_to * median;
        all += isfinite(step) != 0;
        near += is_near;
        sum += is_near ? step : 0;
    }
    return (double)near >= majority * (double)all ? sum / (double)near : 0;
}

/* Mean interval per row, little moved by jumps: median of the slopes of blocks. */
static double mean_interval(stamp_rows s, double *scratch)
{
    const size_t rows = s.n / BLOCKS > BLOCK_ROWS ? s.n / BLOCKS : BLOCK_ROWS;
    size_t count = 0, last = 0;
    for (size_t i = 0; i < s.n; i++) {
        if (!isfinite(s.time[i]) || (i < last + rows && i > 0 && i + 1 < s.n))
            continue;
        if (i > last && isfinite(s.time[last]))
            scratch[count++] = (s.time[i] - s.time[last]) / (double)(i - last);
        last = i;
    }
    if (count == 0)
        return 0;
    imki_sort(scratch, count);
    return scratch[(count - 1) / 2];
}

/* Sizes of the groups of rows, and steps between their first rows. */
static void count_groups(stamp_rows s, double mean, double *size, double *step, size_t *groups)
{
    size_t first = 0, count = 0;
    for (size_t i = 1; i < s.n; i++) {
        if (!(s.time[i] - s.time[i - 1] > within_group * mean) &&
            !(s.time[i] - s.time[i - 1] < -mean))
            continue;
        size[count] = (double)(i - first);
        step[count] = s.time[i] - s.time[first];
        count++;
        first = i;
    }
    *groups = count;
}

/* Some of many, for sorting. @return how many are left */
static size_t thin_out(size_t count, double *a, double *b)
{
    const size_t stride = 1 + count / GROUPS;
    size_t kept = 0;
    for (size_t k = 0; k < count; k += stride, kept++) {
        a[kept] = a[k];
        b[kept] = b[k];
    }
    return kept;
}

/* Mean of those near the median, which are sorted. */
static double mean_near_median(size_t count, const double *sorted)
{
    const double median = sorted[(count - 1) / 2];
    double sum = 0;
    size_t near = 0;
    for (size_t k = 0; k < count; k++)
        if (sorted[k] >= near_median_from * median && sorted[k] <= near_median_to * median) {
            sum += sorted[k];
            near++;
        }
    return near > 0 ? sum / (double)near : 0;
}

/* The most frequent of sorted values; how often it occurs. */
static double most_frequent(size_t count, const double *sorted, size_t *times)
{
    double most = 0;
    *times = 0;
    for (size_t k = 0, first = 0; k < count; k++) {
        if (sorted[k] != sorted[first])
            first = k;
        if (k + 1 - first > *times) {
            *times = k + 1 - first;
            most = sorted[k];
        }
    }
    return most;
}

static void interval_by_groups(stamp_rows s, double mean, imki_stamp_intervals *found,
                               double *scratch)
{
    double *size = scratch, *step = scratch + s.n;
    size_t groups, times;
    count_groups(s, mean, size, step, &groups);
    found->rows_per_stamp = 1;
    if (groups < 4)
        return;
    groups = thin_out(groups, size, step);
    imki_sort(size, groups);
    imki_sort(step, groups);
    double rows = 0;
    for (size_t k = 0; k < groups; k++)
        rows += size[k];
    found->rows_per_stamp = rows / (double)groups;
    /* a group of a pause is no rule */
    found->most_rows_per_stamp = size[groups - 1 - groups / 50];
    const double mode = most_frequent(groups, size, &times);
    if (mode > 1 && (double)times >= majority * (double)groups)
        found->groups = mean_near_median(groups, step) / mode;
}

/* Most frequent of sorted values: the closest fifth, of that the closest half, and so on. */
static double half_sample_mode(size_t count, const double *sorted)
{
    for (size_t part = 5; count > 3; part = 2) {
        const size_t half = (count + part - 1) / part;
        size_t best = 0;
        for (size_t k = 0; k + half <= count; k++)
            if (sorted[k + half - 1] - sorted[k] < sorted[best + half - 1] - sorted[best])
                best = k;
        sorted += best;
        count = half;
    }
    return sorted[count / 2];
}

/* Of each block the row that is least behind a line. @return blocks */
static size_t lower_envelope(stamp_rows s, double mean, size_t blocks, size_t *row)
{
    const size_t rows = s.n / blocks;
    size_t count = 0;
    for (size_t b = 0; b < blocks; b++) {
        size_t best = SIZE_MAX;
        for (size_t i = b * rows; i < (b + 1) * rows; i++)
            if (isfinite(s.time[i]) && (best == SIZE_MAX || s.time[i] - mean * (double)i <
                                                                s.time[best] - mean * (double)best))
                best = i;
        if (best != SIZE_MAX)
            row[count++] = best;
    }
    return count;
}

static double interval_of_long_run(stamp_rows s, double mean, double most_rows, double *scratch)
{
    size_t row[BLOCKS], count = 0;
    const double rows = fmax(BLOCK_ROWS, 2 * most_rows);
    const double fit = floor((double)s.n / rows);
    const size_t blocks = lower_envelope(s, mean,
                                         fit < 4        ? 4
                                         : fit > BLOCKS ? BLOCKS
                                                        : (size_t)fit,
                                         row);
    for (size_t a = 0; a < blocks; a++)
        for (size_t b = a + 1; b < blocks; b++)
            if (24 * (b - a) >= blocks && row[b] > row[a])
                scratch[count++] = (s.time[row[b]] - s.time[row[a]]) / (double)(row[b] - row[a]);
    if (count == 0)
        return mean;
    imki_sort(scratch, count);
    return half_sample_mode(count, scratch);
}

imki_stamp_intervals imki_stamp_intervals_of(size_t n, const double *time, double *scratch)
{
    const stamp_rows s = {n, time};
    imki_stamp_intervals found = {
        .rows_per_stamp = 1, .most_rows_per_stamp = 1, .between = median_step(s, true, scratch)};
    const double mean = mean_interval(s, scratch);
    found.steps = interval_by_steps(s, scratch);
    if (!(mean > 0))
        return found;
    interval_by_groups(s, mean, &found, scratch);
    found.long_run = interval_of_long_run(s, mean, found.most_rows_per_stamp, scratch);
    return found;
}
