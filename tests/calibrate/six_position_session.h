/* SPDX-License-Identifier: Apache-2.0 */
/* Simulated benches for sixposition and ferraris: raw samples in counts by the simulator, with
 * white noise, bias instability and quantization, on a plate that the unit is put on by hand: at
 * any heading, tilted by a placement error, on the turning Earth. Used by the tests (some hundred
 * benches) and by experiments/coverage_six_position.c (thousands). */
#ifndef IMUKIT_TEST_SIX_POSITION_SESSION_H
#define IMUKIT_TEST_SIX_POSITION_SESSION_H

#include "coverage.h"

#include "imukit/imukit.h"

#include <stdlib.h>
#include <string.h>

#define BENCH_TURN 6.283185307179586
#define BENCH_LATITUDE 0.7853981633974483
#define BENCH_GRAVITY 9.81
#define BENCH_EARTH_RATE 7.292115e-5

enum {
    BENCH_RATE = 40,
    BENCH_MOVE = 10, /* samples between two stretches */
    BENCH_STRETCHES = 64,
    BENCH_SAMPLES_MAX = 40000
};

typedef struct session_plan {
    int rounds;        /* through the six faces */
    double hold, turn; /* [s]; turn 0: sixposition, else ferraris, turns of so long */
    double placement;  /* of each hold and turn [rad] */
    double bad_share;  /* of the holds, disturbed: leaning by some degrees, or touched */
    double stated;     /* placement that the calibration is told, over the true one; 0: 1 */
    double unequal;    /* white noise of each axis over that of the axis before it; 0: 1 */
    double push;       /* equal pose errors: a force on every axis of each hold [m/s^2] */
    bool unlabelled; /* sections are not named; the unit rests again after each turn, where it is */
} session_plan;

typedef struct session {
    double motion[6][BENCH_SAMPLES_MAX], reading[6][BENCH_SAMPLES_MAX];
    double steady[6][BENCH_SAMPLES_MAX]; /* the same without instability */
    int section[BENCH_SAMPLES_MAX];
    size_t count;
    imk_test_record record;
    imk_model unit;  /* what is simulated */
    imk_model truth; /* with the bias that the unit had on the average during the test */
    imk_calibration calibration;
    imk_observation observation[BENCH_STRETCHES];
    imk_calibration_result result;
    imk_procedure_findings findings;
    void *simulator, *workspace;
    size_t simulator_size, workspace_size;
    double normal[BENCH_STRETCHES * 8];
} session;

static const char *const session_labels[] = {"x up",   "x down", "y up",  "y down", "z up",
                                             "z down", "x rot",  "y rot", "z rot"};

/* A consumer part: 16 bits over +-2 g and +-250 deg/s. */
static inline imk_model session_truth(void)
{
    static const double bias[2][3] = {{0.02, -0.03, 0.01}, {0.3, -0.2, 0.25}};
    static const double scale[2][3] = {{0.01, -0.02, 0.015}, {0.006, -0.004, 0.008}};
    imk_model model;
    imk_model_default(&model);
    for (int s = 0; s < 2; s++) {
        imk_triad *triad = s == 0 ? &model.gyro : &model.accel;
        for (int i = 0; i < 3; i++) {
            triad->bias.fixed.value[i] = bias[s][i];
            triad->scale_factor.fixed.value[i] = scale[s][i];
            for (int j = 0; j < 3; j++) {
                if (j != i)
                    triad->misalignment.value[i][j] = 0.003 * (1 + i - 2 * j + s);
                if (s == 0)
                    triad->g_sensitivity.value[i][j] = 2e-5 * (2 - i + j);
            }
            triad->noise.white.value[i] = s == 0 ? 9e-5 : 2e-3;
            triad->noise.bias_instability.value[i] = s == 0 ? 1e-5 : 2e-4;
            triad->sensitivity.value[i] = s == 0 ? 7506.0 : 1670.0;
        }
    }
    return model;
}

static inline session *session_new(void)
{
    session *b = calloc(1, sizeof *b);
    b->unit = b->truth = session_truth();
    return b;
}

static inline void session_free(session *b)
{
    free(b->simulator);
    free(b->workspace);
    free(b);
}

