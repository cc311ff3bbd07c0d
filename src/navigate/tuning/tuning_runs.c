/* SPDX-License-Identifier: Apache-2.0 */
/* Monte Carlo of the increments: readings of the simulator, less the bias known, integrated over
 * every window, against the integrals of the true rates and forces.
 *
 * The readings of the slow terms alone come from a second simulator of the same run, of a model
 * with nothing else, at rest and without the Earth: the streams of its terms are the same. */
#include "tuning_internal.h"

#include "base/workspace_internal.h"
#include "imukit/noise.h"
#include "navigate/drift/drift_runs_internal.h"

#include <string.h>

enum { ROWS = IMK_NOISE_BLOCK };

typedef struct run {
    const imk_filter_tuning_settings *settings;
    imki_tuning_grid grid;
    imk_model *model, *slow, *perfect;
    imk_random random;
    uint32_t number;
    void *simulator[2], *scene; /* memory: whole, slow */
    size_t simulator_size[2];
    double *reading[6], *bias[6]; /* of a motion, whole blocks */
    double sigma[2], h;
} run;

/* Rows of the longest motion, in whole blocks. */
static size_t rows_at_most(const imk_filter_tuning_settings *settings, const imki_tuning_grid *grid)
{
    size_t most = 0;
    for (size_t m = 0; m < settings->motion_count; m++)
        most = grid->rows[m] > most ? grid->rows[m] : most;
    return (most + ROWS) / ROWS * ROWS;
}

static imk_simulation simulation_of(const run *r, size_t motion, bool slow)
{
    imk_simulation simulation = imk_simulation_default();
    simulation.rate = r->settings->rate;
    simulation.seed = r->random.seed;
    simulation.run = r->number;
    if (slow && !r->settings->learned)
        simulation.earth = false;
    else
        simulation.motion = r->settings->motion[motion];
    return simulation;
}

/* What a filter takes for bias, and nothing else; where it learns, with all that is no noise. */
static void make_slow(imk_model *slow, const imk_model *model, bool learned)
{
    imk_model_default(slow);
    for (int sensor = 0; sensor < 2 && learned; sensor++) {
        imk_triad *to = imk_model_triad_to_set(slow, sensor);
        *to = *imk_model_triad(model, sensor);
        memset(&to->noise, 0, sizeof to->noise);
        memset(&to->sensitivity, 0, sizeof to->sensitivity);
        memset(&to->zero_offset, 0, sizeof to->zero_offset);
        memset(&to->resolution, 0, sizeof to->resolution);
    }
    for (int sensor = 0; sensor < 2; sensor++) {
        const imk_triad *from = imk_model_triad(model, sensor);
        imk_triad *to = imk_model_triad_to_set(slow, sensor);
        const imk_noise *noise = &from->noise;
        to->bias = from->bias;
        to->noise.bias_instability = noise->bias_instability;
        to->noise.random_walk = noise->random_walk;
        to->noise.ramp = noise->ramp;
        to->noise.gauss_markov_count = noise->gauss_markov_count;
        memcpy(to->noise.gauss_markov, noise->gauss_markov, sizeof noise->gauss_markov);
    }
}

static run lay_out(const imk_model *model, const imk_filter_tuning_settings *settings, void *memory,
                   size_t *size)
{
    run r = {.settings = settings, .h = 1.0 / settings->rate};
    imki_parts parts = imki_parts_of(memory);
    imki_tuning_grid_of(model, settings, &r.grid);
    const size_t rows = rows_at_most(settings, &r.grid);
    r.model = imki_take(&parts, sizeof *r.model);
    r.slow = imki_take(&parts, sizeof *r.slow);
    r.perfect = imki_take(&parts, sizeof *r.perfect);
    r.scene = imki_take(&parts, IMKI_SCENE_SIZE + 2 * IMKI_ALIGNMENT_SLACK);
    /* A part of the model needs no more than the whole. */
    for (int which = 0; which < 2; which++) {
        const imk_simulation simulation = simulation_of(&r, 0, which == 1 && !settings->learned);
        r.simulator_size[which] = imk_simulator_size(model, &simulation) + IMKI_SCENE_SIZE;
        r.simulator[which] = imki_take(&parts, r.simulator_size[which]);
    }
    for (int i = 0; i < 6; i++) {
        r.reading[i] = imki_take(&parts, rows * sizeof(double));
        r.bias[i] = imki_take(&parts, rows * sizeof(double));
    }
    *size = imki_parts_size(&parts);
    return r;
}

size_t imk_filter_tuning_runs_workspace_size(const imk_model *model,
                                             const imk_filter_tuning_settings *settings)
{
    size_t size;
    (void)lay_out(model, settings, NULL, &size);
    return size;
}

/* ---- readings ---- */

