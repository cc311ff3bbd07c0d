/* SPDX-License-Identifier: Apache-2.0 */
/* Monte Carlo: up to eight runs of a unit side by side, each simulated, aligned and navigated, in
 * blocks of 512 rows that stay in the cache.
 *
 * Row k of a simulation covers the interval that ends at k/rate, row 0 the one before the start.
 * The rows 1 … a are those of self-alignment, a = alignment_time rate rounded, at least 1 (none
 * when the attitude is given); navigation starts at the end of row a and takes the rows from a + 1
 * on, of dt = 1/rate whatever the true clock does. A time t of interest is seen at the end of row a
 * + floor(t rate + 1e-6), and compared with the truth at the instant when that row truly ended.
 *
 * Counts are divided by the sensitivity. A row that is lost repeats the one before it. */
#include "drift_aided_internal.h"
#include "drift_correlation_internal.h"
#include "drift_runs_internal.h"

#include "base/workspace_internal.h"
#include "drift_settings_internal.h"
#include "imukit/noise.h"
#include "navigate/alignment/alignment_internal.h"
#include "navigate/strapdown/strapdown_internal.h"
#include "simulate/simulate_internal.h"

#include <math.h>
#include <string.h>

enum {
    LANES = IMK_DRIFT_LANES,
    CHANNELS = 6,
    ROWS = IMK_NOISE_BLOCK /* of a block */
};

#define TURN_OF_ROW 1e-6 /* of a row: what rounding of t rate is given */
#define LOWEST 6000e3    /* from the centre of the Earth [m]: drift.h */
#define HIGHEST 10000e3

typedef struct run {
    uint32_t number;
    imk_simulator *simulator;
    double sum[CHANNELS];       /* of the rows of self-alignment */
    imk_navigation_state start; /* truth with the initial errors */
    double interval;            /* of rows in true time [s] */
    double *column[CHANNELS];   /* ROWS each */
    double held[CHANNELS];      /* the row before */
    double deflection[2];       /* of gravity, north and east, in the row before */
    bool gone;                  /* has left the Earth, or found no attitude */
} run;

/* All that one call works with. */
typedef struct crew {
    imk_strapdown_lanes lanes[LANES]; /* the first only, unless the runs' clocks differ */
    const imk_model *model;
    const imk_drift_settings *settings;
    imk_random random;
    imk_kernel kernel;
    double dt;
    uint64_t alignment_rows, last_row;
    const imk_trajectory *trajectory; /* with the standstill of the alignment before it */
    imk_trajectory padded;            /* that */
    imki_drift_motion_of motion;      /* without it */
    bool moves, slaved, clocks_differ;
    double start;                  /* of row 0 in the trajectory */
    imk_model *drawn;              /* model of a run with what calibration left */
    double *height, *climb, *time; /* ROWS each */
    imki_gravity_row *gravity;     /* ROWS; NULL: gravity is normal */
    size_t count;
    double correlation[IMKI_CORRELATION_FACTOR]; /* of what calibration left, factored */
    run run[LANES];
    size_t states;                         /* of a result: the errors, and of a filter more */
    imki_aided_run *aided;                 /* of each run; NULL: no aids */
    imk_navigation_filter_settings filter; /* of them */
} crew;

/* ---- memory ---- */

static imk_simulation simulation_of(const imk_drift_settings *settings,
                                    const imk_trajectory *trajectory)
{
    imk_simulation simulation = imk_simulation_default();
    simulation.rate = settings->rate;
    simulation.latitude = settings->latitude;
    simulation.height = settings->height;
    simulation.roll = settings->roll;
    simulation.pitch = settings->pitch;
    simulation.yaw = settings->yaw;
    simulation.motion.trajectory = trajectory;
    return simulation;
}

/* The largest that a simulator of this campaign can be: what calibration left of a warm-up varies
 * in time, even where the known one was 0. */
static size_t simulator_size(const imk_model *model, const imk_drift_settings *settings)
{
    imk_simulation simulation = simulation_of(settings, settings->motion);
    const imk_temperature_profile any = {.point_count = 0};
    if (settings->compensated &&
        (model->gyro.bias.warm_up_time.value > 0.0 || model->accel.bias.warm_up_time.value > 0.0))
        simulation.temperature = &any;
    return imki_aligned(imk_simulator_size(model, &simulation));
}

static size_t piece_count(const imk_drift_settings *settings)
{
    return settings->motion && settings->alignment == IMK_ALIGNED_SELF
               ? settings->motion->piece_count + 1
               : 0;
}