static inline void session_rotate(const double d[3], double v[3])
{
    const imk_vector3 rotation = {{d[0], d[1], d[2]}}, vector = {{v[0], v[1], v[2]}};
    const imk_vector3 out =
        imk_quaternion_rotate(imk_quaternion_from_rotation_vector(rotation), vector);
    memcpy(v, out.v, sizeof out.v);
}

/* Samples with axis a up (sense 1) or down; `turned` about it meanwhile. */
static inline void session_add(session *b, size_t n, int section, int a, int sense, double turned,
                               const double tilt[3], double heading, const double push[3])
{
    const double level = BENCH_EARTH_RATE * cos(BENCH_LATITUDE),
                 vertical = BENCH_EARTH_RATE * sin(BENCH_LATITUDE);
    for (size_t k = 0; k < n; k++) {
        const double t = ((double)k + 0.5) / (double)n;
        const double angle = turned * (t - sin(BENCH_TURN * t) / BENCH_TURN);
        const double speed = turned * (1.0 - cos(BENCH_TURN * t)) * BENCH_RATE / (double)n;
        double rate[3] = {0.0}, force[3] = {0.0};
        rate[a] = speed + sense * vertical;
        rate[(a + 1) % 3] = level * cos(heading - angle);
        rate[(a + 2) % 3] = level * sin(heading - angle);
        force[a] = sense * BENCH_GRAVITY;
        session_rotate(tilt, rate);
        session_rotate(tilt, force);
        for (int i = 0; i < 3; i++) {
            b->motion[i][b->count] = rate[i];
            b->motion[3 + i][b->count] = force[i] + push[i];
        }
        b->section[b->count++] = section;
    }
}

static inline void session_plan_motion(session *b, const session_plan *plan)
{
    static const double none[3] = {0.0};
    const size_t hold = (size_t)(plan->hold * BENCH_RATE), turn = (size_t)(plan->turn * BENCH_RATE);
    const int holds = 6 * plan->rounds, bad = (int)(plan->bad_share * holds + 0.5);
    const double *z = b->normal;
    b->count = 0;
    for (int h = 0; h < holds; h++) {
        const int face = h % 6, a = face / 2, sense = face % 2 ? -1 : 1;
        double tilt[3], push[3] = {0.0};
        const double heading = BENCH_TURN * z[3];
        for (int i = 0; i < 3; i++)
            tilt[i] = plan->placement * z[i];
        /* Bad ones spread over the faces: every other leans, every other is pushed against. */
        const bool is_bad = bad > 0 && (h * bad) / holds != ((h + 1) * bad) / holds;
        if (is_bad && h % 4 < 2)
            tilt[(a + 1) % 3] += 0.05;
        else if (is_bad)
            push[a] = 0.3;
        z += 8;
        for (int i = 0; i < 3; i++)
            push[i] += plan->push * z[4 + i];
        session_add(b, hold, face, a, sense, 0.0, tilt, heading, push);
        if (turn > 0 && sense > 0) {
            const double angle = BENCH_TURN + plan->placement * z[a];
            for (int i = 0; i < 3 && !plan->unlabelled; i++)
                tilt[i] = i == a ? 0.0 : plan->placement * z[i];
            session_add(b, BENCH_MOVE, -1, a, sense, 0.0, tilt, heading, none);
            session_add(b, turn, 6 + a, a, sense, angle, tilt, heading, none);
            if (plan->unlabelled)
                session_add(b, hold, face, a, sense, 0.0, tilt, heading - angle, push);
            z += 8;
        }
        session_add(b, BENCH_MOVE, -1, a, sense, 0.0, none, heading, none);
    }
}

static inline bool session_simulate(session *b, const imk_model *model, uint64_t seed,
                                    uint32_t number, double reading[6][BENCH_SAMPLES_MAX],
                                    imk_error *error)
{
    imk_simulation simulation = imk_simulation_default();
    imk_recorded_motion recorded;
    imk_simulator *simulator;
    double *columns[6];
    memset(&recorded, 0, sizeof recorded);
    recorded.count = b->count;
    recorded.rate = BENCH_RATE;
    for (int i = 0; i < 6; i++) {
        *(i < 3 ? &recorded.angular_rate[i] : &recorded.specific_force[i - 3]) = b->motion[i];
        columns[i] = reading[i];
    }
    simulation.rate = BENCH_RATE;
    simulation.seed = seed;
    simulation.run = number;
    simulation.motion.recorded = &recorded;
    const size_t size = imk_simulator_size(model, &simulation);
    if (size > b->simulator_size) {
        free(b->simulator);
        b->simulator = aligned_alloc(64, (size + 63) / 64 * 64);
        b->simulator_size = size;
    }
    if (imk_simulator_start(model, &simulation, &simulator, b->simulator, size, error) != IMK_OK)
        return false;
    imk_simulator_next(simulator, b->count, columns, NULL);
    return true;
}

