/* SPDX-License-Identifier: Apache-2.0 */
/* Simulated benches for turns: a unit on a table, turned about each axis by a marked angle that is
 * met to some tenths of a degree, with faces that are not quite square, on the turning Earth, and
 * with a g-sensitivity that the calibration is not told. Used by the tests and by
 * experiments/coverage_turns.c. */
#ifndef IMUKIT_TEST_TURNS_SESSION_H
#define IMUKIT_TEST_TURNS_SESSION_H

#include "six_position_session.h"

typedef struct turns_plan {
    int pairs;          /* of turns forth and back about each axis; 0: one turn */
    double angle;       /* [rad] */
    double placement;   /* of each angle, and of the axis of each face [rad] */
    double stated;      /* what the calibration is told of it, over the true one; 0: 1 */
    double instability; /* of the gyros, over that of session_truth(); 0: 1 */
    double white;       /* the same of the white noise */
    bool one_gyro;      /* gyro_z alone, turned about z */
    double off[3][4];   /* of the first turns about each axis, from their angle [rad] */
} turns_plan;

static const char *const turns_labels[] = {"rest", "",       "",       "",      "",
                                           "",     "x turn", "y turn", "z turn"};

/* About axis a, which points up or down. @return the next of the random numbers */
static inline const double *turns_about(session *b, const turns_plan *plan, int a, const double *z)
{
    enum { HOLD = 4 * BENCH_RATE, TURN = 5 * BENCH_RATE };
    static const double none[3] = {0.0};
    const int turns = plan->pairs > 0 ? 2 * plan->pairs : 1, sense = z[0] > 0.0 ? 1 : -1;
    double tilt[3], heading = BENCH_TURN * z[1];
    for (int i = 0; i < 3; i++)
        tilt[i] = i == a ? 0.0 : plan->placement * z[2 + i];
    z += 5;
    session_add(b, HOLD, 0, a, sense, 0.0, tilt, heading, none);
    for (int k = 0; k < turns; k++) {
        const double off = k < 4 ? plan->off[a][k] : 0.0;
        const double angle = (k % 2 ? -1.0 : 1.0) * (plan->angle + off) + plan->placement * *z++;
        session_add(b, BENCH_MOVE, -1, a, sense, 0.0, tilt, heading, none);
        session_add(b, TURN, 6 + a, a, sense, angle, tilt, heading, none);
        heading -= angle;
        session_add(b, BENCH_MOVE, -1, a, sense, 0.0, tilt, heading, none);
        session_add(b, HOLD, 0, a, sense, 0.0, tilt, heading, none);
    }
    session_add(b, BENCH_MOVE, -1, a, sense, 0.0, none, heading, none);
    return z;
}

static inline void turns_unit(session *b, const turns_plan *plan, const double *z)
{
    const double sensed = imk_procedure_default(IMK_PROCEDURE_TURNS).g_sensitivity_sigma;
    imk_triad *gyro = &b->unit.gyro;
    b->unit = session_truth();
    for (int i = 0; i < 3; i++) {
        gyro->noise.bias_instability.value[i] *= plan->instability > 0.0 ? plan->instability : 1.0;
        gyro->noise.white.value[i] *= plan->white > 0.0 ? plan->white : 1.0;
        for (int j = 0; j < 3; j++)
            gyro->g_sensitivity.value[i][j] = sensed * *z++;
    }
}

/* The record without accelerometers, and the problem. */
static inline void turns_problem(session *b, const turns_plan *plan)
{
    imk_calibration *c = &b->calibration;
    b->record = (imk_test_record){.name = "bench",
                                  .count = b->count,
                                  .dt = 1.0 / BENCH_RATE,
                                  .axis_count = {plan->one_gyro ? 1 : 3, 0},
                                  .counts = {true, true},
                                  .section = b->section,
                                  .section_count = 9,
                                  .section_name = turns_labels};
    for (int i = 0; i < 3; i++)
        b->record.reading[0][i] = b->reading[plan->one_gyro ? 2 : i];
    imk_calibration_default(c);
    c->observation = b->observation;
    c->observation_capacity = BENCH_STRETCHES;
    c->frame = IMK_FRAME_REFERENCE;
    c->model.accel.present = false;
    c->model.gyro.sensitivity = b->unit.gyro.sensitivity;
    if (!plan->one_gyro)
        return;
    c->model.gyro.axis_count = 1;
    memcpy(c->model.gyro.direction[0], c->model.gyro.direction[2],
           sizeof c->model.gyro.direction[0]);
    b->truth.gyro.bias.fixed.value[0] = b->truth.gyro.bias.fixed.value[2];
    b->truth.gyro.scale_factor.fixed.value[0] = b->truth.gyro.scale_factor.fixed.value[2];
}

/* Simulate bench number `number` and solve it. @return false: refused */
static inline bool turns_run(session *b, const turns_plan *plan, uint64_t seed, uint32_t number,
                             imk_error *error)
{
    imk_random_normals(imk_random_seeded(seed), 0xC000 + ((uint64_t)number << 32), 0,
                       BENCH_STRETCHES * 8, b->normal);
    const double *z = b->normal + 9;
    turns_unit(b, plan, b->normal);
    b->count = 0;
    for (int a = plan->one_gyro ? 2 : 0; a < 3; a++)
        z = turns_about(b, plan, a, z);
    if (!session_readings(b, seed, number, error))
        return false;
    turns_problem(b, plan);
    imk_procedure_settings settings = imk_procedure_default(IMK_PROCEDURE_TURNS);
    settings.placement_sigma = plan->placement * (plan->stated > 0.0 ? plan->stated : 1.0);
    settings.turn_angle = plan->angle;
    size_t needed = imk_procedure_workspace_size(IMK_PROCEDURE_TURNS, &b->record, &settings);
    if (imk_procedure_observe(IMK_PROCEDURE_TURNS, &b->calibration, &b->record, &settings, false,
                              &b->findings, session_workspace(b, needed), needed, error) != IMK_OK)
        return false;
    needed = imk_calibration_workspace_size(&b->calibration);
    return imk_calibration_solve(&b->calibration, &b->result, session_workspace(b, needed), needed,
                                 error) == IMK_OK;
}

#endif
