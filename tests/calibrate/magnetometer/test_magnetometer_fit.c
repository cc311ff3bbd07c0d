/* SPDX-License-Identifier: Apache-2.0 */
/* The fit of a magnetometer: intervals hold, noise makes no bias, what is not determined is
 * refused, outliers and repeated rows do not mislead. Full figures:
 * experiments/coverage_magnetometer.c. */
#include "../coverage.h"
#include "../magnetometer_bench.h"
#include "check.h"

#include "imukit/distributions.h"

static mag_bench bench;

static const mag_bench_plan usual = {.rests = 24,
                                     .rows = 100,
                                     .noise = 0.3e-6,
                                     .up_sigma = 1e-4,
                                     .field = 48e-6,
                                     .dip = 1.1,
                                     .field_sigma = -1};
static const mag_bench_plan turned = {
    .rows = 2000, .noise = 2e-6, .field = 48e-6, .dip = 1.1, .field_sigma = 0, .no_up = true};

/* Each interval holds as often as it says: of all numbers of all benches at least as many as have a
 * chance of 1e-6 to be fewer, if they were independent; each number by itself as well. */
static void check_coverage(const mag_bench_plan *plan, uint64_t seed)
{
    const uint32_t benches = check_runs(60);
    size_t held[IMK_MAGNETOMETER_PARAMETERS] = {0};
    for (uint32_t n = 0; n < benches; n++) {
        CHECK_OK(mag_bench_run(&bench, plan, seed, n));
        const double t = imk_student_quantile(0.975, bench.result.freedom);
        for (int p = 0; p < IMK_MAGNETOMETER_PARAMETERS; p++)
            held[p] += !(fabs(bench.result.value[p] - bench.truth[p]) > t * bench.result.sigma[p]);
    }
    for (int p = 0; p < IMK_MAGNETOMETER_PARAMETERS; p++)
        CHECK_BELOW((double)coverage_least_held(benches, 0.94, 1e-7), (double)held[p]);
}

static void test_coverage(void **state)
{
    (void)state;
    mag_bench_plan plan = usual;
    check_coverage(&plan, 11);
    plan.field_sigma = 0.1e-6;
    plan.dip = 0;
    check_coverage(&plan, 12);
    plan.no_up = true;
    check_coverage(&plan, 13);
    /* A sensor that is ten times slower than the log. */
    plan = usual;
    plan.rows = 400;
    plan.held = 10;
    plan.step = 0.15e-6;
    check_coverage(&plan, 14);
    check_coverage(&turned, 15);
}

/* Mean of (estimate - truth)/sigma of the scale. By algebra, |m - h|^2 = F^2 of readings with noise
 * s makes the sphere too large by s^2/F^2, 0.7 % here, which is more than a sigma of a bench. The
 * mean of 60 benches without bias is within 5.3/sqrt(60) with a probability of 1 - 1e-7. */
static void test_noise_makes_no_bias(void **state)
{
    (void)state;
    const uint32_t benches = check_runs(60);
    mag_bench_plan plan = turned;
    double sum = 0, size = 0;
    plan.noise = 4e-6;
    for (uint32_t n = 0; n < benches; n++) {
        CHECK_OK(mag_bench_run(&bench, &plan, 21, n));
        for (int i = 0; i < 3; i++) {
            const int p = IMK_MAGNETOMETER_RESPONSE + 4 * i;
            sum += (bench.result.value[p] - bench.truth[p]) / bench.result.sigma[p] / 3;
            size += bench.result.sigma[p] / 3 / benches;
        }
    }
    CHECK_BELOW(fabs(sum / benches), 5.3 / sqrt(benches));
    CHECK_BELOW(size, 0.0069); /* that of algebra would be seen */
}

/* Repeating each row nine times tells nothing more. */
static void test_repeated_rows(void **state)
{
    (void)state;
    mag_bench_plan plan = usual;
    double sigma[2] = {0, 0};
    for (uint32_t n = 0; n < 8; n++)
        for (int held = 0; held < 2; held++) {
            plan.rows = held ? 400 : 40;
            plan.held = held ? 10 : 1;
            CHECK_OK(mag_bench_run(&bench, &plan, 31, n));
            sigma[held] += bench.result.sigma[0];
        }
    /* 8 benches of 35 degrees of freedom each: 4 % of each sum */
    CHECK_RELATIVE(sigma[1], sigma[0], 0.25);
    mag_bench_plan slow = turned;
    slow.held = 10;
    CHECK_OK(mag_bench_run(&bench, &slow, 32, 0));
    assert_int_equal(bench.problem.count, 200);
}

