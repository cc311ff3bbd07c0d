/* SPDX-License-Identifier: Apache-2.0 */
/* imukit convert with parameter files of other programs: what it says, the exit code, the next
 * command it shows, and nothing left behind. */
#include "run_command.h"

#define CORPUS "'" SOURCE_DIRECTORY "/fuzz/corpus/parameters/"

/* The formats are found by content, the model is the one expected. */
static void test_to_model(void **state)
{
    (void)state;
    put("imu.yaml", "gyroscope_noise_density: 1e-4\naccelerometer_noise_density: 0.02\n");
    check_message("$I convert imu.yaml model.yaml", 0, "");
    char text[512];
    FILE *file = fopen("model.yaml", "r");
    assert_non_null(file);
    text[fread(text, 1, sizeof text - 1, file)] = '\0';
    fclose(file);
    assert_string_equal(text, "imukit: 1\n"
                              "gyro:\n"
                              "  noise:\n"
                              "    angle_random_walk: 0.34377467707849396 deg/sqrt(h)\n"
                              "accel:\n"
                              "  noise:\n"
                              "    velocity_random_walk: 1.2 m/s/sqrt(h)\n");
    assert_int_equal(run("$I simulate model.yaml --rate 10Hz --duration 2s --seed 1 -o log.csv"),
                     0);
    check_message("$I convert imu.yaml - --from kalibr | head -1 | grep -q imukit", 0, "");
    assert_int_equal(run("$I convert - out.yaml --from kalibr < imu.yaml"), 0);
    assert_int_equal(sweep(), 4);
}

static void test_from_model(void **state)
{
    (void)state;
    put("model.yaml", "imukit: 1\nname: a unit\ngyro:\n  noise: {angle_random_walk: 0.3 "
                      "deg/sqrt(h), bias_instability: 5 deg/h}\n");
    check_message("$I convert model.yaml out.yaml --to navego --rate 200Hz", 0,
                  "imukit convert: warning: gyro.noise.bias_instability is not held by the format "
                  "navego\n");
    check_message(
        "$I convert model.yaml out.sdf --to gazebo", 1,
        "imukit convert: error: model.yaml: stddev: \"stddev\" is per sample, and the "
        "sampling rate is not known; add --rate RATE (samples per second, as 200Hz)\nNext: imukit "
        "convert model.yaml out.sdf --to gazebo --rate RATE\n");
    check_message("$I convert ADIS16465 out.m --to navego --rate 200Hz 2>/dev/null", 0, "");
    check_message(
        "$I convert model.yaml out.x --to kalibra", 2,
        "imukit convert: error: --to kalibra: expected one of "
        "model|kalibr|gazebo|matlab|gnss-ins-sim|navego|openvins|vins|px4|ardupilot|filter|"
        "lio-sam|fast-lio|dlio|glim|orb-slam3|gtsam|airsim|fusion|euroc\n" TRY("convert"));
    check_message("$I convert model.yaml /nowhere/out.yaml --to navego", 1,
                  "imukit convert: error: /nowhere/out.yaml: the folder /nowhere does not exist; "
                  "create this folder, or choose another\n");
    assert_int_equal(sweep(), 3);
}

