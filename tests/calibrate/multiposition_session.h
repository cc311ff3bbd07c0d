/* SPDX-License-Identifier: Apache-2.0 */
/* A simulated multi-position test: a MEMS unit turned by hand through 24 poses, holds of 3 s, turns
 * of 2 s, 100 Hz, counts, at 45 deg north. Raw samples come from the simulator, and go through
 * detection and the procedure. Used by test_multiposition.c (some hundred benches) and
 * experiments/coverage_multiposition.c (thousands). */
#ifndef IMUKIT_TEST_MULTIPOSITION_SESSION_H
#define IMUKIT_TEST_MULTIPOSITION_SESSION_H

#include "imukit/motion_script.h"
#include "imukit/procedure.h"
#include "imukit/simulate.h"

#include "coverage.h"

#include <stdlib.h>

enum { BENCH_POSES = 24, BENCH_RATE = 100, BENCH_HOLD = 3, BENCH_TURN = 2, BENCH_STEPS = 48 };

typedef struct multiposition_session {
    imk_model truth;   /* what is simulated */
    imk_model drift;   /* its bias instability alone */
    imk_model nominal; /* what the solver is told */
    int poses;         /* BENCH_POSES at most */
    double push;       /* 1 sigma of a force on every axis of each hold, alike [m/s^2] */
    imk_trajectory_piece *piece;
    size_t piece_capacity;
    imk_trajectory trajectory;
    size_t rows;
    double *value[6], *slow[6]; /* readings; what the bias instability was */
    void *simulator;
    size_t simulator_size;
    void *workspace;
    size_t workspace_size;
    imk_observation observation[4 * BENCH_POSES];
    imk_turn turn[4 * BENCH_POSES];
    imk_test_record record;
    imk_calibration calibration;
    imk_calibration_result result;
    imk_procedure_findings findings;
    imk_error error;
} multiposition_session;

/* A consumer-grade MEMS unit: 0.3 deg/sqrt(h) and 8 deg/h, 100 ug/sqrt(Hz) and 20 ug; 131 counts
 * per deg/s, 16384 per g. */
static inline void session_truth(multiposition_session *b)
{
    const double degree = 0.017453292519943295, g = 9.80665;
    imk_model_default(&b->nominal);
    for (int i = 0; i < 3; i++) {
        b->nominal.gyro.sensitivity.value[i] = 131.0 / degree;
        b->nominal.accel.sensitivity.value[i] = 16384.0 / g;
    }
    imk_model *m = &b->truth;
    *m = b->nominal;
    for (int i = 0; i < 3; i++) {
        m->gyro.bias.fixed.value[i] = 0.5 * degree * (i - 0.8);
        m->gyro.scale_factor.fixed.value[i] = 0.006 * (1.2 - i);
        m->gyro.noise.white.value[i] = 0.005 * degree;
        m->gyro.noise.bias_instability.value[i] = 8.0 / 3600.0 * degree;
        m->accel.bias.fixed.value[i] = 0.02 * g * (1.4 - i);
        m->accel.scale_factor.fixed.value[i] = 0.004 * (i - 0.6);
        m->accel.noise.white.value[i] = 100e-6 * g;
        m->accel.noise.bias_instability.value[i] = 20e-6 * g;
        for (int j = 0; j < 3; j++) {
            m->gyro.misalignment.value[i][j] = i == j ? 0.0 : 0.004 * (i - 2 * j + 1);
            m->gyro.g_sensitivity.value[i][j] = 0.02 * degree / g * (i - j + 0.5);
            m->accel.misalignment.value[i][j] = j > i ? 0.003 * (i + j) : 0.0;
        }
    }
    const char *const keep[] = {"noise.bias_instability"};
    b->drift = *m;
    imk_model_select(&b->drift, true, 1, keep, NULL);
    for (int i = 0; i < 3; i++)
        b->drift.gyro.sensitivity.value[i] = b->drift.accel.sensitivity.value[i] = 0.0;
}

/* Uniform number `index` of a stream. */
static inline double session_uniform(imk_random random, uint64_t stream, uint64_t index)
{
    uint32_t word;
    imk_random_words(random, stream, index, 1, &word);
    return ((double)word + 0.5) * 0x1p-32;
}

/* Streams of a run that no noise term has. */
static inline uint64_t session_stream(uint32_t run, int use)
{
    return ((uint64_t)run << 32) + 0x7F000000u + (uint64_t)use;
}

/* Directions spread evenly over the sphere along a spiral, taken in an order that makes each turn a
 * large one about another axis; any headings. */