static void test_steel(void **state)
{
    (void)state;
    mag_bench_plan plan = usual;
    plan.rests = 30;
    plan.bad = 0.1;
    for (uint32_t n = 0; n < check_runs(20); n++) {
        CHECK_OK(mag_bench_run(&bench, &plan, 41, n));
        assert_int_equal(bench.result.refused, 3);
        for (int p = 0; p < 12; p++)
            CHECK_BELOW(fabs(bench.result.value[p] - bench.truth[p]), 6 * bench.result.sigma[p]);
    }
    /* Here iterations with derivatives at the adjusted readings went on for ever. */
    plan.rows = 400;
    CHECK_OK(mag_bench_run(&bench, &plan, 1, 351));
    plan.rows = usual.rows;
    /* A field that differs everywhere is added to all. */
    plan.bad = 0;
    plan.disturbance = 0.5e-6;
    CHECK_OK(mag_bench_run(&bench, &plan, 42, 0));
    /* 0.5 uT from 47 degrees of freedom, five sigmas */
    CHECK_RELATIVE(bench.result.added, 0.5e-6, 0.5);
    assert_true(bench.result.rms[0] > 0.005 * bench.result.value[IMK_MAGNETOMETER_FIELD]);
}

/* Attitudes within some degrees of level, or about one axis, and few of them. */
static void test_not_determined(void **state)
{
    (void)state;
    mag_bench_plan plan = usual;
    imk_error error;
    plan.rests = 6;
    CHECK_STATUS(mag_bench_run(&bench, &plan, 51, 0), IMK_ERROR_TOO_SHORT);
    plan.rests = 24;
    CHECK_OK(mag_bench_run(&bench, &plan, 51, 0));
    assert_true(bench.result.spread > 0.1);
    /* The readings of all attitudes in one plane, across z. */
    for (size_t k = 0; k < bench.problem.count; k++) {
        imk_magnetometer_observation *o = &bench.observation[k];
        const double angle = 0.3 * (double)k;
        o->reading[0] = 20e-6 * cos(angle);
        o->reading[1] = 20e-6 * sin(angle);
        o->reading[2] = 43e-6;
        memset(o->up, 0, sizeof o->up);
    }
    CHECK_STATUS(imk_magnetometer_solve(&bench.problem, &bench.result, bench.scratch, &error),
                 IMK_ERROR_SINGULAR);
    assert_string_equal(error.field, "attitude");
    CHECK_CLOSE(bench.result.spread, 0, 1e-9);
    CHECK_CLOSE(fabs(bench.result.normal[2]), 1, 1e-9);
    /* What is asked for first points away from the plane. */
    assert_true(fabs(bench.result.advice[0][2]) > 0.5);
}

/* A as an exchange of axes, and the determinant as the scale. */
static void test_exchanged_axes(void **state)
{
    (void)state;
    CHECK_OK(mag_bench_run(&bench, &usual, 61, 0));
    assert_int_equal(bench.result.nearest, 0);
    for (size_t k = 0; k < bench.problem.count; k++) {
        double *m = bench.observation[k].reading;
        const double x = m[0];
        m[0] = m[1];
        m[1] = x;
        m[2] = -m[2];
    }
    CHECK_OK(imk_magnetometer_solve(&bench.problem, &bench.result, bench.scratch, NULL));
    const imk_signed_axes axes = imk_signed_axes_of(bench.result.nearest);
    assert_int_equal(axes.column[0], 1);
    assert_int_equal(axes.column[1], 0);
    assert_int_equal(axes.sign[0], 1);
    assert_int_equal(axes.sign[2], -1);
    CHECK_CLOSE(bench.result.value[IMK_MAGNETOMETER_DIP], bench.truth[IMK_MAGNETOMETER_DIP],
                6 * bench.result.sigma[IMK_MAGNETOMETER_DIP]);
    const double *a = bench.result.value + IMK_MAGNETOMETER_RESPONSE;
    CHECK_CLOSE(a[0] * (a[4] * a[8] - a[5] * a[7]) - a[1] * (a[3] * a[8] - a[5] * a[6]) +
                    a[2] * (a[3] * a[7] - a[4] * a[6]),
                1, 1e-12);
}

