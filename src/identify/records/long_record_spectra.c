/* SPDX-License-Identifier: Apache-2.0 */
/* The spectrum of a long record on two scales.
 *
 * Fast: the mean power of segments of L samples, at f = k/(2 L dt). Slow: the cosine transform of
 * the means of M samples, a record of its own with the interval M dt. A mean of M samples sees
 *
 *     S_M(f) = sum over j of S(f + j/(M dt)) D^2(f + j/(M dt)),   0 <= j < M,
 *     D(f) = sin(pi f M dt)/(M sin(pi f dt))
 *
 * White noise passes unchanged. For the rest, the part that folds down, j > 0, is taken from the
 * fast spectrum, and the coefficients are divided by the square root of
 *
 *     S_M/S = D^2 + folded/S,   S ~ (power - folded)/D^2 about f
 *
 * The two meet at f M dt = 1/16, where 1 - D^2 is 1.3 %, so that what the estimate of S gets wrong
 * there is a part of that. */
#include "long_record_internal.h"

#include "imukit/elementary.h"

#include <math.h>
#include <string.h>

static const double pi = 3.141592653589793;

/* Coefficient of the segments at which the two scales meet: f M dt = 1/16, and at least 64, below
 * which a segment's ends show; where blocks are long that means f M dt up to 1/4. */
static size_t meeting(size_t segment, size_t block)
{
    const size_t wanted = segment / (8 * block), least = 64, most = segment / (2 * block);
    if (wanted >= least)
        return wanted;
    return most > least ? least : most;
}

/* Mean power of the segments about a frequency, in units of S. */
static double fast_power(const imki_spectrum *fast, double frequency)
{
    enum { REACH = 16 };
    const double place = frequency * 2 * (double)fast->n * fast->dt;
    const size_t k = (size_t)place, n = fast->n;
    const size_t from = k > REACH + 1 ? k - REACH : 1;
    const size_t to = k + REACH + 1 < n ? k + REACH + 1 : n;
    return (fast->cumulative[to] - fast->cumulative[from]) / (double)(to - from);
}

/* What folds down to a frequency f of the means. */
static double folded_power(const imki_spectrum *fast, size_t block, double frequency)
{
    const double step = 1 / ((double)block * fast->dt), s = imk_sin(pi * frequency / step);
    double sum = 0;
    for (size_t j = 1; j < block; j++) {
        const double f = frequency + (double)j * step;
        const double nyquist = 0.5 / fast->dt, seen = f > nyquist ? 2 * nyquist - f : f;
        const double d = s / ((double)block * imk_sin(pi * f * fast->dt));
        sum += fast_power(fast, seen) * d * d;
    }
    return sum;
}

/* Divide out what taking means does, for coefficients up to `end`, a stretch of 3 % at a time. */
static void undo_means(const imki_spectrum *fast, const imki_spectrum *slow, size_t block,
                       size_t end, double *c)
{
    const double step_hz = 1 / (2 * (double)slow->n * slow->dt);
    for (size_t k = 1; k < end;) {
        const size_t width = 1 + (size_t)(0.03 * (double)k),
                     stop = k + width < end ? k + width : end;
        const size_t reach = k / 4 + 8, from = k > reach ? k - reach : 1;
        const size_t to = k + reach < end ? k + reach : end;
        double power = 0;
        for (size_t i = from; i < to; i++)
            power += c[i] * c[i] * slow->dt;
        power /= (double)(to - from);
        const double f = 0.5 * (double)(k + stop - 1) * step_hz;
        const double d = imk_sin(pi * f * slow->dt) / ((double)block * imk_sin(pi * f * fast->dt));
        const double folded = folded_power(fast, block, f);
        const double s = fmax((power - folded) / (d * d), 0.01 * power);
        const double factor = 1 / sqrt(d * d + folded / s);
        for (; k < stop; k++)
            c[k] *= factor;
    }
}

static void sum_powers(size_t n, double dt, double weight, const double *powers, bool squared,
                       double *cumulative)
{
    cumulative[0] = cumulative[1] = 0;
    for (size_t k = 1; k < n; k++) {
        const double power = squared ? powers[k] * powers[k] : powers[k] / weight;
        cumulative[k + 1] = cumulative[k] + power * dt;
    }
}

void imki_record_spectra_make(imk_identify_record *r, double dt, double weight, double squares,
                              double present, size_t point_count, double *coefficients,
                              double *cumulative, imki_record_spectra *spectra)
{
    const size_t n = r->sizes.segment, meet = meeting(n, r->block);
    imki_spectrum *slow = &spectra->part[0], *fast = &spectra->part[1];
    sum_powers(n, dt, weight, r->power, false, r->spectrum);
    spectra->fast_powers = r->spectrum;
    *fast = (imki_spectrum){.n = n,
                            .dt = dt,
                            .length = n,
                            .first = meet,
                            .end = n,
                            .squares = squares,
                            .cumulative = r->spectrum,
                            .lines = spectra->lines[1]};
    *slow = (imki_spectrum){.n = point_count,
                            .dt = dt * (double)r->block,
                            .length = point_count * r->block,
                            .first = 1,
                            .squares = present,
                            .coefficients = coefficients,
                            .cumulative = cumulative,
                            .lines = spectra->lines[0]};
    /* Up to the edge of the fast spectrum's first coefficient. */
    const double edge = ((double)meet - 0.5) / (double)n * (double)slow->n * (double)r->block;
    slow->end = (size_t)(edge + 0.5);
    const size_t end = slow->end + slow->end / 2 < slow->n ? slow->end + slow->end / 2 : slow->n;
    undo_means(fast, slow, r->block, end, coefficients);
    sum_powers(slow->n, slow->dt, 1, coefficients, true, cumulative);
}
