/* SPDX-License-Identifier: Apache-2.0 */
#include "check.h"

#include "imukit/status.h"

#include <stdio.h>

static void the_version_is_that_of_its_numbers(void **state)
{
    (void)state;
    char due[32];
    snprintf(due, sizeof due, "%d.%d.%d", IMK_VERSION_MAJOR, IMK_VERSION_MINOR, IMK_VERSION_PATCH);
    assert_string_equal(imk_version(), due);
    assert_string_equal(imk_version(), IMK_VERSION);
}

static void every_status_has_a_name_and_a_text(void **state)
{
    (void)state;
    for (int status = 0; status >= IMK_ERROR_CANCELLED; status--) {
        assert_string_not_equal(imk_status_name((imk_status)status), "unknown");
        assert_string_not_equal(imk_status_text((imk_status)status), "unknown");
    }
    assert_string_equal(imk_status_text((imk_status)1), "unknown");
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(the_version_is_that_of_its_numbers),
                                       cmocka_unit_test(every_status_has_a_name_and_a_text)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
