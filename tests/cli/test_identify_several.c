/* SPDX-License-Identifier: Apache-2.0 */
/* Several logs: runs of one sensor become one model, sensors a population; and what a record will
 * tell before it is made, and a table of Allan deviations instead of one. */
#include "run_command.h"

#include <math.h>

#define DEGREE (3.14159265358979323846 / 180)
static const double white = 0.3 * DEGREE / 60;

static const char *const texts[] = {
    "imukit: 1\nname: bench\ngyro: {noise: {angle_random_walk: 0.3 deg/sqrt(h), "
    "bias_instability: 8 deg/h}}\n",
    "imukit: 1\nname: noisy\ngyro: {noise: {angle_random_walk: 0.33 deg/sqrt(h), "
    "bias_instability: 8 deg/h}}\n"};

/* run1 … run3 of one sensor and `noisy`, with 10 % more white noise; five minutes at 100 Hz. */
static int make_logs(void **state)
{
    if (set_up(state) != 0)
        return -1;
    put("model.yaml", texts[0]);
    put("noisy.yaml", texts[1]);
    const int code =
        run("for k in 1 2 3; do $I simulate model.yaml --rate 100Hz --duration 5min --seed $k "
            "-o run$k.npy >&2 || exit 1; done; $I simulate noisy.yaml --rate 100Hz --duration 5min "
            "--seed 4 -o noisy.npy");
    if (code != 0)
        print_error("%s", err);
    return code;
}

static int drop_logs(void **state)
{
    sweep();
    return tear_down(state);
}

static json_t *identify(const char *options, int code)
{
    char line[300];
    snprintf(line, sizeof line, "$I identify --json %s", options);
    const int actual = run(line);
    if (actual != code) {
        print_error("%s\n  code %d: %s\n", line, actual, err);
        fail();
    }
    json_t *root = json_loads(out, 0, NULL);
    assert_non_null(root);
    return root;
}

static json_t *result_of(json_t *root, const char *name)
{
    return json_object_get(json_object_get(root, "result"), name);
}

static double value_of(json_t *object, const char *key)
{
    return json_number_value(json_object_get(json_object_get(object, key), "value"));
}

static json_t *term_of(json_t *channel)
{
    return json_object_get(json_object_get(channel, "terms"), "angle_random_walk");
}

static double number(json_t *object, const char *name)
{
    return json_number_value(json_object_get(object, name));
}

/* Messages of a code; the last of them in `text`. */
static size_t messages(json_t *verdict, const char *code, const char **text)
{
    size_t count = 0;
    *text = "";
    for (size_t k = 0; k < json_array_size(verdict); k++) {
        json_t *message = json_array_get(verdict, k);
        if (strcmp(json_string_value(json_object_get(message, "code")), code) == 0) {
            count++;
            *text = json_string_value(json_object_get(message, "message"));
        }
    }
    return count;
}

static void test_which(void **state)
{
    (void)state;
    check_message(
        "$I identify run1.npy run2.npy", 2,
        "imukit identify: error: 2 logs are given: add --runs when they are of one sensor "
        "(one joint model), or --devices when they are of different ones (their "
        "spread)\n" TRY("identify"));
    check_message("$I identify run1.npy --runs", 2,
                  "imukit identify: error: --runs needs two logs or more\n" TRY("identify"));
    check_message("$I identify run1.npy run2.npy --runs --devices", 2,
                  "imukit identify: error: --runs means one sensor, --devices means different "
                  "ones; leave one out\n" TRY("identify"));
    check_message("$I identify run1.npy nothing.npy --runs", 1,
                  "imukit identify: error: nothing.npy cannot be read\n");
    check_message(
        "$I identify run1.npy run2.npy --devices -o model2.yaml", 2,
        "imukit identify: error: --devices compares sensors and makes no model: leave out "
        "--output, or identify each log alone\n" TRY("identify"));
    assert_int_equal(run("$I simulate model.yaml --rate 50Hz --duration 1min -o slow.npy"), 0);
    check_message(
        "$I identify run1.npy slow.npy --runs", 1,
        "imukit identify: error: run1.npy was sampled at 100 Hz, slow.npy at 50 Hz: runs of one "
        "sensor have one sampling rate; identify them separately, or with --devices\n");
}

