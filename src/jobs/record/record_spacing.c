/* SPDX-License-Identifier: Apache-2.0 */
/* Equally spaced samples out of the rows of a record.
 *
 * A row is bad when a value to be analysed is no reading, or when its time is not later than that
 * of the last good row. Between good rows lie round(step/interval) intervals; where that is more
 * than one, samples are missing. They are refused, interpolated on a straight line, or avoided by
 * taking the longest stretch without any, as the policy says; record_grid.c keeps their places. */
#include "even_record_internal.h"

#include "jobs/arena_internal.h"
#include "jobs/job_internal.h"

#include "imukit/samples.h"

#include <math.h>
#include <string.h>

/* Of missing samples a straight line hides this much without harm: it lowers the white-noise
 * variance by about the same fraction, far less than its statistical error on usual records. */
static const double bridged_fraction_max = 1e-3;

/* What is wrong in the analysed columns. Rows count from 1. */
typedef struct spacing {
    size_t not_finite, first_not_finite;
    const char *not_finite_column;
    size_t unordered, first_unordered;
    size_t gaps, first_gap, missing;
    size_t longest_start, longest_length; /* of the longest clean stretch, from 0 */
    double first_step;                    /* the step of the first disorder [s] */
} spacing;

static const double *time_column(const imk_even_record *record)
{
    int column = imk_log_find(&record->log, IMK_QUANTITY_TIME, -1);
    return column >= 0 ? record->log.data[column] : NULL;
}

/* First channel whose value in a row is not finite, or -1. */
static int bad_channel(const imk_even_record *record, const double *time, size_t row)
{
    for (size_t c = 0; c < record->count; c++)
        if (!isfinite(imk_even_record_data(record, c)[row]))
            return (int)c;
    return time && !isfinite(time[row]) ? (int)record->count : -1;
}

static spacing inspect(const imk_even_record *record)
{
    const double *time = time_column(record);
    spacing s = {0};
    bool any = false;
    size_t last = 0, start = 0;
    for (size_t row = 0; row < record->log.rows; row++) {
        int bad = bad_channel(record, time, row);
        size_t steps = !any   ? 1
                       : time ? imk_step_intervals(time[row] - time[last], record->dt)
                              : row - last;
        if (bad >= 0) {
            if (s.not_finite++ == 0) {
                s.first_not_finite = row + 1;
                s.not_finite_column = bad < (int)record->count
                                          ? imk_even_record_column(record, (size_t)bad)->name
                                          : "time";
            }
        } else if (steps == 0) {
            if (s.unordered++ == 0) {
                s.first_unordered = row + 1;
                s.first_step = time[row] - time[last];
            }
        } else if (steps > 1 && row == last + 1) {
            if (s.gaps++ == 0)
                s.first_gap = row + 1;
            s.missing += steps - 1;
        }
        bool good = bad < 0 && steps > 0;
        if (!any || !good || steps > 1 || row != last + 1)
            start = row + (good ? 0 : 1);
        if (good) {
            any = true;
            last = row;
            if (row + 1 - start > s.longest_length) {
                s.longest_length = row + 1 - start;
                s.longest_start = start;
            }
        }
    }
    return s;
}

/* The time of the first row; and the interval as the mean step over the rows used: the median step
 * that found the gaps is off by the resolution of the time column (7.8125 ms reads as 8 ms in whole
 * milliseconds). */
static void refine_interval(double rate, imk_even_record *record, size_t first, size_t last,
                            size_t steps)
{
    const double *time = time_column(record);
    if (!(rate > 0) && time && steps > 0 && time[last] > time[first])
        record->dt = (time[last] - time[first]) / (double)steps;
    record->first_time = time && isfinite(time[first]) ? time[first] : 0.0;
}

/* Keep rows start … start + length - 1. */
static void keep_stretch(imk_even_record *record, size_t start, size_t length)
{
    for (size_t c = 0; c < record->count; c++) {
        double *data = imk_even_record_data(record, c);
        memmove(data, data + start, length * sizeof *data);
    }
    record->rows = length;
}

/* For each good row its place on the grid; SIZE_MAX for rows that are left out. */
static size_t place_rows(const imk_even_record *record, size_t *place)
{
    const double *time = time_column(record);
    size_t count = 0, last = SIZE_MAX;
    for (size_t row = 0; row < record->log.rows; row++) {
        place[row] = SIZE_MAX;
        if (bad_channel(record, time, row) >= 0)
            continue;
        size_t steps = last == SIZE_MAX ? 1
                       : time           ? imk_step_intervals(time[row] - time[last], record->dt)
                                        : row - last;
        if (steps == 0)
            continue;
        place[row] = last == SIZE_MAX ? 0 : place[last] + steps;
        count = place[row] + 1;
        last = row;
    }
    return count;
}

