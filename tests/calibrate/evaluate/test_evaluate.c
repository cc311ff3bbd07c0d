/* SPDX-License-Identifier: Apache-2.0 */
/* Laboratory figures: closed forms, a quantizer, runs, and coverage of the intervals. */
#include "calibrate/evaluation_session.h"
#include "check.h"

#include "imukit/distributions.h"
#include "imukit/evaluate.h"

enum { LEVELS_MAX = 300 };
static imk_evaluation_level level[LEVELS_MAX];
static imk_evaluation result;

static imk_status evaluate(const imk_evaluation_table *table,
                           const imk_evaluation_settings *settings, imk_error *error)
{
    const size_t size = imk_evaluation_workspace_size(table);
    char *workspace = malloc(size);
    assert_non_null(workspace);
    const imk_status status =
        imk_evaluate(table, settings, level, LEVELS_MAX, &result, workspace, size, error);
    free(workspace);
    return status;
}

static void evaluate_well(const imk_evaluation_table *table)
{
    const imk_evaluation_settings settings = imk_evaluation_default();
    CHECK_OK(evaluate(table, &settings, NULL));
}

/* ---- minimax line ---------------------------------------------------------------------------- */

/* The deviation has alternating signs and the full amount at the three places: no line is better
 * [CHENEY1966]; and nowhere is it larger. */
static void check_alternation(size_t n, const double *x, const double *y,
                              const imk_evaluation_line *line, const int alternation[3])
{
    double off[3];
    for (int k = 0; k < 3; k++) {
        const int i = alternation[k];
        assert_true(i >= 0 && (k == 0 || i > alternation[k - 1]));
        off[k] = y[i] - line->zero - line->sensitivity * x[i];
        CHECK_CLOSE(fabs(off[k]), line->deviation, 1e-14);
    }
    assert_true(off[0] * off[1] < 0 && off[1] * off[2] < 0);
    for (size_t i = 0; i < n; i++)
        CHECK_BELOW(fabs(y[i] - line->zero - line->sensitivity * x[i]), line->deviation + 1e-14);
}

/* Chebyshev: the best line of x^3 on [-1, 1] is 3/4 x, off by 1/4 at -1, -1/2, 1/2, 1; that of x^2
 * on [0, 1] is x - 1/8, off by 1/8 at 0, 1/2, 1. The grid holds these points: exact to rounding. */
static void test_minimax_of_powers(void **state)
{
    (void)state;
    double x[201], y[201];
    int alternation[3], workspace[402];
    for (int i = 0; i < 201; i++) {
        x[i] = (i - 100) / 100.0;
        y[i] = x[i] * x[i] * x[i];
    }
    imk_evaluation_line line = imk_minimax_line(201, x, y, alternation, workspace);
    CHECK_CLOSE(line.sensitivity, 0.75, 1e-14);
    CHECK_CLOSE(line.zero, 0.0, 1e-14);
    CHECK_CLOSE(line.deviation, 0.25, 1e-14);
    check_alternation(201, x, y, &line, alternation);
    for (int i = 0; i < 201; i++) {
        x[i] = i / 200.0;
        y[i] = x[i] * x[i];
    }
    line = imk_minimax_line(201, x, y, alternation, workspace);
    CHECK_CLOSE(line.sensitivity, 1.0, 1e-14);
    CHECK_CLOSE(line.zero, -0.125, 1e-14);
    CHECK_CLOSE(line.deviation, 0.125, 1e-14);
    check_alternation(201, x, y, &line, alternation);
}

