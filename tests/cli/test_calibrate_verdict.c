/* SPDX-License-Identifier: Apache-2.0 */
/* imukit calibrate, its verdict: a log that is wrong as a whole (sampling rate, range, signs,
 * gravity, too few poses, a model that does not describe it) is never "Good"; sound logs of several
 * grades are; what the log cannot show is named. */
#include "run_command.h"

#define PLACE "--position '48.1 deg, 11.6 deg, 520 m'"
#define POSES "-p multiposition " PLACE

/* Errors and noise of a grade, in units of an industrial MEMS unit; signs by the seed. */
static void put_unit(double errors, double noise, unsigned seed)
{
    char text[1200];
    const double e = errors, s = seed % 2 ? -errors : errors;
    snprintf(text, sizeof text,
             "imukit: 1\nname: bench unit\ngyro:\n"
             "  bias: {fixed: %g %g %g deg/s}\n  scale_factor: {fixed: %g %g %g ppm}\n"
             "  misalignment: %g %g %g %g %g %g mrad\n"
             "  noise: {angle_random_walk: %g deg/sqrt(h), bias_instability: %g deg/h}\naccel:\n"
             "  bias: {fixed: %g %g %g mg}\n  scale_factor: {fixed: %g %g %g ppm}\n"
             "  misalignment: %g %g %g %g %g %g mrad\n"
             "  noise: {velocity_random_walk: %g m/s/sqrt(h), bias_instability: %g ug}\n",
             0.5 * s, -0.8 * e, 0.3 * s, 8000 * e, -5000 * s, 3000 * e, 2 * s, -3 * e, 4 * s, e,
             -2 * s, 3 * e, 0.3 * noise, 5 * noise, 20 * e, -35 * s, 50 * e, -3000 * s, 6000 * e,
             9000 * s, 3 * e, -2 * s, e, 4 * s, -e, 2 * e, 0.05 * noise, 30 * noise);
    put("unit.yaml", text);
}

/* `count` attitudes over the sphere, or all within `tilt` degrees of level, `turn` s between. */
static void put_poses(int count, double tilt, double turn)
{
    char text[6000];
    size_t used = (size_t)snprintf(text, sizeof text,
                                   "imukit_motion: 1\nstart: {latitude: 48.1 deg, longitude: 11.6 "
                                   "deg, height: 520 m}\nsteps:\n  - hold 6 s\n");
    for (int i = 1; i < count; i++) {
        const int k = i * (count % 5 ? 5 : 7) % count; /* each once, far apart */
        const double roll = remainder(137.50776 * k, 360), z = 1 - (2.0 * k + 1) / count;
        const double pitch = tilt > 0 ? tilt * cos(2.4 * i) : asin(z) * 57.29578;
        used += (size_t)snprintf(
            text + used, sizeof text - used, "  - pose %.2f %.2f %.2f deg in %g s\n  - hold 4 s\n",
            tilt > 0 ? tilt * sin(2.4 * i) : roll, pitch, remainder(63.0 * i, 360), turn);
    }
    put("poses.yaml", text);
}

static void simulate_at(int rate, const char *motion, unsigned seed)
{
    char line[200];
    snprintf(line, sizeof line,
             "$I simulate unit.yaml --motion %s --rate %dHz --seed %u -o poses.csv", motion, rate,
             seed);
    assert_int_equal(run(line), 0);
}

static void simulate(const char *motion, unsigned seed)
{
    simulate_at(100, motion, seed);
}

static void write_poses(int rate)
{
    put_unit(1, 1, 0);
    put_poses(24, 0, 2);
    simulate_at(rate, "poses.yaml", 1);
}

static void check_says(const char *line, int code, const char *where, const char *message)
{
    const int actual = run(line);
    if (actual != code)
        fail_msg("%s: code %d, expected %d\n%s%s", line, actual, code, out, err);
    check_contains(where, message, line);
    assert_null(strstr(out, "Usable:"));
}

/* Columns 2 to 4 are the gyros, 5 to 7 the accelerometers. */
#define CHANGED(statement)                                                                         \
    "awk -F, -v OFS=, 'NR > 1 {" statement "} 1' poses.csv >bad.csv; $I calibrate bad.csv " POSES

