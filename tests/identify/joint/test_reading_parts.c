/* SPDX-License-Identifier: Apache-2.0 */
/* Reading noise and white noise of the integral from readings at several rates: exact squares, how
 * often intervals hold and a kind is told wrongly, the model. */
#include "check.h"

#include "imukit/identify_joint.h"
#include "imukit/random.h"

static imk_reading_parts parted(size_t count, const double *dt, const double *squares,
                                const double *sigmas)
{
    imk_reading_parts parts;
    CHECK_OK(imk_reading_parts_estimate(count, dt, squares, sigmas, 0.95, 0.01, &parts));
    return parts;
}

/* r = 2, A = 0.3: 4 + 0.09 rate. */
static void test_exact(void **state)
{
    (void)state;
    static const double dt[3] = {0.1, 0.01, 0.001};
    const double both[3] = {4.9, 13, 94}, sigma[3] = {0.049, 0.13, 0.94};
    imk_reading_parts p = parted(3, dt, both, sigma);
    assert_int_equal(p.kind, IMK_READING_BOTH);
    assert_int_equal(p.degrees, 1);
    CHECK_RELATIVE(p.reading_noise.value, 2, 1e-12);
    CHECK_RELATIVE(p.angle_white.value, 0.3, 1e-12);
    CHECK_CLOSE(p.chi_square, 0, 1e-18);
    CHECK_RELATIVE(p.probability, 1, 1e-6);
    /* Alone: four of 1 %, known to half a percent of the square by four logs, so to 0.0025 of r. */
    const double alike[4] = {4, 4, 4, 4}, even[4] = {0.04, 0.04, 0.04, 0.04};
    const double four[4] = {0.1, 0.1, 0.01, 0.001};
    p = parted(4, four, alike, even);
    assert_int_equal(p.kind, IMK_READING_ALIKE);
    assert_int_equal(p.degrees, 3);
    CHECK_RELATIVE(p.reading_noise.value, 2, 1e-12);
    CHECK_RELATIVE(p.reading_noise.sigma, 0.005, 1e-12);
    assert_false(p.angle_white.present);
    assert_true(p.angle_white.upper > 0 && p.angle_white.value == 0);
    const double white[3] = {0.9, 9, 90}, spread[3] = {0.009, 0.09, 0.9};
    p = parted(3, dt, white, spread);
    assert_int_equal(p.kind, IMK_READING_WHITE);
    CHECK_RELATIVE(p.angle_white.value, 0.3, 1e-12);
    /* Where the rates differ by 1 %, and the squares are known to 10 %, nothing is told. */
    const double near[2] = {0.01, 0.0101}, square[2] = {9, 9}, wide[2] = {0.9, 0.9};
    p = parted(2, near, square, wide);
    assert_int_equal(p.kind, IMK_READING_UNTOLD);
    assert_false(p.reading_noise.present || p.angle_white.present);
    assert_true(p.reading_noise.upper > 3 && p.angle_white.upper > 0.3);
    /* Readings that scatter more at the lower rate are neither. */
    const double falling[2] = {8, 4}, known[2] = {0.08, 0.04};
    p = parted(2, dt, falling, known);
    assert_int_equal(p.kind, IMK_READING_ALIKE);
    assert_true(p.probability < 1e-9);
}

/* Squares of relative sigma 2 % at 10, 100 and 1000 Hz. Over 4000 draws 95 % intervals hold in 95 %
 * or more where both are there (six sigmas: 2.1 %); the kind is told wrongly, with a part that is
 * not there, in 1 % (six sigmas: 1 %). */
