/* SPDX-License-Identifier: Apache-2.0 */
/* Runs an instrument into a record, and its internal signals into another. Row k of a record is at
 * the time (k + 1)/rate: the end of the sample whose mean it is. */
#include "physics_log_internal.h"

#include "base/refuse_internal.h"
#include "jobs/arena_internal.h"
#include "jobs/job_internal.h"
#include "jobs/record/record_check_internal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const uint32_t settings_cookie = 0x50485931; /* "PHY1" */

enum { BLOCK_ROWS = 1024, COLUMNS_MAX = IMK_INSTRUMENT_SIGNALS_MAX + 2 };

imk_physics_log_settings imk_physics_log_default(void)
{
    imk_physics_log_settings settings = {.cookie = settings_cookie,
                                         .physics = imk_physics_default(),
                                         .quick = true,
                                         .input.exposure = imk_exposure_default()};
    settings.physics.rate = 100;
    settings.input.exposure.temperature = 293.15;
    return settings;
}

imk_status imki_physics_check(const void *result, const imk_physics_log_settings *settings,
                              imk_error *error)
{
    const imk_status status =
        imki_check_call(result, settings, settings_cookie, "imk_physics_log_default()", error);
    if (status != IMK_OK)
        return status;
    if (!settings->instrument || !settings->design)
        return imk_error_set(error, IMK_ERROR_ARGUMENT,
                             settings->instrument ? "design" : "instrument", NULL,
                             "an instrument, and a design of it");
    const imk_status good = imk_design_check(settings->instrument, settings->design, error);
    return good == IMK_OK ? imk_physics_input_check(settings, error) : good;
}

double imki_physics_turning(const imk_physics_input *input)
{
    const double *rate = input->exposure.angular_rate;
    return fabs(rate[0]) + fabs(rate[1]) + fabs(rate[2]);
}

uint64_t imk_physics_rows(const imk_physics_log_settings *settings, double rate)
{
    return (uint64_t)floor(settings->duration * rate + 0.5);
}

void imk_physics_log_free(imk_physics_log *result)
{
    if (result)
        imki_resize(&result->allocator, result, 0);
}

/* ---- records --------------------------------------------------------------------------------- */

typedef struct sheet {
    const imk_record_sink *sink; /* NULL: not written */
    size_t columns;
    imk_log_column column[COLUMNS_MAX];
    double *data[COLUMNS_MAX]; /* BLOCK_ROWS each */
    size_t rows;               /* waiting */
    bool temperature;
} sheet;

static void add_column(sheet *s, const char *name, imk_quantity quantity, int axis,
                       const char *unit)
{
    imk_log_column *column = &s->column[s->columns++];
    *column = (imk_log_column){.quantity = quantity, .axis = axis, .unit = imk_unit_of(unit)};
    snprintf(column->name, sizeof column->name, "%s", name);
}

static void describe_outputs(const imk_physics_log_settings *settings, sheet *s)
{
    const imk_instrument *instrument = settings->instrument;
    const bool gyro = instrument->sensor == IMK_GYRO;
    add_column(s, "time", IMK_QUANTITY_TIME, -1, "s");
    add_column(s, gyro ? "gyro_x" : "accel_x",
               gyro ? IMK_QUANTITY_ANGULAR_RATE : IMK_QUANTITY_SPECIFIC_FORCE, 0,
               gyro ? "deg/s" : "m/s^2");
    bool told = false; /* by the instrument itself */
    for (size_t i = 1; i < instrument->output_count; i++) {
        add_column(s, instrument->outputs[i].name, IMK_QUANTITY_OTHER, -1,
                   instrument->outputs[i].unit);
        told = told || strcmp(instrument->outputs[i].name, "temperature") == 0;
    }
    s->temperature = settings->input.temperature_rate != 0 && !told;
    if (s->temperature)
        add_column(s, "temperature", IMK_QUANTITY_TEMPERATURE, -1, "degC");
}

static void describe_signals(const imk_instrument *instrument, sheet *s)
{
    add_column(s, "time", IMK_QUANTITY_TIME, -1, "s");
    for (size_t i = 0; i < instrument->signal_count; i++)
        add_column(s, instrument->signals[i].name, IMK_QUANTITY_OTHER, -1,
                   instrument->signals[i].unit);
}

