/* SPDX-License-Identifier: Apache-2.0 */
/* Drift on published truth profiles: rows of place, velocity and attitude become increments that
 * lead exactly from row to row, the deterministic errors of three grades are put on their means,
 * and the run with errors is compared with the run without. Used by the test and by
 * experiments/groves_drift.c. */
#ifndef IMUKIT_TESTS_GROVES_PROFILES_H
#define IMUKIT_TESTS_GROVES_PROFILES_H

#include "imukit/imukit.h"
#include "imukit/io.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double groves_degree = 0.017453292519943295;
static const double groves_g = 9.80665;

/* Errors in the units of the source: ug, deg/h, ppm by rows, deg/h/g by rows [GROVES2013]. */
typedef struct groves_grade {
    const char *name;
    double accel_bias[3], gyro_bias[3];
    double accel_matrix[3][3], gyro_matrix[3][3], g_sensitivity[3][3];
} groves_grade;

static const groves_grade groves_grades[] = {
    {.name = "aviation",
     .accel_bias = {30, -45, 26},
     .gyro_bias = {-0.0009, 0.0013, -0.0008},
     .accel_matrix = {{100, -120, 80}, {-60, -120, 100}, {-100, 40, 90}},
     .gyro_matrix = {{8, -120, 100}, {0, -6, -60}, {0, 0, -7}}},
    {.name = "tactical",
     .accel_bias = {900, -1300, 800},
     .gyro_bias = {-9, 13, -8},
     .accel_matrix = {{500, -300, 200}, {-150, -600, 250}, {-250, 100, 450}},
     .gyro_matrix = {{400, -300, 250}, {0, -300, -150}, {0, 0, -350}},
     .g_sensitivity = {{0.9, -1.1, -0.6}, {-0.5, 1.9, -1.6}, {0.3, 1.1, -1.3}}},
    {.name = "consumer",
     .accel_bias = {9000, -13000, 8000},
     .gyro_bias = {-180, 260, -160},
     .accel_matrix = {{50000, -15000, 10000}, {-7500, -60000, 12500}, {-12500, 5000, 20000}},
     .gyro_matrix = {{40000, -14000, 12500}, {0, -30000, -7500}, {0, 0, -17500}},
     .g_sensitivity = {{90, -110, -60}, {-50, 190, -160}, {30, 110, -130}}},
};
enum { GROVES_GRADES = sizeof groves_grades / sizeof *groves_grades };

/* A grade as a model: the diagonal of a matrix is the scale factor, the rest misalignment. */
static inline imk_model groves_model(const groves_grade *grade)
{
    imk_model model;
    imk_model_default(&model);
    const double per_hour = groves_degree / 3600.0;
    for (int i = 0; i < 3; i++) {
        model.accel.bias.fixed.value[i] = grade->accel_bias[i] * 1e-6 * groves_g;
        model.gyro.bias.fixed.value[i] = grade->gyro_bias[i] * per_hour;
        model.accel.scale_factor.fixed.value[i] = grade->accel_matrix[i][i] * 1e-6;
        model.gyro.scale_factor.fixed.value[i] = grade->gyro_matrix[i][i] * 1e-6;
        for (int j = 0; j < 3; j++) {
            model.gyro.g_sensitivity.value[i][j] = grade->g_sensitivity[i][j] * per_hour / groves_g;
            if (i == j)
                continue;
            model.accel.misalignment.value[i][j] = grade->accel_matrix[i][j] * 1e-6;
            model.gyro.misalignment.value[i][j] = grade->gyro_matrix[i][j] * 1e-6;
        }
    }
    return model;
}

/* A profile: its first state, and the mean rate and specific force between rows. */
typedef struct groves_profile {
    size_t count; /* of intervals */
    double *time; /* of the rows, count + 1 */
    double *memory;
    double *rate[3], *force[3], *wrong_rate[3], *wrong_force[3];
    imk_navigation_state start, end;
} groves_profile;

static inline imk_navigation_state groves_row(const imk_log *log, const int column[10], size_t row)
{
    double v[10];
    for (int i = 0; i < 10; i++)
        v[i] = log->data[column[i]][row];
    return imk_navigation_state_ned(v[0], (imk_geodetic){v[1], v[2], v[3]},
                                    (imk_vector3){{v[4], v[5], v[6]}},
                                    imk_matrix3_from_euler(v[7], v[8], v[9]));
}

static inline void groves_means(groves_profile *profile, const imk_log *log, const int column[10])
{
    imk_navigation_state from = profile->start = groves_row(log, column, 0);
    profile->time[0] = from.time;
    for (size_t k = 0; k < profile->count; k++) {
        const imk_navigation_state to = groves_row(log, column, k + 1);
        const double dt = to.time - from.time;
        imk_vector3 angle, velocity;
        imk_strapdown_invert(&from, &to, &angle, &velocity);
        for (int i = 0; i < 3; i++) {
            profile->rate[i][k] = angle.v[i] / dt;
            profile->force[i][k] = velocity.v[i] / dt;
        }
        profile->time[k + 1] = to.time;
        from = to;
    }
    profile->end = from;
}

