/* SPDX-License-Identifier: Apache-2.0 */
/* Perfect sensors lose nothing: a day at rest with the vertical slaved, ten minutes of driving,
 * wherever on Earth; along and across 180 deg of longitude, round a pole and over it. */
#include "car_profile.h"
#include "check.h"
#include "navigate/exact_motion.h"

#include "imukit/motion.h"

#include <stdlib.h>

static const double pi = 3.14159265358979323846, degree = 3.14159265358979323846 / 180.0;

/* ---- at rest ----------------------------------------------------------------------------------
 */

static exact_instant rest_at(double time)
{
    (void)time;
    return (exact_instant){.attitude =
                               imk_quaternion_from_matrix(imk_matrix3_from_euler(0.2, -0.1, 2.0))};
}

static const imk_geodetic places[] = {
    {0.785398163397448279, 0.15, 100.0}, /* 45 deg N */
    {1.57079632679489656, 0.0, 2800.0},  /* a pole */
    {-1.57079632679489656, 1.0, 2800.0}, /* the other */
    {-0.3, 3.14159265358979312, 10.0},   /* 180 deg of longitude */
    {0.0, -1.57079632679489656, 0.0},    /* the equator */
};
enum { PLACES = sizeof places / sizeof *places };

/* A day in steps of a second: 1 m is asked for. What there is are the third powers of the Earth's
 * turn in a step, h = 7e-5: a force of g h^3/24 = 2e-13 m/s^2, and Schuler's oscillation makes
 * 2e-13/(1.2e-3)^2 = 1e-7 m of it; and rounding. */
static void test_a_day_at_rest(void **state)
{
    (void)state;
    for (int i = 0; i < PLACES; i++) {
        const exact_motion motion = {places[i], rest_at};
        const imk_navigation_state start = exact_state(&motion, 0.0);
        imk_strapdown strapdown = imk_strapdown_start(&start);
        strapdown.hold_height = true;
        imk_vector3 angle, velocity;
        exact_increments(&motion, 0.0, 1.0, &angle, &velocity);
        double farthest = 0.0;
        for (int k = 0; k < 86400; k++) {
            imk_strapdown_step(&strapdown, 1.0, angle, velocity);
            farthest = fmax(farthest, exact_compare(&strapdown.state, &start).position);
        }
        const exact_error error = exact_compare(&strapdown.state, &start);
        print_message("a day at latitude %.4g deg: %.2e m at most; %.2e m/s, %.2e rad at the end\n",
                      places[i].latitude / degree, farthest, error.velocity, error.attitude);
        CHECK_BELOW(farthest, 1e-5);
        CHECK_BELOW(error.attitude, 1e-14);
    }
}

/* The same in blocks (imk_strapdown_run), at 45 deg a hundred times a second, at a pole ten times:
 * blocks are 0.16 s and 0.2 s long, so that third powers of h are nothing. */
static void test_a_day_of_blocks(void **state)
{
    (void)state;
    enum { ROWS = 6000 };
    double *memory = malloc(6 * ROWS * sizeof *memory);
    const double *channel[6];
    assert_non_null(memory);
    for (int i = 0; i < 2; i++) {
        const exact_motion motion = {places[i], rest_at};
        const imk_navigation_state start = exact_state(&motion, 0.0);
        imk_strapdown strapdown = imk_strapdown_start(&start);
        strapdown.hold_height = true;
        const double rate = i == 0 ? 100.0 : 10.0;
        const int calls = (int)(86400.0 * rate / ROWS + 0.5);
        imk_vector3 angle, velocity;
        exact_increments(&motion, 0.0, 1.0 / rate, &angle, &velocity);
        for (size_t k = 0; k < 6 * ROWS; k++)
            memory[k] = rate * (k < 3 * ROWS ? angle.v[k / ROWS] : velocity.v[k / ROWS - 3]);
        for (size_t k = 0; k < 6; k++)
            channel[k] = memory + k * ROWS;
        double farthest = 0.0;
        for (int call = 0; call < calls; call++) {
            imk_strapdown_run(&strapdown, ROWS, 1.0 / rate, channel, NULL, NULL);
            farthest = fmax(farthest, exact_compare(&strapdown.state, &start).position);
        }
        print_message("a day of blocks at %g Hz: %.2e m at most\n", rate, farthest);
        CHECK_CLOSE(strapdown.state.time, 86400.0, 1e-4); /* the sum of 8.6e6 intervals */
        CHECK_BELOW(farthest, 1e-6);
    }
    free(memory);
}

