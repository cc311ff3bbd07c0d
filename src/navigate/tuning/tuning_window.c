/* SPDX-License-Identifier: Apache-2.0 */
/* One window: the errors of increments from its start, sample after sample, of every source of the
 * model and of every number of a filter. */
#include "tuning_internal.h"

#include "base/algebra/vector_internal.h"

#include <math.h>
#include <string.h>

/* ---- the sample ---- */

/* What an error of a reading does, turned by the attitude c in the middle of the sample. */
static void fill_columns(const imk_matrix3 *middle, imki_tuning_sample *sample)
{
    for (int axis = 0; axis < 3; axis++) {
        double c[3], lever[3];
        for (int i = 0; i < 3; i++)
            c[i] = middle->m[i][axis] * sample->h;
        imki_cross3(sample->v, c, lever);
        for (int i = 0; i < 3; i++) {
            double *of_gyro = sample->gamma[IMK_GYRO][axis];
            double *of_accel = sample->gamma[IMK_ACCEL][axis];
            of_gyro[i] = c[i];
            of_gyro[3 + i] = -0.5 * lever[i];
            of_gyro[6 + i] = -0.25 * sample->h * lever[i];
            of_accel[i] = 0.0;
            of_accel[3 + i] = c[i];
            of_accel[6 + i] = 0.5 * sample->h * c[i];
        }
    }
}

/* The true increments over a row, and with them what errors do in it. */
static void take_row(imki_tuning_lane *lane, size_t row, imki_tuning_sample *sample)
{
    const imki_exposed *e = &lane->exposed;
    const size_t parts = e->parts, first = row * parts;
    const double part = lane->plan->h / (double)parts;
    double rate[2][3], force[2][3], mean[2][3] = {{0.0}}, before[3], read[3];
    memcpy(before, lane->truth.v, sizeof before);
    memcpy(read, lane->readings.v, sizeof read);
    imki_increments half = lane->truth;
    for (size_t j = 0; j < parts; j++) {
        for (int i = 0; i < 3; i++) {
            rate[j % 2][i] = e->rate[i][first + j];
            force[j % 2][i] = e->force[i][first + j];
            mean[0][i] += e->rate[i][first + j] / (double)parts;
            mean[1][i] += e->force[i][first + j] / (double)parts;
            lane->peak[0][i] = fmax(lane->peak[0][i], fabs(e->rate[i][first + j]));
            lane->peak[1][i] = fmax(lane->peak[1][i], fabs(e->force[i][first + j]));
        }
        if (j % 2 == 1)
            imki_increments_pair(&lane->truth, part, (const double(*)[3])rate,
                                 (const double(*)[3])force);
    }
    imki_increments_take(&half, 0.5 * lane->plan->h, mean[0], mean[1]);
    if (parts == 1)
        imki_increments_take(&lane->truth, part, mean[0], mean[1]);
    imki_increments_take(&lane->readings, lane->plan->h, mean[0], mean[1]);
    imki_increments_sample(&lane->truth, lane->plan->h, before);
    imki_increments_sample(&lane->readings, lane->plan->h, read);
    sample->h = lane->plan->h;
    for (int i = 0; i < 3; i++)
        sample->v[i] = lane->truth.v[i] - before[i];
    fill_columns(&half.c, sample);
}

static void add(double x[9], double factor, const double g[9])
{
    for (int i = 0; i < 9; i++)
        x[i] += factor * g[i];
}

/* An input where two rows meet: row and the one before. */
static double meeting(const double *signal, size_t row, size_t parts)
{
    const double *at = signal + row * parts;
    return 0.5 * (at[-1] + at[0]);
}

static double mean_of(const double *signal, size_t row, size_t parts)
{
    double sum = 0.0;
    for (size_t j = 0; j < parts; j++)
        sum += signal[row * parts + j];
    return sum / (double)parts;
}

/* ---- errors of the whole unit ---- */

