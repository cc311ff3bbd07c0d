/* SPDX-License-Identifier: Apache-2.0 */
/* When to look at a drift: round times for a table, and those between for curves. */
#include "imukit/drift_models.h"

#include "base/refuse_internal.h"
#include "jobs/arena_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { CURVE_POINTS = 96 };

static const double minute = 60, hour = 3600, day = 86400;

static int compare(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Times are those of samples: the nearest, but not the start. */
static double on_sample(double time, double rate)
{
    const double sample = floor(time * rate + 0.5);
    return (sample < 1 ? 1 : sample) / rate;
}

/* In order, none twice. */
static size_t tidy(double *time, size_t count, double rate)
{
    size_t kept = 0;
    for (size_t i = 0; i < count; i++)
        time[i] = on_sample(time[i], rate);
    qsort(time, count, sizeof *time, compare);
    for (size_t i = 0; i < count; i++)
        if (kept == 0 || time[i] > time[kept - 1])
            time[kept++] = time[i];
    return kept;
}

/* Round times up to the duration, as many as a table is easily read with, and the duration. */
static size_t usual_times(double duration, double at[IMK_DRIFT_ROWS_MAX])
{
    const double coarse[] = {10,       minute,   5 * minute, 10 * minute, 30 * minute,
                             hour,     2 * hour, 4 * hour,   8 * hour,    12 * hour,
                             day,      2 * day,  4 * day,    7 * day,     14 * day,
                             30 * day, 60 * day, 120 * day,  365 * day};
    const double fine[] = {0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 30, 60, 120, 300};
    size_t count = 0;
    const bool is_short = duration <= 10 * minute;
    const double *ladder = is_short ? fine : coarse;
    const size_t steps = is_short ? sizeof fine / sizeof *fine : sizeof coarse / sizeof *coarse;
    for (size_t i = 0; i < steps; i++)
        if (ladder[i] < 0.999 * duration && ladder[i] > duration / (is_short ? 200 : 2e4))
            at[count++] = ladder[i];
    at[count++] = duration;
    return count;
}

/* The first row behind the origin. */
static double first_after(const double *time, size_t rows, double origin)
{
    for (size_t i = 0; i < rows; i++)
        if (time[i] > origin)
            return time[i] - origin;
    return 0;
}

/* Times between, of a curve from the origin that ends with the last row. @return how many times
 * there are */
static size_t fill(double *time, size_t rows, size_t linear, double origin)
{
    const double row = first_after(time, rows, origin), last = time[rows - 1] - origin;
    const double start = origin > 0 ? 1 : 10, first = row < start ? row : start;
    size_t count = rows;
    for (size_t i = 0; last > first && first > 0 && i < CURVE_POINTS; i++)
        time[count++] = origin + first * pow(last / first, (double)i / CURVE_POINTS);
    for (size_t i = 1; i < linear; i++)
        time[count++] = origin + last * (double)i / (double)linear;
    return count;
}

static imk_status check_positive(const char *field, double value, imk_error *error)
{
    if (value > 0 && isfinite(value))
        return IMK_OK;
    return imki_refuse(error, IMK_ERROR_RANGE, field, value, 0, "a finite number above 0");
}

imk_status imk_drift_times_choose(double duration, size_t count, const double *stated,
                                  double wanted, double rate, bool curves, double origin,
                                  const imk_allocator *allocator, imk_drift_times *times,
                                  imk_error *error)
{
    const double period = 84.4 * minute;
    double at[IMK_DRIFT_ROWS_MAX];
    if (!times || (count > 0 && !stated))
        return imk_error_set(error, IMK_ERROR_ARGUMENT, times ? "stated" : "times", NULL, NULL);
    *times =
        (imk_drift_times){.allocator = allocator ? *allocator : (imk_allocator){.resize = NULL}};
    if (count + (wanted > 0) > IMK_DRIFT_ROWS_MAX)
        return imki_refuse(error, IMK_ERROR_RANGE, "count", (double)count, IMK_DRIFT_ROWS_MAX,
                           NULL);
    imk_status status = check_positive("rate", rate, error);
    if (status == IMK_OK && count == 0)
        status = check_positive("duration", duration, error);
    for (size_t i = 0; i < count && status == IMK_OK; i++)
        status = check_positive("stated", stated[i], error);
    if (status != IMK_OK)
        return status;
    for (size_t i = 0; i < count; i++)
        at[i] = stated[i];
    size_t rows = count > 0 ? count : usual_times(duration, at);
    if (wanted > 0)
        at[rows++] = wanted;
    rows = tidy(at, rows, rate);
    const double length = at[rows - 1] - origin;
    const size_t swings = length > period ? (size_t)(8 * length / period) : 0;
    const size_t linear = swings > 1000 ? 1000 : swings;
    const size_t room = rows + CURVE_POINTS + linear;
    times->time = imki_resize(&times->allocator, NULL, room * sizeof *times->time);
    times->row = imki_resize(&times->allocator, NULL, rows * sizeof *times->row);
    if (!times->time || !times->row) {
        imk_drift_times_free(times);
        return imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
    }
    memcpy(times->time, at, rows * sizeof *at);
    times->count = tidy(times->time, curves ? fill(times->time, rows, linear, origin) : rows, rate);
    for (size_t i = 0; i < times->count; i++)
        for (size_t k = 0; k < rows; k++)
            if (times->time[i] == at[k])
                times->row[times->row_count++] = i;
    return IMK_OK;
}

void imk_drift_times_free(imk_drift_times *times)
{
    imki_resize(&times->allocator, times->time, 0);
    imki_resize(&times->allocator, times->row, 0);
    *times = (imk_drift_times){.allocator = times->allocator};
}
