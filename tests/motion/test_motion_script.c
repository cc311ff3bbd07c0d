/* SPDX-License-Identifier: Apache-2.0 */
/* Motion scripts: that each step does what it says, by closed forms. Where no source is named, the
 * expected value follows from the step itself; most tests are without Earth, so that nothing else
 * is in the rates and forces. */
#include "check.h"

#include "car_profile.h"

#include <stdlib.h>

#define PI 3.14159265358979323846
#define DEGREE (PI / 180.0)

/* The interpolation may depart from the script by 1e-9 rad/s and 1e-7 m/s^2 (motion_script.h). */
static const double rate_error = 1.5e-9, acceleration_error = 1.5e-7;

typedef struct compiled {
    imk_motion_script script;
    imk_trajectory trajectory;
    imk_trajectory_piece *piece;
} compiled;

/* A script without Earth. */
static imk_motion_script plain(size_t count, const imk_motion_step *step)
{
    imk_motion_script script = imk_motion_script_default();
    script.earth = false;
    script.step_count = count;
    script.step = step;
    return script;
}

static compiled compile(const imk_motion_script *script)
{
    compiled c = {.script = *script};
    imk_error error;
    size_t count = 0;
    CHECK_OK(imk_motion_script_pieces(script, &count, &error));
    assert_true(count > 0);
    c.piece = malloc(count * sizeof *c.piece);
    assert_non_null(c.piece);
    CHECK_OK(imk_motion_script_compile(script, c.piece, count, &c.trajectory, &error));
    assert_int_equal(c.trajectory.piece_count, count);
    assert_ptr_equal(c.trajectory.piece, c.piece);
    CHECK_OK(imk_trajectory_validate(&c.trajectory, &error));
    return c;
}

static imk_motion_state state_at(const compiled *c, double time)
{
    imk_motion_state state;
    imk_trajectory_state(&c->trajectory, time, &state);
    return state;
}

/* When step `index` begins. */
static double begin_of(const compiled *c, size_t index)
{
    double time = 0.0;
    for (size_t i = 0; i < index; i++)
        time += imk_motion_step_duration(&c->script, i);
    return time;
}

static double smooth(double x)
{
    return x * x * x * (10.0 + x * (-15.0 + 6.0 * x));
}

static void check_vector(imk_vector3 actual, double x, double y, double z, double tolerance)
{
    CHECK_CLOSE(actual.v[0], x, tolerance);
    CHECK_CLOSE(actual.v[1], y, tolerance);
    CHECK_CLOSE(actual.v[2], z, tolerance);
}

/* Angle of the rotation between two attitudes, without cancellation. */
static double angle_between(imk_quaternion a, imk_quaternion b)
{
    const imk_quaternion d = imk_quaternion_multiply(imk_quaternion_conjugate(a), b);
    return 2.0 * asin(fmin(1.0, sqrt(d.x * d.x + d.y * d.y + d.z * d.z)));
}

/* ---- durations ------------------------------------------------------------------------------- */

/* A/p + h; 2 h when A/p < h. */
static void test_durations(void **unused)
{
    (void)unused;
    const imk_motion_step steps[] = {
        {.kind = IMK_STEP_ACCELERATE, .amount = 20.0, .rate = 2.0},
        {.kind = IMK_STEP_ACCELERATE, .amount = -0.5, .rate = 2.0},
        {.kind = IMK_STEP_TURN, .amount = -0.5 * PI, .rate = 0.25 * PI},
        {.kind = IMK_STEP_CLIMB, .amount = 0.1, .rate = 0.05},
        {.kind = IMK_STEP_ROTATE, .axis = 2, .amount = 20.0 * PI, .rate = PI},
        {.kind = IMK_STEP_HOLD, .duration = 3.0},
        {.kind = IMK_STEP_POSE, .duration = 4.0},
        {.kind = IMK_STEP_SWING, .amount = 0.1, .frequency = 1.0, .duration = 5.5},
        {.kind = IMK_STEP_CONING, .amount = 0.1, .frequency = 10.0, .duration = 6.0},
    };
    static const double expected[] = {10.5, 1.0, 2.5, 2.5, 20.5, 3.0, 4.0, 5.5, 6.0};
    const imk_motion_script script = plain(9, steps);
    for (size_t i = 0; i < 9; i++)
        CHECK_CLOSE(imk_motion_step_duration(&script, i), expected[i], 1e-14);
    CHECK_CLOSE(imk_motion_step_duration(&script, 9), 0.0, 0.0);
    const compiled c = compile(&script);
    const imk_trajectory_piece *last = &c.piece[c.trajectory.piece_count - 1];
    CHECK_CLOSE(last->start + last->length, 55.5, 1e-13);
    free(c.piece);
}

