/* SPDX-License-Identifier: Apache-2.0 */
/* imukit calibrate, used wrongly: each mistake is answered with what was found, what was expected
 * and what to do; and a sound test of few holds loses none of them. */
#include "run_command.h"

#include "imukit/model_file.h"

#define PLACE "--position '48.1 deg, 11.6 deg, 520 m'"
#define POSES "-p multiposition " PLACE

static void check_says(const char *line, int code, const char *message)
{
    const int actual = run(line);
    if (actual != code)
        fail_msg("%s: code %d, expected %d\n%s%s", line, actual, code, out, err);
    check_contains(err, message, line);
}

static void put_unit(void)
{
    put("unit.yaml", "imukit: 1\n"
                     "name: bench unit\n"
                     "gyro:\n"
                     "  bias: {fixed: 0.5 -0.8 0.3 deg/s}\n"
                     "  noise: {angle_random_walk: 0.3 deg/sqrt(h), bias_instability: 5 deg/h}\n"
                     "accel:\n"
                     "  bias: {fixed: 20 -35 50 mg}\n"
                     "  scale_factor: {fixed: -3000 6000 9000 ppm}\n"
                     "  noise: {velocity_random_walk: 0.05 m/s/sqrt(h), bias_instability: 30 "
                     "ug}\n");
}

/* Six faces, a turn in three of them. */
static void write_turns(void)
{
    put_unit();
    put("turns.yaml", "imukit_motion: 1\n"
                      "start: {latitude: 48.1 deg, longitude: 11.6 deg, height: 520 m}\n"
                      "steps:\n"
                      "  - hold 6 s\n  - rotate z 360 deg at 90 deg/s\n  - hold 5 s\n"
                      "  - pose 0 90 0 deg in 3 s\n"
                      "  - hold 6 s\n  - rotate x 360 deg at 90 deg/s\n  - hold 5 s\n"
                      "  - pose 0 -90 0 deg in 4 s\n  - hold 6 s\n"
                      "  - pose 90 0 0 deg in 3 s\n"
                      "  - hold 6 s\n  - rotate y 360 deg at 90 deg/s\n  - hold 5 s\n"
                      "  - pose -90 0 0 deg in 4 s\n  - hold 6 s\n"
                      "  - pose 180 0 0 deg in 4 s\n  - hold 6 s\n"
                      "then: hold\n");
    assert_int_equal(run("$I simulate unit.yaml --motion turns.yaml --rate 100Hz --duration 95s "
                         "--seed 3 -o turns.csv"),
                     0);
}

/* Three directions of accelerometers are redundant here, and scatter by less than their sigmas:
 * nothing is refused because the rest fits even better. */
static void few_holds_are_kept(void **state)
{
    (void)state;
    write_turns();
    const char *line = "$I calibrate turns.csv -p ferraris " PLACE " --strict";
    assert_int_equal(run(line), 0);
    check_contains(out, "Usable: accelerometer", line);
    assert_null(strstr(out, "Left out"));
    sweep();
}

static void options_of_other_procedures_are_refused(void **state)
{
    (void)state;
    write_turns();
    check_says("$I calibrate turns.csv " POSES " --motion turns.yaml", 2,
               "--motion is not used by --procedure multiposition");
    check_says("$I calibrate turns.csv " POSES " --turn-angle 360deg", 2,
               "--turn-angle is not used by --procedure multiposition, only by ferraris");
    check_says("$I calibrate turns.csv " POSES " --temperature-order 3", 2, "only by thermal");
    check_says("$I calibrate turns.csv " POSES " --motion-offset auto", 2,
               "--motion-offset is used with --motion only");
    check_says("$I calibrate turns.csv -p rate-table --table-axis z", 1,
               "turns.csv has no column table_rate [deg/s], which --table-axis needs");
    sweep();
}

