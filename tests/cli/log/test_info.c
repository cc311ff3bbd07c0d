/* SPDX-License-Identifier: Apache-2.0 */
/* imukit info: what it prints of logs of several formats, and the commands it suggests. */
#include "cli/run_command.h"

static json_t *info_json(const char *line)
{
    json_error_t error;
    if (run(line) != 0) {
        print_error("%s\n%s", line, err);
        fail();
    }
    json_t *root = json_loads(out, 0, &error);
    assert_non_null(root);
    return root;
}

static json_t *record_of(json_t *root)
{
    json_t *record = json_object_get(json_object_get(root, "result"), "record");
    assert_true(json_is_object(record));
    return record;
}

static double value_of(json_t *object, const char *key)
{
    return json_number_value(json_object_get(json_object_get(object, key), "value"));
}

static void test_a_log_at_rest(void **state)
{
    (void)state;
    assert_int_equal(run("$I simulate AHRS --rate 100Hz --duration 2min --seed 1 -o rest.csv"), 0);
    json_t *root = info_json("$I info rest.csv --json"), *record = record_of(root);
    assert_int_equal(json_integer_value(json_object_get(record, "rows")), 12000);
    assert_string_equal(json_string_value(json_object_get(record, "motion")), "at_rest");
    CHECK_CLOSE(value_of(record, "duration"), 119.99, 1e-9);
    CHECK_CLOSE(value_of(record, "interval"), 0.01, 1e-9);
    json_t *gyro = json_array_get(json_object_get(record, "columns"), 1);
    assert_string_equal(json_string_value(json_object_get(gyro, "name")), "gyro_x");
    assert_string_equal(json_string_value(json_object_get(gyro, "unit")), "deg/s");
    assert_string_equal(json_string_value(json_object_get(gyro, "unit_from")), "header");
    /* The preset's resolution is 0.005 deg/s. */
    CHECK_RELATIVE(value_of(gyro, "step"), 0.005 * 3.14159265358979 / 180, 1e-6);
    const char *next = json_string_value(json_object_get(json_object_get(root, "result"), "next"));
    assert_string_equal(next, "imukit identify rest.csv -o model.yaml");
    json_decref(root);
    assert_int_equal(run("$I info rest.csv"), 0);
    check_contains(out, "rest.csv: CSV\n", "text");
    check_contains(out, "Next: imukit identify rest.csv -o model.yaml\n", "text");
    check_contains(out, "faults    none\n", "text");
    /* The command that it suggests runs. */
    assert_int_equal(run("$I identify rest.csv -o model.yaml"), 0);
}

/* Options given for reading are in the suggestion; a stream is gone, so none is made. */
static void test_suggestions(void **state)
{
    (void)state;
    assert_int_equal(run("sed '1s/ .deg.s.//g' rest.csv >'no unit.csv'"), 0);
    assert_int_equal(run("$I info 'no unit.csv' --gyro-unit deg/s"), 0);
    check_contains(out, "Next: imukit identify 'no unit.csv' --gyro-unit deg/s -o model.yaml\n",
                   "text");
    check_contains(out, "gyro_x   deg/s  option", "origin");
    assert_int_equal(run("cat rest.csv | $I info -"), 0);
    check_contains(out, "The sensor is at rest.\n", "pipe");
    assert_null(strstr(out, "Next:"));
}

/* A sensor that is in the log by its units, and is not read, is told as the analyses tell it. */
static void test_columns_that_are_not_read(void **state)
{
    (void)state;
    assert_int_equal(run("sed '1s/gyro_x/rate_n/;1s/gyro_y/rate_e/;1s/gyro_z/rate_d/' rest.csv "
                         ">named.csv; $I info named.csv"),
                     0);
    check_contains(err,
                   "warning: named.csv: no column is read as gyro_x, gyro_y, gyro_z; rate_n, "
                   "rate_e, rate_d may be that",
                   "warning");
    assert_int_not_equal(run("$I info rest.csv --gyro-range 250deg/s"), 0);
    check_contains(err, "name it with --device PART, or state what a count is", "message");
    assert_null(strstr(err, "Next:"));
}

