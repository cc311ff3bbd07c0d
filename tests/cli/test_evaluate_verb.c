/* SPDX-License-Identifier: Apache-2.0 */
/* imukit evaluate: tables and logs in, figures out; exact text, JSON, limits, messages. */
#include "run_command.h"

#include <math.h>

/* y = 0.1 + 1.001 x + 0.0003 x^2, and 0.02 more when rising at 0, less towards the ends; three
 * times -10 … 10 and back, with 0, 0.005 and -0.005 added. */
static void write_table(const char *path, const char *reading, double scale)
{
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    fprintf(file, "reference [deg/s],%s\n", reading);
    for (int k = 0; k < 120; k++) {
        const int place = k % 40 < 20 ? k % 40 : 40 - k % 40;
        const double x = place - 10, loop = (k % 40 < 20 ? 0.01 : -0.01) * (1 - x * x / 100);
        const double noise = 0.005 * (k / 40 == 1 ? 1 : k / 40 == 2 ? -1 : 0);
        fprintf(file, "%g,%.6f\n", x, scale * (0.1 + 1.001 * x + 0.0003 * x * x + loop + noise));
    }
    fclose(file);
}

static void test_table(void **state)
{
    (void)state;
    write_table("t.csv", "reading [deg/s]", 1);
    /* By hand: zero 0.11 (the mean of 0.0003 x^2 and of the directions), precision as in
     * test_counts, best line 0.015/10.01, hysteresis 0.02/10.01. */
    assert_int_equal(run("$I evaluate t.csv"), 0);
    assert_string_equal(err, "");
    assert_string_equal(out,
                        "Usable: the scale factor is known to 158 ppm; linearity is 0.254 % of "
                        "full scale or better.\n\n"
                        "reading: 120 readings at 21 levels in 1 run; full scale 10 deg/s; noise "
                        "from replicates (79 degrees of freedom)\n"
                        "\n"
                        "reading                           value        95 % interval  unit\n"
                        "sensitivity (scale factor)     1.001000  1.000842 … 1.001158  1\n"
                        "scale factor error                 1000           842 … 1158  ppm\n"
                        "reading at zero (bias)          0.11005    0.10914 … 0.11096  deg/s\n"
                        "accuracy                         0.1400      0.1346 … 0.1458  deg/s\n"
                        "accuracy with coverage           0.1483      0.1428 … 0.1545  deg/s\n"
                        "precision                       0.00503    0.00435 … 0.00596  deg/s\n"
                        "linearity, least-squares line     0.199        0.137 … 0.254  %\n"
                        "linearity, best line              0.150        0.109 … 0.179  %\n"
                        "hysteresis                        0.200        0.077 … 0.281  %\n"
                        "asymmetry (K+ - K-)/K              5994          5367 … 6621  ppm\n"
                        "resolution                            -           up to 1.00  deg/s\n"
                        "threshold                             -           up to 1.00  deg/s\n"
                        "\n"
                        "Every step that exceeds the noise gave its change, down to 1 deg/s: the "
                        "resolution and the threshold are finer than what was tested. To find "
                        "them, test smaller steps.\n");
    sweep();
}

static json_t *channel_of(const char *line, json_t **document)
{
    json_error_t problem;
    if (run(line) != 0)
        fail_msg("%s: %s", line, err);
    *document = json_loads(out, 0, &problem);
    if (!*document)
        fail_msg("%s: %s", problem.text, out);
    json_t *result = json_object_get(*document, "result");
    return json_array_get(json_object_get(result, "channels"), 0);
}

static double figure(json_t *channel, const char *name, const char *part)
{
    json_t *value =
        json_object_get(json_object_get(json_object_get(channel, "figures"), name), part);
    return json_is_number(value) ? json_number_value(value) : (double)NAN;
}

/* Counts with the nominal sensitivity are the same figures as those in the unit; without it there
 * is no accuracy, and a slope in counts. */
static void test_counts(void **state)
{
    (void)state;
    const double degree = 0.017453292519943295;
    json_t *document;
    write_table("c.csv", "reading [count]", 131);
    json_t *channel =
        channel_of("$I evaluate c.csv --sensitivity '131 count/(deg/s)' --json", &document);
    /* Written with six decimals of counts: 1e-8 deg/s. */
    CHECK_RELATIVE(figure(channel, "sensitivity", "value"), 1.001, 1e-7);
    CHECK_RELATIVE(figure(channel, "hysteresis", "value"), 0.02 / 10.01, 1e-5);
    /* Largest error, at 10 deg/s: 0.1 + 0.01 of the scale + 0.03. */
    CHECK_RELATIVE(figure(channel, "accuracy", "value"), 0.14 * degree, 1e-6);
    /* Three readings 0, 0.005, -0.005 in each of 39 cells, two at the first level, which is reached
     * from nowhere once: squares 39 * 5e-5 + 5e-5 with 120 - 41 degrees of freedom. */
    CHECK_RELATIVE(figure(channel, "precision", "value"), sqrt(40 * 5e-5 / 79) * degree, 1e-5);
    json_decref(document);
    channel = channel_of("$I evaluate c.csv --json", &document);
    CHECK_RELATIVE(figure(channel, "sensitivity", "value"), 131 * 1.001 / degree, 1e-7);
    assert_true(isnan(figure(channel, "accuracy", "value")));
    assert_string_equal(
        json_string_value(json_object_get(
            json_object_get(json_object_get(channel, "figures"), "sensitivity"), "unit")),
        "count/(rad/s)");
    json_decref(document);
    sweep();
}