static imk_status begin_sheet(imk_physics_log *log, sheet *s, uint64_t rows, imki_arena *arena,
                              imk_error *error)
{
    int decimals[COLUMNS_MAX];
    if (!s->sink)
        return IMK_OK;
    for (size_t c = 0; c < s->columns; c++) {
        decimals[c] = -1;
        s->data[c] = imki_arena_room(arena, BLOCK_ROWS * sizeof *s->data[c]);
    }
    if (arena->failed)
        return imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
    return imki_written(&log->findings, s->sink->begin(s->sink->context, s->columns, s->column,
                                                       decimals, rows, error));
}

static imk_status flush(imk_physics_log *log, sheet *s, imk_error *error)
{
    const size_t rows = s->rows;
    s->rows = 0;
    return rows > 0 && s->sink
               ? imki_written(&log->findings,
                              s->sink->write(s->sink->context, rows, (const double *const *)s->data,
                                             NULL, error))
               : IMK_OK;
}

static imk_status put_row(imk_physics_log *log, sheet *s, double time, const double *values,
                          size_t count, double temperature, imk_error *error)
{
    if (!s->sink)
        return IMK_OK;
    s->data[0][s->rows] = time;
    for (size_t i = 0; i < count; i++)
        s->data[1 + i][s->rows] = values[i];
    if (s->temperature)
        s->data[1 + count][s->rows] = temperature;
    return ++s->rows == BLOCK_ROWS ? flush(log, s, error) : IMK_OK;
}

/* ---- the run --------------------------------------------------------------------------------- */

/* A group of samples, one point of the picture. */
typedef struct point {
    double sum[IMK_INSTRUMENT_OUTPUTS_MAX], input, time;
    double least[IMK_INSTRUMENT_OUTPUTS_MAX], greatest[IMK_INSTRUMENT_OUTPUTS_MAX];
    uint64_t count;
} point;

static void add_to_picture(imk_physics_log *log, point *at, double time, const double *outputs,
                           size_t count, double input)
{
    at->time += time;
    at->input += input;
    for (size_t i = 0; i < count; i++) {
        at->sum[i] += outputs[i];
        at->least[i] = at->count == 0 ? outputs[i] : fmin(at->least[i], outputs[i]);
        at->greatest[i] = at->count == 0 ? outputs[i] : fmax(at->greatest[i], outputs[i]);
    }
    if (++at->count < log->stride || log->points > IMK_PHYSICS_CURVE_POINTS)
        return;
    log->time[log->points] = at->time / (double)at->count;
    log->input[log->points] = at->input / (double)at->count;
    for (size_t i = 0; i < count; i++) {
        log->curve[i][log->points] = at->sum[i] / (double)at->count;
        log->least[i][log->points] = at->least[i];
        log->greatest[i][log->points] = at->greatest[i];
    }
    log->points++;
    *at = (point){.count = 0};
}

imk_unit imk_physics_output_unit(const imk_physics_log *log, size_t output)
{
    const imk_unit unit = imk_unit_of(log->settings.instrument->outputs[output].unit);
    const double size = fmax(fabs(log->mean[output]), log->deviation[output]);
    return output == 0 && size > 0 ? imk_unit_readable(unit.dimension, size) : unit;
}

/* Welford's running mean and sum of squares. */
static void add_to_statistics(imk_physics_log *log, uint64_t index, const double *outputs,
                              size_t count)
{
    const uint64_t tail = log->samples - log->samples / 100 - 1;
    for (size_t i = 0; i < count; i++) {
        const double step = outputs[i] - log->mean[i];
        log->mean[i] += step / (double)(index + 1);
        log->deviation[i] += step * (outputs[i] - log->mean[i]);
        if (index >= tail)
            log->last[i] += outputs[i] / (double)(log->samples - tail);
    }
}

/* No figure is shown that is none: the first that is not finite ends the run.
 * @param value  of each signal, in SI; or a figure made of them */
static imk_status check_finite(imk_physics_log *log, size_t count, const double *value,
                               const imk_signal *signals, const char *code, double time,
                               imk_error *error)
{
    char names[sizeof log->findings.item[0].name];
    for (size_t i = 0; i < count; i++) {
        if (isfinite(value[i]))
            continue;
        snprintf(names, sizeof names, "%s\t%s", signals[i].name, log->settings.instrument->name);
        return imki_fail(&log->findings, error, IMK_ERROR_NOT_FINITE, code, names,
                         IMKI_NUMBERS(time));
    }
    return IMK_OK;
}

