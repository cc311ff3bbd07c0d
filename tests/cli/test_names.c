/* SPDX-License-Identifier: Apache-2.0 */
/* Files whose names are no UTF-8 are files like others: whatever quotes a name shows the
 * replacement character for what is none, and is UTF-8. */
#include "run_command.h"

#include "imukit/utf8.h"

/* Latin-1's o with two dots, and a byte that UTF-8 never has; and how they are shown. */
#define BAD "l\xF6g\xFF"
#define SHOWN "l" IMK_UTF8_REPLACEMENT "g" IMK_UTF8_REPLACEMENT

/* Lines, $N being the bad name; each prints JSON, and may make files called made. */
static const char *const lines[] = {
    "$I allan \"$N.csv\" --json --report made.html --plot made.svg",
    "$I spectrum \"$N.csv\" --json --report made.html",
    "$I identify \"$N.csv\" --json --report made.html -o made.yaml",
    "$I identify plain.csv \"$N.csv\" --runs --json --report made.html -o made.yaml",
    "$I identify six.csv --into \"$N.yaml\" --truth \"$N.yaml\" --json -o made.yaml",
    "$I identify plain.csv --name \"$N\" --json -o made.yaml",
    "$I calibrate \"turns$N.csv\" -p rate-table --motion \"turns$N.yaml\" --no-earth -g "
    "9.81m/s^2 --json --report made.html -o made.yaml",
    "$I evaluate \"turns$N.csv\" --motion \"turns$N.yaml\" --static \"$N.csv\" --unit \"$N\" "
    "--json --report made.html",
    "$I compensate \"turns$N.csv\" \"$N.yaml\" -o made.csv --json",
    "$I compensate tactical --emit-c \"folder$N\" --json",
    "$I convert \"$N.yaml\" made.yaml --to kalibr --rate 100Hz --use-bounds --json",
    "$I drift \"$N.yaml\" -d 10s -r 1Hz --json --report made.html --plot made.svg",
    "$I drift tactical -r 1Hz --motion \"turns$N.yaml\" -n 3 --json",
    "$I drift \"$N.h5\" --json",
    "$I merge \"$N.h5\" -o made.csv --json",
    "$I grade \"$N.yaml\" --json --report made.html",
    "$I navigate \"turns$N.csv\" -p '48 deg, 11 deg, 500 m' --attitude '0 0 0 deg' -m "
    "\"$N.yaml\" --json --report made.html -o made.csv",
    "$I physics \"design$N.yaml\" --reduce --json --report made.html -o made.yaml",
};

static int make_inputs(void **state)
{
    if (set_up(state) != 0)
        return -1;
    setenv("N", BAD, 1);
    mkdir("folder" BAD, 0700);
    put("turns" BAD ".yaml", "imukit_motion: 1\nsteps:\n  - hold 4 s\n  - turn right 40 deg at 10 "
                             "deg/s\n  - hold 4 s\n  - turn right 80 deg at 20 deg/s\n  - hold 4 "
                             "s\n");
    return run(
        "$I simulate tactical --rate 50Hz --duration 12s -o six.csv && cut -d, -f1,2 six.csv "
        ">plain.csv && head -n 600 plain.csv >\"$N.csv\" && "
        "$I simulate tactical --motion \"turns$N.yaml\" --rate 50Hz -o \"turns$N.csv\" && "
        "$I identify six.csv -o \"$N.yaml\" >/dev/null && "
        "$I drift tactical -d 10s -r 1Hz -n 3 -o \"$N.h5\" >/dev/null && "
        "$I physics rate_gyro --show >\"design$N.yaml\"");
}

static int remove_inputs(void **state)
{
    run("rm -rf folder*");
    sweep();
    return tear_down(state);
}

static void check_utf8(const char *line, const char *text)
{
    for (const char *c = text; *c; c += imk_utf8_length(c))
        if (imk_utf8_length(c) == 0) {
            print_error("%s\n  is no UTF-8 from: %.80s\n", line, c);
            fail();
        }
}

static void test_names(void **state)
{
    (void)state;
    static const char *const made[] = {"made.html", "made.svg", "made.yaml", "made.csv"};
    for (size_t i = 0; i < sizeof lines / sizeof lines[0]; i++) {
        if (run(lines[i]) != 0) {
            print_error("%s\n  says: %s\n", lines[i], err);
            fail();
        }
        json_error_t error;
        json_t *document = json_loads(out, 0, &error); /* strict about UTF-8 */
        if (!document)
            print_error("%s\n  no JSON: %s\n", lines[i], error.text);
        assert_non_null(document);
        json_decref(document);
        if (!strstr(lines[i], "--name") && !strstr(lines[i], "--into")) /* in the model alone */
            check_contains(out, SHOWN, lines[i]);
        for (size_t k = 0; k < sizeof made / sizeof made[0]; k++) {
            if (access(made[k], F_OK) != 0)
                continue;
            read_text(made[k], out);
            check_utf8(lines[i], out);
            if (k == 0)
                check_contains(out, SHOWN, lines[i]);
            unlink(made[k]);
        }
    }
}

/* What a model says of where it comes from is UTF-8, also when a long name is cut. */
static void test_source_of_a_model(void **state)
{
    (void)state;
    assert_int_equal(run("$I identify \"$N.csv\" -o - | grep -e '^name' -e source"), 0);
    check_contains(out, "name: \"" SHOWN "\"\n", "identify");
    check_contains(out, "source: \"" SHOWN ".csv\"\n", "identify");
    assert_int_equal(run("L=$(printf 'x%.0s' $(seq 80))\303\266\303\266\303\266\303\266\303\266\303"
                         "\266\303\266\303\266.csv; cp plain.csv \"$L\"; $I identify \"$L\" -o -"),
                     0);
    check_utf8("a long name", out);
    assert_int_equal(run("cp \"turns$N.csv\" \"$N turns.csv\"; $I calibrate \"turns$N.csv\" \"$N "
                         "turns.csv\" -p rate-table --motion \"turns$N.yaml\" --no-earth -g "
                         "9.81m/s^2 -o - | grep -e '^name' -e source"),
                     0);
    check_contains(out, "source: \"turns" SHOWN ".csv, " SHOWN " turns.csv\"\n", "calibrate");
}

/* A column may have such a name too. */
static void test_names_of_columns(void **state)
{
    (void)state;
    assert_int_equal(run("{ echo \"time [s],$N\"; tail -n +2 plain.csv; } >other.csv; $I allan "
                         "other.csv --json"),
                     0);
    check_contains(out, "\"name\": \"" SHOWN "\"", "a column");
    check_utf8("a column", out);
}

/* Outputs have the name that was given, to the byte, whoever draws them. */
static void test_names_of_outputs(void **state)
{
    (void)state;
    assert_int_equal(run("$I allan plain.csv -o \"o$N.csv\" --report \"o$N.html\""), 0);
    assert_int_equal(unlink("o" BAD ".csv") + unlink("o" BAD ".html"), 0);
    assert_int_equal(run("$I allan \"$N.csv\" --plot \"o$N.svg\""), 0);
    assert_int_equal(unlink("o" BAD ".svg"), 0);
    if (imk_plot_available("x.png")) {
        assert_int_equal(run("$I allan \"$N.csv\" --plot \"o$N.png\""), 0);
        assert_int_equal(unlink("o" BAD ".png"), 0);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_names),
        cmocka_unit_test(test_source_of_a_model),
        cmocka_unit_test(test_names_of_columns),
        cmocka_unit_test(test_names_of_outputs),
    };
    return cmocka_run_group_tests(tests, make_inputs, remove_inputs);
}
