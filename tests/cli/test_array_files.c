/* SPDX-License-Identifier: Apache-2.0 */
/* Logs as arrays from end to end: what the simulator writes comes back to the last digit, and names
 * that are no format's are refused before anything is computed. */
#include "run_command.h"

/* A log simulated into each format, converted to CSV, is the log simulated as CSV; and so is one
 * that was converted there and back. */
static void test_round_trip(void **state)
{
    (void)state;
    static const char *const endings[] = {"npz", "mat", "h5"};
    assert_int_equal(run("$I simulate AHRS --rate 100Hz --duration 50s --seed 7 -o log.csv"), 0);
    for (size_t i = 0; i < sizeof endings / sizeof endings[0]; i++) {
        char line[400];
        snprintf(line, sizeof line,
                 "$I simulate AHRS --rate 100Hz --duration 50s --seed 7 -o a.%s && "
                 "$I convert a.%s a.csv && cmp a.csv log.csv && $I convert log.csv b.%s && "
                 "cmp a.%s b.%s && rm a.%s b.%s a.csv",
                 endings[i], endings[i], endings[i], endings[i], endings[i], endings[i],
                 endings[i]);
        assert_int_equal(run(line), 0);
    }
    assert_int_equal(run("$I simulate AHRS --rate 10Hz --duration 5s --runs 2 -o runs/ --format h5 "
                         "&& ls runs"),
                     0);
    assert_string_equal(out, "run_000.h5\nrun_001.h5\n");
    assert_int_equal(run("rm -r runs"), 0);
}

/* @param verb  with its options but for the output */
static void check_refused(const char *line, const char *text)
{
    assert_int_not_equal(run(line), 0);
    check_contains(err, text, line);
}

static void test_names(void **state)
{
    (void)state;
    const char *text = "no log is written to a file with the ending .dat; name it in .csv .txt";
    check_refused("$I simulate AHRS --rate 10Hz --duration 5s -o x.dat", text);
    check_refused("$I simulate AHRS --rate 10Hz --duration 5s -o x.csv --truth x.dat", text);
    check_refused("$I convert log.csv x.dat", text);
    check_refused("$I convert log.csv x.npz.gz", "arrays are not read from a compressed file");
    check_refused("$I allan log.csv -o x.mat", "a table is written as text, not as .mat");
    check_refused("$I spectrum log.csv -o x.h5", "a table is written as text, not as HDF5");
    assert_int_equal(run("ls x.* 2>/dev/null"), 2);
}

/* The streams that cannot be read twice. */
static void test_pipes(void **state)
{
    (void)state;
    assert_int_equal(run("$I convert log.csv log.mat"), 0);
    check_refused("cat log.mat | $I convert - x.csv",
                  ".mat is not read from a pipe, .gz, .zst or memory; write it to a plain file");
    check_refused("gzip -k log.mat && $I convert log.mat.gz x.csv", ".mat is not read from a pipe");
    sweep();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_round_trip),
        cmocka_unit_test(test_names),
        cmocka_unit_test(test_pipes),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