static void test_runs_and_directions(void **state)
{
    (void)state;
    json_t *document;
    put("a.csv", "reference [g],reading_x [g],direction\n-1,-1.1,up\n0,-0.1,up\n1,0.9,up\n"
                 "0,-0.12,down\n");
    put("b.csv", "reference [g],reading_x [g],direction\n-1,-0.9,up\n0,0.1,up\n1,1.1,up\n"
                 "0,0.08,down\n");
    json_t *channel = channel_of("$I evaluate a.csv b.csv --json", &document);
    assert_string_equal(json_string_value(json_object_get(channel, "name")), "x");
    assert_int_equal(json_integer_value(json_object_get(channel, "runs")), 2);
    CHECK_RELATIVE(figure(channel, "hysteresis", "value"), 0.02, 1e-9);
    /* Two runs that differ by 0.2 g: 0.2/sqrt(2). */
    CHECK_RELATIVE(figure(channel, "zero_repeatability", "value"), 0.2 / sqrt(2) * 9.80665, 1e-9);
    json_decref(document);
    sweep();
}

/* What is given is looked at, or refused where it would have no use. */
static void test_options_without_use(void **state)
{
    (void)state;
    static const char *const cases[][2] = {
        {"--sensitivity garbage",
         "--sensitivity is for readings in counts, and there are none: leave --sensitivity out"},
        {"--zero nan", "--zero is used with --sensitivity only: add --sensitivity"},
        {"--motion-offset infs", "--motion-offset is used with --motion only: add --motion"},
        {"--motion missing.yaml", "--motion is for logs, and all files are tables: leave it out"},
        {"--section run", "--section is for logs, and all files are tables: leave it out"},
        {"--table-axis z", "--table-axis is for logs, and all files are tables: leave it out"}};
    char line[200], says[200];
    write_table("t.csv", "reading [deg/s]", 1);
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        snprintf(line, sizeof line, "$I evaluate t.csv %s", cases[i][0]);
        snprintf(says, sizeof says, "imukit evaluate: error: %s\n" TRY("evaluate"), cases[i][1]);
        check_message(line, 2, says);
    }
    sweep();
}

static void test_limits(void **state)
{
    (void)state;
    write_table("t.csv", "reading [deg/s]", 1);
    check_message("$I evaluate t.csv --strict --limit 'hysteresis 0.3 %, precision 0.01 deg/s'", 0,
                  "");
    check_contains(out, "0.3 %", out);
    check_contains(out, "met\n", out);
    check_message("$I evaluate t.csv --strict --limit 'hysteresis 0.1 %'", 1,
                  "imukit evaluate: warning: reading: hysteresis is beyond its limit (limit 0.1 "
                  "%)\n");
    check_message("$I evaluate t.csv --limit 'hysteresis 0.1 %'", 0,
                  "imukit evaluate: warning: reading: hysteresis is beyond its limit (limit 0.1 "
                  "%)\n");
    check_contains(out, "not met\n", out);
    /* All steps of 1 deg/s passed: the resolution is within 1, and nothing tells of less. */
    check_message("$I evaluate t.csv --strict --limit 'resolution 1 deg/s, threshold 2 deg/s'", 0,
                  "");
    check_message("$I evaluate t.csv --limit 'resolution 0.5 deg/s'", 0,
                  "imukit evaluate: warning: reading: resolution is not determined (limit 0.5 "
                  "deg/s)\n");
    check_message("$I evaluate t.csv --limit 'histeresis 0.1 %'", 2,
                  "imukit evaluate: error: --limit: there is no figure \"histeresis\"; did you "
                  "mean \"hysteresis\"?\n" TRY("evaluate"));
    check_message(
        "$I evaluate t.csv --limit 'zero_repeatability 0.1 deg/s'", 2,
        "imukit evaluate: error: --limit zero_repeatability: these files do not give this figure; "
        "it needs two runs: add a column run, or give a file for each run\n" TRY("evaluate"));
    assert_int_equal(run("$I evaluate t.csv --limit 'zero 0.1 g'"), 2);
    check_contains(err, "--limit zero of reading: \"0.1 g\" is ", err);
    /* Each limit must be of something, whatever the others are of. */
    assert_int_equal(run("$I evaluate t.csv --limit 'zero 0.1 g, zero 1 deg/s'"), 2);
    check_contains(err, "--limit zero of reading: ", err);
    sweep();
}

