/* SPDX-License-Identifier: Apache-2.0 */
/* What can be wrong with a record before any noise model: coarse steps, saturation, repeated
 * samples, warm-up. */
#include "identify/likelihood/identify_internal.h"
#include "screen_internal.h"

#include <math.h>

/* A thousandth, for a record of six channels. */
#define WARM_UP_FALSE (1e-3 / 6)

unsigned imki_record_verdict(size_t n, const double *samples, double resolution, double deviation)
{
    unsigned verdict = 0;
    double low = HUGE_VAL, high = -HUGE_VAL, previous = (double)NAN;
    size_t repeats = 0, present = 0;
    for (size_t i = 0; i < n; i++) {
        if (!imki_is_there(samples[i]))
            continue;
        low = samples[i] < low ? samples[i] : low;
        high = samples[i] > high ? samples[i] : high;
        repeats += samples[i] == previous;
        previous = samples[i];
        present++;
    }
    const double step = resolution > 0 ? resolution * 1.01 : 0.1 * deviation;
    if (imki_record_sticks(n, samples, high, -1, step) ||
        imki_record_sticks(n, samples, low, 1, step))
        verdict |= IMK_VERDICT_SATURATED;
    if (resolution > deviation)
        verdict |= IMK_VERDICT_COARSE;
    /* Independent samples repeat in about resolution/(2 sqrt(pi) deviation) of steps. */
    if ((double)repeats > 0.4 * (double)present && resolution < 0.5 * deviation)
        verdict |= IMK_VERDICT_FROZEN;
    imk_screen trend = {0};
    imki_trend_find(WARM_UP_FALSE, n, samples, &trend);
    if (trend.warm_up)
        verdict |= IMK_VERDICT_WARM_UP;
    return verdict;
}
