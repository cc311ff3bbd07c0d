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
    check_message("$I simulate tactical -Z", 2,
                  "imukit simulate: error: there is no option -Z\n" TRY("simulate"));
    check_message("$I simulate", 2,
                  "imukit simulate: error: an operand is missing: imukit simulate "
                  "MODEL\n" TRY("simulate"));
    check_message("$I grade a b c d e f g h i", 2,
                  "imukit grade: error: \"i\" is one word too many: imukit grade "
                  "MODEL...\n" TRY("grade"));
    check_message("$I convert a.csv", 2,
                  "imukit convert: error: an operand is missing: imukit convert IN "
                  "OUT\n" TRY("convert"));
    check_message("$I simulate tactical --rate", 2,
                  "imukit simulate: error: --rate needs a value: --rate RATE\n" TRY("simulate"));
    check_message("$I simulate tactical --duration 1h", 2,
                  "imukit simulate: error: the sample rate is missing: add --rate "
                  "100Hz\n" TRY("simulate"));
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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_newcomer),
        cmocka_unit_test(test_help_of_every_verb),
        cmocka_unit_test(test_wrong_usage),
        cmocka_unit_test(test_units_of_quantities),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
