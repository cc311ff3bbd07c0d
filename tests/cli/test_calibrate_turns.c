/* SPDX-License-Identifier: Apache-2.0 */
/* imukit calibrate --procedure turns: a real session without its accelerometers against its
 * published matrices, what is shown, and what is answered to logs and options that are wrong. */
#include "run_command.h"

#include "imukit/model_file.h"

#define SESSION SHARED_DIRECTORY "/data/calibration/ferraris_session_204.8hz_counts.csv.gz"
#define EXPECTED SHARED_DIRECTORY "/data/reference/ferraris_session_expected.json"

static double number(const json_t *all, const char *key, int row, int column)
{
    const json_t *item =
        json_array_get(json_array_get(json_object_get(all, key), (size_t)row), (size_t)column);
    assert_true(json_is_number(item));
    return json_number_value(item);
}

/* The gyros' counts per unit of a session of six faces and three turns by 360 deg, of which only
 * the gyros are left, are those of another program that had all of it, but for the sign, which
 * turns whose labels state no direction do not tell. The rests around a turn are other faces: a
 * g-sensitivity of 0.018 count/(m/s^2) at 9.81 m/s^2 is 2e-4 of 950 count/(rad/s) at 0.9 rad/s. */
static void session_without_accelerometers(void **state)
{
    (void)state;
    if (access(SESSION, R_OK) != 0 || access(EXPECTED, R_OK) != 0) {
        print_message("[ SKIPPED ] %s is not there\n", SESSION);
        skip();
    }
    assert_int_equal(run("zcat " SESSION " | cut -d, -f1,2,6-8 >gyros.csv"), 0);
    assert_int_equal(run("$I calibrate gyros.csv -p turns --rate 204.8Hz -o found.yaml"), 0);
    check_contains(out, "no turn is repeated", "turns");
    json_t *due = json_load_file(EXPECTED, 0, NULL);
    assert_non_null(due);
    imk_model model;
    imk_error error;
    assert_int_equal(imk_model_read("found.yaml", &model, NULL, &error), IMK_OK);
    for (int i = 0; i < 3; i++) {
        const imk_triad *gyro = &model.gyro;
        const double per_degree = gyro->sensitivity.value[i] *
                                  (1 + gyro->scale_factor.fixed.value[i]) * 0.017453292519943295;
        CHECK_RELATIVE(per_degree, -number(due, "K_g", i, i) * number(due, "R_g", i, i), 4e-4);
    }
    json_decref(due);
    sweep();
}

/* Three axes, forth and back; `second` is the first turn back. */
static void write_turns(const char *second, bool accelerometers)
{
    char motion[1200];
    put("unit.yaml", accelerometers
                         ? "imukit: 1\ngyro:\n  scale_factor: {fixed: 8000 -5000 3000 ppm}\n"
                           "  noise: {angle_random_walk: 0.3 deg/sqrt(h)}\n"
                           "accel:\n  noise: {velocity_random_walk: 0.05 m/s/sqrt(h)}\n"
                         : "imukit: 1\ngyro:\n  scale_factor: {fixed: 8000 -5000 3000 ppm}\n"
                           "  noise: {angle_random_walk: 0.3 deg/sqrt(h)}\n");
    snprintf(motion, sizeof motion,
             "imukit_motion: 1\nsteps:\n"
             "  - hold 5 s\n  - rotate z 360 deg at 90 deg/s\n  - hold 5 s\n"
             "  - rotate z %s at 90 deg/s\n  - hold 5 s\n  - pose 0 90 0 deg in 3 s\n  - hold 5 s\n"
             "  - rotate x 360 deg at 90 deg/s\n  - hold 5 s\n"
             "  - rotate x -360 deg at 90 deg/s\n  - hold 5 s\n  - pose 90 0 0 deg in 3 s\n"
             "  - hold 5 s\n  - rotate y 360 deg at 90 deg/s\n  - hold 5 s\n"
             "  - rotate y -360 deg at 90 deg/s\n  - hold 5 s\nthen: hold\n",
             second);
    put("turns.yaml", motion);
    assert_int_equal(run("$I simulate unit.yaml --motion turns.yaml --rate 100Hz --duration 90s "
                         "--seed 3 -o turns.csv"),
                     0);
}

