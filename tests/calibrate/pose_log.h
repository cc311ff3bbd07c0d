/* SPDX-License-Identifier: Apache-2.0 */
/* Logs for the tests of static detection and of diagnostics: a unit turned from pose to pose,
 * simulated, and the real ones of the shared folder. Include after check.h. */
#ifndef IMUKIT_TESTS_POSE_LOG_H
#define IMUKIT_TESTS_POSE_LOG_H

#include "imukit/log.h"
#include "imukit/motion_script.h"
#include "imukit/simulate.h"
#include "imukit/static_detection.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { POSE_LOG_INTERVALS = 512 };

typedef struct pose_log {
    imk_test_record record;
    double *value[6]; /* the readings, which tests may spoil */
    imk_log log;      /* of a real one */
    int *section;
    imk_static_interval interval[POSE_LOG_INTERVALS];
    size_t count;
    imk_static_findings findings;
    double *activity;
} pose_log;

static inline void pose_log_free(pose_log *log)
{
    if (log->log.rows > 0)
        imk_log_free(&log->log);
    else
        for (int c = 0; c < 6; c++)
            free(log->value[c]);
    free(log->section);
    free(log->activity);
    free(log);
}

/* A consumer MEMS unit, SI. */
static inline imk_model pose_log_model(void)
{
    imk_model model;
    imk_model_default(&model);
    for (int i = 0; i < 3; i++) {
        model.gyro.noise.white.value[i] = 1e-4;
        model.gyro.noise.bias_instability.value[i] = 4e-5;
        model.gyro.bias.fixed.value[i] = 0.01 * (i - 0.7);
        model.accel.noise.white.value[i] = 1e-3;
        model.accel.noise.bias_instability.value[i] = 2e-4;
        model.accel.bias.fixed.value[i] = 0.05 * (1.2 - i);
    }
    return model;
}

/* Simulate a script, at rest for `rest` seconds first. */
static inline pose_log *pose_log_of(const imk_model *model, const imk_motion_script *script,
                                    double seconds, double rate, uint64_t seed)
{
    pose_log *log = calloc(1, sizeof *log);
    size_t pieces;
    imk_trajectory trajectory;
    imk_error error;
    CHECK_OK(imk_motion_script_pieces(script, &pieces, &error));
    imk_trajectory_piece *piece = malloc(pieces * sizeof *piece);
    CHECK_OK(imk_motion_script_compile(script, piece, pieces, &trajectory, &error));
    imk_simulation simulation = imk_simulation_default();
    simulation.rate = rate;
    simulation.seed = seed;
    simulation.motion.trajectory = &trajectory;
    const size_t size = (imk_simulator_size(model, &simulation) + 63) / 64 * 64;
    void *memory = aligned_alloc(64, size);
    imk_simulator *simulator;
    CHECK_OK(imk_simulator_start(model, &simulation, &simulator, memory, size, &error));
    log->record = (imk_test_record){
        .name = "poses", .count = (size_t)(seconds * rate), .dt = 1.0 / rate, .axis_count = {3, 3}};
    for (int c = 0; c < 6; c++) {
        log->value[c] = malloc(log->record.count * sizeof(double));
        log->record.reading[c / 3][c % 3] = log->value[c];
    }
    log->record.counts[0] = model->gyro.sensitivity.value[0] != 0.0;
    log->record.counts[1] = model->accel.sensitivity.value[0] != 0.0;
    imk_simulator_next(simulator, log->record.count, log->value, NULL);
    free(memory);
    free(piece);
    return log;
}