/* Logs at two rates part reading noise; the table, the sentence, the data and the model. */
static void test_rates(void **state)
{
    (void)state;
    put("readings.yaml", "imukit: 1\nname: readings\ngyro: {noise: {reading_noise: 2 arcsec}}\n");
    assert_int_equal(run("$I simulate readings.yaml --rate 100Hz --duration 1min --seed 1 -o "
                         "slow.npy >&2 && $I simulate readings.yaml --rate 400Hz --duration 20s "
                         "--seed 2 -o fast.npy >&2"),
                     0);
    json_t *root = identify("slow.npy fast.npy --runs -o readings2.yaml", 0);
    const char *text;
    assert_int_equal(messages(result_of(root, "verdict"), "readings_alike", &text), 1);
    check_contains(text, "reading noise, the same at each rate", "rates");
    json_t *channel = json_array_get(result_of(root, "channels"), 0);
    json_t *term = json_object_get(json_object_get(channel, "terms"), "reading_noise");
    CHECK_CLOSE(number(term, "value"), 2 * DEGREE / 3600, 6 * number(term, "sigma"));
    assert_string_equal(
        json_string_value(json_object_get(json_object_get(channel, "readings"), "kind")),
        "reading noise");
    json_decref(root);
    assert_int_equal(run("cat readings2.yaml"), 0);
    check_contains(out, "reading_noise: ", "rates");
    assert_null(strstr(out, "    angle_white"));
    assert_int_equal(run("$I identify slow.npy fast.npy --runs --truth readings.yaml"), 0);
    check_contains(out, "1 sigma of a reading [arcsec]", "rates");
    check_contains(out, "All else is that of slow.npy, the longest", "rates");
    check_contains(out, "gyro_x   reading noise  2 ", "rates");
    assert_int_equal(run("$I identify slow.npy fast.npy --devices --plot both.svg && grep -q "
                         "slow.npy both.svg && grep -q fast.npy both.svg"),
                     0);
    check_contains(out, "reading noise [arcsec]", "sensors at two rates");
    assert_int_equal(run("$I identify --plan readings.yaml --rate 100Hz --want 'reading_noise 1%'"),
                     0);
    check_contains(out, "gyro.reading_noise", "plan");
}

static void test_runs(void **state)
{
    (void)state;
    json_t *root = identify("run1.npy run2.npy run3.npy --runs -o joint.yaml --threads 1", 0);
    json_t *channels = result_of(root, "channels"), *logs = result_of(root, "logs");
    const char *text;
    assert_int_equal(json_array_size(channels), 3);
    assert_int_equal(json_array_size(logs), 3);
    for (size_t c = 0; c < 3; c++) {
        json_t *joint = term_of(json_array_get(channels, c));
        double information = 0;
        for (size_t r = 0; r < 3; r++) {
            json_t *of_log = json_object_get(json_array_get(logs, r), "channels");
            information += pow(number(term_of(json_array_get(of_log, c)), "sigma"), -2);
        }
        /* Wrong in 2e-9 of cases. */
        CHECK_CLOSE(number(joint, "value"), white, 6 * number(joint, "sigma"));
        /* The information adds up; a log in which quantization is taken for present knows white
         * noise half as well, so this is no equality. */
        assert_true(number(joint, "sigma") * sqrt(information) < 1.1);
        json_t *agreement = json_object_get(json_array_get(channels, c), "agreement");
        assert_true(number(agreement, "probability") > 1e-7);
        assert_true(number(agreement, "degrees_of_freedom") >= 2);
    }
    assert_int_equal(messages(result_of(root, "verdict"), "runs_differ", &text), 0);
    json_decref(root);
    char *serial = strdup(out);
    assert_int_equal(run("$I identify run1.npy run2.npy run3.npy --runs --json -o joint.yaml "
                         "--threads 2"),
                     0);
    assert_string_equal(out, serial);
    free(serial);
    assert_int_equal(run("cat joint.yaml"), 0);
    check_contains(out, "source: \"run1.npy, run2.npy, run3.npy\"", "joint.yaml");
    check_contains(out, "15 min at 100 Hz", "joint.yaml");
    assert_null(strstr(out, "rate_ramp"));
    if (check_quick())
        return;
    assert_int_equal(run("$I identify run1.npy run2.npy run3.npy --runs --truth model.yaml"), 0);
    check_contains(out, "The 3 logs agree", "runs");
    check_contains(out, "mean from run to run", "runs");
    check_contains(out, "intervals cover the truth", "runs");
}

/* A copy counts once, under whatever name and in whatever format; a longer log is no copy. */
static void test_copies(void **state)
{
    (void)state;
    static const char *const lines[] = {"run1.npy run2.npy copy.csv --runs",
                                        "run1.npy copy.csv --devices --json"};
    assert_int_equal(run("$I convert run1.npy copy.csv && "
                         "head -n 29001 copy.csv > part.csv"),
                     0);
    for (size_t i = 0; i < 2; i++) {
        char line[200];
        snprintf(line, sizeof line, "$I identify %s", lines[i]);
        assert_int_equal(run(line), 1);
        check_contains(err,
                       "error: copy.csv holds the readings of run1.npy again: they would count as "
                       "those of two logs; leave one of the two out\n",
                       lines[i]);
    }
    check_contains(out, "\"code\": \"same_readings\"", "copies");
    assert_int_equal(run("$I identify copy.csv part.csv --devices"), 0);
}