/* ---- along a line ---------------------------------------------------------------------------- */

/* A change of speed is symmetric about its middle, so its length is (v0 + v1)/2 T: with T = dv/a +
 * h, from rest v^2/(2 a) + v h/2. */
static void test_straight_line(void **unused)
{
    (void)unused;
    const imk_motion_step steps[] = {
        {.kind = IMK_STEP_ACCELERATE, .amount = 20.0, .rate = 2.0},
        {.kind = IMK_STEP_HOLD, .duration = 10.0},
        {.kind = IMK_STEP_ACCELERATE, .amount = -20.0, .rate = 4.0},
        {.kind = IMK_STEP_HOLD, .duration = 7.0},
    };
    const imk_motion_script script = plain(4, steps);
    const compiled c = compile(&script);
    const double first = 20.0 * 20.0 / (2.0 * 2.0) + 0.5 * 20.0 * 0.5;
    const double brake = 20.0 * 20.0 / (2.0 * 4.0) + 0.5 * 20.0 * 0.5;
    /* Acceleration errors of 1e-7 over a ramp of 0.5 s are 1e-9 m and carry on. */
    check_vector(state_at(&c, 10.5).position, first, 0.0, 0.0, 1e-9);
    check_vector(state_at(&c, 10.5).velocity, 20.0, 0.0, 0.0, 0.0);
    check_vector(state_at(&c, 20.5).position, first + 200.0, 0.0, 0.0, 1e-9);
    check_vector(state_at(&c, 26.0).position, first + 200.0 + brake, 0.0, 0.0, 1e-9);
    check_vector(state_at(&c, 5.0).specific_force, 2.0, 0.0, 0.0, 1e-12);
    check_vector(state_at(&c, 23.0).specific_force, -4.0, 0.0, 0.0, 1e-12);
    check_vector(state_at(&c, 0.2).specific_force, 2.0 * smooth(0.4), 0.0, 0.0, acceleration_error);
    check_vector(state_at(&c, 25.9).specific_force, -4.0 * smooth(0.2), 0.0, 0.0,
                 acceleration_error);
    double least = 0.0, most = 0.0;
    for (int i = 0; i <= 26000; i++) {
        const double f = state_at(&c, 0.001 * i).specific_force.v[0];
        least = fmin(least, f);
        most = fmax(most, f);
    }
    CHECK_CLOSE(most, 2.0, acceleration_error);
    CHECK_CLOSE(least, -4.0, acceleration_error);
    double begin, end;
    imk_trajectory_span(&c.trajectory, &begin, &end);
    CHECK_CLOSE(begin, 0.0, 0.0);
    assert_true(isinf(end));
    free(c.piece);
}

/* Too little for the rate: the peak is amount/h, the ramps stay. */
static void test_small_amount(void **unused)
{
    (void)unused;
    const imk_motion_step steps[] = {
        {.kind = IMK_STEP_ACCELERATE, .amount = 0.3, .rate = 2.0},
        {.kind = IMK_STEP_TURN, .amount = 0.01, .rate = 1.0},
    };
    const imk_motion_script script = plain(2, steps);
    const compiled c = compile(&script);
    check_vector(state_at(&c, 0.5).specific_force, 0.3 / 0.5, 0.0, 0.0, acceleration_error);
    check_vector(state_at(&c, 1.0).velocity, 0.3, 0.0, 0.0, 0.0);
    check_vector(state_at(&c, 1.5).angular_rate, 0.0, 0.0, 0.01 / 0.5, rate_error);
    const imk_motion_state end = state_at(&c, 2.0);
    check_vector(end.velocity, 0.3 * cos(0.01), 0.3 * sin(0.01), 0.0, 1e-15);
    free(c.piece);
}