/* Without a vertical, A has the form of the frame and A A^T is the same. */
static void test_frames(void **state)
{
    (void)state;
    double square[3][9];
    for (int frame = 0; frame < 3; frame++) {
        CHECK_OK(mag_bench_run(&bench, &turned, 71, 0));
        bench.problem.frame = (imk_triad_frame)frame;
        CHECK_OK(imk_magnetometer_solve(&bench.problem, &bench.result, bench.scratch, NULL));
        const double *a = bench.result.value + IMK_MAGNETOMETER_RESPONSE;
        assert_true(frame != IMK_FRAME_UPPER || (a[3] == 0 && a[6] == 0 && a[7] == 0));
        assert_true(frame != IMK_FRAME_LOWER || (a[1] == 0 && a[2] == 0 && a[5] == 0));
        assert_true(isnan(bench.result.value[IMK_MAGNETOMETER_DIP]));
        if (frame == IMK_FRAME_SYMMETRIC)
            CHECK_CLOSE(a[1], a[3], 1e-15);
        for (int i = 0; i < 9; i++) {
            square[frame][i] = 0;
            for (int j = 0; j < 3; j++)
                square[frame][i] += a[i / 3 * 3 + j] * a[i % 3 * 3 + j];
            /* the iterations end within 1e-5 of a sigma of some 1e-3 */
            CHECK_CLOSE(square[frame][i], square[0][i], 1e-7);
        }
    }
}

static void test_refusals(void **state)
{
    (void)state;
    imk_error error;
    CHECK_OK(mag_bench_run(&bench, &usual, 81, 0));
    bench.problem.field = 0;
    CHECK_STATUS(imk_magnetometer_solve(&bench.problem, &bench.result, bench.scratch, &error),
                 IMK_ERROR_RANGE);
    assert_string_equal(error.field, "field");
    bench.problem.field = 48e-6;
    bench.problem.field_sigma = NAN;
    CHECK_STATUS(imk_magnetometer_solve(&bench.problem, &bench.result, bench.scratch, &error),
                 IMK_ERROR_RANGE);
    bench.problem = imk_magnetometer_default();
    CHECK_STATUS(imk_magnetometer_solve(&bench.problem, &bench.result, bench.scratch, &error),
                 IMK_ERROR_TOO_SHORT);
    bench.problem.observation = bench.observation;
    bench.problem.count = 24;
    bench.observation[5].reading[1] = NAN;
    CHECK_STATUS(imk_magnetometer_solve(&bench.problem, &bench.result, bench.scratch, &error),
                 IMK_ERROR_RANGE);
    assert_int_equal(error.index, 5);
    bench.observation[5].reading[1] = 0;
    bench.observation[5].sigma[1] = 0;
    CHECK_STATUS(imk_magnetometer_solve(&bench.problem, &bench.result, bench.scratch, &error),
                 IMK_ERROR_RANGE);
    assert_string_equal(error.field, "sigma");
    bench.problem.cookie = 0;
    CHECK_STATUS(imk_magnetometer_solve(&bench.problem, &bench.result, bench.scratch, &error),
                 IMK_ERROR_UNINITIALISED);
}

/* Noise by neighbours, axes that are dead or at the end of their range, and coarse ones that are
 * neither. */
static void test_look(void **state)
{
    (void)state;
    mag_bench_plan plan = turned;
    CHECK_OK(mag_bench_run(&bench, &plan, 91, 0));
    imk_magnetometer_record look = imk_magnetometer_look(&bench.record);
    assert_int_equal(look.updates, 2000);
    for (int i = 0; i < 3; i++) {
        /* E sqrt|z| of 2000 second differences: 2 %, five of them; squared */
        CHECK_RELATIVE(look.noise[i], plan.noise, 0.2);
        assert_false(look.stuck[i]);
        CHECK_CLOSE(look.saturated[i], 0, 0);
    }
    for (size_t row = 0; row < 2000; row++)
        bench.value[1][row] = fmin(bench.value[1][row], bench.truth[1] + 20e-6);
    look = imk_magnetometer_look(&bench.record);
    CHECK_RELATIVE(look.saturated[1], bench.truth[1] + 20e-6, 1e-12);
    for (size_t row = 0; row < 2000; row++)
        bench.value[1][row] = 3e-6;
    look = imk_magnetometer_look(&bench.record);
    assert_true(look.stuck[1] && !look.stuck[0]);
    /* A step as coarse as the noise holds still by chance only. */
    plan = usual;
    plan.step = 0.6e-6;
    CHECK_OK(mag_bench_run(&bench, &plan, 92, 0));
    look = imk_magnetometer_look(&bench.record);
    for (int i = 0; i < 3; i++)
        CHECK_CLOSE(look.saturated[i], 0, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_coverage),
                                       cmocka_unit_test(test_noise_makes_no_bias),
                                       cmocka_unit_test(test_repeated_rows),
                                       cmocka_unit_test(test_steel),
                                       cmocka_unit_test(test_not_determined),
                                       cmocka_unit_test(test_exchanged_axes),
                                       cmocka_unit_test(test_frames),
                                       cmocka_unit_test(test_refusals),
                                       cmocka_unit_test(test_look)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
