/* SPDX-License-Identifier: Apache-2.0 */
/* Repeatability over power cycles: closed forms for equal sigmas, coverage, and the ways in and
 * out.
 */
#include "check.h"

#include "imukit/imukit.h"
#include "imukit/repeatability.h"

#include <stdlib.h>
#include <string.h>

/* Equal sigmas s: the estimate is the variance of the values less s^2, and the interval follows
 * from chi-square, s^2 + t = (K - 1) variance/quantile. Values 1 … 5 have the variance 2.5. */
static void test_equal_sigmas(void **state)
{
    (void)state;
    const double value[5] = {1.0, 2.0, 3.0, 4.0, 5.0};
    const double sigma[5] = {0.5, 0.5, 0.5, 0.5, 0.5};
    imk_repeatability r;
    CHECK_OK(imk_repeatability_estimate(5, value, sigma, NULL, 0.95, &r, NULL));
    CHECK_RELATIVE(r.value, sqrt(2.5 - 0.25), 1e-12);
    CHECK_RELATIVE(r.lower, sqrt(10.0 / imk_chi_square_quantile(0.975, 4) - 0.25), 1e-11);
    CHECK_RELATIVE(r.upper, sqrt(10.0 / imk_chi_square_quantile(0.025, 4) - 0.25), 1e-11);
    CHECK_RELATIVE(r.mean, 3.0, 1e-14);
    CHECK_RELATIVE(r.mean_sigma, sqrt(2.5 / 5.0), 1e-12);
    CHECK_RELATIVE(r.within, 0.5, 1e-14);
    /* var(t) = 2 (s^2 + t)^2/(K - 1); over 2 sqrt(t). */
    CHECK_RELATIVE(r.sigma, sqrt(2.0 * 2.5 * 2.5 / 4.0) / (2.0 * sqrt(2.25)), 1e-11);
    CHECK_CLOSE(r.probability, 1.0 - imk_chi_square_probability(10.0 / 0.25, 4), 1e-12);
}

/* Sigmas of 0: the plain standard deviation. */
static void test_exact_values(void **state)
{
    (void)state;
    const double value[4] = {2.0, -1.0, 0.5, 3.5}, sigma[4] = {0.0};
    imk_repeatability r;
    CHECK_OK(imk_repeatability_estimate(4, value, sigma, NULL, 0.95, &r, NULL));
    CHECK_RELATIVE(r.value, sqrt((0.75 * 0.75 + 2.25 * 2.25 + 0.75 * 0.75 + 2.25 * 2.25) / 3.0),
                   1e-12);
    CHECK_BELOW(r.probability, 1e-12);
    const double same[3] = {1.5, 1.5, 1.5};
    CHECK_OK(imk_repeatability_estimate(3, same, sigma, NULL, 0.95, &r, NULL));
    CHECK_CLOSE(r.value, 0.0, 0.0);
    CHECK_CLOSE(r.upper, 0.0, 0.0);
    CHECK_CLOSE(r.mean, 1.5, 0.0);
}

/* Two runs of different sigmas: Q = d^2/(s1^2 + s2^2 + 2 t), whatever the weights. */
static void test_two_unequal_runs(void **state)
{
    (void)state;
    const double value[2] = {0.0, 3.0}, sigma[2] = {0.3, 1.1};
    imk_repeatability r;
    CHECK_OK(imk_repeatability_estimate(2, value, sigma, NULL, 0.9, &r, NULL));
    const double own = 0.09 + 1.21;
    CHECK_RELATIVE(r.value, sqrt((9.0 - own) / 2.0), 1e-12);
    CHECK_RELATIVE(r.lower, sqrt((9.0 / imk_chi_square_quantile(0.95, 1) - own) / 2.0), 1e-11);
    CHECK_RELATIVE(r.upper, sqrt((9.0 / imk_chi_square_quantile(0.05, 1) - own) / 2.0), 1e-11);
}

/* Runs that agree within their sigmas: no difference, but a bound on it that is above 0 however
 * well they agree by chance; and a difference of units changes nothing but units. */