/* ---- curves ---------------------------------------------------------------------------------- */

static void test_turn_on_the_spot(void **unused)
{
    (void)unused;
    const imk_motion_step steps[] = {
        {.kind = IMK_STEP_TURN, .amount = -0.5 * PI, .rate = 20.0 * DEGREE},
    };
    imk_motion_script script = plain(1, steps);
    script.heading = 0.3;
    const compiled c = compile(&script);
    const double length = imk_motion_step_duration(&script, 0);
    CHECK_CLOSE(length, 5.0, 1e-14);
    check_vector(state_at(&c, 2.5).angular_rate, 0.0, 0.0, -20.0 * DEGREE, rate_error);
    check_vector(state_at(&c, 0.25).angular_rate, 0.0, 0.0, -10.0 * DEGREE, rate_error);
    double roll, pitch, yaw;
    imk_matrix3_to_euler(state_at(&c, length).c_nb, &roll, &pitch, &yaw);
    CHECK_CLOSE(yaw, 0.3 - 0.5 * PI, 1e-15);
    for (size_t i = 0; i < c.trajectory.piece_count; i++)
        for (int k = 0; k < 3; k++)
            for (int j = 0; j < 7; j++)
                assert_true(c.piece[i].position[k][j] == 0.0);
    free(c.piece);
}

/* On a circle the force is v times the heading rate, across; a full circle ends in its heading. */
static void test_circle(void **unused)
{
    (void)unused;
    const imk_motion_step steps[] = {{.kind = IMK_STEP_TURN, .amount = 2.0 * PI, .rate = 0.2}};
    imk_motion_script script = plain(1, steps);
    script.speed = 12.0;
    const compiled c = compile(&script);
    const double length = imk_motion_step_duration(&script, 0);
    const imk_motion_state middle = state_at(&c, 0.5 * length), end = state_at(&c, length);
    check_vector(middle.specific_force, 0.0, 12.0 * 0.2, 0.0, acceleration_error);
    check_vector(middle.angular_rate, 0.0, 0.0, 0.2, rate_error);
    check_vector(end.velocity, 12.0, 0.0, 0.0, 1e-13);
    /* The ramps lengthen the circle, which by symmetry happens along the first heading: across it
     * nothing is left. */
    CHECK_CLOSE(end.position.v[1], 0.0, 1e-8);
    /* 1e-7 m/s^2, of changing sign within pieces of 1 s. */
    CHECK_CLOSE(imk_vector3_norm(middle.velocity), 12.0, 5e-8);
    /* It does not end at rest: no endless piece. */
    double first, last;
    imk_trajectory_span(&c.trajectory, &first, &last);
    CHECK_CLOSE(last, length, 1e-13);
    free(c.piece);
}

/* What angle increments add up to, on a turn about one axis. */
static void test_increments_of_a_turn(void **unused)
{
    (void)unused;
    enum { SAMPLES = 1200 };
    static double boundary[SAMPLES + 1], rates[3][SAMPLES], forces[3][SAMPLES];
    const imk_motion_step steps[] = {{.kind = IMK_STEP_TURN, .amount = 1.7, .rate = 0.3}};
    imk_motion_script script = plain(1, steps);
    script.speed = 5.0;
    const compiled c = compile(&script);
    const double dt = imk_motion_step_duration(&script, 0) / SAMPLES;
    for (int i = 0; i <= SAMPLES; i++)
        boundary[i] = i * dt;
    boundary[SAMPLES] = imk_motion_step_duration(&script, 0);
    double *const rate[3] = {rates[0], rates[1], rates[2]};
    double *const force[3] = {forces[0], forces[1], forces[2]};
    imk_trajectory_means(&c.trajectory, IMK_KERNEL_SCALAR, SAMPLES, boundary, rate, NULL, force);
    double sum[3] = {0.0, 0.0, 0.0};
    for (int i = 0; i < SAMPLES; i++)
        for (int k = 0; k < 3; k++)
            sum[k] += rates[k][i] * (boundary[i + 1] - boundary[i]);
    /* The angles at the knots are exact, and pieces integrate between them: rounding is left. */
    CHECK_CLOSE(sum[0], 0.0, 1e-13);
    CHECK_CLOSE(sum[1], 0.0, 1e-13);
    CHECK_CLOSE(sum[2], 1.7, 1e-12);
    free(c.piece);
}