/* Increments are shown as rates, in the unit of a rate; `unit` is that of the log. */
static void test_increments(void **state)
{
    (void)state;
    assert_int_equal(
        run("printf 'time [s],dtheta_x [deg],dvel_x [m/s]\\n0,1,2\\n0.5,1,2\\n1,1,2\\n' >dt.csv"),
        0);
    assert_int_equal(run("$I info dt.csv"), 0);
    check_contains(out, "dtheta_x (as a rate)  deg/s  header     2 ", "1 deg in 0.5 s");
    check_contains(out, "dvel_x (as a rate)    m/s^2  header     4 ", "2 m/s in 0.5 s");
    json_t *root = info_json("$I info dt.csv --json");
    json_t *dvel = json_array_get(json_object_get(record_of(root), "columns"), 2);
    assert_string_equal(json_string_value(json_object_get(dvel, "unit")), "m/s");
    CHECK_CLOSE(value_of(dvel, "mean"), 4, 1e-12);
    json_decref(root);
}

/* What is missing is told, and the rest is shown in the numbers of the log. */
static void test_logs_that_lack_something(void **state)
{
    (void)state;
    assert_int_equal(run("sed '1s/ [[][^]]*]//g' rest.csv >bare.csv"), 0);
    assert_int_equal(run("$I info bare.csv"), 1);
    check_contains(out, "time    from 0 to 119.99, in a unit that is not stated\n", "time");
    check_contains(out, "step    0.01, the median of the time\n", "step");
    check_contains(out, "has the length 9.8", "force");
    assert_null(strstr(out, "Next:"));
    assert_null(strstr(out, "Hz"));
    check_contains(err, "add --time-unit UNIT --gyro-unit UNIT --accel-unit UNIT", "options");
    assert_int_equal(run("$I info bare.csv --json"), 1);
    json_error_t error;
    json_t *root = json_loads(out, 0, &error), *record = record_of(root);
    assert_true(json_is_false(json_object_get(record, "stated")));
    assert_true(json_is_null(json_object_get(json_object_get(record, "duration"), "value")));
    assert_string_equal(json_string_value(json_object_get(record, "motion")), "unknown");
    json_t *gyro = json_array_get(json_object_get(record, "columns"), 1);
    assert_true(json_is_null(json_object_get(gyro, "unit")));
    json_decref(root);
    /* Times are known, units are not. */
    assert_int_equal(run("$I info bare.csv --time-unit s"), 1);
    check_contains(out, "rate      100 Hz, by the median step of the time\n", "rate");
    /* Neither names nor times. */
    assert_int_equal(run("sed 1d rest.csv >numbers.csv"), 0);
    assert_int_equal(run("$I info numbers.csv"), 1);
    check_contains(out, "column 7", "columns");
    check_contains(err, "no header", "header");
    assert_int_equal(run("cut -d, -f2- rest.csv >timeless.csv"), 0);
    assert_int_equal(run("$I info timeless.csv"), 1);
    assert_null(strstr(out, "rate  "));
    check_contains(err, "--rate RATE", "rate");
    /* No other verb reads such numbers. */
    assert_int_equal(run("$I allan bare.csv"), 1);
}

/* What is suggested fits the log: six faces are no twelve holds, and a constant axis is no noise.
 */
static void test_what_is_suggested(void **state)
{
    (void)state;
    assert_int_equal(run("awk 'BEGIN { srand(5); print \"time [s],accel_x [g],accel_y [g],accel_z "
                         "[g]\"; for (i = 0; i < 9000; i++) { p = int(i / 1500); f[0] = f[1] = "
                         "f[2] = 0; f[p % 3] = p < 3 ? 1 : -1; printf \"%.2f\", i / 100; for (k = "
                         "0; k < 3; k++) printf \",%.5f\", f[k] + (rand() - .5) / (i % 1500 > 1400 "
                         "? 2 : 100); print \"\" } }' >faces.csv"),
                     0);
    assert_int_equal(run("$I info faces.csv"), 0);
    check_contains(out, "The sensor rests in 6 attitudes", out);
    check_contains(out, "Next: imukit calibrate faces.csv --procedure sixposition -o model.yaml\n",
                   out);
    assert_int_equal(run("$I calibrate faces.csv --procedure sixposition -o model.yaml"), 0);
    assert_int_equal(run("awk -F, -v OFS=, 'NR > 1 { $2 = 0 } 1' rest.csv >constant.csv"), 0);
    assert_int_equal(run("$I info constant.csv"), 0);
    check_contains(out, "All values of gyro_x are the same.\n", out);
    assert_null(strstr(out, "Next:"));
}

