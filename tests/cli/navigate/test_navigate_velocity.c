/* SPDX-License-Identifier: Apache-2.0 */
/* imukit navigate from a given velocity: options, refusals, and what is said. */
#include "cli/run_command.h"

#define PLACE "--position '45 deg, 0 deg, 0 m'"

static void write_rest(void)
{
    assert_int_equal(run("$I simulate navigation --rate 20Hz --duration 60s --seed 1 -o rest.csv"),
                     0);
}

static void test_refusals(void **state)
{
    (void)state;
    write_rest();
#define REFUSED(options, message)                                                                  \
    check_message("$I navigate rest.csv " PLACE " " options, 2,                                    \
                  "imukit navigate: error: " message "\n" TRY("navigate"))
    REFUSED("--align 10s --velocity '1 0 0 m/s'",
            "--velocity is for a start with --attitude: a unit that aligns itself is at rest");
    REFUSED("--attitude '0 0 0 deg' --velocity '1 0 m/s'",
            "--velocity \"1 0 m/s\": expected three numbers and a unit, north, east and down, such "
            "as \"20 -3 0 m/s\", and their 1 sigma after +- if known");
    REFUSED(
        "--attitude '0 0 0 deg' --velocity '1 0 1 m/s'",
        "--velocity \"1 0 1 m/s\" goes up or down, but the height is held: add --vertical free");
    REFUSED("--attitude '0 0 0 deg' --velocity '1 4e4 0 m/s'",
            "--velocity \"1 4e4 0 m/s\": expected at most 30 km/s");
    REFUSED(
        "--align 10s --position-sigma='-1 m'",
        "--position-sigma \"-1 m\": expected one or three numbers (north, east, down) from 0 to "
        "10000 km with a unit, such as 5m");
    sweep();
}

static void test_what_is_said(void **state)
{
    (void)state;
    write_rest();
    assert_int_equal(run("$I navigate rest.csv " PLACE " --attitude '0 0 0 deg'"), 0);
    check_contains(out, "Velocity assumed (--velocity): north 0, east 0, down 0 m/s", "velocity");
    assert_string_equal(err, "");
    assert_int_equal(run("$I navigate rest.csv " PLACE " --attitude '0 0 0 deg' --model navigation "
                         "--velocity '2 -1 0 +- 0.5 m/s' --position-sigma '3 4 5 m' --json"),
                     0);
    check_contains(out, "\"velocity_given\": true", "velocity");
    assert_int_equal(run("$I navigate rest.csv --position '-45 deg, 0 deg, 0 m' --attitude "
                         "'0 0 0 deg' --model navigation"),
                     0);
    check_contains(err, "the sign of the latitude of --position is wrong", "hemisphere");
    sweep();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_what_is_said),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