/* The bias that a test of minutes can find is that of these minutes: the instability's mean over
 * the holds belongs to the truth, what it does between them to the errors. Streams of noise are
 * independent, so that the difference of two simulations is the instability. */
static inline bool session_readings(session *b, uint64_t seed, uint32_t number, imk_error *error)
{
    imk_model steady = b->unit;
    memset(&steady.gyro.noise.bias_instability, 0, sizeof steady.gyro.noise.bias_instability);
    memset(&steady.accel.noise.bias_instability, 0, sizeof steady.accel.noise.bias_instability);
    if (!session_simulate(b, &b->unit, seed, number, b->reading, error) ||
        !session_simulate(b, &steady, seed, number, b->steady, error))
        return false;
    b->truth = b->unit;
    for (int c = 0; c < 6; c++) {
        imk_triad *triad = c < 3 ? &b->truth.gyro : &b->truth.accel;
        double sum = 0.0, samples = 0.0;
        for (size_t k = 0; k < b->count; k++)
            if (b->section[k] >= 0 && b->section[k] < 6) {
                sum += b->reading[c][k] - b->steady[c][k];
                samples += 1.0;
            }
        triad->bias.fixed.value[c % 3] += sum / samples / triad->sensitivity.value[c % 3];
    }
    return true;
}

static inline void *session_workspace(session *b, size_t needed)
{
    if (needed > b->workspace_size) {
        free(b->workspace);
        b->workspace = malloc(needed);
        b->workspace_size = needed;
    }
    return b->workspace;
}

/* Simulate bench number `number` and solve it. @return false: refused */
static inline bool session_run(session *b, const session_plan *plan, imk_procedure procedure,
                               uint64_t seed, uint32_t number, imk_error *error)
{
    imk_random_normals(imk_random_seeded(seed), 0xB000 + ((uint64_t)number << 32), 0,
                       BENCH_STRETCHES * 8, b->normal);
    session_plan_motion(b, plan);
    b->unit = session_truth();
    for (int i = 1; i < 3 && plan->unequal > 0.0; i++) {
        b->unit.gyro.noise.white.value[i] = plan->unequal * b->unit.gyro.noise.white.value[i - 1];
        b->unit.accel.noise.white.value[i] = plan->unequal * b->unit.accel.noise.white.value[i - 1];
    }
    if (!session_readings(b, seed, number, error))
        return false;
    b->record = (imk_test_record){.name = "bench",
                                  .count = b->count,
                                  .dt = 1.0 / BENCH_RATE,
                                  .axis_count = {3, 3},
                                  .counts = {true, true},
                                  .section = plan->unlabelled ? NULL : b->section,
                                  .section_count = 9,
                                  .section_name = session_labels};
    for (int i = 0; i < 6; i++)
        b->record.reading[i / 3][i % 3] = b->reading[i];
    imk_calibration *c = &b->calibration;
    imk_calibration_default(c);
    c->gravity = BENCH_GRAVITY;
    c->latitude = BENCH_LATITUDE;
    c->observation = b->observation;
    c->observation_capacity = BENCH_STRETCHES;
    c->model.gyro.sensitivity = b->unit.gyro.sensitivity;
    c->model.accel.sensitivity = b->unit.accel.sensitivity;
    imk_procedure_settings settings = imk_procedure_default(procedure);
    settings.placement_sigma = plan->placement * (plan->stated > 0.0 ? plan->stated : 1.0);
    size_t needed = imk_procedure_workspace_size(procedure, &b->record, &settings);
    if (imk_procedure_observe(procedure, c, &b->record, &settings, false, &b->findings,
                              session_workspace(b, needed), needed, error) != IMK_OK)
        return false;
    needed = imk_calibration_workspace_size(c);
    return imk_calibration_solve(c, &b->result, session_workspace(b, needed), needed, error) ==
           IMK_OK;
}

#endif