/* False when there is no such file, or it is another one. */
static inline bool groves_load(const char *path, groves_profile *profile)
{
    static const char *const names[10] = {"time",      "latitude", "longitude", "height",
                                          "vel_north", "vel_east", "vel_down",  "roll",
                                          "pitch",     "yaw"};
    const imk_log_settings settings = imk_log_settings_default();
    imk_log log;
    *profile = (groves_profile){0};
    if (imk_log_load(path, &settings, NULL, &log, NULL) != IMK_OK)
        return false;
    int column[10], found = 0;
    for (int i = 0; i < 10; i++)
        for (size_t j = 0; j < log.column_count; j++)
            if (strcmp(log.column[j].name, names[i]) == 0) {
                column[i] = (int)j;
                found++;
            }
    bool done = found == 10 && log.rows > 1;
    if (done) {
        const size_t n = profile->count = log.rows - 1;
        profile->memory = malloc((13 * n + 1) * sizeof(double));
        done = profile->memory != NULL;
    }
    if (done) {
        double *next = profile->memory;
        for (int i = 0; i < 3; i++) {
            profile->rate[i] = next, next += profile->count;
            profile->force[i] = next, next += profile->count;
            profile->wrong_rate[i] = next, next += profile->count;
            profile->wrong_force[i] = next, next += profile->count;
        }
        profile->time = next;
        groves_means(profile, &log, column);
    }
    imk_log_free(&log);
    return done;
}

static inline void groves_free(groves_profile *profile)
{
    free(profile->memory);
    *profile = (groves_profile){0};
}

/* Put the errors of a grade on the means. */
static inline imk_status groves_distort(groves_profile *profile, const groves_grade *grade)
{
    const imk_model model = groves_model(grade);
    imk_distortion distortion;
    const imk_status status =
        imk_distortion_start(&distortion, &model, NULL, IMK_KERNEL_SCALAR, NULL);
    if (status != IMK_OK)
        return status;
    imk_stimulus stimulus = {0};
    for (int i = 0; i < 3; i++) {
        stimulus.angular_rate[i] = profile->rate[i];
        stimulus.specific_force[i] = profile->force[i];
    }
    for (int i = 0; i < 3; i++) {
        imk_distort(&distortion, IMK_GYRO, i, &stimulus, profile->count, profile->wrong_rate[i]);
        imk_distort(&distortion, IMK_ACCEL, i, &stimulus, profile->count, profile->wrong_force[i]);
    }
    return IMK_OK;
}

/* Mechanise sample k. */
static inline void groves_step(imk_strapdown *strapdown, const groves_profile *profile,
                               double *const rate[3], double *const force[3], size_t k)
{
    const double dt = profile->time[k + 1] - profile->time[k];
    imk_vector3 angle, velocity;
    for (int i = 0; i < 3; i++) {
        angle.v[i] = rate[i][k] * dt;
        velocity.v[i] = force[i][k] * dt;
    }
    imk_strapdown_step(strapdown, dt, angle, velocity);
}

/* a - b in metres as the source has it: differences of latitude, longitude and height, with the
 * radii of curvature at b. Over 15 km it differs by 17 m down from that along straight axes. */
static inline imk_vector3 groves_difference(const imk_navigation_state *a,
                                            const imk_navigation_state *b)
{
    imk_geodetic there, here;
    double meridian, prime_vertical;
    imk_navigation_state_to_ned(a, &there, NULL, NULL);
    imk_navigation_state_to_ned(b, &here, NULL, NULL);
    imk_curvature_radii(here.latitude, &meridian, &prime_vertical);
    return (imk_vector3){{(there.latitude - here.latitude) * (meridian + here.height),
                          (there.longitude - here.longitude) * (prime_vertical + here.height) *
                              imk_cos(here.latitude),
                          here.height - there.height}};
}

/* Drift [m], north, east, down, after each of `count` increasing times [s] since the start: the
 * run with errors less the run without. */
static inline void groves_drift(const groves_profile *profile, size_t count, const double *after,
                                imk_vector3 *drift)
{
    imk_strapdown good = imk_strapdown_start(&profile->start), wrong = good;
    good.samples = wrong.samples = 1;
    for (size_t k = 0, next = 0; k < profile->count && next < count; k++) {
        groves_step(&good, profile, profile->rate, profile->force, k);
        groves_step(&wrong, profile, profile->wrong_rate, profile->wrong_force, k);
        /* Rows are 10 ms apart; the last one may fall short of the time by rounding. */
        if (profile->time[k + 1] - profile->time[0] > after[next] - 1e-3)
            drift[next++] = groves_difference(&wrong.state, &good.state);
    }
}

enum { GROVES_TIMES_MAX = 8 };

/* Published drift of a profile and grade. */
typedef struct groves_published {
    size_t count;
    double after[GROVES_TIMES_MAX];
    imk_vector3 drift[GROVES_TIMES_MAX];
} groves_published;

/* Rows of one profile and grade without initial errors, each time once. */
static inline bool groves_read_published(const char *path, int profile, const char *grade,
                                         groves_published *rows)
{
    FILE *file = fopen(path, "r");
    if (file == NULL)
        return false;
    char line[512], start[64];
    snprintf(start, sizeof start, "Profile_%d.csv,%s,none,NED,", profile, grade);
    *rows = (groves_published){0};
    while (fgets(line, sizeof line, file) != NULL && rows->count < GROVES_TIMES_MAX) {
        double t;
        imk_vector3 d;
        if (strncmp(line, start, strlen(start)) != 0 ||
            sscanf(line + strlen(start), "%lf,%lf,%lf,%lf", &t, &d.v[0], &d.v[1], &d.v[2]) != 4)
            continue;
        if (rows->count > 0 && rows->after[rows->count - 1] == t)
            continue;
        rows->after[rows->count] = t;
        rows->drift[rows->count++] = d;
    }
    fclose(file);
    return rows->count > 0;
}

#endif
