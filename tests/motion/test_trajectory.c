/* SPDX-License-Identifier: Apache-2.0 */
/* Trajectories at one instant: states against closed forms and against derivatives taken by
 * differences; what is refused. */
#include "check.h"

#include "random_pieces.h"

static const double degree = 0.017453292519943295;

static void test_standstill(void **state)
{
    (void)state;
    imk_trajectory trajectory;
    imk_trajectory_piece piece;
    imk_motion_state at;
    const imk_geodetic place = {-35.0 * degree, 149.0 * degree, 560.0};
    const double angles[] = {0.1, -0.2, 2.0};
    CHECK_OK(imk_trajectory_standstill(place, angles, true, &piece, &trajectory, NULL));
    CHECK_OK(imk_trajectory_validate(&trajectory, NULL));
    double first, last;
    imk_trajectory_span(&trajectory, &first, &last);
    assert_true(first == 0.0 && isinf(last));
    imk_trajectory_state(&trajectory, 12345.678, &at);
    const imk_matrix3 c_nb = imk_matrix3_from_euler(angles[0], angles[1], angles[2]);
    const imk_matrix3 c_bn = imk_matrix3_transpose(c_nb);
    const imk_vector3 gravity = imk_gravity_ecef(imk_ecef_from_geodetic(place));
    const imk_vector3 force = imk_vector3_scale(
        imk_matrix3_apply(c_bn, imk_matrix3_apply(imk_matrix3_transpose(imk_ned_axes(
                                                      place.latitude, place.longitude)),
                                                  gravity)),
        -1.0);
    const imk_vector3 rate = imk_matrix3_apply(c_bn, imk_earth_rate(place.latitude));
    CHECK_CLOSE(at.place.latitude, place.latitude, 1e-15);
    CHECK_CLOSE(at.place.longitude, place.longitude, 1e-15);
    CHECK_CLOSE(at.place.height, place.height, 3e-9);
    for (int i = 0; i < 3; i++) {
        /* of 9.8 m/s^2, turned by a rounded attitude */
        CHECK_CLOSE(at.specific_force.v[i], force.v[i], 2e-14);
        CHECK_CLOSE(at.angular_rate.v[i], rate.v[i], 1e-19);
        assert_true(at.angular_acceleration.v[i] == 0.0 && at.velocity.v[i] == 0.0);
        for (int j = 0; j < 3; j++)
            CHECK_CLOSE(at.c_nb.m[i][j], c_nb.m[i][j], 2e-15);
    }
    /* every sample is the state, to the bit */
    double boundary[101], out[9][100];
    double *const rates[] = {out[0], out[1], out[2]}, *const forces[] = {out[6], out[7], out[8]};
    double *const accelerations[] = {out[3], out[4], out[5]};
    for (int k = 0; k <= 100; k++)
        boundary[k] = -0.095 + 0.01 * k;
    imk_trajectory_means(&trajectory, IMK_KERNEL_SCALAR, 100, boundary, rates, accelerations,
                         forces);
    for (int k = 0; k < 100; k++)
        for (int i = 0; i < 3; i++) {
            /* the one that straddles the start is a sum of two parts */
            const double tolerance = k == 9 ? 2e-15 : 0.0;
            CHECK_CLOSE(out[i][k], at.angular_rate.v[i], tolerance);
            CHECK_CLOSE(out[3 + i][k], 0.0, 0.0);
            CHECK_CLOSE(out[6 + i][k], at.specific_force.v[i], tolerance);
        }
    /* without the Earth nothing is felt, and places do not matter */
    CHECK_OK(imk_trajectory_standstill((imk_geodetic){9.0, 0.0, 0.0}, angles, false, &piece,
                                       &trajectory, NULL));
    imk_trajectory_state(&trajectory, 1.0, &at);
    CHECK_CLOSE(imk_vector3_norm(at.specific_force), 0.0, 0.0);
    CHECK_CLOSE(imk_vector3_norm(at.angular_rate), 0.0, 0.0);
    for (int i = 0; i < 3; i++)
        CHECK_CLOSE(at.c_nb.m[i][0], c_nb.m[i][0], 1e-15);
}

