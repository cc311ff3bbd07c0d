/* SPDX-License-Identifier: Apache-2.0 */
/* Samples that do not belong to their neighbourhood.
 *
 * The distance of a sample from the median of the 31 samples around it that are there follows any
 * slow change and any lasting step of the level. Its scale is the median range of the blocks of 32
 * samples of the chunk, divided by that of normal numbers, 4.091: a few outliers do not move it,
 * and a chunk with more noise has a larger one. A sample is an outlier when its distance exceeds
 *
 *     z scale + 3/2 step,   z = normal quantile of false_alarm/(2 n), n = 1e9
 *
 * (coarse steps: the rounding of sample and median adds up to one and a half of them), 9 times the
 * scale of its own neighbourhood, and 6 times that of the 15 samples on either side: where a part
 * of a chunk is noisier, that part is not made of outliers, its edges included. Up to 15
 * neighbouring outliers are seen; more of them are a jump.
 *
 * Samples beyond 5 scales that are no outliers are counted: noise with heavy tails has many, faults
 * have none.
 *
 * To be fast, only blocks whose range comes near that are looked at closely. */
#include "screener_internal.h"

#include <math.h>
#include <string.h>

enum {
    BLOCK = IMKI_BLOCK,
    REACH = IMKI_SCREEN_REACH,
    WINDOW = 2 * REACH + 1,
    RANGES = IMKI_SCREEN_CHUNK / BLOCK
};

static const double median_range = 4.0912, shoulder_begins = 5;

/* Samples of a chunk that are there, with their neighbours on either side. */
typedef struct stretch {
    const double *value;
    size_t margin, end, count; /* samples margin … end - 1 of count are those to assess */
    double shoulder, threshold;
    double range[RANGES]; /* of its whole blocks */
} stretch;

/* Median of some values, at most WINDOW, and the scale of their distances from it. */
static double level_of(const double *value, size_t size, double *spread)
{
    double sorted[WINDOW] = {0};
    memcpy(sorted, value, size * sizeof *value);
    imki_sort(sorted, size);
    const double level = sorted[size / 2];
    for (size_t k = 0; k < size; k++)
        sorted[k] = fabs(sorted[k] - level);
    imki_sort(sorted, size);
    *spread = 1.4826 * sorted[size / 2];
    return level;
}

/* Of the samples around one. At the ends of the record the window is the first or last one. */
static double level_around(const stretch *s, size_t i, double *spread)
{
    const size_t size = s->count < WINDOW ? s->count : WINDOW;
    size_t from = i > REACH ? i - REACH : 0;
    from = from + size > s->count ? s->count - size : from;
    return level_of(s->value + from, size, spread);
}

/* Scale of the noisier side of a sample. */
static double spread_beside(const stretch *s, size_t i)
{
    double before = 0, behind = 0;
    if (i >= REACH)
        (void)level_of(s->value + i - REACH, REACH, &before);
    if (i + REACH < s->count)
        (void)level_of(s->value + i + 1, REACH, &behind);
    return fmax(before, behind);
}

/* Scale and thresholds of the chunk. Few ranges, or none but zero: those of the chunk before. */
static void set_scale(imk_screener *s, stretch *in)
{
    double range[RANGES];
    size_t count = 0;
    for (size_t i = in->margin; i + BLOCK <= in->end; i += BLOCK)
        in->range[count++] = imki_block_range(in->value + i);
    in->threshold = in->shoulder = HUGE_VAL;
    if (count == 0 && !(s->scale > 0))
        return;
    double step = s->step;
    if (count > (s->scale > 0 ? 7u : 0u)) {
        memcpy(range, in->range, count * sizeof *range);
        imki_sort(range, count);
        step = imki_coarse_step(count, range, step);
        const double scale = imki_median_on_steps(count, range, step) / median_range;
        s->scale = scale > 0 ? scale : s->scale;
    }
    if (!(s->scale > 0))
        return;
    /* A median of ranges is known to 0.21/sqrt(count); three of that are added. */
    const double surely = 1 + 0.6 / sqrt(count > 0 ? (double)count : 1);
    in->threshold = s->z * s->scale * surely + 1.5 * step;
    in->shoulder = shoulder_begins * s->scale * surely + 1.5 * step;
    s->scale_sum += s->scale;
    s->threshold_sum += in->threshold;
    s->scale_count++;
}

static void note_outlier(imk_screener *s, size_t i, double distance)
{
    imk_screen_count *outliers = &s->found.outliers;
    const size_t place = s->chunk * IMKI_SCREEN_CHUNK + i;
    if (outliers->count++ == 0)
        outliers->first = place;
    if (outliers->count == 1 || place != s->counting.last + 1)
        outliers->runs++;
    s->counting.last = place;
    s->found.largest_outlier = fmax(s->found.largest_outlier, distance);
    s->mark[i] |= IMKI_MARK_OUTLIER;
    s->marked = true;
}

static void assess(imk_screener *s, const stretch *in, size_t i)
{
    double spread;
    const double distance = fabs(in->value[i] - level_around(in, i, &spread));
    if (!(distance > in->shoulder))
        return;
    const bool near = distance <= in->threshold;
    if (distance <= 5 * spread || (!near && distance <= 6 * spread_beside(in, i)))
        return;
    if (near || distance <= 9 * spread)
        s->shoulder++;
    else
        note_outlier(s, s->place[i - in->margin], distance);
}

static void assess_block(imk_screener *s, const stretch *in, size_t i)
{
    double sorted[BLOCK];
    memcpy(sorted, in->value + i, sizeof sorted);
    imki_sort(sorted, BLOCK);
    const double level = sorted[BLOCK / 2];
    for (size_t k = i; k < i + BLOCK; k++)
        if (fabs(in->value[k] - level) > 0.5 * in->shoulder)
            assess(s, in, k);
}

/* Append the samples of a chunk that are there and not stuck, at most `most`. */
static size_t append(size_t count, const double *samples, const unsigned char *mark, size_t most,
                     double *value, uint32_t *place)
{
    size_t taken = 0;
    for (size_t i = 0; i < count && taken < most; i++) {
        if (samples[i] != samples[i] || (mark && mark[i]))
            continue;
        value[taken] = samples[i];
        if (place)
            place[taken] = (uint32_t)i;
        taken++;
    }
    return taken;
}

static void keep_tail(imk_screener *s, const stretch *in)
{
    const size_t count = in->end < REACH ? in->end : REACH;
    memmove(s->tail, in->value + in->end - count, count * sizeof *s->tail);
    s->tail_count = count;
}

void imki_screen_outliers(imk_screener *s)
{
    stretch in;
    in.value = s->value;
    in.margin = s->tail_count;
    memcpy(s->value, s->tail, s->tail_count * sizeof *s->tail);
    in.end = in.margin + append(s->count[0], s->raw[0], s->mark, IMKI_SCREEN_CHUNK,
                                s->value + in.margin, s->place);
    in.count = in.end + append(s->count[1], s->raw[1], NULL, REACH, s->value + in.end, NULL);
    set_scale(s, &in);
    size_t i = in.margin;
    for (size_t k = 0; in.threshold < HUGE_VAL && i + BLOCK <= in.end; i += BLOCK, k++)
        if (!(in.range[k] < in.shoulder))
            assess_block(s, &in, i);
    for (; in.threshold < HUGE_VAL && i < in.end; i++)
        assess(s, &in, i);
    keep_tail(s, &in);
}