static size_t gravity_size(const imk_drift_settings *settings)
{
    return settings->gravity_deflection > 0.0 ? ROWS * sizeof(imki_gravity_row) : 0;
}

/* The filters of the runs, and what is needed to describe them. */
static size_t filters_size(const imk_model *model, const imk_drift_settings *settings)
{
    size_t filter;
    (void)imki_drift_filter_states(model, settings, &filter);
    return settings->aid_count == 0
               ? 0
               : LANES * (imki_aligned(sizeof(imki_aided_run)) + imki_aligned(filter)) +
                     imki_aligned(imki_drift_filter_scratch());
}

size_t imk_drift_runs_workspace_size(const imk_model *model, const imk_drift_settings *settings)
{
    const size_t run_size =
        imki_aligned(CHANNELS * ROWS * sizeof(double)) + simulator_size(model, settings);
    return imki_aligned(sizeof(crew)) + imki_aligned(sizeof(imk_model)) +
           imki_aligned(piece_count(settings) * sizeof(imk_trajectory_piece)) +
           imki_aligned(3 * ROWS * sizeof(double)) + imki_aligned(gravity_size(settings)) +
           LANES * run_size + filters_size(model, settings) + IMKI_ALIGNMENT_SLACK;
}

/* ---- start ---- */

static uint64_t row_of(double time, double rate)
{
    return (uint64_t)(time * rate + TURN_OF_ROW);
}

/* The motion, preceded by the standstill of the alignment. */
static void add_standstill(crew *c, imk_trajectory_piece *piece)
{
    const imk_trajectory *motion = c->settings->motion;
    const imk_trajectory_piece *first = &motion->piece[0];
    memset(piece, 0, sizeof *piece);
    piece->length = (double)c->alignment_rows * c->dt;
    piece->start = first->start - piece->length;
    for (int i = 0; i < 3; i++)
        piece->position[i][0] = first->position[i][0];
    for (int i = 0; i < 4; i++)
        piece->quaternion[i][0] = first->quaternion[i][0];
    memcpy(piece + 1, motion->piece, motion->piece_count * sizeof *piece);
    c->padded = *motion;
    c->padded.piece = piece;
    c->padded.piece_count = motion->piece_count + 1;
    c->trajectory = &c->padded;
}

static imk_status start_motion(crew *c, imki_parts *memory, imk_error *error)
{
    const size_t pieces = piece_count(c->settings);
    imk_trajectory_piece *piece = imki_take(memory, pieces * sizeof *piece);
    const imk_status status = imki_drift_motion(c->settings, &c->motion, error);
    c->moves = c->settings->motion != NULL;
    c->trajectory = &c->motion.trajectory;
    if (c->moves && pieces > 0)
        add_standstill(c, piece);
    c->start = c->moves ? c->trajectory->piece[0].start : 0.0;
    return status;
}

static imk_status start_run(crew *c, run *r, imki_parts *memory, imk_error *error)
{
    const imk_drift_settings *s = c->settings;
    const imk_model *model = c->model;
    double *columns = imki_take(memory, CHANNELS * ROWS * sizeof(double));
    for (size_t i = 0; i < CHANNELS; i++)
        r->column[i] = columns + i * ROWS;
    if (s->compensated) {
        *c->drawn = *c->model;
        imki_drift_residual(c->drawn, c->correlation, c->random, r->number);
        model = c->drawn;
    }
    r->interval = c->dt / (1.0 + model->timing.rate_error.value);
    imk_simulation simulation = simulation_of(s, c->moves ? c->trajectory : NULL);
    simulation.seed = c->random.seed;
    simulation.run = r->number;
    const size_t size = simulator_size(c->model, s);
    /* The motion is that of the settings, which are valid, or has been checked by the first run. */
    const bool checked = r != c->run || c->trajectory == &c->motion.trajectory;
    imk_status status = imki_simulator_start(imki_take(memory, size), size, model, &simulation,
                                             checked, &r->simulator, error);
    if (status != IMK_OK)
        return status;
    const double begin = imk_simulator_true_time(r->simulator, (int64_t)c->alignment_rows);
    const imk_navigation_state truth = imki_drift_truth(c->trajectory, begin, 0.0);
    r->start = imki_drift_displaced(&truth, s, c->random, r->number);
    return IMK_OK;
}