/* q = (1, 0, 0, a s) turns by 2 atan(a s), unnormalised. */
static void test_one_axis_in_closed_form(void **state)
{
    (void)state;
    const double a = 0.4;
    imk_trajectory_piece piece = {.start = -2.0, .length = 10.0};
    piece.quaternion[0][0] = 1.0;
    piece.quaternion[3][1] = a;
    const imk_trajectory trajectory = {.piece_count = 1, .piece = &piece};
    for (double s = 0.0; s < 9.0; s += 0.25) {
        imk_motion_state at;
        imk_trajectory_state(&trajectory, s - 2.0, &at);
        const double square = 1.0 + a * a * s * s;
        CHECK_RELATIVE(at.angular_rate.v[2], 2.0 * a / square, 1e-15);
        CHECK_CLOSE(at.angular_acceleration.v[2], -4.0 * a * a * a * s / (square * square), 1e-15);
        CHECK_CLOSE(at.attitude.z, a * s / sqrt(square), 4e-16);
    }
}

/* East along the equator at speed v and height h: what holds the body up is less by v^2/(a + h) and
 * by the Coriolis force 2 w v (Eotvos' effect). */
static void test_eotvos(void **state)
{
    (void)state;
    const double v = 250.0, height = 1e4, radius = 6378137.0 + height;
    imk_trajectory_piece piece = {.start = -1.0, .length = 2.0};
    imk_trajectory trajectory = {.earth = true, .piece_count = 1, .piece = &piece};
    trajectory.origin[0] = radius;
    /* s = t + 1: y = v (s - 1), x = -v^2 (s - 1)^2/(2 radius) */
    piece.position[1][0] = -v;
    piece.position[1][1] = v;
    const double bend = -v * v / (2.0 * radius);
    piece.position[0][0] = bend;
    piece.position[0][1] = -2.0 * bend;
    piece.position[0][2] = bend;
    piece.quaternion[0][0] = 1.0;
    imk_motion_state at;
    imk_trajectory_state(&trajectory, 0.0, &at);
    const double up = imk_normal_gravity(0.0, height) - v * v / radius - 2.0 * IMK_EARTH_RATE * v;
    CHECK_CLOSE(at.specific_force.v[0], up, 1e-14);
    CHECK_CLOSE(at.specific_force.v[1], 0.0, 1e-14);
    CHECK_CLOSE(at.velocity_ned.v[1], v, 1e-13);
    CHECK_CLOSE(at.angular_rate.v[2], IMK_EARTH_RATE, 0.0);
}

/* Five-point differences of a vector of the state, step h. */
typedef imk_vector3 state_vector(const imk_motion_state *state);

static imk_vector3 derivative(const imk_trajectory *trajectory, double time, double h,
                              state_vector *of)
{
    static const double weight[] = {1.0 / 12.0, -8.0 / 12.0, 0.0, 8.0 / 12.0, -1.0 / 12.0};
    imk_vector3 sum = {{0.0, 0.0, 0.0}};
    for (int i = 0; i < 5; i++) {
        imk_motion_state at;
        imk_trajectory_state(trajectory, time + (i - 2) * h, &at);
        sum = imk_vector3_add(sum, imk_vector3_scale(of(&at), weight[i] / h));
    }
    return sum;
}

static imk_vector3 position_of(const imk_motion_state *at)
{
    return at->position;
}

static imk_vector3 velocity_of(const imk_motion_state *at)
{
    return at->velocity;
}

static imk_vector3 rate_of(const imk_motion_state *at)
{
    return at->angular_rate;
}

static imk_vector3 x_axis_of(const imk_motion_state *at)
{
    return imk_quaternion_rotate(at->attitude, (imk_vector3){{1.0, 0.0, 0.0}});
}

static imk_vector3 y_axis_of(const imk_motion_state *at)
{
    return imk_quaternion_rotate(at->attitude, (imk_vector3){{0.0, 1.0, 0.0}});
}

/* The laws of kinematics, with derivatives of the states by differences:
 *
 *     r' = v,   v' + 2 w_ie x v - g = C_eb f,   x' = C_eb (w x) - w_ie x x,   w' = alpha
 *
 * in Earth-fixed axes, for the body axes x and y. The error of the differences is h^4/30 of the
 * fifth derivative, and rounding by h. */
