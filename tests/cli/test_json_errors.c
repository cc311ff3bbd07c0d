/* SPDX-License-Identifier: Apache-2.0 */
/* With --json standard output holds one object, whatever happens: the result, the error, or both
 * where a result was there before something failed; notes and warnings are in either. */
#include "run_command.h"

/* The object on standard output, after a line that ends with this code; it is freed by the next. */
static json_t *document;

static void get(const char *line, int code)
{
    json_decref(document);
    assert_int_equal(run(line), code);
    document = json_loads(out, JSON_REJECT_DUPLICATES, NULL);
    if (!document)
        fail_msg("%s: not JSON: %s", line, out);
}

static const char *error_of(const char *key)
{
    return json_string_value(json_object_get(json_object_get(document, "error"), key));
}

static size_t findings_of(const char *level, const char *code)
{
    size_t index, count = 0;
    json_t *finding;
    json_array_foreach(json_object_get(document, "findings"), index, finding)
    {
        const char *of[2] = {json_string_value(json_object_get(finding, "level")),
                             json_string_value(json_object_get(finding, "code"))};
        count += strcmp(of[0], level) == 0 && strcmp(of[1], code) == 0;
        assert_true(json_is_string(json_object_get(finding, "message")));
    }
    return count;
}

static void test_usage(void **state)
{
    (void)state;
    const char *const lines[] = {"$I alan x.csv --json",
                                 "$I allan --json",
                                 "$I allan x.csv --json --tua 1s",
                                 "$I allan --json --",
                                 "$I simulate AHRS --rate 1Hz --duration 2s --json",
                                 "$I convert a.csv - --json",
                                 "$I physics ring_laser --show --json",
                                 "$I allan x.csv --plot term --json"};
    for (size_t i = 0; i < sizeof lines / sizeof lines[0]; i++) {
        get(lines[i], 2);
        assert_string_equal(error_of("code"), "usage");
        assert_null(json_object_get(document, "result"));
        check_contains(err, error_of("message"), lines[i]);
    }
    assert_int_equal(run("$I allan"), 2);
    assert_string_equal(out, "");
}

/* The status of the library, its place in the file, and what to run next. */
static void test_files(void **state)
{
    (void)state;
    get("$I identify nowhere.csv --json", 1);
    assert_string_equal(error_of("code"), "open");
    assert_string_equal(error_of("file"), "nowhere.csv");
    put("wrong.yaml", "imukit: 1\ngyro:\n  noise: {angle_random_wlak: 0.3 deg/sqrt(h)}\n");
    get("$I grade wrong.yaml --json", 1);
    assert_string_equal(error_of("code"), "key_unknown");
    assert_string_equal(error_of("field"), "gyro.noise.angle_random_wlak");
    assert_int_equal(
        json_integer_value(json_object_get(json_object_get(document, "error"), "line")), 3);
    put("no_rate.csv", "gyro_x [deg/s]\n1\n2\n3\n");
    get("$I allan no_rate.csv --json", 1);
    assert_string_equal(error_of("code"), "rate_missing");
    assert_string_equal(error_of("next"), "imukit allan no_rate.csv --json --rate RATE");
    get("$I allan - --json </dev/null", 1);
    assert_string_equal(error_of("code"), "empty");
    assert_int_equal(sweep(), 2);
}

/* What was computed is there although the picture is not. */
/* An output that cannot be written is named, in full where the message shortens it. */
static void test_outputs(void **state)
{
    (void)state;
    char line[1200], name[400];
    memset(name, 'n', 200);
    snprintf(name + 200, sizeof name - 200, "/log.csv");
    snprintf(line, sizeof line, "$I simulate AHRS -r 10Hz -d 1s --json -o%s", "/dev/full");
    get(line, 1);
    assert_string_equal(error_of("code"), "write");
    assert_string_equal(error_of("file"), "/dev/full");
    const char *const ways[] = {"-o %s", "-o%s", "--output=%s", "--output %s"};
    for (size_t i = 0; i < sizeof ways / sizeof ways[0]; i++) {
        char option[420];
        snprintf(option, sizeof option, ways[i], name);
        snprintf(line, sizeof line, "$I simulate AHRS -r 10Hz -d 1s --json %s", option);
        get(line, 1);
        assert_string_equal(error_of("code"), "open");
        assert_string_equal(error_of("file"), name);
    }
    get("$I join AHRS tactical --gyro AHRS --accel tactical --json -o nowhere/unit.yaml", 1);
    assert_string_equal(error_of("file"), "nowhere/unit.yaml");
}

