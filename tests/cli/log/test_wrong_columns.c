/* SPDX-License-Identifier: Apache-2.0 */
/* Every verb that reads a log tells of columns with a wrong name, and of no others. */
#include "cli/run_command.h"

#define POSES "-p multiposition --position '48.1 deg, 11.6 deg, 520 m'"

static void write_poses(void)
{
    put("unit.yaml", "imukit: 1\n"
                     "gyro:\n  noise: {angle_random_walk: 0.3 deg/sqrt(h)}\n"
                     "accel:\n  noise: {velocity_random_walk: 0.05 m/s/sqrt(h)}\n"
                     "mag:\n  noise: {density: one-sided, white_noise: 40 nT/sqrt(Hz)}\n");
    assert_int_equal(run("$I calibrate --plan unit.yaml -p multiposition --want "
                         "'accel.scale_factor 100 ppm' -o plan.yaml"),
                     0);
    assert_int_equal(
        run("$I simulate unit.yaml --motion plan.yaml --rate 50Hz --duration 120s "
            "--field '20 1 43 uT' --seed 1 -o log.csv && "
            "$I simulate unit.yaml --rate 50Hz --duration 60s --field '20 1 43 uT' --seed 1 "
            "-o rest.csv"),
        0);
}

/* Noise is identified at rest: of a log that moves, its lines are what takes the time.
 * @param change  by sed of the header  @param told  NULL: nothing of the kind */
static void check_told(const char *change, const char *verb, int code, const char *told)
{
    char line[400];
    snprintf(line, sizeof line, "sed '1s/%s/' %s.csv >wrong.csv && $I %s", change,
             strstr(verb, "identify") ? "rest" : "log", verb);
    const int actual = run(line);
    if (actual != code)
        fail_msg("%s: code %d, expected %d\n%s%s", line, actual, code, out, err);
    if (told)
        check_contains(strstr(out, told) ? out : err, told, line);
    else if (strstr(err, "not used") || strstr(out, "not used"))
        fail_msg("%s: says\n%s%s", line, out, err);
}

static void test_each_verb(void **state)
{
    (void)state;
    write_poses();
    static const char *const verbs[] = {
        "allan wrong.csv",           "spectrum wrong.csv",
        "identify wrong.csv",        "calibrate wrong.csv " POSES,
        "convert wrong.csv out.csv", "evaluate wrong.csv --motion plan.yaml"};
    for (size_t k = 0; k < sizeof verbs / sizeof verbs[0]; k++) {
        if (check_skips(k, 3)) /* allan and calibrate stay */
            continue;
        check_told("gyro_y/gryo_y", verbs[k], 0,
                   "an axis is missing, and gryo_y, which looks like gyro_y, is not used");
        check_told("gyro_/gyro_", verbs[k], 0, NULL);
    }
    check_told("gyro_y/-gyro_y", "identify wrong.csv --strict", 1,
               "a sign in a name does not turn the readings round");
    check_told("gyro_/gryo_/g; s/x/x", "identify wrong.csv --strict", 1,
               "no column is read as gyro_x, gyro_y, gyro_z; gryo_x, gryo_y, gryo_z may be that");
    if (check_quick()) { /* the rest goes the same way */
        sweep();
        return;
    }
    check_told("gyro_x/roll_rate/; 1s/gyro_y/pitch_rate/; 1s/gyro_z/yaw_rate",
               "convert wrong.csv out.csv", 0,
               "no column is read as gyro_x, gyro_y, gyro_z; roll_rate, pitch_rate, yaw_rate may");
    check_told("gyro_x [^,]*,gyro_y [^,]*,gyro_z [^,]*/p_dps,q_dps,r_dps",
               "convert wrong.csv out.csv", 0, "p_dps, q_dps, r_dps may");
    check_told("gyro_x [^,]*,gyro_y [^,]*,gyro_z [^,]*/roll [deg],pitch [deg],yaw [deg]",
               "convert wrong.csv out.csv", 0, NULL);
    check_told("gyro_y/gryo_y", "convert wrong.csv out.csv --select time,gyro_x", 0, NULL);
    check_told("gyro_/gryo_/g; s/accel_/akz_/g; s/x/x", "identify wrong.csv", 0,
               "no column is read as one of a gyro or an accelerometer");
    check_told("time/tempo", "identify wrong.csv", 1, "if tempo is the time, name it so");
    check_told("mag_y/-mag_y", "calibrate wrong.csv --strict " POSES, 1,
               "-mag_y, which looks like mag_y");
    check_told(" .uT.//g; s/x/x", "calibrate wrong.csv " POSES, 0,
               "mag_x, mag_y, mag_z; write the unit into the header");
    check_told("deg.s/count/g; 1s/m.s^2/count/g; s/x/x", "identify wrong.csv -o counts.yaml", 1,
               "the readings of wrong.csv are counts, and a model needs rates and forces: state "
               "what a count is with --gyro-scale and --accel-scale, or the part with --device");
    /* Renamed for good, or skipped. */
    check_told("x/x",
               "allan wrong.csv --columns 'time [s],gyro_x [deg/s],-,gyro_z [deg/s],accel_x "
               "[m/s^2],accel_y [m/s^2],accel_z [m/s^2],-,-,-'",
               0, NULL);
    sweep();
}

