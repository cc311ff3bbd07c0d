/* SPDX-License-Identifier: Apache-2.0 */
/* The command line: help, man pages, completion, and every wrong usage with its exact message. */
#include "run_command.h"

static void test_newcomer(void **state)
{
    (void)state;
    assert_int_equal(run("$I"), 0);
    check_contains(out, "First result", "imukit");
    check_contains(out, "imukit identify static.csv -o model.yaml --report report.html", "imukit");
    char *first = strdup(out);
    assert_int_equal(run("$I --help"), 0);
    assert_string_equal(out, first);
    assert_int_equal(run("$I help"), 0);
    assert_string_equal(out, first);
    free(first);
    assert_int_equal(run("$I --version"), 0);
    assert_string_equal(out, "imukit " IMK_VERSION "\n");
    assert_string_equal(err, "");
}

static const char *const verbs[] = {"simulate", "compensate", "allan",  "identify",
                                    "devices",  "grade",      "convert"};

/* Help, man page and completion of every verb; examples first, no colours into a file. */
static void test_help_of_every_verb(void **state)
{
    (void)state;
    char line[200], expected[100];
    for (size_t i = 0; i < sizeof verbs / sizeof verbs[0]; i++) {
        if (check_skips(i, 3))
            continue;
        snprintf(line, sizeof line, "$I %s --help", verbs[i]);
        assert_int_equal(run(line), 0);
        snprintf(expected, sizeof expected, "imukit %s: ", verbs[i]);
        assert_int_equal(strncmp(out, expected, strlen(expected)), 0);
        snprintf(expected, sizeof expected, "\n\nExamples\n  imukit %s", verbs[i]);
        assert_ptr_equal(strstr(out, "\n\n"), strstr(out, expected));
        assert_null(strchr(out, '\033'));
        char *help = strdup(out);
        snprintf(line, sizeof line, "$I help %s", verbs[i]);
        assert_int_equal(run(line), 0);
        assert_string_equal(out, help);
        free(help);
        snprintf(line, sizeof line, "$I help --man %s", verbs[i]);
        assert_int_equal(run(line), 0);
        check_contains(out, ".TH IMUKIT\\-", line);
        snprintf(line, sizeof line,
                 "$I help --completion bash | bash -n && $I help --completion "
                 "bash | grep -c '^        %s) choices='",
                 verbs[i]);
        assert_int_equal(run(line), 0);
        assert_string_equal(out, "1\n");
    }
}

