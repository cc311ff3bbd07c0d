/* SPDX-License-Identifier: Apache-2.0 */
/* Blocks of rows: read, correct, write. With lever arms the compensator is one sample late; the
 * last row of a block then waits, its copied columns included, for the next one. Rows are in the
 * buffers of the log's columns; a corrected value stands in the place of the reading it came from.
 */
#include "compensate_parts.h"

#include "log/log_units.h"
#include "shell/progress.h"

#include "imukit/samples.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Long enough that the first block tells the sample interval (4096 steps) and to share the writing
 * among threads. */
enum { BLOCK_ROWS = 65536 };

typedef struct stream {
    const compensate_options *options;
    compensation *compensation;
    size_t column_count;                /* of the log */
    double *data[IMK_LOG_COLUMNS_MAX];  /* BLOCK_ROWS + 1 rows each */
    double *corrected[2][IMK_AXES_MAX]; /* likewise */
    double *flag_column, *temperature, *workspace;
    unsigned char *flags;
    size_t waiting; /* rows at the head of the buffers that were read before: 0 or 1 */
    double first_time, last_time;
    imk_log_writer *writer;
} stream;

static double *take(double **memory)
{
    double *taken = *memory;
    *memory += BLOCK_ROWS + 1;
    return taken;
}

/* @return what to free */
static double *allocate(stream *s)
{
    size_t columns = s->column_count + 2 * IMK_AXES_MAX + 2;
    size_t size = columns * (BLOCK_ROWS + 1) + imk_compensate_workspace(BLOCK_ROWS);
    double *memory = command_memory(NULL, size * sizeof *memory + BLOCK_ROWS + 1), *next = memory;
    for (size_t k = 0; k < s->column_count; k++)
        s->data[k] = take(&next);
    for (int sensor = 0; sensor < 2; sensor++)
        for (int i = 0; i < IMK_AXES_MAX; i++)
            s->corrected[sensor][i] = take(&next);
    s->flag_column = take(&next);
    s->temperature = take(&next);
    s->workspace = next;
    s->flags = (unsigned char *)(next + imk_compensate_workspace(BLOCK_ROWS));
    return memory;
}

/* The sample interval is known when the first block has been read. */
static int start(stream *s)
{
    imk_error error;
    compensation *c = s->compensation;
    imk_correction_settings settings = imk_correction_default();
    settings.rate_limit = s->options->rate_limit;
    settings.force_limit = s->options->force_limit;
    settings.kernel = imk_random_seeded(0).kernel; /* the fastest there is */
    double interval = imk_log_findings_get(c->reader).interval;
    if (!(interval > 0)) /* a single row has none, and no use for it */
        interval = 1;
    imk_status status =
        imk_compensator_start(&c->compensator, &c->model, interval, &settings, &error);
    if (status == IMK_ERROR_KEY_MISSING)
        return command_failed("%s: %s is missing, which bounds the correction: state it in the "
                              "model, or add --rate-limit 500deg/s or --force-limit 10g",
                              c->name, error.field);
    if (status != IMK_OK)
        return command_error(&error, status == IMK_ERROR_RANGE ? c->log : c->name);
    c->compensator.temperature_time = s->options->temperature_time;
    imk_compensator_resume(&c->compensator, s->options->powered_for);
    return compensate_describe(s->options, c->reader, &c->compensator, &c->columns);
}

static int create(stream *s)
{
    const compensate_options *o = s->options;
    const compensate_columns *columns = &s->compensation->columns;
    int decimals[IMK_LOG_COLUMNS_MAX];
    imk_error error;
    for (size_t k = 0; k < columns->count; k++) {
        bool flags = columns->content[k].source < 0 && columns->content[k].sensor == 2;
        decimals[k] = flags ? 0 : (int)o->decimals.value;
    }
    bool fixed = o->decimals.given;
    if (imk_log_create(o->output ? o->output : "-", columns->count, columns->column,
                       fixed ? IMK_LOG_FIXED : IMK_LOG_SHORTEST, fixed ? decimals : NULL, 0,
                       &s->writer, &error) != IMK_OK)
        return command_error(&error, NULL);
    log_copy_labels(s->compensation->reader, s->writer);
    return -1;
}

/* Does time go on evenly from the row before? */
static bool is_break(const stream *s, double time)
{
    double step = time - s->last_time;
    return step <= 0 || imk_step_intervals(step, s->compensation->compensator.dt) > 1;
}

/* Rows `from` to `to` of the buffers, a piece without a break, into the compensator.
 * @return outputs, behind the `done` there are already */
static size_t correct_piece(stream *s, size_t from, size_t to, size_t done)
{
    compensation *c = s->compensation;
    imk_readings readings = {.temperature = s->temperature + from};
    double *out[2][IMK_AXES_MAX];
    for (int sensor = 0; sensor < 2; sensor++)
        for (int i = 0; i < IMK_AXES_MAX; i++) {
            if (i < c->compensator.correction.distortion.axis_count[sensor])
                readings.channel[sensor][i] = s->data[c->columns.axis[sensor][i]] + from;
            out[sensor][i] = s->corrected[sensor][i] + done;
        }
    return imk_compensator_block(&c->compensator, &readings, to - from, out, s->flags + done,
                                 s->workspace);
}

