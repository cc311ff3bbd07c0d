/* SPDX-License-Identifier: Apache-2.0 */
/* Runs an instrument into a log, and its internal signals into another. Row k of a log is at the
 * time (k + 1)/rate: the end of the sample whose mean it is. */
#include "physics_parts.h"
#include "shell/progress.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { BLOCK_ROWS = 1024, COLUMNS_MAX = IMK_INSTRUMENT_SIGNALS_MAX + 2 };

int physics_refused(const physics *p, imk_error *error)
{
    const bool is_file = strcmp(p->source, p->file.instrument->name) != 0;
    const bool is_step = strcmp(error->field, "step") == 0;
    const bool is_rate = strcmp(error->field, "rate") == 0;
    imk_design_error_in_units(p->file.instrument, p->file.design, error);
    if ((is_step || is_rate) && !error->found[0] && error->status == IMK_ERROR_RANGE) {
        snprintf(error->found, sizeof error->found,
                 is_step ? "\"%.6g s\" is outside its valid range (limit %.6g s)"
                         : "\"%.6g Hz\" is outside its valid range (limit %.6g Hz)",
                 error->value, error->limit);
        snprintf(error->field, sizeof error->field, is_step ? "--step" : "--output-rate");
    } else if (strcmp(error->field, "level") == 0) {
        snprintf(error->field, sizeof error->field, "--level");
    }
    return command_error(error, is_file && error->field[0] != '-' ? p->source : NULL);
}

int physics_start(const physics *p, const imk_physics_settings *settings, void **state)
{
    imk_error error = {.status = IMK_OK};
    const imk_instrument *instrument = p->file.instrument;
    *state = command_aligned(instrument->state_size);
    if (instrument->init(p->file.design, settings, *state, &error) == IMK_OK)
        return -1;
    free(*state);
    *state = NULL;
    return physics_refused(p, &error);
}

uint64_t physics_samples(const physics_options *o, double rate)
{
    return (uint64_t)floor(o->duration * rate + 0.5);
}

/* ---- logs ------------------------------------------------------------------------------------ */

