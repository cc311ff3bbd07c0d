/* SPDX-License-Identifier: Apache-2.0 */
/* What samples show by themselves: the step they lie on, and values that pile up at an end. */
#include "identify/likelihood/identify_internal.h"
#include "screen_internal.h"

#include <math.h>

/* Smallest step between different ones of some sorted values that lie on a grid of that step (to
 * 1 %, so that a unit conversion's rounding does not hide it); else 0. */
static double step_among(size_t count, const double *sorted)
{
    const double span = sorted[count - 1] - sorted[0];
    double step = HUGE_VAL;
    for (size_t i = 1; i < count; i++) {
        const double d = sorted[i] - sorted[i - 1];
        if (d > 1e-9 * span && d < step)
            step = d;
    }
    /* An outlier may stretch the span: the steps must be few for the inner nine tenths. */
    const double inner = sorted[count - 1 - count / 20] - sorted[count / 20];
    if (!(step < HUGE_VAL) || !(inner / step < (double)count / 4))
        return 0;
    for (size_t i = 1; i < count; i++) {
        const double steps = (sorted[i] - sorted[i - 1]) / step;
        if (fabs(steps - floor(steps + 0.5)) > 0.05)
            return 0;
    }
    return step;
}

double imki_record_resolution(size_t n, const double *samples, double *scratch,
                              size_t scratch_count)
{
    size_t count = 0;
    for (size_t i = 0; i < n && count < scratch_count; i++)
        if (imki_is_there(samples[i]))
            scratch[count++] = samples[i];
    if (count < 2)
        return 0;
    imki_sort(scratch, count);
    /* Beside an outlier far enough away all others would be one value; they are different when it
     * is by more than rounding. */
    const size_t tail = count / 20;
    const double low = scratch[tail], high = scratch[count - 1 - tail];
    if (high - low < 1e-9 * (scratch[count - 1] - scratch[0]) &&
        high - low > 1e-12 * fmax(fabs(low), fabs(high)))
        return step_among(count - 2 * tail, scratch + tail);
    return step_among(count, scratch);
}

/* An extreme value that piles up: more than three times as many samples on it as on the next value
 * within a step of it, and some in a row. */
bool imki_record_sticks(size_t n, const double *samples, double extreme, double toward, double step)
{
    size_t on = 0, beside = 0, run = 0, longest = 0;
    for (size_t i = 0; i < n; i++)
        on += samples[i] == extreme;
    for (size_t i = 0; on > 10 && i < n; i++) {
        const bool at = samples[i] == extreme;
        beside += !at && fabs(samples[i] - extreme) <= step && (samples[i] - extreme) * toward > 0;
        run = at ? run + 1 : imki_is_there(samples[i]) ? 0 : run;
        longest = run > longest ? run : longest;
    }
    return longest >= 3 && on > 10 + 3 * beside;
}
