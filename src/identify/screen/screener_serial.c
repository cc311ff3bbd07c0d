/* SPDX-License-Identifier: Apache-2.0 */
/* Samples that the ones beside them tell: repeats of the sample before, and means of both
 * neighbours.
 *
 * Noise of a standard deviation s, on steps or not, repeats a sample by chance, and a share of its
 * second differences vanish. How many, tell differences over L samples, whose neighbours are no
 * cause of each other:
 *
 *     P_1 = 2 Phi(z s_L/s_1) - 1,  2 Phi(z) - 1 = P_L      s: root mean square of the differences
 *
 * where noise that is not white has smaller ones from sample to sample. Of four L that one counts
 * whose s is nearest, so that a tone is alike in both; and the differences near
 * zero but not at it, which a tone makes rare or frequent. The larger share is due. A sample
 * rounded to steps is the mean of its neighbours to one step. */
#include "imukit/distributions.h"
#include "screener_internal.h"

#include <math.h>

enum {
    LANES = 8,
    SAMPLES_MIN = 64,
    FIRST = 2048 /* samples that tell whether to count on, and those of later chunks */
};

static const size_t lags[] = {8, 11, 13, 16};
static const double repeats_least = 0.015, straight_least = 0.02;
static const double small_of_scale = 1e-3; /* second differences that vanish, without steps */
static const double near_of_deviation = 0.5;
static const double least_factor = 1.05;

typedef struct tally {
    double count, square, there;
} tally;

/* Differences over a lag whose size is between two limits: how many, and sum of all squares.
 * @param twice  1 for second differences, else 0 */
static tally tally_of(size_t n, const double *x, size_t lag, double twice, double above,
                      double most)
{
    double count[LANES] = {0}, square[LANES] = {0}, there[LANES] = {0};
    tally t = {0, 0, 0};
    for (size_t i = 2 * lag; i + LANES <= n; i += LANES)
        for (size_t l = 0; l < LANES; l++) {
            const double *at = x + i + l;
            const double d = at[0] - at[-(ptrdiff_t)lag] -
                             twice * (at[-(ptrdiff_t)lag] - at[-2 * (ptrdiff_t)lag]);
            const double size = fabs(d);
            count[l] += size > above && size <= most ? 1 : 0;
            there[l] += size >= 0 ? 1 : 0;
            square[l] += size >= 0 ? d * d : 0;
        }
    for (size_t l = 0; l < LANES; l++) {
        t.count += count[l];
        t.square += square[l];
        t.there += there[l];
    }
    return t;
}

/* Count differences that vanish. @param second  second differences, to one step */
static void add(const imk_screener *s, imki_excess *e, bool second, double least)
{
    const size_t n = s->chunk < IMKI_SCREEN_EARLY || s->count[0] < FIRST ? s->count[0] : FIRST;
    const double *x = s->clean, step = s->step, steps = second ? 1 : 0;
    const double most = second ? fmax(small_of_scale * s->scale, 1.1 * step) : 0;
    const tally first = tally_of(n < FIRST ? n : FIRST, x, 1, steps, -1, most);
    if (!(first.count > 0.5 * least * first.there) || !(first.square > 0)) {
        e->samples += (double)n;
        return;
    }
    const tally here = tally_of(n, x, 1, steps, -1, most);
    e->samples += here.there;
    const double deviation = sqrt(here.square / here.there);
    double ratio = HUGE_VAL;
    tally far = {0, 0, 0};
    for (size_t k = 0; k < sizeof lags / sizeof *lags; k++) {
        const tally t = tally_of(n, x, lags[k], steps, -1, most);
        const double r = sqrt(t.square / t.there) / deviation;
        if (t.square > 0 && fabs(r - 1) < fabs(ratio - 1)) {
            far = t;
            ratio = r;
        }
    }
    if (!(far.there > 0))
        return;
    const double z = imk_normal_quantile(0.5 + 0.5 * far.count / far.there) * ratio;
    const double due_far = (2 * imk_normal_probability(z) - 1) * here.there;

    const double near_zero = near_of_deviation * deviation;
    const double cells = step > 0 ? fmax(steps + 1, floor(near_zero / step)) : 0;
    const double within = step > 0 ? (cells + 0.1) * step : near_zero;
    const double part = step > 0 ? (steps + 0.5) / (cells - steps) : most / (within - most);
    const double due_near = tally_of(n, x, 1, steps, most, within).count * part;

    e->counted += here.count;
    e->due += fmax(due_far, due_near);
    e->variance += due_far > due_near ? due_far * (1 + ratio) : due_near * (1 + part);
}

void imki_screen_serial(imk_screener *s)
{
    if (!imki_screen_counts(s->chunk) || s->count[0] < SAMPLES_MIN || !imki_screen_has_noise(s))
        return;
    if ((double)s->chunk_repeats[0] > 0.5 * repeats_least * (double)s->count[0])
        add(s, &s->repeated, false, repeats_least);
    else
        s->repeated.samples += (double)s->count[0];
    add(s, &s->straight, true, straight_least);
}

double imki_repeated_excess(const imk_screener *s)
{
    return imki_excess_share(&s->repeated, repeats_least, least_factor);
}

double imki_straight_excess(const imk_screener *s)
{
    return imki_excess_share(&s->straight, straight_least, least_factor);
}
