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

enum { LANES = 8, PILE_MIN = 10 };

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

/* Samples of one value; in lanes that the compiler makes vectors of. */
static size_t count_equal(size_t count, const double *x, double value)
{
    double equal[LANES] = {0};
    for (size_t i = 0; i < count; i += LANES) {
        const size_t width = count - i < LANES ? count - i : LANES;
        for (size_t l = 0; l < width; l++)
            equal[l] += x[i + l] == value ? 1 : 0;
    }
    for (size_t l = 1; l < LANES; l++)
        equal[0] += equal[l];
    return (size_t)equal[0];
}

/* Samples of one value that follow another one. */
static size_t count_runs(size_t count, const double *x, double value)
{
    double runs[LANES] = {x[0] == value};
    for (size_t i = 1; i < count; i += LANES) {
        const size_t width = count - i < LANES ? count - i : LANES;
        for (size_t l = 0; l < width; l++)
            runs[l] += (x[i + l] == value ? 1.0 : 0.0) * (x[i + l - 1] != value ? 1.0 : 0.0);
    }
    for (size_t l = 1; l < LANES; l++)
        runs[0] += runs[l];
    return (size_t)runs[0];
}

static size_t count_beyond(size_t count, const double *x, double limit, double sign)
{
    double beyond[LANES] = {0};
    for (size_t i = 0; i < count; i += LANES) {
        const size_t width = count - i < LANES ? count - i : LANES;
        for (size_t l = 0; l < width; l++)
            beyond[l] += sign * x[i + l] >= limit ? 1 : 0;
    }
    for (size_t l = 1; l < LANES; l++)
        beyond[0] += beyond[l];
    return (size_t)beyond[0];
}

/* Where coarse values make many samples extreme, all of them known: by whole arrays.
 * @return false: nothing was counted */
static bool add_known(imki_ends *e, size_t place, size_t count, const double *samples, double sign)
{
    enum { FEW = 32 };
    size_t equal[IMKI_SCREEN_ENDS], sum = 0;
    const bool full = e->distinct == IMKI_SCREEN_ENDS;
    const double limit = full ? e->value[IMKI_SCREEN_ENDS - 1] : -HUGE_VAL;
    const size_t within = count_beyond(count, samples, limit, sign);
    if (within < count / FEW)
        return false;
    for (size_t k = 0; k < e->distinct; k++)
        sum += equal[k] = count_equal(count, samples, sign * e->value[k]);
    if (sum != within)
        return false;
    for (size_t k = 0; k < e->distinct; k++) {
        const double value = sign * e->value[k];
        if (equal[k] == 0)
            continue;
        e->count[k].count += equal[k];
        if (k == 0) /* the runs of others are of no interest, and no other will be the first */
            e->count[0].runs += count_runs(count, samples, value) -
                                (samples[0] == value && e->last[0] + 1 == place);
        size_t last = count - 1;
        while (samples[last] != value)
            last--;
        e->last[k] = place + last;
    }
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
