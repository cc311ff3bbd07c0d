/* SPDX-License-Identifier: Apache-2.0 */
/* Trajectories through tables of poses: cubics reproduced, a circle met with the fourth order,
 * stillness kept, odd tables refused. */
#include "check.h"

#include "imukit/motion.h"

#include <string.h>

enum { MOST = 400 };

static double times[MOST], x[MOST], y[MOST], z[MOST], workspace[10 * MOST + 8];
static const double *const position[3] = {x, y, z};
static imk_quaternion attitude[MOST];
static imk_trajectory_piece piece[MOST];

static imk_trajectory through(size_t count)
{
    assert_true(imk_trajectory_poses_workspace_size(count) <= sizeof workspace);
    CHECK_OK(imk_trajectory_from_poses(count, times, position, attitude, piece, workspace,
                                       sizeof workspace, NULL));
    const imk_trajectory trajectory = {.piece_count = count - 1, .piece = piece};
    CHECK_OK(imk_trajectory_validate(&trajectory, NULL));
    return trajectory;
}

/* A circle of 2 m at 1.5 rad/s in the horizontal plane, the body's x axis along the path, with a
 * roll of 0.5 sin(t). Steps of the table vary. */
static const double radius = 2.0, speed = 1.5;

static imk_quaternion circle_attitude(double t)
{
    const imk_quaternion yaw =
        imk_quaternion_from_rotation_vector((imk_vector3){{0.0, 0.0, speed * t + 0.7}});
    const imk_quaternion roll =
        imk_quaternion_from_rotation_vector((imk_vector3){{0.5 * sin(t), 0.0, 0.0}});
    return imk_quaternion_multiply(yaw, roll);
}

static void make_circle(size_t count, double length)
{
    for (size_t i = 0; i < count; i++) {
        const double u = (double)i / (double)(count - 1);
        times[i] = length * (u + 0.02 * sin(12.0 * u));
        x[i] = radius * sin(speed * times[i] + 0.7);
        y[i] = -radius * cos(speed * times[i] + 0.7);
        z[i] = 0.3 * times[i];
        attitude[i] = circle_attitude(times[i]);
        if (i % 3 == 1) /* the same attitude */
            attitude[i] =
                (imk_quaternion){-attitude[i].w, -attitude[i].x, -attitude[i].y, -attitude[i].z};
    }
}

/* Largest errors of position, angular rate and specific force over the middle of the table. */
static void circle_errors(const imk_trajectory *trajectory, double length, double error[3])
{
    error[0] = error[1] = error[2] = 0.0;
    for (int i = 0; i < 997; i++) {
        const double t = length * (0.1 + 0.8 * i / 997.0);
        const double r = 0.5 * sin(t);
        imk_motion_state state;
        imk_trajectory_state(trajectory, t, &state);
        /* towards the centre, which is to the right (y) of the level body at -r along y */
        const double rate[3] = {0.5 * cos(t), speed * sin(r), speed * cos(r)};
        const double force[3] = {0.0, radius * speed * speed * cos(r),
                                 -radius * speed * speed * sin(r)};
        error[0] = fmax(error[0], fabs(state.position.v[0] - radius * sin(speed * t + 0.7)));
        error[0] = fmax(error[0], fabs(state.position.v[2] - 0.3 * t));
        for (int k = 0; k < 3; k++) {
            error[1] = fmax(error[1], fabs(state.angular_rate.v[k] - rate[k]));
            error[2] = fmax(error[2], fabs(state.specific_force.v[k] - force[k]));
        }
    }
}

/* Halving the step divides the error of position by 16, of the rate (a first derivative) by 8 and
 * of the force (a second one) by 4. */
static void test_circle_converges(void **state)
{
    (void)state;
    const double length = 10.0;
    double coarse[3], fine[3];
    make_circle(200, length);
    imk_trajectory trajectory = through(200);
    circle_errors(&trajectory, length, coarse);
    make_circle(399, length);
    trajectory = through(399);
    circle_errors(&trajectory, length, fine);
    CHECK_BELOW(coarse[0], 1e-5); /* h^4/384 v^4 r for h = 0.062, twice */
    CHECK_BELOW(coarse[2], 1e-2);
    CHECK_CLOSE(log2(coarse[0] / fine[0]), 4.0, 0.2);
    CHECK_CLOSE(log2(coarse[1] / fine[1]), 3.0, 0.2);
    CHECK_CLOSE(log2(coarse[2] / fine[2]), 2.0, 0.2);
}

/* A cubic goes through unchanged from four poses on, a straight line with fewer. */
static void test_cubics_are_reproduced(void **state)
{
    (void)state;
    static const double rows[] = {-1.0, 0.5, 1.0, 4.0, 4.5, 7.0};
    for (size_t count = 2; count <= 6; count++) {
        const double cubic = count >= 4 ? 0.1 : 0.0;
        for (size_t i = 0; i < count; i++) {
            const double t = times[i] = rows[i];
            x[i] = 1.0 + t * (0.5 + t * cubic * (2.0 - t));
            y[i] = -3.0 * t;
            z[i] = 0.0;
            attitude[i] = imk_quaternion_identity();
        }
        const imk_trajectory trajectory = through(count);
        for (double t = -1.0; t <= rows[count - 1]; t += 0.125) {
            imk_motion_state at;
            imk_trajectory_state(&trajectory, t, &at);
            /* values to 40, rounded some times */
            CHECK_CLOSE(at.position.v[0], 1.0 + t * (0.5 + t * cubic * (2.0 - t)), 3e-14);
            CHECK_CLOSE(at.velocity.v[0], 0.5 + t * cubic * (4.0 - 3.0 * t), 2e-14);
            CHECK_CLOSE(at.specific_force.v[0], cubic * (4.0 - 6.0 * t), 2e-14);
            CHECK_CLOSE(at.velocity.v[1], -3.0, 1e-14);
        }
    }
}

