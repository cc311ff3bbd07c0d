/* SPDX-License-Identifier: Apache-2.0 */
/* Stretches between turns that look like rests, but were not taken as such, and why. By means over
 * a quarter of a second the unit hardly turns and the force hardly changes there: a coarser test
 * than that of the detection, which does not ask how much the readings scatter. What adjoins a rest
 * that was taken is a part of it, or the slow end of a turn. */
#include "record_diagnostics_internal.h"

#include "base/algebra/vector_internal.h"
#include "imukit/elementary.h"

#include <math.h>

/* Length of a mean [s]; a rate less that of the nearest rest [rad/s], 3 deg/s; a change of force
 * from one mean to the next [m/s^2]. */
static const double WINDOW = 0.25, STILL_RATE = 0.05, STILL_FORCE = 0.7;
/* Share of the mean length of the rests that were taken. */
static const double LEAST_LENGTH = 0.5;
/* Noise over that of the rests; angles by which the vertical moves, surely and at least [rad]. */
static const double NOISY = 1.3, SLIDES = 0.0175, SLIDES_LITTLE = 0.002;

typedef struct search {
    const imk_test_record *record;
    const imk_static_findings *findings;
    imki_axis_unit unit[2][3];
    const imk_static_interval *rest; /* beside the gap that is looked through */
    size_t part;                     /* samples of a mean */
    double minimum, least;           /* [samples] */
    size_t count, capacity;
    imk_static_lost *lost;
} search;

static double mean_of(const search *s, int sensor, int axis, size_t begin, size_t end)
{
    const double *x = s->record->reading[sensor][axis];
    double sum = 0.0;
    for (size_t k = begin; k < end; k++)
        sum += x[k];
    return (sum / (double)(end - begin) - s->unit[sensor][axis].zero) * s->unit[sensor][axis].unit;
}

/* A mean in which the unit hardly turns, with the force of the one before. */
static bool is_still(const search *s, size_t begin)
{
    const size_t before = begin >= s->part ? begin - s->part : begin;
    double rate = 0.0, change = 0.0;
    for (int i = 0; i < 3; i++) {
        const double rest = s->rest->mean[IMK_GYRO][i] - s->unit[IMK_GYRO][i].zero;
        const double off =
            mean_of(s, IMK_GYRO, i, begin, begin + s->part) - rest * s->unit[IMK_GYRO][i].unit;
        const double step = mean_of(s, IMK_ACCEL, i, begin, begin + s->part) -
                            mean_of(s, IMK_ACCEL, i, before, before + s->part);
        rate += off * off;
        change += step * step;
    }
    return rate < STILL_RATE * STILL_RATE && change < STILL_FORCE * STILL_FORCE;
}

/* Angle between the verticals of the first and the last quarter. */
static double slide_of(const search *s, size_t begin, size_t end)
{
    const size_t quarter = (end - begin) / 4;
    double first[3], last[3], across[3];
    for (int i = 0; i < 3; i++) {
        first[i] = mean_of(s, IMK_ACCEL, i, begin, begin + quarter);
        last[i] = mean_of(s, IMK_ACCEL, i, end - quarter, end);
    }
    imki_cross3(first, last, across);
    return imk_atan2(imki_norm3(across), imki_dot3(first, last));
}

/* Standard deviation within the means, over that of the rests. */
static double noise_of(const search *s, int sensor, int axis, size_t begin, size_t end)
{
    const double *x = s->record->reading[sensor][axis];
    double square = 0.0, count = 0.0;
    for (size_t k = begin; k + s->part <= end; k += s->part) {
        double sum = 0.0, squares = 0.0;
        for (size_t j = k; j < k + s->part; j++) {
            const double d = x[j] - x[k];
            sum += d;
            squares += d * d;
        }
        square += squares - sum * sum / (double)s->part;
        count += (double)(s->part - 1);
    }
    return count > 0.0 ? sqrt(square / count) / s->findings->noise[sensor][axis] : 0.0;
}