/* Steps of a log of poses spread over the sphere: hold, turn, hold … */
static inline size_t pose_log_steps(size_t poses, double hold, double turn, imk_motion_step *step)
{
    const size_t stride = poses % 5 != 0 ? 5 : 7; /* each pose once, neighbours far apart */
    size_t steps = 0;
    for (size_t i = 0; i < poses; i++) {
        const double k = (double)(i * stride % poses);
        if (i > 0)
            step[steps++] =
                (imk_motion_step){.kind = IMK_STEP_POSE,
                                  .duration = turn,
                                  .angle = {remainder(2.399963229728653 * k, 6.283185307179586),
                                            asin(1.0 - (2.0 * k + 1.0) / (double)poses),
                                            remainder(1.1 * (double)i, 6.283185307179586)}};
        step[steps++] = (imk_motion_step){.kind = IMK_STEP_HOLD, .duration = hold};
    }
    return steps;
}

/* `poses` (at most 32) held for `hold` seconds, turned within `turn` seconds, 100 Hz. */
static inline pose_log *pose_log_simulate(const imk_model *model, size_t poses, double hold,
                                          double turn, uint64_t seed)
{
    imk_motion_step step[64];
    imk_motion_script script = imk_motion_script_default();
    script.step = step;
    script.step_count = pose_log_steps(poses, hold, turn, step);
    return pose_log_of(model, &script, (double)poses * (hold + turn) - turn, 100.0, seed);
}

/* White noise alone: rates of `gyro`, forces of `accel` about 1 g down; [SI]. */
static inline pose_log *pose_log_noise(size_t count, double gyro, double accel, uint64_t seed)
{
    pose_log *log = calloc(1, sizeof *log);
    const imk_random random = imk_random_seeded(seed);
    log->record =
        (imk_test_record){.name = "noise", .count = count, .dt = 0.01, .axis_count = {3, 3}};
    for (int c = 0; c < 6; c++) {
        log->value[c] = malloc(count * sizeof(double));
        log->record.reading[c / 3][c % 3] = log->value[c];
        imk_random_normals(random, (uint64_t)c, 0, count, log->value[c]);
        for (size_t k = 0; k < count; k++)
            log->value[c][k] = log->value[c][k] * (c < 3 ? gyro : accel) + (c == 5 ? -9.8 : 0.0);
    }
    return log;
}

/* A log of the shared folder, or NULL when it is not there. */
static inline pose_log *pose_log_read(const char *path, double rate, bool counts)
{
    pose_log *log = calloc(1, sizeof *log);
    imk_log_settings settings = imk_log_default();
    settings.rate = rate;
    if (imk_log_load(path, &settings, NULL, &log->log, NULL) != IMK_OK) {
        free(log);
        return NULL;
    }
    imk_log *l = &log->log;
    imk_test_record *r = &log->record;
    *r = (imk_test_record){.name = path, .count = l->rows, .dt = l->findings.interval};
    const int time = imk_log_find(l, IMK_QUANTITY_TIME, -1);
    if (time >= 0)
        r->time = l->data[time];
    for (int c = 0; c < 6; c++) {
        const int column =
            imk_log_find(l, c < 3 ? IMK_QUANTITY_ANGULAR_RATE : IMK_QUANTITY_SPECIFIC_FORCE, c % 3);
        assert_true(column >= 0);
        log->value[c] = l->data[column];
        r->reading[c / 3][c % 3] = l->data[column];
        r->axis_count[c / 3]++;
        r->counts[c / 3] = counts;
    }
    for (size_t c = 0; c < l->column_count; c++)
        if (l->column[c].label) {
            log->section = malloc(l->rows * sizeof *log->section);
            for (size_t k = 0; k < l->rows; k++)
                log->section[k] = (int)l->data[c][k];
            r->section = log->section;
            r->section_count = l->label_count;
        }
    return log;
}

static inline void pose_log_detect(pose_log *log, const imk_static_settings *settings,
                                   const imk_model *model)
{
    const size_t size = imk_static_workspace_size(&log->record, settings);
    void *workspace = malloc(size);
    if (!log->activity)
        log->activity = malloc(log->record.count * sizeof(double));
    CHECK_OK(imk_static_detect(&log->record, settings, model, log->interval, POSE_LOG_INTERVALS,
                               &log->count, log->activity, &log->findings, workspace, size, NULL));
    free(workspace);
}

#endif
