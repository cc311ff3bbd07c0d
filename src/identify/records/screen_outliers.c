/* SPDX-License-Identifier: Apache-2.0 */
/* Samples that do not belong to their neighbourhood.
 *
 * The distance of a sample from the median of the 31 samples around it that are there follows any
 * slow change and any lasting step of the level; its scale is the median of such distances over the
 * record (times 1.4826 for Gaussian noise), which a few outliers do not move. A sample is an
 * outlier when its distance exceeds
 *
 *     z scale + 3/2 step,   z = normal quantile of false_alarm/(2 n)
 *
 * (coarse steps: the rounding of sample and median adds up to one and a half of them), and 9 times
 * the same scale of its own neighbourhood: where a part of the record is noisier, that part is not
 * made of outliers. Up to 15 neighbouring outliers are seen; more of them are a step.
 *
 * To be fast, only blocks of 32 samples whose range comes near the threshold are looked at closely:
 * a block with an outlier has others in it that are none. */
#include "imukit/distributions.h"
#include "screen_internal.h"

#include <math.h>

enum {
    BLOCK = IMKI_BLOCK,
    CHUNK = 8 * BLOCK,
    REACH = 15, /* neighbours on each side */
    WINDOW = 2 * REACH + 1
};

/* Samples that are there, in order: CHUNK of them with REACH on each side. */
typedef struct stretch {
    size_t n, next; /* next index of the record to read */
    const double *samples;
    size_t count;  /* of the buffer, left margin included */
    size_t margin; /* samples before the ones to assess: 0 or REACH */
    double value[CHUNK + 2 * REACH];
    size_t place[CHUNK + 2 * REACH];
} stretch;

/* Read on; false when nothing is left to assess. What is read is assessed in the next call but for
 * the last REACH, which are its right margin. `last` tells that the record ends in the buffer. */
static bool stretch_fill(stretch *s, bool *last)
{
    while (s->count < CHUNK + 2 * REACH && s->next < s->n) {
        const double value = s->samples[s->next];
        s->value[s->count] = value;
        s->place[s->count] = s->next++;
        s->count += imki_is_there(value);
    }
    *last = s->next == s->n;
    return s->count > s->margin;
}

/* Keep what the next assessing needs: the right margin, and REACH before it. */
static void stretch_advance(stretch *s, size_t assessed_end)
{
    const size_t keep_from = assessed_end > REACH ? assessed_end - REACH : 0;
    for (size_t i = keep_from; i < s->count; i++) {
        s->value[i - keep_from] = s->value[i];
        s->place[i - keep_from] = s->place[i];
    }
    s->count -= keep_from;
    s->margin = assessed_end - keep_from;
}

/* Median of the samples around one of the buffer, and of their distances from it (`spread` may be
 * NULL). At the ends of the record the window is the first or last one. */
static double level_around(const stretch *s, size_t i, double *spread)
{
    const size_t size = s->count < WINDOW ? s->count : WINDOW;
    size_t from = i > REACH ? i - REACH : 0;
    from = from + size > s->count ? s->count - size : from;
    double sorted[WINDOW] = {0};
    for (size_t k = 0; k < size; k++)
        sorted[k] = s->value[from + k];
    imki_sort(sorted, size);
    const double level = sorted[size / 2];
    if (spread) {
        for (size_t k = 0; k < size; k++)
            sorted[k] = fabs(sorted[k] - level);
        imki_sort(sorted, size);
        *spread = 1.4826 * sorted[size / 2];
    }
    return level;
}

/* Distance of the middle one of the next 31 samples that are there from their median; negative when
 * there are not so many. */
static double distance_at(size_t n, const double *samples, size_t from)
{
    double sorted[WINDOW], middle = 0;
    size_t size = 0;
    for (size_t i = from; i < n && size < WINDOW; i++) {
        if (!imki_is_there(samples[i]))
            continue;
        middle = size == REACH ? samples[i] : middle;
        sorted[size++] = samples[i];
    }
    if (size < WINDOW)
        return -1;
    imki_sort(sorted, WINDOW);
    return fabs(middle - sorted[REACH]);
}

imki_outlier_rule imki_outlier_rule_find(size_t n, const double *samples, double false_alarm,
                                         double resolution, size_t scratch_count, double *scratch)
{
    size_t present = 0, taken = 0;
    for (size_t i = 0; i < n; i++)
        present += imki_is_there(samples[i]);
    imki_outlier_rule rule = {HUGE_VAL, 0};
    if (present < WINDOW)
        return rule;
    const size_t stride = n / scratch_count + 1;
    for (size_t i = 0; i < n && taken < scratch_count; i += stride) {
        const double distance = distance_at(n, samples, i);
        if (distance < 0)
            break;
        scratch[taken++] = distance;
    }
    imki_sort(scratch, taken);
    const double step = imki_coarse_step(taken, scratch, resolution);
    rule.noise = 1.4826 * imki_median_on_steps(taken, scratch, step);
    const double z = -imk_normal_quantile(false_alarm / (2 * (double)present));
    /* The scale is known to 1.2/sqrt(taken); three of that are added. */
    rule.threshold = z * rule.noise * (1 + 3.6 / sqrt((double)taken)) + 1.5 * step;
    return rule;
}

/* What the search has found so far. */
typedef struct tally {
    imk_screen_count *count;
    double *marked, *largest;
    size_t last; /* place of the last outlier */
} tally;

static void assess(const stretch *s, size_t i, const imki_outlier_rule *rule, tally *t)
{
    double spread;
    const double distance = fabs(s->value[i] - level_around(s, i, &spread));
    if (!(distance > rule->threshold) || !(distance > 9 * spread))
        return;
    const size_t place = s->place[i];
    if (t->count->count++ == 0)
        t->count->first = place;
    if (t->count->count == 1 || place != t->last + 1)
        t->count->runs++;
    t->last = place;
    *t->largest = fmax(*t->largest, distance);
    if (t->marked)
        t->marked[place] = (double)NAN;
}

imk_screen_count imki_outliers_find(size_t n, const double *samples, const imki_outlier_rule *rule,
                                    double *marked, double *largest)
{
    imk_screen_count count = {0, 0, n};
    *largest = 0;
    tally t = {&count, marked, largest, 0};
    stretch s = {.n = n, .samples = samples};
    if (!(rule->threshold < HUGE_VAL))
        return count;
    for (bool last; stretch_fill(&s, &last);) {
        const size_t end = last ? s.count : s.count - REACH;
        size_t i = s.margin;
        for (; i + BLOCK <= end; i += BLOCK) {
            if (imki_block_range(s.value + i) < 0.9 * rule->threshold)
                continue;
            double sorted[BLOCK];
            for (size_t k = 0; k < BLOCK; k++)
                sorted[k] = s.value[i + k];
            imki_sort(sorted, BLOCK);
            const double level = sorted[BLOCK / 2];
            for (size_t k = i; k < i + BLOCK; k++)
                if (fabs(s.value[k] - level) > 0.5 * rule->threshold)
                    assess(&s, k, rule, &t);
        }
        for (; i < end; i++)
            assess(&s, i, rule, &t);
        stretch_advance(&s, end);
        if (last)
            break;
    }
    return count;
}
