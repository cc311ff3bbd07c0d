/* SPDX-License-Identifier: Apache-2.0 */
/* Pieces against the functions of time that a script stands for: rates and accelerations anywhere
 * within a piece, in north-east-down axes that turn on the Earth,
 *
 *     w_eb = w_nb + C_bn w_en,     C_ne r'' = v_n' + w_en x v_n,
 *     w_en = (v_east/(R_p + h), -v_north/(R_m + h), -v_east tan B/(R_p + h))
 *
 * [GROVES2013, eq. 5.44]; and the smooth functions against the sums they are built from. */
#include "check.h"

#include "car_profile.h"
#include "motion/script_step_internal.h"

#include <stdlib.h>

#define PI 3.14159265358979323846
#define DEGREE (PI / 180.0)

/* ---- profiles -------------------------------------------------------------------------------- */

/* Derivatives against central differences, at times off the joints. */
static void check_derivatives(imki_jet (*function)(const void *, double), const void *context,
                              double time, double scale)
{
    const double step = 1e-5;
    const imki_jet before = function(context, time - step), at = function(context, time),
                   after = function(context, time + step);
    for (int i = 0; i < 3; i++)
        CHECK_CLOSE(at.d[i + 1], (after.d[i] - before.d[i]) / (2.0 * step), scale);
}

static imki_jet profile_at(const void *context, double time)
{
    return imki_profile_at(context, time);
}

static imki_jet smooth_step_at(const void *context, double time)
{
    return imki_smooth_step(time, *(const double *)context);
}

static imki_jet sine_at(const void *context, double time)
{
    return imki_jet_sine(time, *(const double *)context);
}

static void test_profile(void **unused)
{
    (void)unused;
    static const double amounts[] = {3.0, -3.0, 0.4, 1e5};
    for (int i = 0; i < 4; i++) {
        const imki_profile p = imki_profile_make(amounts[i], 1.5, 0.7);
        const double length = imki_profile_length(&p);
        CHECK_CLOSE(imki_profile_at(&p, 0.0).d[0], 0.0, 0.0);
        CHECK_CLOSE(imki_profile_at(&p, length).d[0], amounts[i], 0.0);
        /* Symmetric about the middle. */
        for (int j = 1; j < 50; j++) {
            const double t = 0.5 * length * j / 50.0;
            CHECK_RELATIVE(imki_profile_at(&p, t).d[0] + imki_profile_at(&p, length - t).d[0],
                           amounts[i], 1e-14);
        }
        /* Truncation: step^2/6 times the next derivatives but one, up to 360 p/h^4 = 2250; and
         * rounding, which at 1e5 is 1e-6. */
        for (int j = 0; j < 20; j++) {
            check_derivatives(profile_at, &p, 0.03 + 0.6 * j / 20.0, 1e-5);
            check_derivatives(profile_at, &p, length - 0.03 - 0.6 * j / 20.0, 1e-5);
        }
        const double half = imki_profile_at(&p, 0.5 * length).d[1];
        CHECK_RELATIVE(half,
                       fabs(amounts[i]) / 1.5 > 0.7 ? copysign(1.5, amounts[i]) : amounts[i] / 0.7,
                       1e-15);
    }
}

static void test_jets(void **unused)
{
    (void)unused;
    const double length = 2.0, frequency = 0.8;
    for (int j = 0; j < 20; j++) {
        check_derivatives(smooth_step_at, &length, 0.05 + 0.095 * j, 1e-7);
        check_derivatives(sine_at, &frequency, 0.37 * j, 1e-7);
    }
    /* atan(x^2 + x) at x = 0.5, differentiated by hand: u = 0.75, u' = 2, u'' = 2:
     * u'/(1 + u^2) = 1.28, u''/(1 + u^2) - 2 u u'^2/(1 + u^2)^2 = 1.28 - 2.4576. */
    const imki_jet arc = imki_jet_arc_tangent((imki_jet){{0.75, 2.0, 2.0, 0.0}});
    CHECK_CLOSE(arc.d[0], atan(0.75), 1e-16);
    CHECK_CLOSE(arc.d[1], 1.28, 1e-15);
    CHECK_CLOSE(arc.d[2], -1.1776, 1e-15);
    /* (x^2 + 1)(x^3) = x^5 + x^3 at x = 2: 40, 92, 172, 246. */
    const imki_jet product =
        imki_jet_product((imki_jet){{5.0, 4.0, 2.0, 0.0}}, (imki_jet){{8.0, 12.0, 12.0, 6.0}});
    static const double expected[4] = {40.0, 92.0, 172.0, 246.0};
    for (int i = 0; i < 4; i++)
        CHECK_CLOSE(product.d[i], expected[i], 0.0);
}

