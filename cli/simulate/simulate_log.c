/* SPDX-License-Identifier: Apache-2.0 */
/* One run into one log: its columns, and its rows written as they are made. */
#include "log/written_columns.h"
#include "shell/progress.h"
#include "simulate_parts.h"

#include <math.h>
#include <stdlib.h>

/* ---- columns ---- */

/* A kind of sensor as the options want it written. */
typedef struct sensor_columns {
    const char *name;
    imk_quantity quantity;
    imk_unit unit;
    double interval; /* of increments [s]; 0: rates */
} sensor_columns;

static void describe_triad(const imk_triad *triad, const sensor_columns *sensor, log_layout *layout)
{
    int axes[IMK_AXES_MAX];
    log_axes(triad, axes);
    for (int i = 0; triad->present && i < triad->axis_count; i++) {
        imk_log_column *column = &layout->column[layout->count];
        *column =
            (imk_log_column){.quantity = sensor->quantity, .axis = axes[i], .unit = sensor->unit};
        log_axis_name(sensor->name, axes[i], column->name, sizeof column->name);
        layout->factor[layout->count] = 1;
        if (triad->sensitivity.value[i] != 0) {
            column->unit = imk_unit_of("count");
        } else if (sensor->interval > 0) {
            column->increment = true;
            layout->factor[layout->count] = sensor->interval;
        }
        layout->count++;
        layout->channels++;
    }
}

/* Decimals that hold every multiple of 1/rate after a start, up to nine. */
static int time_decimals(double rate, double start)
{
    double scale = 1;
    for (int decimals = 0; decimals < 9; decimals++, scale *= 10)
        if (scale / rate == floor(scale / rate) && scale * start == floor(scale * start))
            return decimals;
    return 9;
}

/* Counts are of the rate, whatever unit is asked for. */
static int check_counts(const simulate_options *o, const imk_model *model)
{
    const bool gyro = model->gyro.present && model->gyro.sensitivity.value[0] != 0;
    const bool accel = model->accel.present && model->accel.sensitivity.value[0] != 0;
    if (o->increments && (gyro || accel))
        return command_misused("--increments: a model with a sensitivity makes counts, which are "
                               "rates; leave the option out");
    if (o->gyro_unit && gyro)
        return command_misused("--gyro-unit %s: the model's gyros have a sensitivity and make "
                               "counts; leave the option out",
                               o->gyro_unit);
    if (o->accel_unit && accel)
        return command_misused("--accel-unit %s: the model's accelerometers have a sensitivity "
                               "and make counts; leave the option out",
                               o->accel_unit);
    return -1;
}

int log_layout_make(const simulate_options *o, const imk_model *model, const scene *s,
                    log_layout *layout)
{
    const bool steps = o->increments;
    sensor_columns gyro = {.name = steps ? "dtheta" : "gyro",
                           .quantity = IMK_QUANTITY_ANGULAR_RATE};
    sensor_columns accel = {.name = steps ? "dvel" : "accel",
                            .quantity = IMK_QUANTITY_SPECIFIC_FORCE};
    gyro.interval = accel.interval = steps ? 1 / s->simulation.rate : 0;
    gyro.unit = imk_unit_of(steps ? "deg" : "deg/s");
    accel.unit = imk_unit_of(steps ? "m/s" : "m/s^2");
    int code = log_unit_asked("gyro-unit", o->gyro_unit, &gyro.unit);
    if (code < 0)
        code = log_unit_asked("accel-unit", o->accel_unit, &accel.unit);
    if (code < 0)
        code = check_counts(o, model);
    if (code >= 0)
        return code;
    *layout = (log_layout){.count = 1, .temperature = s->simulation.temperature != NULL};
    layout->column[0] = (imk_log_column){
        .name = "time", .quantity = IMK_QUANTITY_TIME, .axis = -1, .unit = imk_unit_of("s")};
    layout->factor[0] = 1;
    describe_triad(&model->gyro, &gyro, layout);
    describe_triad(&model->accel, &accel, layout);
    if (layout->temperature) {
        layout->factor[layout->count] = 1;
        layout->column[layout->count++] = (imk_log_column){.name = "temperature",
                                                           .quantity = IMK_QUANTITY_TEMPERATURE,
                                                           .axis = -1,
                                                           .unit = imk_unit_of("degC")};
    }
    for (size_t c = 0; c < layout->count; c++)
        layout->decimals[c] =
            c == 0 ? time_decimals(s->simulation.rate, s->start) : (int)o->decimals.value;
    return -1;
}

