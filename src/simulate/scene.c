/* SPDX-License-Identifier: Apache-2.0 */
/* What the unit is exposed to: true motion, temperature and its history, over parts of samples.
 *
 * With r the clock's rate error, n[k] normals and M parts to a sample, row k ends at
 *
 *     b[k] = k dt/(1 + r) + jitter n[k],
 *
 * and covers b[k-1] … b[k] in M equal parts. Temperature and warm-up, which are slow, are taken in
 * the middle of a part without jitter. Nothing here depends on how rows are divided into stretches.
 */
#include "base/refuse_internal.h"
#include "model/distort_internal.h"
#include "simulate_internal.h"

#include <string.h>

static bool moves(const imk_simulation *simulation)
{
    return simulation->motion.recorded || simulation->motion.trajectory;
}

static bool has_field(const imk_simulation *simulation)
{
    const double *field = simulation->field;
    return field[0] != 0.0 || field[1] != 0.0 || field[2] != 0.0;
}

static bool has_lever_arm(const imk_triad *triad)
{
    for (int i = 0; triad->present && i < triad->axis_count; i++)
        for (int j = 0; j < 3; j++)
            if (triad->lever_arm.value[i][j] != 0.0)
                return true;
    return false;
}

size_t imki_substeps(const imk_model *model, const imk_simulation *simulation)
{
    /* Between its parts a signal that the filter sees is taken as constant: with eight of them the
     * amplitude at a twentieth of the sample rate is right to (pi 0.05/8)^2/3 = 1.3e-4. */
    enum { FILTERED = 8 };
    const imk_triad *gyro = &model->gyro, *accel = &model->accel;
    size_t substeps = simulation->substeps;
    if (substeps > 0 || simulation->motion.recorded || !moves(simulation))
        return substeps > 0 ? substeps : 1;
    substeps = imk_trajectory_substeps(simulation->motion.trajectory, 1.0 / simulation->rate);
    const bool magnetic =
        has_field(simulation) && imki_triad_has(&model->mag, &model->mag.bandwidth);
    if ((imki_triad_has(gyro, &gyro->bandwidth) || imki_triad_has(accel, &accel->bandwidth) ||
         magnetic) &&
        substeps < FILTERED)
        substeps = FILTERED;
    return substeps < IMK_SUBSTEPS_MAX ? substeps : IMK_SUBSTEPS_MAX;
}

bool imki_scene_varies(const imk_model *model, const imk_simulation *simulation)
{
    return moves(simulation) || simulation->temperature ||
           imki_triad_has(&model->gyro, &model->gyro.bias.warm_up_amplitude) ||
           imki_triad_has(&model->accel, &model->accel.bias.warm_up_amplitude) ||
           (has_field(simulation) &&
            imki_triad_has(&model->mag, &model->mag.bias.warm_up_amplitude));
}

/* ---- start ---- */

static imk_status conflict(imk_error *error, const char *field, const char *expected)
{
    return imk_error_set(error, IMK_ERROR_CONFLICT, field, "", expected);
}

static imk_status check_recorded(const imk_model *model, const imk_simulation *simulation,
                                 imk_error *error)
{
    const imk_recorded_motion *recorded = simulation->motion.recorded;
    const imk_timing *timing = &model->timing;
    if (simulation->motion.trajectory)
        return conflict(error, "motion", "give either a trajectory or a recorded motion");
    if (has_field(simulation))
        return conflict(
            error, "motion",
            "a trajectory: a recorded motion has no attitude, which a magnetometer needs");
    if (recorded->count == 0)
        return imk_error_set(error, IMK_ERROR_EMPTY, "motion", "", "at least one recorded sample");
    if (!(fabs(recorded->rate - simulation->rate) <= 1e-6 * simulation->rate))
        return conflict(error, "rate", "use the sample rate of the recorded motion");
    if (simulation->substeps > 1)
        return conflict(error, "substeps", "1 for a recorded motion: its samples are means");
    if (timing->rate_error.value != 0.0 || timing->jitter.value != 0.0 || timing->skew.value != 0.0)
        return conflict(error, "timing",
                        "a model without clock errors: a recorded motion is known at its samples "
                        "only");
    return IMK_OK;
}