/* A polynomial of degree five is its own interpolant. */
static void test_quintic(void **unused)
{
    (void)unused;
    static const double c[6] = {1.0, -2.0, 3.0, 0.5, -1.5, 0.25};
    const double h = 1.7;
    const double first[3] = {c[0], c[1], 2.0 * c[2]};
    const double h2 = h * h, h3 = h2 * h, h4 = h3 * h;
    const double last[3] = {c[0] + c[1] * h + c[2] * h2 + c[3] * h3 + c[4] * h4 + c[5] * h4 * h,
                            c[1] + 2.0 * c[2] * h + 3.0 * c[3] * h2 + 4.0 * c[4] * h3 +
                                5.0 * c[5] * h4,
                            2.0 * c[2] + 6.0 * c[3] * h + 12.0 * c[4] * h2 + 20.0 * c[5] * h3};
    double coefficient[6];
    imki_quintic(first, last, h, coefficient);
    for (int i = 0; i < 6; i++)
        CHECK_CLOSE(coefficient[i], c[i], 1e-13);
}

/* ---- pieces ---------------------------------------------------------------------------------- */

typedef struct worst {
    double rate, acceleration;
} worst;

static imk_vector3 vector_of(imk_quaternion q)
{
    return (imk_vector3){{q.x, q.y, q.z}};
}

/* Value, first and second derivative. */
static void polynomial(const double *coefficient, int degree, double s, double result[3])
{
    result[0] = result[1] = result[2] = 0.0;
    for (int i = degree; i >= 0; i--) {
        result[2] = result[2] * s + 2.0 * result[1];
        result[1] = result[1] * s + result[0];
        result[0] = result[0] * s + coefficient[i];
    }
}

static void check_instant(const imk_trajectory *trajectory, const imk_trajectory_piece *piece,
                          double s, const imki_local_motion *due, worst *most)
{
    double r[3][3], q[4][3];
    for (int k = 0; k < 3; k++)
        polynomial(piece->position[k], 6, s, r[k]);
    for (int k = 0; k < 4; k++)
        polynomial(piece->quaternion[k], 5, s, q[k]);
    const imk_vector3 rate =
        imki_quaternion_rate((imk_quaternion){q[0][0], q[1][0], q[2][0], q[3][0]},
                             (imk_quaternion){q[0][1], q[1][1], q[2][1], q[3][1]});
    const imk_vector3 v = vector_of(due->velocity.d[0]);
    imk_vector3 turning = {{0.0, 0.0, 0.0}};
    imk_matrix3 axes = imk_matrix3_identity();
    if (trajectory->earth) {
        const double *o = trajectory->origin;
        const imk_geodetic place =
            imk_geodetic_from_ecef((imk_vector3){{o[0] + r[0][0], o[1] + r[1][0], o[2] + r[2][0]}});
        double meridian, prime_vertical;
        imk_curvature_radii(place.latitude, &meridian, &prime_vertical);
        const double east = v.v[1] / (prime_vertical + place.height);
        turning =
            (imk_vector3){{east, -v.v[0] / (meridian + place.height), -east * tan(place.latitude)}};
        axes = imk_ned_axes(place.latitude, place.longitude);
    }
    const imk_matrix3 c_nb = imk_quaternion_to_matrix(due->attitude.d[0]);
    const imk_vector3 rate_due =
        imk_vector3_add(imki_quaternion_rate(due->attitude.d[0], due->attitude.d[1]),
                        imk_matrix3_apply(imk_matrix3_transpose(c_nb), turning));
    const imk_vector3 acceleration_due =
        imk_vector3_add(vector_of(due->velocity.d[1]), imk_vector3_cross(turning, v));
    const imk_vector3 acceleration =
        imk_matrix3_apply(imk_matrix3_transpose(axes), (imk_vector3){{r[0][2], r[1][2], r[2][2]}});
    const double rate_off = imk_vector3_norm(imk_vector3_subtract(rate, rate_due));
    most->rate = fmax(most->rate, rate_off / (1.0 + 0.1 * imk_vector3_norm(rate_due)));
    most->acceleration = fmax(
        most->acceleration, imk_vector3_norm(imk_vector3_subtract(acceleration, acceleration_due)));
}

/* The largest departures of the pieces from the script: rates relative to 1 rad/s + a tenth of
 * the rate, as they are tolerated. */
