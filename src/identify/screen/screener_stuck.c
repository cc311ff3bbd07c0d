/* SPDX-License-Identifier: Apache-2.0 */
/* A value that stays when the noise says it should move.
 *
 * Where a share r of samples repeats the one before by chance (coarse steps, repeated samples), the
 * most frequent value has a share of sqrt(2) r for Gaussian noise, and a run of more than L of it
 * occurs in n samples with probability about n (1 - r) (sqrt(2) r)^L: L is put where that is the
 * false-alarm rate for the longest records. r is the median over the last 64 stretches of 512
 * samples, without those of one value, so that a long run does not excuse itself. Above one half
 * the repeats are not independent (slow noise under coarse steps, samples repeated in groups), and
 * runs four times as long are let pass.
 *
 * A run at the end of the values so far, no farther out than noise goes, is clipped noise. */
#include "imukit/elementary.h"
#include "screener_internal.h"

#include <math.h>
#include <string.h>

enum { STRETCH = 512, RUN_MIN = 4 };

static void keep_share(imk_screener *s, size_t repeats, size_t compared)
{
    s->repeats += repeats;
    s->compared += compared;
    if (compared > 1 && repeats + 1 < compared)
        s->share[s->shares++ % IMKI_SCREEN_SHARES] = (double)repeats / (double)compared;
}

static size_t count_repeats(imk_screener *s, size_t from, size_t to, const double *samples,
                            size_t *compared)
{
    size_t repeats = 0;
    for (size_t i = from; i < to; i++) {
        if (samples[i] != samples[i])
            continue;
        repeats += samples[i] == s->last;
        ++*compared;
        s->last = samples[i];
    }
    return repeats;
}

/* The same where nothing is missing. */
static size_t count_repeats_fast(imk_screener *s, size_t from, size_t to, const double *samples,
                                 size_t *compared)
{
    size_t repeats = samples[from] == s->last;
    for (size_t i = from + 1; i < to; i++)
        repeats += samples[i] == samples[i - 1];
    *compared = to - from;
    s->last = samples[to - 1];
    return repeats;
}

void imki_screen_repeats(imk_screener *s, int at, bool whole)
{
    const double *samples = s->raw[at];
    const size_t before = s->repeats, count = s->count[at];
    for (size_t from = 0; from < count; from += STRETCH) {
        const size_t to = from + STRETCH < count ? from + STRETCH : count;
        size_t compared = 0;
        const size_t repeats = whole ? count_repeats_fast(s, from, to, samples, &compared)
                                     : count_repeats(s, from, to, samples, &compared);
        keep_share(s, repeats, compared);
    }
    s->chunk_repeats[at] = s->repeats - before;
    s->chunk_whole[at] = whole;
}

size_t imki_screen_stuck_limit(const imk_screener *s)
{
    double sorted[IMKI_SCREEN_SHARES];
    const size_t count = s->shares < IMKI_SCREEN_SHARES ? s->shares : IMKI_SCREEN_SHARES;
    memcpy(sorted, s->share, count * sizeof *sorted);
    imki_sort(sorted, count);
    const double middle = count > 0 ? sorted[count / 2] : 0;
    const double r = fmax(middle, 1.0 / (STRETCH * IMKI_SCREEN_SHARES));
    if (r > 0.999)
        return SIZE_MAX;
    const double most = r < 0.5 ? r * 1.4142135623730951 : r;
    const double length = imk_ln(imki_screen_samples * (1 - r) / s->settings.false_alarm) /
                          -imk_ln(most) * (r > 0.5 ? 4 : 1);
    return length > RUN_MIN ? (size_t)length + 1 : RUN_MIN;
}

/* Samples of the next chunk that continue a run. */
static size_t run_ahead(const imk_screener *s, double value)
{
    size_t length = 0;
    for (size_t i = 0; i < s->count[1]; i++) {
        if (s->raw[1][i] != s->raw[1][i])
            continue;
        if (s->raw[1][i] != value)
            break;
        length++;
    }
    return length;
}