static imk_status check_timing(const imk_model *model, const imk_simulation *simulation,
                               imk_error *error)
{
    /* Normals stay below 7.54: so boundaries cannot change places. */
    if (model->timing.jitter.value * simulation->rate <= 1.0 / 16.0)
        return IMK_OK;
    return imki_refuse(error, IMK_ERROR_RANGE, "timing.jitter", model->timing.jitter.value,
                       1.0 / 16.0 / simulation->rate,
                       "a jitter of at most 1/16 of the sample interval");
}

static imk_status start_motion(imki_scene *e, const imk_model *model,
                               const imk_simulation *simulation, bool checked, imk_error *error)
{
    e->recorded = simulation->motion.recorded;
    e->trajectory = simulation->motion.trajectory;
    if (e->recorded)
        return check_recorded(model, simulation, error);
    imk_status status = check_timing(model, simulation, error);
    if (status != IMK_OK)
        return status;
    if (e->trajectory) {
        double last;
        imk_trajectory_span(e->trajectory, &e->start, &last);
        return checked ? IMK_OK : imk_trajectory_validate(e->trajectory, error);
    }
    const imk_simulation *s = simulation;
    const double roll_pitch_yaw[3] = {s->roll, s->pitch, s->yaw};
    e->trajectory = &e->rest;
    return imk_trajectory_standstill((imk_geodetic){s->latitude, 0.0, s->height}, roll_pitch_yaw,
                                     s->earth, &e->rest_piece, &e->rest, error);
}

static void assign_columns(imki_scene *e, double *memory)
{
    for (int i = 0; i < IMKI_COLUMNS; i++)
        e->column[i] = memory + (size_t)i * IMKI_STRETCH;
    e->warm_up_table = memory + (size_t)IMKI_COLUMNS * IMKI_STRETCH;
    e->boundary = e->warm_up_table + IMK_KINDS * (size_t)IMK_NOISE_BLOCK;
}

/* The motion of a unit at rest, in every element. */
static void fill_rest(imki_scene *e, double *const *column, size_t count)
{
    imk_motion_state state;
    imk_trajectory_state(e->trajectory, e->start, &state);
    double field[3];
    imki_field_at(e, e->start, field);
    for (int i = 0; i < 3; i++)
        for (size_t k = 0; k < count; k++) {
            column[IMKI_RATE + i][k] = state.angular_rate.v[i];
            column[IMKI_FORCE + i][k] = state.specific_force.v[i];
            column[IMKI_ACCELERATION + i][k] = 0.0;
            column[IMKI_FIELD + i][k] = field[i];
        }
}

static imk_stimulus stimulus_of(const imki_scene *e, double *const *column, int motion)
{
    imk_stimulus s = {.temperature = NULL};
    for (int i = 0; i < 3; i++) {
        s.angular_rate[i] = column[motion + IMKI_RATE + i];
        s.specific_force[i] = column[motion + IMKI_FORCE + i];
        if (e->needs_acceleration)
            s.angular_acceleration[i] = column[motion + IMKI_ACCELERATION + i];
    }
    if (e->temperature) {
        s.temperature = column[IMKI_TEMPERATURE];
        s.temperature_rate = column[IMKI_TEMPERATURE_RATE];
    }
    for (int i = 0; i < 2; i++) {
        if (e->temperature && e->hysteresis_present[i])
            s.hysteresis[i] = column[IMKI_HYSTERESIS + (e->same_hysteresis ? 0 : i)];
        if (e->warm_up_present[i])
            s.warm_up[i] = column[IMKI_WARM_UP + (e->same_warm_up ? 0 : i)];
    }
    return s;
}

/* The field in place of the force, and what warms this kind of sensor in the place of an
 * accelerometer's. */
static imk_stimulus magnetic_stimulus(const imki_scene *e, double *const *column)
{
    imk_stimulus s = stimulus_of(e, column, 0);
    for (int i = 0; i < 3; i++) {
        s.specific_force[i] = column[IMKI_FIELD + i];
        s.angular_acceleration[i] = NULL;
    }
    s.hysteresis[IMK_ACCEL] =
        e->temperature && e->hysteresis_present[IMK_MAG] ? column[IMKI_HYSTERESIS + IMK_MAG] : NULL;
    s.warm_up[IMK_ACCEL] = e->warm_up_present[IMK_MAG] ? column[IMKI_WARM_UP + IMK_MAG] : NULL;
    return s;
}