static void wrong_rates_are_told(void **state)
{
    (void)state;
    write_poses(100);
    assert_int_equal(run("cut -d, -f2- poses.csv >bare.csv"), 0);
    const char *sound = "$I calibrate bare.csv --rate 100Hz " POSES;
    assert_int_equal(run(sound), 0);
    check_contains(out, "Usable: accelerometer", sound);
    check_contains(out, "Cannot be seen in this log: a sampling rate that is some per cent", sound);
    check_says("$I calibrate bare.csv --rate 200Hz -o none.yaml " POSES, 1, out,
               "instead of 200 Hz (the angle of a turn is rate times time: check --rate)");
    check_contains(out, "Not usable: bare.csv: all gyros read 0.5 times the true rate", "rate");
    check_contains(err, "none.yaml is not written (--anyway would)", "rate");
    if (check_quick()) { /* the rest goes the same way */
        sweep();
        return;
    }
    assert_int_equal(run("test -e none.yaml"), 1);
    check_says("$I calibrate bare.csv --rate 200Hz -o m.yaml --anyway " POSES, 0, out,
               "Not usable: bare.csv: all gyros read 0.5 times");
    assert_int_equal(run("test -e m.yaml"), 0);
    check_says("$I calibrate bare.csv --rate 80Hz " POSES, 0, err, "instead of 80 Hz");
    /* No solution is found from there: the reason is told all the same, and no model written. */
    check_says("$I calibrate bare.csv --rate 25Hz -o none.yaml " POSES, 1, err, "instead of 25 Hz");
    assert_int_equal(run("test -e none.yaml"), 1);
    sweep();
}

static void wrong_ranges_are_told(void **state)
{
    (void)state;
    write_poses(40);
    check_says(CHANGED("for (i = 2; i < 5; i++) $i *= 0.5"), 1, out,
               "a range of the device that is 2 times that of the conversion");
    if (!check_quick()) { /* they go the same way */
        check_says(CHANGED("for (i = 2; i < 5; i++) $i *= 4"), 1, err,
                   "a range of the device that is 1/4 times");
        check_says(CHANGED("$2 *= 1.3"), 0, err, "gyro_x reads 1.3");
        check_says(CHANGED("for (i = 5; i < 8; i++) $i *= 1.18"), 0, err,
                   "all accelerometers read 1.18");
    }
    check_says(CHANGED("for (i = 5; i < 8; i++) $i *= 2"), 1, out,
               "it looks like a range of the device that is 1/2 times");
    /* What some sensors have is a note. */
    const char *line = CHANGED("for (i = 2; i < 5; i++) $i *= 1.06");
    assert_int_equal(run(line), 0);
    check_contains(out, "few such sensors err by more than 5 %", line);
    check_contains(out, "Usable: accelerometer", line);
    sweep();
}

static void mendings_are_all_told(void **state)
{
    (void)state;
    write_poses(40);
    check_says(CHANGED("$2 = -$2; $3 = -$3"), 1, err,
               "accel_z inverted; or gyro_x and gyro_y inverted; or accel_x and accel_y inverted. "
               "The log does not show which it is. Hold the unit with an axis up");
    if (check_quick()) { /* the others go the same way */
        sweep();
        return;
    }
    check_says(CHANGED("$4 = -$4; $7 = -$7"), 1, err,
               "left-handed axes: the same axis of both sensors (x, y or z) inverted, or the same "
               "two axes of both exchanged; or all three gyros inverted");
    check_says(CHANGED("t = $2; $2 = $3; $3 = t; t = $3; $3 = $4; $4 = t"), 1, err,
               "gyro x, y, z taken from z, x, y; or accel x, y, z taken from y, z, x");
    check_says(CHANGED("$3 = -$3"), 1, err, "gyro_y has the wrong sign");
    check_says(CHANGED("t = $5; $5 = $7; $7 = t"), 1, err, "accel_x and accel_z look exchanged");
    const char *line = CHANGED("for (i = 5; i < 8; i++) $i = -$i");
    assert_int_equal(run(line), 0);
    check_contains(out, "all accelerometers with the opposite sign", line);
    sweep();
}

