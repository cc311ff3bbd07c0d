/* SPDX-License-Identifier: Apache-2.0 */
/* Single terms of the zero-velocity filter and limits of the standstill detector, each against a
 * closed form that leaves everything else out. How they act together: test_navigation_filter.c. */
#include "check.h"

#include "imukit/distributions.h"
#include "imukit/navigation_filter.h"
#include "imukit/noise.h"

#include <math.h>
#include <string.h>

typedef struct memory {
    double bytes[4000];
} memory;

static void set3(double v[3], double value)
{
    v[0] = v[1] = v[2] = value;
}

static imk_navigation_filter *start_filter(memory *m, const imk_navigation_filter_settings *s,
                                           const imk_navigation_state *start)
{
    imk_navigation_filter *filter;
    imk_error error;
    assert_true(imk_navigation_filter_size(s) <= sizeof *m);
    CHECK_OK(imk_navigation_filter_start(s, start, &filter, m, sizeof *m, &error));
    return filter;
}

/* The parts together have the variance of means and the Allan variance of the generated flicker,
 * whose sums are exact; what is faster than 3 s is left out, hence the tolerances. */
static void test_flicker_parts(void **state)
{
    (void)state;
    static const struct {
        double longest, constant;
        size_t parts;
        double tau, mean, allan; /* tolerances of standard deviations */
    } cases[] = {
        /* ln((pi/2) T/10^4.5)/pi */
        {0.0, 1.2431, 5, 100.0, 0.01, 0.03},  {1e6, 1.2431, 5, 3000.0, 0.01, 0.03},
        {1e8, 2.7090, 5, 1000.0, 0.01, 0.03}, {1e4, 0.0, 5, 1000.0, 0.03, 0.03},
        {1e3, 0.0, 4, 300.0, 0.04, 0.03},     {100.0, 0.0, 3, 100.0, 0.07, 0.07},
        {1.0, 0.0, 1, 100.0, 1.01, 1.01},
    };
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
        imk_model model;
        imk_model_default(&model);
        set3(model.gyro.noise.bias_instability.value, 1.0);
        model.gyro.noise.bias_instability_correlation_time.value = cases[c].longest;
        imk_navigation_filter_settings s;
        imk_navigation_filter_default(&s);
        CHECK_OK(imk_navigation_filter_describe(&model, 0.01, (imk_vector3){{0}},
                                                (imk_vector3){{0}}, &s, NULL));
        assert_int_equal(s.gyro.part_count, cases[c].parts);
        const double constant = s.gyro.part[0].sigma[0] * s.gyro.part[0].sigma[0];
        CHECK_CLOSE(constant, cases[c].constant, 1e-4);
        double mean = constant, allan = 0.0;
        for (size_t p = 1; p < s.gyro.part_count; p++) {
            const double time = s.gyro.part[p].correlation_time, a = cases[c].tau / time;
            const double sigma = s.gyro.part[p].sigma[0];
            mean += 2.0 * sigma * sigma * (a - 1.0 + exp(-a)) / (a * a);
            allan += imk_gauss_markov_allan_variance((imk_gauss_markov){sigma, time}, cases[c].tau);
        }
        const imk_flicker flicker = {1.0, cases[c].longest};
        const double dt = cases[c].tau / 1000.0;
        CHECK_RELATIVE(sqrt(mean), sqrt(imk_flicker_mean_variance(flicker, dt, 1000)),
                       cases[c].mean);
        CHECK_RELATIVE(sqrt(allan), sqrt(imk_flicker_sampled_allan_variance(flicker, dt, 1000)),
                       cases[c].allan);
    }
}

/* The limits: a mean of 1 and a variance of 2/30 are a chi-square variable of 30 degrees over 30;
 * each of four figures has a quarter of the false alarms. */
