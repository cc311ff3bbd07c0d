/* SPDX-License-Identifier: Apache-2.0 */
/* Moments of short blocks of samples: mean and sum of squares about it, both relative to the first
 * sample of the block so that nothing cancels at 33 000 counts. Longer blocks are joined from
 * pairs, q = q1 + q2 + n/4 (m1 - m2)^2 for n samples in both [CHAN1983], windows from four. */
#include "static_internal.h"

#include "imukit/samples.h"

#include <math.h>
#include <string.h>

/* As many neighbours tell the step of an axis that is quantized. */
enum { STEP_SAMPLES = 32768 };

double imki_static_step(const double *reading, size_t begin, size_t end)
{
    double step = (double)INFINITY;
    for (size_t k = begin + 1; k < end; k++) {
        const double d = fabs(reading[k] - reading[k - 1]);
        if (d > 0.0 && d < step)
            step = d;
    }
    return isfinite(step) ? step : 0.0;
}

static void axis_ranges(const imk_test_record *record, const imk_model *model,
                        imki_static_axis *axis)
{
    axis->range_low = -(double)INFINITY;
    axis->range_high = (double)INFINITY;
    axis->zero = 0.0;
    axis->unit = record->counts[axis->sensor] ? 0.0 : 1.0;
    if (!model)
        return;
    const imk_triad *triad = imk_model_triad(model, axis->sensor);
    if (!triad->present || axis->axis >= triad->axis_count)
        return;
    double per_unit = 1.0;
    if (record->counts[axis->sensor]) {
        per_unit = triad->sensitivity.value[axis->axis];
        if (per_unit == 0.0)
            return;
        axis->unit = 1.0 / per_unit;
        axis->zero = triad->zero_offset.value[axis->axis];
    }
    /* A step below full scale is full scale already: where the range is no multiple of the step. */
    const double range = triad->range.value[axis->axis] * fabs(per_unit);
    if (range > axis->step) {
        axis->range_low = axis->zero - range + 0.5 * axis->step;
        axis->range_high = axis->zero + range - 0.5 * axis->step;
    }
}

void imki_static_axes(const imk_test_record *record, const imk_model *model, imki_static_job *job)
{
    job->record = record;
    job->axis_count = 0;
    for (int sensor = 0; sensor < 2; sensor++)
        for (int i = 0; i < record->axis_count[sensor]; i++) {
            if (!record->reading[sensor][i])
                continue;
            imki_static_axis *axis = &job->axis[job->axis_count++];
            *axis = (imki_static_axis){
                .sensor = sensor, .axis = i, .reading = record->reading[sensor][i]};
            const size_t few = record->count < STEP_SAMPLES ? record->count : STEP_SAMPLES;
            axis->step = imki_static_step(axis->reading, 0, few);
            if (axis->step == 0.0)
                axis->step = imki_static_step(axis->reading, few, record->count);
            axis_ranges(record, model, axis);
        }
}

/* Four sums side by side: the additions of one do not wait for each other. */
imki_moments imki_static_moments(const double *x, size_t n)
{
    const double first = x[0];
    double sum[4] = {0.0, 0.0, 0.0, 0.0}, square[4] = {0.0, 0.0, 0.0, 0.0};
    size_t k = 0;
    for (; k + 4 <= n; k += 4)
        for (size_t j = 0; j < 4; j++) {
            const double d = x[k + j] - first;
            sum[j] += d;
            square[j] += d * d;
        }
    for (; k < n; k++) {
        sum[0] += x[k] - first;
        square[0] += (x[k] - first) * (x[k] - first);
    }
    const double off = ((sum[0] + sum[1]) + (sum[2] + sum[3])) / (double)n;
    const double about =
        ((square[0] + square[1]) + (square[2] + square[3])) - (double)n * off * off;
    return (imki_moments){first + off, about > 0.0 ? about : 0.0};
}

/* An axis that sticks at the end of its readings while it otherwise scatters over more than a step
 * is saturated there, whether or not a range is stated. */
