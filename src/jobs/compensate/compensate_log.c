/* SPDX-License-Identifier: Apache-2.0 */
/* Blocks of rows: read, correct, write. With lever arms the compensator is one sample late; the
 * last row of a block then waits, its copied columns included, for the next one. Rows are in the
 * buffers of the record's columns; a corrected value stands in the place of the reading it came
 * from. */
#include "compensate_internal.h"

#include "base/refuse_internal.h"
#include "jobs/arena_internal.h"
#include "jobs/job_internal.h"
#include "jobs/record/even_record_internal.h"
#include "jobs/record/record_check_internal.h"

#include "imukit/random.h"
#include "imukit/samples.h"

#include <math.h>

static const uint32_t settings_cookie = 0x434F4D31; /* "COM1" */

imk_compensate_log_settings imk_compensate_log_default(void)
{
    return (imk_compensate_log_settings){
        .cookie = settings_cookie, .temperature = (double)NAN, .temperature_time = 30};
}

void imk_compensate_log_free(imk_compensate_log *result)
{
    if (result)
        imki_resize(&result->allocator, result, 0);
}

/* Long enough that the first block tells the sample interval (4096 steps) and to share the writing
 * among threads. */
enum { BLOCK_ROWS = 65536 };

typedef struct stream {
    const imk_record_source *source;
    const imk_record_sink *sink;
    const imk_model *whole;
    imk_compensate_log *log;
    imki_compensate_columns columns;
    imki_magnetic magnetic;
    double *data[IMK_LOG_COLUMNS_MAX];  /* BLOCK_ROWS + 1 rows each */
    double *corrected[2][IMK_AXES_MAX]; /* likewise */
    double *flag_column, *temperature, *workspace;
    unsigned char *flags;
    size_t waiting; /* rows at the head of the buffers that were read before: 0 or 1 */
    double first_time, last_time;
} stream;

static stream *allocate(const imk_record_source *source, imki_arena *arena)
{
    const size_t rows = BLOCK_ROWS + 1, size = rows * sizeof(double);
    stream *s = imki_arena_take(arena, sizeof *s);
    if (!s)
        return NULL;
    for (size_t k = 0; k < source->column_count; k++)
        s->data[k] = imki_arena_room(arena, size);
    for (int sensor = 0; sensor < 2; sensor++)
        for (int i = 0; i < IMK_AXES_MAX; i++)
            s->corrected[sensor][i] = imki_arena_room(arena, size);
    s->flag_column = imki_arena_room(arena, size);
    s->temperature = imki_arena_take(arena, size);
    s->workspace = imki_arena_room(arena, imk_compensate_workspace_size(BLOCK_ROWS));
    s->flags = imki_arena_room(arena, rows);
    s->first_time = s->last_time = (double)NAN;
    return arena->failed ? NULL : s;
}

/* ---- before the first row ---- */

/* What can be said before rows are read. */
static imk_status check_model(stream *s, imk_error *error)
{
    imk_compensate_log *log = s->log;
    const int column = s->columns.temperature;
    char term[64];
    if (imki_temperature_term(&log->model, term, sizeof term) && isnan(log->settings.temperature)) {
        if (column < 0)
            return imki_fail(&log->findings, error, IMK_ERROR_COLUMN, "no_temperature", term, 0,
                             NULL);
        if (imk_dimension_equal(s->source->columns[column].unit.dimension,
                                imk_unit_of("count").dimension))
            return imki_fail(&log->findings, error, IMK_ERROR_DIMENSION, "temperature_counts", term,
                             0, NULL);
    }
    (void)imki_find_temperature(&log->findings, log->settings.temperature);
    if (log->model.residual_of[0])
        imki_find(&log->findings, IMK_FINDING_WARNING, "residual", log->model.residual_of, 0, NULL);
    if (log->taken_out.count == 0)
        imki_find(&log->findings, IMK_FINDING_WARNING, "nothing",
                  log->settings.terms ? " of those selected" : "", 0, NULL);
    return IMK_OK;
}

static imk_status begin_sink(stream *s, imk_error *error)
{
    const imki_compensate_columns *columns = &s->columns;
    int decimals[IMK_LOG_COLUMNS_MAX];
    for (size_t k = 0; k < columns->count; k++)
        decimals[k] = columns->content[k].source < 0 && columns->content[k].sensor == 2 ? 0 : -1;
    const imk_status status =
        s->sink->begin(s->sink->context, columns->count, columns->column, decimals, 0, error);
    if (status == IMK_OK && s->sink->labels)
        s->sink->labels(s->sink->context, s->source);
    return imki_written(&s->log->findings, status);
}