static void poses_that_do_not_suffice(void **state)
{
    (void)state;
    put_unit(1, 1, 0);
    put_poses(24, 35, 2);
    simulate("poses.yaml", 3);
    check_says("$I calibrate poses.csv " POSES, 0, err,
               "the force of gravity along z is nearly the same in all poses");
    assert_null(strstr(err, "hardly ever acts"));
    put("two.yaml", "imukit_motion: 1\nstart: {latitude: 48.1 deg, longitude: 11.6 deg, height: "
                    "520 m}\nsteps:\n  - repeat: {times: 5, steps: [hold 4 s, pose 2 61 -1 deg in "
                    "2 s, hold 4 s, pose 1 -2 3 deg in 2 s, hold 4 s, pose -3 58 2 deg in 2 s, "
                    "hold 4 s, pose 3 2 -2 deg in 2 s]}\n");
    simulate("two.yaml", 3);
    check_says("$I calibrate poses.csv -o none.yaml " POSES, 1, err, "poses, 6 or more are needed");
    assert_int_equal(run("test -e none.yaml"), 1);
    sweep();
}

/* Turned about the vertical only; and a full scale that gravity exceeds. */
static void one_attitude_to_gravity(void **state)
{
    (void)state;
    put_unit(1, 1, 0);
    put("yaw.yaml", "imukit_motion: 1\nsteps:\n  - repeat: {times: 12, steps: [hold 4 s, rotate z "
                    "30 deg at 20 deg/s]}\nthen: hold\n");
    assert_int_equal(run("$I simulate unit.yaml --motion yaw.yaml --rate 100Hz --duration 64s -o "
                         "poses.csv"),
                     0);
    check_says("$I calibrate poses.csv " POSES, 1, err,
               "rests have the same attitude to gravity: a turn about the vertical (heading)");
    write_poses(100);
    check_says("$I calibrate poses.csv --accel-range 0.9g " POSES, 1, err,
               "the full scale of accel_x is stated as 8.826 m/s^2");
    const char *line = "$I calibrate poses.csv --strict --accel-range 4g " POSES;
    assert_int_equal(run(line), 0);
    sweep();
}

/* Models whose axes are in order are not told to be named otherwise. */
static void models_as_runs(void **state)
{
    (void)state;
    put_unit(1, 1, 0);
    put_poses(24, 0, 2);
    simulate("poses.yaml", 3);
    assert_int_equal(run("$I calibrate poses.csv -o a.yaml " POSES), 0);
    simulate("poses.yaml", 4);
    assert_int_equal(run("$I calibrate poses.csv -o b.yaml " POSES), 0);
    const char *line = "$I calibrate a.yaml b.yaml -p repeatability -o runs.yaml && cat runs.yaml";
    assert_int_equal(run(line), 0);
    assert_null(strstr(err, "is axis"));
    assert_null(strstr(out, "direction:"));
    sweep();
}

#define MAGNETIC(statement)                                                                        \
    "awk -F, -v OFS=, 'NR > 1 {" statement "} 1' poses.csv >bad.csv; $I calibrate bad.csv "

/* What is said of a field that is the same, of one that is not, and of a rest beside steel; alone
 * it is readings that are counted. */
static void words_on_magnetometers(void **state)
{
    (void)state;
    static const char same[] = "the dip of the field is the same in all attitudes";
    put("unit.yaml", "imukit: 1\ngyro:\n  noise: {angle_random_walk: 0.3 deg/sqrt(h)}\n"
                     "accel:\n  noise: {velocity_random_walk: 0.05 m/s/sqrt(h)}\n"
                     "mag:\n  noise: {density: one-sided, white_noise: 40 nT/sqrt(Hz)}\n");
    put_poses(24, 0, 2);
    assert_int_equal(run("$I simulate unit.yaml --motion poses.yaml --rate 100Hz --seed 1 --field "
                         "'20 1 43 uT' -o poses.csv"),
                     0);
    const char *line = "$I calibrate poses.csv --strict " POSES;
    assert_int_equal(run(line), 0);
    check_contains(out, same, line);
    assert_null(strstr(out, "Rests left out for the magnetometer"));
    line = MAGNETIC("for (i = 8; i < 11; i++) $i += sin(7 * i * int($1 / 6))") POSES;
    assert_int_equal(run(line), 0);
    check_contains(err, "the field is not the same in all attitudes", line);
    check_contains(out, "the dip of the field is taken for the same", line);
    assert_null(strstr(out, same));
    line = MAGNETIC("if ($1 > 60 && $1 < 66) $8 += 9") POSES;
    assert_int_equal(run(line), 0);
    check_contains(err, "1 of 24 rests of the magnetometer do not fit", line);
    check_contains(out, "Rests left out for the magnetometer: at 6", line);
    if (check_quick()) { /* the rest goes the same way */
        sweep();
        return;
    }
    line = MAGNETIC("if ($1 > 60 && $1 < 64) $8 += 9") "-p magnetometer";
    assert_int_equal(run(line), 0);
    check_contains(err, "readings of the magnetometer do not fit", line);
    sweep();
}