static void test_wrong_usage(void **state)
{
    (void)state;
    check_message(
        "$I simluate", 2,
        "imukit: error: there is no verb \"simluate\"; did you mean \"simulate\"?\n" TRY_MAIN);
    check_message("$I xyzzy", 2,
                  "imukit: error: there is no verb \"xyzzy\"; the verbs are listed by imukit "
                  "--help\n" TRY_MAIN);
    check_message("$I simulate tactical --durration 1h", 2,
                  "imukit simulate: error: there is no option --durration; did you mean "
                  "--duration?\n" TRY("simulate"));
    check_message("$I simulate tactical --dur 1h", 2,
                  "imukit simulate: error: there is no option --dur; did you mean "
                  "--duration?\n" TRY("simulate"));
    check_message("$I simulate tactical --ru 2", 2, /* --run and --runs begin so, --run is near */
                  "imukit simulate: error: there is no option --ru; did you mean "
                  "--run?\n" TRY("simulate"));
    check_message("$I simulate tactical -Z", 2,
                  "imukit simulate: error: there is no option -Z\n" TRY("simulate"));
    check_message("$I simulate", 2,
                  "imukit simulate: error: an operand is missing: imukit simulate "
                  "MODEL\n" TRY("simulate"));
    check_message("$I grade a b c d e f g h i", 2,
                  "imukit grade: error: \"i\" is one word too many: imukit grade "
                  "MODEL..., at most 8 of them\n" TRY("grade"));
    check_message("$I info a b", 2,
                  "imukit info: error: \"b\" is one word too many: imukit info LOG\n" TRY("info"));
    check_message("$I convert a.csv", 2,
                  "imukit convert: error: an operand is missing: imukit convert IN "
                  "OUT\n" TRY("convert"));
    check_message("$I simulate tactical --rate", 2,
                  "imukit simulate: error: --rate needs a value: --rate RATE\n" TRY("simulate"));
    check_message(
        "$I simulate tactical --duration 1h", 2,
        "imukit simulate: error: the sampling rate is missing: add --rate 100Hz\n" TRY("simulate"));
    check_message("$I simulate tactical --rate 100Hz", 2,
                  "imukit simulate: error: the length is missing: add --duration "
                  "1h\n" TRY("simulate"));
    check_message("$I simulate tactical --no-earth=1", 2,
                  "imukit simulate: error: --no-earth takes no value\n" TRY("simulate"));
    check_message("$I allan a.csv --edf some", 2,
                  "imukit allan: error: --edf some: expected one of "
                  "exact|greenhall-riley\n" TRY("allan"));
    check_message("$I allan a.csv --confidence 95", 2,
                  "imukit allan: error: --confidence 95: expected a fraction between 0 and 1, such "
                  "as 0.95 or 95%\n" TRY("allan"));
    check_message("$I simulate tactical --seed -1", 2,
                  "imukit simulate: error: --seed -1: expected a whole number, such as --seed "
                  "1\n" TRY("simulate"));
    check_message("$I simulate tactical --seed 18446744073709551616", 2,
                  "imukit simulate: error: --seed 18446744073709551616: the number is too large; "
                  "at most 18446744073709551615\n" TRY("simulate"));
    check_message("$I convert model.yaml log.csv", 2,
                  "imukit convert: error: model.yaml is a model and log.csv a log: a log and a "
                  "model cannot become each other; use identify or simulate\n" TRY("convert"));
    put("m.yaml", "imukit: 1\ngyro: {range: 9 deg/s}\n");
    put("r", "time [s],gyro_x [deg/s]\n0,1\n1,2\n");
    check_message("cat r | $I convert - m.json", 2,
                  "imukit convert: error: - is a log and m.json a model: a log and a model cannot "
                  "become each other; use identify or simulate\n" TRY("convert"));
    check_message("$I convert m.yaml -; cp m.yaml n; $I convert n -; cat r | $I convert - -", 0,
                  "");
    assert_string_equal(out, "imukit: 1\ngyro: {range: 9 deg/s}\n"
                             "imukit: 1\ngyro: {range: 9 deg/s}\n"
                             "time [s],gyro_x [deg/s]\n0,1\n1,2\n");
    assert_int_equal(sweep(), 3);
    assert_int_equal(sweep(), 0);
}

/* Quantities carry units, and the unit decides. */
static void test_units_of_quantities(void **state)
{
    (void)state;
    check_message("$I simulate tactical --rate 100 --duration 1s", 2,
                  "imukit simulate: error: --rate 100: the unit is missing; write --rate "
                  "100Hz\n" TRY("simulate"));
    assert_int_equal(run("$I simulate tactical --rate 100deg --duration 1s"), 2);
    check_contains(err, "is an angle; expected a frequency such as Hz", "--rate 100deg");
    assert_int_equal(run("$I simulate tactical --rate 0Hz --duration 1s"), 2);
    check_contains(err, "--rate must be positive", "--rate 0Hz");
    assert_int_equal(run("$I simulate tactical --rate 100Hz --duration 1ms"), 2);
    check_contains(err, "rows: expected 1 to 1e15", "0.1 rows");
    assert_int_equal(run("$I simulate tactical --rate 100Hz --duration 1s --gyro-unit g"), 2);
    check_contains(err, "--gyro-unit g: expected an angular rate", "--gyro-unit g");
    assert_int_equal(sweep(), 0);
}

/* Every option that takes a whole number: what it refuses, and the largest number that it takes,
 * which is given like any other. */