static void test_standstill_limits(void **state)
{
    (void)state;
    imk_error error;
    imk_standstill d = imk_standstill_start(1.0, 1e-3);
    d.learnt = 9;
    CHECK_STATUS(imk_standstill_ready(&d, &error), IMK_ERROR_TOO_SHORT);
    d.learnt = 101;
    for (int i = 0; i < IMK_STANDSTILL_FIGURES; i++) {
        d.sum[i] = 101.0;
        d.square_sum[i] = 101.0 + 100.0 * 2.0 / 30.0;
    }
    CHECK_OK(imk_standstill_ready(&d, &error));
    for (int i = 0; i < IMK_STANDSTILL_FIGURES; i++)
        CHECK_RELATIVE(d.limit[i], imk_chi_square_quantile(1.0 - 2.5e-4, 30.0) / 30.0, 1e-12);
    /* A scatter that goes +-s about a mean has the figure s^2, wherever its first sample is; a
     * distance is widened by four of its sigmas. */
    const double root = sqrt(d.limit[0]);
    static const struct {
        double force, rate, off, sigma;
        bool stands;
    } cases[] = {{0.99, 0.0, 0.0, 0.0, true}, {1.01, 0.0, 0.0, 0.0, false},
                 {0.0, 0.99, 0.0, 0.0, true}, {0.0, 1.01, 0.0, 0.0, false},
                 {0.0, 0.0, 0.99, 0.0, true}, {0.0, 0.0, 1.01, 0.0, false},
                 {0.0, 0.0, 4.9, 1.0, true},  {0.0, 0.0, 5.1, 1.0, false}};
    for (size_t c = 0; c < sizeof cases / sizeof cases[0]; c++) {
        const imk_rest_readings rest = {{{0}}, {{0}}, root * cases[c].sigma, root * cases[c].sigma};
        imk_standstill_verdict verdict = IMK_STANDSTILL_UNDECIDED;
        for (int k = 0; k < 10; k++) {
            const double sign = k % 2 == 0 ? 0.1 : -0.1;
            verdict = imk_standstill_add(
                &d, 0.1, (imk_vector3){{0.1 * root * cases[c].off, sign * root * cases[c].rate, 0}},
                (imk_vector3){{sign * root * cases[c].force, 0, 0.1 * root * cases[c].off}}, &rest);
        }
        assert_int_equal(verdict, cases[c].stands ? IMK_STANDSTILL_STANDS : IMK_STANDSTILL_MOVES);
    }
}

/* ---- one unit at rest, heading north, level; one-second samples --------------------------------
 */

static const imk_geodetic rest_place = {0.8, 0.7, 0.0};

static imk_navigation_filter *start_at_rest(memory *m, const imk_navigation_filter_settings *s,
                                            double north)
{
    const imk_navigation_state start = imk_navigation_state_ned(
        0.0, rest_place, (imk_vector3){{north, 0.0, 0.0}}, imk_matrix3_identity());
    return start_filter(m, s, &start);
}

/* @param turn  what gyro z reads too much in each sample [rad] */
static void rest_for(imk_navigation_filter *filter, int seconds, double turn)
{
    imk_vector3 rate = imk_earth_rate(rest_place.latitude);
    rate.v[2] += turn;
    const imk_vector3 up = {{0.0, 0.0, -imk_normal_gravity(rest_place.latitude, 0.0)}};
    for (int k = 0; k < seconds; k++)
        imk_navigation_filter_step(filter, 1.0, rate, up);
}

/* The mean rate over a stand: two readings of quantization q make its variance 2 q^2/t^2, so an
 * error of q has the normalised square 1/2. The noise it has is in the attitude as well, and leaves
 * it with the update; the direction of the Earth's rotation shows the heading. */