/* A filter needs a random walk: what the message says to add is what this model has, and helps. */
static void test_missing_walk(void **state)
{
    (void)state;
    put("b.yaml", "imukit: 1\ngyro:\n  noise: {angle_random_walk: 0.3 deg/sqrt(h), "
                  "bias_instability: 5 deg/h}\n");
    check_message("$I convert b.yaml out.yaml --to kalibr --rate 200Hz", 1,
                  "imukit convert: error: b.yaml: gyro.noise.rate_random_walk: "
                  "\"rate_random_walk\" (K) is not in the model, and kalibr needs it; add "
                  "--bias-instability-tau TIME with the averaging time at which B as a walk is to "
                  "be right\n");
    assert_int_equal(access("out.yaml", F_OK), -1);
    /* Largest error of all terms together from 10 s to 1000 s: with N = 8.727e-5 rad/s/sqrt(Hz) and
     * B = 2.424e-5 rad/s the Allan variance at 1000 s is 7.62e-12 + 2.593e-10 = 2.669e-10
     * (rad/s)^2; ten times the second and the first are 2.601e-9; sqrt(2.601e-9/2.669e-10) = 3.12.
     */
    check_message(
        "$I convert b.yaml out.yaml --to kalibr --rate 200Hz --bias-instability-tau 100s", 0,
        "imukit convert: note: gyro: bias instability (B) is in the random walk, K^2 + (6 "
        "ln 2/pi) B^2/T, T = 100 s; its Allan deviation is right at T, 0.32 times B's at "
        "T/10, 3.2 times at 10 T; all terms together are off by up to 212 % (at 1000 "
        "s)\n");
    put("bound.yaml", "imukit: 1\ngyro:\n  noise: {angle_random_walk: 0.3 deg/sqrt(h)}\n  "
                      "evidence: {upper_bound: {noise.rate_random_walk: 1e-6 rad/s/sqrt(s)}}\n");
    check_message(
        "$I convert bound.yaml out.yaml --to orb-slam3 --rate 200Hz", 1,
        "imukit convert: error: bound.yaml: gyro.noise.rate_random_walk: "
        "\"rate_random_walk\" (K) is not in the model, and orb-slam3 needs it; add "
        "--use-bounds (the largest K that the data allow)\nNext: imukit convert bound.yaml "
        "out.yaml --to orb-slam3 --rate 200Hz --use-bounds\n");
    assert_int_equal(run("$I convert bound.yaml out.yaml --to orb-slam3 --rate 200Hz --use-bounds"),
                     0);
    assert_int_equal(run("grep -q '^IMU.GyroWalk: 1.0e-6' out.yaml"), 0);
    put("n.yaml", "imukit: 1\ngyro: {noise: {angle_random_walk: 0.3 deg/sqrt(h)}}\n");
    check_message("$I convert n.yaml out.yaml --to vins --rate 200Hz", 1,
                  "imukit convert: error: n.yaml: gyro.noise.rate_random_walk: "
                  "\"rate_random_walk\" (K) is not in the model, and vins needs it; nothing in the "
                  "model stands for it: add it to the model, or identify it from a longer log\n");
    /* FAST-LIO runs without, so the file is written. */
    assert_int_equal(run("$I convert n.yaml out.yaml --to fast-lio --rate 200Hz"), 0);
    check_contains(err, "warning: gyro: the model has no random walk (K)", "fast-lio");
    assert_int_equal(sweep(), 4);
}

/* Options where they have no use. */
static void test_walk_options(void **state)
{
    (void)state;
    static const struct {
        const char *options, *says;
        int code;
    } wrong[] = {
        {"o.yaml --to gazebo --rate 100Hz --use-bounds",
         "the format gazebo has no random walk; "
         "leave --use-bounds out",
         1},
        {"o.yaml --to dlio --bias-instability-tau 10s", "leave --bias-instability-tau out", 1},
        {"o.json --to matlab --bias-instability-tau 10s", "has bias instability itself", 1},
        {"o.yaml --to filter --rate 1Hz --bias-instability-tau 10s", "--flicker, --tau-from", 1},
        {"o.yaml --from kalibr --use-bounds", "state the format with --to", 2},
        {"o.yaml --to kalibr --bias-instability-tau 1e9s", "--bias-instability-tau", 2},
        {"o.yaml --to kalibr --frame-rate 10Hz", "--frame-rate is for the format glim", 2},
        {"o.json --to glim", "add --frame-rate RATE", 1},
        {"o.yaml --to fast-lio", "add --rate RATE", 1},
        {"o.yaml --to orb-slam3", "add --rate RATE", 1},
    };
    char line[300];
    put("imu.yaml", "gyroscope_noise_density: 1e-4\ngyroscope_random_walk: 1e-6\n"
                    "accelerometer_noise_density: 0.02\naccelerometer_random_walk: 1e-5\n");
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        if (check_skips(i, 3))
            continue;
        snprintf(line, sizeof line, "$I convert imu.yaml %s", wrong[i].options);
        assert_int_equal(run(line), wrong[i].code);
        check_contains(err, wrong[i].says, wrong[i].options);
    }
    assert_int_equal(run("$I convert imu.yaml o.yaml --to lio-sam --use-bounds "
                         "--bias-instability-tau 10s"),
                     0);
    check_contains(err, "--use-bounds changes nothing", "bounds");
    check_contains(err, "--bias-instability-tau changes nothing", "tau");
    assert_int_equal(sweep(), 2);
}

