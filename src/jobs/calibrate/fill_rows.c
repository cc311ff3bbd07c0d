/* SPDX-License-Identifier: Apache-2.0 */
/* Rows that a logger wrote where it had no reading: the same values of all axes of a sensor, mostly
 * zeros, again and again.
 *
 * The unit cannot be there for so short a time: on some axis the readings jump to the value and
 * back, by more than SCALE times what they differ by in the BESIDE rows before and in those behind,
 * and by more than STEPS steps. A spike does so too, but does not come to the same values of all
 * axes LEAST times. At rest near zero such rows do not show, and do little harm; they are counted
 * once others have shown. */
#include "calibrate_internal.h"

#include "calibrate/standstill/static_internal.h"
#include "jobs/job_internal.h"

#include <math.h>

enum { BESIDE = 4, STEPS = 8, SCALE = 4, LEAST = 3, VALUES = 16 };

/* Longer ones may be rests [s]. */
static const double longest = 0.5;
/* So many rows of the log must have shown; fewer change no value by a per cent. */
static const double least_share = 2e-4;

/* A value of all axes that a run of rows jumped to. */
typedef struct fill_value {
    size_t row; /* the first with it */
    size_t shown;
} fill_value;

typedef struct fill_search {
    const imk_test_record *record;
    int sensor;
    double step[IMK_AXES_MAX];
    size_t count; /* of values */
    fill_value value[VALUES];
} fill_search;

static bool equal_rows(const fill_search *s, size_t a, size_t b)
{
    for (int i = 0; i < s->record->axis_count[s->sensor]; i++)
        if (!(s->record->reading[s->sensor][i][a] == s->record->reading[s->sensor][i][b]))
            return false;
    return true;
}

/* Largest less smallest of BESIDE rows. */
static double range_of(const double *x)
{
    double low = x[0], high = x[0];
    for (int k = 1; k < BESIDE; k++) {
        low = x[k] < low ? x[k] : low;
        high = x[k] > high ? x[k] : high;
    }
    return high - low;
}

/* Do rows begin … end - 1, which are equal, lie on one side of those before and behind them? */
static bool jumps(const fill_search *s, size_t begin, size_t end)
{
    for (int i = 0; i < s->record->axis_count[s->sensor]; i++) {
        const double *x = s->record->reading[s->sensor][i];
        const double before = x[begin - 1] - x[begin], after = x[end] - x[begin];
        const double beside = fmax(range_of(x + begin - BESIDE), range_of(x + end));
        const double limit = fmax(SCALE * fmax(beside, fabs(before - after)), STEPS * s->step[i]);
        if (before * after > 0.0 && fmin(fabs(before), fabs(after)) > limit)
            return true;
    }
    return false;
}

static void note_value(fill_search *s, size_t row)
{
    size_t k = 0;
    while (k < s->count && !equal_rows(s, s->value[k].row, row))
        k++;
    if (k == VALUES)
        return;
    if (k == s->count)
        s->value[s->count++] = (fill_value){.row = row};
    s->value[k].shown++;
}

/* The value that jumped most often. */
static fill_value most_frequent(const fill_search *s)
{
    fill_value most = {0, 0};
    for (size_t k = 0; k < s->count; k++)
        most = s->value[k].shown > most.shown ? s->value[k] : most;
    return most;
}

static void tell_fill(fill_search *s, imk_findings *findings)
{
    const imk_test_record *record = s->record;
    const fill_value most = most_frequent(s);
    size_t rows = 0;
    bool zero = true;
    if (most.shown < LEAST || (double)most.shown < least_share * (double)record->count)
        return;
    for (size_t k = 0; k < record->count; k++)
        rows += equal_rows(s, most.row, k);
    for (int i = 0; i < record->axis_count[s->sensor]; i++)
        zero = zero && record->reading[s->sensor][i][most.row] == 0.0;
    imki_find(findings, IMK_FINDING_WARNING, "calibrate:fill_rows", imki_sensor_titles[s->sensor],
              IMKI_NUMBERS((double)rows, (double)record->count, (double)most.row + 1, zero));
}

void imki_tell_fill_rows(const imk_test_record *record, imk_findings *findings)
{
    const double most = longest / record->dt;
    for (int sensor = 0; sensor < 2; sensor++) {
        fill_search s = {.record = record, .sensor = sensor};
        for (int i = 0; i < record->axis_count[sensor]; i++)
            s.step[i] = imki_static_step(record->reading[sensor][i], 0, record->count);
        for (size_t begin = BESIDE, end; begin + 1 + BESIDE <= record->count; begin = end) {
            end = begin + 1;
            while (end < record->count && equal_rows(&s, begin, end))
                end++;
            if ((double)(end - begin) <= most && end + BESIDE <= record->count &&
                jumps(&s, begin, end))
                note_value(&s, begin);
        }
        if (record->axis_count[sensor] > 0)
            tell_fill(&s, findings);
    }
}
