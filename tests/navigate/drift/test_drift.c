/* SPDX-License-Identifier: Apache-2.0 */
/* Drift at rest with one error on: Schuler's forms, the linear theory on a sphere, the instability
 * of the vertical, and the random walks. */
#include "check.h"

#include "imukit/distributions.h"
#include "imukit/elementary.h"
#include "imukit/navigate.h"
#include "imukit/random.h"

#include <stdlib.h>

static const double degree = 0.017453292519943295, standard_g = 9.80665;
#define DEGREE_PER_HOUR (degree / 3600.0)
#define MICRO_G (1e-6 * standard_g)

/* 45 deg N on the ellipsoid, level, x to the north. */
static imk_geodetic here(void)
{
    return (imk_geodetic){45.0 * degree, 0.2, 0.0};
}

/* At rest there, with constant errors [rad/s, m/s^2] in body axes. */
typedef struct parked {
    imk_navigation_state start;
    imk_strapdown strapdown;
    double dt;
    imk_vector3 rate, force; /* true ones */
} parked;

static parked park(double dt, bool hold_height)
{
    const imk_geodetic place = here();
    parked p = {
        .start = imk_navigation_state_ned(0.0, place, (imk_vector3){{0}}, imk_matrix3_identity()),
        .dt = dt,
        .rate = imk_earth_rate(place.latitude),
        .force = {{0.0, 0.0, -imk_normal_gravity(place.latitude, place.height)}}};
    p.strapdown = imk_strapdown_start(&p.start);
    p.strapdown.hold_height = hold_height;
    return p;
}

static void go(parked *p, imk_vector3 rate_error, imk_vector3 force_error)
{
    const imk_vector3 rate = imk_vector3_add(p->rate, rate_error);
    const imk_vector3 force = imk_vector3_add(p->force, force_error);
    imk_strapdown_step(&p->strapdown, p->dt, imk_vector3_scale(rate, p->dt),
                       imk_vector3_scale(force, p->dt));
}

/* Position error [m], north, east, down, after `seconds` with constant errors. */
static imk_vector3 drift(double seconds, double dt, bool hold_height, imk_vector3 rate_error,
                         imk_vector3 force_error)
{
    parked p = park(dt, hold_height);
    const int count = (int)(seconds / dt + 0.5);
    for (int k = 0; k < count; k++)
        go(&p, rate_error, force_error);
    return imk_navigation_difference_ned(&p.strapdown.state, &p.start);
}

static imk_vector3 along(int axis, double amount)
{
    imk_vector3 v = {{0}};
    v.v[axis] = amount;
    return v;
}

static const imk_vector3 none = {{0}};

/* Schuler's rate of the direction the body errs in [1/s]: g over the radius of curvature. */
static double schuler(int axis)
{
    const imk_geodetic place = here();
    double radius[2];
    imk_curvature_radii(place.latitude, &radius[0], &radius[1]);
    return sqrt(imk_normal_gravity(place.latitude, 0.0) / radius[axis]);
}

/* (b/w^2)(1 - cos wt), b t^2/2 to begin with. At 60 s Schuler's part is 5e-4 of it; what the form
 * leaves out, the Earth's rotation, is of relative (w_ie t)^2/6 = 3e-6. */
static void test_accelerometer_over_a_minute(void **state)
{
    (void)state;
    const double b = 50 * MICRO_G;
    for (int axis = 0; axis < 2; axis++) {
        const double w = schuler(axis), t = 60.0;
        const imk_vector3 d = drift(t, 0.01, true, none, along(axis, b));
        CHECK_RELATIVE(d.v[axis], b / (w * w) * (1 - imk_cos(w * t)), 1e-5);
        CHECK_RELATIVE(d.v[axis], b * t * t / 2, 1e-3);
    }
}

/* R e (t - sin(wt)/w), g e t^3/6 to begin with: a gyro that turns to the north tilts the platform
 * about north, and gravity seems to come from the east; about east, from the south. */