static void test_whole_numbers(void **state)
{
    (void)state;
    static const struct {
        const char *verb, *option, *least, *most; /* NULL: any number */
    } options[] = {
        {"allan x.csv", "threads", "1", "65536"},
        {"calibrate x.csv", "temperature-order", "1", "5"},
        {"compensate x.csv AHRS", "decimals", "0", "17"},
        {"compensate x.csv AHRS", "threads", "1", "65536"},
        {"compensate AHRS --emit-c d", "vectors", "1", "1000000"},
        {"convert x.csv y.csv", "decimals", "0", "17"},
        {"convert x.csv y.csv", "threads", "1", "65536"},
        {"drift tactical", "monte-carlo", "1", "4294967295"},
        {"drift tactical", "seed", NULL, NULL},
        {"drift tactical", "threads", "1", "65536"},
        {"identify x.csv", "seed", NULL, NULL},
        {"identify x.csv", "threads", "1", "65536"},
        {"identify x.csv", "gauss-markov", "0", "8"},
        {"navigate x.csv", "coning", "1", "4"},
        {"physics ring_laser", "seed", NULL, NULL},
        {"physics ring_laser", "run", "0", "4294967295"},
        {"physics ring_laser", "threads", "1", "65536"},
        {"simulate AHRS", "seed", NULL, NULL},
        {"simulate AHRS", "run", "0", "4294967295"},
        {"simulate AHRS", "runs", "1", "4294967295"},
        {"simulate AHRS", "decimals", "0", "17"},
        {"simulate AHRS", "threads", "1", "65536"},
        {"simulate AHRS", "substeps", "1", "512"},
        {"spectrum x.csv", "threads", "1", "65536"},
        {"allan x.csv", "instance", "0", "999"},
        {"calibrate x.csv", "instance", "0", "999"},
        {"compensate x.csv m.yaml", "instance", "0", "999"},
        {"convert x.csv y.csv", "instance", "0", "999"},
        {"evaluate x.csv", "instance", "0", "999"},
        {"identify x.csv", "instance", "0", "999"},
        {"info x.csv", "instance", "0", "999"},
        {"navigate x.csv", "instance", "0", "999"},
        {"spectrum x.csv", "instance", "0", "999"},
    };
    static const char *const no_numbers[] = {"-1", "+5", "1e3", "0x10", "''", "' 1'", "1.0", "inf"};
    static const char *const beyond[] = {"18446744073709551615", "18446744073709551616",
                                         "99999999999999999999999"};
    char line[200], says[200];
    for (size_t i = 0; i < sizeof options / sizeof options[0]; i++) {
        const char *name = options[i].option;
        for (size_t k = 0; k < sizeof no_numbers / sizeof no_numbers[0]; k++) {
            /* How numbers are read is the same for all: each further option tries two. */
            if ((i >= 4 && (i + k) % 4 != 0) || check_skips(i + k, 4))
                continue;
            snprintf(line, sizeof line, "$I %s --%s %s", options[i].verb, name, no_numbers[k]);
            assert_int_equal(run(line), 2);
            check_contains(err, ": expected a whole number, such as --", line);
        }
        for (size_t k = 0; k < sizeof beyond / sizeof beyond[0]; k++) {
            snprintf(line, sizeof line, "$I %s --%s %s", options[i].verb, name, beyond[k]);
            if ((!options[i].most && k == 0) /* the largest seed */ || check_skips(i + k, 3))
                continue;
            snprintf(says, sizeof says,
                     options[i].most ? "--%s %s: expected %s to %s\n"
                                     : "--%s %s: the number is too large",
                     name, beyond[k], options[i].least, options[i].most);
            assert_int_equal(run(line), 2);
            check_contains(err, says, line);
        }
        if (options[i].least && options[i].least[0] == '1') {
            snprintf(line, sizeof line, "$I %s --%s 0", options[i].verb, name);
            snprintf(says, sizeof says, "--%s 0: expected 1 to %s\n", name, options[i].most);
            assert_int_equal(run(line), 2);
            check_contains(err, says, line);
        }
    }
    /* No option was forgotten. */
    assert_int_equal(
        run("for v in allan calibrate compensate convert devices drift evaluate grade "
            "identify info join merge navigate physics simulate spectrum; do $I $v --help; done "
            "| grep -c -e '--[a-z-]* N  *[A-Za-z]' -e '--[a-z-]* N$'"),
        0);
    assert_int_equal(atoi(out), sizeof options / sizeof options[0]);
}