static void test_rotation(void **state)
{
    (void)state;
    static memory m;
    imk_navigation_filter_estimate end;
    imk_navigation_filter_settings s;
    imk_navigation_filter_default(&s);
    s.hold_height = true;
    s.velocity_sigma = 10.0; /* of no weight */
    s.rotation_sigma = 1e-12;
    set3(s.gyro.quantization, 1e-6);
    imk_navigation_filter *filter = start_at_rest(&m, &s, 0.0);
    rest_for(filter, 1, 1e-6);
    assert_true(imk_navigation_filter_stand(filter));
    CHECK_RELATIVE(imk_navigation_filter_counted(filter).chi_square, 0.5, 1e-4);

    set3(s.gyro.quantization, 0.0);
    set3(s.gyro.white, 1e-4);
    filter = start_at_rest(&m, &s, 0.0);
    rest_for(filter, 60, 0.0);
    imk_navigation_filter_get(filter, &end);
    CHECK_RELATIVE(end.covariance[8][8], 60e-8, 1e-4);
    assert_true(imk_navigation_filter_stand(filter));
    imk_navigation_filter_get(filter, &end);
    CHECK_BELOW(end.covariance[8][8], 1e-4 * 60e-8); /* the Earth turns by 4 mrad */

    set3(s.gyro.white, 0.0);
    s.initial_sigma[8] = 0.01;
    s.rotation_sigma = 0.01 * imk_earth_rate(rest_place.latitude).v[0];
    filter = start_at_rest(&m, &s, 0.0);
    rest_for(filter, 1, 0.0);
    assert_true(imk_navigation_filter_stand(filter));
    imk_navigation_filter_get(filter, &end);
    CHECK_RELATIVE(end.covariance[8][8], 0.5e-4, 1e-3);

    /* A bias that was found is forgotten as its process is. */
    imk_navigation_filter_default(&s);
    s.velocity_sigma = 10.0;
    s.rotation_sigma = 1e-12;
    s.gyro.part_count = 1;
    s.gyro.part[0].correlation_time = 10.0;
    set3(s.gyro.part[0].sigma, 1e-5);
    filter = start_at_rest(&m, &s, 0.0);
    rest_for(filter, 1, 1e-5);
    assert_true(imk_navigation_filter_stand(filter));
    imk_navigation_filter_get(filter, &end);
    const double found = end.gyro_bias.v[2];
    CHECK_BELOW(5e-6, found);
    rest_for(filter, 20, 0.0);
    imk_navigation_filter_get(filter, &end);
    CHECK_RELATIVE(end.gyro_bias.v[2], found * exp(-2.0), 1e-9);
}

/* Quantization of the integrated force is part of a velocity's noise; a height that is held is
 * measured by nothing. */
static void test_velocity_noise(void **state)
{
    (void)state;
    static memory m;
    const double no = (double)INFINITY;
    imk_navigation_filter_settings s;
    imk_navigation_filter_default(&s);
    s.hold_height = true;
    s.velocity_sigma = 1e-3;
    s.aid_count = 1;
    s.aid[0] = imk_aid_default(IMK_AID_POSITION);
    set3(s.accel.quantization, 0.05);
    imk_navigation_filter *filter = start_at_rest(&m, &s, 0.05);
    assert_true(imk_navigation_filter_stand(filter));
    CHECK_RELATIVE(imk_navigation_filter_counted(filter).chi_square, 25e-4 / (25e-4 + 1e-6), 1e-9);
    const imk_aid_reading above = {.time = 0.05,
                                   .value = {rest_place.latitude, rest_place.longitude, 1000.0},
                                   .sigma = {no, no, 1.0}};
    assert_int_equal(imk_navigation_filter_aid(filter, 0, &above), IMK_AID_NOT_USED);
    assert_int_equal(imk_navigation_filter_aided(filter, 0).refused, 0);
}

/* What a level unit at rest reads; of its attitude's uncertainty only the tilt turns gravity. */
static void test_rest(void **state)
{
    (void)state;
    static memory m;
    const imk_geodetic place = {0.6, -1.0, 200.0};
    const imk_matrix3 c = imk_matrix3_from_euler(0.1, -0.2, 1.0);
    const imk_navigation_state start = imk_navigation_state_ned(0.0, place, (imk_vector3){{0}}, c);
    imk_navigation_filter_settings s;
    imk_navigation_filter_default(&s);
    const double sigma[3] = {1e-3, 2e-3, 0.1}, g = imk_normal_gravity(0.6, 200.0);
    memcpy(s.initial_sigma + 6, sigma, sizeof sigma);
    s.gyro.part_count = s.accel.part_count = 1;
    set3(s.gyro.part[0].sigma, 1e-5);
    set3(s.accel.part[0].sigma, 1e-2);
    const imk_rest_readings rest = imk_navigation_filter_rest(start_filter(&m, &s, &start));
    const imk_vector3 rate = imk_matrix3_apply(imk_matrix3_transpose(c), imk_earth_rate(0.6));
    const imk_vector3 force =
        imk_matrix3_apply(imk_matrix3_transpose(c), (imk_vector3){{0.0, 0.0, -g}});
    for (int i = 0; i < 3; i++) {
        CHECK_CLOSE(rest.rate.v[i], rate.v[i], 1e-15);
        CHECK_CLOSE(rest.force.v[i], force.v[i], 1e-5); /* gravity is not quite along the normal */
    }
    CHECK_RELATIVE(rest.rate_sigma, sqrt(3.0) * 1e-5, 1e-9);
    CHECK_RELATIVE(rest.force_sigma, sqrt(g * g * 5e-6 + 3e-4), 1e-4);
}