static inline imk_status session_motion(multiposition_session *b, uint64_t seed, uint32_t run)
{
    const double turn = 6.283185307179586;
    imk_motion_step step[BENCH_STEPS];
    size_t steps = 0, pieces = 0;
    for (int i = 0; i < b->poses; i++) {
        const int k = i * 7 % b->poses;
        const double pitch = asin(1.0 - (2.0 * k + 1.0) / b->poses);
        const double roll = remainder(2.399963229728653 * k, turn); /* by the golden angle */
        const double yaw =
            turn * session_uniform(imk_random_seeded(seed), session_stream(run, 0), (uint64_t)i);
        step[steps++] = (imk_motion_step){
            .kind = IMK_STEP_POSE, .duration = BENCH_TURN, .angle = {roll, pitch, yaw - turn / 2}};
        step[steps++] = (imk_motion_step){.kind = IMK_STEP_HOLD, .duration = BENCH_HOLD};
    }
    imk_motion_script script = imk_motion_script_default();
    script.step = step;
    script.step_count = steps;
    imk_status status = imk_motion_script_pieces(&script, &pieces, &b->error);
    if (status == IMK_OK && pieces > b->piece_capacity) {
        free(b->piece);
        b->piece = malloc(pieces * sizeof *b->piece);
        b->piece_capacity = b->piece ? pieces : 0;
    }
    return status != IMK_OK ? status
                            : imk_motion_script_compile(&script, b->piece, b->piece_capacity,
                                                        &b->trajectory, &b->error);
}

static inline imk_simulation session_simulation(const multiposition_session *b)
{
    imk_simulation simulation = imk_simulation_default();
    simulation.rate = BENCH_RATE;
    simulation.motion.trajectory = &b->trajectory;
    return simulation;
}

/* NULL: something failed. */
static inline multiposition_session *session_start(void)
{
    multiposition_session *b = calloc(1, sizeof *b);
    if (!b)
        return NULL;
    session_truth(b);
    b->rows = (size_t)BENCH_RATE * BENCH_POSES * (BENCH_HOLD + BENCH_TURN);
    b->poses = BENCH_POSES;
    for (int c = 0; c < 6; c++) {
        b->value[c] = malloc(b->rows * sizeof(double));
        b->slow[c] = malloc(b->rows * sizeof(double));
    }
    b->workspace_size = (size_t)1 << 23;
    b->workspace = malloc(b->workspace_size);
    return b;
}

/* Fewer poses. */
static inline void session_poses(multiposition_session *b, int poses)
{
    b->poses = poses;
    b->rows = (size_t)BENCH_RATE * (size_t)poses * (BENCH_HOLD + BENCH_TURN);
}

static inline void session_stop(multiposition_session *b)
{
    for (int c = 0; c < 6; c++) {
        free(b->value[c]);
        free(b->slow[c]);
    }
    free(b->simulator);
    free(b->workspace);
    free(b->piece);
    free(b);
}

static inline imk_status session_simulate(multiposition_session *b, uint64_t seed, uint32_t run)
{
    imk_status status = session_motion(b, seed, run);
    if (status != IMK_OK)
        return status;
    imk_simulation simulation = session_simulation(b);
    simulation.seed = seed;
    simulation.run = run;
    const size_t size = (imk_simulator_size(&b->truth, &simulation) + 63) / 64 * 64;
    if (size > b->simulator_size) {
        free(b->simulator);
        b->simulator = aligned_alloc(64, size);
        b->simulator_size = b->simulator ? size : 0;
    }
    imk_simulator *simulator;
    status = imk_simulator_start(&b->truth, &simulation, &simulator, b->simulator,
                                 b->simulator_size, &b->error);
    if (status != IMK_OK)
        return status;
    imk_simulator_next(simulator, b->rows, b->value, NULL);
    /* The same streams, at rest: what the biases did. */
    simulation.motion.trajectory = NULL;
    simulation.earth = false;
    status = imk_simulator_start(&b->drift, &simulation, &simulator, b->simulator,
                                 b->simulator_size, &b->error);
    if (status == IMK_OK)
        imk_simulator_next(simulator, b->rows, b->slow, NULL);
    return status;
}

/* A bad hold: the unit is pushed with 3 % of gravity all the time, or turns slowly, or is bumped.
 */