static void test_gyro_over_a_minute(void **state)
{
    (void)state;
    const double e = 0.01 * DEGREE_PER_HOUR, t = 60.0, g = imk_normal_gravity(45 * degree, 0);
    for (int axis = 0; axis < 2; axis++) {
        const int other = 1 - axis;
        const double w = schuler(other), sign = axis == 0 ? 1.0 : -1.0;
        const imk_vector3 d = drift(t, 0.01, true, along(axis, e), none);
        CHECK_RELATIVE(d.v[other], sign * g / (w * w) * e * (t - imk_sin(w * t) / w), 1e-4);
        CHECK_RELATIVE(d.v[other], sign * g * e * t * t * t / 6, 1e-3);
    }
    /* 0.0171 m, rounded */
    CHECK_CLOSE(g * e * t * t * t / 6, 0.0171, 5e-5);
}

/* Independent linear theory on a sphere of 6371 km with g = 9.80665 and the Earth's rotation, one
 * hour at 45 deg N; the ellipsoid's radii there are 6367 and 6389 km. What is 1 % of the largest
 * component: radii and gravity enter tilt and way by 0.3 % each. */
static void test_linear_theory_over_an_hour(void **state)
{
    (void)state;
    const double e = 0.01 * DEGREE_PER_HOUR, b = 50 * MICRO_G;
    const imk_vector3 north = drift(3600.0, 0.1, true, along(0, e), none);
    const imk_vector3 east = drift(3600.0, 0.1, true, along(1, e), none);
    const imk_vector3 azimuth = drift(3600.0, 0.1, true, along(2, e), none);
    CHECK_RELATIVE(north.v[1], 1340.6, 0.01);
    CHECK_RELATIVE(east.v[0], -1336.5, 0.01);
    CHECK_RELATIVE(azimuth.v[0], -89.6, 0.01);
    for (int axis = 0; axis < 2; axis++) {
        const imk_vector3 accel = drift(3600.0, 0.1, true, none, along(axis, b));
        CHECK_RELATIVE(accel.v[axis], 396.0, 0.01);
        /* the Earth's turn deflects it */
        CHECK_CLOSE(accel.v[1 - axis], 0.0, 0.01 * 396.0);
    }
    /* the height is held, but for the fall of the tangent over 1350 m, d^2/(2 R) */
    CHECK_CLOSE(north.v[2], 1354.0 * 1354.0 / (2 * 6.38e6), 0.002);
}

/* Half a Schuler period after the start the accelerometer's error is largest: 634.4 m in the same
 * theory, 637.1 m = 2 b/w^2 without the Earth's rotation; and after a whole one it is back. */
static void test_schuler_oscillation(void **state)
{
    (void)state;
    parked p = park(0.1, true);
    double largest = 0.0, when = 0.0, least = HUGE_VAL;
    for (int k = 1; k <= 54000; k++) {
        go(&p, none, along(0, 50 * MICRO_G));
        if (k % 10 != 0)
            continue;
        const double north = imk_navigation_difference_ned(&p.strapdown.state, &p.start).v[0];
        if (north > largest) {
            largest = north;
            when = 0.1 * k;
        }
        if (k > 45000)
            least = fmin(least, north);
    }
    CHECK_RELATIVE(largest, 634.4, 0.01);
    CHECK_RELATIVE(when, 3.14159265358979 / schuler(0), 0.01);
    /* the oscillation has turned by w_ie sin(latitude) t = 15 deg meanwhile */
    CHECK_BELOW(fabs(least), 0.02 * largest);
}

/* Free in height an error grows as cosh(k t), k^2 the gradient of gravity, (b/k^2)(cosh kt - 1):
 * 43.9 km in an hour in the theory above. The way gone up also turns the body's path west, which
 * lifts it less, by about 4 w_ie^2 cos^2(latitude)/k^2 = 0.3 % of k^2. */
static void test_free_height(void **state)
{
    (void)state;
    const double latitude = 45.0 * degree;
    const double gradient =
        (imk_normal_gravity(latitude, -50.0) - imk_normal_gravity(latitude, 50.0)) / 100.0;
    const double k = sqrt(gradient), t = 3600.0, b = 50 * MICRO_G;
    const imk_vector3 minute = drift(60.0, 0.01, false, none, along(2, b));
    CHECK_RELATIVE(minute.v[2], b / gradient * (cosh(60.0 * k) - 1.0), 1e-5);
    const imk_vector3 small = drift(t, 0.1, false, none, along(2, 0.01 * b));
    CHECK_RELATIVE(small.v[2], 0.01 * b / gradient * (cosh(k * t) - 1.0), 0.01);
    const imk_vector3 large = drift(t, 0.1, false, none, along(2, b));
    CHECK_RELATIVE(large.v[2], 43.9e3, 0.01);
}

