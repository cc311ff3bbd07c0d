/* SPDX-License-Identifier: Apache-2.0 */
/* Times of evenly spaced samples for rows whose stamps are none.
 *
 * Stamps that fit an even grid are left alone. For the others there are up to three readings, by
 * the interval (stamp_interval.c); each places the rows in their order (stamp_places.c). The one
 * that leaves least unexplained holds: steps back of the clock count fully, lost rows a fifth, rows
 * that are late a tenth, because rows are lost and late; a drift of the envelope fully. Its
 * interval is corrected by what the lower envelope drifts. */
#include "even_record_internal.h"
#include "record_stamps_internal.h"
#include "record_times_internal.h"

#include "jobs/arena_internal.h"
#include "jobs/job_internal.h"

#include <math.h>
#include <string.h>

/* Rows that do not fit a grid: up to this share are left out or placed as they are. */
static const double few_rows = 1e-3;
/* Steps back beyond this share of the rows: the stamps are no times. */
static const double few_jumps = 4, steps_back_most = 0.005;
static const double loss_weight = 0.2, delay_weight = 0.1;
/* A reading is preferred to one before it where it explains this many rows more. */
enum { BETTER_BY = 3, WINDOW = 256, GROUPS_IN_WINDOW = 4, REFINEMENTS = 4 };

/* Share of rows beyond which those left out are a fault of the record. */
static const double rows_lost_told = 0.01;

/* Delays [intervals] beyond that of coarse stamps that are told. */
static const double late_told = 2.0;

/* Mean and median of the steps: gaps are counted by the median. */
static const double mean_differs = 2e-3, errors_beyond = 6;

static bool is_median_off(const imk_log_findings *f)
{
    const double error = f->jitter / f->interval / sqrt((double)f->rows);
    const double off = fabs(f->mean_step / f->interval - 1);
    return off > fmax(mean_differs, errors_beyond * error);
}

/* ---- do the stamps fit a grid? ---- */

/* Clocks that count milliseconds or seconds: steps of one and two of them are rounded times. */
static bool is_natural_tick(double interval)
{
    return fabs(interval - 1e-3) < 1e-9 || fabs(interval - 1.0) < 1e-6;
}

static bool is_rounded(const imk_log_findings *f)
{
    return f->gaps >= 8 && f->steady_gaps >= f->gaps * 7 / 10 && is_natural_tick(f->interval);
}

/* A stated rate so far off is none to count gaps by. */
static const double other_rate = 0.1;

bool imki_stamps_uneven(double rate, const imk_log_findings *f)
{
    const size_t odd = f->uneven + f->repeats + f->reversals;
    if (rate > 0 && (2 * f->gaps > f->rows || fabs(f->mean_step * rate - 1) > other_rate))
        return true;
    return (odd >= 2 && (double)odd > few_rows * (double)f->rows) ||
           f->largest_reversal > 3 * f->interval || f->missing > 2 * f->rows ||
           (f->gaps > 0 && is_median_off(f)) || is_rounded(f);
}

/* ---- the times as they come ---- */

static bool make_room(imki_stamps *s, size_t rows)
{
    if (s->rows + rows <= s->room)
        return true;
    const size_t room = s->rows + rows + s->room / 2;
    double *time = imki_resize(&s->allocator, s->time, (room + 1) * sizeof *time);
    s->time = time ? time : s->time;
    bool *same = imki_resize(&s->allocator, s->same, (room + 1) * sizeof *same);
    s->same = same ? same : s->same;
    s->room = time && same ? room : s->room;
    return time && same;
}

/* Are the values of a row those of the row before? */
static bool repeats_row(imki_stamps *s, size_t row, double *const *columns)
{
    bool same = true;
    for (size_t c = 0; c < s->column_count; c++) {
        if (!columns[c])
            continue;
        same = same && columns[c][row] == s->last[c];
        s->last[c] = columns[c][row];
    }
    return same;
}

bool imki_stamps_add(imki_stamps *s, size_t rows, double *const *columns)
{
    if (!make_room(s, rows))
        return false;
    const double *time = columns[s->time_column];
    for (size_t row = 0; row < rows; row++) {
        const bool stands = s->rows > 0 && time[row] == s->last[s->time_column];
        const bool same = repeats_row(s, row, columns);
        s->repeated += stands;
        s->doubled += stands && same;
        s->same[s->rows] = stands && same;
        s->time[s->rows++] = time[row];
    }
    return true;
}

void imki_stamps_free(imki_stamps *s)
{
    s->time = imki_resize(&s->allocator, s->time, 0);
    s->same = imki_resize(&s->allocator, s->same, 0);
}

/* ---- clocks that begin anew ---- */

