/* SPDX-License-Identifier: Apache-2.0 */
/* Gyro biases from readings at rest: exact without errors; consistent over draws, with the heading
 * given and with the heading found; readings beyond the settings; the spread of a heading against
 * its series. */
#include "check.h"

#include "imukit/linear_algebra.h"
#include "imukit/random.h"
#include "imukit/standing_start.h"
#include "navigate/filter/navigation_filter_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double degree = 0.017453292519943295, hour = 3600.0;
static const imk_geodetic place = {0.8, 0.3, 200.0};

static double normal(uint64_t run, int which)
{
    double value;
    imk_random_normals(imk_random_seeded(225), (uint64_t)which, run, 1, &value);
    return value;
}

static imk_navigation_filter_settings plain_settings(double bias, double white)
{
    imk_navigation_filter_settings s;
    imk_navigation_filter_default(&s);
    s.gyro.part_count = s.accel.part_count = 1;
    for (int i = 0; i < 3; i++) {
        s.gyro.part[0].sigma[i] = bias;
        s.gyro.white[i] = white;
        s.accel.part[0].sigma[i] = 1e-3;
    }
    return s;
}

static imk_navigation_filter *start(const imk_navigation_filter_settings *settings,
                                    const imk_navigation_state *state, void **memory)
{
    imk_navigation_filter *filter = NULL;
    const size_t size = imk_navigation_filter_size(settings);
    *memory = malloc(size);
    assert_non_null(*memory);
    CHECK_OK(imk_navigation_filter_start(settings, state, &filter, *memory, size, NULL));
    return filter;
}

static imk_vector3 earth_in_body(const imk_navigation_state *state)
{
    const imk_vector3 earth = {{0.0, 0.0, IMK_EARTH_RATE}};
    return imk_quaternion_rotate(imk_quaternion_conjugate(state->attitude), earth);
}

static imk_navigation_state standing(double roll, double pitch, double yaw)
{
    return imk_navigation_state_ned(0.0, place, (imk_vector3){{0.0, 0.0, 0.0}},
                                    imk_matrix3_from_euler(roll, pitch, yaw));
}

/* The right attitude and no noise leave the bias itself. */
static void test_exact(void **state)
{
    (void)state;
    void *memory;
    const imk_navigation_filter_settings settings = plain_settings(0.2 * degree, 0.0);
    const imk_navigation_state truth = standing(0.3, -0.1, 2.0);
    const imk_vector3 bias = {{3e-3, -2e-3, 1e-3}};
    imk_navigation_filter *filter = start(&settings, &truth, &memory);
    imk_navigation_filter_estimate estimate;
    const imk_standing_start stood = {.rate = imk_vector3_add(earth_in_body(&truth), bias),
                                      .time = 100.0,
                                      .rotation_sigma = 1e-7};
    assert_true(imk_navigation_filter_stood(filter, &stood));
    imk_navigation_filter_get(filter, &estimate);
    for (int i = 0; i < 3; i++) {
        CHECK_CLOSE(estimate.gyro_bias.v[i], bias.v[i], 1e-10); /* of 3e-3 1e-12 of the variance */
        CHECK_RELATIVE(estimate.gyro_bias_sigma.v[i], 1e-7, 1e-2);
    }
    const imk_navigation_filter_counts counts = imk_navigation_filter_counted(filter);
    assert_true(counts.accepted == 0 && counts.refused == 0 && counts.degrees == 0);
    free(memory);
}

/* Mean over draws of x^T P^-1 x of attitude errors, of which `attitude` are known to be other than
 * 0, and biases; within 4 of its standard deviations, sqrt(2 d/runs). */
