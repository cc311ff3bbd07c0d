/* SPDX-License-Identifier: Apache-2.0 */
/* The checks of record_checks.c on a record that passes by: the few most extreme values, how often
 * they came and how many in a row, and repeats. */
#include "long_record_internal.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

enum { PIECE = 64 };

/* A value at or beyond the last of the list. */
static void enter(imki_extremes *e, double value)
{
    size_t place = 0;
    while (place < e->distinct && e->value[place] > value)
        place++;
    if (place < e->distinct && e->value[place] == value) {
        e->count[place]++;
        return;
    }
    if (e->distinct < IMKI_EXTREMES)
        e->distinct++;
    for (size_t i = e->distinct - 1; i > place; i--) {
        e->value[i] = e->value[i - 1];
        e->count[i] = e->count[i - 1];
    }
    e->value[place] = value;
    e->count[place] = 1;
    if (place == 0)
        e->run = e->longest = 0;
}

/* A piece all of whose extreme values are known, as coarse steps make them: their counts have no
 * branch, and become vectors.
 * @return false: nothing was counted */
static bool add_known(imki_extremes *e, const double *samples, double sign)
{
    uint64_t found[IMKI_EXTREMES] = {0}, reaching = 0;
    const double last = e->value[IMKI_EXTREMES - 1];
    for (size_t i = 0; i < PIECE; i++)
        reaching += sign * samples[i] >= last;
    for (size_t k = 0; k < IMKI_EXTREMES && reaching > 0; k++)
        for (size_t i = 0; i < PIECE; i++)
            found[k] += sign * samples[i] == e->value[k];
    if (found[0] + found[1] + found[2] + found[3] != reaching)
        return false;
    for (size_t k = 0; k < IMKI_EXTREMES; k++)
        e->count[k] += (size_t)found[k];
    for (size_t i = 0; i < PIECE && found[0] > 0; i++) {
        e->run = sign * samples[i] == e->value[0] ? e->run + 1 : 0;
        e->longest = e->run > e->longest ? e->run : e->longest;
    }
    e->run = found[0] > 0 ? e->run : 0;
    return true;
}

static void add_each(imki_extremes *e, size_t count, const double *samples, double sign)
{
    for (size_t i = 0; i < count; i++) {
        const double value = sign * samples[i];
        if (!(e->distinct < IMKI_EXTREMES || value >= e->value[e->distinct - 1])) {
            e->run = 0;
            continue;
        }
        if (value != value)
            continue;
        enter(e, value);
        e->run = value == e->value[0] ? e->run + 1 : 0;
        e->longest = e->run > e->longest ? e->run : e->longest;
    }
}

static void look(imki_extremes *e, size_t count, const double *samples, double sign, double highest)
{
    if (e->distinct == IMKI_EXTREMES && highest < e->value[IMKI_EXTREMES - 1]) {
        e->run = 0;
        return;
    }
    for (size_t i = 0; i < count; i += PIECE) {
        const size_t size = count - i < PIECE ? count - i : PIECE;
        const bool known = size == PIECE && e->distinct == IMKI_EXTREMES;
        if (!known || !add_known(e, samples + i, sign))
            add_each(e, size, samples + i, sign);
    }
}

void imki_record_check(imki_record_checks *checks, size_t count, const double *samples, double low,
                       double high)
{
    size_t repeats = samples[0] == checks->last;
    for (size_t i = 1; i < count; i++)
        repeats += samples[i] == samples[i - 1];
    checks->repeats += repeats;
    checks->last = samples[count - 1];
    look(&checks->high, count, samples, 1, high);
    look(&checks->low, count, samples, -1, -low);
}

/* As imki_record_verdict() has it: an extreme value that piles up, some in a row. Of the values
 * within a step of it the nearest three are counted. */
static bool sticks(const imki_extremes *e, double step)
{
    size_t beside = 0;
    for (size_t i = 1; i < e->distinct; i++)
        beside += e->value[0] - e->value[i] <= step ? e->count[i] : 0;
    return e->longest >= 3 && e->count[0] > 10 + 3 * beside;
}

unsigned imki_record_checked(const imki_record_checks *checks, size_t samples, double deviation)
{
    const double resolution = checks->resolution;
    const double step = resolution > 0 ? resolution * 1.01 : 0.1 * deviation;
    unsigned verdict = 0;
    if (sticks(&checks->high, step) || sticks(&checks->low, step))
        verdict |= IMK_VERDICT_SATURATED;
    if (resolution > deviation)
        verdict |= IMK_VERDICT_COARSE;
    if ((double)checks->repeats > 0.4 * (double)samples && resolution < 0.5 * deviation)
        verdict |= IMK_VERDICT_FROZEN;
    return verdict;
}
