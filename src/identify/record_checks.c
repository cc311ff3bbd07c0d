/* SPDX-License-Identifier: Apache-2.0 */
/* What can be wrong with a record before any noise model: coarse steps, saturation, repeated
 * samples, warm-up. */
#include "identify_internal.h"

#include <math.h>

/* Heap sort, ascending: the C library's qsort may allocate. */
static void sift(double *a, size_t root, size_t count)
{
    for (size_t child; (child = 2 * root + 1) < count; root = child) {
        if (child + 1 < count && a[child + 1] > a[child])
            child++;
        if (a[root] >= a[child])
            return;
        const double swap = a[root];
        a[root] = a[child];
        a[child] = swap;
    }
}

static void sort(double *a, size_t count)
{
    for (size_t i = count / 2; i-- > 0;)
        sift(a, i, count);
    for (size_t end = count; end-- > 1;) {
        const double swap = a[0];
        a[0] = a[end];
        a[end] = swap;
        sift(a, 0, end);
    }
}

/* Smallest step between different values in a sample of the record, when the values lie on a grid
 * of that step (to 1 %, so that a unit conversion's rounding does not hide it); else 0. */
double imki_record_resolution(size_t n, const double *samples, double *scratch,
                              size_t scratch_count)
{
    const size_t count = n < scratch_count ? n : scratch_count;
    for (size_t i = 0; i < count; i++)
        scratch[i] = samples[i];
    sort(scratch, count);
    const double span = scratch[count - 1] - scratch[0];
    double step = HUGE_VAL;
    for (size_t i = 1; i < count; i++) {
        const double d = scratch[i] - scratch[i - 1];
        if (d > 1e-9 * span && d < step)
            step = d;
    }
    if (!(step < HUGE_VAL) || !(span / step < (double)count / 4))
        return 0;
    for (size_t i = 1; i < count; i++) {
        const double steps = (scratch[i] - scratch[i - 1]) / step;
        if (fabs(steps - floor(steps + 0.5)) > 0.05)
            return 0;
    }
    return step;
}

/* An extreme value that piles up: more than three times as many samples on it as on the next value
 * within a step of it, and some in a row. */
static bool sticks(size_t n, const double *samples, double extreme, double toward, double step)
{
    size_t on = 0, beside = 0, run = 0, longest = 0;
    for (size_t i = 0; i < n; i++) {
        const bool at = samples[i] == extreme;
        on += at;
        beside += !at && fabs(samples[i] - extreme) <= step && (samples[i] - extreme) * toward > 0;
        run = at ? run + 1 : 0;
        longest = run > longest ? run : longest;
    }
    return longest >= 3 && on > 10 + 3 * beside;
}

/* The first eighth's mean against the scatter of the other seven. Ten standard deviations of a
 * t-distribution with 6 degrees of freedom: a false alarm in 1e-4 of records without slow noise. */
static bool warms_up(size_t n, const double *samples)
{
    double mean[8] = {0}, centre = 0, scatter = 0;
    for (size_t part = 0; part < 8; part++) {
        const size_t from = part * n / 8, to = (part + 1) * n / 8;
        for (size_t i = from; i < to; i++)
            mean[part] += samples[i];
        mean[part] /= (double)(to - from);
        centre += part > 0 ? mean[part] / 7 : 0;
    }
    for (size_t part = 1; part < 8; part++)
        scatter += (mean[part] - centre) * (mean[part] - centre) / 6;
    return fabs(mean[0] - centre) > 10 * sqrt(scatter);
}

unsigned imki_record_verdict(size_t n, const double *samples, double resolution, double deviation)
{
    unsigned verdict = 0;
    double low = samples[0], high = samples[0];
    size_t repeats = 0;
    for (size_t i = 1; i < n; i++) {
        low = samples[i] < low ? samples[i] : low;
        high = samples[i] > high ? samples[i] : high;
        repeats += samples[i] == samples[i - 1];
    }
    const double step = resolution > 0 ? resolution * 1.01 : 0.1 * deviation;
    if (sticks(n, samples, high, -1, step) || sticks(n, samples, low, 1, step))
        verdict |= IMK_VERDICT_SATURATED;
    if (resolution > deviation)
        verdict |= IMK_VERDICT_COARSE;
    /* Independent samples repeat in about resolution/(2 sqrt(pi) deviation) of steps. */
    if ((double)repeats > 0.4 * (double)n && resolution < 0.5 * deviation)
        verdict |= IMK_VERDICT_FROZEN;
    if (warms_up(n, samples))
        verdict |= IMK_VERDICT_WARM_UP;
    return verdict;
}
