/* SPDX-License-Identifier: Apache-2.0 */
/* The description of an aid: its defaults, and what is refused. */
#include "check.h"

#include "imukit/aiding.h"

#include <math.h>

static void test_defaults(void **state)
{
    (void)state;
    /* Axes and units of the kinds, as the header has them. */
    static const size_t axes[IMK_AID_KIND_COUNT] = {3, 3, 1, 1, 3, 3};
    static const char *const units[IMK_AID_KIND_COUNT] = {"m", "m/s", "rad", "m", "m/s", "m/s"};
    imk_error error;
    for (int k = 0; k < IMK_AID_KIND_COUNT; k++) {
        const imk_aid aid = imk_aid_default((imk_aid_kind)k);
        CHECK_OK(imk_aid_validate(&aid, &error));
        assert_int_equal(imk_aid_axes((imk_aid_kind)k), axes[k]);
        assert_string_equal(imk_aid_unit((imk_aid_kind)k), units[k]);
        assert_non_null(imk_aid_kind_name((imk_aid_kind)k));
        assert_true(aid.interval == 1.0 && aid.from == 1.0 && isinf(aid.until));
    }
    assert_true(isinf(imk_aid_default(IMK_AID_ODOMETER).sigma[1]));
    assert_null(imk_aid_kind_name(IMK_AID_KIND_COUNT));
    assert_null(imk_aid_unit(IMK_AID_KIND_COUNT));
    assert_int_equal(imk_aid_axes(IMK_AID_KIND_COUNT), 0);
}

static void test_refusals(void **state)
{
    (void)state;
    const imk_aid good = imk_aid_default(IMK_AID_POSITION);
    imk_aid bad[12];
    const char *const field[12] = {"aid",
                                   "kind",
                                   "sigma",
                                   "sigma",
                                   "sigma",
                                   "sigma",
                                   "correlated_sigma",
                                   "correlation_time",
                                   "lever_arm",
                                   "interval",
                                   "from",
                                   "until"};
    for (int k = 0; k < 12; k++)
        bad[k] = good;
    bad[0].cookie = 0;
    bad[1].kind = IMK_AID_KIND_COUNT;
    bad[2].sigma[1] = 0.0;
    bad[3].sigma[0] = (double)NAN;
    bad[4].sigma[0] = bad[4].sigma[1] = bad[4].sigma[2] = (double)INFINITY;
    bad[5] = imk_aid_default(IMK_AID_HEIGHT);
    bad[5].sigma[2] = 1.0;
    bad[6].correlated_sigma[2] = -1.0;
    bad[7].correlated_sigma[2] = 1.0;
    bad[8].lever_arm[1] = (double)NAN;
    bad[9].interval = 0.0;
    bad[10].from = (double)NAN;
    bad[11].until = 0.5;
    for (int k = 0; k < 12; k++) {
        imk_error error;
        assert_true(imk_aid_validate(&bad[k], &error) != IMK_OK);
        assert_string_equal(error.field, field[k]);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_defaults),
                                       cmocka_unit_test(test_refusals)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