/* Periods of counters of 16 and 32 bits in ns, us, 10 us, 0.1 ms, ms, and of the clock [s]. */
static const double wraps[] = {4.294967296, 65.536,   4294.967296, 42949.67296, 429496.7296,
                               4294967.296, 0.065536, 1.0,         60.0,        100.0,
                               3600.0,      43200.0,  86400.0,     604800.0};

/* The period by which a clock that steps back goes on; 0: it does not. */
static double wrap_of(double step, double interval)
{
    for (size_t k = 0; k < sizeof wraps / sizeof wraps[0]; k++)
        if (step + wraps[k] > 0 && step + wraps[k] < 1.5 * interval && wraps[k] > 20 * interval)
            return wraps[k];
    return 0;
}

/* Let clocks that begin anew go on. @return how often they began; `period` of the last */
static size_t unwrap(size_t n, double *time, double interval, double *period)
{
    double added = 0, last = (double)NAN;
    size_t count = 0;
    for (size_t i = 0; i < n; i++) {
        const double now = time[i];
        const double wrap = now < last ? wrap_of(now - last, interval) : 0;
        if (wrap > 0) {
            added += wrap;
            *period = wrap;
            count++;
        }
        if (isfinite(now))
            last = now;
        time[i] = now + added;
    }
    return count;
}

/* ---- the choice ---- */

typedef struct choice {
    imki_stamp_reading reading;
    imki_stamp_intervals intervals;
    size_t doubled, wrapped;
    double wrap;
} choice;

static double unexplained(const imki_stamp_reading *r)
{
    return r->down + loss_weight * r->up + delay_weight * (double)r->late +
           fabs(r->drift) / r->interval * (double)(r->rows + r->lost);
}

static void refine(size_t n, const double *time, imki_stamp_reading *r)
{
    const imki_stamp_reading asked = *r;
    imki_read_stamps(n, time, r, NULL);
    for (int k = 0; k < REFINEMENTS; k++) {
        const double better = r->interval + r->drift;
        if (!(better > 0) || fabs(r->drift) * (double)(n + r->lost) < 0.1 * r->interval)
            break;
        imki_stamp_reading next = asked;
        next.interval = better;
        imki_read_stamps(n, time, &next, NULL);
        if (unexplained(&next) > unexplained(r) + BETTER_BY)
            break;
        *r = next;
    }
}

/* @return false: the stamps suggest no interval */
static bool choose(size_t n, const double *time, double *scratch, choice *c)
{
    c->intervals = imki_stamp_intervals_of(n, time, scratch);
    const imki_stamp_intervals *v = &c->intervals;
    const double most = fmax(WINDOW, GROUPS_IN_WINDOW * v->most_rows_per_stamp);
    const size_t window = (size_t)fmax(1, fmin(most, (double)n / 4));
    const bool dithered = v->rows_per_stamp > 1.2;
    const struct {
        double interval, threshold;
    } tried[] = {{v->steps, 0.6}, {v->long_run, dithered ? 1.25 : 0.75}, {v->groups, 0.6}};
    bool any = false;
    for (size_t k = 0; k < 3; k++) {
        imki_stamp_reading r = {.interval = tried[k].interval,
                                .threshold = tried[k].threshold,
                                .window = window,
                                .usual = v->most_rows_per_stamp + 0.5};
        if (!(r.interval > 0) || !isfinite(r.interval))
            continue;
        refine(n, time, &r);
        if (!any || unexplained(&r) + BETTER_BY < unexplained(&c->reading))
            c->reading = r;
        any = true;
    }
    return any;
}

/* ---- what is told ---- */

static void tell_groups(const choice *c, size_t repeated, size_t rows, imk_findings *findings)
{
    const imki_stamp_reading *r = &c->reading;
    const imki_stamp_intervals *v = &c->intervals;
    const bool coarse = (double)repeated > 0.5 * (1 - 1 / v->rows_per_stamp) * (double)rows;
    const bool even = v->most_rows_per_stamp < v->rows_per_stamp + 1.5;
    const bool harmless = coarse && even && r->lost == 0 && r->jumps == 0;
    if (coarse)
        imki_find(findings, harmless ? IMK_FINDING_NOTE : IMK_FINDING_WARNING,
                  "stamps:coarse_stamps", NULL, IMKI_NUMBERS(v->rows_per_stamp, 1 / r->interval));
    else
        imki_find(findings, IMK_FINDING_WARNING, "stamps:bunched", NULL,
                  IMKI_NUMBERS(v->rows_per_stamp, 1 / r->interval));
}