/* Accelerometers late by a second: they miss the change of the force over the row. */
static void skew_column(const imki_tuning_lane *lane, size_t row, const imki_tuning_sample *sample,
                        double g[9])
{
    const size_t parts = lane->exposed.parts;
    memset(g, 0, 9 * sizeof *g);
    for (int i = 0; i < 3; i++) {
        const double *force = lane->exposed.force[i];
        add(g, -(meeting(force, row + 1, parts) - meeting(force, row, parts)) / sample->h,
            sample->gamma[IMK_ACCEL][i]);
    }
}

/* A clock that is fast by one: the filter counts more time than there was, for the readings, for
 * gravity and for the velocity it started with. */
static void clock_column(const imki_tuning_lane *lane, size_t row, const imki_tuning_sample *sample,
                         double time, double g[9])
{
    const size_t parts = lane->exposed.parts;
    memset(g, 0, 9 * sizeof *g);
    for (int i = 0; i < 3; i++)
        add(g, mean_of(lane->exposed.rate[i], row, parts), sample->gamma[IMK_GYRO][i]);
    for (int i = 0; i < 3; i++) {
        const double speed = lane->speed[i] + lane->gravity[i] * (time + 0.5 * sample->h) +
                             lane->truth.v[i] - 0.5 * sample->v[i];
        g[3 + i] += sample->v[i] + lane->gravity[i] * sample->h;
        g[6 + i] += speed * sample->h;
    }
}

/* The end of a row later by a second, and its beginning. */
static void jitter_columns(const imki_tuning_lane *lane, size_t row,
                           const imki_tuning_sample *sample, double late[9], double early[9])
{
    const size_t parts = lane->exposed.parts;
    memset(late, 0, 9 * sizeof *late);
    memset(early, 0, 9 * sizeof *early);
    for (int sensor = 0; sensor < 2; sensor++)
        for (int i = 0; i < 3; i++) {
            const double *u = sensor == IMK_GYRO ? lane->exposed.rate[i] : lane->exposed.force[i];
            const double mean = mean_of(u, row, parts);
            add(late, (meeting(u, row + 1, parts) - mean) / sample->h, sample->gamma[sensor][i]);
            add(early, (mean - meeting(u, row, parts)) / sample->h, sample->gamma[sensor][i]);
        }
}

/* ---- moving all over a row ---- */

static void move_source(imki_tuning_lane *lane, size_t s, size_t row,
                        const imki_tuning_sample *sample, double time)
{
    const imki_drift_plan *drift = &lane->plan->drift;
    const imki_drift_part *part = &drift->part[s];
    imki_tuning_move(sample, lane->mean[s]);
    bool noisy = false;
    for (size_t i = part->first; i < part->first + part->count; i++) {
        const imki_tuning_element *made = &lane->plan->element[i];
        const imki_drift_column *column = &drift->column[drift->element[i].column];
        const double *g = sample->gamma[column->sensor][column->axis];
        double whole[9], other[9];
        if (made->role >= IMKI_ROLE_NOISE && !noisy) {
            imki_tuning_move_matrix(sample, &lane->covariance[s]);
            noisy = true;
        }
        switch (made->role) {
        case IMKI_ROLE_NOISE:
            imki_tuning_drive(sample, &made->sampled, g, g, lane->cross[i], lane->states[i],
                              &lane->covariance[s]);
            continue;
        case IMKI_ROLE_JITTER:
            jitter_columns(lane, row, sample, whole, other);
            imki_tuning_drive(sample, &made->sampled, other, whole, lane->cross[i], lane->states[i],
                              &lane->covariance[s]);
            continue;
        case IMKI_ROLE_NONE:
            continue;
        default:
            break;
        }
        double *x = made->role == IMKI_ROLE_MEAN ? lane->mean[s] : lane->size[i];
        if (made->role == IMKI_ROLE_SIZE)
            imki_tuning_move(sample, x);
        if (imki_tuning_has_series(lane->plan, i)) {
            add(x, lane->value[i][row], g);
            continue;
        }
        if (column->kind == IMKI_COLUMN_SKEW)
            skew_column(lane, row, sample, whole);
        else
            clock_column(lane, row, sample, time, whole);
        add(x, drift->element[i].state[0], whole);
    }
}

