/* SPDX-License-Identifier: Apache-2.0 */
/* Rows of a log on the even grid of their times, NaN where something is missing.
 *
 * A row has its place round(step/interval) behind the row before; one whose time is not finite or
 * not later is left out. A value that is no reading is missing in its own channel only. */
#include "log_input.h"

#include "imukit/samples.h"

#include <math.h>
#include <stdlib.h>

/* Scatter of the steps, as a share of the interval: beyond the first the log is said to be
 * jittered, beyond the second its times are no grid. Uniform scatter of one interval's width is
 * 0.29, its difference of neighbours 0.41. */
static const double jitter_told = 0.05, jitter_most = 0.3;

static const double *time_of(const log_channels *channels)
{
    int column = imk_log_find(&channels->log, IMK_QUANTITY_TIME, -1);
    return column >= 0 ? channels->log.data[column] : NULL;
}

/* Places of the rows, SIZE_MAX for those left out; what is missing is counted.
 * @return places in all, 0 when they are out of proportion */
static size_t place_on_grid(log_channels *channels, const double *time, size_t *place,
                            size_t *first, size_t *last)
{
    const size_t rows = channels->log.rows;
    size_t count = 0;
    *first = *last = SIZE_MAX;
    for (size_t row = 0; row < rows; row++) {
        place[row] = SIZE_MAX;
        if (!isfinite(time[row]))
            continue;
        const size_t steps =
            *last == SIZE_MAX ? 1 : imk_step_intervals(time[row] - time[*last], channels->dt);
        if (steps == 0) {
            channels->unordered++;
            continue;
        }
        if (*last == SIZE_MAX)
            *first = row;
        if (count + steps > LOG_EMPTY_MOST * rows + 1000)
            return 0;
        place[row] = count + steps - 1;
        count += steps;
        channels->missing += steps - 1;
        channels->holes += steps > 1;
        channels->longest_hole =
            steps - 1 > channels->longest_hole ? steps - 1 : channels->longest_hole;
        *last = row;
    }
    return count;
}

/* One column spread over the grid. */
static bool spread(double **column, size_t rows, const size_t *place, size_t count)
{
    double *out = malloc((count + 1) * sizeof *out);
    if (!out)
        return false;
    for (size_t i = 0; i < count; i++)
        out[i] = (double)NAN;
    for (size_t row = 0; row < rows; row++)
        if (place[row] != SIZE_MAX)
            out[place[row]] = (*column)[row];
    free(*column);
    *column = out;
    return true;
}

static bool spread_all(log_channels *channels, const size_t *place, size_t count)
{
    imk_log *log = &channels->log;
    const int temperature = imk_log_find(log, IMK_QUANTITY_TEMPERATURE, -1);
    bool done = temperature < 0 || spread(&log->data[temperature], log->rows, place, count);
    for (size_t c = 0; done && c < channels->count; c++)
        done = spread(&log->data[channels->column[c]], log->rows, place, count);
    return done;
}

static bool is_missing(const log_channels *channels, size_t row)
{
    for (size_t c = 0; c < channels->count; c++)
        if (!isfinite(log_channel_data(channels, c)[row]))
            return true;
    return false;
}

/* Rows with something missing, and the first of them from 1. */
static size_t count_not_finite(const log_channels *channels, const double *time, size_t *first)
{
    size_t count = 0;
    for (size_t row = 0; row < channels->log.rows; row++)
        if (((time && !isfinite(time[row])) || is_missing(channels, row)) && count++ == 0)
            *first = row + 1;
    return count;
}

void log_grid_tell(const log_channels *channels, size_t first_not_finite)
{
    if (channels->not_finite > 0)
        command_warn("not_finite",
                     "%zu row%s with a value that is not a finite number or beyond 1e60, first "
                     "in row %zu: counted as missing",
                     channels->not_finite, channels->not_finite == 1 ? "" : "s", first_not_finite);
    if (channels->unordered > 0)
        command_warn("unordered", "%zu row%s whose time stands still or runs backwards: left out",
                     channels->unordered, channels->unordered == 1 ? "" : "s");
    if (channels->missing > 0)
        command_warn("missing",
                     "%zu of %zu samples are missing, in %zu hole%s, the longest of %g s: their "
                     "places are kept empty",
                     channels->missing, channels->rows, channels->holes,
                     channels->holes == 1 ? "" : "s",
                     (double)channels->longest_hole * channels->dt);
}

int log_grid_jitter(const char *path, const log_channels *channels)
{
    const double share = channels->log.findings.jitter / channels->dt;
    if (share > jitter_most)
        return command_failed("%s: the times are no even grid: steps scatter by %.0f %% of their "
                              "median, %g s; give the rate the samples were taken at, such as "
                              "--rate 100Hz, if only the time stamps scatter and the column is "
                              "left out with --columns, or resample the log",
                              path, 100 * share, channels->dt);
    if (share > jitter_told)
        command_warn("jitter",
                     "the times scatter by %.1f %% of the interval: samples are taken as evenly "
                     "spaced",
                     100 * share);
    return -1;
}

int log_keep_grid(const log_input *input, const char *path, log_channels *channels)
{
    const double *time = time_of(channels);
    const size_t rows = channels->log.rows;
    size_t first_not_finite = 0, first, last;
    int code = time ? log_grid_jitter(path, channels) : -1;
    if (code >= 0)
        return code;
    channels->not_finite = count_not_finite(channels, time, &first_not_finite);
    channels->rows = rows;
    if (time) {
        size_t *place = malloc(rows * sizeof *place);
        if (!place)
            return command_failed("%s: memory is exhausted", path);
        const size_t count = place_on_grid(channels, time, place, &first, &last);
        if (count == 0 || last <= first)
            code = command_failed("%s: the times leap by far more than there are rows: is there a "
                                  "jump of the clock? use --gaps longest (the longest clean "
                                  "stretch)",
                                  path);
        else if (!(input->rate > 0))
            channels->dt = (time[last] - time[first]) / (double)(count - 1);
        if (code < 0 && (count != rows || channels->unordered > 0))
            code = spread_all(channels, place, count)
                       ? -1
                       : command_failed("%s: memory is exhausted", path);
        free(place);
        if (code >= 0)
            return code;
        channels->rows = count;
    }
    const int temperature = imk_log_find(&channels->log, IMK_QUANTITY_TEMPERATURE, -1);
    channels->temperature = temperature >= 0 ? channels->log.data[temperature] : NULL;
    log_grid_tell(channels, first_not_finite);
    return -1;
}