static void test_coverage(void **state)
{
    (void)state;
    enum { DRAWS = 4000 };
    static const double dt[3] = {0.1, 0.01, 0.001};
    static const struct {
        double r, a;
        imk_reading_kind kind;
    } truths[] = {
        {2, 0, IMK_READING_ALIKE}, {0, 0.3, IMK_READING_WHITE}, {2, 0.3, IMK_READING_BOTH}};
    const uint32_t draws = check_runs(DRAWS);
    const double slack = 6 / sqrt(draws);
    for (size_t t = 0; t < 3; t++) {
        size_t told = 0, covered[2] = {0};
        for (uint32_t k = 0; k < draws; k++) {
            double square[3], sigma[3], normal[3];
            imk_random_normals(imk_random_seeded(t + 1), k, 0, 3, normal);
            for (size_t i = 0; i < 3; i++) {
                const double truth = truths[t].r * truths[t].r + truths[t].a * truths[t].a / dt[i];
                sigma[i] = 0.02 * truth;
                square[i] = truth + sigma[i] * normal[i];
            }
            const imk_reading_parts p = parted(3, dt, square, sigma);
            const imk_estimate *r = &p.reading_noise, *a = &p.angle_white;
            told += p.kind == truths[t].kind;
            covered[0] += truths[t].r >= r->lower && truths[t].r <= r->upper;
            covered[1] += truths[t].a >= a->lower && truths[t].a <= a->upper;
            assert_true(!r->present || (r->value >= r->lower && r->value <= r->upper));
            assert_true(!a->present || (a->value >= a->lower && a->value <= a->upper));
        }
        const double n = draws;
        print_message("r = %g, A = %g: told %.4f, r held %.4f, A held %.4f\n", truths[t].r,
                      truths[t].a, (double)told / n, (double)covered[0] / n,
                      (double)covered[1] / n);
        assert_true((double)told / n > 0.99 - slack * 0.1);
        for (int part = 0; part < 2; part++)
            assert_true((double)covered[part] / n > 0.95 - slack * 0.22);
    }
}

static void test_refusals(void **state)
{
    (void)state;
    const double dt[2] = {0.01, 0.02}, same[2] = {0.01, 0.01}, square[2] = {1, 1}, none[2] = {1, 0};
    const double bad[2] = {1, NAN};
    imk_reading_parts p;
    CHECK_STATUS(imk_reading_parts_estimate(1, dt, square, square, 0.95, 0.01, &p),
                 IMK_ERROR_TOO_SHORT);
    CHECK_STATUS(imk_reading_parts_estimate(2, same, square, square, 0.95, 0.01, &p),
                 IMK_ERROR_TOO_SHORT);
    CHECK_STATUS(imk_reading_parts_estimate(2, dt, square, none, 0.95, 0.01, &p), IMK_ERROR_RANGE);
    CHECK_STATUS(imk_reading_parts_estimate(2, dt, square, square, 1, 0.01, &p), IMK_ERROR_RANGE);
    CHECK_STATUS(imk_reading_parts_estimate(2, dt, bad, square, 0.95, 0.01, &p),
                 IMK_ERROR_NOT_FINITE);
    assert_int_equal(p.count, 0);
}

/* In the model they stand in place of what one log makes of them; where nothing is told, that
 * stays. */
static void test_store(void **state)
{
    (void)state;
    static imk_model model;
    imk_model_default(&model);
    model.accel.noise.angle_white.value[1] = 7;
    imk_reading_parts p = {.count = 2, .reading_noise = {.upper = 9}, .angle_white = {.upper = 9}};
    imk_reading_parts_store(&p, &model, IMK_ACCEL, 1);
    CHECK_CLOSE(model.accel.noise.angle_white.value[1], 7, 0);
    assert_int_equal(model.accel_evidence.interval_count, 0);
    p.kind = IMK_READING_ALIKE;
    p.reading_noise = (imk_estimate){true, 2, 0.1, 1.8, 2.2, 2};
    imk_reading_parts_store(&p, &model, IMK_ACCEL, 1);
    CHECK_CLOSE(model.accel.noise.angle_white.value[1], 0, 0);
    CHECK_CLOSE(model.accel.noise.reading_noise.value[1], 2, 0);
    CHECK_CLOSE(model.accel.noise.reading_noise.sigma[1], 0.1, 0);
    assert_int_equal(model.accel_evidence.interval_count, 2);
    assert_string_equal(model.accel_evidence.interval[1].key, "noise.velocity_white");
    CHECK_CLOSE(model.accel_evidence.interval[1].upper.value[1], 9, 0);
    CHECK_OK(imk_model_validate(&model, NULL));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_exact),
        cmocka_unit_test(test_coverage),
        cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_store),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