static void move_filter(imki_tuning_lane *lane, size_t row, const imki_tuning_sample *sample)
{
    const imki_tuning_plan *plan = lane->plan;
    for (int j = 0; j < 6; j++) {
        const double *g = sample->gamma[j / 3][j % 3];
        const double *input = j < 3 ? lane->exposed.rate[j] : lane->exposed.force[j - 3];
        imki_tuning_move(sample, lane->bias[j]);
        add(lane->bias[j], 1.0, g);
        imki_tuning_move(sample, lane->scale[j]);
        add(lane->scale[j], mean_of(input, row, lane->exposed.parts), g);
        double none[2][9], nothing[2][2];
        imki_tuning_move_matrix(sample, &lane->white[j]);
        imki_tuning_start_noise(&plan->white, none, nothing);
        imki_tuning_drive(sample, &plan->white, g, g, none, nothing, &lane->white[j]);
        imki_tuning_move_matrix(sample, &lane->walk[j]);
        imki_tuning_drive(sample, &plan->walk, g, g, lane->walk_cross[j], lane->walk_states[j],
                          &lane->walk[j]);
    }
}

/* ---- results ---- */

static void add_square(imki_matrix9 *p, const double a[9], const double b[9], double factor)
{
    for (int i = 0; i < 9; i++)
        for (int j = 0; j < 9; j++)
            p->m[i][j] += factor * (a[i] * b[j] + b[i] * a[j]);
}

/* The sources that the drift does not know: the last ones. */
static void own_sources(imki_tuning_lane *lane)
{
    const size_t own = lane->plan->drift.source_count - IMKI_TUNING_OWN;
    for (int sensor = 0; sensor < 2; sensor++) {
        imki_matrix9 *p = &lane->covariance[own + (size_t)sensor];
        const double sigma = lane->settings->bias_sigma[sensor];
        memset(p, 0, sizeof *p);
        for (int i = 0; i < 3; i++)
            add_square(p, lane->bias[3 * sensor + i], lane->bias[3 * sensor + i],
                       0.5 * sigma * sigma);
    }
    imki_increments_error(&lane->readings, &lane->truth, lane->mean[own + 2]);
}

static void report(imki_tuning_lane *lane, size_t t)
{
    const imki_drift_plan *drift = &lane->plan->drift;
    const size_t times = lane->grid->time_count;
    imki_matrix9 total = {{{0.0}}};
    double shift[9] = {0.0};
    memcpy(lane->increments[t], lane->truth.c.m, sizeof lane->truth.c.m);
    memcpy(lane->increments[t] + 9, lane->truth.v, sizeof lane->truth.v);
    memcpy(lane->increments[t] + 12, lane->truth.p, sizeof lane->truth.p);
    own_sources(lane);
    for (size_t s = 0; s < drift->source_count; s++)
        add(shift, 1.0, lane->mean[s]);
    for (size_t s = 0; s < drift->source_count; s++) {
        imki_matrix9 p = lane->covariance[s];
        const imki_drift_part *part = &drift->part[s];
        for (size_t i = part->first; i < part->first + part->count; i++)
            if (lane->plan->element[i].role == IMKI_ROLE_SIZE)
                add_square(&p, lane->size[i], lane->size[i], 0.5);
        for (int i = 0; i < 9; i++)
            for (int j = 0; j < 9; j++)
                total.m[i][j] += p.m[i][j];
        add_square(&p, lane->mean[s], shift, 0.5);
        imki_pack(&p, lane->part[s * times + t]);
    }
    imki_pack(&total, lane->total[t]);
    memcpy(lane->shift[t], shift, sizeof shift);
    for (int j = 0; j < 6; j++) {
        imki_matrix9 bias = {{{0.0}}}, scale = {{{0.0}}};
        add_square(&bias, lane->bias[j], lane->bias[j], 0.5);
        add_square(&scale, lane->scale[j], lane->scale[j], 0.5);
        const imki_matrix9 *all[IMKI_KINDS_OF_BASIS] = {&lane->white[j], &lane->walk[j], &bias,
                                                        &scale};
        for (int kind = 0; kind < IMKI_KINDS_OF_BASIS; kind++)
            imki_pack(all[kind], lane->basis[(size_t)imki_basis(kind, j / 3, j % 3) * times + t]);
    }
}