/* Ten per cent more white noise is 23 standard deviations. */
static void test_run_that_differs(void **state)
{
    (void)state;
    json_t *root = identify("run1.npy run2.npy noisy.npy --runs --strict", 1);
    const char *text;
    assert_int_equal(messages(result_of(root, "verdict"), "runs_differ", &text), 3);
    check_contains(text, "the largest difference is in angle random walk", "a run that differs");
    check_contains(text, "in noisy.npy", "a run that differs");
    check_contains(err, "do not have the same noise", "a run that differs");
    json_decref(root);
}

static void test_devices(void **state)
{
    (void)state;
    const char *text;
    json_t *root = identify("run1.npy run2.npy run3.npy --devices --confidence 0.9999", 0);
    assert_int_equal(messages(result_of(root, "verdict"), "devices_differ", &text), 0);
    assert_int_equal(messages(result_of(root, "verdict"), "devices_agree", &text), 1);
    json_decref(root);
    root = identify("run1.npy noisy.npy --devices", 0);
    assert_true(messages(result_of(root, "verdict"), "devices_differ", &text) >= 3);
    check_contains(text, "gyro_z: angle random walk differs: 0.3", "two devices");
    check_contains(text, "in noisy.npy", "two devices");
    assert_int_equal(messages(result_of(root, "verdict"), "two_devices", &text), 1);
    for (size_t c = 0; c < 3; c++) {
        json_t *term = json_object_get(
            json_object_get(json_array_get(result_of(root, "channels"), c), "population"),
            "angle_random_walk");
        /* Half of 0.33^2 + 0.3^2, whose root is 0.3154; the sigmas are 0.4 %. */
        CHECK_CLOSE(number(term, "mean"), white * sqrt((1 + 1.21) / 2), 0.01 * white);
        /* Two values apart by d have the standard deviation d/sqrt(2). */
        CHECK_CLOSE(number(term, "spread"), white * 0.1 / sqrt(2), 0.02 * white);
        assert_true(number(term, "probability") < 1e-12);
    }
    json_decref(root);
}

static void test_report(void **state)
{
    (void)state;
    static const char *const lines[] = {
        "$I identify run1.npy run2.npy --runs --report page.html --plot plot.svg",
        "$I identify run1.npy run2.npy --devices --report page.html"};
    for (size_t k = 0; k < 2; k++) {
        assert_int_equal(run(lines[k]), 0);
        check_contains(out, "Report: page.html", lines[k]);
        assert_int_equal(run("cat page.html"), 0);
        check_contains(out, k ? "Sensor by sensor" : "Run by run", lines[k]);
        check_contains(out, "run2.npy", lines[k]);
    }
}

static void test_plan(void **state)
{
    (void)state;
    assert_int_equal(run("$I identify --plan model.yaml --rate 100Hz --want 'bias_instability 5%'"),
                     0);
    check_contains(out, "bias_instability 5%", "plan");
    check_contains(out, "planned length", "plan");
    /* Ten minutes are too short for a statement. */
    assert_int_equal(run("$I identify --plan tactical --rate 0.1Hz | grep gyro.angle_random_walk"),
                     0);
    check_contains(out, "deg/sqrt(h)    -  ", "plan");
    check_message("$I identify --plan tactical --rate 1e-9Hz", 2,
                  "imukit identify: error: --plan: a record of 86400 s at 1e-09 Hz does not have "
                  "256 to 1e12 samples; add a --duration that fits\n" TRY("identify"));
    check_message("$I identify --plan tactical --rate 100Hz --duration 1e308s", 2,
                  "imukit identify: error: --plan: a record of 1e+308 s at 100 Hz does not have "
                  "256 to 1e12 samples; change --duration or --rate\n" TRY("identify"));
    check_message("$I identify run1.npy --plan model.yaml --rate 100Hz", 2,
                  "imukit identify: error: --plan is for a record that does not exist yet; leave "
                  "out the log, or --plan\n" TRY("identify"));
    check_message("$I identify --want 'bias_instability 5%'", 2,
                  "imukit identify: error: --want states requirements for a planned record; add "
                  "--plan MODEL\n" TRY("identify"));
    check_message("$I identify", 2,
                  "imukit identify: error: an operand is missing: imukit identify LOG..., "
                  "or --plan MODEL\n" TRY("identify"));
    check_message("$I identify run1.npy --duration 3h", 2,
                  "imukit identify: error: --duration goes with --plan or --curve; a log has its "
                  "own length\n" TRY("identify"));
}

