/* SPDX-License-Identifier: Apache-2.0 */
/* imukit tune: the numbers as text, as JSON and as files of other programs; motions of each kind;
 * what a model does not state; refusals. */
#include "run_command.h"

#include <math.h>

#define SMALL " -r 50Hz --to-time 1s --windows 3"

static int make_inputs(void **state)
{
    if (set_up(state) != 0)
        return -1;
    put("turn.yaml", "imukit_motion: 1\n"
                     "steps:\n"
                     "  - hold 2 s\n"
                     "  - accelerate to 5 m/s at 2 m/s^2\n"
                     "  - turn right 90 deg at 30 deg/s\n"
                     "  - hold 1 s\n");
    put("unit.yaml", "imukit: 1\n"
                     "gyro:\n"
                     "  scale_factor: {repeatability: 1000 ppm}\n"
                     "  misalignment: 1 mrad\n"
                     "  noise: {density: two-sided, angle_random_walk: 0.3 deg/sqrt(h),\n"
                     "          rate_random_walk: 60 deg/h/sqrt(h)}\n"
                     "accel:\n"
                     "  scale_factor: {repeatability: 1000 ppm}\n"
                     "  misalignment: 1 mrad\n"
                     "  noise: {density: two-sided, velocity_random_walk: 0.06 m/s/sqrt(h),\n"
                     "          acceleration_random_walk: 300 ug/sqrt(h)}\n");
    return 0;
}

static int remove_inputs(void **state)
{
    sweep();
    return tear_down(state);
}

static json_t *answers_of(const char *line, json_t **document)
{
    json_error_t problem;
    if (run(line) != 0)
        fail_msg("%s: %s", line, err);
    *document = json_loads(out, 0, &problem);
    if (!*document)
        fail_msg("%s: %s", problem.text, out);
    return json_object_get(json_object_get(*document, "result"), "answers");
}

static double number(json_t *answer, const char *sensor, const char *key)
{
    json_t *values =
        json_object_get(json_object_get(json_object_get(answer, sensor), key), "value");
    return json_number_value(json_array_get(values, 0));
}

/* The data sheet's row has the numbers of the model, in SI: 0.3 deg/sqrt(h) and 0.06 m/s/sqrt(h)
 * over 60 sqrt(s); runs are beside all answers. */
static void test_data(void **state)
{
    (void)state;
    json_t *document;
    json_t *answers = answers_of("$I tune unit.yaml turn.yaml --json -n 5" SMALL, &document);
    json_t *stated = json_object_get(answers, "data_sheet"), *fit = json_object_get(answers, "fit");
    CHECK_RELATIVE(number(stated, "gyro", "angle_random_walk"),
                   0.3 / 60 * 3.14159265358979323846 / 180, 1e-9);
    CHECK_RELATIVE(number(stated, "accel", "velocity_random_walk"), 1e-3, 1e-9);
    CHECK_RELATIVE(
        number(json_object_get(answers, "data_sheet_x10"), "accel", "velocity_random_walk"), 1e-2,
        1e-9);
    /* What scale factors and misalignments add grows with time: it is no white noise. */
    assert_true(number(fit, "gyro", "rate_random_walk") >
                number(stated, "gyro", "rate_random_walk"));
    json_t *times = json_object_get(fit, "times");
    assert_int_equal(json_array_size(times), 7); /* 0.04 of 0.032 s, 0.06, 0.1 … 1 s */
    json_t *last = json_array_get(times, 6), *runs = json_object_get(last, "runs");
    assert_true(json_number_value(json_object_get(runs, "lower")) <
                json_number_value(json_object_get(runs, "upper")));
    double sum = 0;
    const char *name;
    json_t *share;
    json_object_foreach(json_object_get(last, "shares"), name, share) sum +=
        json_number_value(share);
    CHECK_CLOSE(sum, 1.0, 0.01);
    json_decref(document);
}