/* ---- all ---- */

/* Gravity and velocity, which matter to the clock alone: a recorded motion has neither. */
static void look_at_start(imki_tuning_lane *lane, size_t row)
{
    const imk_trajectory *trajectory = lane->settings->motion[lane->motion].trajectory;
    imk_vector3 gravity = {{0.0}}, speed = {{0.0}};
    if (trajectory) {
        imk_motion_state state;
        imk_trajectory_state(trajectory, lane->scene.start + (double)row * lane->plan->h, &state);
        const imk_matrix3 to_body = imk_matrix3_transpose(imk_quaternion_to_matrix(state.attitude));
        if (trajectory->earth)
            gravity = imk_matrix3_apply(to_body, imk_gravity_ecef(state.position));
        speed = imk_matrix3_apply(to_body, state.velocity);
    }
    memcpy(lane->gravity, gravity.v, sizeof gravity.v);
    memcpy(lane->speed, speed.v, sizeof speed.v);
}

static void clear(imki_tuning_lane *lane)
{
    const imki_drift_plan *drift = &lane->plan->drift;
    lane->truth = lane->readings = imki_increments_start();
    memset(lane->mean, 0, drift->source_count * sizeof *lane->mean);
    memset(lane->covariance, 0, drift->source_count * sizeof *lane->covariance);
    memset(lane->size, 0, drift->element_count * sizeof *lane->size);
    memset(lane->bias, 0, sizeof lane->bias);
    memset(lane->scale, 0, sizeof lane->scale);
    memset(lane->white, 0, sizeof lane->white);
    memset(lane->walk, 0, sizeof lane->walk);
    for (size_t i = 0; i < drift->element_count; i++)
        if (lane->plan->element[i].role >= IMKI_ROLE_NOISE)
            imki_tuning_start_noise(&lane->plan->element[i].sampled, lane->cross[i],
                                    lane->states[i]);
    for (int j = 0; j < 6; j++)
        imki_tuning_start_noise(&lane->plan->walk, lane->walk_cross[j], lane->walk_states[j]);
}

void imki_tuning_window_run(imki_tuning_lane *lane)
{
    const imki_tuning_grid *grid = lane->grid;
    const size_t row = imki_tuning_window(lane->settings, grid, lane->motion, lane->window);
    imki_parts memory = imki_parts_of(lane->scene_memory);
    lane->status = imki_tuning_scene_start(&lane->scene, lane->perfect, lane->model, lane->settings,
                                           lane->motion, &memory, &lane->error);
    if (lane->status == IMK_OK)
        lane->status = imki_tuning_series_start(lane, row);
    if (lane->status != IMK_OK)
        return;
    clear(lane);
    look_at_start(lane, row);
    const size_t most = imki_tuning_rows_at_once(lane->scene.substeps);
    size_t done = 0;
    for (size_t t = 0; t < grid->time_count; t++) {
        while (done < grid->samples[t]) {
            const size_t left = grid->samples[t] - done, rows = left < most ? left : most;
            imki_tuning_expose(&lane->scene, row + 1 + done, rows, &lane->exposed);
            imki_tuning_series(lane);
            for (size_t k = 0; k < rows; k++) {
                imki_tuning_sample sample;
                take_row(lane, k, &sample);
                for (size_t s = 0; s < lane->plan->drift.source_count - IMKI_TUNING_OWN; s++)
                    move_source(lane, s, k, &sample, (double)(done + k) * sample.h);
                move_filter(lane, k, &sample);
            }
            done += rows;
        }
        report(lane, t);
    }
}