/* A model without a magnetometer leaves its columns as they came, and says so. */
static void test_compensate(void **state)
{
    (void)state;
    write_poses();
    put("clean.yaml", "imukit: 1\ngyro: {bias: {fixed: 1 deg/s}}\naccel: {bias: {fixed: 1 mg}}\n");
    put("all.yaml", "imukit: 1\ngyro: {bias: {fixed: 1 deg/s}}\naccel: {bias: {fixed: 1 mg}}\n"
                    "mag: {bias: {fixed: 1 uT}}\n");
    check_told("x/x", "compensate wrong.csv clean.yaml -o o.csv", 0,
               "clean.yaml describes no magnetometer: the columns are copied as they are");
    check_contains(err, "Left in: nothing\nLeft as it came: every column of the magnetometer",
                   "left in");
    assert_int_equal(run("$I compensate log.csv all.yaml -o o.csv"), 0);
    assert_null(strstr(err, "as it came"));
    assert_null(strstr(err, "magnetometer"));
    check_told("mag_y/mag_y_raw", "compensate wrong.csv all.yaml -o o.csv", 0,
               "mag_y_raw, which looks like mag_y");
    assert_int_equal(run("$I compensate log.csv clean.yaml -o o.csv --strict"), 1);
    sweep();
}

/* --axes turns the axes of sensors; what else belongs to the axes of the file is told. */
static void test_what_is_not_turned(void **state)
{
    (void)state;
    static const char turn[] = "--axes right-forward-up", same[] = "--axes forward-right-down";
    char line[300];
    put("all.csv", "time [s],gyro_x [deg/s],gyro_y [deg/s],gyro_z [deg/s],temperature [degC],"
                   "pressure [hPa],roll [deg],q0,qy,vel_x [m/s],phase\n"
                   "0,1,2,3,20,1000,1,1,0,0,5\n1,1,2,3,20,1000,1,1,0,0,5\n");
    snprintf(line, sizeof line, "$I convert all.csv turned.csv %s", turn);
    assert_int_equal(run(line), 0);
    check_contains(err, "all.csv: roll, q0, qy, vel_x: not turned; only the axes of the sensors",
                   "warning");
    snprintf(line, sizeof line, "$I convert all.csv turned.csv %s --select time,gyro_x", turn);
    assert_int_equal(run(line), 0);
    assert_null(strstr(err, "turned;"));
    snprintf(line, sizeof line, "$I convert all.csv turned.csv %s", same);
    assert_int_equal(run(line), 0);
    assert_null(strstr(err, "turned;"));
    put("clean.yaml", "imukit: 1\ngyro: {bias: {fixed: 1 deg/s}}\n");
    snprintf(line, sizeof line, "$I compensate all.csv clean.yaml -o turned.csv %s", turn);
    assert_int_equal(run(line), 0);
    check_contains(err, "roll, q0, qy, vel_x: not turned", "compensate");
    sweep();
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_each_verb),
                                       cmocka_unit_test(test_compensate),
                                       cmocka_unit_test(test_what_is_not_turned)};
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
