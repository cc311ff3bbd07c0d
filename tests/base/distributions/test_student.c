/* SPDX-License-Identifier: Apache-2.0 */
/* Incomplete beta function, F and Student's distributions against closed forms: with 1, 2 and 4
 * degrees of freedom Student's quantile is elementary, and F with 2 above, for any below. The
 * tolerance is what the header promises. */
#include "check.h"

#include "imukit/distributions.h"

#include <float.h>

static void student_quantile_is_elementary_for_few_degrees(void **state)
{
    (void)state;
    const double pi = 3.14159265358979323846;
    for (double tail = 1e-9; tail < 0.5; tail *= 1.7) {
        const double p = 1.0 - tail, left = 1.0 - p; /* what is left of the tail by rounding */
        /* Relative error of the tail is that of t, times the degrees at most. */
        CHECK_RELATIVE(imk_student_quantile(p, 1.0), 1.0 / tan(pi * left), 1e-12);
        CHECK_RELATIVE(imk_student_quantile(p, 2.0),
                       (1.0 - 2.0 * left) / sqrt(2.0 * left * (1.0 - left)), 1e-12);
        const double alpha = 4.0 * left * (1.0 - left);
        const double q = cos(acos(sqrt(alpha)) / 3.0) / sqrt(alpha);
        CHECK_RELATIVE(imk_student_quantile(p, 4.0), 2.0 * sqrt(q - 1.0),
                       1e-12 + DBL_EPSILON / (q - 1.0));
        CHECK_RELATIVE(imk_student_quantile(left, 4.0), -imk_student_quantile(1.0 - left, 4.0),
                       1e-12);
    }
}

static void student_quantile_tends_to_the_normal(void **state)
{
    (void)state;
    CHECK_CLOSE(imk_student_quantile(0.5, 7.0), 0.0, 0.0);
    CHECK_RELATIVE(imk_student_quantile(0.975, (double)INFINITY), 1.959963984540054, 1e-14);
    /* t = z + (z^3 + z)/(4 n) + (5 z^5 + 16 z^3 + 3 z)/(96 n^2) + …  [ABRAMOWITZ1964, 26.7.5] */
    const double z = 1.959963984540054;
    for (double n = 1e4; n < 1e8; n *= 10.0)
        CHECK_RELATIVE(imk_student_quantile(0.975, n),
                       z + (z * z * z + z) / (4.0 * n) +
                           (5.0 * z * z * z * z * z + 16.0 * z * z * z + 3.0 * z) / (96.0 * n * n),
                       2e-12);
    assert_true(isnan(imk_student_quantile(1.0, 3.0)));
    assert_true(isnan(imk_student_quantile(0.9, 0.0)));
}

/* With 2 degrees above Q(f) = (1 + 2 f/d)^(-d/2). */
static void f_is_elementary_with_two_degrees_above(void **state)
{
    (void)state;
    for (double d = 0.7; d < 3e5; d *= 2.3)
        for (double q = 1e-8; q < 0.99; q *= 2.1) {
            const double f = 0.5 * d * expm1(-2.0 / d * log(q));
            CHECK_RELATIVE(imk_f_upper(f, 2.0, d), q, 1e-12 * (1.0 - log(q)));
            CHECK_RELATIVE(imk_f_upper_quantile(q, 2.0, d), f, 2e-12 * (1.0 + 2.0 / d));
        }
}

/* Quantile and probability undo each other; exchanged degrees give the reciprocal. */
static void f_is_consistent(void **state)
{
    (void)state;
    static const double degrees[] = {1.0, 3.0, 8.0, 15.5, 120.0, 1e5};
    for (int i = 0; i < 6; i++)
        for (int k = 0; k < 6; k++)
            for (double q = 1e-6; q < 1.0; q *= 4.0) {
                const double f = imk_f_upper_quantile(q, degrees[i], degrees[k]);
                CHECK_RELATIVE(imk_f_upper(f, degrees[i], degrees[k]), q, 1e-11);
                CHECK_RELATIVE(imk_f_upper(1.0 / f, degrees[k], degrees[i]), 1.0 - q, 1e-11);
            }
    CHECK_RELATIVE(imk_f_upper_quantile(0.05, 3.0, (double)INFINITY),
                   imk_chi_square_quantile(0.95, 3.0) / 3.0, 1e-12);
    CHECK_RELATIVE(
        imk_f_upper(imk_f_upper_quantile(1e-9, 3.0, (double)INFINITY), 3.0, (double)INFINITY), 1e-9,
        1e-11);
    assert_true(isnan(imk_f_upper(-1.0, 1.0, 1.0)));
    assert_true(isnan(imk_f_upper_quantile(0.0, 1.0, 1.0)));
}

/* I_x(a, 1) = x^a, I_x(1, b) = 1 - (1-x)^b, I_x(1/2, 1/2) = 2/pi asin(sqrt x). */
static void beta_is_elementary_at_its_edges(void **state)
{
    (void)state;
    for (double x = 1e-6; x < 1.0; x = x < 0.4 ? 3.0 * x : 0.5 * (1.0 + x)) {
        if (1.0 - x < 1e-9)
            break;
        for (double a = 0.3; a < 2000.0; a *= 2.7) {
            const double power = exp(a * log(x));
            if (power > 1e-290)
                CHECK_RELATIVE(imk_beta_lower(a, 1.0, x, 1.0 - x), power,
                               1e-12 - 4.0 * DBL_EPSILON * a * log(x));
            CHECK_RELATIVE(imk_beta_lower(1.0, a, x, 1.0 - x), -expm1(a * log1p(-x)), 1e-12);
        }
        CHECK_RELATIVE(imk_beta_lower(0.5, 0.5, x, 1.0 - x),
                       2.0 / 3.14159265358979323846 * asin(sqrt(x)), 1e-12);
    }
    CHECK_CLOSE(imk_beta_lower(2.0, 3.0, 0.0, 1.0), 0.0, 0.0);
    CHECK_CLOSE(imk_beta_lower(2.0, 3.0, 1.0, 0.0), 1.0, 0.0);
    assert_true(isnan(imk_beta_lower(0.0, 3.0, 0.5, 0.5)));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(student_quantile_is_elementary_for_few_degrees),
        cmocka_unit_test(student_quantile_tends_to_the_normal),
        cmocka_unit_test(f_is_elementary_with_two_degrees_above),
        cmocka_unit_test(f_is_consistent),
        cmocka_unit_test(beta_is_elementary_at_its_edges),
    };
    return cmocka_run_group_tests_name("student", tests, NULL, NULL);
}