static void test_messages(void **state)
{
    (void)state;
    check_message("$I evaluate", 2,
                  "imukit evaluate: error: an operand is missing: imukit evaluate FILE..., or "
                  "--static LOG\n" TRY("evaluate"));
    put("n.csv", "reference,reading [deg/s]\n1,2\n2,3\n");
    check_message("$I evaluate n.csv", 1,
                  "imukit evaluate: error: n.csv: reference has no unit; write it into the header, "
                  "such as reference [deg/s] or reference [count]\n");
    put("d.csv", "reference [g],reading [g],direction\n1,2,left\n2,3,up\n");
    check_message("$I evaluate d.csv", 1,
                  "imukit evaluate: error: row 1: direction \"left\"; expected up, down or -\n");
    write_good();
    check_message(
        "$I evaluate good.csv", 1,
        "imukit evaluate: error: good.csv does not contain the reference motion of the unit; add "
        "--motion PROGRAMME, or columns reference_rate_z [deg/s] … or table_rate [deg/s] with "
        "--table-axis; for a unit at rest use --static good.csv\n");
    sweep();
}

/* A log of a rate table: steps of 2 s at 100 Hz, the gyro 1 % high; and one at rest. */
static void test_logs(void **state)
{
    (void)state;
    static const int steps[] = {0,  20, 40, 20, 0,   -20, -40, -20, 0,
                                20, 40, 20, 0,  -20, -40, -20, 0};
    json_t *document;
    FILE *file = fopen("steps.csv", "wb");
    assert_non_null(file);
    uint64_t n = 1;
    fputs("time [s],gyro_z [deg/s],table_rate [deg/s]\n", file);
    for (size_t k = 0; k < 200 * sizeof steps / sizeof *steps; k++, n = 16807 * n % 2147483647)
        fprintf(file, "%.2f,%.6f,%d\n", (double)k / 100,
                1.01 * steps[k / 200] + 0.3 + 0.1 * ((double)n / 2147483647 - 0.5), steps[k / 200]);
    fclose(file);
    /* A log of one gyro needs no other axes. */
    const char *line = "$I evaluate steps.csv --table-axis z";
    assert_int_equal(run(line), 0);
    check_contains(out, "gyro_z: 17 readings", line);
    assert_int_equal(run("sed -i 's/gyro_z/gyro_x/' steps.csv"), 0);
    json_t *channel = channel_of("$I evaluate steps.csv --table-axis x --json", &document);
    CHECK_RELATIVE(figure(channel, "sensitivity", "value"), 1.01, 1e-3);
    assert_int_equal(json_array_size(json_object_get(channel, "levels")), 5);
    assert_int_equal(json_integer_value(json_object_get(channel, "readings")), 17);
    json_decref(document);
    write_good();
    assert_int_equal(run("$I evaluate --static good.csv"), 0);
    check_contains(out, "bias instability B, fitted", out);
    check_contains(out, "Allan minimum / 0.664", out);
    sweep();
}

static void test_report(void **state)
{
    (void)state;
    write_table("t.csv", "reading [deg/s]", 1);
    assert_int_equal(run("$I evaluate t.csv --limit 'hysteresis 0.1 %' --unit 'A <b>' --serial 7 "
                         "--plot p.svg --report r.html"),
                     0);
    read_text("r.html", out);
    check_contains(out, "A &lt;b&gt;", "page");
    check_contains(out, "reading, hysteresis: not met (limit 0.1 %).", "page");
    check_contains(out, "<div class=\"sheet\"></div>", "page");
    check_contains(out, "Levels of reading", "page");
    assert_null(strstr(out, "Operator"));
    assert_null(strstr(out, "nan"));
    read_text("p.svg", out);
    check_contains(out, "best line", "figure");
    check_contains(out, "falling", "figure");
    sweep();
}

/* Two panels for each channel that has a loop, however many channels. */
static void test_plot_of_several_channels(void **state)
{
    (void)state;
    write_table("t.csv", "reading_x [deg/s]", 1);
    assert_int_equal(run("awk -F, 'NR == 1 { print $0 \",reading_y [deg/s],reading_z [deg/s]\" }"
                         " NR > 1 { print $0 \",\" $2 \",\" $2 }' t.csv >three.csv && "
                         "$I evaluate three.csv --plot p.svg"),
                     0);
    read_text("p.svg", out);
    check_contains(out, "x: hysteresis", "figure");
    check_contains(out, "y: hysteresis", "figure");
    check_contains(out, "z: hysteresis", "figure");
    sweep();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_table),
        cmocka_unit_test(test_counts),
        cmocka_unit_test(test_limits),
        cmocka_unit_test(test_runs_and_directions),
        cmocka_unit_test(test_messages),
        cmocka_unit_test(test_options_without_use),
        cmocka_unit_test(test_logs),
        cmocka_unit_test(test_report),
        cmocka_unit_test(test_plot_of_several_channels),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
