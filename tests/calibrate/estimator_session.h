/* SPDX-License-Identifier: Apache-2.0 */
/* Bench tests drawn as observations: readings of a unit with known errors, by imk_distort(), with
 * normal errors of their means. */
#ifndef IMUKIT_TEST_ESTIMATOR_SESSION_H
#define IMUKIT_TEST_ESTIMATOR_SESSION_H

#include "imukit/calibration.h"
#include "imukit/earth.h"
#include "imukit/random.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { BENCH_OBSERVATIONS = 512, BENCH_NORMALS = 16384 };

typedef struct session {
    imk_calibration calibration;
    imk_calibration_result result;
    imk_observation observation[BENCH_OBSERVATIONS];
    imk_turn turn[BENCH_OBSERVATIONS];
    imk_model truth;
    double sigma[2];    /* of a mean [rad/s], [m/s^2] */
    double understated; /* sigmas are stated so many times too small */
    double place;       /* latitude [rad] */
    double normal[BENCH_NORMALS];
    size_t used;
    void *workspace;
    size_t workspace_size;
    imk_error error;
} session;

static inline double session_normal(session *b)
{
    return b->normal[b->used++ % BENCH_NORMALS];
}

/* Errors of a MEMS unit in the upper triangular frame. */
static inline imk_model session_truth(void)
{
    static const double scale[2][3] = {{.004, -.007, .002}, {.003, -.002, .004}};
    static const double bias[2][3] = {{.01, -.02, .005}, {.1, -.05, .2}};
    imk_model m;
    imk_model_default(&m);
    for (int i = 0; i < 3; i++) {
        m.gyro.bias.fixed.value[i] = bias[0][i];
        m.accel.bias.fixed.value[i] = bias[1][i];
        m.gyro.scale_factor.fixed.value[i] = scale[0][i];
        m.accel.scale_factor.fixed.value[i] = scale[1][i];
        for (int j = 0; j < 3; j++) {
            m.gyro.g_sensitivity.value[i][j] = 1e-5 * (i - j + 0.5);
            m.gyro.misalignment.value[i][j] = i == j ? 0.0 : .002 * (i - 2 * j + 1.3);
            m.accel.misalignment.value[i][j] = i >= j ? 0.0 : .003 * (i - j + 1.6);
        }
    }
    return m;
}

static inline session *session_new(uint64_t seed, uint32_t number)
{
    session *b = calloc(1, sizeof *b);
    if (!b)
        abort();
    imk_calibration_default(&b->calibration);
    b->calibration.latitude = b->place = 0.8;
    b->calibration.observation = b->observation;
    b->calibration.turn = b->turn;
    b->calibration.observation_capacity = b->calibration.turn_capacity = BENCH_OBSERVATIONS;
    b->truth = session_truth();
    b->sigma[IMK_GYRO] = 3e-5;
    b->sigma[IMK_ACCEL] = 1e-3;
    b->understated = 1.0;
    imk_random_normals(imk_random_seeded(seed), imk_stream(number, 900, 0, 0), 0, BENCH_NORMALS,
                       b->normal);
    return b;
}

static inline void session_free(session *b)
{
    free(b->workspace);
    free(b);
}

static inline void session_unit_vector(session *b, double v[3])
{
    double norm;
    do {
        norm = 0.0;
        for (int j = 0; j < 3; j++) {
            v[j] = session_normal(b);
            norm += v[j] * v[j];
        }
    } while (norm < 1e-6);
    for (int j = 0; j < 3; j++)
        v[j] /= sqrt(norm);
}

/* Readings of an exposure, with errors. */
static inline imk_observation session_read(session *b, const double rate[3], const double force[3],
                                           const double acceleration[3], double temperature)
{
    imk_observation o;
    memset(&o, 0, sizeof o);
    imk_distortion distortion;
    imk_stimulus stimulus;
    memset(&stimulus, 0, sizeof stimulus);
    if (imk_distortion_start(&distortion, &b->truth, NULL, IMK_KERNEL_SCALAR, NULL) != IMK_OK)
        abort();
    for (int j = 0; j < 3; j++) {
        stimulus.angular_rate[j] = &rate[j];
        stimulus.specific_force[j] = &force[j];
        stimulus.angular_acceleration[j] = acceleration ? &acceleration[j] : NULL;
        o.rate[j] = rate[j];
        o.force[j] = force[j];
        o.angular_acceleration[j] = acceleration ? acceleration[j] : 0.0;
    }
    stimulus.temperature = isnan(temperature) ? NULL : &temperature;
    o.temperature = temperature;
    o.record = o.fixture = -1;
    for (int sensor = 0; sensor < 2; sensor++)
        for (int axis = 0; axis < IMK_AXES_MAX; axis++) {
            o.reading[sensor][axis] = (double)NAN;
            if (axis >= distortion.axis_count[sensor])
                continue;
            double value;
            imk_distort(&distortion, sensor, axis, &stimulus, 1, &value);
            o.sigma[sensor][axis] = b->sigma[sensor] / b->understated;
            o.reading[sensor][axis] = value + b->sigma[sensor] * session_normal(b);
        }
    return o;
}