static void logs_too_short_for_the_options_are_named(void **state)
{
    (void)state;
    write_turns();
    check_says("$I calibrate turns.csv " POSES " --initial-rest 500s", 2,
               "--initial-rest 500s is longer than turns.csv, which has 95 s");
    check_says("$I calibrate turns.csv " POSES " --window 1e9s", 2, "is longer than turns.csv");
    check_says("$I calibrate turns.csv " POSES " --minimum 40s", 1,
               "is never stationary for 40 s, which --minimum requires");
    assert_int_equal(run("head -2 turns.csv >one.csv"), 0);
    check_says("$I calibrate one.csv " POSES " --rate 100Hz", 1, "one.csv has one row of data");
    sweep();
}

/* A temperature in each row is not enough: it must be one. */
static void temperatures_that_are_none_are_counted(void **state)
{
    (void)state;
    assert_int_equal(run("$I simulate AHRS --rate 10Hz --duration 20s -o rest.csv && "
                         "awk -F, -v OFS=, '{print $0, NR == 1 ? \"temperature [degC]\" : "
                         "NR <= 51 ? \"nan\" : -300}' rest.csv >cold.csv"),
                     0);
    check_says(
        "$I calibrate cold.csv -p thermal", 1,
        "cold.csv: of 200 rows, 150 have a temperature of 0 K or less and 50 have no number; at "
        "least 96 rows need a valid temperature: check the column temperature and its unit "
        "(--temperature-unit)");
    sweep();
}

static void rows_without_numbers_are_counted(void **state)
{
    (void)state;
    write_turns();
    assert_int_equal(run("awk -F, 'BEGIN{OFS=\",\"} NR>1&&NR%5==0{$5=\"\"} {print}' turns.csv "
                         ">sparse.csv"),
                     0);
    check_says("$I calibrate sparse.csv " POSES, 1, "sparse.csv: 20 % of the rows have an empty");
    sweep();
}

/* A programme that begins later than was said, and one of another test. */
static void other_programmes_are_noticed(void **state)
{
    (void)state;
    write_turns();
    check_says("$I calibrate turns.csv -p rate-table --motion turns.yaml --motion-offset 4s", 1,
               "s earlier than stated");
    sweep();
}

/* A row that is left out is told, and only such a row. */
static void missing_readings_are_told(void **state)
{
    (void)state;
    write_turns();
    static const char told[] = "a reading or the temperature is not finite, or beyond 1e60";
    static const char *const values[] = {"nan", "inf", "1e308", ""};
    char line[300];
    for (size_t i = 0; i < sizeof values / sizeof values[0]; i++) {
        snprintf(line, sizeof line,
                 "awk -F, -v OFS=, 'NR==3000 {$5=\"%s\"} 1' turns.csv >gap.csv; "
                 "$I calibrate gap.csv " POSES " --strict",
                 values[i]);
        run(line);
        check_contains(err, "gap.csv: in 1 of 9500 rows a reading", line);
        check_contains(err, "first in row 2999", line);
    }
    run("$I calibrate turns.csv " POSES);
    assert_null(strstr(err, told));
    sweep();
}

/* Counts per unit are refused where the log has a unit; what was taken would be in the model. */
static void counts_are_for_logs_in_counts(void **state)
{
    (void)state;
    write_turns();
    check_says("$I calibrate turns.csv " POSES " --accel-sensitivity '415 count/(m/s^2)'", 2,
               "--accel-sensitivity is for readings in counts, but those of turns.csv have a unit");
    check_says("$I calibrate turns.csv " POSES
               " --gyro-sensitivity '4778 count/(rad/s)' --gyro-zero "
               "'512 count'",
               2, "--gyro-sensitivity is for readings in counts");
    sweep();
}