/* Statistics, and the picture in the units that fit them. */
static imk_status finish(imk_physics_log *log, imk_error *error)
{
    const imk_instrument *instrument = log->settings.instrument;
    for (size_t i = 0; i < instrument->output_count; i++) {
        const double sizes[] = {log->mean[i], log->deviation[i], log->last[i]};
        for (size_t k = 0; k < sizeof sizes / sizeof sizes[0]; k++) {
            const imk_status status = check_finite(log, 1, &sizes[k], &instrument->outputs[i],
                                                   "statistics_not_finite", 0, error);
            if (status != IMK_OK)
                return status;
        }
        log->deviation[i] =
            log->samples > 1 ? sqrt(log->deviation[i] / (double)(log->samples - 1)) : (double)NAN;
        const imk_unit unit = imk_physics_output_unit(log, i);
        for (size_t k = 0; k < log->points; k++) {
            log->curve[i][k] = (log->curve[i][k] - unit.offset) / unit.scale;
            log->least[i][k] = (log->least[i][k] - unit.offset) / unit.scale;
            log->greatest[i][k] = (log->greatest[i][k] - unit.offset) / unit.scale;
            if (i == 0)
                log->input[k] /= unit.scale;
        }
    }
    return IMK_OK;
}

/* What a pass through the samples is for: statistics of the outputs, sheets, or both. */
typedef struct work {
    imk_physics_log *log;
    double rate;
    bool counts; /* for the statistics */
    sheet *outputs, *signals;
    const char *stage;
    point at;
} work;

static imk_status take_sample(work *w, void *state, uint64_t k, imk_error *error)
{
    imk_physics_log *log = w->log;
    const imk_instrument *instrument = log->settings.instrument;
    double values[IMK_INSTRUMENT_OUTPUTS_MAX], inside[IMK_INSTRUMENT_SIGNALS_MAX];
    const imk_exposure e = imk_physics_input_at(&log->settings.input, w->rate, k);
    const double time = (double)(k + 1) / w->rate;
    instrument->step(state, &e, values);
    imk_status status = check_finite(log, instrument->output_count, values, instrument->outputs,
                                     "output_not_finite", time, error);
    if (w->outputs && status == IMK_OK)
        status =
            put_row(log, w->outputs, time, values, instrument->output_count, e.temperature, error);
    if (w->signals && status == IMK_OK) {
        instrument->observe(state, inside);
        status = check_finite(log, instrument->signal_count, inside, instrument->signals,
                              "output_not_finite", time, error);
        if (status == IMK_OK)
            status = put_row(log, w->signals, time, inside, instrument->signal_count, 0, error);
    }
    if (w->counts && status == IMK_OK) {
        add_to_statistics(log, k, values, instrument->output_count);
        add_to_picture(log, &w->at, time, values, instrument->output_count,
                       instrument->sensor == IMK_GYRO ? e.angular_rate[0] : e.specific_force[0]);
    }
    return status;
}

/* What happened inside, that the outputs do not say. */
static void tell_event(imk_physics_log *log, const void *state)
{
    const imk_instrument *instrument = log->settings.instrument;
    imk_instrument_event event;
    if (instrument->happened && instrument->happened(state, &event))
        imki_find(&log->findings, IMK_FINDING_WARNING, event.code, event.name, event.count,
                  event.number);
}

static imk_status pass(work *w, const imk_job *job, imki_arena *arena, imk_error *error)
{
    const imk_instrument *instrument = w->log->settings.instrument;
    const uint64_t samples = imk_physics_rows(&w->log->settings, w->rate);
    imk_physics_settings settings = w->log->settings.physics;
    settings.rate = w->rate;
    settings.duration = w->log->settings.duration;
    settings.turning = imki_physics_turning(&w->log->settings.input);
    settings.steps_max =
        fmin(IMK_PHYSICS_STEPS * fmax(1.0, settings.duration), IMK_PHYSICS_STEPS_MAX);
    const size_t size = instrument->state_size;
    void *state = imki_arena_take(arena, size > 256 ? size : 256); /* a cache line begins there */
    if (!state)
        return imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
    imk_status status =
        imk_instrument_init(instrument, w->log->settings.design, &settings, state, error);
    for (uint64_t k = 0; k < samples && status == IMK_OK; k++) {
        status = take_sample(w, state, k, error);
        if (status == IMK_OK)
            status = imki_job_progress(job, w->stage, "samples", k + 1, samples, error);
    }
    if (w->counts && status == IMK_OK)
        tell_event(w->log, state);
    if (status == IMK_OK && w->outputs)
        status = flush(w->log, w->outputs, error);
    return status == IMK_OK && w->signals ? flush(w->log, w->signals, error) : status;
}