/* A pose at rest with any heading. `wrong`: |force| is so many times gravity. */
static inline void session_pose_along(session *b, const double vertical[3], double wrong)
{
    imk_calibration *c = &b->calibration;
    double other[3], rate[3], force[3], along = 0.0, norm = 0.0;
    session_unit_vector(b, other);
    for (int j = 0; j < 3; j++)
        along += other[j] * vertical[j];
    for (int j = 0; j < 3; j++) {
        other[j] -= along * vertical[j];
        norm += other[j] * other[j];
    }
    for (int j = 0; j < 3; j++) {
        force[j] = wrong * c->gravity * vertical[j];
        rate[j] =
            c->earth_rate * (sin(b->place) * vertical[j] + cos(b->place) * other[j] / sqrt(norm));
    }
    imk_observation o = session_read(b, rate, force, NULL, (double)NAN);
    o.knowledge = IMK_INPUT_GRAVITY;
    memset(o.force, 0, sizeof o.force);
    memset(o.rate, 0, sizeof o.rate);
    (void)imk_calibration_observe(c, &o);
}

static inline void session_pose(session *b, double wrong)
{
    double vertical[3];
    session_unit_vector(b, vertical);
    session_pose_along(b, vertical, wrong);
}

/* A table or centrifuge: rate up to 2 rad/s, force up to 20 m/s^2 on each axis. */
static inline void session_known(session *b)
{
    double rate[3], force[3];
    for (int j = 0; j < 3; j++) {
        rate[j] = fmax(-2.0, fmin(2.0, session_normal(b)));
        force[j] = fmax(-20.0, fmin(20.0, 8.0 * session_normal(b)));
    }
    const imk_observation o = session_read(b, rate, force, NULL, (double)NAN);
    (void)imk_calibration_observe(&b->calibration, &o);
}

/* Free a term on three axes; rows without their diagonal, `triangle`: its upper part only. */
static inline void session_free_term(session *b, int sensor, int term, bool triangle)
{
    const int elements = imk_model_term_elements(sensor, term);
    const bool rows = term == IMK_MODEL_MISALIGNMENT || term == IMK_MODEL_CROSS_AXIS;
    for (int axis = 0; axis < 3; axis++)
        for (int k = 0; k < elements; k++)
            if (!rows || (triangle ? k > axis : k != axis))
                (void)imk_calibration_free(&b->calibration, sensor, term, axis, k);
}

/* What poses under gravity determine. */
static inline void session_free_static(session *b)
{
    session_free_term(b, IMK_ACCEL, IMK_MODEL_BIAS, false);
    session_free_term(b, IMK_ACCEL, IMK_MODEL_SCALE_FACTOR, false);
    session_free_term(b, IMK_ACCEL, IMK_MODEL_MISALIGNMENT,
                      b->calibration.frame == IMK_FRAME_UPPER);
    session_free_term(b, IMK_GYRO, IMK_MODEL_BIAS, false);
    session_free_term(b, IMK_GYRO, IMK_MODEL_G_SENSITIVITY, false);
}

static inline void session_free_all(session *b)
{
    session_free_static(b);
    session_free_term(b, IMK_GYRO, IMK_MODEL_SCALE_FACTOR, false);
    session_free_term(b, IMK_GYRO, IMK_MODEL_MISALIGNMENT, false);
}

/* Everything that is not estimated is known as it is. */
static inline void session_know_the_rest(session *b)
{
    b->calibration.model = b->truth;
    for (size_t p = 0; p < b->calibration.parameter_count; p++)
        *imk_model_parameter_at(&b->calibration.model, b->calibration.parameter[p], NULL) = 0.0;
}

static inline imk_status session_solve(session *b)
{
    const size_t size = imk_calibration_workspace_size(&b->calibration);
    if (size > b->workspace_size) {
        free(b->workspace);
        b->workspace = malloc(size);
        b->workspace_size = size;
    }
    if (!b->workspace)
        abort();
    return imk_calibration_solve(&b->calibration, &b->result, b->workspace, size, &b->error);
}

#endif