static void test_stillness_is_exact(void **state)
{
    (void)state;
    const imk_quaternion q = imk_quaternion_normalise((imk_quaternion){0.3, -0.5, 0.6, 0.2});
    const imk_vector3 origin = imk_ecef_from_geodetic((imk_geodetic){0.7, 0.1, 200.0});
    for (size_t i = 0; i < 50; i++) {
        times[i] = 0.1 * (double)i;
        x[i] = 0.25, y[i] = -1.5, z[i] = 3.0;
        attitude[i] = i % 2 ? (imk_quaternion){-q.w, -q.x, -q.y, -q.z} : q;
    }
    imk_trajectory trajectory = through(50);
    imk_motion_state at;
    imk_trajectory_state(&trajectory, 1.234, &at);
    for (int k = 0; k < 3; k++)
        assert_true(at.angular_rate.v[k] == 0.0 && at.specific_force.v[k] == 0.0);
    trajectory.earth = true;
    memcpy(trajectory.origin, origin.v, sizeof origin.v);
    imk_trajectory_state(&trajectory, 1.234, &at);
    const imk_vector3 earth =
        imk_quaternion_rotate(imk_quaternion_conjugate(q), (imk_vector3){{0, 0, IMK_EARTH_RATE}});
    for (int k = 0; k < 3; k++) {
        CHECK_CLOSE(at.angular_rate.v[k], earth.v[k], 6e-20);
        CHECK_CLOSE(at.angular_acceleration.v[k], 0.0, 0.0);
        CHECK_CLOSE(at.velocity.v[k], 0.0, 0.0);
    }
    CHECK_CLOSE(imk_vector3_norm(at.specific_force),
                imk_vector3_norm(imk_gravity_ecef(imk_ecef_from_geodetic(at.place))), 3e-14);
}

static void test_odd_tables_are_refused(void **state)
{
    (void)state;
    imk_error error;
    make_circle(10, 1.0);
    CHECK_STATUS(imk_trajectory_from_poses(1, times, position, attitude, piece, workspace,
                                           sizeof workspace, &error),
                 IMK_ERROR_TOO_SHORT);
    times[4] = times[3];
    CHECK_STATUS(imk_trajectory_from_poses(10, times, position, attitude, piece, workspace,
                                           sizeof workspace, &error),
                 IMK_ERROR_TIME_ORDER);
    assert_int_equal(error.index, 4);
    /* Steps of time whose powers overflow; the shortest and the longest that do not. */
    static const struct {
        double step;
        imk_status status;
    } steps[] = {{1e-320, IMK_ERROR_RANGE}, {0.9e-9, IMK_ERROR_RANGE}, {1.1e-9, IMK_OK},
                 {0.9e9, IMK_OK},           {1.1e9, IMK_ERROR_RANGE},  {1e300, IMK_ERROR_RANGE}};
    for (size_t i = 0; i < sizeof steps / sizeof steps[0]; i++) {
        make_circle(10, 1.0);
        times[0] = 0.0;
        for (size_t k = 1; k < 10; k++)
            times[k] = steps[i].step + (double)(k - 1);
        CHECK_STATUS(imk_trajectory_from_poses(10, times, position, attitude, piece, workspace,
                                               sizeof workspace, &error),
                     steps[i].status);
        if (steps[i].status != IMK_OK)
            assert_int_equal(error.index, 1);
    }
    make_circle(10, 1.0);
    y[7] = (double)NAN;
    CHECK_STATUS(imk_trajectory_from_poses(10, times, position, attitude, piece, workspace,
                                           sizeof workspace, &error),
                 IMK_ERROR_NOT_FINITE);
    assert_int_equal(error.index, 7);
    make_circle(10, 1.0);
    attitude[2].w += 0.5;
    CHECK_STATUS(imk_trajectory_from_poses(10, times, position, attitude, piece, workspace,
                                           sizeof workspace, &error),
                 IMK_ERROR_RANGE);
    assert_int_equal(error.index, 2);
    /* turns of 119 and 121 degrees */
    for (int turn = 119; turn <= 121; turn += 2) {
        make_circle(10, 1.0);
        for (size_t i = 0; i < 10; i++) {
            const double angle = i < 5 ? 0.0 : turn * 0.017453292519943295;
            attitude[i] = imk_quaternion_from_rotation_vector((imk_vector3){{0.0, angle, 0.0}});
        }
        const imk_status expected = turn < 120 ? IMK_OK : IMK_ERROR_RANGE;
        CHECK_STATUS(imk_trajectory_from_poses(10, times, position, attitude, piece, workspace,
                                               sizeof workspace, &error),
                     expected);
    }
    assert_int_equal(error.index, 5);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_circle_converges),
        cmocka_unit_test(test_cubics_are_reproduced),
        cmocka_unit_test(test_stillness_is_exact),
        cmocka_unit_test(test_odd_tables_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