static imk_static_lost reason_of(const search *s, size_t begin, size_t end)
{
    imk_static_lost lost = {.begin = begin, .end = end, .reason = IMK_LOST_OTHER_RATE};
    const double slide = slide_of(s, begin, end);
    double noise = 0.0;
    for (int sensor = 0; sensor < 2; sensor++)
        for (int i = 0; i < 3; i++) {
            const double ratio = noise_of(s, sensor, i, begin, end);
            if (ratio > noise && isfinite(ratio)) {
                noise = ratio;
                lost.sensor = sensor;
                lost.axis = i;
            }
        }
    if (slide > SLIDES || (slide > SLIDES_LITTLE && noise < NOISY)) {
        lost.reason = IMK_LOST_SLIDES;
        lost.value = slide;
    } else if (noise > NOISY) {
        lost.reason = IMK_LOST_NOISY;
        lost.value = noise;
    } else if ((double)(end - begin) < s->minimum)
        lost.reason = IMK_LOST_SHORT;
    return lost;
}

/* At both ends the turns may be slow: they are no reason. */
static void add_lost(search *s, size_t begin, size_t end)
{
    if (s->count < s->capacity) {
        s->lost[s->count] = reason_of(s, begin + s->part, end - s->part);
        s->lost[s->count].begin = begin;
        s->lost[s->count].end = end;
    }
    s->count++;
}

/* One gap; a stretch at an end of it where a rest was taken is a part of that rest. */
static void look_through(search *s, size_t begin, size_t end, bool rest_before, bool rest_after)
{
    size_t k = begin;
    for (bool first = true; k + s->part <= end; first = false) {
        size_t from = k;
        while (from + s->part <= end && !is_still(s, from))
            from += s->part;
        size_t to = from;
        while (to + s->part <= end && is_still(s, to))
            to += s->part;
        const bool adjoins = (first && rest_before && from <= begin + s->part) ||
                             (rest_after && to + 2 * s->part > end);
        if (!adjoins && to > from && (double)(to - from) >= s->least) {
            add_lost(s, from, to);
        }
        k = to > from ? to : end;
    }
}

static bool has_units(search *s, const imk_model *model)
{
    for (int sensor = 0; sensor < 2; sensor++) {
        if (s->record->means || s->record->axis_count[sensor] != 3)
            return false;
        for (int i = 0; i < 3; i++) {
            s->unit[sensor][i] = imki_record_unit(s->record, model, sensor, i);
            if (!s->record->reading[sensor][i] || s->unit[sensor][i].unit == 0.0)
                return false;
        }
    }
    return true;
}

size_t imk_static_lost_rests(const imk_test_record *record, const imk_static_settings *settings,
                             const imk_model *model, const imk_static_findings *findings,
                             size_t interval_count, const imk_static_interval *interval,
                             size_t capacity, imk_static_lost *lost)
{
    search s = {.record = record, .findings = findings, .capacity = capacity, .lost = lost};
    if (!record || !settings || !findings || !interval || interval_count == 0 ||
        !has_units(&s, model))
        return 0;
    s.part = (size_t)ceil(WINDOW / record->dt);
    if (s.part < 4)
        s.part = 4;
    for (size_t i = 0; i < interval_count; i++)
        s.least += LEAST_LENGTH * (double)(interval[i].end - interval[i].begin);
    s.least = fmax(s.least / (double)interval_count, 4.0 * (double)s.part);
    s.minimum = settings->minimum / record->dt;
    for (size_t i = 0; i <= interval_count; i++) {
        s.rest = &interval[i > 0 ? i - 1 : 0];
        look_through(&s, i > 0 ? interval[i - 1].end : 0,
                     i < interval_count ? interval[i].begin : record->count, i > 0,
                     i < interval_count);
    }
    return s.count;
}
