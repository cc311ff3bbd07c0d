/* SPDX-License-Identifier: Apache-2.0 */
/* The rate of a tuning by what is stated and recorded, and what a model leaves out. */
#include "check.h"

#include "imukit/model_file.h"
#include "imukit/tune_model.h"

#include <stdlib.h>
#include <string.h>

static void test_rate(void **state)
{
    (void)state;
    const imk_recorded_motion slow = {.rate = 50}, fast = {.rate = 400};
    imk_filter_tuning_settings s = imk_filter_tuning_default();
    imk_error error;
    s.motion_count = 2;
    CHECK_OK(imk_tune_model_rate(0, &s, &error));
    CHECK_CLOSE(s.rate, 200.0, 0.0);
    CHECK_OK(imk_tune_model_rate(300, &s, &error));
    CHECK_CLOSE(s.rate, 300.0, 0.0);
    s.motion[1].recorded = &slow;
    CHECK_OK(imk_tune_model_rate(0, &s, &error));
    CHECK_CLOSE(s.rate, 50.0, 0.0);
    assert_int_equal(imk_tune_model_rate(100, &s, &error), IMK_ERROR_CONFLICT);
    assert_int_equal(error.index, 1);
    CHECK_CLOSE(error.value, 50.0, 0.0);
    s.motion[0].recorded = &fast;
    assert_int_equal(imk_tune_model_rate(0, &s, &error), IMK_ERROR_CONFLICT);
    assert_int_equal(error.index, 1);
    assert_non_null(strstr(error.found, "another motion"));
    CHECK_CLOSE(s.rate, 50.0, 0.0);
}

static void test_unstated(void **state)
{
    (void)state;
    imk_error error;
    imk_unstated all, left;
    imk_model *model = malloc(sizeof *model);
    const char text[] = "imukit: 1\ngyro:\n  noise: {angle_random_walk: 0.1 deg/sqrt(h)}\n";
    assert_non_null(model);
    CHECK_OK(imk_model_parse(text, sizeof text - 1, model, NULL, &error));
    imk_model_unstated(model, &all);
    imk_tune_model_unstated(model, &left);
    assert_int_equal(left.count, all.count - 2); /* of gyros and of accelerometers */
    for (size_t i = 0; i < left.count; i++)
        assert_string_not_equal(left.term[i].key, "bias.repeatability");
    free(model);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_rate),
                                       cmocka_unit_test(test_unstated)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
