/* SPDX-License-Identifier: Apache-2.0 */
/* imukit compensate, and the motion options of imukit convert: exact output, refusals, and the
 * loop simulate -> compensate. */
#include "run_command.h"

static const char counts_model[] =
    "imukit: 1\nname: counts\n"
    "gyro:\n"
    "  sensitivity: 100 count/(rad/s)\n"
    "  zero_offset: 512 count\n"
    "  bias: {fixed: 0.25 rad/s, temperature: {reference_temperature: 300 K,"
    " valid_range: 250 350 K, coefficients: [0.01 rad/s/K]}, hysteresis: 0.01 rad/s}\n"
    "  range: 4 rad/s\n"
    "accel: {bias: {fixed: 0.5 m/s^2}, scale_factor: {fixed: 100 %}}\n";

/* (612 - 512)/100 - 0.25 - 0.01 (310 - 300) = 0.65 rad/s; (2.5 - 0.5)/2 = 1 m/s^2. */
static const char counts_log[] =
    "time [s],gyro_x [count],gyro_y [count],gyro_z [count],accel_x [m/s^2],accel_y [m/s^2],"
    "accel_z [m/s^2],mode,temperature [K]\n"
    "0,612,512,512,2.5,0.5,0.5,still,310\n"
    "1,912,512,512,2.5,0.5,0.5,still,310\n"
    "2,612,,512,2.5,0.5,0.5,moves,310\n"
    "5,612,512,512,2.5,0.5,0.5,moves,360\n";

static void test_every_column(void **state)
{
    (void)state;
    put("unit.yaml", counts_model);
    put("log.csv", counts_log);
    check_message(
        "$I compensate log.csv unit.yaml --flags --decimals 3 -o out.csv", 0,
        "imukit compensate: warning: saturated, at or beyond the range of an axis: 1 of 4 samples "
        "(first: row 2)\nimukit compensate: warning: temperature outside the valid range of the "
        "model's terms, so the nearer end of the range was used: 1 of 4 samples (first: row "
        "4)\nimukit compensate: warning: readings that are not finite, or no temperature yet; "
        "values that depend on these are nan: 1 of 4 samples (first: row 3)\nimukit compensate: "
        "warning: gaps and steps back in time: 1 (first: row 4); each begins a new stretch\nUsable "
        "with care: 3 of 4 samples are flagged, 1 saturated, 1 outside the temperatures of the "
        "model, 1 with a reading that is not finite; gaps and steps back in time; 5 terms are "
        "taken out, and 1 stay in.\n\nTaken "
        "out: gyro.bias.fixed, gyro.bias.temperature, gyro.sensitivity, accel.bias.fixed, "
        "accel.scale_factor.fixed\nLeft in: gyro.bias.hysteresis\n4 samples, 3 flagged\n");
    assert_string_equal(out, "");
    assert_int_equal(run("cat out.csv"), 0);
    assert_string_equal(out,
                        "time [s],gyro_x [rad/s],gyro_y [rad/s],gyro_z [rad/s],accel_x [m/s^2],"
                        "accel_y [m/s^2],accel_z [m/s^2],mode,temperature [K],flags\n"
                        "0.000,0.650,-0.350,-0.350,1.000,0.000,0.000,still,310.000,0\n"
                        "1.000,3.650,-0.350,-0.350,1.000,0.000,0.000,still,310.000,1\n"
                        "2.000,nan,nan,nan,1.000,0.000,0.000,moves,310.000,8\n"
                        "5.000,0.250,-0.750,-0.750,1.000,0.000,0.000,moves,360.000,2\n");
    /* Units, and a temperature that overrules the column. */
    assert_int_equal(run("$I compensate log.csv unit.yaml --to-gyro-unit deg/s --to-accel-unit mg "
                         "--temperature 300K --decimals 2 | head -2"),
                     0);
    check_contains(out, "gyro_x [deg/s]", "unit");
    /* 0.75 rad/s, -0.25 rad/s; 1 m/s^2 */
    check_contains(out, "\n0.00,42.97,-14.32,-14.32,101.97,0.00,0.00,still,310.00\n", "values");
    assert_int_equal(run("$I compensate log.csv unit.yaml --strict -o out.csv"), 1);
    sweep();
}