static void start_triad(imki_scene *e, const imk_triad *triad, int sensor)
{
    e->warm_up_present[sensor] = imki_triad_has(triad, &triad->bias.warm_up_amplitude);
    e->warm_up_time[sensor] = triad->bias.warm_up_time.value;
    e->same_warm_up =
        e->warm_up_present[0] && e->warm_up_present[1] && e->warm_up_time[0] == e->warm_up_time[1];
    double part = e->interval / (double)e->substeps;
    const bool needs_table = e->warm_up_present[sensor] && (!e->same_warm_up || sensor == IMK_MAG);
    for (size_t i = 0; needs_table && i < IMK_NOISE_BLOCK; i++)
        e->warm_up_table[(size_t)sensor * IMK_NOISE_BLOCK + i] =
            imki_warm_up_within(i, part, e->warm_up_time[sensor]);
    e->hysteresis_present[sensor] = imki_triad_has(triad, &triad->bias.hysteresis);
    e->hysteresis[sensor] = imk_hysteresis_start(triad);
}

imk_status imki_scene_start(imki_scene *e, const imk_model *model, const imk_simulation *simulation,
                            bool checked, imki_parts *memory, imk_error *error)
{
    *e = (imki_scene){.random = imk_random_seeded(simulation->seed),
                      .temperature = simulation->temperature,
                      .jitter = model->timing.jitter.value,
                      .skew = model->timing.skew.value,
                      .has_field = model->mag.present && has_field(simulation)};
    memcpy(e->field, simulation->field, sizeof e->field);
    e->kernel = e->random.kernel;
    e->jitter_stream = imk_stream(simulation->run, IMK_TERM_JITTER, 0, 0);
    imk_status status = start_motion(e, model, simulation, checked, error);
    if (status == IMK_OK && e->temperature)
        status = imk_temperature_validate(e->temperature, error);
    if (status != IMK_OK)
        return status;
    e->interval = 1.0 / simulation->rate / (1.0 + model->timing.rate_error.value);
    e->substeps = imki_substeps(model, simulation);
    e->motion_varies = moves(simulation);
    e->varies = imki_scene_varies(model, simulation);
    e->needs_acceleration = e->motion_varies && has_lever_arm(&model->accel);
    if (!e->varies)
        return IMK_OK;
    assign_columns(e, imki_take(memory, IMKI_SCENE_SIZE));
    for (int sensor = 0; sensor < 2; sensor++)
        start_triad(e, sensor == IMK_GYRO ? &model->gyro : &model->accel, sensor);
    if (e->has_field)
        start_triad(e, &model->mag, IMK_MAG);
    e->same_hysteresis = e->hysteresis_present[0] && e->hysteresis_present[1] &&
                         e->hysteresis[0].span == e->hysteresis[1].span;
    e->still = !e->motion_varies && !e->temperature && e->substeps == 1;
    if (!e->motion_varies)
        fill_rest(e, e->column, e->still ? (size_t)IMKI_CHUNK : (size_t)IMKI_STRETCH);
    e->stimulus[IMK_GYRO] = stimulus_of(e, e->column, 0);
    e->stimulus[IMK_ACCEL] =
        stimulus_of(e, e->column, e->skew != 0.0 && e->motion_varies ? IMKI_LATE : 0);
    if (e->has_field)
        e->stimulus[IMK_MAG] = magnetic_stimulus(e, e->column);
    return IMK_OK;
}

bool imki_scenes_agree(const imki_scene *a, const imki_scene *b)
{
    /* At rest each has its own trajectory, and what follows the temperature a state. */
    if (!a->trajectory || a->trajectory != b->trajectory || a->temperature || b->temperature)
        return false;
    if (a->has_field != b->has_field)
        return false;
    for (int i = 0; i < 3; i++)
        if (a->field[i] != b->field[i])
            return false;
    for (int i = 0; i < IMK_KINDS; i++)
        if (a->warm_up_present[i] != b->warm_up_present[i] ||
            (a->warm_up_present[i] && a->warm_up_time[i] != b->warm_up_time[i]))
            return false;
    return a->start == b->start && a->interval == b->interval && a->jitter == 0.0 &&
           b->jitter == 0.0 && a->skew == b->skew && a->substeps == b->substeps &&
           a->needs_acceleration == b->needs_acceleration;
}

