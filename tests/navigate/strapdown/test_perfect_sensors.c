/* SPDX-License-Identifier: Apache-2.0 */
/* Perfect sensors on a trajectory lead the mechanisation to where the trajectory ends: motion and
 * navigation assess each other, having nothing in common but gravity. */
#include "car_profile.h"
#include "check.h"

#include "imukit/motion.h"
#include "imukit/navigate.h"

#include <stdlib.h>

static const double pi = 3.14159265358979323846;

static imk_navigation_state truth_at(const imk_trajectory *trajectory, double time)
{
    imk_motion_state state;
    imk_trajectory_state(trajectory, time, &state);
    return (imk_navigation_state){time, state.position, state.velocity, state.attitude};
}

/* What a run from 0 to `seconds` misses: position [m], velocity [m/s], attitude [rad]. */
typedef struct missed {
    double position, velocity, attitude;
} missed;

/* Step by step, or in blocks. */
static missed run(const imk_trajectory *trajectory, double seconds, double rate, bool blocks)
{
    const size_t count = (size_t)(seconds * rate + 0.5);
    double *memory = malloc((7 * count + 1) * sizeof *memory), *boundary = memory;
    assert_non_null(memory);
    double *gyro[3], *accel[3];
    for (size_t i = 0; i < 3; i++) {
        gyro[i] = memory + (1 + i) * count + 1;
        accel[i] = memory + (4 + i) * count + 1;
    }
    for (size_t k = 0; k <= count; k++)
        boundary[k] = (double)k / rate;
    imk_trajectory_means(trajectory, IMK_KERNEL_SCALAR, count, boundary, gyro, NULL, accel);

    const imk_navigation_state start = truth_at(trajectory, 0.0);
    const imk_navigation_state end = truth_at(trajectory, boundary[count]);
    imk_strapdown strapdown = imk_strapdown_start(&start);
    const double *const channel[6] = {gyro[0], gyro[1], gyro[2], accel[0], accel[1], accel[2]};
    if (blocks)
        imk_strapdown_run(&strapdown, count, 1.0 / rate, channel, NULL, NULL);
    for (size_t k = 0; k < count && !blocks; k++) {
        const double dt = boundary[k + 1] - boundary[k];
        const imk_vector3 rates = {{gyro[0][k], gyro[1][k], gyro[2][k]}};
        const imk_vector3 forces = {{accel[0][k], accel[1][k], accel[2][k]}};
        imk_strapdown_step(&strapdown, dt, imk_vector3_scale(rates, dt),
                           imk_vector3_scale(forces, dt));
    }
    free(memory);
    const imk_navigation_state *s = &strapdown.state;
    const imk_quaternion off =
        imk_quaternion_multiply(imk_quaternion_conjugate(end.attitude), s->attitude);
    const missed result = {
        .position = imk_vector3_norm(imk_vector3_subtract(s->position, end.position)),
        .velocity = imk_vector3_norm(imk_vector3_subtract(s->velocity, end.velocity)),
        .attitude = 2.0 * imk_vector3_norm((imk_vector3){{off.x, off.y, off.z}})};
    print_message("%g s at %g Hz, %s: %.2e m, %.2e m/s, %.2e rad\n", seconds, rate,
                  blocks ? "blocks" : "steps", result.position, result.velocity, result.attitude);
    return result;
}

static imk_trajectory_piece *car(imk_trajectory *trajectory)
{
    static imk_motion_step steps[CAR_PROFILE_STEPS];
    imk_motion_script script;
    size_t count;
    car_profile(&script, steps);
    CHECK_OK(imk_motion_script_pieces(&script, &count, NULL));
    imk_trajectory_piece *piece = malloc(count * sizeof *piece);
    assert_non_null(piece);
    CHECK_OK(imk_motion_script_compile(&script, piece, count, trajectory, NULL));
    return piece;
}

/* Ten minutes of driving. At 100 Hz the errors of second order (gravity half-way) and fourth order
 * (turning) leave 2 um, a tilt of 1e-13 rad; at 25 Hz, 256 times the latter, they leave 10 um. */
static void test_car(void **state)
{
    (void)state;
    imk_trajectory trajectory;
    imk_trajectory_piece *piece = car(&trajectory);
    const missed usual = run(&trajectory, CAR_PROFILE_DURATION, 100.0, false);
    CHECK_BELOW(usual.position, 1e-5);
    CHECK_BELOW(usual.velocity, 1e-8);
    CHECK_BELOW(usual.attitude, 1e-12);
    const missed slow = run(&trajectory, CAR_PROFILE_DURATION, 25.0, false);
    CHECK_BELOW(slow.position, 1e-4);
    CHECK_BELOW(slow.attitude, 1e-9);
    free(piece);
}

/* A minute of it with an engine that shakes: displacements of 1 mm, and rotations of 1 mrad about
 * two axes in quadrature, which is coning. With c = 1 mrad, f = 8 Hz and the phase per sample
 * x = 2 pi f/1000, coning turns by c^2 x^3/12 per sample and 0.3 x^2 of that is missed: 3e-11 rad
 * a second, 8e-10 m/s^2 of gravity in mean over a minute, 2e-6 m. Blocks miss x^2/20 instead, a
 * sixth, but see of the 13 Hz two samples at a time only: the force's mean is that of a parabola,
 * the way is by the trapezium with its end terms. */
static void test_vibrating_car(void **state)
{
    (void)state;
    imk_trajectory trajectory;
    imk_trajectory_piece *piece = car(&trajectory);
    const imk_vibration_line line[] = {
        {.axis = 3, .amplitude = 1e-3, .frequency = 8.0},
        {.axis = 4, .amplitude = 1e-3, .frequency = 8.0, .phase = 0.25},
        {.axis = 2, .amplitude = 1e-3, .frequency = 8.0, .phase = 0.1},
        {.axis = 0, .amplitude = 1e-3, .frequency = 13.0}};
    trajectory.line = line;
    trajectory.line_count = sizeof line / sizeof *line;
    assert_int_equal(imk_trajectory_substeps(&trajectory, 0.001), 1);
    for (int blocks = 0; blocks < 2; blocks++) {
        const missed result = run(&trajectory, 60.0, 1000.0, blocks);
        CHECK_BELOW(result.position, 1e-5);
        CHECK_BELOW(result.attitude, 1e-8);
    }
    free(piece);
}

/* At rest, also where longitudes mean nothing: ten minutes of rounding. */
static void test_standstill(void **state)
{
    (void)state;
    const imk_geodetic places[] = {
        {0.6, -2.0, 100.0}, {pi / 2, 0.0, 0.0}, {-pi / 2, 1.0, 2800.0}, {0.1, pi, 0.0}};
    for (size_t i = 0; i < sizeof places / sizeof *places; i++) {
        imk_trajectory trajectory;
        imk_trajectory_piece piece;
        const double angles[3] = {0.1, -0.05, 2.0};
        CHECK_OK(imk_trajectory_standstill(places[i], angles, true, &piece, &trajectory, NULL));
        const missed result = run(&trajectory, 600.0, 100.0, false);
        CHECK_BELOW(result.position, 1e-6);
        CHECK_BELOW(result.velocity, 1e-8);
        CHECK_BELOW(result.attitude, 1e-14);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_car),
        cmocka_unit_test(test_vibrating_car),
        cmocka_unit_test(test_standstill),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