static void test_refusals(void **state)
{
    (void)state;
    put("unit.yaml", counts_model);
    put("log.csv", counts_log);
    put("rates.yaml", "imukit: 1\ngyro: {bias: {fixed: 1 deg/s}}\n");
    put("arms.yaml", "imukit: 1\ngyro: {}\naccel: {lever_arm: [1 0 0 mm, 0 0 0 mm, 0 0 0 mm]}\n");
    put("left.yaml", "imukit: 1\nresidual_of: first.yaml\ngyro: {noise: {angle_random_walk: 1 "
                     "deg/sqrt(h)}}\n");
    put("folded.yaml", "imukit: 1\ngyro: {nonlinearity: {k2: -1 1/(rad/s)}, range: 10 rad/s}\n");
    put("k2.yaml", "imukit: 1\ngyro: {nonlinearity: {k2: 1e-3 1/(rad/s)}}\n");
    put("gyro.csv", "time [s],gyro_x [deg/s],gyro_y [deg/s],gyro_z [deg/s]\n0,1,1,1\n1,1,1,1\n");
    put("two.csv", "time [s],gyro_x [deg/s],gyro_y [deg/s]\n0,1,1\n1,1,1\n");
    put("accel.csv", "time [s],accel_x [g],accel_y [g],accel_z [g]\n0,1,1,1\n1,1,1,1\n");
    check_message(
        "cut -d, -f1-7 log.csv | $I compensate - unit.yaml", 1,
        "imukit compensate: error: unit.yaml depends on temperature (gyro.bias.temperature), but - "
        "has no temperature column; add --temperature 25degC\n");
    check_message("$I compensate gyro.csv unit.yaml", 1,
                  "imukit compensate: error: gyro.csv: gyro_x is in deg/s, but unit.yaml describes "
                  "readings in counts (gyro.sensitivity)\n");
    check_message("$I compensate log.csv rates.yaml", 1,
                  "imukit compensate: error: log.csv: gyro_x is in counts, but rates.yaml does not "
                  "say what a count is: add gyro.sensitivity to it\n");
    check_message("$I compensate two.csv rates.yaml", 1,
                  "imukit compensate: error: two.csv has no column gyro_z: rates.yaml describes 3 "
                  "gyro axes, and all of them are needed\n");
    check_message("$I compensate accel.csv arms.yaml", 1,
                  "imukit compensate: error: accel.csv has no gyro columns, which accel.lever_arm "
                  "of arms.yaml needs\n");
    check_message("$I compensate accel.csv rates.yaml", 1,
                  "imukit compensate: warning: rates.yaml describes no accelerometers: the "
                  "columns are copied as they are\nimukit compensate: error: rates.yaml describes "
                  "none of the sensors in accel.csv\n");
    check_message("$I compensate log.csv unit.yaml --axes right-forward-up", 2,
                  "imukit compensate: error: --axes changes signs, and counts have a zero offset; "
                  "compensate first, then use imukit convert --axes\n" TRY("compensate"));
    check_message("$I compensate gyro.csv rates.yaml --json", 2,
                  "imukit compensate: error: --json and the log cannot both go to standard output: "
                  "add -o LOG\n" TRY("compensate"));
    check_message("$I compensate gyro.csv k2.yaml -o x.csv", 1,
                  "imukit compensate: error: k2.yaml: gyro.range is missing, and the correction "
                  "needs a limit; state gyro.range in the model, or add --rate-limit 500deg/s or "
                  "--force-limit 10g\n");
    assert_int_equal(run("$I compensate gyro.csv k2.yaml --rate-limit 500deg/s -o k2.csv"), 0);
    /* A model whose output turns back within its range cannot be undone. */
    assert_int_equal(run("$I compensate gyro.csv folded.yaml -o x.csv"), 1);
    check_contains(err, "nonlinearity", "what cannot be undone is named");
    assert_int_not_equal(access("x.csv", F_OK), 0);
    check_message("$I compensate gyro.csv left.yaml -o left.csv", 0,
                  "imukit compensate: warning: left.yaml describes the errors that remain after "
                  "compensation with first.yaml; compensate with that model first\nimukit "
                  "compensate: warning: left.yaml has no deterministic term: there is nothing to "
                  "take out\nNot usable: the model describes the errors that remain after "
                  "compensation with first.yaml; the model has no deterministic term; 0 terms are "
                  "taken out, and 1 stay in.\n\n"
                  "Taken out: nothing\nLeft in: gyro.noise\n2 samples, 0 flagged\n");
    assert_int_equal(run("cmp gyro.csv left.csv"), 0);
    sweep();
}