/* ---- motion ---- */

double imki_row_end(const imki_scene *e, int64_t row)
{
    double normal = 0.0;
    if (e->jitter > 0.0)
        imk_random_normals(e->random, e->jitter_stream, (uint64_t)(row + 1), 1, &normal);
    return (double)row * e->interval + e->jitter * normal;
}

/* Ends of the parts of rows first …: count + 1 times. Row -1 has jitter 0 of the stream. */
static void make_boundaries(imki_scene *e, uint64_t first, size_t rows)
{
    enum { AT_ONCE = 256 };
    double normal[AT_ONCE + 1] = {0.0};
    const double parts = (double)e->substeps;
    for (size_t row = 0; row < rows; row += AT_ONCE) {
        size_t now = rows - row < AT_ONCE ? rows - row : AT_ONCE;
        if (e->jitter > 0.0)
            imk_random_normals(e->random, e->jitter_stream, first + row, now + 1, normal);
        for (size_t k = 0; k < now; k++) {
            double number = (double)(first + row + k);
            double begin = e->start + ((number - 1.0) * e->interval + e->jitter * normal[k]);
            double end = e->start + (number * e->interval + e->jitter * normal[k + 1]);
            double *boundary = e->boundary + (row + k) * e->substeps;
            for (size_t j = 0; j < e->substeps; j++)
                boundary[j] = begin + (end - begin) * ((double)j / parts);
            boundary[e->substeps] = end;
        }
    }
}

typedef struct motion_work {
    imki_scene *scene;
    size_t count;
    const double *boundary;
    int motion;
} motion_work;

/* The means of up to a block of parts: one work item. */
static void run_motion(void *context, size_t item)
{
    const motion_work *work = context;
    imki_scene *e = work->scene;
    size_t first = item * IMK_NOISE_BLOCK;
    size_t count = work->count - first < IMK_NOISE_BLOCK ? work->count - first : IMK_NOISE_BLOCK;
    double *rate[3], *force[3], *acceleration[3];
    for (int i = 0; i < 3; i++) {
        rate[i] = e->column[work->motion + IMKI_RATE + i] + first;
        force[i] = e->column[work->motion + IMKI_FORCE + i] + first;
        acceleration[i] = e->column[work->motion + IMKI_ACCELERATION + i] + first;
    }
    imk_trajectory_means(e->trajectory, e->kernel, count, work->boundary + first, rate,
                         e->needs_acceleration ? acceleration : NULL, force);
}

void imki_field_at(const imki_scene *e, double time, double field[3])
{
    imk_motion_state state;
    imk_trajectory_state(e->trajectory, time, &state);
    for (int i = 0; i < 3; i++) {
        field[i] = 0.0;
        for (int j = 0; j < 3; j++)
            field[i] += state.c_nb.m[j][i] * e->field[j];
    }
}

/* The field in the middle of up to a block of parts. */
static void run_field(void *context, size_t item)
{
    const motion_work *work = context;
    imki_scene *e = work->scene;
    const size_t first = item * IMK_NOISE_BLOCK, left = work->count - first;
    for (size_t k = first; k < first + (left < IMK_NOISE_BLOCK ? left : IMK_NOISE_BLOCK); k++) {
        double field[3];
        imki_field_at(e, 0.5 * (work->boundary[k] + work->boundary[k + 1]), field);
        for (int i = 0; i < 3; i++)
            e->column[IMKI_FIELD + i][k] = field[i];
    }
}

static void fill_trajectory(imki_scene *e, uint64_t first, size_t rows,
                            const imk_executor *executor)
{
    const size_t count = rows * e->substeps,
                 items = (count + IMK_NOISE_BLOCK - 1) / IMK_NOISE_BLOCK;
    make_boundaries(e, first, rows);
    motion_work work = {e, count, e->boundary, 0};
    imk_execute(executor, items, run_motion, &work);
    if (e->has_field)
        imk_execute(executor, items, run_field, &work);
    if (e->skew == 0.0)
        return;
    for (size_t i = 0; i <= count; i++)
        e->boundary[i] -= e->skew;
    work.motion = IMKI_LATE;
    imk_execute(executor, items, run_motion, &work);
}