static imk_status start_filters(crew *c, imki_parts *memory, imk_error *error)
{
    size_t size;
    (void)imki_drift_filter_states(c->model, c->settings, &size);
    c->aided = imki_take(memory, LANES * sizeof *c->aided);
    for (size_t i = 0; i < LANES; i++)
        c->aided[i] = (imki_aided_run){.memory = imki_take(memory, size), .memory_size = size};
    return imki_drift_filter_settings(c->model, c->settings, &c->motion, &c->filter,
                                      imki_take(memory, imki_drift_filter_scratch()), error);
}

static imk_status start(crew *c, uint32_t first, imki_parts *memory, imk_error *error)
{
    const imk_drift_settings *s = c->settings;
    c->drawn = imki_take(memory, sizeof *c->drawn);
    c->height = imki_take(memory, 3 * ROWS * sizeof(double));
    if (s->gravity_deflection > 0.0)
        c->gravity = imki_take(memory, gravity_size(s));
    c->climb = c->height + ROWS;
    c->time = c->climb + ROWS;
    c->kernel = c->random.kernel;
    c->dt = 1.0 / s->rate;
    c->slaved = imk_drift_vertical(s) == IMK_VERTICAL_SLAVED;
    if (s->alignment == IMK_ALIGNED_SELF) {
        c->alignment_rows = (uint64_t)(s->alignment_time * s->rate + 0.5);
        c->alignment_rows += c->alignment_rows == 0;
    }
    c->last_row = c->alignment_rows + row_of(s->time[s->time_count - 1], s->rate);
    if (s->compensated)
        (void)imki_correlation_factor(&c->model->correlation, c->correlation); /* was checked */
    imk_status status = start_motion(c, memory, error);
    if (status == IMK_OK && s->aid_count > 0)
        status = start_filters(c, memory, error);
    for (size_t i = 0; i < c->count && status == IMK_OK; i++) {
        c->run[i].number = first + (uint32_t)i;
        status = start_run(c, &c->run[i], memory, error);
        c->clocks_differ = c->clocks_differ || c->run[i].interval != c->run[0].interval;
    }
    /* Only true heights depend on the clock. */
    c->clocks_differ = c->clocks_differ && c->moves && c->slaved;
    for (size_t k = 0; k < ROWS && !c->moves; k++) {
        c->height[k] = s->height;
        c->climb[k] = 0.0;
    }
    return status;
}

/* ---- readings ---- */

static void divide_counts(const imk_triad *triad, double *const *column)
{
    for (int i = 0; i < 3; i++) {
        const double sensitivity = triad->sensitivity.value[i];
        const double offset = triad->zero_offset.value[i];
        if (sensitivity != 0.0)
            for (size_t k = 0; k < ROWS; k++)
                column[i][k] = (column[i][k] - offset) / sensitivity;
    }
}

/* Row 0 is there always: it stands for what was before. */
static void hold_lost(run *r, uint64_t first)
{
    for (size_t k = 0; k < ROWS; k++) {
        const bool lost = first + k > 0 && imk_simulator_dropped(r->simulator, first + k);
        for (int i = 0; i < CHANNELS; i++)
            if (lost)
                r->column[i][k] = r->held[i];
            else
                r->held[i] = r->column[i][k];
    }
}

/* The block of rows that begins at `first`, of every run. */
static void make_block(crew *c, uint64_t first)
{
    imk_simulator *simulators[LANES];
    double *const *columns[LANES];
    for (size_t i = 0; i < c->count; i++) {
        simulators[i] = c->run[i].simulator;
        columns[i] = c->run[i].column;
    }
    imki_simulators_next(c->count, simulators, 1, columns);
    if (c->gravity)
        imki_gravity_rows(c->settings, c->trajectory, c->start, c->run[0].interval, first, ROWS,
                          c->gravity);
    for (size_t i = 0; i < c->count; i++) {
        run *r = &c->run[i];
        divide_counts(&c->model->gyro, r->column);
        divide_counts(&c->model->accel, r->column + 3);
        if (c->model->timing.drops.value > 0.0)
            hold_lost(r, first);
        if (c->gravity)
            imki_gravity_deflect(c->settings, c->random, r->number, first, ROWS, c->gravity,
                                 r->deflection, r->column + 3);
    }
}

/* ---- alignment ---- */

static void add_to_means(crew *c, size_t from, size_t to)
{
    for (size_t i = 0; i < c->count; i++)
        for (int j = 0; j < CHANNELS; j++)
            for (size_t k = from; k < to; k++)
                c->run[i].sum[j] += c->run[i].column[j][k];
}

/* North-east-down are the axes where the navigator believes to be. A run that finds no attitude is
 * none. */