static void divide_counts(const imk_model *model, double *const *column, size_t rows)
{
    for (int i = 0; i < 6; i++) {
        const imk_triad *triad = imk_model_triad(model, i / 3);
        const double sensitivity = triad->sensitivity.value[i % 3];
        for (size_t k = 0; k < rows && sensitivity != 0.0; k++)
            column[i][k] = (column[i][k] - triad->zero_offset.value[i % 3]) / sensitivity;
    }
}

static imk_status simulate(run *r, const imk_model *model, size_t motion, bool slow,
                           double *const *column, imk_error *error)
{
    const imk_simulation simulation = simulation_of(r, motion, slow);
    imk_simulator *simulator;
    const size_t rows = (r->grid.rows[motion] + ROWS) / ROWS * ROWS;
    const imk_status status = imki_simulator_start(r->simulator[slow], r->simulator_size[slow],
                                                   model, &simulation, true, &simulator, error);
    if (status != IMK_OK)
        return status;
    imk_simulator_next(simulator, rows, column, NULL);
    divide_counts(model, column, rows);
    return IMK_OK;
}

/* ---- a window ---- */

static void known_bias(const run *r, size_t motion, size_t window, size_t row, double bias[6])
{
    for (int i = 0; i < 6; i++) {
        double normal, sum = 0.0;
        imk_random_normals(r->random,
                           imk_stream(r->number, IMK_TERM_INITIAL, (uint8_t)motion, (uint8_t)i),
                           window, 1, &normal);
        for (size_t k = row + 1 - r->grid.bias_samples; k <= row; k++)
            sum += r->bias[i][k];
        bias[i] = sum / (double)r->grid.bias_samples + r->sigma[i / 3] * normal;
    }
}

/* True increments where the clock is right: those of the tuning. */
static imki_increments known_truth(const double increments[15])
{
    imki_increments truth;
    memcpy(truth.c.m, increments, sizeof truth.c.m);
    memcpy(truth.v, increments + 9, sizeof truth.v);
    memcpy(truth.p, increments + 12, sizeof truth.p);
    return truth;
}

/* Else over the time that rows really took. */
static void true_row(imki_increments *truth, const imki_exposed *e, size_t row, double h)
{
    const size_t parts = e->parts;
    double rate[2][3], force[2][3], before[3];
    memcpy(before, truth->v, sizeof before);
    for (size_t j = 0; j < parts; j++) {
        for (int i = 0; i < 3; i++) {
            rate[j % 2][i] = e->rate[i][row * parts + j];
            force[j % 2][i] = e->force[i][row * parts + j];
        }
        if (j % 2 == 1)
            imki_increments_pair(truth, h / (double)parts, (const double(*)[3])rate,
                                 (const double(*)[3])force);
        else if (parts == 1)
            imki_increments_take(truth, h, rate[0], force[0]);
    }
    imki_increments_sample(truth, h, before);
}

/* What the filter thinks passed besides, because its clock counts `more` time than there was. */
static void add_clock(const run *r, size_t motion, double start, double time, double more,
                      double error[9])
{
    const imk_trajectory *trajectory = r->settings->motion[motion].trajectory;
    if (!trajectory || more == 0.0)
        return;
    imk_motion_state state;
    imk_trajectory_state(trajectory, start, &state);
    const imk_matrix3 to_body = imk_matrix3_transpose(imk_quaternion_to_matrix(state.attitude));
    const imk_vector3 speed = imk_matrix3_apply(to_body, state.velocity);
    imk_vector3 gravity = {{0.0, 0.0, 0.0}};
    if (trajectory->earth)
        gravity = imk_matrix3_apply(to_body, imk_gravity_ecef(state.position));
    for (int i = 0; i < 3; i++) {
        error[3 + i] += gravity.v[i] * more;
        error[6 + i] += speed.v[i] * more + gravity.v[i] * (time - 0.5 * more) * more;
    }
}

/* Readings less the bias, from `done` samples of a window to `goal`. */
static void take_readings(const run *r, size_t row, size_t done, size_t goal, const double bias[6],
                          imki_increments *readings)
{
    for (; done < goal; done++) {
        double reading[6], before[3];
        memcpy(before, readings->v, sizeof before);
        for (int i = 0; i < 6; i++)
            reading[i] = r->reading[i][row + 1 + done] - bias[i];
        imki_increments_take(readings, r->h, reading, reading + 3);
        imki_increments_sample(readings, r->h, before);
    }
}

static void take_truth(imki_scene *scene, size_t row, size_t done, size_t goal,
                       imki_increments *truth)
{
    const size_t most = imki_tuning_rows_at_once(scene->substeps);
    imki_exposed exposed;
    for (; done < goal; done += exposed.rows) {
        const size_t left = goal - done;
        imki_tuning_expose(scene, row + 1 + done, left < most ? left : most, &exposed);
        for (size_t k = 0; k < exposed.rows; k++)
            true_row(truth, &exposed, k, scene->interval);
    }
}