static void gravity_of_another_place(void **state)
{
    (void)state;
    if (check_quick()) /* words alone differ */
        return;
    write_poses(100);
    check_says("$I calibrate poses.csv --gravity 9.71m/s^2 " POSES, 0, err,
               "--gravity 9.71000 m/s^2 differs by -0.99 % from gravity at --position");
    const char *line = "$I calibrate poses.csv --gravity 9.8045m/s^2 " POSES;
    assert_int_equal(run(line), 0);
    check_contains(out, "Usable: accelerometer", line);
    sweep();
}

/* A unit of K2 = 50 mg/g^2: far from what the model describes. */
static void models_that_do_not_describe_the_log(void **state)
{
    (void)state;
    write_poses(100);
    check_says(CHANGED("$7 += 0.005 * $7 * $7; $5 += 0.004 * $5 * $5"), 0, err,
               "the model does not describe this log, and the intervals hold only if the excess "
               "is random");
    sweep();
}

static void only_labelled_rests_are_holds(void **state)
{
    (void)state;
    write_poses(100);
    assert_int_equal(run("awk -F, -v OFS=, '{print $0, NR == 1 ? \"pose\" : $1 < 100 ? \"a\" : "
                         "\"\"}' poses.csv >part.csv"),
                     0);
    const char *line = "$I calibrate part.csv --section pose --poses " POSES;
    assert_int_equal(run(line), 0);
    check_contains(out, "accelerometer readings  48", line);
    assert_int_equal(run("awk -F, -v OFS=, '{print $0, NR == 1 ? \"pose\" : $1 < 30 ? \"a\" : "
                         "\"\"}' poses.csv >part.csv"),
                     0);
    check_says("$I calibrate part.csv --section pose " POSES, 1, err, "the log has 5 poses");
    sweep();
}

/* A log of one gyro, about z, on a table: its model has one axis along z, and compensates it. */
static void one_gyro_about_z(void **state)
{
    (void)state;
    put_unit(1, 1, 0);
    put("table.yaml", "imukit_motion: 1\nstart: {latitude: 48.1 deg, longitude: 11.6 deg, height: "
                      "520 m}\nsteps:\n  - hold 5 s\n  - repeat: {times: 2, steps: [rotate z at "
                      "20 deg/s for 5 s, rotate z at -20 deg/s for 5 s, rotate z at 100 deg/s for "
                      "5 s, rotate z at -100 deg/s for 5 s]}\n");
    simulate("table.yaml", 2);
    const char *line = "cut -d, -f1,4 poses.csv >z.csv; $I calibrate z.csv -p rate-table --motion "
                       "table.yaml --without nonlinearity -o z.yaml && cat z.yaml && $I compensate "
                       "z.csv z.yaml -o clean.csv";
    assert_int_equal(run(line), 0);
    check_contains(err, "gyro_z is axis x in the tables and in the model", line);
    check_contains(out, "Usable: gyro bias", line);
    check_contains(out, "direction: [0 0 1]", line);
    line = "$I evaluate z.csv --motion table.yaml";
    assert_int_equal(run(line), 0);
    check_contains(out, "gyro_z: ", line);
    sweep();
}

