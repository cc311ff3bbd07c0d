/* SPDX-License-Identifier: Apache-2.0 */
/* Distribution functions against 60-digit reference values (tests/reference/distributions.py). The
 * tolerances are those the header promises. */
#include "check.h"

#include "imukit/distributions.h"

#include "reference/distributions.inc"

#include <float.h>

#define COUNT(array) (sizeof(array) / sizeof((array)[0]))

static void normal_probability_agrees_in_both_tails(void **state)
{
    (void)state;
    for (size_t i = 0; i < COUNT(normal_upper); i++) {
        const double x = normal_upper[i][0], upper = normal_upper[i][1];
        CHECK_RELATIVE(imk_normal_probability(-x), upper, 1e-14);
        CHECK_RELATIVE(imk_normal_probability(x), 1.0 - upper, 1e-14);
    }
    CHECK_RELATIVE(imk_normal_probability(0.0), 0.5, 0.0);
    CHECK_RELATIVE(imk_normal_probability(-40.0), 0.0, 0.0);
    CHECK_RELATIVE(imk_normal_probability(-(double)INFINITY), 0.0, 0.0);
    CHECK_RELATIVE(imk_normal_probability((double)INFINITY), 1.0, 0.0);
    assert_true(isnan(imk_normal_probability((double)NAN)));
}

static void normal_quantile_inverts_the_table(void **state)
{
    (void)state;
    for (size_t i = 0; i < COUNT(normal_upper); i++) {
        const double x = normal_upper[i][0], upper = normal_upper[i][1];
        /* dx = dp/density: where x is small the rounding of p itself, half an ulp, shows. */
        const double rounding = 0.5 * DBL_EPSILON * upper * sqrt(2.0 * 3.1416) * exp(0.5 * x * x);
        CHECK_CLOSE(imk_normal_quantile(upper), -x, 1e-14 * x + rounding);
    }
}

/* Percentage points as every table prints them. */
static void normal_quantile_gives_the_usual_points(void **state)
{
    (void)state;
    CHECK_CLOSE(imk_normal_quantile(0.975), 1.959963984540054, 1e-14);
    CHECK_CLOSE(imk_normal_quantile(0.995), 2.575829303548901, 1e-14);
    CHECK_CLOSE(imk_normal_quantile(0.84134474606854293), 1.0, 1e-14);
    CHECK_CLOSE(imk_normal_quantile(0.5), 0.0, 0.0);
    /* Near one half the quantile is (p - 1/2) sqrt(2 pi), relative to itself. */
    CHECK_RELATIVE(imk_normal_quantile(0.5 + 0x1p-40), 0x1p-40 * 2.5066282746310005, 1e-14);
    assert_true(isnan(imk_normal_quantile(0.0)));
    assert_true(isnan(imk_normal_quantile(1.0)));
    assert_true(isnan(imk_normal_quantile((double)NAN)));
}

/* Probabilities down to the smallest doubles still have quantiles. */
static void normal_quantile_reaches_the_far_tail(void **state)
{
    (void)state;
    for (int exponent = -10; exponent >= -1070; exponent -= 53) {
        const double p = ldexp(1.0, exponent);
        /* The rounding of x of half an ulp changes p by x^2 eps/2, at most 1600 * 1.1e-16. */
        const double tolerance = exponent > -1000 ? 4e-13 : 0.1;
        CHECK_RELATIVE(imk_normal_probability(imk_normal_quantile(p)), p, tolerance);
    }
}

static void log_gamma_agrees(void **state)
{
    (void)state;
    for (size_t i = 0; i < COUNT(log_gamma); i++) {
        CHECK_RELATIVE(imk_log_gamma(log_gamma[i][0]), log_gamma[i][1], 1e-14);
    }
    CHECK_CLOSE(imk_log_gamma(1.0), 0.0, 0.0);
    CHECK_CLOSE(imk_log_gamma(2.0), 0.0, 0.0);
    assert_true(isnan(imk_log_gamma(0.0)));
    assert_true(isnan(imk_log_gamma(-1.5)));
}

static void incomplete_gamma_agrees(void **state)
{
    (void)state;
    for (size_t i = 0; i < COUNT(gamma_pq); i++) {
        const double a = gamma_pq[i][0], x = gamma_pq[i][1];
        const double p = gamma_pq[i][2], q = gamma_pq[i][3];
        /* The smaller one is accurate relative to itself, so the other one to rounding. */
        CHECK_RELATIVE(imk_gamma_lower(a, x), p, p <= q ? 1e-12 : 1e-15 + 1e-12 * q);
        CHECK_RELATIVE(imk_gamma_upper(a, x), q, q <= p ? 1e-12 : 1e-15 + 1e-12 * p);
    }
}