static inline void session_spoil(multiposition_session *b, int pose, imk_random random,
                                 uint64_t stream)
{
    const int kind = (int)(3.0 * session_uniform(random, stream, 0));
    const int axis = (int)(3.0 * session_uniform(random, stream, 1));
    const double sign = session_uniform(random, stream, 2) < 0.5 ? -1.0 : 1.0;
    const size_t begin = ((size_t)pose * (BENCH_HOLD + BENCH_TURN) + BENCH_TURN) * BENCH_RATE;
    const size_t length = (size_t)BENCH_HOLD * BENCH_RATE;
    for (size_t k = 0; k < length; k++) {
        const double x = (double)k / (double)length;
        double force = 0.0, rate = 0.0;
        if (kind == 0) {
            force = sign * 0.3;
        } else if (kind == 1) {
            force = sign * 0.6 * x;
            rate = sign * 0.06 / BENCH_HOLD;
        } else if (fabs(x - 0.5) < 0.05) {
            force = 3.0 * sign;
            rate = 0.3 * sign;
        }
        b->value[3 + axis][begin + k] += floor(force * b->nominal.accel.sensitivity.value[axis]);
        b->value[axis][begin + k] += floor(rate * b->nominal.gyro.sensitivity.value[axis]);
    }
}

/* Every pose is off by as much on each axis. */
static inline void session_push(multiposition_session *b, uint64_t seed, uint32_t run)
{
    double normal[3 * BENCH_POSES];
    imk_random_normals(imk_random_seeded(seed), session_stream(run, 100), 0, 3 * BENCH_POSES,
                       normal);
    for (int i = 0; i < 3 * b->poses; i++) {
        const size_t begin =
            ((size_t)(i / 3) * (BENCH_HOLD + BENCH_TURN) + BENCH_TURN) * BENCH_RATE;
        const double force = b->push * normal[i] * b->nominal.accel.sensitivity.value[i % 3];
        for (size_t k = 0; k < (size_t)BENCH_HOLD * BENCH_RATE; k++)
            b->value[3 + i % 3][begin + k] += floor(force + 0.5);
    }
}

static inline imk_status session_observe(multiposition_session *b)
{
    b->record = (imk_test_record){.name = "bench",
                                  .count = b->rows,
                                  .dt = 1.0 / BENCH_RATE,
                                  .axis_count = {3, 3},
                                  .counts = {true, true}};
    for (int c = 0; c < 6; c++)
        b->record.reading[c / 3][c % 3] = b->value[c];
    imk_calibration *c = &b->calibration;
    imk_calibration_default(c);
    c->model = b->nominal;
    c->latitude = 0.7853981633974483;
    c->observation = b->observation;
    c->turn = b->turn;
    c->observation_capacity = c->turn_capacity = 4 * BENCH_POSES;
    const imk_procedure_settings settings = imk_procedure_default(IMK_PROCEDURE_MULTIPOSITION);
    return imk_procedure_observe(IMK_PROCEDURE_MULTIPOSITION, c, &b->record, &settings, false,
                                 &b->findings, b->workspace, b->workspace_size, &b->error);
}

static inline imk_status session_solve(multiposition_session *b)
{
    return imk_calibration_solve(&b->calibration, &b->result, b->workspace, b->workspace_size,
                                 &b->error);
}

/* The bias that this log had: what the instability was on average is no error of the result. */
static inline imk_model session_true_model(const multiposition_session *b)
{
    imk_model truth = b->truth;
    for (int c = 0; c < 6; c++) {
        double sum = 0.0;
        for (size_t k = 0; k < b->rows; k++)
            sum += b->slow[c][k];
        (c < 3 ? &truth.gyro : &truth.accel)->bias.fixed.value[c % 3] += sum / (double)b->rows;
    }
    return truth;
}

/* One bench from the samples to the count. @param bad poses to spoil */
static inline imk_status session_run(multiposition_session *b, uint64_t seed, uint32_t run, int bad,
                                     coverage_count *count)
{
    imk_status status = session_simulate(b, seed, run);
    const imk_random random = imk_random_seeded(seed);
    for (int i = 0; status == IMK_OK && i < bad; i++) {
        const uint64_t stream = session_stream(run, 1 + i);
        /* Spread over the log, so that no pose is taken twice. */
        const int pose = (int)((i + session_uniform(random, stream, 3)) * b->poses / bad);
        session_spoil(b, pose, random, stream);
    }
    if (status == IMK_OK && b->push > 0.0)
        session_push(b, seed, run);
    if (status == IMK_OK)
        status = session_observe(b);
    if (status == IMK_OK)
        status = session_solve(b);
    if (status == IMK_OK) {
        const imk_model truth = session_true_model(b);
        coverage_take(count, &b->calibration, &b->result, &truth);
    } else {
        count->failed++;
    }
    return status;
}

#endif