/* An error of velocity grows as the difference between two mechanisations does, sidewards by
 * Coriolis' acceleration: by W sin(L) t^2 v. */
static void test_coriolis(void **state)
{
    (void)state;
    static memory m[2];
    const imk_geodetic place = {1.0, 0.2, 0.0};
    imk_navigation_filter_settings s;
    imk_navigation_filter_default(&s);
    s.hold_height = true;
    s.initial_sigma[3] = 1.0;
    imk_navigation_filter *filter[2];
    const imk_vector3 rate = imk_earth_rate(place.latitude);
    const imk_vector3 up = {{0.0, 0.0, -imk_normal_gravity(place.latitude, 0.0)}};
    imk_navigation_filter_estimate end[2];
    for (int k = 0; k < 2; k++) {
        const imk_navigation_state start = imk_navigation_state_ned(
            0.0, place, (imk_vector3){{(double)k, 0.0, 0.0}}, imk_matrix3_identity());
        filter[k] = start_filter(&m[k], &s, &start);
        for (int step = 0; step < 1200; step++)
            imk_navigation_filter_step(filter[k], 0.5, imk_vector3_scale(rate, 0.5),
                                       imk_vector3_scale(up, 0.5));
        imk_navigation_filter_get(filter[k], &end[k]);
    }
    const imk_vector3 off = imk_navigation_difference_ned(&end[1].state, &end[0].state);
    /* 600 s are 0.13 of Schuler's period; second order of 1 m/s is nothing. */
    CHECK_RELATIVE(sqrt(end[0].covariance[0][0]), fabs(off.v[0]), 1e-3);
    CHECK_RELATIVE(sqrt(end[0].covariance[1][1]), fabs(off.v[1]), 1e-2);
    CHECK_BELOW(15.0, fabs(off.v[1]));
}

/* Velocity from a Gauss-Markov force: variance 2 sigma^2 T (t - T (1 - e^(-t/T))), whatever the
 * step; 20 s, in which gravity does nothing. Discrete steps make h^2/(12 T^2) too much. */
static void test_short_correlation(void **state)
{
    (void)state;
    static memory m;
    static const double times[] = {1.0, 3.0, 30.0}; /* T [s] */
    for (int k = 0; k < 3; k++) {
        imk_navigation_filter_settings s;
        imk_navigation_filter_default(&s);
        s.step = 1.0;
        s.accel.part_count = 1;
        s.accel.part[0].correlation_time = times[k];
        set3(s.accel.part[0].sigma, 1e-3);
        const imk_navigation_state start = imk_navigation_state_ned(
            0.0, (imk_geodetic){0.5, 0.0, 0.0}, (imk_vector3){{0}}, imk_matrix3_identity());
        imk_navigation_filter *filter = start_filter(&m, &s, &start);
        imk_navigation_filter_estimate end;
        for (int step = 0; step < 20; step++)
            imk_navigation_filter_step(filter, 1.0, (imk_vector3){{0}},
                                       (imk_vector3){{0, 0, -9.79}});
        imk_navigation_filter_get(filter, &end);
        const double t = 20.0, tau = times[k];
        const double variance = 2e-6 * tau * (t - tau * (1.0 - exp(-t / tau)));
        CHECK_RELATIVE(end.covariance[3][3], variance, 1.5 / (12.0 * tau * tau) + 0.02);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_flicker_parts),
        cmocka_unit_test(test_standstill_limits),
        cmocka_unit_test(test_rotation),
        cmocka_unit_test(test_velocity_noise),
        cmocka_unit_test(test_rest),
        cmocka_unit_test(test_coriolis),
        cmocka_unit_test(test_short_correlation),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