static void finish_alignment(crew *c)
{
    const double count = (double)c->alignment_rows;
    for (size_t i = 0; i < c->count; i++) {
        run *r = &c->run[i];
        const double *sum = r->sum;
        const imk_vector3 rate = {{sum[0] / count, sum[1] / count, sum[2] / count}};
        const imk_vector3 force = {{sum[3] / count, sum[4] / count, sum[5] / count}};
        const imk_geodetic place = imk_geodetic_from_ecef(r->start.position);
        imk_matrix3 c_nb = imk_matrix3_identity();
        r->gone = imki_alignment_of_means(force, rate, place, &c_nb) != IMK_OK;
        r->start.attitude = imk_quaternion_from_matrix(
            imk_matrix3_multiply(imk_ned_axes(place.latitude, place.longitude), c_nb));
    }
}

/* ---- navigation ---- */

/* Run of a lane: spare lanes repeat the first. */
static size_t run_of(const crew *c, size_t lane)
{
    return lane < c->count ? lane : 0;
}

static void start_lanes(crew *c)
{
    for (size_t i = 0; i < c->count && c->aided; i++) /* the settings have been checked */
        if (imki_aided_run_start(&c->aided[i], c->settings, &c->filter, &c->run[i].start, c->random,
                                 c->run[i].number, NULL) != IMK_OK)
            c->run[i].gone = true;
    if (c->aided)
        return;
    for (size_t i = 0; i < (c->clocks_differ ? c->count : 1); i++)
        for (size_t lane = 0; lane < LANES; lane++) {
            const size_t from = c->clocks_differ ? i : run_of(c, lane);
            imk_strapdown_lanes_start(&c->lanes[i], lane, &c->run[from].start, c->slaved);
        }
}

static imk_navigation_state state_of(const crew *c, size_t i)
{
    if (c->aided)
        return imk_navigation_filter_state(c->aided[i].filter);
    return c->clocks_differ ? imk_strapdown_lanes_state(&c->lanes[i], 0)
                            : imk_strapdown_lanes_state(&c->lanes[0], i);
}

/* True heights at the ends of rows `first` … of a run, without the jitter of its clock: of those
 * that the lanes use. */
static void make_heights(crew *c, const run *r, const imk_strapdown_lanes *lanes, uint64_t first,
                         size_t rows)
{
    size_t row[ROWS];
    if (!c->moves || !c->slaved)
        return;
    const size_t count = imki_lanes_heights(lanes, c->dt, rows, row);
    for (size_t i = 0; i < count; i++)
        c->time[i] = c->start + (double)(first + row[i]) * r->interval;
    imki_drift_heights(c->trajectory, count, row, c->time, c->height, c->climb);
}

/* Rows from … to - 1 of the block that begins at `first`. */
static void navigate(crew *c, uint64_t first, size_t from, size_t to)
{
    const double *channel[LANES][CHANNELS];
    const double *height = c->slaved ? c->height : NULL, *climb = c->slaved ? c->climb : NULL;
    if (from >= to)
        return;
    for (size_t i = 0; i < c->count && c->aided; i++)
        if (!c->run[i].gone)
            imki_aided_run_take(&c->aided[i],
                                &(imki_aided_rows){.trajectory = c->trajectory,
                                                   .simulator = c->run[i].simulator,
                                                   .column = c->run[i].column,
                                                   .dt = c->dt,
                                                   .start = c->start,
                                                   .interval = c->run[i].interval,
                                                   .moves = c->moves,
                                                   .height = c->height,
                                                   .climb = c->climb,
                                                   .time = c->time,
                                                   .first = first,
                                                   .before = c->alignment_rows},
                                from, to);
    for (size_t i = 0; i < (c->clocks_differ ? c->count : 1) && !c->aided; i++) {
        for (size_t lane = 0; lane < LANES; lane++)
            for (size_t j = 0; j < CHANNELS; j++)
                channel[lane][j] = c->run[c->clocks_differ ? i : run_of(c, lane)].column[j] + from;
        make_heights(c, &c->run[i], &c->lanes[i], first + from, to - from);
        imk_strapdown_lanes_run(&c->lanes[i], c->kernel, to - from, c->dt,
                                (const double *const(*)[CHANNELS])channel, height, climb);
    }
    for (size_t i = 0; i < c->count; i++) {
        if (c->aided && c->run[i].gone)
            continue;
        const imk_navigation_state state = state_of(c, i);
        const double radius = imk_vector3_norm(state.position);
        c->run[i].gone = c->run[i].gone || !(radius >= LOWEST && radius <= HIGHEST);
    }
}