static void test_a_log_that_moves(void **state)
{
    (void)state;
    assert_int_equal(run("printf 'imukit_motion: 1\\nsteps:\\n  - hold 2 s\\n  - accelerate to 15 "
                         "m/s at 2 m/s^2\\n  - turn right 90 deg at 15 deg/s\\n  - stop at 3 "
                         "m/s^2\\n' >drive.yaml"),
                     0);
    assert_int_equal(run("$I simulate AHRS --motion drive.yaml --rate 100Hz -o drive.csv"), 0);
    assert_int_equal(run("$I info drive.csv"), 0);
    check_contains(out, "The sensor rests ", "motion");
    assert_null(strstr(out, "Next:"));
}

/* 50 MB: read in places, and from the beginning where it is compressed. */
static void test_a_long_log(void **state)
{
    (void)state;
    assert_int_equal(run("$I simulate AHRS --rate 100Hz --duration 10000s --seed 2 -o long.npy"),
                     0);
    json_t *root = info_json("$I info long.npy --json"), *record = record_of(root);
    assert_true(json_is_false(json_object_get(record, "whole")));
    assert_string_equal(json_string_value(json_object_get(record, "duration_from")), "ends");
    CHECK_CLOSE(value_of(record, "duration"), 9999.99, 1e-6);
    CHECK_RELATIVE((double)json_integer_value(json_object_get(record, "rows")), 1e6, 1e-3);
    json_decref(root);
    root = info_json("$I info long.npy --full --json");
    record = record_of(root);
    assert_true(json_is_true(json_object_get(record, "whole")));
    assert_int_equal(json_integer_value(json_object_get(record, "rows_read")), 1000000);
    json_decref(root);
}

/* What is found in one of the places is that of this place, and no row counts twice. */
static void test_gaps_of_a_long_log(void **state)
{
    (void)state;
    assert_int_equal(run("awk 'BEGIN { print \"time [s],gyro_x [deg/s]\"; for (i = 0; i < 1500000; "
                         "i++) if (i < 5000 || i >= 5500) printf \"%.3f,0.%018d\\n\", i / 1e3, i "
                         "* 7919 % 1000003 }' >gap.csv"),
                     0);
    json_t *root = info_json("$I info gap.csv --json"), *record = record_of(root);
    assert_true(json_is_false(json_object_get(record, "whole")));
    assert_int_equal(json_integer_value(json_object_get(record, "gaps")), 1);
    assert_int_equal(json_integer_value(json_object_get(record, "missing")), 500);
    CHECK_RELATIVE((double)json_integer_value(json_object_get(record, "rows")), 1499500, 0.02);
    json_decref(root);
}

static void test_refusals(void **state)
{
    (void)state;
    assert_int_equal(run("$I info"), 2);
    assert_int_equal(run("$I info none.csv"), 1);
    check_contains(err, "none.csv", "missing");
    assert_int_equal(run("printf '' >empty.csv; $I info empty.csv"), 1);
    assert_int_equal(run("$I info rest.csv --topic imu"), 1);
    check_contains(err, "leave --topic and --instance out", "topic");
    assert_int_equal(run("$I info rest.csv --format nonesuch"), 1);
    check_contains(err, "no format is called \"nonesuch\"", "format");
    /* rest, model, no unit, named, faces, constant, bare, numbers, timeless, the drive and its log,
     * long.npy and its names, gap, increments, empty */
    assert_int_equal(sweep(), 16);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_a_log_at_rest),
        cmocka_unit_test(test_suggestions),
        cmocka_unit_test(test_columns_that_are_not_read),
        cmocka_unit_test(test_increments),
        cmocka_unit_test(test_logs_that_lack_something),
        cmocka_unit_test(test_what_is_suggested),
        cmocka_unit_test(test_a_log_that_moves),
        cmocka_unit_test(test_a_long_log),
        cmocka_unit_test(test_gaps_of_a_long_log),
        cmocka_unit_test(test_refusals),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