static void check_kinematics(const imk_trajectory *trajectory)
{
    const double h = 1e-3;
    const imk_vector3 earth = {{0.0, 0.0, trajectory->earth ? IMK_EARTH_RATE : 0.0}};
    for (double time = 3.01; time < 3.98; time += 0.0137) {
        imk_motion_state at;
        imk_trajectory_state(trajectory, time, &at);
        const imk_vector3 velocity = derivative(trajectory, time, h, position_of);
        const imk_vector3 change = derivative(trajectory, time, h, velocity_of);
        const imk_vector3 rotation = derivative(trajectory, time, h, rate_of);
        const imk_vector3 axis_change[2] = {derivative(trajectory, time, h, x_axis_of),
                                            derivative(trajectory, time, h, y_axis_of)};
        const imk_vector3 axis[2] = {x_axis_of(&at), y_axis_of(&at)};
        imk_vector3 force =
            imk_vector3_add(change, imk_vector3_scale(imk_vector3_cross(earth, at.velocity), 2.0));
        if (trajectory->earth)
            force = imk_vector3_subtract(force, imk_gravity_ecef(at.position));
        const imk_vector3 felt = imk_quaternion_rotate(at.attitude, at.specific_force);
        const imk_vector3 rate =
            imk_vector3_subtract(imk_quaternion_rotate(at.attitude, at.angular_rate), earth);
        for (int i = 0; i < 3; i++) {
            CHECK_CLOSE(at.velocity.v[i], velocity.v[i], trajectory->earth ? 4e-6 : 3e-8);
            CHECK_CLOSE(felt.v[i], force.v[i], 1e-6);
            CHECK_CLOSE(at.angular_acceleration.v[i], rotation.v[i], 3e-6);
            for (int j = 0; j < 2; j++)
                CHECK_CLOSE(axis_change[j].v[i], imk_vector3_cross(rate, axis[j]).v[i], 1e-7);
        }
    }
}

static void test_kinematics(void **state)
{
    (void)state;
    for (uint64_t seed = 1; seed <= 4; seed++) {
        imk_trajectory_piece piece;
        random_pieces(1, 1.0, seed, &piece);
        imk_trajectory trajectory = on_earth(1, &piece);
        check_kinematics(&trajectory);
        trajectory.line_count = LINES;
        trajectory.line = lines;
        check_kinematics(&trajectory);
        trajectory.earth = false;
        check_kinematics(&trajectory);
    }
}

/* What differences cannot see: without the Earth the axes of the state are the trajectory's. */
static void test_local_axes_agree(void **state)
{
    (void)state;
    imk_trajectory_piece piece;
    imk_motion_state at;
    random_pieces(1, 1.0, 9, &piece);
    const imk_trajectory trajectory = on_earth(1, &piece);
    imk_trajectory_state(&trajectory, 3.5, &at);
    const imk_matrix3 axes = imk_ned_axes(at.place.latitude, at.place.longitude);
    const imk_vector3 velocity = imk_matrix3_apply(axes, at.velocity_ned);
    const imk_matrix3 attitude = imk_matrix3_multiply(axes, at.c_nb);
    const imk_matrix3 expected = imk_quaternion_to_matrix(at.attitude);
    for (int i = 0; i < 3; i++) {
        CHECK_CLOSE(velocity.v[i], at.velocity.v[i], 1e-13);
        for (int j = 0; j < 3; j++)
            CHECK_CLOSE(attitude.m[i][j], expected.m[i][j], 1e-15);
    }
}

/* Before and after, the velocity is that of the end, the angular rate falls as the header says, and
 * the force is what that motion feels, since all of it is one motion. */