/* f = C_bn (v_n' + (2 w_ie + w_en) x v_n - g_n). A banked turn leaves nothing of v_n' - g_n across
 * the body; Coriolis and transport remain. */
static void test_banked_turn(void **unused)
{
    (void)unused;
    const imk_motion_step steps[] = {
        {.kind = IMK_STEP_TURN, .amount = 2.0, .rate = 0.15, .banked = true}};
    imk_motion_script script = plain(1, steps);
    script.earth = true;
    script.speed = 60.0;
    script.climb = 0.05;
    script.smoothing = 3.0;
    const compiled c = compile(&script);
    double most = 0.0, steepest = 0.0;
    const double length = imk_motion_step_duration(&script, 0);
    for (int i = 0; i <= 1000; i++) {
        const imk_motion_state s = state_at(&c, length * i / 1000.0);
        double meridian, prime_vertical;
        imk_curvature_radii(s.place.latitude, &meridian, &prime_vertical);
        const double north = s.velocity_ned.v[0] / (meridian + s.place.height);
        const double east = s.velocity_ned.v[1] / (prime_vertical + s.place.height);
        imk_vector3 turning = imk_vector3_scale(imk_earth_rate(s.place.latitude), 2.0);
        turning =
            imk_vector3_add(turning, (imk_vector3){{east, -north, -east * tan(s.place.latitude)}});
        const imk_vector3 rest = imk_matrix3_apply(imk_matrix3_transpose(s.c_nb),
                                                   imk_vector3_cross(turning, s.velocity_ned));
        most = fmax(most, fabs(s.specific_force.v[1] - rest.v[1]));
        double roll, pitch, yaw;
        imk_matrix3_to_euler(s.c_nb, &roll, &pitch, &yaw);
        steepest = fmax(steepest, roll);
    }
    /* Gravity is that at the beginning of the turn: it changes by 3e-6 m/s^2 per metre, over the 50
     * m of height gained 1.5e-4, and half of the sine of the bank is seen across. */
    CHECK_BELOW(most, 1.2e-4);
    CHECK_CLOSE(steepest, atan(60.0 * 0.15 / 9.806), 1e-4);
    free(c.piece);
}

/* Height is the integral of v sin(climb): exactly, whatever the Earth is like. */
static void test_climb(void **unused)
{
    (void)unused;
    const imk_motion_step steps[] = {
        {.kind = IMK_STEP_CLIMB, .amount = 6.0 * DEGREE, .rate = 2.0 * DEGREE},
        {.kind = IMK_STEP_HOLD, .duration = 60.0},
        {.kind = IMK_STEP_CLIMB, .amount = -6.0 * DEGREE, .rate = 2.0 * DEGREE},
        {.kind = IMK_STEP_HOLD, .duration = 30.0},
    };
    imk_motion_script script = plain(4, steps);
    script.earth = true;
    script.speed = 80.0;
    script.heading = 1.0;
    const compiled c = compile(&script);
    const imk_motion_state before = state_at(&c, begin_of(&c, 1));
    const imk_motion_state after = state_at(&c, begin_of(&c, 2));
    /* Below the centimetre heights are limited by the interpolation of 10 s: 1e-9 m, and by the
     * rounding of geocentric coordinates: 1e-9 m. */
    CHECK_CLOSE(after.place.height - before.place.height, 80.0 * sin(6.0 * DEGREE) * 60.0, 1e-7);
    CHECK_CLOSE(after.velocity_ned.v[2], -80.0 * sin(6.0 * DEGREE), 1e-12);
    CHECK_CLOSE(before.velocity_ned.v[2], -80.0 * sin(6.0 * DEGREE), 1e-12);
    double roll, pitch, yaw;
    imk_matrix3_to_euler(after.c_nb, &roll, &pitch, &yaw);
    CHECK_CLOSE(roll, 0.0, 1e-14);
    CHECK_CLOSE(pitch, 6.0 * DEGREE, 1e-14);
    CHECK_CLOSE(yaw, 1.0, 1e-14);
    const imk_motion_state level = state_at(&c, begin_of(&c, 3)),
                           end = state_at(&c, begin_of(&c, 4));
    CHECK_CLOSE(end.place.height, level.place.height, 1e-7);
    free(c.piece);
}