/* @param jitter  share of the interval */
static void tell(const choice *c, double jitter, const imki_stamps *s, imk_findings *findings)
{
    const imki_stamp_reading *r = &c->reading;
    const imki_stamp_intervals *v = &c->intervals;
    const double rate = 1 / r->interval;
    const bool grouped =
        v->rows_per_stamp > 1.2 && (v->groups > 0 || v->between > 1.2 * r->interval);
    const double expected = grouped ? 1.5 * v->most_rows_per_stamp : 0;
    if (grouped)
        tell_groups(c, s->repeated, s->rows, findings);
    if (!grouped && r->latest <= expected + late_told && 100 * jitter > IMKI_JITTER_TOLD)
        imki_find(findings, IMK_FINDING_WARNING, "jitter", NULL, IMKI_NUMBERS(100 * jitter));
    const bool many = (double)r->late > few_rows * (double)s->rows;
    if (r->late > 0 && r->latest > expected + late_told)
        imki_find(findings, many ? IMK_FINDING_WARNING : IMK_FINDING_NOTE, "stamps:late", NULL,
                  IMKI_NUMBERS((double)r->late, r->latest * r->interval, rate));
    if (r->jumps > 0)
        imki_find(findings, IMK_FINDING_WARNING, "stamps:jumps", NULL,
                  IMKI_NUMBERS((double)r->jumps, r->largest_jump * r->interval, rate));
}

static void tell_before(const choice *c, size_t rows, imk_findings *findings)
{
    if (c->wrapped > 0)
        imki_find(findings, IMK_FINDING_NOTE, "stamps:wrapped", NULL,
                  IMKI_NUMBERS((double)c->wrapped, c->wrap));
    if (c->doubled > 0)
        imki_find(findings, IMK_FINDING_WARNING,
                  (double)c->doubled > rows_lost_told * (double)rows ? "stamps:doubled" : "doubled",
                  NULL, IMKI_NUMBERS((double)c->doubled, (double)rows));
}

/* ---- all together ---- */

/* Close up the rows that are not doubled. @return how many */
static size_t close_up(const imki_stamps *s, bool doubled, double *time)
{
    size_t kept = 0;
    for (size_t row = 0; row < s->rows; row++)
        if (!doubled || !s->same[row])
            time[kept++] = s->time[row];
    return kept;
}

/* Back to all rows: a doubled one has the time of the row before. */
static void spread(imki_stamps *s, bool doubled, const double *even)
{
    size_t kept = 0;
    for (size_t row = 0; row < s->rows; row++) {
        kept += !doubled || !s->same[row];
        s->time[row] = even[kept - 1];
    }
}

static imk_status look_again(size_t n, const double *time, imki_arena *scratch,
                             imk_log_findings *found, imk_error *error)
{
    imki_record_times *times = imki_arena_take(scratch, sizeof *times);
    if (!times)
        return imk_error_set(error, IMK_ERROR_MEMORY, "time", NULL, NULL);
    imki_record_times_start(times, 0);
    imki_record_times_add(times, 1, n, time);
    *found = imki_record_times_findings(times);
    found->rows = n;
    return IMK_OK;
}

/* Times from which no rate follows: the reason. */
static imk_status refuse_times(const imk_log_findings *f, double first, imk_findings *findings,
                               imk_error *error)
{
    const double rows = (double)f->rows, back = (double)f->reversals, same = (double)f->repeats;
    const double even = 0.05; /* scatter of steps that are even [intervals] */
    const char *code = "no_grid";
    double numbers[3] = {100 * f->jitter / f->interval, f->interval};
    if (!(f->interval > 0) && f->reversals == 0) {
        code = "time_constant";
        numbers[0] = first;
    } else if (!(f->interval > 0) || back > rows / 2) {
        code = "time_backwards";
        numbers[0] = back;
        numbers[1] = rows;
    } else if (same > rows / 2 && f->jitter < even * f->interval) {
        code = "time_digits";
        numbers[0] = rows / (rows - same);
    } else if (same > 1 && f->reversals == 0 && f->jitter < even * f->interval) {
        code = "time_stands";
        numbers[0] = same;
    } else if (f->reversals > 0 && f->jitter < even * f->interval) {
        code = "time_order";
        numbers[0] = back;
        numbers[1] = rows;
        numbers[2] = f->largest_reversal;
    }
    return imki_fail(findings, error, IMK_ERROR_TIME_ORDER, code, NULL, 3, numbers);
}