typedef struct sheet {
    imk_log_writer *writer; /* NULL: not written */
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

static void describe_outputs(const physics *p, sheet *s)
{
    const imk_instrument *instrument = p->file.instrument;
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
    s->temperature = p->input.temperature_rate != 0 && !told;
    if (s->temperature)
        add_column(s, "temperature", IMK_QUANTITY_TEMPERATURE, -1, "degC");
}

static void describe_signals(const physics *p, sheet *s)
{
    const imk_instrument *instrument = p->file.instrument;
    add_column(s, "time", IMK_QUANTITY_TIME, -1, "s");
    for (size_t i = 0; i < instrument->signal_count; i++)
        add_column(s, instrument->signals[i].name, IMK_QUANTITY_OTHER, -1,
                   instrument->signals[i].unit);
}

static int open_sheet(sheet *s, const char *path, uint64_t rows)
{
    imk_error error;
    double *block = command_memory(NULL, s->columns * BLOCK_ROWS * sizeof *block);
    for (size_t c = 0; c < s->columns; c++)
        s->data[c] = block + c * BLOCK_ROWS;
    if (imk_log_create(path, s->columns, s->column, IMK_LOG_SHORTEST, NULL, rows, &s->writer,
                       &error) != IMK_OK)
        return command_error(&error, NULL);
    return -1;
}

static imk_status flush(sheet *s)
{
    const size_t rows = s->rows;
    s->rows = 0;
    return rows > 0 && s->writer
               ? imk_log_write(s->writer, rows, (const double *const *)s->data, NULL)
               : IMK_OK;
}

static imk_status put_row(sheet *s, double time, const double *values, size_t count,
                          double temperature)
{
    if (!s->writer)
        return IMK_OK;
    s->data[0][s->rows] = time;
    for (size_t i = 0; i < count; i++)
        s->data[1 + i][s->rows] = values[i];
    if (s->temperature)
        s->data[1 + count][s->rows] = temperature;
    return ++s->rows == BLOCK_ROWS ? flush(s) : IMK_OK;
}

/* @return -1 or the exit code */
static int close_sheet(sheet *s)
{
    imk_error error;
    int code = -1;
    const imk_status status = flush(s);
    /* a failed write is told by commit, which knows the system's reason */
    if (s->writer && imk_log_commit(s->writer, &error) != IMK_OK)
        code = command_error(&error, NULL);
    else if (status != IMK_OK)
        code = command_failed("%s", imk_status_text(status));
    free(s->data[0]);
    *s = (sheet){.writer = NULL};
    return code;
}

static void drop_sheet(sheet *s)
{
    imk_log_abandon(s->writer);
    free(s->data[0]);
    *s = (sheet){.writer = NULL};
}

/* ---- the run --------------------------------------------------------------------------------- */

/* Means of a group of samples, one point of the picture. */
typedef struct point {
    double sum[IMK_INSTRUMENT_OUTPUTS_MAX], input, time;
    uint64_t count;
} point;

static void add_to_picture(physics_run *run, point *at, double time, const double *outputs,
                           size_t count, double input)
{
    at->time += time;
    at->input += input;
    for (size_t i = 0; i < count; i++)
        at->sum[i] += outputs[i];
    if (++at->count < run->stride || run->points > PHYSICS_CURVE_POINTS)
        return;
    run->time[run->points] = at->time / (double)at->count;
    run->input[run->points] = at->input / (double)at->count;
    for (size_t i = 0; i < count; i++)
        run->curve[i][run->points] = at->sum[i] / (double)at->count;
    run->points++;
    *at = (point){.count = 0};
}

static void allocate(physics_run *run, size_t outputs)
{
    const size_t size = PHYSICS_CURVE_POINTS + 1;
    run->time = command_memory(NULL, (outputs + 2) * size * sizeof *run->time);
    for (size_t i = 0; i < outputs; i++)
        run->curve[i] = run->time + (1 + i) * size;
    run->input = run->time + (1 + outputs) * size;
}

void physics_run_free(physics_run *run)
{
    free(run->time);
    run->time = NULL;
}

imk_unit physics_output_unit(const physics *p, const physics_run *run, size_t output)
{
    const imk_unit unit = imk_unit_of(p->file.instrument->outputs[output].unit);
    const double size = fmax(fabs(run->mean[output]), run->deviation[output]);
    return output == 0 && size > 0 ? imk_unit_readable(unit.dimension, size) : unit;
}

/* Welford's running mean and sum of squares. */
static void add_to_statistics(physics_run *run, uint64_t index, const double *outputs, size_t count)
{
    const uint64_t tail = run->samples - run->samples / 100 - 1;
    for (size_t i = 0; i < count; i++) {
        const double step = outputs[i] - run->mean[i];
        run->mean[i] += step / (double)(index + 1);
        run->deviation[i] += step * (outputs[i] - run->mean[i]);
        if (index >= tail)
            run->last[i] += outputs[i] / (double)(run->samples - tail);
    }
}

/* Statistics, and the picture in the units that fit them. */
static void finish(const physics *p, physics_run *run)
{
    for (size_t i = 0; i < p->file.instrument->output_count; i++) {
        run->deviation[i] =
            run->samples > 1 ? sqrt(run->deviation[i] / (double)(run->samples - 1)) : (double)NAN;
        const imk_unit unit = physics_output_unit(p, run, i);
        for (size_t k = 0; k < run->points; k++) {
            run->curve[i][k] = (run->curve[i][k] - unit.offset) / unit.scale;
            if (i == 0)
                run->input[k] /= unit.scale;
        }
    }
}

/* Step through the samples at settings->rate; `outputs` and `signals` may be NULL. */
static int pass(const physics *p, const imk_physics_settings *settings, sheet *outputs,
                sheet *signals, physics_run *run, const char *label)
{
    const imk_instrument *instrument = p->file.instrument;
    const uint64_t samples = physics_samples(p->options, settings->rate);
    const bool gyro = instrument->sensor == IMK_GYRO;
    double values[IMK_INSTRUMENT_OUTPUTS_MAX], inside[IMK_INSTRUMENT_SIGNALS_MAX];
    imk_status status = IMK_OK;
    point at = {.count = 0};
    void *state;
    int code = physics_start(p, settings, &state);
    if (code >= 0)
        return code;
    progress bar = progress_begin(label, "samples", 1);
    for (uint64_t k = 0; k < samples && status == IMK_OK && code < 0; k++) {
        const imk_exposure e = physics_input_at(&p->input, settings->rate, k);
        const double time = (double)(k + 1) / settings->rate;
        instrument->step(state, &e, values);
        if (!isfinite(values[0]))
            code = command_failed("the output is not finite after %g s", time);
        if (outputs)
            status = put_row(outputs, time, values, instrument->output_count, e.temperature);
        if (signals && status == IMK_OK) {
            instrument->observe(state, inside);
            status = put_row(signals, time, inside, instrument->signal_count, 0);
        }
        if (run) {
            add_to_statistics(run, k, values, instrument->output_count);
            add_to_picture(run, &at, time, values, instrument->output_count,
                           gyro ? e.angular_rate[0] : e.specific_force[0]);
        }
        progress_update(&bar, k + 1, samples);
    }
    progress_end(&bar); /* a failed write is told by commit */
    free(state);
    return code;
}

/* The signals have a run of their own when their rate is another. */
static int run_sheets(const physics *p, sheet *log, sheet *signals, physics_run *run)
{
    const bool apart = signals->columns > 0 && p->options->signal_rate != p->settings.rate;
    imk_physics_settings settings = p->settings;
    int code =
        pass(p, &settings, log, signals->columns > 0 && !apart ? signals : NULL, run, "running");
    if (code < 0 && apart) {
        settings.rate = p->options->signal_rate;
        code = pass(p, &settings, NULL, signals, NULL, "signals");
    }
    return code;
}

static int prepare(const physics *p, sheet *log, sheet *signals, physics_run *run)
{
    const physics_options *o = p->options;
    const bool to_output = !o->json && !o->report && !o->plot && !o->signals;
    int code = -1;
    run->samples = physics_samples(o, p->settings.rate);
    run->stride = run->samples / PHYSICS_CURVE_POINTS + 1;
    if (run->samples < 1)
        return command_misused("--duration %g s: shorter than a sample of %g s", o->duration,
                               1 / p->settings.rate);
    if (o->signals && p->file.instrument->signal_count == 0)
        return command_misused("--signals: the %s has no internal signals to write",
                               p->file.instrument->title);
    allocate(run, p->file.instrument->output_count);
    describe_outputs(p, log);
    if (o->output || to_output)
        code = open_sheet(log, o->output ? o->output : "-", run->samples);
    if (code < 0 && o->signals) {
        describe_signals(p, signals);
        code = open_sheet(signals, o->signals, physics_samples(o, o->signal_rate));
    }
    return code;
}

int physics_run_make(const physics *p, physics_run *run)
{
    sheet log = {.writer = NULL}, signals = {.writer = NULL};
    *run = (physics_run){.samples = 0};
    int code = prepare(p, &log, &signals, run);
    if (code < 0)
        code = run_sheets(p, &log, &signals, run);
    if (code >= 0) {
        drop_sheet(&log);
        drop_sheet(&signals);
        return code;
    }
    finish(p, run);
    code = close_sheet(&log);
    const int second = close_sheet(&signals);
    return code >= 0 ? code : second;
}