/* On a parallel the longitude grows by v T/((R_p + h) cos B) and the latitude stays; across the
 * line of 180 deg, and 1 deg from a pole. */
static void test_along_a_parallel(void **unused)
{
    (void)unused;
    const imk_motion_step steps[] = {{.kind = IMK_STEP_HOLD, .duration = 200.0}};
    static const double latitudes[] = {0.0, 0.7, -1.2, 89.0 * DEGREE};
    for (size_t i = 0; i < 4; i++) {
        imk_motion_script script = plain(1, steps);
        script.earth = true;
        script.place = (imk_geodetic){latitudes[i], 179.99 * DEGREE, 1000.0};
        script.speed = 250.0;
        script.heading = 0.5 * PI;
        const compiled c = compile(&script);
        double meridian, prime_vertical;
        imk_curvature_radii(latitudes[i], &meridian, &prime_vertical);
        const double distance = 250.0 * 200.0, cosine = cos(latitudes[i]);
        const double turn = distance / ((prime_vertical + 1000.0) * cosine);
        const imk_motion_state end = state_at(&c, 200.0);
        /* 1e-14 rad is 6e-8 m. */
        CHECK_CLOSE(end.place.latitude, latitudes[i], 1e-14);
        CHECK_CLOSE(remainder(end.place.longitude - 179.99 * DEGREE - turn, 2.0 * PI), 0.0,
                    1e-14 / cosine);
        CHECK_CLOSE(end.place.height, 1000.0, 1e-7);
        free(c.piece);
    }
}

/* ---- the body -------------------------------------------------------------------------------- */

static void test_rotation(void **unused)
{
    (void)unused;
    const double rate = 300.0 * DEGREE;
    for (int axis = 0; axis < 3; axis++) {
        const imk_motion_step steps[] = {
            {.kind = IMK_STEP_ROTATE, .axis = axis, .amount = 20.25 * 2.0 * PI, .rate = rate}};
        imk_motion_script script = plain(1, steps);
        script.mounting[0] = 0.4;
        script.mounting[1] = -0.2;
        const compiled c = compile(&script);
        const double length = imk_motion_step_duration(&script, 0);
        double most = 0.0;
        for (int i = 0; i <= 2000; i++) {
            const imk_vector3 w = state_at(&c, length * i / 2000.0).angular_rate;
            most = fmax(most, w.v[axis]);
            CHECK_CLOSE(w.v[(axis + 1) % 3], 0.0, 1e-12);
            CHECK_CLOSE(w.v[(axis + 2) % 3], 0.0, 1e-12);
        }
        CHECK_CLOSE(most, rate, rate_error);
        imk_vector3 quarter = {{0.0, 0.0, 0.0}};
        quarter.v[axis] = 0.5 * PI;
        const imk_quaternion begin = state_at(&c, 0.0).attitude;
        const imk_quaternion due =
            imk_quaternion_multiply(begin, imk_quaternion_from_rotation_vector(quarter));
        CHECK_CLOSE(angle_between(state_at(&c, length).attitude, due), 0.0, 1e-13);
        free(c.piece);
    }
}