/* Straight lines over what is missing between good rows. */
static void interpolate(const double *data, size_t rows, const size_t *place, double *out)
{
    size_t last = SIZE_MAX;
    for (size_t row = 0; row < rows; row++) {
        if (place[row] == SIZE_MAX)
            continue;
        out[place[row]] = data[row];
        if (last != SIZE_MAX) {
            size_t steps = place[row] - place[last];
            double slope = (data[row] - data[last]) / (double)steps;
            for (size_t k = 1; k < steps; k++)
                out[place[last] + k] = data[last] + slope * (double)k;
        }
        last = row;
    }
}

/* The columns with straight lines over what is missing. */
static imk_status interpolate_all(imk_even_record *record, const size_t *place, size_t count,
                                  imk_error *error)
{
    imk_log *log = &record->log;
    for (size_t c = 0; c < record->count; c++) {
        double **slot = &log->data[record->column[c]];
        double *out = imki_resize(&log->allocator, NULL, (count + 1) * sizeof *out);
        if (!out)
            return imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
        interpolate(*slot, log->rows, place, out);
        imki_resize(&log->allocator, *slot, 0);
        *slot = out;
    }
    return IMK_OK;
}

static imk_status bridge(double rate, imk_even_record *record, imk_findings *findings,
                         imk_error *error)
{
    const size_t rows = record->log.rows;
    size_t good = 0, first = 0, last = 0;
    imki_arena scratch = {.allocator = record->log.allocator};
    size_t *place = imki_arena_room(&scratch, rows * sizeof *place);
    if (!place)
        return imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
    const size_t count = place_rows(record, place);
    for (size_t row = 0; row < rows; row++) {
        if (place[row] == SIZE_MAX)
            continue;
        first = good++ == 0 ? row : first;
        last = row;
    }
    imk_status status = IMK_OK;
    if (good < 2 || count > 2 * good)
        status = imki_fail(findings, error, IMK_ERROR_GAP, "mostly_missing", NULL,
                           IMKI_NUMBERS((double)good, (double)(count - good)));
    if (status == IMK_OK)
        status = interpolate_all(record, place, count, error);
    imki_arena_free(&scratch);
    if (status != IMK_OK)
        return status;
    refine_interval(rate, record, first, last, count - 1);
    record->rows = count;
    record->bridged = count - good;
    imki_find(findings, IMK_FINDING_WARNING, "bridged", NULL,
              IMKI_NUMBERS((double)record->bridged, (double)record->rows));
    return IMK_OK;
}

static imk_status refuse(const spacing *s, imk_findings *findings, imk_error *error)
{
    if (s->not_finite)
        return imki_fail(findings, error, IMK_ERROR_GAP, "refused_not_finite", s->not_finite_column,
                         IMKI_NUMBERS((double)s->not_finite, (double)s->first_not_finite));
    if (s->unordered)
        return imki_fail(
            findings, error, IMK_ERROR_GAP,
            s->first_step < 0 ? "refused_backwards" : "refused_standing", NULL,
            IMKI_NUMBERS((double)s->unordered, (double)s->first_unordered, -s->first_step));
    return imki_fail(findings, error, IMK_ERROR_GAP, "refused_missing", NULL,
                     IMKI_NUMBERS((double)s->missing, (double)s->gaps, (double)s->first_gap));
}

static imk_status take_longest(double rate, const spacing *s, imk_even_record *record,
                               imk_findings *findings, imk_error *error)
{
    const size_t start = s->longest_start, length = s->longest_length;
    const size_t rows = record->log.rows;
    imki_find(findings, IMK_FINDING_WARNING,
              length < rows / 10           ? "stamps:short_stretch"
              : length < rows - rows / 100 ? "stamps:longest_stretch"
                                           : "longest_stretch",
              NULL,
              IMKI_NUMBERS((double)(s->not_finite + s->unordered), (double)s->missing,
                           (double)(start + 1), (double)(start + length), (double)rows,
                           100 * (double)length / (double)rows));
    if (length < 2)
        return imki_fail(findings, error, IMK_ERROR_GAP, "no_good_rows", NULL, 0, NULL);
    refine_interval(rate, record, start, start + length - 1, length - 1);
    keep_stretch(record, start, length);
    return IMK_OK;
}

imk_status imki_space_evenly(double rate, imk_gap_policy gaps, imk_even_record *record,
                             imk_findings *findings, imk_error *error)
{
    const size_t rows = record->log.rows;
    const spacing s = inspect(record);
    const size_t bad = s.not_finite + s.unordered;
    const double missing = (double)s.missing / (double)(s.missing + rows);
    if (bad == 0 && s.gaps == 0) {
        refine_interval(rate, record, 0, rows - 1, rows - 1);
        return IMK_OK;
    }
    if (gaps == IMK_GAPS_LONGEST)
        return take_longest(rate, &s, record, findings, error);
    if (gaps == IMK_GAPS_REFUSE && (bad > 0 || missing > bridged_fraction_max))
        return refuse(&s, findings, error);
    return bridge(rate, record, findings, error);
}
