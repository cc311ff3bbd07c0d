/* SPDX-License-Identifier: Apache-2.0 */
/* Samples that pile up at the end of the values.
 *
 * Where a density falls towards its end, the last value does not come more often than the one
 * before it. So of the samples on both, a share p of a half at most is on the last one. More is a
 * pile: three times as many, and six standard deviations of the binomial distribution.
 *
 * Values on a coarse grid hide a pile among the counts of its neighbours. There the normal
 * distribution tells, if the deviation is that of the fast noise: what is beyond the upper edge of
 * the last value, more than 15 samples, is missing, and the last value has more than halfway from
 * its own share to its own and that of all beyond it. */
#include "imukit/distributions.h"
#include "screener_internal.h"

#include <math.h>

enum { PILE_MIN = 10 };

static void count_at(imki_ends *e, size_t at, size_t place)
{
    imk_screen_count *count = &e->count[at];
    if (count->count++ == 0)
        count->first = place;
    if (count->count == 1 || place != e->last[at] + 1)
        count->runs++;
    e->last[at] = place;
}

static void enter(imki_ends *e, double value, size_t place)
{
    size_t at = 0;
    while (at < e->distinct && e->value[at] > value)
        at++;
    if (at < e->distinct && e->value[at] == value) {
        count_at(e, at, place);
        return;
    }
    if (e->distinct < IMKI_SCREEN_ENDS)
        e->distinct++;
    for (size_t i = e->distinct - 1; i > at; i--) {
        e->value[i] = e->value[i - 1];
        e->count[i] = e->count[i - 1];
        e->last[i] = e->last[i - 1];
    }
    e->value[at] = value;
    e->count[at] = (imk_screen_count){0, 0, 0};
    count_at(e, at, place);
}

/* Where each value on the list is, in steps from the first; 0: they are not on a grid. */
static double grid_of(const imki_ends *e)
{
    if (e->distinct < 2)
        return 0;
    const double step = e->value[0] - e->value[1];
    for (size_t k = 2; k < e->distinct; k++)
        if (fabs((e->value[0] - e->value[k]) / step - (double)k) > 1e-6)
            return 0;
    return step;
}

/* Where coarse values make many samples extreme, and all of them are known: by their places on the
 * grid. Runs are of interest of the first value only, and no other will be the first.
 * @return false: nothing was counted */
static bool add_known(imki_ends *e, size_t place, size_t count, const double *samples, double sign)
{
    enum { OTHER = IMKI_SCREEN_ENDS, NEW };
    const double step = grid_of(e), first = e->value[0];
    if (!(step > 0))
        return false;
    const double scale = sign / step, origin = first / step + 0.5, most = (double)e->distinct;
    const bool full = e->distinct == IMKI_SCREEN_ENDS;
    const double limit = first - (most - 0.5) * step; /* of values that may be the last known */
    size_t found[NEW + 1] = {0}, runs = 0, last[NEW + 1] = {0}, before = OTHER;
    for (size_t i = 0; i < count; i++) {
        while (full && i + IMKI_EIGHT < count && imki_eight_below(samples + i, sign, limit)) {
            before = OTHER;
            i += IMKI_EIGHT;
        }
        const double steps = origin - samples[i] * scale;
        const size_t at = steps < most ? (steps >= 0 ? (size_t)steps : NEW) : OTHER;
        found[at]++;
        last[at] = i;
        runs += at == 0 && before != 0;
        before = at;
    }
    if (found[NEW] > 0 || (!full && found[OTHER] > 0))
        return false;
    for (size_t k = 0; k < e->distinct; k++)
        e->count[k].count += found[k];
    e->count[0].runs += runs - (sign * samples[0] == first && e->last[0] + 1 == place);
    for (size_t k = 0; k < e->distinct; k++)
        e->last[k] = found[k] > 0 ? place + last[k] : e->last[k];
    return true;
}

void imki_ends_add(imki_ends *e, size_t place, size_t count, const double *samples, double sign)
{
    if (count == 0 || add_known(e, place, count, samples, sign))
        return;
    for (size_t i = 0; i < count; i++) {
        const double value = sign * samples[i];
        const bool full = e->distinct == IMKI_SCREEN_ENDS;
        if (value == value && !(full && value < e->value[IMKI_SCREEN_ENDS - 1]))
            enter(e, value, place + i);
    }
}

/* Count of the value beside the last one: on a grid a step away, else the largest of those known.
 */
static double beside(const imki_ends *e, double resolution)
{
    size_t most = 0;
    for (size_t i = 1; i < e->distinct; i++) {
        const bool near = resolution > 0 ? e->value[0] - e->value[i] < 1.5 * resolution : true;
        most = near && e->count[i].count > most ? e->count[i].count : most;
    }
    return (double)most;
}

/* Does more than a share p of all lie on the last value? */
static bool exceeds(double on, double all, double p)
{
    return on - p * all > 6 * sqrt(p * (1 - p) * all);
}

static bool piles_on_grid(const imki_ends *e, double on, double next, double q, double mean,
                          double deviation, double present)
{
    const double true_square = deviation * deviation - q * q / 12;
    if (!(q < deviation))
        return false;
    const double sigma = sqrt(true_square), above = (e->value[0] + q / 2 - mean) / sigma;
    const double a = above - q / sigma, b = a - q / sigma;
    const double beyond = imk_normal_probability(-above);
    const double own = imk_normal_probability(-a) - beyond;
    const double other = imk_normal_probability(-b) - imk_normal_probability(-a);
    const double sound = own / (own + other), clipped = (own + beyond) / (own + beyond + other);
    return beyond * present > 15 && on > 0.5 * (sound + clipped) * (on + next) &&
           exceeds(on, on + next, sound);
}

bool imki_ends_pile(const imki_ends *e, double resolution, double mean, double deviation,
                    double present, bool fast)
{
    if (e->distinct < 2)
        return false;
    const double on = (double)e->count[0].count, next = beside(e, resolution);
    if (on > PILE_MIN + 3 * next && exceeds(on, on + next, 0.5))
        return true;
    return fast && resolution > 0 && on > PILE_MIN &&
           piles_on_grid(e, on, next, resolution, mean, deviation, present);
}