static void test_no_difference(void **state)
{
    (void)state;
    const double value[5] = {1.0, 1.1, 0.9, 1.05, 0.95};
    double sigma[5] = {1.0, 1.0, 1.0, 1.0, 1.0}, small[5], tiny[5];
    imk_repeatability r, s;
    CHECK_OK(imk_repeatability_estimate(5, value, sigma, NULL, 0.95, &r, NULL));
    CHECK_CLOSE(r.value, 0.0, 0.0);
    CHECK_CLOSE(r.lower, 0.0, 0.0);
    assert_true(r.upper > 0.5 && r.upper < 3.0);
    assert_true(r.probability > 0.99);
    assert_true(r.sigma > 0.0);
    for (int k = 0; k < 5; k++) {
        small[k] = 1e-9 * value[k];
        tiny[k] = 1e-9 * sigma[k];
    }
    CHECK_OK(imk_repeatability_estimate(5, small, tiny, NULL, 0.95, &s, NULL));
    CHECK_RELATIVE(s.upper, 1e-9 * r.upper, 1e-10);
}

/* 95 % intervals over 2000 sets of 5 runs, sigmas from 0.5 to 1.5 known exactly or with 6 degrees
 * of freedom, repeatability 2. Binomial limits for a false alarm of 1e-7: 95 % -+ 5.3 sigma of 0.49
 * %; with estimated sigmas the F distribution is an approximation, good to 1 %. */
static void test_coverage(void **state)
{
    (void)state;
    enum { SETS = 2000, RUNS = 5, FREEDOM = 6 };
    const imk_random source = imk_random_seeded(1);
    for (int estimated = 0; estimated < 2; estimated++) {
        int held = 0;
        double sum = 0.0;
        for (int n = 0; n < SETS; n++) {
            double normal[64], value[RUNS], sigma[RUNS], freedom[RUNS];
            imk_repeatability r;
            imk_random_normals(source, 7, (uint64_t)n * 64, 64, normal);
            for (int k = 0; k < RUNS; k++) {
                const double own = 0.5 + 0.25 * k;
                double square = 0.0;
                value[k] = 2.0 * normal[k] + own * normal[RUNS + k];
                for (int f = 0; f < FREEDOM; f++)
                    square +=
                        normal[2 * RUNS + FREEDOM * k + f] * normal[2 * RUNS + FREEDOM * k + f];
                sigma[k] = estimated ? own * sqrt(square / FREEDOM) : own;
                freedom[k] = FREEDOM;
            }
            CHECK_OK(imk_repeatability_estimate(RUNS, value, sigma, estimated ? freedom : NULL,
                                                0.95, &r, NULL));
            held += r.lower <= 2.0 && 2.0 <= r.upper;
            sum += r.value * r.value;
        }
        const double share = (double)held / SETS;
        assert_true(share > 0.95 - 0.026 - 0.01 * estimated);
        assert_true(share < 0.95 + 0.026 + 0.01 * estimated);
        /* The variance is hardly biased: sd of a set's about 3.6, of the mean 0.08; cutting at 0
         * adds some 0.05. */
        CHECK_CLOSE(sum / SETS, 4.0, 0.5);
    }
}

static void test_refusals(void **state)
{
    (void)state;
    double value[2] = {1.0, 2.0}, sigma[2] = {0.1, 0.1}, freedom[2] = {5.0, 0.0};
    imk_repeatability r;
    imk_error error;
    CHECK_STATUS(imk_repeatability_estimate(1, value, sigma, NULL, 0.95, &r, &error),
                 IMK_ERROR_TOO_SHORT);
    CHECK_CLOSE(error.limit, 2.0, 0.0);
    CHECK_STATUS(imk_repeatability_estimate(2, value, sigma, freedom, 0.95, &r, &error),
                 IMK_ERROR_RANGE);
    assert_string_equal(error.field, "freedom");
    assert_int_equal(error.index, 1);
    CHECK_STATUS(imk_repeatability_estimate(2, value, sigma, NULL, 1.0, &r, &error),
                 IMK_ERROR_RANGE);
    sigma[1] = -0.1;
    CHECK_STATUS(imk_repeatability_estimate(2, value, sigma, NULL, 0.95, &r, &error),
                 IMK_ERROR_RANGE);
    assert_string_equal(error.field, "sigma");
    value[0] = (double)NAN;
    CHECK_STATUS(imk_repeatability_estimate(2, value, sigma, NULL, 0.95, &r, &error),
                 IMK_ERROR_NOT_FINITE);
    assert_int_equal(error.index, 0);
}