/* Any points: the alternation proves each. Lines and pairs have none. */
static void test_minimax_of_any_points(void **state)
{
    (void)state;
    const imk_random source = imk_random_seeded(1);
    double x[40], y[40], step[40];
    int alternation[3], workspace[80];
    for (uint64_t trial = 0; trial < 500; trial++) {
        const size_t n = 3 + trial % 38;
        imk_random_normals(source, 1, 64 * trial, n, y);
        imk_random_normals(source, 2, 64 * trial, n, step);
        for (size_t i = 0; i < n; i++)
            x[i] = (i > 0 ? x[i - 1] : 0.0) + 0.01 + fabs(step[i]);
        const imk_evaluation_line line = imk_minimax_line(n, x, y, alternation, workspace);
        check_alternation(n, x, y, &line, alternation);
    }
    const double at[4] = {1.0, 2.0, 4.0, 8.0}, on[4] = {3.0, 5.0, 9.0, 17.0};
    for (size_t n = 2; n <= 4; n++) {
        const imk_evaluation_line line = imk_minimax_line(n, at, on, alternation, workspace);
        CHECK_CLOSE(line.sensitivity, 2.0, 1e-15);
        CHECK_CLOSE(line.zero, 1.0, 1e-15);
        CHECK_CLOSE(line.deviation, 0.0, 0.0);
        assert_int_equal(alternation[0], -1);
    }
}

/* ---- figures without noise ------------------------------------------------------------------- */

/* Up and down twice, so that replicates are equal and intervals have no width: y = 0.5 + 2 x +
 * 0.02 |x|/2, and 0.003 more when rising, less when falling, but at the ends. */
static void test_figures_without_noise(void **state)
{
    (void)state;
    double x[100], y[100];
    size_t n = 0;
    for (int sweep = 0; sweep < 2; sweep++)
        for (int k = 0; k < 40; k++) {
            const int place = k < 20 ? k : 40 - k; /* 0 … 20 … 1 */
            const double loop = k % 20 == 0 ? 0.0 : k < 20 ? 0.003 : -0.003;
            x[n] = (place - 10) / 10.0;
            y[n] = 0.5 + 2.0 * x[n] + 0.01 * fabs(x[n]) + loop;
            n++;
        }
    evaluate_well(&(imk_evaluation_table){.count = n, .reference = x, .reading = y});
    assert_int_equal(result.levels, 21);
    assert_int_equal(result.source, IMK_SCATTER_REPLICATES);
    CHECK_CLOSE(result.precision.value, 0.0, 1e-15);
    CHECK_CLOSE(result.full_scale, 1.0, 0.0);
    CHECK_CLOSE(result.hysteresis.value, 0.006 / result.sensitivity.value, 1e-14);
    CHECK_CLOSE(level[10].up - level[10].down, 0.006, 1e-15);
    CHECK_CLOSE(level[5].reading, 0.5 - 1.0 + 0.005, 1e-15);
    /* The minimax line of |x| on [-1, 1] is 1/2, off by 1/2. */
    CHECK_CLOSE(result.best.deviation, 0.005, 1e-14);
    CHECK_CLOSE(result.best.sensitivity, 2.0, 1e-14);
    CHECK_CLOSE(result.best.zero, 0.505, 1e-14);
    CHECK_CLOSE(result.linearity_best.value, 0.005 / result.sensitivity.value, 1e-14);
    /* The error is largest at 1: 0.5 + 1 + 0.01. */
    CHECK_CLOSE(result.accuracy.value, 1.51, 1e-14);
    CHECK_CLOSE(result.coverage.value, 1.51, 1e-12);
    assert_int_equal(result.accuracy_level, 20);
}

/* y = 0.1 + 3 x + 0.05 |x|/2: K+ - K- = 0.05, their mean 3. */
static void test_asymmetry(void **state)
{
    (void)state;
    double x[14], y[14];
    for (int i = 0; i < 14; i++) {
        x[i] = (i % 7) - 2.0; /* -2 … 4: not symmetric about 0 */
        y[i] = 0.1 + 3.0 * x[i] + 0.025 * fabs(x[i]);
    }
    evaluate_well(&(imk_evaluation_table){.count = 14, .reference = x, .reading = y});
    CHECK_CLOSE(result.asymmetry.value, 0.05 / 3.0, 1e-14);
    CHECK_CLOSE(result.asymmetry.lower, 0.05 / 3.0, 1e-12);
}

/* A quantizer of step 0.5: steps of 0.4 sometimes give nothing, of 0.5 always a half. From zero,
 * 0.2 rounds to nothing and 0.3 to 0.5. Everything is done twice, and repeats exactly. */
