/* SPDX-License-Identifier: Apache-2.0 */
/* Values that are too frequent, and values that never come.
 *
 * Programs write a mean, or another constant, where a sample is missing. Of the values of the first
 * chunk, in order, the one that is most too frequent is a candidate; from then on it and three
 * values on either side are counted. ln n_k, the logarithm of the number at the k-th value on a
 * side, is close to a parabola of k, whatever the mean, the tails and the steps are:
 *
 *     ln n_0 = 3 ln n_1 - 3 ln n_2 + ln n_3
 *
 * is how many are due, the mean of both sides. Tails that are heavier than Gaussian ones make this
 * too large, and by how much values farther off differ from it is its error. Only values that are
 * equal, but for the rounding of a rate that is an increment over a time, are compared, so that no
 * step need be known; noise without steps has none due.
 * A candidate that lies closer to the values beside it than any two others do is none of the
 * converter's.
 *
 * A bit of the converter that is stuck leaves gaps among the values: much wider than the smallest
 * distance between two, and with as many samples at their edges as elsewhere. One of w standard
 * deviations raises the variance by w^2/4, so that a gap of less than a third matters little. */
#include "imukit/elementary.h"
#include "screener_internal.h"

#include <math.h>

enum { SIDE = IMKI_FREQUENT_SIDE, CROWD_MIN = 20 };

static const double candidate_share = 0.01; /* too many, of a chunk */
static const double equal_of_scale = 1e-7;
static const double at_rest = 0.5; /* a value of more samples is where a coarse output rests */
static const double least_share = 0.03, least_factor = 1.2, uneven_deviations = 3;
static const double due_deviations = 6, most_of_beside = 3;
static const double off_grid = 0.9;
static const double gap_of_scale = 0.35, gap_of_step = 2.9, crowd_share = 0.01, edge_of_scale = 0.5;

/* Different values of the chunk, in order: value k is that of the samples place[k] … place[k + 1] -
 * 1 of s->value. */
static size_t sort_values(imk_screener *s)
{
    size_t present = 0, count = 0;
    for (size_t i = 0; i < s->count[0]; i++) {
        s->value[present] = s->clean[i];
        present += s->clean[i] == s->clean[i];
    }
    imki_sort(s->value, present);
    for (size_t i = 0; i < present; i++)
        if (i == 0 || s->value[i] - s->value[i - 1] > equal_of_scale * s->scale)
            s->place[count++] = (uint32_t)i;
    s->place[count] = (uint32_t)present;
    return count;
}

static double value_of(const imk_screener *s, size_t k)
{
    return s->value[s->place[k]];
}

static double number_of(const imk_screener *s, size_t k)
{
    return (double)(s->place[k + 1] - s->place[k]);
}

/* Numbers of a value and those beside it, in order: how many of it are due? `variance` is that of
 * the logarithm. Half a sample is added where a number may be none. */
static double due_of(const double *number, double *variance)
{
    static const double weight[] = {3, -3, 1};
    double sum = 0;
    *variance = 0;
    for (int k = 1; k <= SIDE; k++)
        for (int sign = -1; sign <= 1; sign += 2) {
            const double n = number[SIDE + sign * k] + 0.5, w = 0.5 * weight[k - 1];
            sum += w * imk_ln(n);
            *variance += w * w / n;
        }
    return imk_exp(sum);
}

/* Smallest distance between two values, neither of them the k-th. */
static double least_step(const imk_screener *s, size_t values, size_t without)
{
    double least = HUGE_VAL;
    for (size_t k = 1; k < values; k++)
        if (k != without && k != without + 1)
            least = fmin(least, value_of(s, k) - value_of(s, k - 1));
    return least;
}

/* Is a value closer to those beside it than they can be, and do they lie on steps without it? */
static bool is_alone(const imk_screener *s, size_t values, size_t at)
{
    const double least = least_step(s, values, at);
    const double below = value_of(s, at) - value_of(s, at - 1);
    const double above = value_of(s, at + 1) - value_of(s, at);
    const double steps = (below + above) / least;
    return fmin(below, above) < off_grid * least && fabs(steps - nearbyint(steps)) < 0.05;
}

/* What is due of value `at`, SIDE values or more from either end, where value `other` has `number`
 * samples. @param variance  of the logarithm */
static double due_at(const imk_screener *s, size_t at, size_t other, double number,
                     double *variance)
{
    double beside[2 * SIDE + 1];
    for (size_t k = 0; k <= 2 * SIDE; k++) {
        const size_t value = at + k - SIDE;
        beside[k] = value == other ? number : number_of(s, value);
    }
    return due_of(beside, variance);
}

/* Mean square by which ln n_0 is off at the other frequent values, beyond chance, if the candidate
 * is as frequent as it is due: where the output is rounded twice, or the converter's steps differ.
 */