/* ---- runs -------------------------------------------------------------------------------------
 */

enum { RUNS = 8, HOLD = 500, PAUSE = 50, SAMPLES = RUNS * (HOLD + PAUSE) };

/* Power cycles of one unit as sections of a log, in counts: bias from run to run 0.05 m/s^2 and
 * 1e-3 rad/s on top of the noise of each. */
static void test_holds(void **state)
{
    (void)state;
    static double reading[6][SAMPLES], normal[6 * SAMPLES], offset[64];
    static int section[SAMPLES];
    static const char *const names[] = {"run"};
    const imk_random source = imk_random_seeded(1);
    imk_random_normals(source, 0, 0, 6 * (size_t)SAMPLES, normal);
    imk_random_normals(source, 1, 0, 64, offset);
    double truth[6] = {0.0};
    for (int c = 0; c < 6; c++) {
        const double between = c < 3 ? 1e-3 : 0.05, white = c < 3 ? 5e-3 : 0.05;
        const double per_unit = c < 3 ? -7500.0 : 1670.0;
        double mean = 0.0;
        for (int k = 0; k < RUNS; k++)
            mean += offset[8 * c + k] / RUNS;
        for (int k = 0; k < RUNS; k++)
            truth[c] += between * between * (offset[8 * c + k] - mean) *
                        (offset[8 * c + k] - mean) / (RUNS - 1);
        for (int k = 0; k < SAMPLES; k++) {
            const int run = k / (HOLD + PAUSE);
            const double x =
                (c == 5 ? 9.81 : 0.1) + between * offset[8 * c + run] + white * normal[6 * k + c];
            reading[c][k] = rint(x * per_unit + (c < 3 ? 12.0 : 0.0));
            section[k] = k % (HOLD + PAUSE) < HOLD ? 0 : -1;
        }
    }
    imk_test_record record = {.name = "cycles",
                              .count = SAMPLES,
                              .dt = 0.01,
                              .axis_count = {3, 3},
                              .counts = {true, true},
                              .section = section,
                              .section_count = 1,
                              .section_name = names};
    imk_model model;
    imk_model_default(&model);
    for (int i = 0; i < 3; i++) {
        record.reading[IMK_GYRO][i] = reading[i];
        record.reading[IMK_ACCEL][i] = reading[3 + i];
    }
    imk_static_interval run[RUNS];
    imk_repeatability_result result;
    imk_error error;
    size_t count = 0;
    CHECK_STATUS(imk_repeatability_runs(&record, 3.0, 0.0, 1.0, RUNS, run, &count, &error),
                 IMK_ERROR_TOO_SHORT);
    CHECK_OK(imk_repeatability_runs(&record, 0.2, 0.1, 1.0, RUNS, run, &count, &error));
    assert_int_equal(count, RUNS);
    assert_int_equal(run[1].begin, HOLD + PAUSE + 30);
    assert_int_equal(run[1].end, HOLD + PAUSE + HOLD - 20);
    CHECK_STATUS(
        imk_repeatability_of_holds(&model, record.counts, count, run, 0.0, 0.95, &result, &error),
        IMK_ERROR_UNIT_MISSING);
    for (int i = 0; i < 3; i++) {
        model.gyro.sensitivity.value[i] = -7500.0;
        model.gyro.zero_offset.value[i] = 12.0;
        model.accel.sensitivity.value[i] = 1670.0;
    }
    CHECK_OK(
        imk_repeatability_of_holds(&model, record.counts, count, run, 0.0, 0.95, &result, &error));
    for (int c = 0; c < 6; c++) {
        const imk_repeatability *r = &result.bias[c / 3][c % 3];
        assert_int_equal(r->runs, RUNS);
        /* What was drawn, but for the noise of a mean, 2.3e-4 rad/s and 2.3e-3 m/s^2: 5 of its
         * sigmas on the standard deviation of 8. */
        CHECK_CLOSE(r->value, sqrt(truth[c]), 5.0 * (c < 3 ? 2.3e-4 : 2.3e-3) / sqrt(7.0));
        assert_true(r->lower > 0.0 && r->lower < r->value && r->value < r->upper);
        CHECK_BELOW(r->probability, 1e-3);
    }
    /* 0.05 m/s^2 across 9.81: 5 mrad, of two axes and the most distant of 8 runs. */
    assert_true(result.attitude > 0.004 && result.attitude < 0.05);

    imk_repeatability_to_model(&result, &model);
    CHECK_OK(imk_model_validate(&model, &error));
    assert_int_equal(model.accel_evidence.interval_count, 1);
    assert_string_equal(model.accel_evidence.interval[0].key, "bias.repeatability");
    CHECK_CLOSE(model.gyro.bias.repeatability.value[1], result.bias[0][1].value, 0.0);
    CHECK_CLOSE(model.accel_evidence.interval[0].upper.value[2], result.bias[1][2].upper, 0.0);

    /* Put back to 1 degree only: what x and y differ by may be all attitude, what z does is not. */
    CHECK_OK(imk_repeatability_of_holds(&model, record.counts, count, run, 0.0175, 0.95, &result,
                                        &error));
    CHECK_CLOSE(result.bias[1][0].value, 0.0, 0.0);
    CHECK_CLOSE(result.bias[1][1].value, 0.0, 0.0);
    CHECK_CLOSE(result.bias[1][2].value, sqrt(truth[5]), 5.0 * 2.3e-3 / sqrt(7.0));
}