static void test_motion_outside_the_span(void **state)
{
    (void)state;
    imk_trajectory_piece piece[2];
    random_pieces(2, 1.0, 3, piece);
    const imk_trajectory trajectory = on_earth(2, piece);
    const imk_vector3 earth = {{0.0, 0.0, IMK_EARTH_RATE}};
    for (int after = 0; after < 2; after++)
        for (int i = 0; i < 3; i++) {
            const double end = after ? 5.0 : 3.0, reach = (double[]){2e-3, 0.3, 100.0}[i];
            const double time = after ? end + reach : end - reach;
            imk_motion_state at_end, at, a, b;
            imk_trajectory_state(&trajectory, end, &at_end);
            imk_trajectory_state(&trajectory, time, &at);
            CHECK_BELOW(imk_vector3_norm(imk_vector3_subtract(at.velocity, at_end.velocity)),
                        1e-13);
            const imk_vector3 rate_at_end = imk_vector3_subtract(
                imk_quaternion_rotate(at_end.attitude, at_end.angular_rate), earth);
            const imk_vector3 rate =
                imk_vector3_subtract(imk_quaternion_rotate(at.attitude, at.angular_rate), earth);
            const double turned = imk_vector3_norm(rate_at_end) * reach;
            CHECK_CLOSE(imk_vector3_norm(rate),
                        imk_vector3_norm(rate_at_end) / (1.0 + 0.25 * turned * turned), 1e-14);
            for (int j = 0; j < 3; j++)
                CHECK_CLOSE(at.position.v[j],
                            at_end.position.v[j] + (time - end) * at_end.velocity.v[j], 1e-8);
            const imk_vector3 force =
                imk_vector3_subtract(imk_vector3_scale(imk_vector3_cross(earth, at.velocity), 2.0),
                                     imk_gravity_ecef(at.position));
            CHECK_BELOW(imk_vector3_norm(imk_vector3_subtract(
                            imk_quaternion_rotate(at.attitude, at.specific_force), force)),
                        1e-12);
            /* the rate is the derivative of the attitude */
            const double h = 1e-3;
            imk_trajectory_state(&trajectory, time - h, &a);
            imk_trajectory_state(&trajectory, time + h, &b);
            const imk_vector3 turn = imk_quaternion_to_rotation_vector(
                imk_quaternion_multiply(b.attitude, imk_quaternion_conjugate(a.attitude)));
            for (int j = 0; j < 3; j++)
                CHECK_CLOSE(turn.v[j] / (2.0 * h), rate.v[j], 1e-6);
        }
}

/* A body that has stopped stays, to the bit. */
static void test_rest_outside_the_span(void **state)
{
    (void)state;
    imk_trajectory_piece piece;
    imk_motion_state at, after;
    random_pieces(1, 1.0, 3, &piece);
    for (int i = 0; i < 3; i++)
        memset(&piece.position[i][1], 0, 6 * sizeof(double));
    for (int i = 0; i < 4; i++)
        memset(&piece.quaternion[i][1], 0, 5 * sizeof(double));
    const imk_trajectory trajectory = on_earth(1, &piece);
    imk_trajectory_state(&trajectory, 3.5, &at);
    imk_trajectory_state(&trajectory, 1e6, &after);
    after.time = at.time;
    assert_memory_equal(&after, &at, sizeof at);
}

/* Times that rounding has put past the end have the accelerations of the last piece. */
static void test_rounded_end(void **state)
{
    (void)state;
    imk_trajectory_piece piece[2];
    imk_motion_state end, past, gone;
    random_pieces(2, 1.0, 3, piece);
    for (int i = 0; i < 2; i++)
        piece[i].start += 1.7e9; /* seconds since 1970 */
    const imk_trajectory trajectory = on_earth(2, piece);
    double first, last;
    imk_trajectory_span(&trajectory, &first, &last);
    imk_trajectory_state(&trajectory, last, &end);
    imk_trajectory_state(&trajectory, nextafter(last, 1e10), &past); /* 0.24 us */
    imk_trajectory_state(&trajectory, last + 1e-3, &gone);
    CHECK_BELOW(imk_vector3_norm(imk_vector3_subtract(past.specific_force, end.specific_force)),
                1e-4);
    assert_true(imk_vector3_norm(imk_vector3_subtract(gone.specific_force, end.specific_force)) >
                1.0);
}

/* ---- checks ---------------------------------------------------------------------------------- */