/* Is this value the last one so far at an end, and within the noise? */
static bool is_end(const imk_screener *s, double value)
{
    const bool top =
        s->high.distinct > 0 && value >= s->high.value[0] && s->high.count[0].count > 1;
    const bool bottom =
        s->low.distinct > 0 && -value >= s->low.value[0] && s->low.count[0].count > 1;
    return (top || bottom) && s->scale > 0 && fabs(value - s->mean) < s->z * s->scale;
}

/* Mark samples from … to of raw[0] that have the value of a run, but for the first of the run. */
static void mark_run(imk_screener *s, size_t from, size_t to, double value, size_t length)
{
    imk_screen_count *stuck = &s->found.stuck;
    bool spare = s->run_length == 0;
    for (size_t i = from; i < to; i++) {
        if (s->raw[0][i] != value)
            continue;
        if (!spare) {
            stuck->first = stuck->count++ == 0 ? s->chunk * IMKI_SCREEN_CHUNK + i : stuck->first;
            s->mark[i] |= IMKI_MARK_STUCK;
            s->marked = true;
        }
        spare = false;
    }
    stuck->runs += !s->run_stuck;
    s->run_stuck = true;
    s->found.longest_stuck = length > s->found.longest_stuck ? length : s->found.longest_stuck;
}

/* Samples of one value from `from` on, missing ones between; `to` is set behind them. */
static size_t run_from(const imk_screener *s, size_t from, double value, size_t *to)
{
    size_t length = 0, i = from;
    for (; i < s->count[0] && (s->raw[0][i] == value || s->raw[0][i] != s->raw[0][i]); i++)
        length += s->raw[0][i] == value;
    *to = i;
    return length;
}

/* The chunk ends in a run that is not stuck. */
static void keep_last_run(imk_screener *s)
{
    size_t i = s->count[0];
    while (i > 0 && s->raw[0][i - 1] != s->raw[0][i - 1])
        i--;
    if (i == 0)
        return; /* nothing is there: the run goes on */
    s->run_value = s->raw[0][i - 1];
    s->run_stuck = false;
    for (s->run_length = 0; i > 0; i--) {
        const double sample = s->raw[0][i - 1];
        if (sample == sample && sample != s->run_value)
            break;
        s->run_length += sample == sample;
    }
}

/* Can the chunk hold a run of more than the limit? Where nothing is missing, such a run inside it
 * holds one of every limit/2 samples and as many after that one. */
static bool may_be_stuck(const imk_screener *s, size_t limit)
{
    const double *x = s->raw[0];
    const size_t count = s->count[0], stride = limit / 2;
    const bool begins = s->run_length > 0 && x[0] == s->run_value;
    const bool ends = s->count[1] > 0 && x[count - 1] == s->raw[1][0];
    if (s->run_length + s->chunk_repeats[0] + s->chunk_repeats[1] < RUN_MIN)
        return false;
    if (begins || ends || !s->chunk_whole[0] || !s->chunk_whole[1] || stride >= count)
        return true;
    for (size_t i = 0; i + stride <= count; i += stride) {
        size_t equal = 1;
        while (equal < stride && x[i + equal] == x[i])
            equal++;
        if (equal == stride)
            return true;
    }
    return false;
}

void imki_screen_stuck(imk_screener *s)
{
    const size_t limit = imki_screen_stuck_limit(s);
    s->found.stuck_limit = limit;
    if (!s->run_stuck && !may_be_stuck(s, limit)) {
        keep_last_run(s);
        return;
    }
    for (size_t i = 0, to; i < s->count[0]; i = to) {
        const double value = s->raw[0][i];
        if (value != value) {
            to = i + 1;
            continue;
        }
        if (value != s->run_value) {
            s->run_length = 0;
            s->run_stuck = false;
        }
        const size_t length = run_from(s, i, value, &to) + s->run_length;
        const size_t ahead = to == s->count[0] ? run_ahead(s, value) : 0;
        if (s->run_stuck || (length + ahead > limit && !is_end(s, value)))
            mark_run(s, i, to, value, length);
        s->run_value = value;
        s->run_length = length;
    }
}
