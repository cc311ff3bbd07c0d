/* SPDX-License-Identifier: Apache-2.0 */
/* Is a log interpolated from a slower sensor?
 *
 * Between samples of the sensor the noise of a log is averaged more or less, in a cycle: the second
 * differences are noise whose strength has lines at a = f_sensor/f_log and its multiples. Noise
 * whose strength has the cycle a couples the coefficients X(f) and X(f + a) at all frequencies f;
 * stationary noise couples none, whatever its spectrum is [GARDNER2006]. So every coefficient is
 * given the same size, and
 *
 *     C(a) = sum_f U(f + a) U*(f),   U = X/|X|
 *
 * is a sum of directions by chance, |C|^2 over its mean an exponential number. A tone makes a few
 * coefficients large but not more than a few equal; those far above their neighbours are left out.
 * C is the transform of u^2, u the inverse transform of U. It is averaged over segments. */
#include "imukit/distributions.h"
#include "screener_internal.h"

#include "base/transform/fourier_internal.h"

#include <math.h>

enum {
    SEGMENT = IMKI_CYCLE_SEGMENT,
    HALF = SEGMENT / 2,
    STRIDE = SEGMENT + 2, /* samples of a segment of second differences */
    GROUP = 32,           /* coefficients among which one is large */
    EARLY = 4,            /* chunks that are used in full; of later ones the first segment, */
    MANY = 32,
    EVERY = 4,  /* and after so many of every fourth one */
    LEAST = 12, /* cycles in a segment: slower ones are changes of the noise */
    SEGMENTS_MIN = 4
};

/* A coefficient beyond so many medians of the power about it is left out: 0.4 % of them by chance.
 */
static const double large = 8;
/* One segment alone is no evidence: an exponential number is above this with a chance of 1e-7. */
static const double most = 16;
/* Less is a modulation of the noise by some per cent, which an interpolation exceeds by far. Rows
 * of two sensors in turn may differ by less and move white noise by more than its interval. */
static const double matters = 3, matters_alternating = 1.3;
/* Share of the second differences of a segment that may be missing. */
static const double missing_most = 0.05;

void imki_cycles_begin(imki_cycles *c)
{
    imki_roots(SEGMENT, SEGMENT, c->roots);
}

/* Complex second differences times a Hann window. @return the number that is there; `square` is
 * set to the sum of their squares without the window */
static size_t differences(const imki_cycles *c, const double *x, double *out, double *square)
{
    size_t there = 0;
    *square = 0;
    for (size_t i = 0; i < SEGMENT; i++) {
        const double second = x[i + 2] - x[i + 1] - (x[i + 1] - x[i]);
        const bool is = second == second;
        const double d = is ? second : 0;
        there += is;
        *square += d * d;
        out[2 * i] = d * (1 - c->roots[2 * i]);
        out[2 * i + 1] = 0;
    }
    return there;
}

/* How many second differences vanish, and how many do by chance. */
static void count_straight(imki_cycles *c, const double *x, double deviation, double step)
{
    const double small = fmax(1e-3 * deviation, 2.5 * step);
    const double chance = 2 * imk_normal_probability(small / deviation) - 1;
    for (size_t i = 0; i < SEGMENT; i++)
        c->straight += fabs(x[i + 2] - x[i + 1] - (x[i + 1] - x[i])) < small;
    c->straight_by_chance += chance * SEGMENT;
    c->differences += SEGMENT;
}

/* The coefficients in one size each; those far above the ones about them, and the mean, are 0. */
static void level_spectrum(double *data, double *power, double *sorted)
{
    for (size_t k = 0; k < HALF; k++)
        power[k] = data[2 * k] * data[2 * k] + data[2 * k + 1] * data[2 * k + 1];
    for (size_t group = 0; group < HALF; group += GROUP) {
        for (size_t k = 0; k < GROUP; k++)
            sorted[k] = power[group + k];
        imki_sort(sorted, GROUP);
        const double limit = large * sorted[GROUP / 2];
        for (size_t k = group; k < group + GROUP; k++) {
            const bool kept = k > 0 && power[k] > 0 && power[k] < limit;
            const double scale = kept ? 1 / sqrt(power[k]) : 0;
            data[2 * k] *= scale;
            data[2 * k + 1] *= scale;
        }
    }
    data[2 * HALF] = data[2 * HALF + 1] = 0;
    for (size_t k = 1; k < HALF; k++) {
        data[2 * (SEGMENT - k)] = data[2 * k];
        data[2 * (SEGMENT - k) + 1] = -data[2 * k + 1];
    }
}

