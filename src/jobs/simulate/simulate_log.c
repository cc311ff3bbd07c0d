/* SPDX-License-Identifier: Apache-2.0 */
/* One run of a model into a record: its columns, and its rows as they are made. */
#include "simulate_log_internal.h"

#include "base/refuse_internal.h"
#include "jobs/arena_internal.h"
#include "jobs/job_internal.h"
#include "jobs/record/record_check_internal.h"

#include <math.h>

static const uint32_t settings_cookie = 0x53494D31; /* "SIM1" */

imk_simulate_log_settings imk_simulate_log_default(void)
{
    return (imk_simulate_log_settings){.cookie = settings_cookie,
                                       .simulation = imk_simulation_default()};
}

void imk_triad_axes(const imk_triad *triad, int axis[IMK_AXES_MAX])
{
    bool named = true, taken[3] = {false};
    for (int i = 0; i < triad->axis_count; i++) {
        axis[i] = -1;
        for (int k = 0; k < 3; k++)
            if (triad->direction[i][k] >= 1)
                axis[i] = k;
        named = named && axis[i] >= 0 && !taken[axis[i]];
        if (named)
            taken[axis[i]] = true;
    }
    for (int i = 0; i < triad->axis_count && !named; i++)
        axis[i] = i;
}

/* ---- columns ---- */

enum { COLUMNS_MAX = 2 + IMK_KINDS * IMK_AXES_MAX }; /* time, channels, temperature */

typedef struct layout {
    size_t count, channels;
    imk_log_column column[COLUMNS_MAX];
    double factor[COLUMNS_MAX]; /* from samples to what is written: dt of increments */
} layout;

static void describe_triad(const imk_triad *triad, const char *name, imk_quantity quantity,
                           imk_unit unit, double interval, layout *l)
{
    int axes[IMK_AXES_MAX];
    imk_triad_axes(triad, axes);
    for (int i = 0; triad->present && i < triad->axis_count; i++) {
        imk_log_column *column = &l->column[l->count];
        *column = (imk_log_column){.quantity = quantity, .axis = axes[i], .unit = unit};
        imk_axis_name(name, axes[i], column->name);
        l->factor[l->count] = 1;
        if (triad->sensitivity.value[i] != 0) { /* counts are of the rate */
            column->unit = imk_unit_of("count");
        } else if (interval > 0) {
            column->increment = true;
            l->factor[l->count] = interval;
        }
        l->count++;
        l->channels++;
    }
}

