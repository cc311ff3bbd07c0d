/* SPDX-License-Identifier: Apache-2.0 */
/* Few missing samples of a long record: a straight line between the levels on either side, and
 * white noise about it as strong as the differences of neighbours say. Where at most a hundredth is
 * missing this is as good as the truth for the spectrum's other 99 hundredths. */
#include "imukit/random.h"
#include "long_record_internal.h"

#include <math.h>

enum { LEVEL = 8, DRAWN = 64 };

/* Half the mean square of differences between neighbours: their variance, when they are white. */
static double white_deviation(size_t count, const double *samples)
{
    double sum = 0, pairs = 0;
    for (size_t i = 1; i < count; i++) {
        const double d = samples[i] - samples[i - 1];
        if (d == d) {
            sum += d * d;
            pairs++;
        }
    }
    return pairs > 0 ? sqrt(0.5 * sum / pairs) : 0;
}

/* Mean of up to LEVEL samples that are there, from `place` on in a direction; NaN without any. */
static double level_at(size_t count, const double *samples, size_t place, bool forward)
{
    double sum = 0, present = 0;
    for (size_t i = place; i < count && present < LEVEL; i = forward ? i + 1 : i - 1)
        if (samples[i] == samples[i]) {
            sum += samples[i];
            present++;
        }
    return present > 0 ? sum / present : (double)NAN;
}

static void bridge_run(size_t count, double *samples, size_t from, size_t to, double deviation,
                       uint64_t stream, uint64_t first)
{
    double left = from > 0 ? level_at(count, samples, from - 1, false) : (double)NAN;
    double right = level_at(count, samples, to, true), normal[DRAWN];
    left = left == left ? left : right == right ? right : 0;
    right = right == right ? right : left;
    const imk_random random = imk_random_seeded(1);
    for (size_t i = from; i < to; i++) {
        const size_t drawn = (i - from) % DRAWN;
        if (drawn == 0)
            imk_random_normals(random, stream, first + i, to - i < DRAWN ? to - i : DRAWN, normal);
        const double part = (double)(i + 1 - from) / (double)(to + 1 - from);
        samples[i] = left + (right - left) * part + deviation * normal[drawn];
    }
}

void imki_record_bridge(size_t count, double *samples, uint64_t stream, uint64_t first)
{
    const double deviation = white_deviation(count, samples);
    for (size_t i = 0; i < count; i++) {
        size_t to = i;
        while (to < count && samples[to] != samples[to])
            to++;
        if (to > i)
            bridge_run(count, samples, i, to, deviation, stream, first);
        i = to;
    }
}
