/* SPDX-License-Identifier: Apache-2.0 */
/* What instruments beside the unit read of its motion: truth and errors. The errors of an aid are
 * its own streams of random numbers, by kind: axes 0-2 white, 3-5 correlated, 6-8 the lever arm. */
#include "simulate_log_internal.h"

#include "jobs/arena_internal.h"
#include "jobs/job_internal.h"

#include "imukit/elementary.h"
#include "imukit/noise.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { BLOCK_ROWS = 1024, COLUMNS_OF_AID = 6, COLUMNS = 1 + COLUMNS_OF_AID * IMK_AIDS_MAX };

static const struct {
    const char *name[3], *unit;
    int decimals[3];
    const char *sigma[3], *sigma_unit;
} kinds[IMK_AID_KIND_COUNT] = {
    [IMK_AID_POSITION] = {{"latitude", "longitude", "height"},
                          "deg",
                          {10, 10, 4},
                          {"sigma_north", "sigma_east", "sigma_down"},
                          "m"},
    [IMK_AID_VELOCITY] = {{"velocity_north", "velocity_east", "velocity_down"},
                          "m/s",
                          {5, 5, 5},
                          {"sigma_velocity_north", "sigma_velocity_east", "sigma_velocity_down"},
                          "m/s"},
    [IMK_AID_HEADING] = {{"heading"}, "deg", {5}, {"sigma_heading"}, "deg"},
    [IMK_AID_HEIGHT] = {{"baro_height"}, "m", {4}, {"sigma_baro_height"}, "m"},
    [IMK_AID_ODOMETER] = {{"speed"}, "m/s", {5}, {"sigma_speed"}, "m/s"},
};

typedef struct state_of_aid {
    const imk_aid *aid;
    double correlated[3], arm[3];
} state_of_aid;

typedef struct aids {
    const imk_simulation *simulation;
    const imk_trajectory *trajectory;
    imk_random random;
    size_t count;
    state_of_aid aid[IMK_AIDS_MAX];
    double block[COLUMNS][BLOCK_ROWS];
} aids;

static size_t axes_written(imk_aid_kind kind)
{
    return kind == IMK_AID_POSITION || kind == IMK_AID_VELOCITY ? 3 : 1;
}

static double draw(const aids *a, imk_aid_kind kind, size_t axis, uint64_t index)
{
    double value;
    const uint64_t stream =
        imk_stream(a->simulation->run, IMK_TERM_AID, (uint8_t)kind, (uint8_t)axis);
    imk_random_normals(a->random, stream, index, 1, &value);
    return value;
}

/* ---- one reading ---------------------------------------------------------------------------- */

static void true_values(const imk_motion_state *m, imk_aid_kind kind, imk_vector3 arm,
                        double value[3])
{
    const imk_vector3 earth = {{0.0, 0.0, IMK_EARTH_RATE}};
    const imk_matrix3 c = imk_quaternion_to_matrix(m->attitude), back = imk_matrix3_transpose(c);
    const imk_vector3 rate = imk_vector3_subtract(m->angular_rate, imk_matrix3_apply(back, earth));
    const imk_vector3 swept = imk_vector3_cross(rate, arm);
    const imk_geodetic place =
        imk_geodetic_from_ecef(imk_vector3_add(m->position, imk_matrix3_apply(c, arm)));
    double roll, pitch;
    imk_vector3 velocity = {{0}};
    switch (kind) {
    case IMK_AID_POSITION:
        velocity = (imk_vector3){{place.latitude, place.longitude, place.height}};
        break;
    case IMK_AID_VELOCITY:
        velocity = imk_vector3_add(m->velocity_ned, imk_matrix3_apply(m->c_nb, swept));
        break;
    case IMK_AID_HEADING:
        imk_matrix3_to_euler(m->c_nb, &roll, &pitch, &velocity.v[0]);
        break;
    case IMK_AID_HEIGHT:
        velocity.v[0] = place.height;
        break;
    default:
        velocity = imk_vector3_add(imk_matrix3_apply(back, m->velocity), swept);
    }
    memcpy(value, velocity.v, sizeof velocity.v);
}