/* A curve of N = 0.3 deg/sqrt(h) alone: 0.3/60/sqrt(tau) deg/s; of the log, by either method. */
static void test_allan(void **state)
{
    (void)state;
    FILE *file = fopen("curve.csv", "w");
    assert_non_null(file);
    fputs("tau [s],gyro_x [deg/s]\n", file);
    for (int k = 0; k < 12; k++)
        fprintf(file, "%.2f,%.9f\n", 0.01 * (1 << k), 0.3 / 60 / sqrt(0.01 * (1 << k)));
    assert_int_equal(fclose(file), 0);
    json_t *root = identify("curve.csv --curve --rate 100Hz --duration 1h", 0);
    json_t *term = term_of(json_array_get(result_of(root, "channels"), 0));
    CHECK_CLOSE(number(term, "value"), white, 1e-6 * white); /* nine decimals of the table */
    json_decref(root);
    check_message(
        "$I identify curve.csv --curve", 2,
        "imukit identify: error: a curve does not state the rate and the length of its record; add "
        "--rate and --duration, such as --rate 100Hz --duration 3h\n" TRY("identify"));
    root = identify("run1.npy --method allan", 0);
    term = term_of(json_array_get(result_of(root, "channels"), 0));
    CHECK_CLOSE(number(term, "value"), white, 6 * number(term, "sigma"));
    json_decref(root);
    assert_int_equal(run("$I allan run1.npy -o long.csv"), 0);
    assert_int_equal(run("$I identify long.csv --curve --rate 100Hz --duration 5min"), 1);
    check_contains(err, "looks like the long table of imukit allan", "a long table");
    check_message("$I identify run1.npy --tolerance 2%", 2,
                  "imukit identify: error: --tolerance goes with --method allan or "
                  "--curve\n" TRY("identify"));
}

/* Runs of a model with bias instability alone differ by its slow part, 1.8 B for ten minutes, which
 * is no repeatability: simulated with it, their means would scatter more than these. One with 4 B
 * is found, and what `calibrate` puts into a model is the same. */
static void test_slow_flicker_is_no_repeatability(void **state)
{
    (void)state;
    put("b.yaml", "imukit: 1\ngyro: {noise: {angle_random_walk: 0.03 deg/sqrt(h), "
                  "bias_instability: 8 deg/h}}\n");
    put("r.yaml", "imukit: 1\ngyro: {bias: {repeatability: 40 deg/h}, noise: {angle_random_walk: "
                  "0.03 deg/sqrt(h), bias_instability: 8 deg/h}}\n");
    assert_int_equal(
        run("for m in b r; do for k in 1 2 3 4 5 6; do $I simulate $m.yaml --rate 5Hz "
            "--duration 10min --seed 7 --run $k -o $m$k.npy >&2 || exit 1; done; done"),
        0);
    json_t *root = identify("b1.npy b2.npy b3.npy b4.npy b5.npy b6.npy --runs", 0), *channel;
    size_t index;
    json_array_foreach(result_of(root, "channels"), index, channel)
    {
        json_t *found = json_object_get(channel, "run_to_run");
        CHECK_CLOSE(json_number_value(json_object_get(json_object_get(found, "lower"), "value")), 0,
                    0);
        CHECK_RELATIVE(value_of(found, "within"), 1.8 * 8 * DEGREE / 3600, 0.25);
    }
    assert_int_equal(index, 3);
    json_decref(root);
    assert_int_equal(run("$I calibrate b?.npy --procedure repeatability --model b.yaml"), 0);
    check_contains(out, "deg/h  not seen  not seen  not seen", "calibrate");
    root = identify("r1.npy r2.npy r3.npy r4.npy r5.npy r6.npy --runs", 0);
    json_array_foreach(result_of(root, "channels"), index, channel)
    {
        json_t *found = json_object_get(channel, "run_to_run");
        CHECK_BELOW(value_of(found, "lower"), 40 * DEGREE / 3600);
        CHECK_BELOW(40 * DEGREE / 3600, value_of(found, "upper"));
        CHECK_BELOW(0, value_of(found, "lower"));
    }
    json_decref(root);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_which),
        cmocka_unit_test(test_rates),
        cmocka_unit_test(test_runs),
        cmocka_unit_test(test_copies),
        cmocka_unit_test(test_run_that_differs),
        cmocka_unit_test(test_devices),
        cmocka_unit_test(test_report),
        cmocka_unit_test(test_plan),
        cmocka_unit_test(test_allan),
        cmocka_unit_test(test_slow_flicker_is_no_repeatability),
    };
    return cmocka_run_group_tests(tests, make_logs, drop_logs);
}
