/* SPDX-License-Identifier: Apache-2.0 */
/* Zeros that are no measurements.
 *
 * Loggers write 0 where a row was lost. Such zeros lie outside the other samples of their chunk:
 * these are all on one side of zero, which is farther from them than a quarter of their range (6
 * standard deviations from their mean, for a range of 8) and three steps. They are taken out like
 * stuck samples.
 *
 * Zeros among the noise may be too many: a driver that puts small values to zero, or cuts values
 * off toward zero. How many are due, the values beside zero tell. Where the step q between values
 * is fine, as many as the mean of those up to k = scale/(2 q) steps on either side; where there is
 * no step, and no other value comes more than three times, none; where it is coarse, by the
 * logarithm of the numbers n_k of k steps, which is a parabola for Gaussian noise about any mean:
 *
 *     ln n_0 = (4 (ln n_1 + ln n_-1) - ln n_2 - ln n_-2)/6
 *
 * Steps beyond 1.4 scales are not tested: where the level moves, a mixture of such noise is no
 * parabola, and white noise is doubted for the steps. */
#include "imukit/elementary.h"
#include "screener_internal.h"

#include <math.h>

enum { EVERY = 8, STEPS = 3, REPEATS = 3, FINE = 3, COUNTED_MIN = 25 };

static const double apart = 0.25; /* of the range: so far from zero are the other samples */
/* Zeros among the noise are too many when they are more than due by these. */
static const double coarsest = 1.4;
static const double least_share = 0.015, least_factor = 1.2, deviations = 6;

static size_t count_zeros(size_t count, const double *x)
{
    size_t zeros = 0;
    for (size_t i = 0; i < count; i++)
        zeros += x[i] == 0;
    return zeros;
}

/* Lowest and highest of the samples that are not zero. */
static bool extremes_without_zeros(size_t count, const double *x, double *low, double *high)
{
    *low = HUGE_VAL;
    *high = -HUGE_VAL;
    for (size_t i = 0; i < count; i++) {
        *low = x[i] != 0 && x[i] < *low ? x[i] : *low;
        *high = x[i] != 0 && x[i] > *high ? x[i] : *high;
    }
    return *low <= *high;
}

static void mark_lost(imk_screener *s)
{
    imk_screen_count *lost = &s->found.lost;
    const double *x = s->raw[0];
    for (size_t i = 0; i < s->count[0]; i++) {
        if (x[i] != 0 || s->mark[i])
            continue;
        const size_t place = s->chunk * IMKI_SCREEN_CHUNK + i;
        lost->first = lost->count++ == 0 ? place : lost->first;
        lost->runs += i == 0 || x[i - 1] != 0;
        s->mark[i] |= IMKI_MARK_STUCK;
        s->marked = true;
    }
}

void imki_screen_lost(imk_screener *s)
{
    double low, high;
    const bool at_end = s->lowest[0] == 0 || s->highest[0] == 0;
    if (!at_end || !extremes_without_zeros(s->count[0], s->raw[0], &low, &high))
        return;
    if (fmax(low, -high) > apart * (high - low) + STEPS * s->step)
        mark_lost(s);
}

/* Samples within two limits that are not zero. */
static double count_between(const imk_screener *s, double low, double high)
{
    size_t count = 0;
    for (size_t i = 0; i < s->count[0]; i++)
        count += s->clean[i] != 0 && s->clean[i] > low && s->clean[i] < high;
    return (double)count;
}

/* How often the most frequent size of the values within three scales of zero comes. */
static size_t most_frequent(imk_screener *s)
{
    size_t count = 0, most = 0, run = 0;
    for (size_t i = 0; i < s->count[0]; i++) {
        s->value[count] = fabs(s->clean[i]);
        count += s->value[count] > 0 && s->value[count] < 3 * s->scale;
    }
    imki_sort(s->value, count);
    for (size_t i = 0; i < count; i++) {
        run = i > 0 && s->value[i] == s->value[i - 1] ? run + 1 : 1;
        most = run > most ? run : most;
    }
    return most;
}

void imki_screen_zeros(imk_screener *s)
{
    imki_zeros *z = &s->zeros;
    if (s->chunk % EVERY != 0)
        return;
    z->samples += (double)s->count[0];
    const double zeros = (double)count_zeros(s->count[0], s->clean), step = s->step;
    if (zeros == 0 || !(s->scale > 0) || step > coarsest * s->scale)
        return;
    if (step > 0 && step * 2 * FINE > s->scale) {
        z->coarse += zeros;
        for (int k = 0; k < 2; k++) {
            const double low = (k + 0.5) * step, high = (k + 1.5) * step;
            z->above[k] += count_between(s, low, high);
            z->below[k] += count_between(s, -high, -low);
        }
        return;
    }
    if (step > 0) {
        const double reach = floor(0.5 * s->scale / step);
        const double limit = (reach + 0.5) * step;
        const double due = count_between(s, -limit, limit) / (2 * reach);
        z->due += due;
        z->variance += due + due / (2 * reach);
    } else if (most_frequent(s) > REPEATS) {
        return;
    }
    z->fine += zeros;
}

double imki_zeros_excess(const imki_zeros *z)
{
    const double least = fmin(fmin(z->above[0], z->above[1]), fmin(z->below[0], z->below[1]));
    double due = z->due, variance = z->variance, zeros = z->fine;
    if (least >= COUNTED_MIN) {
        const double one = imk_ln(z->above[0]) + imk_ln(z->below[0]);
        const double two = imk_ln(z->above[1]) + imk_ln(z->below[1]);
        const double here = imk_exp((4 * one - two) / 6);
        due += here;
        variance +=
            here + here * here *
                       (16 / z->above[0] + 16 / z->below[0] + 1 / z->above[1] + 1 / z->below[1]) /
                       36;
        zeros += z->coarse;
    }
    const double excess = zeros - due;
    return excess > least_share * z->samples && zeros > least_factor * due &&
                   excess > deviations * sqrt(variance)
               ? excess / z->samples
               : 0;
}