/* North and east in metres, as angles at a place. */
static void add_metres(double value[3], const double error[3])
{
    const imk_vector3 from = imk_ecef_from_geodetic((imk_geodetic){value[0], value[1], value[2]});
    const imk_matrix3 axes = imk_ned_axes(value[0], value[1]);
    const imk_geodetic there = imk_geodetic_from_ecef(imk_vector3_add(
        from, imk_matrix3_apply(axes, (imk_vector3){{error[0], error[1], error[2]}})));
    value[0] = there.latitude;
    value[1] = there.longitude;
    value[2] = there.height;
}

static void read_aid(aids *a, size_t k, uint64_t row, double value[3])
{
    state_of_aid *s = &a->aid[k];
    const imk_aid *aid = s->aid;
    const double time = aid->from + (double)row * aid->interval;
    const double decay =
        aid->correlation_time > 0.0 ? imk_exp(-aid->interval / aid->correlation_time) : 0.0;
    double error[3] = {0};
    imk_motion_state m;
    imk_trajectory_state(a->trajectory, time, &m);
    true_values(&m, aid->kind, (imk_vector3){{s->arm[0], s->arm[1], s->arm[2]}}, value);
    for (size_t axis = 0; axis < imk_aid_axes(aid->kind); axis++) {
        const double fresh = row == 0 ? 1.0 : sqrt(1.0 - decay * decay);
        s->correlated[axis] = decay * s->correlated[axis] + fresh * aid->correlated_sigma[axis] *
                                                                draw(a, aid->kind, 3 + axis, row);
        if (aid->sigma[axis] < (double)INFINITY)
            error[axis] = s->correlated[axis] + aid->sigma[axis] * draw(a, aid->kind, axis, row);
    }
    if (aid->kind == IMK_AID_POSITION)
        add_metres(value, error);
    else
        for (size_t axis = 0; axis < 3; axis++)
            value[axis] += error[axis];
    for (size_t axis = 0; axis < imk_aid_axes(aid->kind); axis++)
        if (!(aid->sigma[axis] < (double)INFINITY))
            value[axis] = (double)NAN;
}

/* ---- rows ----------------------------------------------------------------------------------- */

static size_t choose_columns(const aids *a, imk_log_column *columns, int *decimals)
{
    size_t count = 0;
    memset(columns, 0, COLUMNS * sizeof *columns);
    columns[count] = (imk_log_column){
        .name = "time", .quantity = IMK_QUANTITY_TIME, .axis = -1, .unit = imk_unit_of("s")};
    decimals[count++] = 6;
    for (size_t k = 0; k < a->count; k++) {
        const imk_aid_kind kind = a->aid[k].aid->kind;
        for (int sigma = 0; sigma < 2; sigma++)
            for (size_t axis = 0; axis < axes_written(kind); axis++, count++) {
                const char *unit = sigma ? kinds[kind].sigma_unit : kinds[kind].unit;
                columns[count].axis = -1;
                columns[count].unit =
                    imk_unit_of(!sigma && kind == IMK_AID_POSITION && axis == 2 ? "m" : unit);
                snprintf(columns[count].name, sizeof columns[count].name, "%s",
                         sigma ? kinds[kind].sigma[axis] : kinds[kind].name[axis]);
                decimals[count] = sigma ? 6 : kinds[kind].decimals[axis];
            }
    }
    return count;
}

static void fill_row(aids *a, uint64_t row, size_t at, double start)
{
    size_t column = 1;
    a->block[0][at] = start + a->aid[0].aid->from + (double)row * a->aid[0].aid->interval;
    for (size_t k = 0; k < a->count; k++) {
        const imk_aid *aid = a->aid[k].aid;
        double value[3];
        read_aid(a, k, row, value);
        for (size_t axis = 0; axis < axes_written(aid->kind); axis++)
            a->block[column++][at] = value[axis];
        for (size_t axis = 0; axis < axes_written(aid->kind); axis++)
            a->block[column++][at] =
                aid->sigma[axis] < (double)INFINITY ? aid->sigma[axis] : (double)NAN;
    }
}