static void test_refused(void **state)
{
    (void)state;
    check_message("$I convert " CORPUS "vins.yaml' out.yaml | cat", 0,
                  "imukit convert: error: " SOURCE_DIRECTORY
                  "/fuzz/corpus/parameters/vins.yaml: acc_n: \"acc_n\" and the others are per "
                  "sample or per sqrt(Hz): the file does not say which; add --rate RATE (samples "
                  "per second, if the "
                  "numbers are per sample, as VINS takes them; if they are densities, add "
                  "--density two-sided)\nNext: imukit convert " SOURCE_DIRECTORY
                  "/fuzz/corpus/parameters/vins.yaml out.yaml --rate RATE\n");
    put("deg.yaml", "gyroscope_noise_density: 0.3\n");
    check_message(
        "$I convert deg.yaml out.yaml", 1,
        "imukit convert: error: deg.yaml:1:26: gyroscope_noise_density: \"0.3\" cannot be "
        "in rad/s/sqrt(Hz), it looks like deg/sqrt(h); this format uses rad/s/sqrt(Hz): "
        "write 8.72665e-05, or correct the value if it is wrong\n");
    put("two.yaml", "imu0: {gyroscope_noise_density: 1e-4}\nimu1: {gyroscope_noise_density: "
                    "2e-4}\n");
    assert_int_equal(run("$I convert two.yaml out.yaml"), 1);
    check_contains(err, "add --sensor NAME with one of imu0, imu1", "two.yaml");
    put("world.sdf", "<sdf version='1.6'></sdf>\n"); /* is no log, though no IMU is in it */
    assert_int_equal(run("$I convert world.sdf out.yaml"), 1);
    check_contains(err, "world.sdf: the file format is not recognised; expected a parameter file",
                   "world.sdf");
    check_contains(err, "(name the format with --from)", "world.sdf");
    check_message("$I convert missing.sdf out.yaml", 1,
                  "imukit convert: error: missing.sdf: the file cannot be opened: No such file or "
                  "directory; check the path\n");
    put("log.csv", "time [s],gyro_x [deg/s]\n0,1\n0.1,2\n");
    assert_int_equal(run("$I convert log.csv out.csv --sensor a"), 2);
    check_contains(err, "are for parameter files", "log.csv");
    assert_int_equal(run("$I convert log.csv out.csv --to euroc --select time"), 2);
    check_contains(err, "--to euroc has its columns and units", "log.csv");
    assert_int_equal(run("$I convert log.csv out.csv --to euroc"), 1);
    check_contains(err,
                   "has a time, three gyros and three accelerometers, and the log lacks a gyro",
                   "log.csv");
    put("log.csv",
        "time [s],gyro_x [rad/s],gyro_y [rad/s],gyro_z [rad/s],accel_x [m/s^2],accel_y "
        "[m/s^2],accel_z [m/s^2],temperature [degC]\n0,1,2,3,4,5,6,20\n1,1,2,3,4,5,6,20\n");
    assert_int_equal(run("$I convert log.csv - --to euroc"), 0);
    check_contains(err, "the EuRoC format has no place for temperature: left out", "log.csv");
    check_contains(out, "\n1000000000,1,2,3,4,5,6\n", "log.csv");
    put("unit.yaml", "imukit: 1\n");
    assert_int_equal(run("$I convert unit.yaml out.yaml --to euroc && rm unit.yaml"), 2);
    check_contains(err, "--to euroc is for logs, and unit.yaml is a model", "unit.yaml");
    assert_int_equal(run("rm unit.yaml"), 0);
    assert_int_equal(run("$I convert deg.yaml - --from kalibr --json"), 2);
    assert_int_equal(access("out.yaml", F_OK), -1);
    assert_int_equal(sweep(), 4);
}

/* Stamps keep their epoch where the format has stamps, to the nanosecond; elsewhere it is told that
 * they do not. */
static void test_epoch(void **state)
{
    (void)state;
    static const char *const formats[] = {"csv", "bag", "mcap", "db3"};
    put("data.csv", "#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],"
                    "a_RS_S_x [m s^-2],a_RS_S_y [m s^-2],a_RS_S_z [m s^-2]\n"
                    "1403636579758555393,1,2,3,4,5,6\n1403636579763555393,2,3,4,5,6,7\n"
                    "1403636579768555396,3,4,5,6,7,8\n");
    for (size_t i = 0; i < sizeof formats / sizeof formats[0]; i++) {
        char line[200];
        snprintf(line, sizeof line,
                 "$I convert data.csv a.%s %s && $I convert a.%s b.csv --to euroc && "
                 "cmp data.csv b.csv",
                 formats[i], i == 0 ? "--to euroc" : "", formats[i]);
        assert_int_equal(run(line), 0);
        assert_string_equal(err, "");
    }
    /* Beyond the whole numbers of a double, and short of those of today. */
    assert_int_equal(
        run("sed 's/^1403636579/9007199/' data.csv >small.csv && grep -c '^9007199' "
            "small.csv && $I convert small.csv b.csv --to euroc && cmp small.csv b.csv "
            "&& rm small.csv"),
        0);
    assert_int_equal(run("$I convert data.csv c.csv"), 0);
    check_contains(err, "the times count from 1403636579.759 s, which is 0 in what is written",
                   "note");
    assert_int_equal(sweep(), 7);
}