/* The sample the compensator still holds. @return 1, or 0 when there is none */
static size_t flush(stream *s, size_t done)
{
    compensation *c = s->compensation;
    imk_compensator_sample sample;
    if (!imk_compensator_finish(&c->compensator, &sample))
        return 0;
    for (int i = 0; i < imk_compensator_components(&c->compensator, IMK_GYRO); i++)
        s->corrected[IMK_GYRO][i][done] = sample.rate[i];
    for (int i = 0; i < imk_compensator_components(&c->compensator, IMK_ACCEL); i++)
        s->corrected[IMK_ACCEL][i][done] = sample.force[i];
    s->flags[done] = (unsigned char)sample.flags;
    return 1;
}

static void fill_temperature(stream *s, size_t rows)
{
    compensation *c = s->compensation;
    int column = c->columns.temperature;
    bool constant = !isnan(s->options->temperature);
    for (size_t r = s->waiting; r < rows && c->compensator.needs_temperature; r++) {
        s->temperature[r] = constant ? s->options->temperature : s->data[column][r];
        c->counts.temperatures_held += !(fabs(s->temperature[r]) < (double)INFINITY);
    }
}

/* New rows, from s->waiting on. @return rows that are ready to be written */
static size_t correct_rows(stream *s, size_t rows)
{
    compensation *c = s->compensation;
    const double *time = c->columns.time >= 0 ? s->data[c->columns.time] : NULL;
    size_t done = 0, from = s->waiting;
    fill_temperature(s, rows);
    for (size_t r = s->waiting; time && r < rows; r++) {
        if (!isfinite(time[r])) {
            if (c->counts.times_missing++ == 0)
                c->counts.first_time_missing = c->counts.rows + (r - s->waiting) + 1;
            s->last_time += c->compensator.dt;
            continue;
        }
        if (isnan(s->first_time))
            s->first_time = time[r];
        if (is_break(s, time[r])) {
            done += correct_piece(s, from, r, done);
            done += flush(s, done);
            imk_compensator_resume(&c->compensator,
                                   s->options->powered_for + (time[r] - s->first_time));
            if (c->counts.stretches++ == 1)
                c->counts.first_gap = c->counts.rows + (r - s->waiting) + 1;
            from = r;
        }
        s->last_time = time[r];
    }
    done += correct_piece(s, from, rows, done);
    c->counts.rows += rows - s->waiting;
    return done;
}

/* @param first_row  of the file, counted from 1, at the head of the buffers */
static bool write_rows(stream *s, size_t count, uint64_t first_row, const imk_executor *executor)
{
    const compensate_columns *columns = &s->compensation->columns;
    compensate_counts *counts = &s->compensation->counts;
    const double *written[IMK_LOG_COLUMNS_MAX];
    for (size_t r = 0; r < count; r++) {
        unsigned flags = s->flags[r];
        s->flag_column[r] = flags;
        counts->any_flag += flags != 0;
        for (int i = 0; flags && i < IMK_FLAG_COUNT; i++)
            if ((flags & (1U << i)) && counts->flagged[i]++ == 0)
                counts->first_flagged[i] = first_row + r;
    }
    for (size_t k = 0; k < columns->count; k++) {
        int source = columns->content[k].source, sensor = columns->content[k].sensor;
        written[k] = source >= 0   ? s->data[source]
                     : sensor == 2 ? s->flag_column
                                   : s->corrected[sensor][columns->content[k].component];
    }
    return imk_log_write(s->writer, count, written, executor) == IMK_OK;
}

/* @return -1 or the exit code; with a code the writer is still to be abandoned */
static int copy(stream *s, const imk_executor *executor)
{
    compensation *c = s->compensation;
    imk_error error;
    size_t got = 1;
    bool wrote = true;
    progress p = progress_begin("compensating", "B", 1);
    int code = -1;
    while (got > 0 && wrote && code < 0) {
        double *place[IMK_LOG_COLUMNS_MAX];
        uint64_t at, size, first_row = c->counts.rows - s->waiting + 1;
        for (size_t k = 0; k < s->column_count; k++)
            place[k] = s->data[k] + s->waiting;
        if (imk_log_read(c->reader, BLOCK_ROWS, place, &got, &error) != IMK_OK) {
            progress_end(&p);
            return command_log_error(&error, c->log);
        }
        if (!s->writer && (code = start(s)) < 0)
            code = create(s);
        if (code >= 0)
            break;
        size_t rows = s->waiting + got, ready = got > 0 ? correct_rows(s, rows) : flush(s, 0);
        wrote = write_rows(s, ready, first_row, executor);
        s->waiting = rows - ready;
        for (size_t k = 0; k < s->column_count && s->waiting > 0; k++)
            s->data[k][0] = s->data[k][ready];
        imk_log_progress(c->reader, &at, &size);
        progress_update(&p, at, size);
    }
    progress_end(&p);
    if (code < 0 && wrote && c->counts.rows == 0)
        code = command_failed("%s: there is a header but no data row", c->log);
    return code;
}

int compensate_stream(const compensate_options *o, compensation *c)
{
    imk_error error;
    stream s = {.options = o,
                .compensation = c,
                .column_count = imk_log_column_count(c->reader),
                .first_time = (double)NAN,
                .last_time = (double)NAN};
    double *memory = allocate(&s);
    c->counts.stretches = 1;
    imk_thread_pool *pool = imk_thread_pool_create(o->threads.value);
    imk_executor executor = imk_thread_pool_executor(pool);
    int code = copy(&s, &executor);
    imk_thread_pool_destroy(pool);
    free(memory);
    if (code >= 0)
        imk_log_abandon(s.writer);
    else if (imk_log_commit(s.writer, &error) != IMK_OK)
        code = command_error(&error, NULL);
    return code;
}
