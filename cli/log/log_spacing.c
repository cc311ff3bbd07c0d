/* SPDX-License-Identifier: Apache-2.0 */
/* Equally spaced samples out of the rows of a log.
 *
 * A row is bad when a value to be analysed is no reading, or when its time is not later than that
 * of the last good row. Between good rows lie round(step/interval) intervals; where that is more
 * than one, samples are missing. They are refused, interpolated on a straight line, or avoided by
 * taking the longest stretch without any, as the policy says; log_grid.c keeps their places. */
#include "log_input.h"

#include "imukit/samples.h"

#include <math.h>
#include <stdlib.h>
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

static const double *time_column(const log_channels *channels)
{
    int column = imk_log_find(&channels->log, IMK_QUANTITY_TIME, -1);
    return column >= 0 ? channels->log.data[column] : NULL;
}

/* First channel whose value in a row is not finite, or -1. */
static int bad_channel(const log_channels *channels, const double *time, size_t row)
{
    for (size_t c = 0; c < channels->count; c++)
        if (!isfinite(log_channel_data(channels, c)[row]))
            return (int)c;
    return time && !isfinite(time[row]) ? (int)channels->count : -1;
}

static spacing inspect(const log_channels *channels)
{
    const double *time = time_column(channels);
    spacing s = {0};
    bool any = false;
    size_t last = 0, start = 0;
    for (size_t row = 0; row < channels->log.rows; row++) {
        int bad = bad_channel(channels, time, row);
        size_t steps = !any   ? 1
                       : time ? imk_step_intervals(time[row] - time[last], channels->dt)
                              : row - last;
        if (bad >= 0) {
            if (s.not_finite++ == 0) {
                s.first_not_finite = row + 1;
                s.not_finite_column = bad < (int)channels->count
                                          ? log_channel_column(channels, (size_t)bad)->name
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

/* The interval as the mean step over the rows used: the median step that found the gaps is off by
 * the resolution of the time column (7.8125 ms reads as 8 ms in whole milliseconds). */
static void refine_interval(const log_input *input, log_channels *channels, size_t first,
                            size_t last, size_t steps)
{
    const double *time = time_column(channels);
    if (!(input->rate > 0) && time && steps > 0 && time[last] > time[first])
        channels->dt = (time[last] - time[first]) / (double)steps;
}

/* Keep rows start … start + length - 1. */
static void keep_stretch(log_channels *channels, size_t start, size_t length)
{
    for (size_t c = 0; c < channels->count; c++) {
        double *data = log_channel_data(channels, c);
        memmove(data, data + start, length * sizeof *data);
    }
    channels->rows = length;
}

/* For each good row its place on the grid; SIZE_MAX for rows that are left out. */
static size_t place_rows(const log_channels *channels, size_t *place)
{
    const double *time = time_column(channels);
    size_t count = 0, last = SIZE_MAX;
    for (size_t row = 0; row < channels->log.rows; row++) {
        place[row] = SIZE_MAX;
        if (bad_channel(channels, time, row) >= 0)
            continue;
        size_t steps = last == SIZE_MAX ? 1
                       : time           ? imk_step_intervals(time[row] - time[last], channels->dt)
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

static int bridge(const log_input *input, const char *path, log_channels *channels)
{
    size_t rows = channels->log.rows, good = 0, first = 0, last = 0;
    size_t *place = malloc(rows * sizeof *place);
    if (!place)
        return command_failed("%s: memory is exhausted", path);
    size_t count = place_rows(channels, place);
    for (size_t row = 0; row < rows; row++) {
        if (place[row] == SIZE_MAX)
            continue;
        first = good++ == 0 ? row : first;
        last = row;
    }
    int code = -1;
    if (good < 2 || count > 2 * good)
        code = command_failed("%s: more is missing than is there (%zu good rows, %zu samples "
                              "missing): nothing to interpolate; use --gaps longest",
                              path, good, count - good);
    for (size_t c = 0; code < 0 && c < channels->count; c++) {
        double *out = malloc((count + 1) * sizeof *out);
        if (!out) {
            code = command_failed("%s: memory is exhausted", path);
            break;
        }
        double **slot = &channels->log.data[channels->column[c]];
        interpolate(*slot, rows, place, out);
        free(*slot);
        *slot = out;
    }
    free(place);
    if (code < 0)
        refine_interval(input, channels, first, last, count - 1);
    channels->rows = count;
    channels->bridged = count - good;
    return code;
}

static int refuse(const char *path, const spacing *s)
{
    const char *remedy = "use --gaps longest (the longest clean stretch) or --gaps bridge "
                         "(interpolate)";
    if (s->not_finite)
        return command_failed("%s: %zu row%s with a value that is not a finite number or beyond "
                              "1e60, first in row %zu, column %s; %s",
                              path, s->not_finite, s->not_finite == 1 ? "" : "s",
                              s->first_not_finite, s->not_finite_column, remedy);
    if (s->unordered) {
        char by[40] = "";
        if (s->first_step < 0)
            snprintf(by, sizeof by, " (by %g s)", -s->first_step);
        return command_failed("%s: time %s in %zu row%s, first in row %zu%s; %s", path,
                              s->first_step < 0 ? "runs backwards" : "stands still", s->unordered,
                              s->unordered == 1 ? "" : "s", s->first_unordered, by, remedy);
    }
    return command_failed("%s: %zu samples are missing in %zu gap%s, first before row %zu; %s",
                          path, s->missing, s->gaps, s->gaps == 1 ? "" : "s", s->first_gap, remedy);
}

int log_space_evenly(const log_input *input, const char *path, log_channels *channels)
{
    const imk_log_findings *findings = &channels->log.findings;
    size_t rows = channels->log.rows;
    channels->dt = input->rate > 0 ? 1 / input->rate : findings->interval;
    channels->rows = rows;
    if (rows < 2)
        return command_failed("%s: there is one row only; a static record of minutes to hours is "
                              "due",
                              path);
    if (!(channels->dt > 0) || !isfinite(channels->dt))
        return command_failed("%s: the time column does not increase, so the sample rate is not "
                              "known; name it, such as --rate 100Hz",
                              path);
    if (input->gaps == GAPS_KEEP)
        return log_keep_grid(input, path, channels);
    spacing s = inspect(channels);
    size_t bad = s.not_finite + s.unordered;
    if (bad == 0 && s.gaps == 0) {
        refine_interval(input, channels, 0, rows - 1, rows - 1);
        return -1;
    }
    double missing = (double)s.missing / (double)(s.missing + rows);
    if (input->gaps == GAPS_LONGEST) {
        command_warn("longest_stretch",
                     "%zu bad, %zu missing: using the longest clean stretch, rows %zu to %zu of "
                     "%zu",
                     bad, s.missing, s.longest_start + 1, s.longest_start + s.longest_length, rows);
        if (s.longest_length < 2)
            return command_failed("%s: no two rows in a row are good", path);
        refine_interval(input, channels, s.longest_start, s.longest_start + s.longest_length - 1,
                        s.longest_length - 1);
        keep_stretch(channels, s.longest_start, s.longest_length);
        return -1;
    }
    if (input->gaps == GAPS_REFUSE && (bad > 0 || missing > bridged_fraction_max))
        return refuse(path, &s);
    int code = bridge(input, path, channels);
    if (code < 0)
        command_warn("bridged", "%zu of %zu samples are missing or bad: bridged by straight lines",
                     channels->bridged, channels->rows);
    return code;
}