static layout make_layout(const imk_model *model, const imk_simulate_log_settings *s)
{
    const bool steps = s->increments;
    const double interval = steps ? 1 / s->simulation.rate : 0;
    const imk_unit gyro =
        s->gyro_unit.scale > 0 ? s->gyro_unit : imk_unit_of(steps ? "deg" : "deg/s");
    const imk_unit accel =
        s->accel_unit.scale > 0 ? s->accel_unit : imk_unit_of(steps ? "m/s" : "m/s^2");
    layout l = {.count = 1, .factor = {1}};
    l.column[0] = (imk_log_column){
        .name = "time", .quantity = IMK_QUANTITY_TIME, .axis = -1, .unit = imk_unit_of("s")};
    describe_triad(&model->gyro, steps ? "dtheta" : "gyro", IMK_QUANTITY_ANGULAR_RATE, gyro,
                   interval, &l);
    describe_triad(&model->accel, steps ? "dvel" : "accel", IMK_QUANTITY_SPECIFIC_FORCE, accel,
                   interval, &l);
    const double *field = s->simulation.field;
    if (field[0] != 0 || field[1] != 0 || field[2] != 0)
        describe_triad(&model->mag, "mag", IMK_QUANTITY_MAGNETIC, imk_unit_of("uT"), 0, &l);
    if (s->simulation.temperature) {
        l.factor[l.count] = 1;
        l.column[l.count++] = (imk_log_column){.name = "temperature",
                                               .quantity = IMK_QUANTITY_TEMPERATURE,
                                               .axis = -1,
                                               .unit = imk_unit_of("degC")};
    }
    return l;
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

/* ---- rows ---- */

/* Rows made and written at a time: long enough to share among threads, short enough for the
 * cache of a small machine. */
enum { BLOCK_ROWS = 65536 };

struct imk_simulated_rows {
    imki_arena arena;
    imk_simulate_log_settings settings;
    layout layout;
    imk_simulator *simulator;
    bool drops;
    uint64_t next;
};

/* Take out the rows that are lost. @return how many stay */
static size_t drop_rows(const imk_simulated_rows *r, size_t count, double *const *column)
{
    size_t kept = 0;
    for (size_t k = 0; k < count; k++) {
        if (imk_simulator_dropped(r->simulator, r->next + k))
            continue;
        for (size_t c = 0; c < r->layout.count; c++)
            column[c][kept] = column[c][k];
        kept++;
    }
    return kept;
}

/* @return how many rows there are */
static size_t make_rows(imk_simulated_rows *r, size_t count, double *const *column,
                        const imk_executor *executor)
{
    const imk_simulate_log_settings *s = &r->settings;
    const layout *l = &r->layout;
    double *time = column[0];
    for (size_t k = 0; k < count; k++)
        time[k] = (double)(r->next + k) / s->simulation.rate;
    if (s->simulation.temperature)
        imk_temperature_at(s->simulation.temperature, count, time, column[1 + l->channels], NULL);
    for (size_t k = 0; k < count && s->start != 0; k++)
        time[k] += s->start;
    imk_simulator_next(r->simulator, count, column + 1, executor);
    for (size_t c = 1; c <= l->channels; c++)
        if (l->factor[c] != 1)
            for (size_t k = 0; k < count; k++)
                column[c][k] *= l->factor[c];
    const size_t kept = r->drops ? drop_rows(r, count, column) : count;
    r->next += count;
    return kept;
}

/* Vibration makes rows so slow to compute that fewer at a time keep the progress going. */
static size_t rows_at_once(const imk_simulation *simulation)
{
    const imk_trajectory *trajectory = simulation->motion.trajectory;
    const size_t parts = trajectory ? imk_trajectory_substeps(trajectory, 1 / simulation->rate) : 1;
    return parts < BLOCK_ROWS / 1024 ? BLOCK_ROWS / parts : 1024;
}

uint64_t imk_simulated_rows_left(const imk_simulated_rows *r)
{
    return r->settings.rows > 0 ? r->settings.rows - r->next : UINT64_MAX;
}

const imk_log_column *imk_simulated_rows_columns(const imk_simulated_rows *r, size_t *count)
{
    *count = r->layout.count;
    return r->layout.column;
}

imk_status imk_simulated_rows_next(imk_simulated_rows *r, size_t most, double *const *columns,
                                   const char *stage, const imk_job *job, size_t *made,
                                   imk_error *error)
{
    const size_t step = rows_at_once(&r->settings.simulation);
    imk_status status = IMK_OK;
    *made = 0;
    job = imki_job_of(job);
    while (most > 0 && status == IMK_OK) {
        const uint64_t left = imk_simulated_rows_left(r);
        size_t count = most < step ? most : step;
        double *at[COLUMNS_MAX] = {columns[0] + *made}; /* the time is always there */
        if (left < count)
            count = (size_t)left;
        if (count == 0)
            break;
        for (size_t c = 1; c < r->layout.count; c++)
            at[c] = columns[c] + *made;
        *made += make_rows(r, count, at, job->executor);
        most -= count;
        status = imki_job_progress(job, stage, "rows", r->next, r->settings.rows, error);
    }
    return status;
}

void imk_simulated_rows_free(imk_simulated_rows *r)
{
    if (!r)
        return;
    imki_arena arena = r->arena;
    imki_arena_free(&arena);
}

static imk_status check_settings(const imk_model *model, const imk_simulate_log_settings *s,
                                 const void *result, imk_error *error)
{
    imk_status status =
        imki_check_call(result, s, settings_cookie, "imk_simulate_log_default()", error);
    if (status == IMK_OK)
        status = imki_check_model(model, error);
    if (status == IMK_OK)
        status =
            imki_check_unit(&s->gyro_unit, imk_unit_of(s->increments ? "rad" : "rad/s").dimension,
                            "gyro_unit", error);
    if (status == IMK_OK)
        status =
            imki_check_unit(&s->accel_unit, imk_unit_of(s->increments ? "m/s" : "m/s^2").dimension,
                            "accel_unit", error);
    return status;
}

imk_status imki_simulate_check(const imk_model *model, const imk_simulate_log_settings *s,
                               const imk_record_sink *sink, imk_error *error)
{
    imk_status status = imki_check_sink(sink, error);
    if (status == IMK_OK)
        status = check_settings(model, s, sink, error);
    if (status == IMK_OK && s->rows == 0)
        status = imki_refuse(error, IMK_ERROR_RANGE, "rows", 0, 1, "at least 1 row");
    return status;
}

imk_status imk_simulated_rows_start(const imk_model *model,
                                    const imk_simulate_log_settings *settings, const imk_job *job,
                                    imk_simulated_rows **rows, imk_error *error)
{
    imki_arena arena = {.allocator = imki_job_of(job)->allocator};
    imk_status status = check_settings(model, settings, rows, error);
    if (status != IMK_OK)
        return status;
    const size_t size = imk_simulator_size(model, &settings->simulation);
    imk_simulated_rows *r = imki_arena_take(&arena, sizeof *r);
    void *memory = imki_arena_room(&arena, size > 256 ? size : 256); /* a cache line begins there */
    status = imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
    if (r && memory) {
        r->settings = *settings;
        r->layout = make_layout(model, settings);
        r->drops = model->timing.drops.value > 0;
        status =
            imk_simulator_start(model, &settings->simulation, &r->simulator, memory, size, error);
    }
    if (!r || status != IMK_OK) {
        imki_arena_free(&arena);
        return status;
    }
    r->arena = arena;
    *rows = r;
    return IMK_OK;
}

static imk_status stream(imk_simulated_rows *r, double *const *column, const imk_record_sink *sink,
                         const char *stage, const imk_job *job, imk_error *error)
{
    const imk_simulate_log_settings *s = &r->settings;
    const size_t step = rows_at_once(&s->simulation);
    int decimals[COLUMNS_MAX];
    for (size_t c = 0; c < r->layout.count; c++)
        decimals[c] = c == 0 ? time_decimals(s->simulation.rate, s->start) : -1;
    imk_status status = sink->begin(sink->context, r->layout.count, r->layout.column, decimals,
                                    r->drops ? 0 : s->rows, error);
    while (imk_simulated_rows_left(r) > 0 && status == IMK_OK) {
        const uint64_t left = imk_simulated_rows_left(r);
        const size_t made = make_rows(r, left < step ? (size_t)left : step, column, job->executor);
        status =
            sink->write(sink->context, made, (const double *const *)column, job->executor, error);
        if (status == IMK_OK)
            status = imki_job_progress(job, stage, "rows", r->next, s->rows, error);
    }
    return status;
}

imk_status imk_simulate_log_run(const imk_model *model, const imk_simulate_log_settings *settings,
                                const imk_record_sink *sink, const char *stage, const imk_job *job,
                                imk_error *error)
{
    imk_simulated_rows *r = NULL;
    double *column[COLUMNS_MAX];
    job = imki_job_of(job);
    imk_status status = imki_simulate_check(model, settings, sink, error);
    if (status == IMK_OK)
        status = imk_simulated_rows_start(model, settings, job, &r, error);
    if (!r)
        return status;
    double *block = imki_arena_room(&r->arena, r->layout.count * BLOCK_ROWS * sizeof *block);
    column[0] = block;
    for (size_t c = 1; block && c < r->layout.count; c++)
        column[c] = block + c * BLOCK_ROWS;
    status = block ? stream(r, column, sink, stage, job, error)
                   : imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
    imk_simulated_rows_free(r);
    return status;
}