/* What simulate puts in, compensate takes out, and the rest of the log is left as it was. The log
 * is longer than a block of the program (65536 rows), so rows are carried over. */
static void test_loop(void **state)
{
    (void)state;
    put("unit.yaml", "imukit: 1\n"
                     "gyro: {bias: {fixed: 1 -2 0.5 deg/s}, scale_factor: {fixed: 1000 ppm}, "
                     "misalignment: 2 mrad, g_sensitivity: [1 0 0 deg/h/g, 0 1 0 deg/h/g, 0 0 1 "
                     "deg/h/g], range: 300 deg/s}\n"
                     "accel: {bias: {fixed: 5 mg}, lever_arm: [10 0 0 mm, 0 20 0 mm, 0 0 0 mm]}\n");
    put("perfect.yaml", "imukit: 1\ngyro: {}\naccel: {}\n");
    setenv("A", "--rate 100Hz --duration 700s --decimals 17 --gyro-unit rad/s", 1);
    assert_int_equal(run("$I simulate unit.yaml $A -o raw.csv && $I simulate perfect.yaml $A -o "
                         "truth.csv"),
                     0);
    assert_int_equal(run("$I compensate raw.csv unit.yaml --decimals 12 -o clean.csv"), 0);
    check_contains(err, "70000 samples, 0 flagged\n", "count");
    assert_int_equal(
        run("cut -d, -f2- clean.csv | sed 1d | sort -u | wc -l; wc -l <clean.csv; cut "
            "-d, -f1 clean.csv | cksum; $I convert truth.csv --decimals 12 - | cut -d, "
            "-f1 | cksum"),
        0);
    unsigned different, lines, sums[4];
    assert_int_equal(sscanf(out, "%u %u %u %u %u %u", &different, &lines, &sums[0], &sums[1],
                            &sums[2], &sums[3]),
                     6);
    assert_int_equal(lines, 70001);
    assert_int_equal(sums[0], sums[2]);
    /* At rest every row is the same; 12 decimals hide the last places. */
    assert_in_range(different, 1, 2);
    assert_int_equal(run("sed -n 40000p clean.csv; sed -n 40000p truth.csv"), 0);
    double value[2][7];
    char *line[2] = {out, strchr(out, '\n') + 1};
    for (int i = 0; i < 2; i++)
        for (int k = 0; k < 7; k++)
            value[i][k] = strtod(line[i], &line[i]), line[i]++;
    for (int k = 0; k < 7; k++) /* half a unit of the last decimal, and the log's rounding */
        CHECK_CLOSE(value[0][k], value[1][k], 2e-12);
    /* The same bytes by another way through the program. */
    assert_int_equal(run("gzip -c raw.csv | $I compensate - unit.yaml --threads 1 --decimals 12 | "
                         "cmp - clean.csv"),
                     0);
    assert_int_equal(run("$I compensate raw.csv unit.yaml -o x.npy --json | grep -A1 stretches"),
                     0);
    check_contains(out, "\"stretches\": 1", "json");
    sweep();
}