/* ---- a car ------------------------------------------------------------------------------------
 */

typedef struct drive {
    size_t count;
    imk_navigation_state start, end;
    double *means[6], *memory;
    double least_longitude, largest_longitude, end_longitude; /* on the way, and where it ends */
} drive;

static imk_navigation_state truth_at(const imk_trajectory *trajectory, double time)
{
    imk_motion_state state;
    imk_trajectory_state(trajectory, time, &state);
    return (imk_navigation_state){time, state.position, state.velocity, state.attitude};
}

static drive drive_from(imk_geodetic place, double heading)
{
    static const double rate = 100.0;
    drive d = {.count = (size_t)(CAR_PROFILE_DURATION * rate + 0.5)};
    imk_motion_step steps[CAR_PROFILE_STEPS];
    imk_motion_script script;
    imk_trajectory trajectory;
    size_t pieces;
    car_profile(&script, steps);
    script.place = place;
    script.heading = heading;
    CHECK_OK(imk_motion_script_pieces(&script, &pieces, NULL));
    imk_trajectory_piece *piece = malloc(pieces * sizeof *piece);
    d.memory = malloc((7 * d.count + 1) * sizeof *d.memory);
    assert_non_null(piece);
    assert_non_null(d.memory);
    CHECK_OK(imk_motion_script_compile(&script, piece, pieces, &trajectory, NULL));
    double *boundary = d.memory + 6 * d.count;
    for (size_t k = 0; k <= d.count; k++)
        boundary[k] = (double)k / rate;
    for (size_t i = 0; i < 6; i++)
        d.means[i] = d.memory + i * d.count;
    imk_trajectory_means(&trajectory, imk_random_seeded(0).kernel, d.count, boundary, d.means, NULL,
                         d.means + 3);
    d.start = truth_at(&trajectory, 0.0);
    d.end = truth_at(&trajectory, boundary[d.count]);
    for (size_t k = 0; k <= d.count; k += 1000) {
        const imk_navigation_state now = truth_at(&trajectory, boundary[k]);
        const double longitude = imk_geodetic_from_ecef(now.position).longitude;
        d.least_longitude = fmin(d.least_longitude, longitude);
        d.largest_longitude = fmax(d.largest_longitude, longitude);
        d.end_longitude = longitude;
    }
    free(piece);
    return d;
}

static exact_error drive_by_step(const drive *d)
{
    imk_strapdown strapdown = imk_strapdown_start(&d->start);
    for (size_t k = 0; k < d->count; k++) {
        imk_vector3 angle, velocity;
        for (int i = 0; i < 3; i++) {
            angle.v[i] = 0.01 * d->means[i][k];
            velocity.v[i] = 0.01 * d->means[3 + i][k];
        }
        imk_strapdown_step(&strapdown, 0.01, angle, velocity);
    }
    return exact_compare(&strapdown.state, &d->end);
}

static exact_error drive_by_blocks(const drive *d)
{
    imk_strapdown strapdown = imk_strapdown_start(&d->start);
    imk_strapdown_run(&strapdown, d->count, 0.01, (const double *const *)d->means, NULL, NULL);
    return exact_compare(&strapdown.state, &d->end);
}

/* 1 mm is asked for. There is the fourth order of turning and the second of gravity half-way
 * through the step: 0.1 um at 45 deg, and in blocks 1 um. */
static void check_drive(const char *where, const drive *d)
{
    for (int blocks = 0; blocks < 2; blocks++) {
        const exact_error error = blocks ? drive_by_blocks(d) : drive_by_step(d);
        print_message("%s, %s: %.2e m, %.2e m/s, %.2e rad\n", where, blocks ? "blocks" : "steps",
                      error.position, error.velocity, error.attitude);
        CHECK_BELOW(error.position, 1e-5);
        CHECK_BELOW(error.velocity, 1e-7);
        CHECK_BELOW(error.attitude, 1e-11);
    }
}

static void test_car(void **state)
{
    (void)state;
    drive d = drive_from((imk_geodetic){45.0 * degree, 7.0 * degree, 300.0}, 20.0 * degree);
    check_drive("45 deg", &d);
    free(d.memory);
}

/* From 3 km west of 180 deg: across it and back again. */
static void test_car_across_the_date_line(void **state)
{
    (void)state;
    drive d =
        drive_from((imk_geodetic){-17.0 * degree, 180.0 * degree - 5.5e-4, 5.0}, 20.0 * degree);
    CHECK_BELOW(d.least_longitude, -pi + 1e-3);
    CHECK_BELOW(pi - 1e-3, d.largest_longitude);
    CHECK_BELOW(pi - 1e-3, d.end_longitude);
    check_drive("across 180 deg", &d);
    free(d.memory);
}

