/* SPDX-License-Identifier: Apache-2.0 */
/* Powers of the input up to the seventh, of which a model states the first few: the kernels against
 * the formula, and the slope's range and first zero against a search. */
#include "check.h"

#include "imukit/distort.h"
#include "io/random_model.h"
#include "model/correct_internal.h"

#include <math.h>

enum { SAMPLES = 100, AXES = 500, STEPS = 4000 };

/* A perfect unit of which axis 0 has powers: of the slope they are at most 0.3 over |u| <= 2. */
static imk_distortion draw_distortion(uint64_t *state)
{
    imk_model model;
    imk_distortion made;
    imk_model_default(&model);
    CHECK_OK(imk_distortion_start(&made, &model, NULL, IMK_KERNEL_SCALAR, NULL));
    imk_axis_response *axis = &made.axis[IMK_GYRO][0];
    axis->powers = 1 + (int)random_below(state, IMK_POWERS);
    axis->has_nonlinearity = true;
    for (int q = 0; q < 2; q++)
        for (int k = 0; k < axis->powers; k++) {
            const int n = q ? k + 1 : k + 2;
            axis->power[q][k] = 0.3 * (2.0 * random_unit(state) - 1.0) / (n * pow(2.0, n - 1));
        }
    return made;
}

/* n(u) */
static double nonlinearity_at(const imk_axis_response *axis, double u)
{
    double sum = 0.0;
    for (int k = 0; k < axis->powers; k++)
        sum += axis->power[0][k] * pow(u, k + 2) + axis->power[1][k] * fabs(u) * pow(u, k);
    return sum;
}

/* n'(u); at 0 that of the side. */
static double slope_at(const imk_axis_response *axis, double side, double size)
{
    const double u = side * size;
    double sum = 0.0, power = 1.0; /* u^k */
    for (int k = 0; k < axis->powers; k++, power *= u)
        sum += ((k + 2) * axis->power[0][k] * u + (k + 1) * axis->power[1][k] * side) * power;
    return sum;
}

/* To 8 roundings of sums of a few units; the same bits for every kernel. */
static void kernels_compute_the_formula(void **state)
{
    (void)state;
    uint64_t random = 1;
    double u[SAMPLES], scalar[SAMPLES], best[SAMPLES];
    for (int trial = 0; trial < 50; trial++) {
        imk_distortion distortion = draw_distortion(&random);
        const imk_stimulus stimulus = {.angular_rate = {u}};
        for (int i = 0; i < SAMPLES; i++)
            u[i] = 4.0 * random_unit(&random) - 2.0;
        imk_distort(&distortion, IMK_GYRO, 0, &stimulus, SAMPLES, scalar);
        distortion.kernel = imk_random_seeded(0).kernel;
        imk_distort(&distortion, IMK_GYRO, 0, &stimulus, SAMPLES, best);
        for (int i = 0; i < SAMPLES; i++) {
            const double n = nonlinearity_at(&distortion.axis[IMK_GYRO][0], u[i]);
            CHECK_CLOSE(scalar[i], u[i] + n, 4e-15);
            CHECK_CLOSE(best[i], scalar[i], 0);
        }
    }
}

/* The search misses an extreme by half a step: with second derivatives of the slope up to 20, by
 * 10 (1/4000)^2. */
static void the_range_of_the_slope_is_found(void **state)
{
    (void)state;
    uint64_t random = 2;
    const int axes = (int)check_runs(AXES);
    for (int trial = 0; trial < axes; trial++) {
        const imk_distortion distortion = draw_distortion(&random);
        const imk_axis_response *axis = &distortion.axis[IMK_GYRO][0];
        double lower = HUGE_VAL, upper = -HUGE_VAL;
        for (int i = 0; i <= STEPS; i++)
            for (int side = -1; side <= 1; side += 2) {
                lower = fmin(lower, slope_at(axis, side, 2.0 * i / STEPS));
                upper = fmax(upper, slope_at(axis, side, 2.0 * i / STEPS));
            }
        const imki_interval slope = imki_slope(axis, 2.0);
        CHECK_CLOSE(slope.center - slope.radius, lower, 1e-6);
        CHECK_CLOSE(slope.center + slope.radius, upper, 1e-6);
        assert_true(slope.center - slope.radius <= lower + 1e-14);
        assert_true(slope.center + slope.radius >= upper - 1e-14);
    }
}

/* With a slope of 0.2 beside the powers some readings turn back within 2, and others do not. */
static void the_nearest_turning_point_is_found(void **state)
{
    (void)state;
    uint64_t random = 3;
    const int axes = (int)check_runs(AXES);
    int turning = 0;
    for (int trial = 0; trial < axes; trial++) {
        const imk_distortion distortion = draw_distortion(&random);
        const imk_axis_response *axis = &distortion.axis[IMK_GYRO][0];
        const double found = imki_turning_point(axis, -0.8, 2.0);
        const double end = isnan(found) ? 2.0 : fabs(found);
        turning += !isnan(found);
        if (found == 0.0) { /* the asymmetry alone does it */
            assert_true(fabs(axis->power[1][0]) >= 0.2);
            continue;
        }
        for (int i = 0; i <= STEPS; i++)
            for (int side = -1; side <= 1; side += 2)
                assert_true(0.2 + slope_at(axis, side, end * i / STEPS) > -1e-13);
        if (!isnan(found))
            CHECK_CLOSE(0.2 + slope_at(axis, copysign(1.0, found), end), 0.0, 1e-13);
    }
    assert_in_range(turning, axes / 10, axes * 9 / 10);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(kernels_compute_the_formula),
        cmocka_unit_test(the_range_of_the_slope_is_found),
        cmocka_unit_test(the_nearest_turning_point_is_found),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