/* What was left out of a log is a finding with the same code in every verb. */
static void test_damage(void **state)
{
    (void)state;
    put("damaged.csv", "time [s],gyro_x [rad/s]\n0,1\n1,x\n2,2\n3,1\n4,3\n5,1\n6,2\n7,1\n8,2\n"
                       "9,4\n10,1\n11,2\n");
    const char *const lines[] = {"$I info damaged.csv --json", "$I allan damaged.csv --json"};
    for (int i = 0; i < 2; i++) {
        get(lines[i], 0);
        assert_int_equal(findings_of("warning", "damaged"), 1);
    }
    get("$I info damaged.csv --full --after 20s --json", 1);
    assert_string_equal(error_of("file"), "damaged.csv");
}

static void test_result_and_error(void **state)
{
    (void)state;
    write_good();
    get("$I allan good.csv --json --plot nowhere/picture.svg", 1);
    assert_string_equal(error_of("code"), "open");
    assert_true(json_is_object(json_object_get(document, "result")));
    get("$I allan good.csv --json", 0);
    assert_null(json_object_get(document, "error"));
    /* What is known of a log that other verbs refuse. */
    assert_int_equal(run("gzip -c good.csv | head -c 3000 > cut.csv.gz && cut -d, -f2- good.csv > "
                         "timeless.csv"),
                     0);
    get("$I info cut.csv.gz --json", 1);
    assert_string_equal(error_of("code"), "compressed");
    assert_true(json_is_object(json_object_get(document, "result")));
    get("$I info timeless.csv --json", 1);
    assert_string_equal(error_of("code"), "rate_missing");
    assert_true(json_is_object(json_object_get(document, "result")));
    sweep();
}

static void test_findings(void **state)
{
    (void)state;
    put("lost.csv", "time [s],gyro_x [deg/s],gyro_y [deg/s]\n1600000000,1,nan\n1600000001,2,3\n"
                    "1600000002,3,4\n");
    get("$I convert lost.csv kept.npy --json", 0);
    assert_int_equal(findings_of("note", "time_origin"), 1);
    assert_int_equal(findings_of("note", "not_finite"), 1);
    check_contains(err, "1 of 3 rows have a value that is missing", "convert");
    get("$I convert nowhere.csv kept.npy --json", 1);
    assert_int_equal(json_array_size(json_object_get(document, "findings")), 0);
    put("heat.yaml", "imukit: 1\ngyro: {bias: {temperature_rate: 0.5 deg/h/(K/min)}}\n");
    get("$I simulate heat.yaml --rate 10Hz --duration 2s -o a.csv --json", 0);
    assert_int_equal(findings_of("warning", "temperature_unknown"), 1);
    sweep();
}

/* What was written, with its columns. */
static void test_written(void **state)
{
    (void)state;
    long long rows;
    size_t columns;
    json_t *logs, *truth;
    get("$I simulate AHRS --rate 10Hz --duration 2s --runs 2 -o runs/ --truth t.csv --json", 0);
    assert_int_equal(
        json_unpack(document, "{s:{s:o,s:o}}", "result", "logs", &logs, "truth", &truth), 0);
    assert_int_equal(json_array_size(logs), 2);
    assert_string_equal(json_string_value(json_object_get(json_array_get(logs, 1), "file")),
                        "runs/run_001.csv");
    rows = json_integer_value(json_object_get(json_array_get(logs, 1), "rows"));
    columns = json_array_size(json_object_get(truth, "columns"));
    assert_int_equal(rows, 20);
    assert_int_equal(columns, 17);
    get("$I convert runs/run_000.csv a.csv --select gyro_x,time --to-gyro-unit mrad/s --json", 0);
    const char *name, *unit;
    assert_int_equal(json_unpack(document, "{s:{s:[{s:s,s:s}, o]}}", "result", "columns", "name",
                                 &name, "unit", &unit, &truth),
                     0);
    assert_string_equal(name, "gyro_x");
    assert_string_equal(unit, "mrad/s");
    assert_int_equal(run("rm -r runs"), 0);
    sweep();
    json_decref(document);
    document = NULL;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_usage),
        cmocka_unit_test(test_files),
        cmocka_unit_test(test_outputs),
        cmocka_unit_test(test_damage),
        cmocka_unit_test(test_result_and_error),
        cmocka_unit_test(test_findings),
        cmocka_unit_test(test_written),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