/* The sample interval is known when the first block has been read, of so many rows. */
static imk_status start(stream *s, size_t rows, imk_error *error)
{
    imk_compensate_log *log = s->log;
    imk_error why;
    imk_correction_settings settings = imk_correction_default();
    settings.rate_limit = log->settings.rate_limit;
    settings.force_limit = log->settings.force_limit;
    settings.kernel = imk_random_seeded(0).kernel; /* the fastest there is */
    imk_log_findings found;
    imk_status status =
        imki_source_findings(s->source, rows, s->data, &log->allocator, &found, error);
    if (status != IMK_OK)
        return status;
    /* A single row has no interval, and no use for it. */
    const double interval = found.interval > 0 ? found.interval : 1;
    status = imk_compensator_start(&log->compensator, &log->model, interval, &settings, &why);
    if (status == IMK_ERROR_KEY_MISSING)
        imki_find(&log->findings, IMK_FINDING_FAILURE, "no_limit", why.field, 0, NULL);
    else if (status != IMK_OK && status != IMK_ERROR_RANGE)
        imki_find(&log->findings, IMK_FINDING_FAILURE, "model_refused", NULL, IMKI_NUMBERS(status));
    if (status != IMK_OK) {
        if (error)
            *error = why;
        return status;
    }
    log->compensator.temperature_time = log->settings.temperature_time;
    imk_compensator_resume(&log->compensator, log->settings.powered_for);
    status = imki_compensate_describe(s->source, log, &s->columns, error);
    return status == IMK_OK ? begin_sink(s, error) : status;
}

/* ---- rows ---- */

/* Does time go on evenly from the row before? */
static bool is_break(const stream *s, double time)
{
    const double step = time - s->last_time;
    return step <= 0 || imk_step_intervals(step, s->log->compensator.dt) > 1;
}

/* Rows `from` to `to` of the buffers, a piece without a break, into the compensator.
 * @return outputs, behind the `done` there are already */
static size_t correct_piece(stream *s, size_t from, size_t to, size_t done)
{
    imk_compensator *c = &s->log->compensator;
    imk_readings readings = {.temperature = s->temperature + from};
    double *out[2][IMK_AXES_MAX];
    for (int sensor = 0; sensor < 2; sensor++)
        for (int i = 0; i < IMK_AXES_MAX; i++) {
            if (i < c->correction.distortion.axis_count[sensor])
                readings.channel[sensor][i] = s->data[s->columns.axis[sensor][i]] + from;
            out[sensor][i] = s->corrected[sensor][i] + done;
        }
    return imk_compensator_block(c, &readings, to - from, out, s->flags + done, s->workspace,
                                 imk_compensate_workspace_size(BLOCK_ROWS));
}

/* The sample the compensator still holds. @return 1, or 0 when there is none */
static size_t flush(stream *s, size_t done)
{
    imk_compensator *c = &s->log->compensator;
    imk_compensator_sample sample;
    if (!imk_compensator_finish(c, &sample))
        return 0;
    for (int i = 0; i < imk_compensator_components(c, IMK_GYRO); i++)
        s->corrected[IMK_GYRO][i][done] = sample.rate[i];
    for (int i = 0; i < imk_compensator_components(c, IMK_ACCEL); i++)
        s->corrected[IMK_ACCEL][i][done] = sample.force[i];
    s->flags[done] = (unsigned char)sample.flags;
    return 1;
}

static void fill_temperature(stream *s, size_t rows)
{
    imk_compensate_log *log = s->log;
    const double given = log->settings.temperature;
    for (size_t r = s->waiting; r < rows && log->compensator.needs_temperature; r++) {
        s->temperature[r] = isnan(given) ? s->data[s->columns.temperature][r] : given;
        log->counts.temperatures_held += !(fabs(s->temperature[r]) < (double)INFINITY);
    }
}

