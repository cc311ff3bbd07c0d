/* SPDX-License-Identifier: Apache-2.0 */
/* What a step of time says about missing samples: docs/logs.md, 1.5 intervals and more. */
#include "check.h"

#include "imukit/samples.h"

static void test_gaps_from_one_and_a_half(void **state)
{
    (void)state;
    static const double interval[] = {1.0, 0.01, 1.0 / 512};
    for (size_t i = 0; i < 3; i++) {
        assert_false(imk_step_is_gap(1.49 * interval[i], interval[i]));
        assert_true(imk_step_is_gap(1.51 * interval[i], interval[i]));
        assert_int_equal(imk_step_intervals(1e-3 * interval[i], interval[i]), 1);
        assert_int_equal(imk_step_intervals(1.49 * interval[i], interval[i]), 1);
        assert_int_equal(imk_step_intervals(1.51 * interval[i], interval[i]), 2);
        assert_int_equal(imk_step_intervals(2.49 * interval[i], interval[i]), 2);
        assert_int_equal(imk_step_intervals(2.51 * interval[i], interval[i]), 3);
        assert_int_equal(imk_step_intervals(1e6 * interval[i], interval[i]), 1000000);
    }
    assert_true(imk_step_is_gap(1.5, 1.0));
    assert_int_equal(imk_step_intervals(1.5, 1.0), 2);
}

static void test_what_is_no_step(void **state)
{
    (void)state;
    assert_int_equal(imk_step_intervals(0.0, 1.0), 0);
    assert_int_equal(imk_step_intervals(-2.0, 1.0), 0);
    assert_int_equal(imk_step_intervals((double)NAN, 1.0), 0);
    assert_true(imk_step_is_gap((double)NAN, 1.0));
    assert_int_equal(imk_step_intervals((double)INFINITY, 1.0), 1000000000000000);
    assert_int_equal(imk_step_intervals(1e300, 1e-300), 1000000000000000);
}

static void test_samples_in_a_time(void **state)
{
    (void)state;
    assert_int_equal(imk_samples_in(1.0, 0.01), 100);
    assert_int_equal(imk_samples_in(0.4999, 1.0), 0);
    assert_int_equal(imk_samples_in(0.5, 1.0), 1);
    assert_int_equal(imk_samples_in(0.0, 1.0), 0);
    assert_int_equal(imk_samples_in(-1.0, 1.0), 0);
    assert_int_equal(imk_samples_in((double)NAN, 1.0), 0);
    assert_int_equal(imk_samples_in(1e14, 0.1), 1000000000000000);
    assert_int_equal(imk_samples_in(1.0, 1e-20), 1000000000000000);
    assert_int_equal(imk_samples_in(1e300, 0.0), 1000000000000000);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_gaps_from_one_and_a_half),
        cmocka_unit_test(test_what_is_no_step),
        cmocka_unit_test(test_samples_in_a_time),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