/* A clock that is 1 % off against the programme of a table; one that is right. */
static void clocks_are_compared_with_the_programme(void **state)
{
    (void)state;
    put_unit(1, 1, 0);
    char text[2000];
    size_t used = (size_t)snprintf(text, sizeof text,
                                   "imukit_motion: 1\nstart: {latitude: 48.1 deg, longitude: 11.6 "
                                   "deg, height: 520 m}\nsteps:\n  - hold 5 s\n");
    for (int k = 0; k < 3; k++)
        used += (size_t)snprintf(
            text + used, sizeof text - used,
            "  - repeat: {times: 1, steps: [rotate %c at 20 deg/s for 5 s, rotate %c at -20 deg/s "
            "for 5 s, rotate %c at 100 deg/s for 5 s, rotate %c at -100 deg/s for 5 s]}\n%s",
            "zxy"[k], "zxy"[k], "zxy"[k], "zxy"[k],
            k == 0   ? "  - pose 0 90 0 deg in 5 s\n  - hold 5 s\n"
            : k == 1 ? "  - pose 90 0 0 deg in 5 s\n  - hold 5 s\n"
                     : "then: hold\n");
    put("table.yaml", text);
    assert_int_equal(run("$I simulate unit.yaml --motion table.yaml --rate 100Hz --duration 90s "
                         "--seed 2 -o poses.csv"),
                     0);
    const char *line = "cut -d, -f2-4 poses.csv >bare.csv; $I calibrate bare.csv --rate 100Hz -p "
                       "rate-table --motion table.yaml --without nonlinearity";
    assert_int_equal(run(line), 0);
    check_contains(out, "Usable: gyro", line);
    check_says("$I calibrate bare.csv --rate 98Hz -p rate-table --motion table.yaml --without "
               "nonlinearity",
               0, err, "bare.csv fits the programme");
    check_says("$I calibrate bare.csv --rate 99.5Hz -p rate-table --motion table.yaml --without "
               "nonlinearity --motion-offset auto",
               0, err, "as if the sampling rate were");
    sweep();
}

/* A session on faces in counts, real: its full turns stated the other way round, a gyro inverted.
 */
static void turns_the_other_way_round(void **state)
{
    (void)state;
#define SESSION SHARED_DIRECTORY "/data/calibration/ferraris_session_204.8hz_counts.csv.gz"
#define FACES "-p ferraris --rate 204.8Hz --gravity 9.80665m/s^2"
    if (run("test -e " SESSION) != 0)
        skip();
    const char *line = "$I calibrate " SESSION " " FACES;
    assert_int_equal(run(line), 0);
    assert_null(strstr(err, "opposite sign"));
    /* It was turned by hand on a table: its faces scatter by 0.4 deg. */
    check_contains(err, "the placements scatter by 0.42 deg", line);
    check_says("$I calibrate " SESSION " " FACES " --turn-angle -360deg", 0, out,
               "all gyros read the full turns with the opposite sign");
    if (check_quick()) {
        sweep();
        return;
    }
    check_says("gzip -dc " SESSION " | awk -F, -v OFS=, 'NR > 1 {for (i = 6; i < 9; i++) $i = -$i} "
               "1' >bad.csv; $I calibrate bad.csv " FACES,
               0, err, "all gyros read the full turns with the opposite sign");
    check_says("gzip -dc " SESSION " | awk -F, -v OFS=, 'NR > 1 {$6 = -$6} 1' >bad.csv; $I "
               "calibrate bad.csv " FACES,
               0, err, "gyro_x reads the full turns with the opposite sign");
    sweep();
}

/* Grades from a consumer unit to one whose noise is a hundredth. */
static void sound_benches_are_good(void **state)
{
    (void)state;
    static const double grade[4][2] = {{2, 2}, {1, 1}, {0.1, 0.2}, {0.01, 0.02}};
    for (unsigned k = 0; k < 12; k++) {
        if (check_skips(k, 12))
            continue;
        put_unit(grade[k % 4][0], grade[k % 4][1], k);
        put_poses(18 + (int)(k * 5 % 13), 0, 1.5 + 0.25 * (k % 7));
        simulate("poses.yaml", 100 + k);
        const char *line = "$I calibrate poses.csv --strict " POSES;
        if (run(line) != 0)
            fail_msg("bench %u: %s%s", k, out, err);
        check_contains(out, "Usable: accelerometer", line);
    }
    sweep();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(wrong_rates_are_told),
        cmocka_unit_test(wrong_ranges_are_told),
        cmocka_unit_test(mendings_are_all_told),
        cmocka_unit_test(poses_that_do_not_suffice),
        cmocka_unit_test(one_attitude_to_gravity),
        cmocka_unit_test(models_as_runs),
        cmocka_unit_test(words_on_magnetometers),
        cmocka_unit_test(gravity_of_another_place),
        cmocka_unit_test(models_that_do_not_describe_the_log),
        cmocka_unit_test(only_labelled_rests_are_holds),
        cmocka_unit_test(one_gyro_about_z),
        cmocka_unit_test(clocks_are_compared_with_the_programme),
        cmocka_unit_test(turns_the_other_way_round),
        cmocka_unit_test(sound_benches_are_good),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
