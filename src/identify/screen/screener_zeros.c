/* SPDX-License-Identifier: Apache-2.0 */
/* Zeros, and other values, that are no measurements.
 *
 * Loggers write 0, -32768, 999 or 1e9 where a row was lost. Such zeros lie outside the other
 * samples of their chunk: these are all on one side of zero, which is farther from them than a
 * quarter of their range (6 standard deviations from their mean, for a range of 8) and three steps.
 * Another value must come twice in a chunk, to the digit, and be twice the range of the others
 * away. They are taken out like stuck samples.
 *
 * Zeros among the noise may be too many: a driver that puts small values to zero, or cuts values
 * off toward zero. How many are due, the values beside zero tell. Where the step q between values
 * is fine, as many as the mean of those up to k = scale/(2 q) steps on either side; where there is
 * no step, and no other value comes more than three times, none; where it is coarse, by the
 * logarithm of the numbers n_k of k steps, which is a parabola for Gaussian noise about any mean:
 *
 *     ln n_0 = (4 (ln n_1 + ln n_-1) - ln n_2 - ln n_-2)/6
 *
 * Noise with heavy tails has a peak that is sharper than these: a corner in Laplace's density. Each
 * side by itself is a straight line there, or with three values a parabola; where this has more
 * zeros due, it counts. Steps beyond 1.4 scales are not tested: where the level moves, a mixture of
 * such noise is no parabola, and white noise is doubted for the steps. */
#include "imukit/elementary.h"
#include "screener_internal.h"

#include <math.h>

enum { STEPS = 3, FAR = 30, REPEATS = 3, FINE = 3, ONE_MIN = 25, TWO_MIN = 4 };

/* Of the range of the other samples: so far are they from zero, and from another value. */
static const double apart = 0.25, far_apart = 2;
static const double least_share = 0.015, least_factor = 1.2;

static size_t count_zeros(size_t count, const double *x)
{
    size_t zeros = 0;
    for (size_t i = 0; i < count; i++)
        zeros += x[i] == 0;
    return zeros;
}

/* Lowest and highest of the samples that are not of a value; how many are. */
static size_t extremes_without(size_t count, const double *x, double value, double *low,
                               double *high)
{
    size_t equal = 0;
    *low = HUGE_VAL;
    *high = -HUGE_VAL;
    for (size_t i = 0; i < count; i++) {
        equal += x[i] == value;
        *low = x[i] != value && x[i] < *low ? x[i] : *low;
        *high = x[i] != value && x[i] > *high ? x[i] : *high;
    }
    return equal;
}

static void mark_lost(imk_screener *s, double value)
{
    imk_screen_count *lost = &s->found.lost;
    const double *x = s->raw[0];
    for (size_t i = 0; i < s->count[0]; i++) {
        if (x[i] != value || s->mark[i])
            continue;
        const size_t place = s->chunk * IMKI_SCREEN_CHUNK + i;
        lost->first = lost->count++ == 0 ? place : lost->first;
        lost->runs += i == 0 || x[i - 1] != value;
        s->mark[i] |= IMKI_MARK_STUCK;
        s->marked = true;
    }
    s->found.lost_value = value;
}

/* Does a value at an end of the chunk stand for lost rows? */
static bool stands_for_lost(const imk_screener *s, double value)
{
    double low, high;
    const size_t equal = extremes_without(s->count[0], s->raw[0], value, &low, &high);
    if (!(low <= high) || low == high)
        return false;
    const bool known = s->found.lost.count > 0 && value == s->found.lost_value;
    const double gap = fmax(low - value, value - high), range = high - low;
    /* a larger step is that of the code */
    const double steps = s->step <= range ? STEPS * s->step : 0;
    return gap > (value == 0 ? apart : far_apart) * range + steps &&
           (value == 0 || equal > 1 || known);
}

void imki_screen_lost(imk_screener *s)
{
    const double ends[2] = {s->lowest[0], s->highest[0]};
    const bool far = !(s->scale > 0) || ends[1] - ends[0] > FAR * s->scale;
    for (int k = 0; k < 2; k++)
        if ((ends[k] == 0 || far) && stands_for_lost(s, ends[k]))
            mark_lost(s, ends[k]);
}