/* Numbers of a CSV, row after row. */
static size_t read_numbers(const char *path, double *values, size_t size)
{
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    size_t count = 0;
    int c = 0;
    while (c != '\n' && c != EOF)
        c = fgetc(file);
    while (count < size && fscanf(file, "%lf%*c", &values[count]) == 1)
        count++;
    fclose(file);
    return count;
}

/* A unit that swings by 20 deg at 1 Hz: the third derivative of its rate is 20 deg (2 pi)^4 at
 * most, so the forces err by dt^2/6 of it times a lever arm of 20 mm, the scale factor apart. The
 * rates do not err. Growing and dying away, the swing is a little sharper: a tenth more is allowed.
 */
static void test_moving_loop(void **state)
{
    (void)state;
    enum { SIZE = 30000 };
    static double truth[SIZE], clean[SIZE];
    put("ride.yaml", "imukit_motion: 1\nstart: {latitude: 47 deg, height: 600 m}\nsteps:\n"
                     "  - hold 2 s\n  - swing x 20 deg at 1 Hz for 10 s\n"
                     "  - accelerate to 10 m/s at 2 m/s^2\n  - turn right 90 deg at 15 deg/s\n"
                     "  - stop at 3 m/s^2\n");
    put("perfect.yaml", "imukit: 1\ngyro: {}\naccel: {}\n");
    put("unit.yaml",
        "imukit: 1\n"
        "gyro: {bias: {fixed: 1 -2 0.5 deg/s, temperature: {reference_temperature: 25 degC, "
        "valid_range: -40 85 degC, coefficients: [2e-3 deg/s/K]}}, misalignment: 2 mrad, "
        "nonlinearity: {k2: 10 ppm/(deg/s)}, range: 300 deg/s}\n"
        "accel: {bias: {fixed: 5 mg}, scale_factor: {fixed: 0.1 %}, "
        "lever_arm: [0 20 0 mm, 0 0 20 mm, 0 20 0 mm], range: 10 g}\n");
    setenv("A", "--motion ride.yaml --rate 100Hz --gyro-unit rad/s --decimals 17", 1);
    assert_int_equal(run("$I simulate perfect.yaml $A -o truth.csv && $I simulate unit.yaml $A "
                         "--temperature 40degC -o raw.csv && $I compensate raw.csv unit.yaml -o "
                         "- | cut -d, -f1-7 >clean.csv"),
                     0);
    size_t count = read_numbers("truth.csv", truth, SIZE);
    assert_true(count > 7 * 2000 && count < SIZE);
    assert_int_equal(read_numbers("clean.csv", clean, SIZE), count);
    const double swing = 20 * 3.14159265358979 / 180 * pow(2 * 3.14159265358979, 4);
    const double bound = 1.01 * 0.01 * 0.01 / 6 * swing * 0.020;
    double largest = 0;
    for (size_t i = 0; i < count; i++) {
        const bool force = i % 7 > 3, steady = i >= 7 * 500 && i < 7 * 900;
        CHECK_CLOSE(clean[i], truth[i], force ? (steady ? 1 : 2) * bound : 1e-12);
        largest = force && steady ? fmax(largest, fabs(clean[i] - truth[i])) : largest;
    }
    assert_true(largest > bound / 2); /* the bound is sharp */
    sweep();
}

/* ---- convert --------------------------------------------------------------------------------- */

/* Rotation about z at 2 rad/s, gravity on z: at (0.1, 0, 0) the force is w x (w x r) = -0.4 m/s^2
 * along x; while the rate grows by 1 rad/s^2, alpha x r is 0.1 along y. */