/* ---- rows ---- */

/* Rows made and written at a time: long enough to share among threads, short enough for the
 * cache of a small machine. */
enum { BLOCK_ROWS = 65536 };

typedef struct recording {
    const scene *scene;
    const log_layout *layout;
    imk_simulator *simulator;
    imk_log_writer *writer;
    const imk_executor *executor;
    bool drops;
    double *column[SIMULATE_COLUMNS_MAX]; /* BLOCK_ROWS each */
} recording;

/* Take out the rows that are lost. @return how many stay */
static size_t drop_rows(recording *r, uint64_t first, size_t count)
{
    size_t kept = 0;
    for (size_t k = 0; k < count; k++) {
        if (imk_simulator_dropped(r->simulator, first + k))
            continue;
        for (size_t c = 0; c < r->layout->count; c++)
            r->column[c][kept] = r->column[c][k];
        kept++;
    }
    return kept;
}

static imk_status write_rows(recording *r, uint64_t first, size_t count)
{
    const log_layout *layout = r->layout;
    double *time = r->column[0];
    for (size_t k = 0; k < count; k++)
        time[k] = (double)(first + k) / r->scene->simulation.rate;
    if (layout->temperature)
        imk_temperature_at(r->scene->simulation.temperature, count, time,
                           r->column[1 + layout->channels], NULL);
    for (size_t k = 0; k < count && r->scene->start != 0; k++)
        time[k] += r->scene->start;
    imk_simulator_next(r->simulator, count, r->column + 1, r->executor);
    for (size_t c = 1; c <= layout->channels; c++)
        if (layout->factor[c] != 1)
            for (size_t k = 0; k < count; k++)
                r->column[c][k] *= layout->factor[c];
    if (r->drops)
        count = drop_rows(r, first, count);
    return imk_log_write(r->writer, count, (const double *const *)r->column, r->executor);
}

/* Vibration makes rows so slow to compute that fewer at a time keep the progress going. */
static size_t rows_at_once(const imk_simulation *simulation)
{
    const imk_trajectory *trajectory = simulation->motion.trajectory;
    size_t parts = trajectory ? imk_trajectory_substeps(trajectory, 1 / simulation->rate) : 1;
    return parts < BLOCK_ROWS / 1024 ? BLOCK_ROWS / parts : 1024;
}

static int stream(recording *r, const char *label)
{
    imk_error error;
    progress p = progress_begin(label, "rows", 1);
    imk_status status = IMK_OK;
    const uint64_t rows = r->scene->rows;
    const size_t step = rows_at_once(&r->scene->simulation);
    for (uint64_t first = 0; first < rows && status == IMK_OK; first += step) {
        size_t count = rows - first < step ? (size_t)(rows - first) : step;
        status = write_rows(r, first, count);
        progress_update(&p, first + count, rows);
    }
    progress_end(&p);
    /* A failed write is told by commit, which knows the system's reason. */
    if (imk_log_commit(r->writer, &error) != IMK_OK)
        return command_error(&error, NULL);
    return status == IMK_OK ? EXIT_DONE : command_failed("%s", imk_status_text(status));
}

static int create(const simulate_options *o, recording *r, const char *path)
{
    imk_error error;
    bool fixed = o->decimals.given;
    if (imk_log_create(path, r->layout->count, r->layout->column,
                       fixed ? IMK_LOG_FIXED : IMK_LOG_SHORTEST, fixed ? r->layout->decimals : NULL,
                       r->drops ? 0 : r->scene->rows, &r->writer, &error) != IMK_OK)
        return command_error(&error, NULL);
    return -1;
}

int simulate_log(const simulate_options *o, const imk_model *model, const scene *s,
                 const log_layout *layout, const imk_executor *executor, const log_target *target)
{
    imk_error error;
    recording r = {
        .scene = s, .layout = layout, .executor = executor, .drops = model->timing.drops.value > 0};
    const size_t size = imk_simulator_size(model, &s->simulation);
    void *memory = command_aligned(size);
    double *block = command_memory(NULL, layout->count * BLOCK_ROWS * sizeof *block);
    for (size_t c = 0; c < layout->count; c++)
        r.column[c] = block + c * BLOCK_ROWS;
    int code =
        imk_simulator_start(memory, size, model, &s->simulation, &r.simulator, &error) == IMK_OK
            ? create(o, &r, target->path)
            : command_error(&error, NULL);
    if (code < 0)
        code = stream(&r, target->label);
    free(block);
    free(memory);
    return code;
}