/* The signals have a run of their own when their rate is another. */
static imk_status run(imk_physics_log *log, sheet *outputs, sheet *signals, const imk_job *job,
                      imki_arena *arena, imk_error *error)
{
    const imk_physics_log_settings *s = &log->settings;
    const double rate = s->physics.rate, signal_rate = s->signal_rate > 0 ? s->signal_rate : rate;
    const bool apart = signals->sink && signal_rate != rate;
    work first = {log,       rate,        true, outputs, signals->sink && !apart ? signals : NULL,
                  "running", {.count = 0}};
    work second = {log, signal_rate, false, NULL, signals, "signals", {.count = 0}};
    imk_status status = begin_sheet(log, outputs, imk_physics_rows(s, rate), arena, error);
    if (status == IMK_OK)
        status = begin_sheet(log, signals, imk_physics_rows(s, signal_rate), arena, error);
    if (status == IMK_OK)
        status = pass(&first, job, arena, error);
    if (status == IMK_OK && apart)
        status = pass(&second, job, arena, error);
    if (status == IMK_OK)
        status = finish(log, error);
    if (status == IMK_OK)
        imki_physics_warn(log);
    return status;
}

static imk_physics_log *create(const imk_physics_log_settings *settings,
                               const imk_allocator *allocator)
{
    const size_t outputs = settings->instrument->output_count, size = IMK_PHYSICS_CURVE_POINTS + 1;
    imk_physics_log *log =
        imki_resize(allocator, NULL, sizeof *log + (3 * outputs + 2) * size * sizeof(double));
    if (!log)
        return NULL;
    memset(log, 0, sizeof *log);
    log->settings = *settings;
    log->allocator = *allocator;
    log->samples = imk_physics_rows(settings, settings->physics.rate);
    log->stride = log->samples / IMK_PHYSICS_CURVE_POINTS + 1;
    log->time = (double *)(log + 1);
    log->input = log->time + size;
    for (size_t i = 0; i < outputs; i++) {
        log->curve[i] = log->input + (1 + 3 * i) * size;
        log->least[i] = log->curve[i] + size;
        log->greatest[i] = log->least[i] + size;
    }
    imk_instrument_reduce(settings->instrument, settings->design, &log->model);
    return log;
}

/* A sample fits, and a clock counts them. */
static imk_status check_length(const imk_physics_log_settings *s, imk_error *error)
{
    const double samples = s->duration * s->physics.rate;
    if (samples >= 0.5 && samples < 1e18)
        return IMK_OK;
    return imki_refuse(error, IMK_ERROR_RANGE, "duration", s->duration, 1 / s->physics.rate,
                       "at least one sample");
}

imk_status imk_physics_log_run(const imk_physics_log_settings *settings,
                               const imk_record_sink *outputs, const imk_record_sink *signals,
                               const imk_job *job, imk_physics_log **result, imk_error *error)
{
    imk_status status = imki_physics_check(result, settings, error);
    if (!result)
        return status;
    *result = NULL;
    job = imki_job_of(job);
    if (status == IMK_OK && outputs)
        status = imki_check_sink(outputs, error);
    if (status == IMK_OK && signals)
        status = imki_check_sink(signals, error);
    if (status == IMK_OK)
        status = check_length(settings, error);
    if (status != IMK_OK)
        return status;
    imki_arena arena = {.allocator = job->allocator};
    imk_physics_log *log = create(settings, &job->allocator);
    sheet *sheets = imki_arena_take(&arena, 2 * sizeof *sheets);
    status = imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
    *result = log;
    if (log && sheets) {
        sheets[0].sink = outputs;
        sheets[1].sink = signals;
        describe_outputs(settings, &sheets[0]);
        describe_signals(settings->instrument, &sheets[1]);
        status = run(log, &sheets[0], &sheets[1], job, &arena, error);
    }
    imki_arena_free(&arena);
    return status;
}
