/* SPDX-License-Identifier: Apache-2.0 */
/* The truth behind a record, row by row: where the unit was at the stamp, and what perfect sensors
 * would have read over the row. */
#include "simulate_log_internal.h"

#include "jobs/arena_internal.h"
#include "jobs/job_internal.h"

#include <stdio.h>
#include <string.h>

enum { BLOCK_ROWS = 4096, STATE_COLUMNS = 10, SENSOR_COLUMNS = 6 };

static const struct {
    const char *name;
    imk_quantity quantity;
    int axis;
    const char *unit;
} truth_columns[1 + STATE_COLUMNS + SENSOR_COLUMNS] = {
    {"time", IMK_QUANTITY_TIME, -1, "s"},
    {"latitude", IMK_QUANTITY_OTHER, -1, "deg"},
    {"longitude", IMK_QUANTITY_OTHER, -1, "deg"},
    {"height", IMK_QUANTITY_OTHER, -1, "m"},
    {"vel_north", IMK_QUANTITY_OTHER, -1, "m/s"},
    {"vel_east", IMK_QUANTITY_OTHER, -1, "m/s"},
    {"vel_down", IMK_QUANTITY_OTHER, -1, "m/s"},
    {"roll", IMK_QUANTITY_OTHER, -1, "deg"},
    {"pitch", IMK_QUANTITY_OTHER, -1, "deg"},
    {"yaw", IMK_QUANTITY_OTHER, -1, "deg"},
    {"true_time", IMK_QUANTITY_OTHER, -1, "s"},
    {"gyro_x", IMK_QUANTITY_ANGULAR_RATE, 0, "deg/s"},
    {"gyro_y", IMK_QUANTITY_ANGULAR_RATE, 1, "deg/s"},
    {"gyro_z", IMK_QUANTITY_ANGULAR_RATE, 2, "deg/s"},
    {"accel_x", IMK_QUANTITY_SPECIFIC_FORCE, 0, "m/s^2"},
    {"accel_y", IMK_QUANTITY_SPECIFIC_FORCE, 1, "m/s^2"},
    {"accel_z", IMK_QUANTITY_SPECIFIC_FORCE, 2, "m/s^2"},
};
enum { COLUMNS = sizeof truth_columns / sizeof truth_columns[0] };

typedef struct truth {
    const imk_simulate_log_settings *settings;
    const imk_trajectory *trajectory; /* NULL: recorded */
    imk_simulator *simulator;
    imk_random random;
    size_t parts;                    /* of a row: vibration may be faster than rows */
    double boundary[BLOCK_ROWS + 1]; /* of parts, as many as fit */
    double part[SENSOR_COLUMNS][BLOCK_ROWS];
    double block[COLUMNS][BLOCK_ROWS];
} truth;

static void fill_state(truth *t, uint64_t row, size_t k)
{
    imk_motion_state state;
    double roll, pitch, yaw, time = imk_simulator_true_time(t->simulator, (int64_t)row);
    imk_trajectory_state(t->trajectory, time, &state);
    imk_matrix3_to_euler(state.c_nb, &roll, &pitch, &yaw);
    const double values[STATE_COLUMNS] = {state.place.latitude,
                                          state.place.longitude,
                                          state.place.height,
                                          state.velocity_ned.v[0],
                                          state.velocity_ned.v[1],
                                          state.velocity_ned.v[2],
                                          roll,
                                          pitch,
                                          yaw,
                                          time};
    for (size_t c = 0; c < STATE_COLUMNS; c++)
        t->block[1 + c][k] = values[c];
}

static void copy_recorded(truth *t, uint64_t first, size_t count)
{
    const imk_recorded_motion *recorded = t->settings->simulation.motion.recorded;
    for (size_t i = 0; i < 3; i++) {
        memcpy(t->block[1 + STATE_COLUMNS + i], recorded->angular_rate[i] + first,
               count * sizeof(double));
        memcpy(t->block[4 + STATE_COLUMNS + i], recorded->specific_force[i] + first,
               count * sizeof(double));
    }
}

/* Means over rows from the means over their parts, which vibration moves through less than a
 * sixteenth of a cycle. */
static void fill_sensors(truth *t, uint64_t first, size_t count)
{
    const size_t rows_at_once = BLOCK_ROWS / t->parts;
    double *rate[3] = {t->part[0], t->part[1], t->part[2]};
    double *force[3] = {t->part[3], t->part[4], t->part[5]};
    for (size_t row = 0; row < count; row += rows_at_once) {
        const size_t now = count - row < rows_at_once ? count - row : rows_at_once;
        const int64_t before = (int64_t)(first + row) - 1;
        double end = imk_simulator_true_time(t->simulator, before);
        for (size_t k = 0; k < now; k++) {
            const double begin = end;
            end = imk_simulator_true_time(t->simulator, before + 1 + (int64_t)k);
            for (size_t j = 0; j < t->parts; j++)
                t->boundary[k * t->parts + j] =
                    begin + (end - begin) * ((double)j / (double)t->parts);
        }
        t->boundary[now * t->parts] = end;
        imk_trajectory_means(t->trajectory, t->random.kernel, now * t->parts, t->boundary, rate,
                             NULL, force);
        for (size_t i = 0; i < SENSOR_COLUMNS; i++)
            for (size_t k = 0; k < now; k++) {
                double sum = 0;
                for (size_t j = 0; j < t->parts; j++)
                    sum += t->part[i][k * t->parts + j];
                t->block[1 + STATE_COLUMNS + i][row + k] = sum / (double)t->parts;
            }
    }
}

