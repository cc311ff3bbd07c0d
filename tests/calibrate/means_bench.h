/* SPDX-License-Identifier: Apache-2.0 */
/* Tables of pose means, drawn, and calibrated by the job: the readings of estimator_session.h as
 * columns, with or without how well they are known. */
#ifndef IMUKIT_TEST_MEANS_BENCH_H
#define IMUKIT_TEST_MEANS_BENCH_H

#include "coverage.h"
#include "estimator_session.h"

#include "imukit/jobs.h"

enum { MEANS_POSES = 64, MEANS_COLUMNS = 13 };

typedef struct means_plan {
    const char *name;
    int poses, bad;     /* of multiposition: of any attitude; bad: force 3 % off */
    int rounds;         /* of sixposition instead: each face so often */
    double placement;   /* 1 sigma, as stated [rad] */
    bool stated;        /* columns of standard deviations and samples */
    double understated; /* standard deviations are so many times too small */
    bool counts;        /* 4000 counts per m/s^2, 1e5 per rad/s, given; means are not rounded */
} means_plan;

typedef struct means_bench {
    session *of; /* truth, draws */
    double column[MEANS_COLUMNS][MEANS_POSES];
    size_t rows;
    imk_array_source arrays;
    imk_record_source source;
} means_bench;

static const double means_sensitivity[2] = {1e5, 4000};

/* The errors of a row's means are of different sizes: 100 to 900 samples. */
static inline void means_row(means_bench *b, const means_plan *plan, const double vertical[3],
                             double wrong)
{
    session *s = b->of;
    const double usual[2] = {3e-5, 1e-3};
    const int samples = 100 * (1 + (int)(b->rows % 9));
    const double sample[2] = {usual[0] * 20, usual[1] * 20}; /* 400 samples are usual */
    for (int sensor = 0; sensor < 2; sensor++)
        s->sigma[sensor] = plan->stated ? sample[sensor] / sqrt(samples) : usual[sensor];
    session_pose_along(s, vertical, wrong);
    const imk_observation *o = &s->observation[s->calibration.observation_count - 1];
    for (int k = 0; k < 6; k++) {
        const int sensor = k / 3;
        const double unit = plan->counts ? means_sensitivity[sensor] : 1;
        const double shown = 1 + session_normal(s) / sqrt(2.0 * samples);
        b->column[k][b->rows] = unit * o->reading[sensor][k % 3];
        b->column[6 + k][b->rows] = unit * sample[sensor] * shown / plan->understated;
    }
    b->column[12][b->rows++] = samples;
}

static inline void means_fill(means_bench *b, const means_plan *plan)
{
    for (int k = 0; k < plan->poses; k++) {
        double vertical[3];
        session_unit_vector(b->of, vertical);
        means_row(b, plan, vertical, k < plan->bad ? 1.03 : 1.0);
    }
    for (int k = 0; k < 6 * plan->rounds; k++) {
        double vertical[3] = {0, 0, 0}, norm = 0;
        for (int j = 0; j < 3; j++) {
            const double face = j == k % 6 / 2 ? (k % 2 ? -1 : 1) : 0;
            vertical[j] = face != 0 ? face : plan->placement * session_normal(b->of);
            norm += vertical[j] * vertical[j];
        }
        for (int j = 0; j < 3; j++)
            vertical[j] /= sqrt(norm);
        means_row(b, plan, vertical, 1);
    }
}

/* Draw table `number`. Free it with means_free(). */
static inline means_bench *means_new(const means_plan *plan, uint64_t seed, uint32_t number)
{
    static const char *const names[2][MEANS_COLUMNS] = {
        {"gyro_x", "gyro_y", "gyro_z", "accel_x", "accel_y", "accel_z", "gyro_x_std [rad/s]",
         "gyro_y_std [rad/s]", "gyro_z_std [rad/s]", "accel_x_std [m/s^2]", "accel_y_std [m/s^2]",
         "accel_z_std [m/s^2]", "samples"},
        {"gyro_x [count]", "gyro_y [count]", "gyro_z [count]", "accel_x [count]", "accel_y [count]",
         "accel_z [count]", "gyro_x_std [count]", "gyro_y_std [count]", "gyro_z_std [count]",
         "accel_x_std [count]", "accel_y_std [count]", "accel_z_std [count]", "samples"}};
    const double *data[MEANS_COLUMNS];
    means_bench *b = calloc(1, sizeof *b);
    if (!b)
        abort();
    b->of = session_new(seed, number);
    for (int i = 0; i < 3; i++) /* of which a table says nothing */
        for (int j = 0; j < 3; j++)
            b->of->truth.gyro.scale_factor.fixed.value[i] =
                b->of->truth.gyro.misalignment.value[i][j] = 0;
    means_fill(b, plan);
    for (int k = 0; k < MEANS_COLUMNS; k++)
        data[k] = b->column[k];
    if (imk_array_source_make(plan->stated ? MEANS_COLUMNS : 6, names[plan->counts], data, b->rows,
                              1, &b->arrays, &b->source, NULL) != IMK_OK)
        abort();
    return b;
}

static inline void means_free(means_bench *b)
{
    session_free(b->of);
    free(b);
}

static inline imk_calibrate_log_settings means_settings(const means_bench *b,
                                                        const means_plan *plan)
{
    imk_calibrate_log_settings settings = imk_calibrate_log_default();
    settings.pose_means = true;
    settings.gravity = b->of->calibration.gravity;
    settings.place_known = true;
    settings.place = (imk_geodetic){.latitude = b->of->place};
    if (plan->rounds > 0)
        settings.placement = plan->placement;
    for (int sensor = 0; plan->counts && sensor < 2; sensor++)
        settings.sensitivity[sensor] = (imk_calibrate_counts){1, {means_sensitivity[sensor]}};
    return settings;
}

/* Draw and calibrate one table. */
static inline imk_status means_run(const means_plan *plan, uint64_t seed, uint32_t number,
                                   coverage_count *count, imk_error *error)
{
    means_bench *b = means_new(plan, seed, number);
    const imk_calibrate_log_settings settings = means_settings(b, plan);
    const imk_calibrate_input input = {
        "table", plan->rounds > 0 ? IMK_PROCEDURE_SIXPOSITION : IMK_PROCEDURE_MULTIPOSITION,
        &b->source};
    imk_calibrate_log *found = NULL;
    const imk_status status = imk_calibrate_logs(1, &input, &settings, NULL, &found, error);
    if (status == IMK_OK)
        coverage_add(count, found->result, &b->of->truth, 0.95);
    else
        count->failed++;
    imk_calibrate_log_free(found);
    means_free(b);
    return status;
}

#endif