/* Errors of every run at the end of a row. errors[run * stride + state] */
static void look(const crew *c, uint64_t row, size_t stride, double *errors)
{
    for (size_t i = 0; i < c->count; i++) {
        const run *r = &c->run[i];
        double *out = errors + i * stride;
        if (r->gone) {
            for (size_t j = 0; j < c->states; j++)
                out[j] = (double)NAN;
            continue;
        }
        const double time = imk_simulator_true_time(r->simulator, (int64_t)row);
        const imk_navigation_state truth = imki_drift_truth(c->trajectory, time, 0.0);
        const imk_navigation_state state = state_of(c, i);
        imki_drift_errors(&state, &truth, c->settings->attitude_errors, out);
        if (c->states > IMK_DRIFT_STATES)
            out[IMK_DRIFT_STATES] = imki_aided_run_nees(&c->aided[i], &truth);
    }
}

/* ---- all of it ---- */

static void compute(crew *c, double *errors)
{
    const imk_drift_settings *s = c->settings;
    const size_t stride = s->time_count * c->states;
    const uint64_t begin = c->alignment_rows + 1; /* first row of navigation */
    size_t seen = 0;
    if (c->alignment_rows == 0)
        start_lanes(c);
    for (uint64_t first = 0; first <= c->last_row && seen < s->time_count; first += ROWS) {
        const uint64_t end = first + ROWS;
        make_block(c, first);
        uint64_t row = first > 0 ? first : 1; /* to be used next */
        if (row < begin) {
            const uint64_t stop = begin < end ? begin : end;
            add_to_means(c, (size_t)(row - first), (size_t)(stop - first));
            row = stop;
            if (row < begin)
                continue;
            finish_alignment(c);
            start_lanes(c);
        }
        for (; seen < s->time_count; seen++) {
            const uint64_t last = c->alignment_rows + row_of(s->time[seen], s->rate);
            if (last >= end)
                break;
            navigate(c, first, (size_t)(row - first), (size_t)(last + 1 - first));
            row = last + 1;
            look(c, last, stride, errors + seen * c->states);
        }
        if (seen < s->time_count)
            navigate(c, first, (size_t)(row - first), ROWS);
    }
}

static imk_status run_all(const imk_model *model, const imk_drift_settings *settings, uint64_t seed,
                          uint32_t first, size_t count, size_t states, double *errors,
                          void *workspace, size_t workspace_size, imk_error *error)
{
    imk_status status = imk_drift_validate(model, settings, error);
    if (status != IMK_OK)
        return status;
    if (!(count >= 1 && count <= LANES) || count - 1 > UINT32_MAX - first)
        return imk_error_set(error, IMK_ERROR_RANGE, "count", "",
                             "1 to 8 runs with numbers below 2^32");
    if (!workspace)
        return imk_error_set(error, IMK_ERROR_ARGUMENT, "workspace", "", "a workspace");
    if (workspace_size < imk_drift_runs_workspace_size(model, settings))
        return imk_error_set(error, IMK_ERROR_WORKSPACE, "workspace", "",
                             "imk_drift_runs_workspace_size() bytes");
    imki_parts rest = imki_parts_of(workspace);
    crew *c = imki_take(&rest, sizeof *c);
    memset(c, 0, sizeof *c);
    c->model = model;
    c->settings = settings;
    c->random = imk_random_seeded(seed);
    c->count = count;
    c->states = states;
    status = start(c, first, &rest, error);
    if (status == IMK_OK)
        compute(c, errors);
    return status;
}

imk_status imk_drift_runs(const imk_model *model, const imk_drift_settings *settings, uint64_t seed,
                          uint32_t first, size_t count, double *errors, void *workspace,
                          size_t workspace_size, imk_error *error)
{
    return run_all(model, settings, seed, first, count, IMK_DRIFT_STATES, errors, workspace,
                   workspace_size, error);
}

imk_status imk_drift_aided_runs(const imk_model *model, const imk_drift_settings *settings,
                                uint64_t seed, uint32_t first, size_t count, double *errors,
                                void *workspace, size_t workspace_size, imk_error *error)
{
    if (settings->aid_count == 0)
        return imk_error_set(error, IMK_ERROR_ARGUMENT, "aid_count", "", "at least one aid");
    return run_all(model, settings, seed, first, count, IMK_DRIFT_AIDED_STATES, errors, workspace,
                   workspace_size, error);
}
