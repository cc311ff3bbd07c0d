/* SPDX-License-Identifier: Apache-2.0 */
/* What messages about bags suggest is accepted by bags. */
#include "cli/run_command.h"

/* 600 rows at 100 Hz; the same with all stamps alike. */
static void make_bags(void)
{
    assert_int_equal(run("$I simulate AHRS --rate 100Hz --duration 6s --seed 1 -o log.csv"), 0);
    assert_int_equal(run("sed '2,$s/^[^,]*,/5,/' log.csv >still.csv"), 0);
    assert_int_equal(run("$I convert log.csv log.bag"), 0);
    assert_int_equal(run("$I convert still.csv still.bag"), 0);
}

/* A bag defines its columns: a time that tells nothing is left out by the names of the others. */
static void test_constant_stamps(void **state)
{
    (void)state;
    make_bags();
    assert_int_equal(run("$I allan still.bag --tau 1s"), 1);
    check_contains(err,
                   "leave the time column out with --map (in a log without names with --columns) "
                   "and state the sampling rate, such as --rate 100Hz\n",
                   "constant");
    assert_int_equal(run("$I allan still.bag --tau 1s --columns -,gyro_x --rate 100Hz"), 1);
    check_contains(err, "leave --columns out; --map chooses columns by their names\n", "columns");
    assert_int_equal(run("$I allan still.bag --tau 1s --map gyro_x=gyro_x --rate 100Hz"), 0);
    /* The same without names. */
    assert_int_equal(run("sed 1d still.csv | cut -d, -f1,2 >bare.csv"), 0);
    assert_int_equal(run("$I allan bare.csv --tau 1s --columns '-,gyro_x [deg/s]' --rate 100Hz"),
                     0);
    sweep();
}

/* An instance of sensors that have none is left out, also from the command that is suggested. */
static void test_instances(void **state)
{
    (void)state;
    make_bags();
    assert_int_equal(run("$I allan log.bag --tau 1s --instance 1"), 1);
    check_contains(err, "told apart by their names; leave --instance out\n", "instance");
    assert_null(strstr(err, "Next:"));
    assert_int_equal(run("$I allan log.bag --tau 1s --instance 0"), 0);
    assert_int_equal(run("$I allan log.bag --tau 1s --topic nonesuch --instance 0"), 1);
    check_contains(err, "Next: imukit allan log.bag --tau 1s --topic /imu\n", "next");
    sweep();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_constant_stamps),
        cmocka_unit_test(test_instances),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
