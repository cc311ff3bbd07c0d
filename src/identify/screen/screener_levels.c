/* SPDX-License-Identifier: Apache-2.0 */
/* The level of a record over its whole length: sums of blocks of samples, with how many were there.
 * Blocks begin with one sample; when there is no more room, they are joined two by two. */
#include "screener_internal.h"

#include <math.h>
#include <string.h>

enum { LANES = 8 };

void imki_levels_begin(imki_levels *l)
{
    memset(l, 0, sizeof *l);
    l->block = 1;
    l->shift = l->shift_temperature = (double)NAN;
}

static double sum_of(size_t count, const double *x, double shift, double *present)
{
    double sum[LANES] = {0}, there[LANES] = {0};
    for (size_t i = 0; i < count; i += LANES) {
        const size_t width = count - i < LANES ? count - i : LANES;
        for (size_t l = 0; l < width; l++) {
            const bool is = x[i + l] == x[i + l];
            sum[l] += is ? x[i + l] - shift : 0;
            there[l] += is ? 1 : 0;
        }
    }
    for (size_t l = 1; l < LANES; l++) {
        sum[0] += sum[l];
        there[0] += there[l];
    }
    *present += there[0];
    return sum[0];
}

static void join(double *x, size_t count)
{
    for (size_t i = 0; i < count / 2; i++)
        x[i] = x[2 * i] + x[2 * i + 1];
    memset(x + count / 2, 0, (count - count / 2) * sizeof *x);
}

static void join_all(imki_levels *l)
{
    join(l->sum, l->count);
    join(l->present, l->count);
    join(l->temperature, l->count);
    join(l->measured, l->count);
    l->count /= 2;
    l->block *= 2;
}

/* The first value there is. */
static double first_of(size_t count, const double *x)
{
    for (size_t i = 0; i < count; i++)
        if (x[i] == x[i])
            return x[i];
    return (double)NAN;
}

void imki_levels_add(imki_levels *l, size_t count, const double *samples, const double *temperature)
{
    if (l->shift != l->shift)
        l->shift = first_of(count, samples);
    if (temperature && l->shift_temperature != l->shift_temperature)
        l->shift_temperature = first_of(count, temperature);
    for (size_t done = 0; done < count;) {
        if (l->filled == 0 && l->count == IMKI_SCREEN_LEVELS)
            join_all(l);
        const size_t room = l->block - l->filled;
        const size_t part = count - done < room ? count - done : room, at = l->count;
        l->sum[at] += sum_of(part, samples + done, l->shift, &l->present[at]);
        if (temperature)
            l->temperature[at] +=
                sum_of(part, temperature + done, l->shift_temperature, &l->measured[at]);
        l->filled += part;
        done += part;
        if (l->filled < l->block)
            continue;
        l->filled = 0;
        l->count++;
        l->sum[l->count] = l->present[l->count] = 0;
        l->temperature[l->count] = l->measured[l->count] = 0;
    }
}

static size_t group_of(const imki_levels *l, size_t most)
{
    return (l->count + most - 1) / most;
}

size_t imki_levels_length(const imki_levels *l, size_t most)
{
    return l->count > 0 ? group_of(l, most) * l->block : 0;
}

/* Mean square of differences between means that are there, `lag` apart. */
static double mean_square(size_t count, const double *mean, size_t lag)
{
    double sum = 0, pairs = 0;
    for (size_t i = lag; i < count; i++) {
        const double d = mean[i] - mean[i - lag];
        sum += d == d ? d * d : 0;
        pairs += d == d;
    }
    return pairs > 0 ? sum / pairs : 0;
}

/* Weight of the newest mean in the level that is best for a walk under white noise: their variances
 * from differences at lags 1 and 16 [MUTH1960]. */
static double gain_of(size_t count, const double *mean)
{
    enum { LAG = 16 };
    const double near = mean_square(count, mean, 1), far = mean_square(count, mean, LAG);
    const double walk = fmax(0, (far - near) / (LAG - 1)), white = 0.5 * (near - walk);
    const double ratio = white > 0 ? fmax(walk / white, 1.0 / (LAG * LAG * LAG)) : HUGE_VAL;
    return ratio < 1e6 ? 0.5 * (sqrt(ratio * ratio + 4 * ratio) - ratio) : 1;
}

/* Levels beside the holes: of the means before, and of those behind. */
static void bridge_hole(double *mean, size_t from, size_t to, size_t count, double gain)
{
    enum { FAR = 256 };
    double left = 0, right = 0, left_weight = 0, right_weight = 0, weight = 1;
    for (size_t k = 1; k <= FAR && k <= from; k++, weight *= 1 - gain) {
        left += weight * mean[from - k];
        left_weight += weight;
    }
    weight = 1;
    for (size_t k = to; k < to + FAR && k < count; k++, weight *= 1 - gain) {
        const bool there = mean[k] == mean[k];
        right += there ? weight * mean[k] : 0;
        right_weight += there ? weight : 0;
    }
    left = left_weight > 0 ? left / left_weight : right / right_weight;
    right = right_weight > 0 ? right / right_weight : left;
    for (size_t i = from; i < to; i++)
        mean[i] = left + (right - left) * (double)(i + 1 - from) / (double)(to + 1 - from);
}

/* Means that are not there, on lines between the levels on either side. */
static void bridge(double *mean, size_t count)
{
    const double gain = gain_of(count, mean);
    for (size_t i = 0, to; i < count; i = to + 1) {
        for (to = i; to < count && mean[to] != mean[to];)
            to++;
        if (to > i)
            bridge_hole(mean, i, to, count, gain);
    }
}

/* A mean of less than half of its samples is none. */
size_t imki_levels_means(const imki_levels *l, size_t most, const double *sum,
                         const double *present, double shift, double *mean, double *empty)
{
    if (l->count == 0)
        return 0;
    const size_t group = group_of(l, most), count = l->count / group;
    const double least = 0.5 * (double)(group * l->block);
    size_t there = 0;
    for (size_t i = 0; i < count; i++) {
        double total = 0, samples = 0;
        for (size_t k = i * group; k < (i + 1) * group; k++) {
            total += sum[k];
            samples += present[k];
        }
        const bool enough = samples > 0 && samples >= least;
        mean[i] = enough ? shift + total / samples : (double)NAN;
        there += enough;
    }
    if (there == 0)
        return 0;
    if (there < count)
        bridge(mean, count);
    *empty = 1 - (double)there / (double)count;
    return count;
}
