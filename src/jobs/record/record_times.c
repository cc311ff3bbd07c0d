/* SPDX-License-Identifier: Apache-2.0 */
/* What the times of a log tell about it. Steps <= 0 are counted at once; positive ones in groups of
 * 4096, each assessed with the interval known when it is full, so a log of any length takes the
 * same memory:
 *
 *     interval = 1/rate, or the median of the first group; from the second group on the median of
 *                the groups' medians (of 4096 groups' medians each, beyond 4096 groups)
 *     gap:      step >= 1.5 intervals;  missing in it: round(step / interval) - 1
 *     jitter  = sqrt(mean((step - interval)^2)) over the positive steps that are no gap
 *     uneven:   step < 0.4 intervals, or one of 1.35 to 4 intervals that is more than 0.25 off a
 *               whole number of them; a burst is a step < 0.25 intervals
 *     pattern = correlation of neighbouring steps, each limited to two intervals
 *
 * A time that is not finite makes no step, neither to it nor from it. */
#include "record_times_internal.h"

#include "imukit/samples.h"

#include <math.h>
#include <string.h>

static void swap(double *a, double *b)
{
    const double held = *a;
    *a = *b;
    *b = held;
}

/* Lower median for even counts: a step that did occur. Reorders the values: quickselect
 * [HOARE1961], with the middle as pivot, so that sorted and equal values are fast. */
static double median_of(double *values, size_t count)
{
    const size_t middle = (count - 1) / 2;
    size_t first = 0, last = count - 1;
    while (first < last) {
        const double pivot = values[first + (last - first) / 2];
        size_t i = first, j = last;
        for (;;) {
            while (values[i] < pivot)
                i++;
            while (j > first && pivot < values[j])
                j--;
            if (i >= j)
                break;
            swap(&values[i++], &values[j--]);
        }
        if (middle <= j) /* [first, j] is not above the pivot, [j + 1, last] not below */
            last = j;
        else
            first = j + 1;
    }
    return values[middle];
}

static double median_of_copy(const double *values, size_t count)
{
    double copy[IMKI_STEP_GROUP];
    memcpy(copy, values, count * sizeof copy[0]);
    return median_of(copy, count);
}

static double median_of_pending(const imki_record_times *times)
{
    double size[IMKI_STEP_GROUP] = {0};
    for (size_t i = 0; i < times->pending; i++)
        size[i] = times->step[i].size;
    return median_of(size, times->pending);
}

void imki_record_times_start(imki_record_times *times, double given_interval)
{
    times->given_interval = given_interval;
    times->last_time = (double)NAN;
    times->findings.interval = given_interval;
}

/* The interval with what is known now; 0 when nothing is. */
static double interval_now(const imki_record_times *times)
{
    if (times->given_interval > 0.0)
        return times->given_interval;
    if (times->upper_groups > 0)
        return median_of_copy(times->upper, times->upper_groups);
    if (times->groups > 0)
        return median_of_copy(times->median, times->groups);
    return times->pending > 0 ? median_of_pending(times) : 0.0;
}

/* Sums over the regular steps, the gaps, and what does not fit even samples. */
typedef struct assessment {
    size_t gaps, first_gap, missing, regular, uneven, bursts;
    double sum, square_sum;
    imki_step_pattern pattern;
} assessment;

/* Neighbouring steps, and the distances of gaps. */
static void follow_pattern(imki_step_pattern *p, double share, bool gap, size_t row)
{
    const double d = (share < 2.0 ? share : 2.0) - 1.0;
    p->steps++;
    p->sum += d;
    p->square_sum += d * d;
    p->product_sum += d * p->last;
    p->last = d;
    if (!gap)
        return;
    const size_t distance = row - p->gap_row;
    const size_t change =
        distance > p->gap_distance ? distance - p->gap_distance : p->gap_distance - distance;
    p->steady_gaps += change <= 1 + distance / 4;
    p->gap_row = row;
    p->gap_distance = distance;
}

static void assess_odd(assessment *j, double share)
{
    j->bursts += share < 0.25;
    j->uneven += share < 0.4 || (share > 1.35 && share < 4.0 && fabs(share - round(share)) > 0.25);
}

