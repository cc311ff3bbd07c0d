/* SPDX-License-Identifier: Apache-2.0 */
/* Rows of a record on the even grid of their times, NaN where something is missing. A value that is
 * no reading is missing in its own channel only. */
#include "even_record_internal.h"

#include "jobs/arena_internal.h"
#include "jobs/job_internal.h"

#include "imukit/samples.h"

#include <math.h>

/* Scatter of the steps, as a share of the interval: beyond the first the record is said to be
 * jittered, beyond the second its times are no grid. Uniform scatter of one interval's width is
 * 0.29, its difference of neighbours 0.41. */
static const double jitter_told = 0.01 * IMKI_JITTER_TOLD, jitter_most = 0.3;

/* More empty places than this for every row are a jump of the clock, not missing samples. */
enum { EMPTY_MOST = 20, EMPTY_ALLOWED = 1000 };

size_t imki_grid_step(imki_grid *grid, double time, imk_even_record *record)
{
    if (!isfinite(time))
        return 0;
    const size_t steps =
        grid->places == 0 ? 1 : imk_step_intervals(time - grid->last_time, grid->interval);
    if (steps == 0) {
        record->unordered++;
        return 0;
    }
    if (grid->places + steps > EMPTY_MOST * grid->rows + EMPTY_ALLOWED) {
        grid->leaps = true;
        return 0;
    }
    if (grid->places == 0)
        grid->first_time = time;
    grid->last_time = time;
    grid->places += steps;
    record->missing += steps - 1;
    record->holes += steps > 1;
    record->longest_hole = steps - 1 > record->longest_hole ? steps - 1 : record->longest_hole;
    return steps;
}

static const double *time_of(const imk_even_record *record)
{
    const int column = imk_log_find(&record->log, IMK_QUANTITY_TIME, -1);
    return column >= 0 ? record->log.data[column] : NULL;
}

/* Places of the rows, SIZE_MAX for those left out. */
static void place_rows(imk_even_record *record, const double *time, imki_grid *grid, size_t *place)
{
    const size_t rows = record->log.rows;
    *grid = (imki_grid){.interval = record->dt, .rows = rows};
    for (size_t row = 0; row < rows && !grid->leaps; row++)
        place[row] = imki_grid_step(grid, time[row], record) > 0 ? grid->places - 1 : SIZE_MAX;
}

/* One column spread over the grid. */
static bool spread(imk_log *log, int column, const size_t *place, size_t count)
{
    double *out = imki_resize(&log->allocator, NULL, (count + 1) * sizeof *out);
    if (!out)
        return false;
    for (size_t i = 0; i < count; i++)
        out[i] = (double)NAN;
    for (size_t row = 0; row < log->rows; row++)
        if (place[row] != SIZE_MAX)
            out[place[row]] = log->data[column][row];
    imki_resize(&log->allocator, log->data[column], 0);
    log->data[column] = out;
    return true;
}

static bool spread_all(imk_even_record *record, const size_t *place, size_t count)
{
    imk_log *log = &record->log;
    const int temperature = imk_log_find(log, IMK_QUANTITY_TEMPERATURE, -1);
    bool done = temperature < 0 || spread(log, temperature, place, count);
    for (size_t c = 0; done && c < record->count; c++)
        done = spread(log, record->column[c], place, count);
    return done;
}

/* Rows with something missing, and the first of them from 1. */
static size_t count_not_finite(const imk_even_record *record, const double *time, size_t *first)
{
    size_t count = 0;
    for (size_t row = 0; row < record->log.rows; row++) {
        bool finite = !time || isfinite(time[row]);
        for (size_t c = 0; finite && c < record->count; c++)
            finite = isfinite(imk_even_record_data(record, c)[row]);
        if (!finite && count++ == 0)
            *first = row + 1;
    }
    return count;
}

/* More than 1 % are a fault of the record. */
static const char *unordered_code(const imk_even_record *record)
{
    return record->unordered > record->log.rows / 100 ? "stamps:unordered" : "unordered";
}

void imki_grid_tell(const imk_even_record *record, size_t first_not_finite, imk_findings *findings)
{
    if (record->not_finite > 0)
        imki_find(findings, IMK_FINDING_WARNING, "not_finite", NULL,
                  IMKI_NUMBERS((double)record->not_finite, (double)first_not_finite));
    if (record->unordered > record->log.findings.doubled)
        imki_find(findings, IMK_FINDING_WARNING, unordered_code(record), NULL,
                  IMKI_NUMBERS((double)record->unordered, (double)record->log.rows));
    if (record->missing > 0)
        imki_find(findings, IMK_FINDING_WARNING, "missing", NULL,
                  IMKI_NUMBERS((double)record->missing, (double)record->rows, (double)record->holes,
                               (double)record->longest_hole * record->dt));
}

imk_status imki_grid_jitter(const imk_even_record *record, imk_findings *findings, imk_error *error)
{
    const double share = record->log.findings.jitter / record->dt;
    if (share > jitter_most)
        return imki_fail(findings, error, IMK_ERROR_TIME_ORDER, "no_grid", NULL,
                         IMKI_NUMBERS(100 * share, record->dt));
    if (share > jitter_told)
        imki_find(findings, IMK_FINDING_WARNING, "jitter", NULL, IMKI_NUMBERS(100 * share));
    return IMK_OK;
}

/* The rows on their places. */
static imk_status place_all(double rate, const double *time, imk_even_record *record,
                            imk_findings *findings, imk_error *error)
{
    imki_grid grid;
    imki_arena scratch = {.allocator = record->log.allocator};
    size_t *place = imki_arena_room(&scratch, record->log.rows * sizeof *place);
    imk_status status = place ? IMK_OK : imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
    if (place)
        place_rows(record, time, &grid, place);
    if (place && (grid.leaps || grid.places == 0 || !(grid.last_time > grid.first_time)))
        status = imki_fail(findings, error, IMK_ERROR_TIME_ORDER, "clock_leaps", NULL, 0, NULL);
    if (place)
        record->first_time = grid.first_time;
    if (status == IMK_OK && !(rate > 0))
        record->dt = (grid.last_time - grid.first_time) / (double)(grid.places - 1);
    if (status == IMK_OK && (grid.places != record->log.rows || record->unordered > 0) &&
        !spread_all(record, place, grid.places))
        status = imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
    if (status == IMK_OK)
        record->rows = grid.places;
    imki_arena_free(&scratch);
    return status;
}

imk_status imki_keep_grid(double rate, imk_even_record *record, imk_findings *findings,
                          imk_error *error)
{
    const double *time = time_of(record);
    size_t first_not_finite = 0;
    imk_status status = time ? imki_grid_jitter(record, findings, error) : IMK_OK;
    if (status != IMK_OK)
        return status;
    record->not_finite = count_not_finite(record, time, &first_not_finite);
    record->rows = record->log.rows;
    if (time)
        status = place_all(rate, time, record, findings, error);
    if (status != IMK_OK)
        return status;
    const int temperature = imk_log_find(&record->log, IMK_QUANTITY_TEMPERATURE, -1);
    record->temperature = temperature >= 0 ? record->log.data[temperature] : NULL;
    imki_grid_tell(record, first_not_finite, findings);
    return IMK_OK;
}