/* ---- random walks ---------------------------------------------------------------------------- */

enum { RUNS = 200, SECONDS = 60, RATE = 10 };

static int compare(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Positions after a minute, of both axes in units of sigma. White noise of density N is a rate or
 * force that is constant over each sample, N/sqrt(dt) of standard deviation. */
static void random_walks(uint64_t seed, double gyro, double accel, double sigma, double *scaled)
{
    const imk_random random = imk_random_seeded(seed);
    for (uint32_t run = 0; run < RUNS; run++) {
        parked p = park(1.0 / RATE, true);
        const double scale = sqrt((double)RATE);
        for (uint64_t k = 0; k < SECONDS * RATE; k++) {
            double n[16];
            imk_random_normals(random, imk_stream(run, 1, 0, 0), 16 * k, 16, n);
            imk_vector3 rate, force;
            for (int i = 0; i < 3; i++) {
                rate.v[i] = gyro * scale * n[i];
                force.v[i] = accel * scale * n[3 + i];
            }
            go(&p, rate, force);
        }
        const imk_vector3 d = imk_navigation_difference_ned(&p.strapdown.state, &p.start);
        scaled[2 * run] = d.v[0] / sigma;
        scaled[2 * run + 1] = d.v[1] / sigma;
    }
}

/* 400 standard normal values, north and east being independent: their sum of squares has the
 * chi-square distribution, and their distribution function is within 0.135 of the normal one
 * (Dvoretzky, Kiefer and Wolfowitz); each fails once in a million. The forms leave out Schuler's
 * part, (w t)^2 = 0.5 % of the position, and the sample's length, 1/600. */
static void check_normal(double *scaled)
{
    const size_t count = 2 * RUNS;
    double squares = 0.0;
    for (size_t i = 0; i < count; i++)
        squares += scaled[i] * scaled[i];
    CHECK_BELOW(imk_chi_square_quantile(5e-7, (double)count) * 0.99, squares);
    CHECK_BELOW(squares, imk_chi_square_quantile(1.0 - 5e-7, (double)count) * 1.01);
    qsort(scaled, count, sizeof *scaled, compare);
    double distance = 0.0;
    for (size_t i = 0; i < count; i++) {
        const double expected = 0.5 * erfc(-scaled[i] / sqrt(2.0));
        distance = fmax(distance, fabs(expected - (double)i / (double)count));
        distance = fmax(distance, fabs(expected - (double)(i + 1) / (double)count));
    }
    CHECK_BELOW(distance, sqrt(log(2.0 / 1e-6) / (2.0 * (double)count)) + 0.001);
    print_message("rms %.4f of sigma, distribution within %.3f\n", sqrt(squares / (double)count),
                  distance);
}

/* sigma = g N sqrt(t^5/20): an angle random walk is integrated three times; 0.0503 m for both axes
 * at 0.002 deg/sqrt(h). */
static void test_angle_random_walk(void **state)
{
    (void)state;
    static double scaled[2 * RUNS];
    const double n = 0.002 * degree / 60.0, t = SECONDS;
    const double sigma = imk_normal_gravity(45.0 * degree, 0.0) * n * sqrt(pow(t, 5) / 20.0);
    CHECK_CLOSE(sqrt(2.0) * sigma, 0.0503, 5e-5);
    random_walks(7, n, 0.0, sigma, scaled);
    check_normal(scaled);
}

/* sigma = N sqrt(t^3/3): 0.0372 m for both axes at 10 ug/sqrt(Hz). */
static void test_velocity_random_walk(void **state)
{
    (void)state;
    static double scaled[2 * RUNS];
    const double n = 10 * MICRO_G, t = SECONDS, sigma = n * sqrt(t * t * t / 3.0);
    CHECK_CLOSE(sqrt(2.0) * sigma, 0.0372, 5e-5);
    random_walks(8, 0.0, n, sigma, scaled);
    check_normal(scaled);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_accelerometer_over_a_minute),
        cmocka_unit_test(test_gyro_over_a_minute),
        cmocka_unit_test(test_linear_theory_over_an_hour),
        cmocka_unit_test(test_schuler_oscillation),
        cmocka_unit_test(test_free_height),
        cmocka_unit_test(test_angle_random_walk),
        cmocka_unit_test(test_velocity_random_walk),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