/* From one attitude to another about one axis, which the rate has all the time. */
static void test_pose(void **unused)
{
    (void)unused;
    const imk_motion_step steps[] = {
        {.kind = IMK_STEP_POSE, .duration = 4.0, .angle = {0.3, -1.2, 2.5}},
        {.kind = IMK_STEP_POSE, .duration = 2.0, .angle = {PI, 0.5 * PI, 0.0}},
        {.kind = IMK_STEP_POSE, .duration = 2.0, .angle = {PI, 0.5 * PI, 0.0}},
    };
    imk_motion_script script = plain(3, steps);
    script.heading = -0.7;
    script.mounting[2] = 0.2;
    const compiled c = compile(&script);
    double time = 0.0;
    for (size_t i = 0; i < 3; i++) {
        const double length = imk_motion_step_duration(&script, i);
        const imk_quaternion begin = state_at(&c, time).attitude;
        const imk_quaternion end = imk_quaternion_from_matrix(
            imk_matrix3_from_euler(steps[i].angle[0], steps[i].angle[1], steps[i].angle[2]));
        CHECK_CLOSE(angle_between(state_at(&c, time + length).attitude, end), 0.0, 1e-14);
        const double angle = angle_between(begin, end);
        const imk_motion_state part = state_at(&c, time + 0.3 * length);
        CHECK_CLOSE(angle_between(begin, part.attitude), angle * smooth(0.3), 1e-9);
        const imk_motion_state half = state_at(&c, time + 0.5 * length);
        CHECK_CLOSE(imk_vector3_norm(half.angular_rate), 1.875 * angle / length, rate_error);
        const imk_vector3 across = imk_vector3_cross(part.angular_rate, half.angular_rate);
        CHECK_CLOSE(imk_vector3_norm(across), 0.0, 2.0 * rate_error);
        time += length;
    }
    free(c.piece);
}

/* a sin(2 pi f t) between growth and decay of a cycle, or of as many as the smoothing takes. */
static void test_swing(void **unused)
{
    (void)unused;
    const double amplitude = 0.1, frequency = 4.0, w = 2.0 * PI * frequency;
    static const double smoothings[] = {0.1, 0.6};
    static const double growths[] = {0.25, 0.75}; /* one cycle, three cycles */
    for (int i = 0; i < 2; i++) {
        const imk_motion_step steps[] = {{.kind = IMK_STEP_SWING,
                                          .axis = 1,
                                          .amount = amplitude,
                                          .frequency = frequency,
                                          .duration = 5.1}};
        imk_motion_script script = plain(1, steps);
        script.smoothing = smoothings[i];
        const compiled c = compile(&script);
        for (int j = 0; j <= 100; j++) {
            const double time = growths[i] + j / 100.0 * (5.1 - 2.0 * growths[i]);
            const imk_motion_state s = state_at(&c, time);
            check_vector(s.angular_rate, 0.0, amplitude * w * cos(w * time), 0.0, 1.5 * rate_error);
            CHECK_CLOSE(2.0 * asin(s.attitude.y), amplitude * sin(w * time), 1e-10);
        }
        const double time = 0.3 * growths[i];
        CHECK_CLOSE(2.0 * asin(state_at(&c, time).attitude.y),
                    amplitude * smooth(0.3) * sin(w * time), 1e-10);
        CHECK_CLOSE(2.0 * asin(state_at(&c, 5.1 - time).attitude.y),
                    amplitude * smooth(0.3) * sin(w * (5.1 - time)), 1e-10);
        CHECK_CLOSE(angle_between(state_at(&c, 5.1).attitude, state_at(&c, 0.0).attitude), 0.0,
                    0.0);
        free(c.piece);
    }
}

/* Coning of half angle a at w: q = (cos a/2, u sin a/2), u in the plane across the axis at the
 * angle w t. Differentiated, 2 vec(q* q') = (-w sin a sin(w t), w sin a cos(w t), -2 w sin^2(a/2))
 * in the axes (u at t = 0, the next, the cone's axis). */