/* |C|^2 of a segment joins the sums. */
static void add_segment(imki_cycles *c, const double *x, double step, double *room)
{
    double *a = room, *b = a + 2 * SEGMENT, *power = b + 2 * SEGMENT, square, sum = 0;
    imki_factors factors;
    const size_t there = differences(c, x, a, &square);
    if ((double)there < (1 - missing_most) * SEGMENT || !(square > 0))
        return;
    count_straight(c, x, sqrt(square / (double)there), step);
    imki_factorise(SEGMENT, &factors);
    double *spectrum = imki_stockham_single(&factors, SEGMENT, c->roots, a, b);
    level_spectrum(spectrum, power, power + HALF);
    double *signal =
        imki_stockham_single(&factors, SEGMENT, c->roots, spectrum, spectrum == a ? b : a);
    for (size_t i = 0; i < SEGMENT; i++) {
        signal[2 * i] *= signal[2 * i];
        signal[2 * i + 1] = 0;
    }
    const double *coupling =
        imki_stockham_single(&factors, SEGMENT, c->roots, signal, signal == a ? b : a);
    for (size_t k = LEAST; k <= HALF; k++) {
        power[k] = coupling[2 * k] * coupling[2 * k] + coupling[2 * k + 1] * coupling[2 * k + 1];
        sum += power[k];
    }
    if (!(sum > 0))
        return;
    for (size_t k = LEAST; k <= HALF; k++) {
        const double part = power[k] * (HALF + 1 - LEAST) / sum;
        c->whole[k] += part;
        c->sum[k] += fmin(part, most);
    }
    c->segments++;
}

void imki_cycles_add(imki_cycles *c, size_t chunk, size_t count, const double *samples, double step,
                     double *room)
{
    const size_t end = chunk < EARLY ? count : STRIDE < count ? STRIDE : count;
    if (chunk >= MANY && chunk % EVERY != 0)
        return;
    for (size_t from = 0; from + STRIDE <= end; from += STRIDE)
        add_segment(c, samples + from, step, room);
}

/* Mean of one segment over those of cycles about it, which short bursts of noise raise. */
static double prominence(const imki_cycles *c, size_t at)
{
    enum { NEAR = 5, FAR = 24 };
    double sum = 0, count = 0;
    for (size_t k = at > LEAST + FAR ? at - FAR : LEAST; k <= at + FAR && k <= HALF; k++)
        if (k + NEAR < at || k > at + NEAR) {
            sum += c->sum[k];
            count++;
        }
    return c->sum[at] / c->segments / fmax(1, sum / (count * c->segments));
}

/* The strongest cycle of some. */
static size_t strongest(const imki_cycles *c, size_t from, size_t to)
{
    size_t best = from;
    for (size_t k = from; k <= to; k++)
        if (c->whole[k] > c->whole[best])
            best = k;
    return best;
}

/* Cycles per sample, from a line and its neighbours. */
static double centre(const imki_cycles *c, size_t at)
{
    double sum = 0, moment = 0;
    for (size_t k = at - 1; k <= at + 1 && k <= HALF; k++) {
        const double excess = fmax(0, c->whole[k] - c->segments);
        sum += excess;
        moment += excess * (double)k;
    }
    return (sum > 0 ? moment / sum : (double)at) / SEGMENT;
}

/* Rates of the sensor over that of the log; 0: noise that alternates from row to row. A rate above
 * one half shows at one minus itself. Below, samples lie on straight lines: of them a share of 1 -
 * 2a to 1 - a. */
static void find_rates(const imki_cycles *c, double *rate)
{
    const double found = centre(c, strongest(c, LEAST, HALF));
    const double chance = c->straight_by_chance / c->differences;
    const double straight = (c->straight / c->differences - chance) / (1 - chance);
    rate[0] = 1 - found;
    rate[1] = chance < 0.02 ? 0 : found;
    if (!(chance < 0.02))
        return;
    if (!(straight > 0.02)) {
        /* of a log interpolated by two, half of the second differences vanish */
        rate[0] = found * SEGMENT > HALF - 0.6 ? 0 : rate[0];
        return;
    }
    const double low = 0.45 * (1 - straight) * SEGMENT, high = 1.05 * (1 - straight) * SEGMENT;
    const size_t from = low > LEAST ? (size_t)low : LEAST;
    const size_t to = high < HALF ? (size_t)high : HALF;
    rate[0] = from < to ? centre(c, strongest(c, from, to)) : found;
}

bool imki_cycles_find(const imki_cycles *c, double significance, double rate[2])
{
    const double chance = significance / (HALF + 1 - LEAST);
    bool any = false;
    rate[0] = rate[1] = 0;
    if (c->segments < SEGMENTS_MIN)
        return false;
    /* C of half a cycle per sample is real, so it has one degree of freedom */
    const double n = 2 * c->segments;
    const double limit = imk_chi_square_quantile(1 - chance, n) / n;
    const double limit_real = imk_chi_square_quantile(1 - chance, n / 2) / (n / 2);
    for (size_t k = LEAST; k <= HALF; k++)
        any = any || prominence(c, k) > (k + 3 > HALF ? fmax(matters_alternating, limit_real)
                                                      : fmax(matters, limit));
    if (any)
        find_rates(c, rate);
    return any;
}