static size_t choose_columns(truth *t, imk_log_column *columns, double **data)
{
    size_t count = 0;
    for (size_t c = 0; c < COLUMNS; c++) {
        bool state = c > 0 && c <= STATE_COLUMNS;
        if (state && !t->trajectory)
            continue;
        columns[count] = (imk_log_column){.quantity = truth_columns[c].quantity,
                                          .axis = truth_columns[c].axis,
                                          .unit = imk_unit_of(truth_columns[c].unit)};
        snprintf(columns[count].name, sizeof columns[count].name, "%s", truth_columns[c].name);
        data[count++] = t->block[c];
    }
    return count;
}

static imk_status stream(truth *t, const imk_record_sink *sink, const imk_job *job,
                         imk_error *error)
{
    imk_log_column columns[COLUMNS];
    double *data[COLUMNS];
    int decimals[COLUMNS];
    const size_t count = choose_columns(t, columns, data);
    const uint64_t rows = t->settings->rows;
    for (size_t c = 0; c < count; c++)
        decimals[c] = -1;
    imk_status status = sink->begin(sink->context, count, columns, decimals, rows, error);
    for (uint64_t first = 0; first < rows && status == IMK_OK; first += BLOCK_ROWS) {
        const size_t now = rows - first < BLOCK_ROWS ? (size_t)(rows - first) : BLOCK_ROWS;
        for (size_t k = 0; k < now; k++) {
            t->block[0][k] =
                t->settings->start + (double)(first + k) / t->settings->simulation.rate;
            if (t->trajectory)
                fill_state(t, first + k, k);
        }
        if (t->trajectory)
            fill_sensors(t, first, now);
        else
            copy_recorded(t, first, now);
        status = sink->write(sink->context, now, (const double *const *)data, job->executor, error);
        if (status == IMK_OK)
            status = imki_job_progress(job, "writing the truth", "rows", first + now, rows, error);
    }
    return status;
}

static size_t truth_parts(const imk_trajectory *trajectory, const imk_simulation *simulation)
{
    const size_t needed = imk_trajectory_substeps(trajectory, 1.0 / simulation->rate);
    return needed < BLOCK_ROWS ? needed : BLOCK_ROWS;
}

/* A unit at rest is on a trajectory too. */
static imk_status choose_trajectory(truth *t, imk_trajectory_piece *piece, imk_trajectory *rest,
                                    imk_error *error)
{
    const imk_simulation *s = &t->settings->simulation;
    const double attitude[3] = {s->roll, s->pitch, s->yaw};
    imk_status status = IMK_OK;
    t->trajectory = s->motion.trajectory;
    if (!t->trajectory && !s->motion.recorded) {
        const imk_geodetic place = {s->latitude, 0.0, s->height};
        status = imk_trajectory_standstill(place, attitude, s->earth, piece, rest, error);
        t->trajectory = rest;
    }
    t->parts = status == IMK_OK && t->trajectory ? truth_parts(t->trajectory, s) : 1;
    return status;
}

imk_status imk_simulate_truth_run(const imk_model *model, const imk_simulate_log_settings *settings,
                                  const imk_record_sink *sink, const imk_job *job, imk_error *error)
{
    job = imki_job_of(job);
    imk_status status = imki_simulate_check(model, settings, sink, error);
    if (status != IMK_OK)
        return status;
    imki_arena arena = {.allocator = job->allocator};
    imk_trajectory_piece rest_piece;
    imk_trajectory rest;
    const size_t size = imk_simulator_size(model, &settings->simulation);
    void *memory = imki_arena_room(&arena, size > 256 ? size : 256); /* a cache line begins there */
    truth *t = imki_arena_take(&arena, sizeof *t);
    status = imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
    if (memory && t) {
        t->settings = settings;
        t->random = imk_random_seeded(settings->simulation.seed);
        status = choose_trajectory(t, &rest_piece, &rest, error);
    }
    if (status == IMK_OK) /* only for the true times of its rows */
        status =
            imk_simulator_start(model, &settings->simulation, &t->simulator, memory, size, error);
    if (status == IMK_OK)
        status = stream(t, sink, job, error);
    imki_arena_free(&arena);
    return status;
}