/* Samples within two limits that are not zero. */
static double count_between(const imk_screener *s, double low, double high)
{
    size_t count = 0;
    for (size_t i = 0; i < s->count[0]; i++)
        count += (s->clean[i] != 0) & (s->clean[i] > low) & (s->clean[i] < high);
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

static void add_coarse(imk_screener *s, double zeros)
{
    imki_zeros *z = &s->zeros;
    z->coarse += zeros;
    for (int k = 0; k < 3; k++) {
        const double low = (k + 0.5) * s->step, high = (k + 1.5) * s->step;
        z->above[k] += count_between(s, low, high);
        z->below[k] += count_between(s, -high, -low);
    }
}

static void add_fine(imk_screener *s)
{
    imki_zeros *z = &s->zeros;
    const double reach = floor(0.5 * s->scale / s->step), half = ceil(0.5 * reach);
    const double near_end = (half + 0.5) * s->step, end = (reach + 0.5) * s->step;
    const double near = count_between(s, -near_end, near_end);
    const double far = count_between(s, -end, end) - near;
    z->near += near;
    z->far += far;
    z->near_due += near / (2 * half);
    z->far_due += far / (2 * (reach - half));
    z->weight += near / (2 * half) * (half + 1) / reach;
}

void imki_screen_zeros(imk_screener *s)
{
    imki_zeros *z = &s->zeros;
    if (!imki_screen_counts(s->chunk))
        return;
    z->samples += (double)s->count[0];
    const double zeros = (double)count_zeros(s->count[0], s->clean), step = s->step;
    if (zeros == 0 || !imki_screen_has_noise(s))
        return;
    if (step > 0 && step * 2 * FINE > s->scale) {
        add_coarse(s, zeros);
    } else if (step > 0) {
        add_fine(s);
        z->fine += zeros;
    } else if (most_frequent(s) <= REPEATS) {
        z->fine += zeros;
    }
}

/* Those whose number and its variance are higher. */
static void allow(imki_excess *e, double due, double relative_variance)
{
    if (due > e->due) {
        e->due = due;
        e->variance = due + due * due * relative_variance;
    }
}

static void allow_fine(const imki_zeros *z, imki_excess *e)
{
    if (!(z->near > 0 && z->far > 0))
        return;
    const double w = z->weight / z->near_due, w1 = 1 + w;
    const double mean = 0.5 * (z->near_due + z->far_due);
    allow(e, mean, 1 / (z->near + z->far));
    allow(e, z->near_due * imk_exp(w * imk_ln(z->near_due / z->far_due)),
          w1 * w1 / z->near + w * w / z->far);
}

static void allow_coarse(const imki_zeros *z, imki_excess *e)
{
    const double *above = z->above, *below = z->below;
    if (!(fmin(above[0], below[0]) >= ONE_MIN && fmin(above[1], below[1]) >= TWO_MIN))
        return;
    double l[3], v[3];
    for (int k = 0; k < 3; k++) {
        l[k] = 0.5 * (imk_ln(above[k]) + imk_ln(below[k]));
        v[k] = 0.25 / above[k] + 0.25 / below[k];
    }
    imki_excess here = {.due = 0};
    allow(&here, imk_exp((4 * l[0] - l[1]) / 3), (16 * v[0] + v[1]) / 9);
    if (fmin(above[2], below[2]) >= ONE_MIN)
        allow(&here, imk_exp(3 * l[0] - 3 * l[1] + l[2]), 9 * v[0] + 9 * v[1] + v[2]);
    e->counted += z->coarse;
    e->due += here.due;
    e->variance += here.variance;
}

double imki_zeros_excess(const imki_zeros *z)
{
    imki_excess e = {z->samples, z->fine, 0, 0};
    allow_fine(z, &e);
    allow_coarse(z, &e);
    return imki_excess_share(&e, least_share, least_factor);
}