/* New rows, from s->waiting on. @return rows that are ready to be written */
static size_t correct_rows(stream *s, size_t rows)
{
    imk_compensate_log *log = s->log;
    imk_compensate_counts *counts = &log->counts;
    const double *time = s->columns.time >= 0 ? s->data[s->columns.time] : NULL;
    size_t done = 0, from = s->waiting;
    fill_temperature(s, rows);
    for (size_t r = s->waiting; time && r < rows; r++) {
        if (!isfinite(time[r])) {
            if (counts->times_missing++ == 0)
                counts->first_time_missing = counts->rows + (r - s->waiting) + 1;
            s->last_time += log->compensator.dt;
            continue;
        }
        if (isnan(s->first_time))
            s->first_time = time[r];
        if (is_break(s, time[r])) {
            done += correct_piece(s, from, r, done);
            done += flush(s, done);
            imk_compensator_resume(&log->compensator,
                                   log->settings.powered_for + (time[r] - s->first_time));
            if (counts->stretches++ == 1)
                counts->first_gap = counts->rows + (r - s->waiting) + 1;
            from = r;
        }
        s->last_time = time[r];
    }
    done += correct_piece(s, from, rows, done);
    counts->rows += rows - s->waiting;
    return done;
}

/* @param first_row  of the record, counted from 1, at the head of the buffers */
static imk_status write_rows(stream *s, size_t count, uint64_t first_row, const imk_job *job,
                             imk_error *error)
{
    const imki_compensate_columns *columns = &s->columns;
    imk_compensate_counts *counts = &s->log->counts;
    const double *written[IMK_LOG_COLUMNS_MAX];
    for (size_t r = 0; r < count; r++) {
        const unsigned flags = s->flags[r];
        s->flag_column[r] = flags;
        counts->any_flag += flags != 0;
        for (int i = 0; flags && i < IMK_FLAG_COUNT; i++)
            if ((flags & (1U << i)) && counts->flagged[i]++ == 0)
                counts->first_flagged[i] = first_row + r;
    }
    for (size_t k = 0; k < columns->count; k++) {
        const int source = columns->content[k].source, sensor = columns->content[k].sensor;
        written[k] = source >= 0   ? s->data[source]
                     : sensor == 2 ? s->flag_column
                                   : s->corrected[sensor][columns->content[k].component];
    }
    return imki_written(&s->log->findings,
                        s->sink->write(s->sink->context, count, written, job->executor, error));
}

/* The next block. @param got  rows read; 0 at the end */
static imk_status next_block(stream *s, bool first, size_t *got, const imk_job *job,
                             imk_error *error)
{
    const imk_record_source *source = s->source;
    const uint64_t first_row = s->log->counts.rows - s->waiting + 1;
    double *place[IMK_LOG_COLUMNS_MAX];
    uint64_t at = 0, size = 0;
    for (size_t k = 0; k < source->column_count; k++)
        place[k] = s->data[k] + s->waiting;
    imk_status status = source->read(source->context, BLOCK_ROWS, place, got, error);
    if (status == IMK_OK && first)
        status = start(s, *got, error);
    if (status != IMK_OK)
        return status;
    imki_magnetic_correct(&s->magnetic, s->waiting, s->waiting + *got, s->data);
    const size_t rows = s->waiting + *got, ready = *got > 0 ? correct_rows(s, rows) : flush(s, 0);
    status = write_rows(s, ready, first_row, job, error);
    s->waiting = rows - ready;
    for (size_t k = 0; k < source->column_count && s->waiting > 0; k++)
        s->data[k][0] = s->data[k][ready];
    if (source->progress)
        source->progress(source->context, &at, &size);
    return status == IMK_OK ? imki_job_progress(job, "compensating", "B", at, size, error) : status;
}

/* Warn of samples that are not what they should be. */
static void warn(imk_compensate_log *log)
{
    static const char *const flags[IMK_FLAG_COUNT] = {
        "compensate:saturated", "compensate:temperature", "compensate:limit",
        "compensate:not_finite", "compensate:acceleration"};
    const imk_compensate_counts *c = &log->counts;
    const double rows = (double)c->rows;
    for (int i = 0; i < IMK_FLAG_COUNT; i++)
        if (c->flagged[i] > 0)
            imki_find(&log->findings, IMK_FINDING_WARNING, flags[i], NULL,
                      IMKI_NUMBERS((double)c->flagged[i], rows, (double)c->first_flagged[i]));
    if (c->temperatures_held > 0)
        imki_find(&log->findings, IMK_FINDING_WARNING, "temperature_held", NULL,
                  IMKI_NUMBERS((double)c->temperatures_held, rows));
    if (c->times_missing > 0)
        imki_find(&log->findings, IMK_FINDING_WARNING, "time_missing", NULL,
                  IMKI_NUMBERS((double)c->times_missing, rows, (double)c->first_time_missing));
    if (c->stretches > 1)
        imki_find(&log->findings, IMK_FINDING_WARNING, "compensate:gaps", NULL,
                  IMKI_NUMBERS((double)(c->stretches - 1), (double)c->first_gap));
}