static void test_to_point(void **state)
{
    (void)state;
    put("log.csv", "time [s],gyro_x [rad/s],gyro_y [rad/s],gyro_z [rad/s],accel_x [m/s^2],"
                   "accel_y [m/s^2],accel_z [m/s^2],note\n"
                   "0,0,0,2,0,0,-10,a\n1,0,0,2,0,0,-10,b\n2,0,0,2,0,0,-10,c\n3,0,0,3,0,0,-10,d\n"
                   "4,0,0,4,0,0,-10,e\n");
    assert_int_equal(run("$I convert log.csv - --to-point '0.1 0 0 m' --decimals 2"), 0);
    assert_string_equal(out, "time [s],gyro_x [rad/s],gyro_y [rad/s],gyro_z [rad/s],"
                             "accel_x [m/s^2],accel_y [m/s^2],accel_z [m/s^2],note\n"
                             "0.00,0.00,0.00,2.00,-0.40,0.00,-10.00,a\n"
                             "1.00,0.00,0.00,2.00,-0.40,0.00,-10.00,b\n"
                             "2.00,0.00,0.00,2.00,-0.40,0.05,-10.00,c\n"
                             "3.00,0.00,0.00,3.00,-0.90,0.10,-10.00,d\n"
                             "4.00,0.00,0.00,4.00,-1.60,0.10,-10.00,e\n");
    assert_string_equal(err, "");
    check_message("$I convert log.csv - --to-point 0.1m", 2,
                  "imukit convert: error: --to-point 0.1m: expected three lengths with their unit, "
                  "such as \"0.1 0 -0.05 m\"\n" TRY("convert"));
    check_message("cut -d, -f1-6 log.csv | $I convert - - --to-point '1 0 0 m'", 1,
                  "imukit convert: error: - has no column accel_z, which --to-point needs\n");
    sweep();
}

/* A perfect unit at rest and tilted has no acceleration; the Earth turns with it. */
static void test_gravity_free(void **state)
{
    (void)state;
    put("perfect.yaml", "imukit: 1\ngyro: {}\naccel: {}\n");
    assert_int_equal(run("$I simulate perfect.yaml --rate 10Hz --duration 2000s --latitude 60deg "
                         "--height 100m --roll 20deg --pitch -30deg --yaw 50deg -o tilted.csv"),
                     0);
    assert_int_equal(run("$I convert tilted.csv free.csv --gravity-free --latitude 60deg --height "
                         "100m --yaw 50deg --decimals 9"),
                     0);
    check_contains(err, "attitude comes from the gyros alone", "drift");
    /* 9 decimals; every row within one of them. */
    assert_int_equal(run("cut -d, -f5-7 free.csv | sed 1d | tr , '\\n' | sort -u"), 0);
    for (const char *line = out; *line; line = strchr(line, '\n') + 1)
        CHECK_CLOSE(strtod(line, NULL), 0, 1e-9);
    check_message("$I convert tilted.csv - --gravity-free", 2,
                  "imukit convert: error: --gravity-free: gravity depends on the place; add "
                  "--latitude 45deg and, away from sea level, --height 500m\n" TRY("convert"));
    sweep();
}

/* Rows without a time are told; the others are where their times say. */
static void test_missing_times(void **state)
{
    (void)state;
    put("unit.yaml", "imukit: 1\ngyro:\n  bias: {fixed: 1 2 3 deg/s}\n");
    static const char *const values[] = {"nan", "inf", ""};
    char line[300];
    assert_int_equal(run("$I simulate unit.yaml --rate 100Hz -d 10s -o good.csv"), 0);
    for (size_t i = 0; i < sizeof values / sizeof values[0]; i++) {
        snprintf(line, sizeof line,
                 "awk -F, -v OFS=, 'NR==9 || NR==12 {$1=\"%s\"} 1' good.csv >log.csv; "
                 "$I compensate log.csv unit.yaml -o out.csv",
                 values[i]);
        assert_int_equal(run(line), 0);
        check_contains(err, "the time is not finite: 2 of 1000 samples (first: row 8)", line);
        assert_null(strstr(err, "gaps"));
    }
    assert_int_equal(run("$I compensate good.csv unit.yaml -o out.csv"), 0);
    assert_null(strstr(err, "the time"));
    sweep();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_column), cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_loop),         cmocka_unit_test(test_moving_loop),
        cmocka_unit_test(test_to_point),     cmocka_unit_test(test_gravity_free),
        cmocka_unit_test(test_missing_times)};
    return cmocka_run_group_tests_name("compensate command", tests, set_up, tear_down);
}