/* 22 km from the pole, where a constant heading is a curve: scripts go no nearer than 11 km. */
static void test_car_round_the_pole(void **state)
{
    (void)state;
    for (int south = 0; south < 2; south++) {
        const double latitude = 89.8 * degree;
        drive d =
            drive_from((imk_geodetic){south ? -latitude : latitude, 2.0, 2800.0}, 90.0 * degree);
        check_drive(south ? "round the south pole" : "round the north pole", &d);
        free(d.memory);
    }
}

/* ---- over the pole ----------------------------------------------------------------------------
 */

/* 3 km towards the pole and 3 km beyond at 20 m/s, straight but for a metre of weaving, over the
 * pole itself half-way; in the axes of the pole. */
static exact_instant over_at(double time)
{
    double across[3] = {0}, down[3] = {0}, angle[3][3] = {{0}}, euler[3], rate[3];
    exact_wave(1.0, 0.0, 2 * pi / 50, time, across);
    exact_wave(0.01, 0.0, 2 * pi * 1.5, time, down);
    exact_wave(0.0, 0.02, 2 * pi * 0.7, time, angle[0]);
    exact_wave(0.01, 0.01, 2 * pi * 0.9, time, angle[1]);
    exact_wave(0.05, 0.0, 2 * pi / 25, time, angle[2]);
    for (int i = 0; i < 3; i++) {
        euler[i] = angle[i][0];
        rate[i] = angle[i][1];
    }
    const imk_matrix3 attitude = imk_matrix3_from_euler(euler[0], euler[1], euler[2]);
    return (exact_instant){.position = {{20.0 * time - 3000.0, across[0], down[0]}},
                           .velocity = {{20.0, across[1], down[1]}},
                           .acceleration = {{0.0, across[2], down[2]}},
                           .attitude = imk_quaternion_from_matrix(attitude),
                           .rate = exact_euler_rate(euler, rate)};
}

/* Free, and slaved to the true height and climb. The turning of fourth order leaves a tilt of 2
 * nrad, and this in five minutes g t^2/2 of it, some tenths of a millimetre. */
static void test_over_the_pole(void **state)
{
    (void)state;
    for (int slaved = 0; slaved < 2; slaved++)
        for (int south = 0; south < 2; south++) {
            const exact_motion motion = {{south ? -pi / 2 : pi / 2, 0.0, 10.0}, over_at};
            const imk_navigation_state start = exact_state(&motion, 0.0);
            imk_strapdown strapdown = imk_strapdown_start(&start);
            strapdown.hold_height = slaved;
            double nearest = 1e9;
            for (int k = 1; k <= 30000; k++) {
                imk_vector3 angle, velocity;
                exact_increments(&motion, (k - 1) / 100.0, k / 100.0, &angle, &velocity);
                if (slaved) {
                    const imk_navigation_state truth = exact_state(&motion, k / 100.0);
                    imk_geodetic place;
                    imk_vector3 ned;
                    imk_navigation_state_to_ned(&truth, &place, &ned, NULL);
                    strapdown.height = place.height;
                    strapdown.climb = -ned.v[2];
                }
                imk_strapdown_step(&strapdown, 0.01, angle, velocity);
                nearest = fmin(nearest,
                               hypot(strapdown.state.position.v[0], strapdown.state.position.v[1]));
            }
            const imk_navigation_state end = exact_state(&motion, 300.0);
            const exact_error error = exact_compare(&strapdown.state, &end);
            print_message("over the %s pole, %s: past it at %.1e m; %.2e m, %.2e m/s, %.2e rad\n",
                          south ? "south" : "north", slaved ? "slaved" : "free", nearest,
                          error.position, error.velocity, error.attitude);
            CHECK_BELOW(nearest, 1e-3);
            CHECK_BELOW(error.position, 1e-3);
            CHECK_BELOW(error.velocity, 1e-5);
            CHECK_BELOW(error.attitude, 5e-9);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_a_day_at_rest),
        cmocka_unit_test(test_a_day_of_blocks),
        cmocka_unit_test(test_car),
        cmocka_unit_test(test_car_across_the_date_line),
        cmocka_unit_test(test_car_round_the_pole),
        cmocka_unit_test(test_over_the_pole),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