static void test_quantizer(void **state)
{
    (void)state;
    double x[400], y[400];
    size_t n = 0;
    for (int pass = 0; pass < 2; pass++) {
        for (int step = 1; step <= 8; step++) /* steps of 0.1 … 0.8, from 0 and back */
            for (int k = -7; k <= 7; k++)
                x[n++] = 0.1 * step * (k <= 0 ? k + 7 : 7 - k);
        x[n++] = -20.0;
        x[n++] = 20.0;
    }
    for (size_t i = 0; i < n; i++)
        y[i] = 0.5 * floor(x[i] / 0.5 + 0.5);
    evaluate_well(&(imk_evaluation_table){.count = n, .reference = x, .reading = y});
    CHECK_CLOSE(result.resolution.value, 0.5, 1e-9);
    CHECK_CLOSE(result.resolution.lower, 0.4, 1e-9);
    CHECK_CLOSE(result.resolution.upper, 0.5, 1e-9);
    CHECK_CLOSE(result.smallest_step, 0.1, 1e-9);
    CHECK_CLOSE(result.threshold.value, 0.3, 1e-9);
    CHECK_CLOSE(result.threshold.lower, 0.2, 1e-9);
    CHECK_CLOSE(result.smallest_input, 0.1, 1e-9);
}

/* Where each step gives its change, the table does not tell the resolution, but a bound; where the
 * largest gives nothing, it is coarser than all. */
static void test_steps_too_large(void **state)
{
    (void)state;
    double x[24], y[24];
    for (int i = 0; i < 24; i++) {
        x[i] = 100.0 * (i % 4);
        y[i] = x[i] + 0.01 * (i / 4 % 2);
    }
    evaluate_well(&(imk_evaluation_table){.count = 24, .reference = x, .reading = y});
    assert_true(isnan(result.resolution.value) && isnan(result.threshold.value));
    CHECK_CLOSE(result.resolution.lower, 0.0, 0.0);
    CHECK_CLOSE(result.resolution.upper, 100.0, 1e-9);
    CHECK_CLOSE(result.threshold.upper, 100.0, 1e-9);
    CHECK_CLOSE(result.smallest_step, 100.0, 1e-9);
    /* The step back from 300 to 0 is the largest; it gives a third. */
    for (int i = 0; i < 24; i++)
        y[i] = x[i] < 300.0 ? x[i] : 100.0 * (i / 4 % 2);
    evaluate_well(&(imk_evaluation_table){.count = 24, .reference = x, .reading = y});
    assert_true(isinf(result.resolution.value));
}

/* ---- noise ----------------------------------------------------------------------------------- */

/* Two readings of each of three levels, all reached from below: differences 0.2, 0.4, 0.4 give
 * s^2 = sum d^2/2/3 = 0.06 with 3 degrees of freedom; the slope's variance is s^2/sum (x - mean)^2
 * = s^2/4. */
static void test_replicates(void **state)
{
    (void)state;
    const double x[6] = {1, 1, 2, 2, 3, 3}, y[6] = {1.0, 1.2, 2.1, 1.7, 3.1, 3.5};
    const signed char up[6] = {1, 1, 1, 1, 1, 1};
    evaluate_well(
        &(imk_evaluation_table){.count = 6, .reference = x, .reading = y, .direction = up});
    CHECK_CLOSE(result.freedom, 3.0, 0.0);
    CHECK_RELATIVE(result.precision.value, sqrt(0.06), 1e-12);
    CHECK_RELATIVE(result.precision.lower, sqrt(0.18 / imk_chi_square_quantile(0.975, 3)), 1e-12);
    CHECK_RELATIVE(result.precision.upper, sqrt(0.18 / imk_chi_square_quantile(0.025, 3)), 1e-12);
    CHECK_RELATIVE(result.sensitivity.value, (3.3 - 1.1) / 2.0, 1e-12);
    /* Student's 97.5 % quantile with 3 degrees of freedom (tables: 3.18245). */
    CHECK_CLOSE(result.sensitivity.upper - result.sensitivity.value, 3.182446 * sqrt(0.06 / 4.0),
                1e-6);
}