/* A full scale of the data sheet ends in the model, and readings beyond it are saturated. */
static void ranges_are_written_and_checked(void **state)
{
    (void)state;
    imk_model model;
    imk_error error;
    write_turns();
    const char *line = "$I calibrate turns.csv -p ferraris " PLACE
                       " --gyro-range '2000 deg/s' --accel-range '16 g' --strict -o ranged.yaml";
    assert_int_equal(run(line), 0);
    CHECK_OK(imk_model_read("ranged.yaml", &model, NULL, &error));
    for (int i = 0; i < 3; i++) {
        CHECK_RELATIVE(model.gyro.range.value[i], 2000 * 0.017453292519943295, 1e-9);
        CHECK_RELATIVE(model.accel.range.value[i], 16 * 9.80665, 1e-9);
    }
    check_says("$I calibrate turns.csv -p ferraris " PLACE " --gyro-range '0 deg/s'", 2,
               "--gyro-range: the full scale must be above 0");
    check_says("$I calibrate turns.csv -p ferraris " PLACE " --accel-range '16 deg/s'", 2,
               "--accel-range \"16 deg/s\": expected one number");
    /* x reads 1 g in two of the faces, beyond a range of 9 m/s^2: these holds are left out. */
    assert_int_not_equal(run("$I calibrate turns.csv -p ferraris " PLACE
                             " --accel-range '9 160 160 m/s^2' --strict"),
                         0);
    check_contains(err, "found 4: add a hold with x up, x down", "saturated");
    sweep();
}

/* Rows without a text belong to no face, also the first ones. */
static void blank_labels_are_no_pose(void **state)
{
    (void)state;
    put_unit();
    put("six.yaml",
        "imukit_motion: 1\nsteps:\n  - hold 6 s\n  - pose 0 90 0 deg in 3 s\n  - hold 6 s\n"
        "  - pose 0 -90 0 deg in 4 s\n  - hold 6 s\n  - pose 90 0 0 deg in 3 s\n  - hold 6 s\n"
        "  - pose -90 0 0 deg in 4 s\n  - hold 6 s\n  - pose 180 0 0 deg in 4 s\n  - hold 6 s\n"
        "then: hold\n");
    assert_int_equal(run("$I simulate unit.yaml --motion six.yaml --rate 100Hz --duration 54s "
                         "-o six.csv"),
                     0);
    const char *line =
        "awk -F, -v OFS=, 'function f(t){return t<0.5?\"\":t<6?\"z_down\":t<9?\"\":t<15?\"x_up\":"
        "t<19?\"\":t<25?\"x_down\":t<28?\"\":t<34?\"y_down\":t<38?\"\":t<44?\"y_up\":t<48?\"\":"
        "\"z_up\"} NR==1{print $0,\"pose\";next}{print $0,f($1)}' six.csv >named.csv && "
        "$I calibrate named.csv -p sixposition " PLACE " --strict";
    assert_int_equal(run(line), 0);
    check_contains(out, "accelerometer readings  18        0", line);
    check_contains(out, "Usable: ", line);
    sweep();
}

/* What changes in a model is a screen, not its correlations. */
static void changes_are_few_lines(void **state)
{
    (void)state;
    write_turns();
    const char *line = "$I calibrate turns.csv -p ferraris " PLACE " --into unit.yaml";
    assert_int_equal(run(line), 0);
    check_contains(err, "Changes to unit.yaml:", line);
    check_contains(err, "+ correlation: …", line);
    size_t lines = 0;
    for (const char *c = err; *c; c++)
        lines += *c == '\n';
    assert_in_range(lines, 5, 40);
    sweep();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(few_holds_are_kept),
        cmocka_unit_test(options_of_other_procedures_are_refused),
        cmocka_unit_test(logs_too_short_for_the_options_are_named),
        cmocka_unit_test(temperatures_that_are_none_are_counted),
        cmocka_unit_test(rows_without_numbers_are_counted),
        cmocka_unit_test(other_programmes_are_noticed),
        cmocka_unit_test(missing_readings_are_told),
        cmocka_unit_test(counts_are_for_logs_in_counts),
        cmocka_unit_test(blank_labels_are_no_pose),
        cmocka_unit_test(changes_are_few_lines),
        cmocka_unit_test(ranges_are_written_and_checked),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