/* Whole calibrations: bias and scale factor, where all of them state it. */
static void test_calibrations(void **state)
{
    (void)state;
    enum { N = 6 };
    imk_calibration_result *run = calloc(N, sizeof *run);
    const imk_calibration_result *list[N];
    imk_repeatability_result result;
    static const double value[N] = {1.0, 1.2, 0.7, 1.1, 0.6, 1.4};
    for (int k = 0; k < N; k++) {
        run[k].parameter_count = k == 2 ? 2 : 3;
        for (int p = 0; p < 3; p++) {
            static const imk_model_parameter parameters[3] = {
                {IMK_ACCEL, IMK_MODEL_SCALE_FACTOR, 1, 0},
                {IMK_GYRO, IMK_MODEL_BIAS, 2, 0},
                {IMK_GYRO, IMK_MODEL_BIAS, 0, 0}};
            run[k].parameter[p] = parameters[p];
            run[k].value[p] = value[k];
            run[k].sigma[p] = 0.1;
            run[k].freedom[p] = 20.0;
        }
        list[k] = &run[k];
    }
    CHECK_OK(imk_repeatability_of_calibrations(N, list, 0.95, &result, NULL));
    imk_repeatability alone;
    const double sigma[N] = {0.1, 0.1, 0.1, 0.1, 0.1, 0.1}, freedom[N] = {20, 20, 20, 20, 20, 20};
    CHECK_OK(imk_repeatability_estimate(N, value, sigma, freedom, 0.95, &alone, NULL));
    CHECK_CLOSE(result.scale_factor[IMK_ACCEL][1].value, alone.value, 0.0);
    CHECK_CLOSE(result.bias[IMK_GYRO][2].upper, alone.upper, 0.0);
    assert_int_equal(result.bias[IMK_GYRO][0].runs, 0);
    assert_int_equal(result.scale_factor[IMK_ACCEL][0].runs, 0);
    imk_model model;
    imk_model_default(&model);
    imk_repeatability_to_model(&result, &model);
    CHECK_OK(imk_model_validate(&model, NULL));
    CHECK_CLOSE(model.accel.scale_factor.repeatability.value[1], alone.value, 0.0);
    CHECK_CLOSE(model.accel.scale_factor.repeatability.value[0], 0.0, 0.0);
    free(run);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_equal_sigmas),
                                       cmocka_unit_test(test_exact_values),
                                       cmocka_unit_test(test_two_unequal_runs),
                                       cmocka_unit_test(test_no_difference),
                                       cmocka_unit_test(test_coverage),
                                       cmocka_unit_test(test_refusals),
                                       cmocka_unit_test(test_holds),
                                       cmocka_unit_test(test_calibrations)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