/* Without repetition the residuals of the line stand for the noise; extremes have no interval. */
static void test_no_replicates(void **state)
{
    (void)state;
    const double x[5] = {0, 1, 2, 3, 4}, y[5] = {0.0, 1.0, 3.0, 3.0, 4.0};
    double sigma[5] = {0.1, 0.1, 0.1, 0.1, 0.1};
    imk_evaluation_table table = {.count = 5, .reference = x, .reading = y};
    evaluate_well(&table);
    /* Slope 1, zero 0.2; residuals -0.2 -0.2 0.8 -0.2 -0.2: squares 0.8, 3 degrees of freedom. */
    assert_int_equal(result.source, IMK_SCATTER_RESIDUALS);
    CHECK_CLOSE(result.sensitivity.value, 1.0, 1e-14);
    CHECK_CLOSE(result.sensitivity.upper - 1.0, 3.182446 * sqrt(0.8 / 3.0 / 10.0), 1e-6);
    assert_true(isnan(result.precision.value) && isnan(result.linearity.upper));
    CHECK_CLOSE(result.linearity.value, 0.8 / 4.0, 1e-14);
    CHECK_CLOSE(result.linearity_best.value, 0.5 / 4.0, 1e-14);
    table.sigma = sigma;
    evaluate_well(&table);
    assert_int_equal(result.source, IMK_SCATTER_STATED);
    CHECK_CLOSE(result.sensitivity.upper - 1.0, 1.959964 * 0.1 / sqrt(10.0), 1e-7);
    assert_true(result.linearity.lower > 0.0 && result.linearity.upper < 0.3);
}

/* Four runs that differ by bias and scale factor, without noise: their standard deviations, and no
 * imprecision. The runs stop at different levels: the lines are still the runs' own. */
static void test_runs(void **state)
{
    (void)state;
    const double zero[4] = {0.1, -0.2, 0.3, 0.0}, scale[4] = {1e-3, -1e-3, 2e-3, 0.0};
    double x[100], y[100];
    int run[100];
    size_t n = 0;
    for (int r = 0; r < 4; r++)
        for (int k = -5; k <= 5 - r % 2; k++) {
            x[n] = k;
            y[n] = zero[r] + (1.0 + scale[r]) * k;
            run[n++] = r;
        }
    evaluate_well(&(imk_evaluation_table){.count = n, .reference = x, .reading = y, .run = run});
    assert_int_equal(result.runs, 4);
    assert_int_equal(result.source, IMK_SCATTER_REPLICATES);
    /* Readings 42; cells: -5 reached from nowhere, ten from below: 11; runs: 2 (4 - 1). */
    CHECK_CLOSE(result.freedom, 42.0 - 11.0 - 6.0, 0.0);
    CHECK_CLOSE(result.precision.value, 0.0, 1e-14);
    /* 0.1, -0.2, 0.3, 0 have the mean 0.05 and the variance 0.13/3. */
    CHECK_RELATIVE(result.run_zero.value, sqrt(0.13 / 3.0), 1e-9);
    CHECK_CLOSE(result.run_line[2][0], 0.3, 1e-13);
    CHECK_CLOSE(result.run_line[2][1], 1.002, 1e-13);
    CHECK_RELATIVE(result.run_sensitivity.value * result.sensitivity.value,
                   sqrt((0.25 + 2.25 + 2.25 + 0.25) * 1e-6 / 3.0), 1e-9);
}

/* A single level, as of a unit at rest: accuracy and precision, no line. */
static void test_one_level(void **state)
{
    (void)state;
    const double x[4] = {2, 2, 2, 2}, y[4] = {2.1, 2.3, 2.2, 2.2};
    evaluate_well(&(imk_evaluation_table){.count = 4, .reference = x, .reading = y});
    CHECK_CLOSE(result.accuracy.value, 0.2, 1e-14);
    CHECK_RELATIVE(result.precision.value, sqrt(0.02 / 3.0), 1e-12);
    /* Student's interval of a mean. */
    CHECK_CLOSE(result.accuracy.upper - 0.2, 3.182446 * sqrt(0.02 / 3.0 / 4.0), 1e-6);
    assert_true(isnan(result.sensitivity.value) && isnan(result.linearity.value));
}

