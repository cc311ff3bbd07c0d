/* SPDX-License-Identifier: Apache-2.0 */
/* "Did you mean": distances counted by hand. */
#include "check.h"

#include "imukit/names.h"

#include <string.h>

static const char *const keys[] = {"bias", "scale_factor", "misalignment", NULL, "range", "k2",
                                   "k3"};
enum { COUNT = sizeof keys / sizeof keys[0] };

static void finds_one_slip(void **state)
{
    (void)state;
    assert_int_equal(imk_nearest_name("baias", COUNT, keys), 0);        /* one added */
    assert_int_equal(imk_nearest_name("bisa", COUNT, keys), 0);         /* two exchanged */
    assert_int_equal(imk_nearest_name("rnge", COUNT, keys), 4);         /* one left out */
    assert_int_equal(imk_nearest_name("Scale Factor", COUNT, keys), 1); /* spelling only */
    assert_int_equal(imk_nearest_name("scalefactors", COUNT, keys), 1);
    assert_int_equal(imk_nearest_name("mis-aligment", COUNT, keys), 2);
}

static void leaves_far_names_alone(void **state)
{
    (void)state;
    assert_true(imk_nearest_name("noise", COUNT, keys) == SIZE_MAX);
    assert_true(imk_nearest_name("", COUNT, keys) == SIZE_MAX);
    assert_true(imk_nearest_name("biass", 0, NULL) == SIZE_MAX);
    char name[200];
    memset(name, 'a', sizeof name - 1);
    name[sizeof name - 1] = '\0';
    assert_true(imk_nearest_name(name, COUNT, keys) == SIZE_MAX);
    name[64] = '\0';
    assert_true(imk_nearest_name(name, COUNT, keys) == SIZE_MAX);
}

static void equal_but_for_case_blanks_and_hyphens(void **state)
{
    (void)state;
    assert_true(imk_name_equal("ICM-42688-P", " icm 42688_p"));
    assert_false(imk_name_equal("ICM-42688-P", "icm42688"));
    assert_false(imk_name_equal("", ""));
    assert_false(imk_name_equal("- _", "-"));
    assert_true(imk_name_within("mti 630", "Xsens MTi-630"));
    assert_true(imk_name_within("XSENSMTI", "Xsens MTi-630"));
    assert_false(imk_name_within("mti6300", "Xsens MTi-630"));
    assert_false(imk_name_within("-", "Xsens MTi-630"));
    char name[80];
    memset(name, 'a', sizeof name - 1);
    name[sizeof name - 1] = '\0';
    assert_false(imk_name_equal(name, name)); /* too long to compare */
    assert_false(imk_name_within(name, name));
    assert_false(imk_name_within("a", name));
}

static void knows_endings(void **state)
{
    (void)state;
    assert_true(imk_has_ending("a/log.csv", ".csv"));
    assert_true(imk_has_ending("log.npy.gz", ".npy.gz"));
    assert_true(imk_has_ending(".csv", ".csv"));
    assert_false(imk_has_ending("log.CSV", ".csv"));
    assert_false(imk_has_ending("log.csv.gz", ".csv"));
    assert_false(imk_has_ending("csv", ".csv"));
    assert_false(imk_has_ending("", ".csv"));
    assert_false(imk_has_ending(NULL, ".csv"));
}

static void takes_the_first_of_equals(void **state)
{
    (void)state;
    assert_int_equal(imk_nearest_name("k4", COUNT, keys), 5);
    assert_int_equal(imk_nearest_name("k3", COUNT, keys), 6);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(finds_one_slip),
        cmocka_unit_test(leaves_far_names_alone),
        cmocka_unit_test(takes_the_first_of_equals),
        cmocka_unit_test(equal_but_for_case_blanks_and_hyphens),
        cmocka_unit_test(knows_endings),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