/* --sensor chooses among several; where there is one only it was meant for another file. */
static void test_sensor_of_one(void **state)
{
    (void)state;
    put("dev.yaml", "imukit: 1\ngyro: {noise: {angle_random_walk: 0.3 deg/sqrt(h)}}\n");
    check_message("$I convert dev.yaml gnss.yaml --to gnss-ins-sim --rate 100Hz --sensor a", 2,
                  "imukit convert: error: --sensor is for a parameter file with several sensors, "
                  "and dev.yaml is a model\n" TRY("convert"));
    assert_int_equal(run("$I convert dev.yaml gnss.yaml --to gnss-ins-sim --rate 100Hz"), 0);
    check_message(
        "$I convert gnss.yaml back.yaml --sensor a", 1,
        "imukit convert: error: gnss.yaml: sensor: the format gnss-ins-sim has one sensor "
        "only; leave --sensor out\n");
    assert_int_equal(sweep(), 2);
}

/* Every sample becomes a model, and from the model a file that becomes the same model: the second
 * file is the first, byte for byte, where no products of matrices are rounded in between. */
static void test_round_trip(void **state)
{
    (void)state;
    static const struct {
        const char *file, *format, *options;
        bool exact;
    } samples[] = {{"kalibr.yaml", "kalibr", "", false},
                   {"gazebo_old.sdf", "gazebo", "--rate 100Hz", true},
                   {"matlab.json", "matlab", "", false},
                   {"gnss_ins_sim.json", "gnss-ins-sim", "--rate 100Hz", true},
                   {"navego.m", "navego", "", true},
                   {"openvins.yaml", "openvins", "", false},
                   {"px4.params", "px4", "", true},
                   {"vins.yaml", "vins", "--density two-sided", true},
                   {"lio_sam.yaml", "lio-sam", "", true},
                   {"fast_lio.yaml", "fast-lio", "--rate 200Hz", false},
                   {"dlio.yaml", "dlio", "", false},
                   {"glim.json", "glim", "--frame-rate 10Hz", false},
                   {"orb_slam3.yaml", "orb-slam3", "--rate 200Hz", true},
                   {"gtsam.txt", "gtsam", "", false},
                   {"airsim.json", "airsim", "", false},
                   {"fusion.txt", "fusion", "", false}};
    char line[1500];
    for (size_t i = 0; i < sizeof samples / sizeof samples[0]; i++) {
        if (check_skips(i, 2))
            continue;
        const char *format = samples[i].format, *options = samples[i].options;
        snprintf(line, sizeof line,
                 "$I convert " CORPUS "%s' a.yaml %s 2>/dev/null && "
                 "$I convert a.yaml b --to %s %s 2>/dev/null && "
                 "$I convert b c.yaml --from %s %s 2>/dev/null && "
                 "$I convert c.yaml d --to %s %s 2>/dev/null && %s",
                 samples[i].file, options, format, options, format, options, format, options,
                 samples[i].exact ? "cmp b d" : "test -s d");
        if (run(line) != 0) {
            print_error("%s\n%s%s", line, out, err);
            fail();
        }
        sweep();
    }
}

static void test_json(void **state)
{
    (void)state;
    json_error_t error;
    assert_int_equal(
        run("$I convert " CORPUS "gnss_ins_sim.json' out.yaml --rate 100Hz --json 2>/dev/null"), 0);
    json_t *root = json_loads(out, 0, &error);
    assert_non_null(root);
    json_t *result = json_object_get(root, "result");
    assert_string_equal(json_string_value(json_object_get(result, "format")), "model");
    assert_string_equal(
        json_string_value(json_object_get(json_object_get(root, "inputs"), "format")),
        "gnss-ins-sim");
    json_t *findings = json_object_get(root, "findings");
    bool assumed = false, lost = false;
    for (size_t i = 0; i < json_array_size(findings); i++) {
        const char *code = json_string_value(json_object_get(json_array_get(findings, i), "code"));
        assumed = assumed || strcmp(code, "assumed") == 0;
        lost = lost || strcmp(code, "lost") == 0;
    }
    assert_true(assumed && lost);
    json_decref(root);
    sweep();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_to_model),      cmocka_unit_test(test_from_model),
        cmocka_unit_test(test_refused),       cmocka_unit_test(test_round_trip),
        cmocka_unit_test(test_json),          cmocka_unit_test(test_epoch),
        cmocka_unit_test(test_sensor_of_one), cmocka_unit_test(test_missing_walk),
        cmocka_unit_test(test_walk_options),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