/* ---- coverage -------------------------------------------------------------------------------- */

/* Three plans of 120 tables. Intervals of the line and of the precision are exact: of 360, more
 * than 44 or less than 2 miss with a probability below 1e-6 (binomial, 5 %). Those of extremes hold
 * at least about what they say (93.4 … 98.7 % of 3000, experiments/coverage_evaluate.c): more than
 * 54 misses have less than 1e-6 at 7 %. Of 36, it is 11 and 13. */
static void test_coverage(void **state)
{
    (void)state;
    static const size_t plans[3] = {0, 2, 4};
    const int tables = check_quick() ? 12 : 120;
    evaluation_score score[EVALUATION_FIGURES] = {{0}};
    for (size_t k = 0; k < 3; k++)
        evaluation_cover(&evaluation_plans[plans[k]], (uint32_t)plans[k], tables, 1, score);
    for (int k = 0; k < EVALUATION_FIGURES; k++) {
        const bool exact = k <= 2 || k == 8;
        const double misses = score[k].high + score[k].low;
        CHECK_CLOSE(score[k].stated, 3.0 * tables, 0.0);
        CHECK_BELOW(misses, check_quick() ? (exact ? 11.0 : 13.0) : exact ? 44.0 : 54.0);
        if (exact && !check_quick())
            CHECK_BELOW(-misses, -2.0);
    }
}

/* ---- what is refused ------------------------------------------------------------------------- */

static void test_errors(void **state)
{
    (void)state;
    double x[3] = {0, 1, 2}, y[3] = {0, 1, 2};
    int run[3] = {0, 0, 64};
    imk_evaluation_table table = {.count = 1, .reference = x, .reading = y};
    imk_evaluation_settings settings = imk_evaluation_default();
    imk_error error;
    CHECK_STATUS(evaluate(&table, &settings, &error), IMK_ERROR_TOO_SHORT);
    table.count = 3;
    settings.confidence = 1.0;
    CHECK_STATUS(evaluate(&table, &settings, &error), IMK_ERROR_RANGE);
    assert_string_equal(error.field, "confidence");
    settings.cookie = 0;
    CHECK_STATUS(evaluate(&table, &settings, &error), IMK_ERROR_UNINITIALISED);
    settings = imk_evaluation_default();
    table.run = run;
    CHECK_STATUS(evaluate(&table, &settings, &error), IMK_ERROR_RANGE);
    assert_int_equal(error.index, 2);
    table.run = NULL;
    y[1] = (double)NAN;
    CHECK_STATUS(evaluate(&table, &settings, &error), IMK_ERROR_NOT_FINITE);
    assert_int_equal(error.index, 1);
    y[1] = 1e160;
    CHECK_STATUS(evaluate(&table, &settings, &error), IMK_ERROR_NOT_FINITE);
    assert_string_equal(error.field, "reading");
    char small[64];
    y[1] = 1;
    CHECK_STATUS(
        imk_evaluate(&table, &settings, level, LEVELS_MAX, &result, small, sizeof small, &error),
        IMK_ERROR_WORKSPACE);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_minimax_of_powers),
        cmocka_unit_test(test_minimax_of_any_points),
        cmocka_unit_test(test_figures_without_noise),
        cmocka_unit_test(test_asymmetry),
        cmocka_unit_test(test_quantizer),
        cmocka_unit_test(test_steps_too_large),
        cmocka_unit_test(test_replicates),
        cmocka_unit_test(test_no_replicates),
        cmocka_unit_test(test_runs),
        cmocka_unit_test(test_one_level),
        cmocka_unit_test(test_coverage),
        cmocka_unit_test(test_errors),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