/* Derivative of recorded rates at sample k: from both neighbours, at the ends from the one. */
static double slope(const imk_recorded_motion *recorded, const double *rate, size_t k)
{
    size_t before = k > 0 ? k - 1 : 0, after = k + 1 < recorded->count ? k + 1 : k;
    if (after == before)
        return 0.0;
    return (rate[after] - rate[before]) * (recorded->rate / (double)(after - before));
}

/* Rows that are there are used where they stand. Beyond its end, which whole blocks may pass, a
 * recorded motion stays as it was last: such rows are copied. */
static void fill_recorded(imki_scene *e, uint64_t first, size_t rows)
{
    const imk_recorded_motion *r = e->recorded;
    const bool inside = first + rows <= r->count;
    for (int i = 0; i < 3; i++) {
        double *rate = e->column[IMKI_RATE + i], *force = e->column[IMKI_FORCE + i];
        double *acceleration = e->column[IMKI_ACCELERATION + i];
        const double *given = r->angular_acceleration[i];
        for (size_t k = 0; k < rows && (!inside || (e->needs_acceleration && !given)); k++) {
            size_t row = first + k < r->count ? (size_t)(first + k) : r->count - 1;
            rate[k] = r->angular_rate[i][row];
            force[k] = r->specific_force[i][row];
            acceleration[k] = given ? given[row] : slope(r, r->angular_rate[i], row);
        }
        for (int sensor = 0; sensor < 2; sensor++) {
            imk_stimulus *s = &e->stimulus[sensor];
            s->angular_rate[i] = inside ? r->angular_rate[i] + first : rate;
            s->specific_force[i] = inside ? r->specific_force[i] + first : force;
            if (e->needs_acceleration)
                s->angular_acceleration[i] = inside && given ? given + first : acceleration;
        }
    }
}

/* ---- temperature ---- */

static void fill_temperature(imki_scene *e, uint64_t first, size_t count)
{
    const double part = e->interval / (double)e->substeps;
    const double begin = (double)first, parts = (double)e->substeps;
    double *time = e->column[IMKI_TIME], *temperature = e->column[IMKI_TEMPERATURE];
    for (size_t i = 0; i < count; i++)
        time[i] = ((begin + (double)(int)i) + 0.5 - parts) * part;
    imk_temperature_at(e->temperature, count, time, temperature, e->column[IMKI_TEMPERATURE_RATE]);
    for (int sensor = 0; sensor < IMK_KINDS; sensor++)
        if (e->hysteresis_present[sensor] && !(sensor == IMK_ACCEL && e->same_hysteresis))
            imk_hysteresis_next(&e->hysteresis[sensor], count, temperature,
                                e->column[IMKI_HYSTERESIS + sensor]);
}

/* Anchored at multiples of 512 parts. */
static void fill_warm_up(imki_scene *e, int sensor, uint64_t first, size_t count)
{
    const double part = e->interval / (double)e->substeps;
    const double *table = e->warm_up_table + (size_t)sensor * IMK_NOISE_BLOCK;
    double *out = e->column[IMKI_WARM_UP + sensor];
    for (size_t i = 0; i < count;) {
        size_t within = (size_t)((first + i) % IMK_NOISE_BLOCK);
        double begin =
            imki_warm_up_block(first + i - within, e->substeps, part, e->warm_up_time[sensor]);
        for (; within < IMK_NOISE_BLOCK && i < count; within++, i++)
            out[i] = begin * table[within];
    }
}

void imki_scene_fill(imki_scene *e, uint64_t first, size_t rows, const imk_executor *executor)
{
    const uint64_t part = first * e->substeps;
    const size_t count = rows * e->substeps;
    if (e->recorded)
        fill_recorded(e, first, rows);
    else if (e->motion_varies)
        fill_trajectory(e, first, rows, executor);
    if (e->temperature)
        fill_temperature(e, part, count);
    for (int sensor = 0; sensor < IMK_KINDS; sensor++)
        if (e->warm_up_present[sensor] && !(sensor == IMK_ACCEL && e->same_warm_up))
            fill_warm_up(e, sensor, part, count);
}