/* What is written is what is shown. */
static void test_files(void **state)
{
    (void)state;
    static char text[TEXT_SIZE];
    json_t *document;
    json_t *answers = answers_of(
        "$I tune unit.yaml turn.yaml --json --answer fit --to kalibr -o imu.yaml" SMALL, &document);
    read_text("imu.yaml", text);
    const char *at = strstr(text, "\ngyroscope_noise_density: ");
    assert_non_null(at);
    CHECK_RELATIVE(strtod(strchr(at, ':') + 1, NULL),
                   number(json_object_get(answers, "fit"), "gyro", "angle_random_walk"), 1e-9);
    check_contains(text, "update_rate: 50", "imu.yaml");
    json_decref(document);
    assert_int_equal(run("$I tune unit.yaml turn.yaml -o filter.yaml" SMALL), 0);
    check_contains(out, "Noise of the filter\n", "tune");
    check_contains(out, "accelerometer misalignment", "tune");
    assert_int_equal(run("$I grade filter.yaml"), 0);
    assert_int_equal(run("$I tune unit.yaml turn.yaml --correlation-time 300s -o gm.json" SMALL),
                     0);
    read_text("gm.json", text);
    check_contains(text, "\"correlation_time\": \"300 s\"", "gm.json");
    read_text("filter.yaml", text);
    check_contains(text, "noise of a filter, not of a sensor", "filter.yaml");
}

/* Rates and forces of perfect sensors are a motion at their own rate, beside others. */
static void test_motions(void **state)
{
    (void)state;
    assert_int_equal(run("$I simulate unit.yaml --without noise,scale_factor,misalignment -r 50Hz "
                         "-m turn.yaml -o read.csv"),
                     0);
    assert_int_equal(run("$I tune unit.yaml read.csv turn.yaml --to-time 1s --windows 3"), 0);
    check_contains(out, "unit.yaml: 6 windows, ", "tune");
    check_contains(out, " at 50 Hz\n", "tune");
    check_message("$I tune unit.yaml read.csv -r 100Hz", 2,
                  "imukit tune: error: read.csv has 50 samples a second, and --rate is another; "
                  "recorded rates and forces are taken at their own rate\n" TRY("tune"));
}

static void test_messages(void **state)
{
    (void)state;
    assert_int_equal(run("$I tune BMI270 turn.yaml" SMALL), 0);
    check_contains(err, "BMI270 does not state gyro bias instability, ", "tune");
    check_contains(err, "accelerometer misalignment", "tune");
    assert_int_equal(run("$I tune BMI270 turn.yaml --assume-class control" SMALL), 0);
    assert_null(strstr(err, "does not state"));
    check_contains(out, "assumed: gyro scale factor 1e+04 ppm (control system)\n", "tune");
    check_message("$I tune unit.yaml turn.yaml --to kalibr", 2,
                  "imukit tune: error: --to, --answer and --frame-rate are for the file of -o "
                  "FILE; add that option\n" TRY("tune"));
    check_message("$I tune unit.yaml none.yaml", 1,
                  "imukit tune: error: none.yaml: the file cannot be opened: No such file "
                  "or directory; check the path\n");
    put("gyro.yaml",
        "imukit: 1\ngyro: {scale_factor: {repeatability: 1 ppm}, misalignment: 1 mrad, "
        "noise: {angle_random_walk: 1 deg/sqrt(h)}}\n");
    check_message("$I tune gyro.yaml turn.yaml", 1,
                  "imukit tune: error: gyro.yaml has no accelerometers: a filter of attitude, "
                  "velocity and position needs gyros and accelerometers\n");
    assert_int_equal(run("$I tune unit.yaml turn.yaml --bias-time 1h" SMALL), 1);
    check_contains(err, "turn.yaml", "tune");
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_data), cmocka_unit_test(test_files),
                                       cmocka_unit_test(test_motions),
                                       cmocka_unit_test(test_messages)};
    return cmocka_run_group_tests(tests, make_inputs, remove_inputs);
}