static imk_status write_rows(aids *a, const imk_simulate_log_settings *settings,
                             const imk_record_sink *sink, const imk_job *job, imk_error *error)
{
    imk_log_column columns[COLUMNS];
    int decimals[COLUMNS];
    const double *data[COLUMNS];
    const imk_aid *first = a->aid[0].aid;
    const double length = (double)(settings->rows - 1) / settings->simulation.rate;
    const double end = first->until < length ? first->until : length;
    const double steps = (end - first->from) / first->interval;
    const uint64_t rows = steps >= 0.0 ? (uint64_t)(steps + 1e-9) + 1 : 0;
    for (size_t c = 0; c < COLUMNS; c++)
        data[c] = a->block[c];
    imk_status status = sink->begin(sink->context, choose_columns(a, columns, decimals), columns,
                                    decimals, rows, error);
    for (uint64_t row = 0; row < rows && status == IMK_OK; row += BLOCK_ROWS) {
        const size_t now = rows - row < BLOCK_ROWS ? (size_t)(rows - row) : BLOCK_ROWS;
        for (size_t k = 0; k < now; k++)
            fill_row(a, row + k, k, settings->start);
        status = sink->write(sink->context, now, data, job->executor, error);
        if (status == IMK_OK)
            status = imki_job_progress(job, "writing the aids", "rows", row + now, rows, error);
    }
    return status;
}

/* ---- all ------------------------------------------------------------------------------------ */

static imk_status check_aids(const imk_simulate_log_settings *settings, size_t count,
                             const imk_aid *aid, imk_error *error)
{
    if (count == 0 || count > IMK_AIDS_MAX)
        return imk_error_set(error, IMK_ERROR_RANGE, "aid_count", "", "1 to 8 aids");
    if (settings->simulation.motion.recorded)
        return imk_error_set(error, IMK_ERROR_UNSUPPORTED, "aids", "",
                             "a motion with positions: true rates and forces have none");
    if (!settings->simulation.earth && !settings->simulation.motion.trajectory)
        return imk_error_set(error, IMK_ERROR_CONFLICT, "aids", "", "a motion on the Earth");
    if (settings->simulation.motion.trajectory && !settings->simulation.motion.trajectory->earth)
        return imk_error_set(error, IMK_ERROR_CONFLICT, "aids", "", "a motion on the Earth");
    for (size_t k = 0; k < count; k++) {
        const imk_status status = imk_aid_validate(&aid[k], error);
        if (status != IMK_OK)
            return status;
        if (aid[k].kind == IMK_AID_ZERO_VELOCITY)
            return imk_error_set(error, IMK_ERROR_UNSUPPORTED, "aids", "zero velocity",
                                 "an aid that an instrument reads");
        if (aid[k].interval != aid[0].interval || aid[k].from != aid[0].from ||
            aid[k].until != aid[0].until)
            return imk_error_set(error, IMK_ERROR_CONFLICT, "interval", "",
                                 "the same times of all aids of a table");
    }
    return IMK_OK;
}

imk_status imk_simulate_aids_run(const imk_model *model, const imk_simulate_log_settings *settings,
                                 size_t aid_count, const imk_aid *aid, const imk_record_sink *sink,
                                 const imk_job *job, imk_error *error)
{
    job = imki_job_of(job);
    imk_status status = imki_simulate_check(model, settings, sink, error);
    if (status == IMK_OK)
        status = check_aids(settings, aid_count, aid, error);
    if (status != IMK_OK)
        return status;
    const imk_simulation *s = &settings->simulation;
    imki_arena arena = {.allocator = job->allocator};
    imk_trajectory_piece piece;
    imk_trajectory rest;
    aids *a = imki_arena_take(&arena, sizeof *a);
    if (!a)
        return imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
    a->simulation = s;
    a->trajectory = s->motion.trajectory ? s->motion.trajectory : &rest;
    a->random = imk_random_seeded(s->seed);
    a->count = aid_count;
    const double attitude[3] = {s->roll, s->pitch, s->yaw};
    const imk_geodetic place = {s->latitude, 0.0, s->height};
    if (!s->motion.trajectory)
        status = imk_trajectory_standstill(place, attitude, true, &piece, &rest, error);
    for (size_t k = 0; k < aid_count; k++) {
        a->aid[k].aid = &aid[k];
        for (size_t axis = 0; axis < 3; axis++)
            a->aid[k].arm[axis] =
                aid[k].lever_arm[axis] +
                aid[k].lever_arm_sigma[axis] * draw(a, IMK_AID_POSITION, 6 + axis, 0);
    }
    if (status == IMK_OK)
        status = write_rows(a, settings, sink, job, error);
    imki_arena_free(&arena);
    return status;
}