static assessment assess(const imki_record_times *times, double interval, double reference)
{
    assessment j = {.pattern = times->pattern};
    const double rate = 1.0 / interval;
    for (size_t i = 0; i < times->pending; i++) {
        const imki_record_step step = times->step[i];
        const size_t intervals = imk_step_intervals(step.size, interval);
        if (intervals > 1) {
            if (j.gaps++ == 0)
                j.first_gap = step.row;
            j.missing += intervals - 1;
        } else {
            const double deviation = step.size - reference;
            j.regular++;
            j.sum += deviation;
            j.square_sum += deviation * deviation;
        }
        assess_odd(&j, step.size * rate);
        follow_pattern(&j.pattern, step.size * rate, intervals > 1, step.row);
    }
    return j;
}

static void add_assessment(imki_record_times *times, const assessment *j)
{
    imk_log_findings *found = &times->findings;
    if (found->gaps == 0)
        found->first_gap = j->first_gap;
    found->gaps += j->gaps;
    found->missing += j->missing;
    found->uneven += j->uneven;
    found->bursts += j->bursts;
    times->pattern = j->pattern;
    times->regular += j->regular;
    times->deviation_sum += j->sum;
    times->deviation_square_sum += j->square_sum;
}

static void close_group(imki_record_times *times)
{
    if (times->groups == IMKI_STEP_GROUP && times->upper_groups < IMKI_STEP_GROUP) {
        times->upper[times->upper_groups++] = median_of(times->median, times->groups);
        times->groups = 0;
    }
    if (times->groups < IMKI_STEP_GROUP)
        times->median[times->groups++] = median_of_pending(times);
    times->findings.interval = interval_now(times);
    if (times->reference == 0.0)
        times->reference = times->findings.interval;
    const assessment j = assess(times, times->findings.interval, times->reference);
    add_assessment(times, &j);
    times->pending = 0;
}

void imki_record_times_add(imki_record_times *times, size_t first_row, size_t count,
                           const double *time)
{
    imk_log_findings *found = &times->findings;
    for (size_t i = 0; i < count; i++) {
        const double step = time[i] - times->last_time;
        times->last_time = time[i];
        if (isfinite(time[i])) {
            if (times->times++ == 0)
                found->first_time = time[i];
            found->last_time = time[i];
        } else {
            times->last_time = (double)NAN;
        }
        if (step > 0.0 && isfinite(step)) {
            times->step[times->pending++] = (imki_record_step){step, first_row + i};
            if (times->pending == IMKI_STEP_GROUP)
                close_group(times);
        } else if (step == 0.0) {
            if (found->repeats++ == 0)
                found->first_repeat = first_row + i;
        } else if (step < 0.0) {
            if (found->reversals++ == 0)
                found->first_reversal = first_row + i;
            found->largest_reversal = fmax(found->largest_reversal, -step);
        }
    }
}

/* Correlation of neighbouring steps; how many gaps are as far from the one before as that was. */
static void tell_pattern(const imki_step_pattern *p, imk_log_findings *found)
{
    const double n = (double)p->steps;
    if (p->steps < 3)
        return;
    const double mean = p->sum / n, variance = p->square_sum / n - mean * mean;
    if (variance > 0.0) {
        found->step_scatter = sqrt(variance);
        found->step_correlation = (p->product_sum / n - mean * mean) / variance;
    }
    found->steady_gaps = p->steady_gaps;
}

imk_log_findings imki_record_times_findings(const imki_record_times *times)
{
    imk_log_findings found = times->findings;
    const double interval = interval_now(times);
    const double reference = times->reference > 0.0 ? times->reference : interval;
    const assessment j = assess(times, interval, reference);
    if (found.gaps == 0)
        found.first_gap = j.first_gap;
    found.gaps += j.gaps;
    found.missing += j.missing;
    found.uneven += j.uneven;
    found.bursts += j.bursts;
    found.interval = interval;
    tell_pattern(&j.pattern, &found);
    const double regular = (double)(times->regular + j.regular);
    if (regular > 0.0) {
        /* mean((s - I)^2) from the sums about the reference r, with e = I - r */
        const double mean = (times->deviation_sum + j.sum) / regular;
        const double square = (times->deviation_square_sum + j.square_sum) / regular;
        const double e = interval - reference;
        found.mean_step = reference + mean;
        const double jitter_square = square - 2.0 * e * mean + e * e;
        found.jitter = jitter_square > 0.0 ? sqrt(jitter_square) : 0.0;
    }
    return found;
}