static void test_odd_trajectories_are_refused(void **state)
{
    (void)state;
    imk_error error;
    imk_trajectory_piece piece[2];
    memset(piece, 0, sizeof piece);
    for (int i = 0; i < 2; i++) {
        piece[i].start = 2.0 * i;
        piece[i].length = 2.0;
        piece[i].quaternion[0][0] = 1.0;
        piece[i].position[0][0] = 10.0 * i; /* 5 m/s */
        piece[i].position[0][1] = 5.0;
    }
    imk_trajectory trajectory = on_earth(2, piece);
    CHECK_OK(imk_trajectory_validate(&trajectory, &error));
    trajectory.piece_count = 0;
    CHECK_STATUS(imk_trajectory_validate(&trajectory, &error), IMK_ERROR_EMPTY);
    trajectory.piece_count = 2;
    const struct {
        double *number, value;
        imk_status status;
    } cases[] = {
        {&piece[1].position[0][0], 10.1, IMK_ERROR_CONFLICT},
        {&piece[1].position[0][1], 5.1, IMK_ERROR_CONFLICT},
        {&piece[1].position[0][2], 0.1, IMK_ERROR_CONFLICT},
        {&piece[1].quaternion[2][0], 0.1, IMK_ERROR_CONFLICT},
        {&piece[1].quaternion[2][1], 0.1, IMK_ERROR_CONFLICT},
        {&piece[1].start, 2.5, IMK_ERROR_TIME_ORDER},
        {&piece[1].start, -2.5, IMK_ERROR_TIME_ORDER},
        {&piece[1].quaternion[0][0], 0.0, IMK_ERROR_RANGE},
        {&piece[1].position[1][6], (double)NAN, IMK_ERROR_NOT_FINITE},
        {&piece[1].quaternion[3][5], (double)INFINITY, IMK_ERROR_NOT_FINITE},
        {&piece[1].length, 0.0, IMK_ERROR_RANGE},
        {&piece[0].length, (double)INFINITY, IMK_ERROR_RANGE},
        {&piece[0].start, (double)NAN, IMK_ERROR_NOT_FINITE},
        {&trajectory.origin[1], 0.0, IMK_ERROR_RANGE}, /* below the ground */
        {&trajectory.origin[2], (double)NAN, IMK_ERROR_NOT_FINITE},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const double keep = *cases[i].number;
        *cases[i].number = cases[i].value;
        CHECK_STATUS(imk_trajectory_validate(&trajectory, &error), cases[i].status);
        *cases[i].number = keep;
        CHECK_OK(imk_trajectory_validate(&trajectory, &error));
    }
    /* another norm or sign of the quaternion is the same attitude */
    piece[1].quaternion[0][0] = -0.5;
    CHECK_OK(imk_trajectory_validate(&trajectory, &error));
}

static void test_odd_vibration_is_refused(void **state)
{
    (void)state;
    imk_error error;
    imk_trajectory_piece piece;
    imk_trajectory trajectory;
    const double level[3] = {0.0, 0.0, 0.0};
    CHECK_OK(imk_trajectory_standstill((imk_geodetic){0.5, 0.5, 0.0}, level, true, &piece,
                                       &trajectory, &error));
    const imk_vibration_line odd[] = {
        {6, 1e-3, 10.0, 0.0},
        {-1, 1e-3, 10.0, 0.0},
        {0, 1e-3, 0.0, 0.0},
        {0, 1e-3, (double)NAN, 0.0},
        {0, (double)INFINITY, 1.0, 0.0},
        {0, 1e-3, 1e-9, 0.0},
        {0, 1e5, 1.0, 0.0},
        {3, 0.2, 1.0, 0.0},
        {3, 0.01, 1.0, (double)INFINITY},
    };
    for (size_t i = 0; i < sizeof odd / sizeof *odd; i++) {
        const imk_vibration_line two[] = {lines[0], odd[i]};
        trajectory.line = two;
        trajectory.line_count = 2;
        assert_true(imk_trajectory_validate(&trajectory, &error) != IMK_OK);
        assert_int_equal(error.index, 1);
    }
    trajectory.line = lines;
    trajectory.line_count = LINES;
    CHECK_OK(imk_trajectory_validate(&trajectory, &error));
    CHECK_STATUS(imk_trajectory_standstill((imk_geodetic){1.6, 0.0, 0.0}, level, true, &piece,
                                           &trajectory, &error),
                 IMK_ERROR_RANGE);
    assert_string_equal(error.field, "latitude");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_standstill),
        cmocka_unit_test(test_one_axis_in_closed_form),
        cmocka_unit_test(test_eotvos),
        cmocka_unit_test(test_kinematics),
        cmocka_unit_test(test_local_axes_agree),
        cmocka_unit_test(test_motion_outside_the_span),
        cmocka_unit_test(test_rest_outside_the_span),
        cmocka_unit_test(test_rounded_end),
        cmocka_unit_test(test_odd_trajectories_are_refused),
        cmocka_unit_test(test_odd_vibration_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