/* The stamps of n rows in `time` become even, where they are not. */
static imk_status settle(imki_stamps *s, size_t n, double *time, choice *c, imki_arena *scratch,
                         imk_log_findings *settled, imk_findings *findings, imk_error *error)
{
    imk_log_findings found = {.rows = 0};
    imk_status status = look_again(n, time, scratch, &found, error);
    if (status != IMK_OK)
        return status;
    if (found.interval > 0 && found.reversals > 0)
        c->wrapped = unwrap(n, time, found.interval, &c->wrap);
    if (c->wrapped > 0)
        status = look_again(n, time, scratch, &found, error);
    if (status != IMK_OK)
        return status;
    tell_before(c, s->rows, findings);
    settled->jitter = found.jitter;
    settled->interval = found.interval;
    settled->doubled = c->doubled;
    imki_tell_steps(&found, findings);
    if (!imki_stamps_uneven(0, &found))
        return IMK_OK;
    double *room = imki_arena_room(scratch, (2 * n + 8192) * sizeof *room);
    if (!room)
        return imk_error_set(error, IMK_ERROR_MEMORY, "time", NULL, NULL);
    const bool chosen = choose(n, time, room, c);
    if (!chosen || (double)c->reading.jumps > fmax(few_jumps, steps_back_most * (double)n))
        return refuse_times(&found, settled->time_origin + time[0], findings, error);
    imki_stamp_reading final = {.interval = c->reading.interval,
                                .threshold = c->reading.threshold,
                                .window = c->reading.window,
                                .usual = c->reading.usual};
    imki_read_stamps(n, time, &final, room);
    memcpy(time, room, n * sizeof *time);
    settled->interval = c->reading.interval;
    settled->jitter = 0;
    if (is_rounded(&found))
        imki_find(findings, IMK_FINDING_NOTE, "stamps:rounded", NULL,
                  IMKI_NUMBERS(found.interval, 1 / settled->interval));
    tell(c, found.jitter / found.interval, s, findings);
    return IMK_OK;
}

/* Of rate 1/interval instead of 1/own. */
static void stretch(size_t n, double *time, double own, double interval)
{
    for (size_t i = 0; i < n; i++)
        time[i] *= interval / own;
}

imk_status imki_stamps_settle(imki_stamps *s, double rate, imk_log_findings *found,
                              imk_findings *findings, imk_error *error)
{
    imki_arena scratch = {.allocator = s->allocator};
    const bool doubled = s->doubled > 0 && 10 * s->doubled >= 9 * s->repeated;
    choice c = {.doubled = doubled ? s->doubled : 0};
    double *time = imki_arena_room(&scratch, (s->rows + 1) * sizeof *time);
    imk_status status = imk_error_set(error, IMK_ERROR_MEMORY, "time", NULL, NULL);
    if (time) {
        const size_t n = close_up(s, doubled, time);
        status = settle(s, n, time, &c, &scratch, found, findings, error);
        if (status == IMK_OK && rate > 0 && found->interval > 0) {
            imki_tell_rate(rate, found->interval, findings);
            stretch(n, time, found->interval, 1 / rate);
            found->jitter *= 1 / (rate * found->interval);
            found->interval = 1 / rate;
        }
        if (status == IMK_OK)
            spread(s, doubled, time);
    }
    imki_arena_free(&scratch);
    return status;
}

/* Take the doubled rows out of all columns. */
static void drop_doubled(const imki_stamps *s, imk_log *log)
{
    size_t kept = 0;
    for (size_t row = 0; row < s->rows; row++) {
        if (s->same[row])
            continue;
        for (size_t c = 0; c < log->column_count && kept != row; c++)
            log->data[c][kept] = log->data[c][row];
        kept++;
    }
    log->rows = kept;
    log->findings.doubled = 0;
}

imk_status imki_settle_times(double rate, imk_log *log, imk_findings *findings, imk_error *error)
{
    const int time = imk_log_find(log, IMK_QUANTITY_TIME, -1);
    if (time < 0 || log->rows < 2)
        return IMK_OK;
    if (!imki_stamps_uneven(rate, &log->findings)) {
        imki_tell_steps(&log->findings, findings);
        imki_tell_rate(rate, log->findings.mean_step, findings);
        return IMK_OK;
    }
    imki_stamps s = {.allocator = log->allocator,
                     .column_count = log->column_count,
                     .time_column = (size_t)time};
    imk_status status = imki_stamps_add(&s, log->rows, log->data)
                            ? IMK_OK
                            : imk_error_set(error, IMK_ERROR_MEMORY, "time", NULL, NULL);
    if (status == IMK_OK)
        status = imki_stamps_settle(&s, rate, &log->findings, findings, error);
    if (status == IMK_OK)
        memcpy(log->data[time], s.time, log->rows * sizeof *s.time);
    if (status == IMK_OK && log->findings.doubled > 0)
        drop_doubled(&s, log);
    imki_stamps_free(&s);
    return status;
}