static void incomplete_gamma_at_the_ends(void **state)
{
    (void)state;
    CHECK_CLOSE(imk_gamma_lower(3.0, 0.0), 0.0, 0.0);
    CHECK_CLOSE(imk_gamma_upper(3.0, (double)INFINITY), 0.0, 0.0);
    CHECK_CLOSE(imk_gamma_lower(3.0, 1e300), 1.0, 0.0);
    CHECK_CLOSE(imk_gamma_lower(1e8, 1e7), 0.0, 0.0);
    assert_true(isnan(imk_gamma_lower(0.0, 1.0)));
    assert_true(isnan(imk_gamma_lower(1.0, -1.0)));
    assert_true(isnan(imk_gamma_upper((double)INFINITY, 1.0)));
    assert_true(isnan(imk_gamma_upper(1.0, (double)NAN)));
}

/* Where one formula hands over to the next, neighbours agree to the slope of the function. */
static void incomplete_gamma_is_continuous_across_its_formulas(void **state)
{
    (void)state;
    const double at[][2] = {{20.0, 20.0},  {20.0, 12.0},  {20.0, 30.0},         {25.0, 25.0 * 0.31},
                            {25.0, 58.75}, {1e6, 0.31e6}, {0.7, 1.5},           {5.0, 6.0},
                            {1.0, 1.2},    {1.0, 2.0},    {200.0, 200.0 * 1.02}};
    for (size_t i = 0; i < COUNT(at); i++) {
        const double a = at[i][0], x = at[i][1];
        const double below = imk_gamma_upper(a * (1.0 - 1e-13), x * (1.0 - 1e-13));
        const double above = imk_gamma_upper(a * (1.0 + 1e-13), x * (1.0 + 1e-13));
        /* Q changes by at most a few times the relative change times the larger argument. */
        CHECK_CLOSE(above, below, 4e-13 * (a + x));
    }
}

static void chi_square_quantile_agrees(void **state)
{
    (void)state;
    for (size_t i = 0; i < COUNT(chi_square); i++) {
        const double degrees = chi_square[i][0];
        /* P is good to 1e-12 in its logarithm at the worst, whose slope in log x is at most
         * degrees/2 in the lower tail: hence the degrees below 1. */
        const double tolerance = degrees < 1.0 ? 1e-12 / degrees : 1e-12;
        CHECK_RELATIVE(imk_chi_square_quantile(chi_square[i][1], degrees), chi_square[i][2],
                       tolerance);
    }
}

/* Two degrees of freedom: the exponential distribution, -2 log(1 - p). */
static void chi_square_of_two_degrees_is_exponential(void **state)
{
    (void)state;
    for (double p = 1e-12; p < 1.0; p = p < 0.1 ? 3.0 * p : p + 0.07) {
        CHECK_RELATIVE(imk_chi_square_quantile(p, 2.0), -2.0 * log1p(-p), 1e-13);
        CHECK_RELATIVE(imk_chi_square_probability(-2.0 * log1p(-p), 2.0), p, 1e-13);
    }
}

/* Over the whole range of degrees and probabilities, the distribution function of the quantile is
 * the probability; its tail is compared, to the slope times the rounding of x. */
static void chi_square_quantile_inverts_the_distribution(void **state)
{
    (void)state;
    const double probabilities[] = {1e-12, 1e-9,  1e-4, 0.01,       0.1,        0.4999,
                                    0.5,   0.501, 0.99, 1.0 - 1e-6, 1.0 - 1e-9, 1.0 - 1e-12};
    for (double degrees = 0.1; degrees < 1.1e8; degrees *= 1.9) {
        for (size_t i = 0; i < COUNT(probabilities); i++) {
            const double p = probabilities[i];
            const double x = imk_chi_square_quantile(p, degrees);
            const double slope = 8.0 * sqrt(degrees + 50.0);
            const double tolerance = 2e-13 + slope * DBL_EPSILON;
            if (p <= 0.5)
                CHECK_RELATIVE(imk_gamma_lower(0.5 * degrees, 0.5 * x), p, tolerance);
            else
                CHECK_RELATIVE(imk_gamma_upper(0.5 * degrees, 0.5 * x), 1.0 - p, tolerance);
        }
    }
    assert_true(isnan(imk_chi_square_quantile(0.5, 0.0)));
    assert_true(isnan(imk_chi_square_quantile(0.0, 3.0)));
    assert_true(isnan(imk_chi_square_quantile(1.0, 3.0)));
    assert_true(isnan(imk_chi_square_quantile(0.5, (double)NAN)));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(normal_probability_agrees_in_both_tails),
        cmocka_unit_test(normal_quantile_inverts_the_table),
        cmocka_unit_test(normal_quantile_gives_the_usual_points),
        cmocka_unit_test(normal_quantile_reaches_the_far_tail),
        cmocka_unit_test(log_gamma_agrees),
        cmocka_unit_test(incomplete_gamma_agrees),
        cmocka_unit_test(incomplete_gamma_at_the_ends),
        cmocka_unit_test(incomplete_gamma_is_continuous_across_its_formulas),
        cmocka_unit_test(chi_square_quantile_agrees),
        cmocka_unit_test(chi_square_of_two_degrees_is_exponential),
        cmocka_unit_test(chi_square_quantile_inverts_the_distribution),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