/* The numbers that once stood for "not given", and 0 where a quantity is to be above it. */
static void test_given_is_no_value(void **state)
{
    (void)state;
    assert_int_equal(run("$I simulate AHRS --rate 1Hz --duration 2s --seed 18446744073709551615"),
                     0);
    assert_int_equal(
        run("$I simulate AHRS --rate 1Hz --duration 2s --decimals 0 | tail -1 | grep -c "
            "[.]"),
        1); /* no point */
    check_message("$I drift tactical -n 18446744073709551615", 2,
                  "imukit drift: error: --monte-carlo 18446744073709551615: expected 1 to "
                  "4294967295\n" TRY("drift"));
    static const char *const zeros[] = {"identify --plan AHRS --duration 0s",
                                        "spectrum x.csv --resolution 0Hz",
                                        "spectrum x.csv --to 0Hz",
                                        "calibrate x.csv --minimum 0s",
                                        "evaluate x.csv --minimum 0s",
                                        "compensate x.csv AHRS --rate-limit 0deg/s",
                                        "compensate x.csv AHRS --force-limit '0 g'",
                                        "physics ring_laser -d 1s --step 0s"};
    char line[200];
    for (size_t i = 0; i < sizeof zeros / sizeof zeros[0]; i++) {
        if (check_skips(i, 3))
            continue;
        snprintf(line, sizeof line, "$I %s", zeros[i]);
        assert_int_equal(run(line), 2);
        check_contains(err, ": expected more than 0\n", line);
    }
    static const char *const negative[] = {
        "calibrate x.csv --trim=-1s",   "calibrate x.csv --settle=-1s",
        "calibrate x.csv --window=-1s", "calibrate x.csv --initial-rest=-1s",
        "evaluate x.csv --trim=-1s",    "evaluate x.csv --settle=-1s",
        "spectrum x.csv --from=-1Hz"};
    for (size_t i = 0; i < sizeof negative / sizeof negative[0]; i++) {
        if (check_skips(i, 3))
            continue;
        snprintf(line, sizeof line, "$I %s", negative[i]);
        assert_int_equal(run(line), 2);
        check_contains(err, ": expected 0 or more\n", line);
    }
}

/* Numbers beyond a range, in the unit in which the message says it. */
static void test_ranges(void **state)
{
    (void)state;
    static const struct {
        const char *words, *says;
    } cases[] = {
        {"allan x.csv --rate 0Hz", "--rate 0Hz: expected 1e-9Hz to 1e9Hz"},
        {"convert m.yaml f.yaml --to filter --rate 1e-320Hz",
         "--rate 1e-320Hz: expected 1e-9Hz to 1e9Hz"},
        {"identify --plan tactical --rate 1e308Hz", "--rate 1e308Hz: expected 1e-9Hz to 1e9Hz"},
        {"convert m.yaml f.yaml --to filter --tau-from 1e-320s",
         "--tau-from 1e-320s: expected 1e-9s to 1e9s"},
        {"convert m.yaml f.yaml --to filter --tau-from 0s",
         "--tau-from 0s: expected 1e-9s to 1e9s"},
        {"convert m.yaml f.yaml --to filter --tau-to 1e308s",
         "--tau-to 1e308s: expected 1e-9s to 1e9s"},
        {"convert x.csv y.csv --gravity-free --latitude 45deg --yaw 1e20deg",
         "--yaw 1e20deg: expected -36000deg to 36000deg"},
        {"simulate AHRS --rate 1Hz --duration 2s --pitch=-1e3rad",
         "--pitch -1e3rad: expected -36000deg to 36000deg"},
        {"calibrate x.csv --placement 1e20deg", "--placement 1e20deg: expected 0deg to 180deg"},
        {"allan x.csv --confidence 0.9999999999999999",
         "--confidence 0.9999999999999999: expected a fraction from 0.001 to 0.999999999"},
        {"spectrum x.csv --confidence 99.99999999%",
         "--confidence 99.99999999%: expected a fraction from 0.001 to 0.999999999"},
        {"evaluate x.csv --confidence 1e-300",
         "--confidence 1e-300: expected a fraction from 0.001 to 0.999999999"},
        {"identify x.csv --confidence 0.9999999999",
         "--confidence 0.9999999999: expected a fraction from 0.001 to 0.999999999"},
        {"drift AHRS --roll 36001deg", "--roll 36001deg: expected -36000deg to 36000deg"},
    };
    char line[200], message[200];
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        if (check_skips(i, 3))
            continue;
        snprintf(line, sizeof line, "$I %s", cases[i].words);
        snprintf(message, sizeof message, "error: %s\n", cases[i].says);
        assert_int_equal(run(line), 2);
        check_contains(err, message, line);
    }
    assert_int_equal(run("$I simulate AHRS --rate 1Hz --duration 2s --yaw=-36000deg"), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_newcomer),      cmocka_unit_test(test_help_of_every_verb),
        cmocka_unit_test(test_wrong_usage),   cmocka_unit_test(test_units_of_quantities),
        cmocka_unit_test(test_whole_numbers), cmocka_unit_test(test_given_is_no_value),
        cmocka_unit_test(test_ranges),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