static void flag_stuck(const imki_static_job *job, int a, imk_static_findings *findings)
{
    const imki_static_axis *axis = &job->axis[a];
    const imki_static_blocks *b = &job->blocks;
    size_t lively = 0, usable = 0, constant = 0;
    for (size_t k = 0; k < b->count; k++)
        if (!(b->flag[k] & IMKI_BLOCK_INVALID)) {
            usable++;
            lively += b->square[a][k] > (double)b->length * axis->step * axis->step;
            constant += b->square[a][k] == 0.0;
        }
    if (constant == 0 || b->length < 4 || lively < usable / 2)
        return;
    double lowest = (double)INFINITY, highest = -(double)INFINITY;
    for (size_t k = 0; k < b->count * b->length; k++) {
        const double x = axis->reading[k];
        lowest = x < lowest ? x : lowest;
        highest = x > highest ? x : highest;
    }
    for (size_t k = 0; k < b->count; k++) {
        const double value = axis->reading[k * b->length];
        if (!(b->flag[k] & IMKI_BLOCK_INVALID) && b->square[a][k] == 0.0 &&
            (value <= lowest || value >= highest)) {
            findings->saturated += b->length;
            b->flag[k] |= IMKI_BLOCK_INVALID;
        }
    }
}

/* Is a sample of these at or beyond the range? */
static bool beyond_range(const imki_static_axis *axis, const double *x, size_t n)
{
    bool beyond = false;
    if (isfinite(axis->range_high))
        for (size_t k = 0; k < n; k++)
            beyond |= x[k] <= axis->range_low || x[k] >= axis->range_high;
    return beyond;
}

/* Samples of a block that cannot be used, each counted once. */
static void count_unusable(const imki_static_job *job, size_t block, imk_static_findings *findings)
{
    const size_t begin = block * job->blocks.length, end = begin + job->blocks.length;
    for (size_t k = begin; k < end; k++) {
        bool missing = false, saturated = false;
        for (int a = 0; a < job->axis_count; a++) {
            const imki_static_axis *axis = &job->axis[a];
            const double x = axis->reading[k];
            missing |= !isfinite(x);
            saturated |= x <= axis->range_low || x >= axis->range_high;
        }
        findings->not_finite += missing;
        findings->saturated += saturated && !missing;
    }
}

/* Gaps in time and borders of sections: nothing is averaged across them. */
static void flag_breaks(const imki_static_job *job)
{
    const imk_test_record *r = job->record;
    const imki_static_blocks *b = &job->blocks;
    if (!r->time && !r->section)
        return;
    const size_t samples = b->count * b->length;
    for (size_t k = 1; k < samples; k++) {
        const bool gap = r->time && imk_step_is_gap(r->time[k] - r->time[k - 1], r->dt);
        if (!gap && !(r->section && r->section[k] != r->section[k - 1]))
            continue;
        b->flag[k / b->length] |= k % b->length == 0 ? IMKI_BLOCK_BREAK : IMKI_BLOCK_INVALID;
    }
}

void imki_static_blocks_fill(imki_static_job *job, imk_static_findings *findings)
{
    imki_static_blocks *b = &job->blocks;
    memset(b->flag, 0, b->count);
    for (int a = 0; a < job->axis_count; a++) {
        const imki_static_axis *axis = &job->axis[a];
        for (size_t k = 0; k < b->count; k++) {
            const double *x = axis->reading + k * b->length;
            const imki_moments m = imki_static_moments(x, b->length);
            const bool usable = isfinite(m.mean) && isfinite(m.square);
            if (!usable || beyond_range(axis, x, b->length))
                b->flag[k] |= IMKI_BLOCK_INVALID;
            b->mean[a][k] = usable ? m.mean : 0.0;
            b->square[a][k] = usable ? m.square : 0.0;
        }
    }
    for (size_t k = 0; k < b->count; k++)
        if (b->flag[k] & IMKI_BLOCK_INVALID)
            count_unusable(job, k, findings);
    for (int a = 0; a < job->axis_count; a++)
        if (job->axis[a].step > 0.0)
            flag_stuck(job, a, findings);
    flag_breaks(job);
}

void imki_static_blocks_join(imki_static_job *job)
{
    imki_static_blocks *b = &job->blocks;
    const double quarter = 0.5 * (double)b->length; /* n/4 of n = 2 length samples */
    const size_t count = b->count / 2;
    for (int a = 0; a < job->axis_count; a++) {
        double *m = b->mean[a], *q = b->square[a];
        for (size_t k = 0; k < count; k++) {
            const double d = m[2 * k] - m[2 * k + 1];
            q[k] = q[2 * k] + q[2 * k + 1] + quarter * d * d;
            m[k] = 0.5 * (m[2 * k] + m[2 * k + 1]);
        }
    }
    for (size_t k = 0; k < count; k++) {
        const uint8_t first = b->flag[2 * k], second = b->flag[2 * k + 1];
        b->flag[k] = (uint8_t)(first | (second & IMKI_BLOCK_INVALID) |
                               (second & IMKI_BLOCK_BREAK ? IMKI_BLOCK_INVALID : 0));
    }
    b->count = count;
    b->length *= 2;
}