static void check_consistent(bool found)
{
    enum { RUNS = 600 };
    const double bias_sigma = (found ? 1.0 : 30.0) * degree / hour, time = 200.0;
    const double white = 0.05 * degree / 60.0, heading_sigma = 2.0 * degree;
    const double horizontal = IMK_EARTH_RATE * cos(place.latitude);
    const imk_navigation_state truth = standing(0.2, 0.1, -1.0);
    double sum = 0.0;
    for (uint64_t run = 0; run < RUNS; run++) {
        void *memory;
        imk_navigation_filter_settings settings = plain_settings(bias_sigma, white);
        imk_vector3 bias, read = earth_in_body(&truth), turn = {{0.0, 0.0, 0.0}};
        for (int i = 0; i < 3; i++) {
            bias.v[i] = bias_sigma * normal(run, i);
            read.v[i] += bias.v[i] + white / sqrt(time) * normal(run, 3 + i);
        }
        const imk_matrix3 axes = imk_ned_axes(place.latitude, place.longitude);
        const imk_matrix3 c_nb = imk_matrix3_multiply(imk_matrix3_transpose(axes),
                                                      imk_quaternion_to_matrix(truth.attitude));
        const imk_vector3 off =
            imk_matrix3_apply(c_nb, imk_vector3_subtract(read, earth_in_body(&truth)));
        settings.initial_sigma[8] = heading_sigma;
        double heading = heading_sigma * normal(run, 6);
        if (found) { /* means: e_D = -(b + n)_E/w, which the settings have of b */
            settings.alignment_time = time;
            for (int i = 0; i < 3; i++)
                settings.alignment[2][i] = -c_nb.m[1][i] / horizontal;
            settings.initial_sigma[8] = white / sqrt(time) / horizontal;
            heading = -off.v[1] / horizontal;
        }
        for (int i = 0; i < 3; i++)
            turn.v[i] = heading * axes.m[i][2];
        imk_navigation_state estimated = truth;
        estimated.attitude =
            imk_quaternion_multiply(imk_quaternion_from_rotation_vector(turn), truth.attitude);
        imk_navigation_filter *filter = start(&settings, &estimated, &memory);
        const imk_standing_start stood = {.rate = read, .time = time, .heading_found = found};
        imk_navigation_filter_stood(filter, &stood);
        /* heading and biases, whose covariance is regular */
        const size_t n = filter->states;
        const double *p = imki_navigation_filter_covariance(filter);
        const imk_vector3 left = imk_quaternion_to_rotation_vector(imk_quaternion_multiply(
            filter->strapdown.state.attitude, imk_quaternion_conjugate(truth.attitude)));
        double x[4] = {
            imk_vector3_dot(left, (imk_vector3){{axes.m[0][2], axes.m[1][2], axes.m[2][2]}})};
        double a[16] = {0.0}, map[4][6] = {{axes.m[0][2], axes.m[1][2], axes.m[2][2]}};
        const size_t at[6] = {6, 7, 8, 9, 10, 11};
        for (int i = 0; i < 3; i++) {
            x[1 + i] = bias.v[i] - filter->bias_sum[IMKI_GYRO_PART].v[i];
            map[1 + i][3 + i] = 1.0;
        }
        for (int i = 0; i < 16; i++)
            for (int k = 0; k < 36; k++)
                a[i] += map[i / 4][k / 6] * p[at[k / 6] * n + at[k % 6]] * map[i % 4][k % 6];
        double factor[16], solved[4];
        memcpy(factor, a, sizeof a);
        memcpy(solved, x, sizeof x);
        CHECK_OK(imk_cholesky_factor(4, factor));
        imk_cholesky_solve(4, factor, solved);
        for (int i = 0; i < 4; i++)
            sum += x[i] * solved[i];
        free(memory);
    }
    CHECK_CLOSE(sum / RUNS, 4.0, 4.0 * sqrt(8.0 / RUNS));
}

static void test_heading_given(void **state)
{
    (void)state;
    check_consistent(false);
}

static void test_heading_found(void **state)
{
    (void)state;
    check_consistent(true);
}

/* 1 deg/s where 1 deg/h is stated: told, and taken with a sigma by which it is no miracle. */
static void test_beyond_the_settings(void **state)
{
    (void)state;
    void *memory;
    imk_navigation_filter_settings settings = plain_settings(1.0 * degree / hour, 1e-5);
    const imk_navigation_state truth = standing(0.0, 0.0, 0.0);
    imk_vector3 read = earth_in_body(&truth);
    read.v[1] += 1.0 * degree;
    imk_navigation_filter *filter = start(&settings, &truth, &memory);
    imk_navigation_filter_estimate estimate;
    const imk_standing_start stood = {.rate = read, .time = 60.0};
    assert_false(imk_navigation_filter_stood(filter, &stood));
    imk_navigation_filter_get(filter, &estimate);
    CHECK_RELATIVE(estimate.gyro_bias.v[1], 1.0 * degree, 1e-3);
    free(memory);
}

/* With k = reading earth/sigma^2 the mean square is pi^2/3 + 4 sum (-1)^n I_n(k)/(n^2 I_0(k)), here
 * by SciPy 1.10 (scipy.special.ive). */
static void test_spread(void **state)
{
    (void)state;
    static const double k[] = {0.1, 1.0, 5.0, 25.0, 400.0};
    static const double expected[] = {1.758225372532834, 1.266591606961496, 0.4766866505522572,
                                      0.2020819618618763, 0.05003132516637716};
    for (int i = 0; i < 5; i++)
        CHECK_RELATIVE(imk_heading_spread(2.0 * k[i], 0.5, 1.0), expected[i], 1e-6);
    CHECK_RELATIVE(imk_heading_spread(0.0, 1.0, 1.0), 3.14159265358979323846 / sqrt(3.0), 1e-6);
    CHECK_RELATIVE(imk_heading_spread(1.0, 1.0, 1e-3), 1e-3, 1e-3); /* sigma/earth */
    CHECK_CLOSE(imk_heading_spread(1.0, 1.0, 0.0), 0.0, 0.0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_exact),         cmocka_unit_test(test_heading_given),
        cmocka_unit_test(test_heading_found), cmocka_unit_test(test_beyond_the_settings),
        cmocka_unit_test(test_spread),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