static imk_status compensate(stream *s, const imk_job *job, imk_error *error)
{
    imk_compensate_log *log = s->log;
    size_t got = 1;
    imki_magnetic_start(s->source, log, &s->magnetic);
    imk_status status = imki_compensate_match(s->source, log, &s->columns, error);
    if (status != IMK_OK)
        return status;
    log->taken_out = imki_taken_out(&log->model);
    log->left_in = imki_left_in(&log->model, s->whole);
    imki_tell_unused(s->source->column_count, s->source->columns, IMK_KINDS, &log->findings);
    imki_tell_not_turned(s->source, s->source->column_count, s->source->columns, &log->findings);
    status = check_model(s, error);
    for (bool first = true; status == IMK_OK && got > 0; first = false)
        status = next_block(s, first, &got, job, error);
    if (status == IMK_OK && log->counts.rows == 0)
        return imki_fail(&log->findings, error, IMK_ERROR_EMPTY, "no_rows", NULL, 0, NULL);
    if (status == IMK_OK) {
        imki_tell_damage(s->source, &log->findings);
        warn(log);
    }
    return status;
}

static imk_status check_handed(const imk_record_source *source, const imk_model *model,
                               const imk_compensate_log_settings *s, const imk_record_sink *sink,
                               imk_error *error)
{
    imk_status status = imki_check_source(source, error);
    if (status == IMK_OK)
        status = imki_check_sink(sink, error);
    if (status == IMK_OK)
        status = imki_check_model(model, error);
    if (status == IMK_OK && s->terms)
        status = imki_check_model(s->terms, error);
    if (status == IMK_OK && s->temperature < 0)
        status =
            imki_refuse(error, IMK_ERROR_RANGE, "temperature", s->temperature, 0, "at least 0 K");
    if (status == IMK_OK && !(s->temperature_time > 0))
        status = imki_refuse(error, IMK_ERROR_RANGE, "temperature_time", s->temperature_time, 0,
                             "a positive time");
    if (status == IMK_OK && !(s->powered_for >= 0))
        status = imki_refuse(error, IMK_ERROR_RANGE, "powered_for", s->powered_for, 0,
                             "a time that is not negative");
    if (status == IMK_OK)
        status = imki_check_unit(&s->gyro_unit, imk_unit_of("rad/s").dimension, "gyro_unit", error);
    if (status == IMK_OK)
        status =
            imki_check_unit(&s->accel_unit, imk_unit_of("m/s^2").dimension, "accel_unit", error);
    return status;
}

imk_status imk_compensate_log_run(const imk_record_source *source, const imk_model *model,
                                  const imk_compensate_log_settings *settings,
                                  const imk_record_sink *sink, const imk_job *job,
                                  imk_compensate_log **result, imk_error *error)
{
    imk_status status =
        imki_check_call(result, settings, settings_cookie, "imk_compensate_log_default()", error);
    if (!result)
        return status;
    *result = NULL;
    job = imki_job_of(job);
    if (status == IMK_OK)
        status = check_handed(source, model, settings, sink, error);
    imk_compensate_log *log = imki_result_new(job, sizeof *log, &status, error);
    if (!log)
        return status;
    log->settings = *settings;
    log->model = settings->terms ? *settings->terms : *model;
    log->counts.stretches = 1;
    log->allocator = job->allocator;
    *result = log;
    imk_compensation_model(model, &log->model);
    imki_arena arena = {.allocator = job->allocator};
    stream *s = allocate(source, &arena);
    status = IMK_ERROR_MEMORY;
    if (s) {
        s->source = source;
        s->sink = sink;
        s->whole = model;
        s->log = log;
        status = compensate(s, job, error);
    } else {
        imk_error_set(error, status, NULL, NULL, NULL);
    }
    imki_arena_free(&arena);
    return status;
}