static double unevenness(const imk_screener *s, size_t values, size_t candidate)
{
    const double least = candidate_share * (double)s->count[0];
    double square = 0, chance = 0, count = 0, of_due, variance;
    const double due = due_at(s, candidate, values, 0, &of_due);
    for (size_t at = SIDE; at + SIDE < values; at++) {
        if (number_of(s, at) < least || at == candidate)
            continue;
        const double off = imk_ln(number_of(s, at) / due_at(s, at, candidate, due, &variance));
        const bool beside = at + SIDE >= candidate && at <= candidate + SIDE;
        square += off * off;
        chance += variance + 1 / number_of(s, at) + (beside ? 2.25 * of_due : 0);
        count++;
    }
    return count > 0 ? fmax(0, square - chance * (1 + 3 * sqrt(2 / count))) / count : 0;
}

static void find_candidate(imk_screener *s, size_t values)
{
    imki_frequent *f = &s->frequent;
    const double least = candidate_share * (double)s->count[0];
    const double all = (double)s->place[values];
    double most = least, unused;
    size_t best = 0;
    for (size_t at = SIDE; at + SIDE < values; at++) {
        if (number_of(s, at) < least || number_of(s, at) > at_rest * all)
            continue;
        const bool alone = is_alone(s, values, at);
        const double excess = number_of(s, at) - (alone ? 0 : due_at(s, at, values, 0, &unused));
        if (alone < f->alone || (alone == f->alone && !(excess > most)))
            continue;
        most = excess;
        best = at;
        f->alone = alone;
    }
    if (best == 0)
        return;
    f->candidate = true;
    f->equal = equal_of_scale * s->scale;
    f->uneven = f->alone ? 0 : unevenness(s, values, best);
    for (size_t k = 0; k <= 2 * SIDE; k++)
        f->value[k] = value_of(s, best + k - SIDE);
}

/* Samples within a distance behind the edge of a gap: of value k upwards, or downwards. */
static double crowd_at(const imk_screener *s, size_t values, size_t k, int direction, double within)
{
    const double edge = value_of(s, k);
    double crowd = 0;
    for (; k < values && fabs(value_of(s, k) - edge) <= within; k += (size_t)direction)
        crowd += number_of(s, k);
    return crowd;
}

/* The widest gap among the values that is none of the noise, 0 if there is none. */
static double widest_gap(const imk_screener *s, size_t values)
{
    const double least = least_step(s, values, SIZE_MAX - 1);
    const double crowd = fmax(CROWD_MIN, crowd_share * (double)s->count[0]);
    double widest = 0;
    for (size_t k = 1; k < values; k++) {
        const double gap = value_of(s, k) - value_of(s, k - 1);
        const double within = fmin(gap, edge_of_scale * s->scale);
        if (gap > widest && gap > gap_of_scale * s->scale && gap > gap_of_step * least &&
            crowd_at(s, values, k - 1, -1, within) >= crowd &&
            crowd_at(s, values, k, 1, within) >= crowd)
            widest = gap;
    }
    return widest;
}

/* Is a value missing between two frequent ones, or are their numbers uneven? Rounding twice, first
 * to wider steps, skips values; first to smaller ones, it puts two into one. */
static bool is_uneven(const imk_screener *s, size_t values)
{
    static const double wider = 1.5, square_least = 0.02;
    const double frequent = candidate_share * (double)s->count[0];
    double least = HUGE_VAL, most = 0;
    for (size_t k = 1; k < values; k++)
        if (number_of(s, k - 1) >= frequent && number_of(s, k) >= frequent) {
            least = fmin(least, value_of(s, k) - value_of(s, k - 1));
            most = fmax(most, value_of(s, k) - value_of(s, k - 1));
        }
    return most > wider * least || s->frequent.uneven > square_least;
}

void imki_screen_frequent(imk_screener *s)
{
    imki_frequent *f = &s->frequent;
    if (!f->looked && imki_screen_has_noise(s)) {
        const size_t values = sort_values(s);
        f->looked = true;
        find_candidate(s, values);
        s->found.uneven = is_uneven(s, values);
        s->found.gap = f->candidate && f->alone ? 0 : widest_gap(s, values);
    }
    if (!f->candidate || !imki_screen_counts(s->chunk))
        return;
    f->samples += (double)s->count[0];
    for (size_t k = 0; k <= 2 * SIDE; k++) {
        size_t equal = 0;
        for (size_t i = 0; i < s->count[0]; i++)
            equal += fabs(s->clean[i] - f->value[k]) <= f->equal;
        f->number[k] += (double)equal;
    }
}

double imki_frequent_excess(const imki_frequent *f)
{
    if (!f->candidate)
        return 0;
    imki_excess e = {.samples = f->samples, .counted = f->number[SIDE]};
    if (f->alone)
        return imki_excess_share(&e, least_share, least_factor);
    double variance, most = 0;
    e.due = due_of(f->number, &variance);
    for (int k = 0; k <= 2 * SIDE; k++)
        most = k == SIDE ? most : fmax(most, f->number[k]);
    /* beside few samples what is due is hardly known, but for its size */
    const double error = due_deviations * sqrt(variance) + uneven_deviations * sqrt(f->uneven);
    e.variance = fmin(e.due * imk_exp(error), most_of_beside * (most + most_of_beside));
    return imki_excess_share(&e, least_share, fmax(least_factor, e.variance / e.due));
}
