/* SPDX-License-Identifier: Apache-2.0 */
/* The page of imukit identify: its figure draws all that was identified, and says where the model
 * does not hold; its table has a row for each term and axis. */
#include "cli/run_command.h"

#include "imukit/utf8.h"

static const char rich[] = "imukit: 1\n"
                           "gyro:\n"
                           "  direction: [1 0 0]\n"
                           "  noise:\n"
                           "    angle_random_walk: 0.3 deg/sqrt(h)\n"
                           "    gauss_markov: [{sigma: 40 deg/h, correlation_time: 1 s}]\n"
                           "    sinusoid: [{amplitude: 60 deg/h, frequency: 7 Hz}]\n"
                           "  bandwidth: 20 Hz\n"
                           "accel:\n"
                           "  direction: [1 0 0]\n"
                           "  noise:\n"
                           "    velocity_random_walk: 0.06 m/s/sqrt(h)\n"
                           "    resonance: [{sigma: 2 mg, frequency: 31 Hz, q: 20}]\n";

/* A row of the printed table begins so, its value is this, within a few sigmas of an estimate from
 * ten minutes, and has no interval. */
static void check_row(const char *name, double value, double tolerance, const char *unit)
{
    const char *row = strstr(out, name);
    double found;
    char axis[8], interval[8], shown[16];
    const char *cells = row ? strstr(row, " x ") : NULL;
    if (!cells || sscanf(cells, " %7s %lf %7s %15s", axis, &found, interval, shown) != 4)
        fail_msg("no row \"%s\" in\n%s", name, out);
    assert_string_equal(axis, "x");
    assert_true(found > value - tolerance && found < value + tolerance);
    assert_string_equal(interval, "-");
    assert_string_equal(shown, unit);
}

static void test_all_is_drawn(void **state)
{
    (void)state;
    put("rich.yaml", rich);
    assert_int_equal(run("$I simulate rich.yaml --rate 100Hz --duration 10min --seed 3 -o r.csv"),
                     0);
    assert_int_equal(run("$I identify r.csv --report r.html"), 0);
    check_row("line of 7 Hz", 60, 2, "deg/h");
    check_row("output filter, bandwidth", 20, 1, "Hz");
    check_row("resonance at 3", 2, 0.2, "mg");
    read_text("r.html", out);
    check_contains(out, ">line of 7 Hz</th>", "row of the page");
    check_contains(out, "angle random walk, filter of ", "filter");
    check_contains(out, ">Gauss-Markov, ", "Gauss-Markov");
    check_contains(out, ">line of 7 Hz<", "line");
    check_contains(out, ">resonance at 3", "resonance");
    assert_null(strstr(out, "Twin: "));
    assert_null(strstr(out, "Tinted: "));
    assert_null(strstr(out, "the model does not hold"));
    assert_int_equal(run("$I identify r.csv --report r.html --twin"), 0);
    read_text("r.html", out);
    check_contains(out, "Twin: a simulation of the model.", "caption");
    sweep();
}

/* Jumps of the level are in no model. */
static void test_where_it_does_not_hold(void **state)
{
    (void)state;
    assert_int_equal(run("$I simulate AHRS --rate 100Hz --duration 10min --seed 3 -o s.csv"), 0);
    assert_int_equal(run("awk -F, -v OFS=, 'NR > 1 {$2 += 0.02 * sin(NR / 955)^3} {print $1, $2}' "
                         "s.csv >cycle.csv; $I identify cycle.csv --keep all --report r.html"),
                     0);
    check_contains(out, "Usable with care: ", out);
    read_text("r.html", out);
    check_contains(out, "the model does not hold", "region");
    check_contains(out, "Tinted: where the model does not hold.", "caption");
    sweep();
}

/* A term and axis in a row: value, sigma, interval and unit, of less than 100 characters. */
static void test_rows(void **state)
{
    (void)state;
    assert_int_equal(run("$I simulate AHRS --rate 100Hz --duration 1min -o s.csv"), 0);
    assert_int_equal(run("$I identify s.csv"), 0);
    check_contains(out, "\ngyro               axis  value ± 1 sigma ", out);
    check_contains(out, "\nangle random walk  x     0.", out);
    check_contains(out, "\n                   z     0.", out);
    check_contains(out, "\ngyro  mean [deg/h]  Allan minimum / 0.664 [deg/h]  model holds, tau [s]",
                   out);
    char *table = strchr(out, '\n');
    for (char *row = strtok(table, "\n"); row && row[0] != 'T'; row = strtok(NULL, "\n")) {
        size_t length = 0;
        for (const char *c = row; *c; c += imk_utf8_length(c))
            length++;
        if (length > 100)
            fail_msg("%zu characters: %s", length, row);
    }
    sweep();
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_all_is_drawn),
                                       cmocka_unit_test(test_where_it_does_not_hold),
                                       cmocka_unit_test(test_rows)};
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