static worst depart(const imk_motion_script *script)
{
    size_t count = 0;
    CHECK_OK(imk_motion_script_pieces(script, &count, NULL));
    imk_trajectory_piece *piece = malloc(count * sizeof *piece);
    assert_non_null(piece);
    imk_trajectory trajectory;
    CHECK_OK(imk_motion_script_compile(script, piece, count, &trajectory, NULL));
    imki_vehicle vehicle = imki_vehicle_start(script);
    worst most = {0.0, 0.0};
    double start = 0.0;
    size_t k = 0;
    for (size_t i = 0; i < script->step_count; i++) {
        imk_motion_state state;
        imk_trajectory_state(&trajectory, start, &state);
        const imk_geodetic place = script->earth ? state.place : script->place;
        const imki_step_run run = imki_step_begin(&script->step[i], script->smoothing, vehicle,
                                                  imk_normal_gravity(place.latitude, place.height));
        for (; k < count && piece[k].start < start + run.duration - 1e-9; k++)
            for (int j = 0; j <= 10; j++) {
                const double s = piece[k].length * j / 10.0;
                const imki_local_motion due = imki_step_motion(&run, piece[k].start + s - start);
                check_instant(&trajectory, &piece[k], s, &due, &most);
            }
        start += run.duration;
        vehicle = run.end;
    }
    free(piece);
    return most;
}

/* Pieces are tried at two points, which see their worst to some tenths: the tolerances are 1e-9 and
 * 1e-7. */
static void check_departure(const imk_motion_script *script)
{
    const worst most = depart(script);
    CHECK_BELOW(most.rate, 1.5e-9);
    /* Near a pole the directions of north and east turn too: more for the same pieces. */
    CHECK_BELOW(most.acceleration, script->place.latitude > 1.5 ? 2e-7 : 1.2e-7);
}

static void test_car(void **unused)
{
    (void)unused;
    imk_motion_script script;
    imk_motion_step steps[CAR_PROFILE_STEPS];
    car_profile(&script, steps);
    check_departure(&script);
    for (size_t i = 0; i < CAR_PROFILE_STEPS; i++)
        steps[i].banked = true;
    check_departure(&script);
}

static void test_aircraft(void **unused)
{
    (void)unused;
    const imk_motion_step steps[] = {
        {.kind = IMK_STEP_ACCELERATE, .amount = 250.0, .rate = 3.0},
        {.kind = IMK_STEP_CLIMB, .amount = 20.0 * DEGREE, .rate = 3.0 * DEGREE},
        {.kind = IMK_STEP_TURN, .amount = 4.0, .rate = 0.05, .banked = true},
        {.kind = IMK_STEP_CLIMB, .amount = -20.0 * DEGREE, .rate = 3.0 * DEGREE},
        {.kind = IMK_STEP_HOLD, .duration = 1000.0},
        {.kind = IMK_STEP_TURN, .amount = -1.0, .rate = 0.3, .banked = true},
        {.kind = IMK_STEP_ACCELERATE, .amount = -250.0, .rate = 30.0},
    };
    static const double smoothings[] = {0.05, 0.5, 20.0};
    static const double latitudes[] = {0.0, -0.8, 88.0 * DEGREE};
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            imk_motion_script script = imk_motion_script_default();
            script.step_count = sizeof steps / sizeof steps[0];
            script.step = steps;
            script.smoothing = smoothings[i];
            script.place = (imk_geodetic){latitudes[j], 179.9 * DEGREE, 500.0};
            check_departure(&script);
            script.earth = false;
            check_departure(&script);
        }
}

/* Rotations of the body, at rest and on the move. */
static void test_body(void **unused)
{
    (void)unused;
    const imk_motion_step steps[] = {
        {.kind = IMK_STEP_ROTATE, .axis = 2, .amount = 2.0 * PI, .rate = 36.0 * DEGREE},
        {.kind = IMK_STEP_ROTATE, .axis = 0, .amount = -20.0 * PI, .rate = 1000.0 * DEGREE},
        {.kind = IMK_STEP_POSE, .duration = 5.0, .angle = {0.0, 0.5 * PI, 0.0}},
        {.kind = IMK_STEP_POSE, .duration = 0.5, .angle = {3.0, 0.0, 2.0}},
        {.kind = IMK_STEP_SWING, .axis = 1, .amount = 0.1, .frequency = 1.0, .duration = 9.3},
        {.kind = IMK_STEP_SWING, .axis = 2, .amount = 1.0, .frequency = 2.0, .duration = 3.3},
        {.kind = IMK_STEP_CONING, .axis = 2, .amount = 0.02, .frequency = 10.0, .duration = 2.0},
        {.kind = IMK_STEP_CONING, .axis = 0, .amount = 0.5, .frequency = 30.0, .duration = 1.1},
    };
    for (int i = 0; i < 2; i++) {
        imk_motion_script script = imk_motion_script_default();
        script.step_count = sizeof steps / sizeof steps[0];
        script.step = steps;
        script.mounting[0] = 0.3;
        script.speed = i ? 100.0 : 0.0;
        script.climb = 0.2;
        check_departure(&script);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_profile),  cmocka_unit_test(test_jets),
        cmocka_unit_test(test_quintic),  cmocka_unit_test(test_car),
        cmocka_unit_test(test_aircraft), cmocka_unit_test(test_body),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