/* Six turns in the table and in the JSON, and the scale factors simulated within four sigmas. */
static void turns_are_shown(void **state)
{
    (void)state;
    write_turns("-360 deg", false);
    const char *line = "$I calibrate turns.csv -p turns --poses --strict";
    assert_int_equal(run(line), 0);
    check_contains(out, "from [s]  length [s]  about  angle [deg]  read [deg]", line);
    check_contains(out, "y      -360         -3", line);
    check_contains(out, "turns by stated angles  6", line);
    check_contains(out, "the sign of a gyro", line);
    check_contains(out, "axes that are not quite those of the unit", line);
    check_contains(out, "Usable: gyro bias", line);
    assert_int_equal(run("$I calibrate turns.csv -p turns --json"), 0);
    json_t *all = json_loads(out, 0, NULL);
    const json_t *result = json_object_get(all, "result");
    assert_int_equal(json_array_size(json_object_get(result, "turns")), 6);
    assert_int_equal(json_array_size(json_object_get(result, "poses")), 0);
    static const double due[3] = {8e-3, -5e-3, 3e-3};
    const json_t *parameter;
    size_t k, seen = 0;
    json_array_foreach(json_object_get(result, "parameters"), k, parameter)
    {
        const char *name = json_string_value(json_object_get(parameter, "name"));
        if (strncmp(name, "gyro.scale_factor.fixed.", 24) != 0)
            continue;
        const double sigma = json_number_value(json_object_get(parameter, "sigma"));
        CHECK_CLOSE(json_number_value(json_object_get(parameter, "value")), due[name[24] - 'x'],
                    4 * sigma);
        seen++;
    }
    assert_int_equal(seen, 3);
    json_decref(all);
    sweep();
}

static void check_says(const char *line, int code, const char *message)
{
    const int actual = run(line);
    if (actual != code)
        fail_msg("%s: code %d, expected %d\n%s%s", line, actual, code, out, err);
    check_contains(strstr(out, message) ? out : err, message, line);
}

static void mistakes_are_answered(void **state)
{
    (void)state;
    write_turns("-180 deg", true);
    check_says("$I calibrate turns.csv -p turns", 0, "that at ");
    check_says("$I calibrate turns.csv -p turns", 0, "deg about z, not by 360 deg");
    check_says("$I calibrate turns.csv -p turns", 0, "turns uses the gyros only; ferraris");
    check_says("$I calibrate turns.csv -p turns --turn-angle -360deg", 2, "an angle above 0");
    check_says("$I calibrate turns.csv -p turns --turn-angle 700deg --strict", 1, "turns by 0.51");
    check_says("sed '1s#deg/s#rad/s#g' turns.csv >r.csv && $I calibrate r.csv -p turns", 1,
               "times as large as stated: the columns look like deg/s");
    check_says("head -n 400 turns.csv >rest.csv && $I calibrate rest.csv -p turns", 1,
               "turns needs at least 2 holds, found 1: turn the unit");
    check_says("$I convert turns.csv accel.csv --select time,accel_x,accel_y,accel_z && "
               "$I calibrate accel.csv -p turns",
               1, "turns needs gyros");
    sweep();
}

/* One turn of four by another angle is named and left out; of two it is not known which. */
static void wrong_turns_are_named(void **state)
{
    (void)state;
    write_turns("-350 deg", false);
    check_says("$I calibrate turns.csv -p turns --strict", 1,
               "the turns about z disagree by 10.1 deg");
    assert_null(strstr(err, "state --placement"));
    const char *more =
        "sed 's/pose 0 90 0/rotate z 360 deg at 90 deg\\/s\\n  - hold 5 s\\n  - "
        "rotate z -360 deg at 90 deg\\/s\\n  - hold 5 s\\n  - pose 0 90 0/' turns.yaml "
        ">more.yaml && $I simulate unit.yaml --motion more.yaml --rate 100Hz "
        "--duration 110s --seed 3 -o turns.csv";
    assert_int_equal(run(more), 0);
    check_says("$I calibrate turns.csv -p turns --strict", 1,
               "turn 2 about z, at 14.04 s: -350 deg recorded for -360 deg stated");
    check_contains(err, "label it \"z -350deg\"", "what to do");
    check_contains(out, "turns by stated angles  8         1", "table");
    assert_null(strstr(err, "scatter by"));
    sweep();
}

/* What a label states stands against the reading. */
static void label_against_reading(void **state)
{
    (void)state;
    write_turns("-360 deg", false);
    const char *label = "awk -F, -v OFS=, 'NR==1{print $0,\"section\";next}{print $0,$1<4?\"rest\":"
                        "$1<11?\"z -360deg\":\"still\"}' turns.csv | head -n 1400 >named.csv && "
                        "$I calibrate named.csv -p turns";
    check_says(label, 1, "gyro_z reads the full turns with the opposite sign");
    check_contains(err, "correct the signs in their labels", label);
    sweep();
}

/* A programme of turns is run and calibrated as it says. */
static void programme_of_turns(void **state)
{
    (void)state;
    write_turns("-360 deg", false);
    check_says("$I calibrate --plan unit.yaml -p turns --want 'gyro.scale_factor 300 ppm' -o "
               "programme.yaml",
               0, "--procedure turns");
    assert_int_equal(run("$I simulate unit.yaml --motion programme.yaml --rate 100Hz --duration "
                         "150s -o bench.csv"),
                     0);
    const char *line = "$I calibrate bench.csv -p turns --strict";
    assert_int_equal(run(line), 0);
    check_contains(out, "turns by stated angles  6", line);
    sweep();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(session_without_accelerometers), cmocka_unit_test(turns_are_shown),
        cmocka_unit_test(mistakes_are_answered),          cmocka_unit_test(label_against_reading),
        cmocka_unit_test(wrong_turns_are_named),          cmocka_unit_test(programme_of_turns),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