static void test_coning(void **unused)
{
    (void)unused;
    const double angle = 0.05, frequency = 10.0, w = 2.0 * PI * frequency;
    for (int axis = 0; axis < 3; axis++) {
        const imk_motion_step steps[] = {{.kind = IMK_STEP_CONING,
                                          .axis = axis,
                                          .amount = angle,
                                          .frequency = frequency,
                                          .duration = 3.0}};
        const imk_motion_script script = plain(1, steps);
        const compiled c = compile(&script);
        /* The axis about which the body is tilted at t = 0, and the one after it. */
        const int first = (axis + 1) % 3, second = (axis + 2) % 3;
        for (int j = 0; j <= 100; j++) {
            const double time = 0.5 + 0.02 * j;
            const imk_motion_state s = state_at(&c, time);
            const double sine = sin(angle), half = sin(0.5 * angle);
            CHECK_CLOSE(s.angular_rate.v[first], -w * sine * sin(w * time), 2.0 * rate_error);
            CHECK_CLOSE(s.angular_rate.v[second], w * sine * cos(w * time), 2.0 * rate_error);
            CHECK_CLOSE(s.angular_rate.v[axis], -2.0 * w * half * half, 2.0 * rate_error);
            imk_vector3 unit = {{0.0, 0.0, 0.0}};
            unit.v[axis] = 1.0;
            const imk_vector3 tip = imk_quaternion_rotate(s.attitude, unit);
            CHECK_CLOSE(tip.v[axis], cos(angle), 1e-11);
        }
        CHECK_CLOSE(angle_between(state_at(&c, 3.0).attitude, state_at(&c, 0.0).attitude), 0.0,
                    0.0);
        free(c.piece);
    }
}

/* Gravity of a body mounted on its side. */
static void test_mounting(void **unused)
{
    (void)unused;
    const imk_motion_step steps[] = {{.kind = IMK_STEP_HOLD, .duration = 1.0}};
    imk_motion_script script = plain(1, steps);
    script.earth = true;
    script.mounting[0] = 0.5 * PI;
    const compiled c = compile(&script);
    const double gravity = imk_normal_gravity(0.25 * PI, 0.0);
    check_vector(state_at(&c, 0.5).specific_force, 0.0, -gravity, 0.0, 1e-8);
    free(c.piece);
}

/* ---- pieces ---------------------------------------------------------------------------------- */

static double value(const double *coefficient, int degree, int derivative, double s)
{
    double sum = 0.0;
    for (int i = degree; i >= derivative; i--) {
        double factor = coefficient[i];
        for (int j = 0; j < derivative; j++)
            factor *= i - j;
        sum = sum * s + factor;
    }
    return sum;
}

/* Position with three derivatives and quaternion with two are continuous: rounding is left, larger
 * where short pieces have large coefficients. */
static void check_seams(const compiled *c)
{
    static const double position[4] = {1e-9, 1e-13, 1e-12, 1e-8};
    static const double quaternion[3] = {1e-15, 1e-14, 1e-11};
    for (size_t i = 0; i + 1 < c->trajectory.piece_count; i++) {
        const imk_trajectory_piece *a = &c->piece[i], *b = &c->piece[i + 1];
        CHECK_CLOSE(a->start + a->length, b->start, 1e-13 * b->start);
        for (int d = 0; d < 4; d++)
            for (int k = 0; k < 3; k++)
                CHECK_CLOSE(value(a->position[k], 6, d, a->length),
                            value(b->position[k], 6, d, 0.0), position[d]);
        for (int d = 0; d < 3; d++)
            for (int k = 0; k < 4; k++)
                CHECK_CLOSE(value(a->quaternion[k], 5, d, a->length),
                            value(b->quaternion[k], 5, d, 0.0), quaternion[d]);
    }
}

static void test_continuity(void **unused)
{
    (void)unused;
    imk_motion_script script;
    imk_motion_step steps[CAR_PROFILE_STEPS];
    car_profile(&script, steps);
    for (int banked = 0; banked < 2; banked++) {
        for (size_t i = 0; i < CAR_PROFILE_STEPS; i++)
            steps[i].banked = banked;
        const compiled c = compile(&script);
        check_seams(&c);
        CHECK_CLOSE(c.piece[c.trajectory.piece_count - 1].start, CAR_PROFILE_DURATION, 1e-9);
        CHECK_BELOW((double)c.trajectory.piece_count, 2500.0);
        free(c.piece);
    }
}

static bool is_constant(const imk_trajectory_piece *piece)
{
    for (int i = 1; i < 7; i++)
        for (int k = 0; k < 3; k++)
            if (piece->position[k][i] != 0.0)
                return false;
    for (int i = 1; i < 6; i++)
        for (int k = 0; k < 4; k++)
            if (piece->quaternion[k][i] != 0.0)
                return false;
    return true;
}

