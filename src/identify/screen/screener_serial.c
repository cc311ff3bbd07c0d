/* SPDX-License-Identifier: Apache-2.0 */
/* Samples that the ones beside them tell: repeats of the sample before, and means of both
 * neighbours.
 *
 * Noise of a standard deviation s, on steps or not, repeats a sample by chance, and a share of its
 * second differences vanish. How many, tell differences over 16 samples, whose neighbours are no
 * cause of each other:
 *
 *     P_1 = 2 Phi(z s_16/s_1) - 1,  2 Phi(z) - 1 = P_16    s: root mean square of the differences
 *
 * where noise that is not white has smaller ones from sample to sample; and the differences near
 * zero but not at it, which a tone makes rare or frequent. The larger share is due. A sample
 * rounded to steps is the mean of its neighbours to one step. */
#include "imukit/distributions.h"
#include "screener_internal.h"

#include <math.h>

enum { FAR = 16 };

static const double repeats_least = 0.015, straight_least = 0.02;
static const double small_of_scale = 1e-3; /* second differences that vanish, without steps */
static const double near_of_deviation = 0.5;
static const double least_factor = 1.05;
static const double coarsest = 1.4; /* step over scale: beyond it rounding is no noise */

typedef struct tally {
    double count, square, there;
} tally;

/* Differences over a lag whose size is between two limits: how many, and sum of all squares.
 * @param second  second differences */
static tally tally_of(const imk_screener *s, size_t lag, bool second, double above, double most)
{
    const double *x = s->clean;
    size_t count = 0, there = 0;
    double square = 0;
    for (size_t i = 2 * lag; i < s->count[0]; i++) {
        const double first = x[i] - x[i - lag];
        const double d = second ? first - (x[i - lag] - x[i - 2 * lag]) : first;
        const double size = fabs(d);
        count += size > above && size <= most;
        there += d == d;
        square += d == d ? d * d : 0;
    }
    return (tally){(double)count, square, (double)there};
}

/* Count differences that vanish. @param second  second differences, to one step */
static void add(imk_screener *s, imki_excess *e, bool second, double least)
{
    const double step = s->step, steps = second ? 1 : 0;
    const double most = second ? fmax(small_of_scale * s->scale, 1.1 * step) : 0;
    const tally here = tally_of(s, 1, second, -1, most);
    e->samples += here.there;
    if (!(here.count > 0.5 * least * here.there) || !(here.square > 0))
        return;
    const tally far = tally_of(s, FAR, second, -1, most);
    if (!(far.there > 0))
        return;
    const double deviation = sqrt(here.square / here.there);
    const double ratio = sqrt(far.square / far.there) / deviation;
    const double z = imk_normal_quantile(0.5 + 0.5 * far.count / far.there) * ratio;
    const double due_far = (2 * imk_normal_probability(z) - 1) * here.there;

    const double near_zero = near_of_deviation * deviation;
    const double cells = step > 0 ? fmax(steps + 1, floor(near_zero / step)) : 0;
    const double within = step > 0 ? (cells + 0.1) * step : near_zero;
    const double part = step > 0 ? (steps + 0.5) / (cells - steps) : most / (within - most);
    const double due_near = tally_of(s, 1, second, most, within).count * part;

    e->counted += here.count;
    e->due += fmax(due_far, due_near);
    e->variance += due_far > due_near ? due_far * (1 + ratio) : due_near * (1 + part);
}

void imki_screen_serial(imk_screener *s)
{
    if (!imki_screen_counts(s->chunk) || s->count[0] < 4 * FAR || !(s->scale > 0) ||
        s->step > coarsest * s->scale)
        return;
    add(s, &s->repeated, false, repeats_least);
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