static void run_window(run *r, imki_scene *scene, size_t motion, size_t window,
                       const double (*known)[15], double *errors)
{
    const imki_tuning_grid *grid = &r->grid;
    const size_t row = imki_tuning_window(r->settings, grid, motion, window);
    const bool exact = r->model->timing.rate_error.value == 0.0;
    imki_increments truth = imki_increments_start(), readings = truth;
    double bias[6];
    size_t done = 0;
    known_bias(r, motion, window, row, bias);
    for (size_t t = 0; t < grid->time_count; t++) {
        take_readings(r, row, done, grid->samples[t], bias, &readings);
        if (exact)
            truth = known_truth(known[t]);
        else
            take_truth(scene, row, done, grid->samples[t], &truth);
        done = grid->samples[t];
        double *error = errors + t * IMK_TUNING_STATES;
        const double time = (double)done * r->h;
        imki_increments_error(&readings, &truth, error);
        add_clock(r, motion, scene->start + (double)row * scene->interval, time,
                  exact ? 0.0 : time - (double)done * scene->interval, error);
    }
}

static imk_status run_motion(run *r, size_t motion, const double (*known)[15], double *errors,
                             imk_error *error)
{
    imki_scene scene;
    imki_parts memory = imki_parts_of(r->scene);
    imk_status status = simulate(r, r->slow, motion, true, r->bias, error);
    if (status == IMK_OK && r->settings->learned) {
        imk_model_default(r->perfect);
        status = simulate(r, r->perfect, motion, true, r->reading, error);
        for (int i = 0; i < 6 && status == IMK_OK; i++)
            for (size_t k = 0; k < r->grid.rows[motion]; k++)
                r->bias[i][k] -= r->reading[i][k];
    }
    if (status == IMK_OK)
        status = simulate(r, r->model, motion, false, r->reading, error);
    if (status == IMK_OK)
        status = imki_tuning_scene_start(&scene, r->perfect, r->model, r->settings, motion, &memory,
                                         error);
    if (status != IMK_OK)
        return status;
    scene.interval = r->h / (1.0 + r->model->timing.rate_error.value);
    for (size_t w = 0; w < r->settings->window_count; w++)
        run_window(r, &scene, motion, w, known + w * r->grid.time_count,
                   errors + w * r->grid.time_count * IMK_TUNING_STATES);
    return IMK_OK;
}

imk_status imk_filter_tuning_simulate(const imk_model *model,
                                      const imk_filter_tuning_settings *settings,
                                      const imk_filter_tuning *tuning, uint64_t seed,
                                      uint32_t number, double *errors, void *workspace,
                                      size_t workspace_size, imk_error *error)
{
    size_t size;
    imk_status status = imk_filter_tuning_validate(model, settings, error);
    if (status != IMK_OK)
        return status;
    run r = lay_out(model, settings, workspace, &size);
    if (!workspace)
        return imk_error_set(error, IMK_ERROR_ARGUMENT, "workspace", "", "memory");
    if (workspace_size < size)
        return imk_error_set(error, IMK_ERROR_WORKSPACE, "workspace", "",
                             "imk_filter_tuning_runs_workspace_size() bytes");
    r.random = imk_random_seeded(seed);
    r.number = number;
    memcpy(r.sigma, tuning->bias_sigma, sizeof r.sigma);
    memcpy(r.model, model, sizeof *model);
    if (settings->compensated)
        imki_drift_residual(r.model, NULL, r.random, number);
    make_slow(r.slow, r.model, settings->learned);
    const size_t each = settings->window_count * r.grid.time_count * IMK_TUNING_STATES;
    for (size_t m = 0; m < settings->motion_count && status == IMK_OK; m++)
        status = run_motion(&r, m, tuning->increments + m * each / IMK_TUNING_STATES,
                            errors + m * each, error);
    return status;
}

void imk_filter_tuning_nees(const imk_filter_tuning *tuning, imk_filter_answer_kind kind,
                            const double *errors, double *nees)
{
    const imk_filter_answer *answer = &tuning->answer[kind];
    for (size_t t = 0; t < tuning->time_count; t++) {
        double moment[9][9] = {{0.0}};
        for (size_t w = 0; w < tuning->window_count; w++) {
            const double *e = errors + (w * tuning->time_count + t) * IMK_TUNING_STATES;
            for (int i = 0; i < 9; i++)
                for (int j = 0; j < 9; j++)
                    moment[i][j] += e[i] * e[j] / (double)tuning->window_count;
        }
        nees[t] = imki_tuning_trace(answer->covariance[t], (const double(*)[9])moment) / 9.0;
    }
}