/* A car that waits is one constant piece, as is its rest at the end, and both ends of a wait are
 * the same to the last bit. */
static void test_rest_is_constant(void **unused)
{
    (void)unused;
    imk_motion_script script;
    imk_motion_step steps[CAR_PROFILE_STEPS];
    car_profile(&script, steps);
    const compiled c = compile(&script);
    double time = 0.0, speed = 0.0;
    int waits = 0;
    for (size_t i = 0; i < script.step_count; i++) {
        const double length = imk_motion_step_duration(&script, i);
        if (steps[i].kind == IMK_STEP_ACCELERATE)
            speed += steps[i].amount;
        size_t j = 0;
        while (c.piece[j].start < time - 1e-9)
            j++;
        if (steps[i].kind == IMK_STEP_HOLD && speed == 0.0) {
            waits++;
            assert_true(is_constant(&c.piece[j]));
            CHECK_CLOSE(c.piece[j].length, length, 1e-9);
            const imk_trajectory_piece *next = &c.piece[j + 1];
            for (int k = 0; k < 3; k++)
                assert_true(c.piece[j].position[k][0] == next->position[k][0]);
            for (int k = 0; k < 4; k++)
                assert_true(c.piece[j].quaternion[k][0] == next->quaternion[k][0]);
        }
        time += length;
    }
    assert_int_equal(waits, 5);
    assert_true(is_constant(&c.piece[c.trajectory.piece_count - 1]));
    free(c.piece);
}

/* Wherever on Earth: that its geocentric coordinates lead back to a slightly other latitude does
 * not turn the body. */
static void test_rest_anywhere(void **unused)
{
    (void)unused;
    const imk_motion_step steps[] = {
        {.kind = IMK_STEP_HOLD, .duration = 5.0},
        {.kind = IMK_STEP_TURN, .amount = 1.0, .rate = 0.5},
        {.kind = IMK_STEP_HOLD, .duration = 5.0},
    };
    for (int i = 0; i < 50; i++) {
        imk_motion_script script = plain(3, steps);
        script.earth = true;
        script.place = (imk_geodetic){1.5 * sin(3.0 * i), 3.1 * sin(7.0 * i), 20.0 * i};
        script.heading = 0.1 * i;
        const compiled c = compile(&script);
        assert_true(is_constant(&c.piece[0]));
        assert_true(is_constant(&c.piece[c.trajectory.piece_count - 2]));
        assert_true(is_constant(&c.piece[c.trajectory.piece_count - 1]));
        free(c.piece);
    }
}

/* Speeds that add up to zero but for rounding are rest. */
static void test_rounded_rest(void **unused)
{
    (void)unused;
    const imk_motion_step steps[] = {
        {.kind = IMK_STEP_ACCELERATE, .amount = 0.1, .rate = 1.0},
        {.kind = IMK_STEP_ACCELERATE, .amount = 0.2, .rate = 1.0},
        {.kind = IMK_STEP_ACCELERATE, .amount = -0.3, .rate = 1.0},
    };
    assert_true(0.1 + 0.2 - 0.3 != 0.0);
    const imk_motion_script script = plain(3, steps);
    const compiled c = compile(&script);
    assert_true(isinf(c.piece[c.trajectory.piece_count - 1].length));
    free(c.piece);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_durations),
        cmocka_unit_test(test_straight_line),
        cmocka_unit_test(test_small_amount),
        cmocka_unit_test(test_turn_on_the_spot),
        cmocka_unit_test(test_circle),
        cmocka_unit_test(test_increments_of_a_turn),
        cmocka_unit_test(test_banked_turn),
        cmocka_unit_test(test_climb),
        cmocka_unit_test(test_along_a_parallel),
        cmocka_unit_test(test_rotation),
        cmocka_unit_test(test_pose),
        cmocka_unit_test(test_swing),
        cmocka_unit_test(test_coning),
        cmocka_unit_test(test_mounting),
        cmocka_unit_test(test_continuity),
        cmocka_unit_test(test_rest_is_constant),
        cmocka_unit_test(test_rest_anywhere),
        cmocka_unit_test(test_rounded_rest),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
