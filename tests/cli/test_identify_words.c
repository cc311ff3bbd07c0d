/* SPDX-License-Identifier: Apache-2.0 */
/* What identify says first: one sentence that is true of the log, and little after it. Where
 * mistakes of memory are looked for, logs that differ in words only are left out. */
#include "check.h"

#include "run_command.h"

/* An awk program that changes a row after the header. */
#define CHANGE "awk -F, -v OFS=, 'NR == 1 { print; next } { t = $1; %s; print }'"

/* A quarter of an hour of three gyros and three accelerometers at 20 Hz. The awk program
 * changes a row; of the columns, time first, so many are kept. */
static void make_columns(int columns, const char *change)
{
    char line[1200];
    put("model.yaml", "imukit: 1\n"
                      "gyro: {noise: {angle_random_walk: 0.3 deg/sqrt(h)}}\n"
                      "accel: {noise: {velocity_random_walk: 0.05 m/s/sqrt(h)}}\n");
    assert_int_equal(
        run("$I simulate model.yaml --rate 20Hz --duration 15min --seed 4 -o sound.csv"), 0);
    snprintf(line, sizeof line, CHANGE " sound.csv | cut -d, -f1-%d > log.csv", change, columns);
    assert_int_equal(run(line), 0);
}

static void make_log(const char *change)
{
    make_columns(7, change);
}

/* Where accelerometers add nothing. */
static void make_gyros(const char *change)
{
    make_columns(4, change);
}

/* Three gyros at 100 Hz. */
static void make_long_log(int minutes)
{
    char line[200];
    put("gyros.yaml", "imukit: 1\ngyro: {noise: {angle_random_walk: 0.3 deg/sqrt(h), "
                      "bias_instability: 8 deg/h}}\n");
    snprintf(line, sizeof line,
             "$I simulate gyros.yaml --rate 100Hz --duration %dmin --seed 4 -o long.csv", minutes);
    assert_int_equal(run(line), 0);
}

static void identify_log(const char *options)
{
    char line[300];
    snprintf(line, sizeof line, "$I identify log.csv %s", options);
    assert_int_equal(run(line), 0);
}

static void check_first(const char *sentence)
{
    check_contains(out, sentence, "first line");
    assert_ptr_equal(strstr(out, sentence), out);
}

/* Words that are no table: the first line, and the lines after the last table. */
static size_t words_of_verdict(void)
{
    size_t words = 0;
    bool last_space = true;
    const char *after = strstr(out, "\n\n"), *next = after;
    while ((next = strstr(after + 2, "\n\n")) != NULL)
        after = next;
    for (const char *c = out; *c; c++) {
        if (*c == '\n' && c < after)
            c = after;
        words += last_space && *c != ' ' && *c != '\n';
        last_space = *c == ' ' || *c == '\n';
    }
    return words;
}

static void test_sound(void **state)
{
    (void)state;
    make_log("");
    identify_log("");
    check_first("Usable for the white noise: no test found a fault, but the record is too short");
    assert_string_equal(err, "");
    assert_int_equal(run("$I identify log.csv --strict"), 0);
    sweep();
}

static void test_step(void **state)
{
    (void)state;
    make_gyros("if (t > 450) $3 += 1");
    identify_log("");
    check_first("Usable with care: the slow terms of gyro_y include jumps of the level.\n");
    check_contains(out, "\nJumps of the level: gyro_y.\n", "list");
    check_contains(err, "warning: the slow terms of gyro_y include jumps of the level\n",
                   "warning");
    assert_null(strstr(out, "was touched"));
    if (check_quick()) {
        sweep();
        return;
    }
    identify_log("--verbose");
    check_contains(out, "was touched", "whole message");
    assert_int_equal(run("$I identify log.csv --strict"), 1);
    sweep();
}

static void test_json(void **state)
{
    (void)state;
    if (check_quick())
        return;
    make_gyros("if (t > 450) $3 += 1");
    identify_log("--json");
    json_t *root = json_loads(out, 0, NULL);
    json_t *usability = json_object_get(json_object_get(root, "result"), "usability");
    assert_string_equal(json_string_value(json_object_get(usability, "grade")), "usable with care");
    assert_string_equal(json_string_value(json_object_get(usability, "sentence")),
                        "Usable with care: the slow terms of gyro_y include jumps of the level.");
    json_decref(root);
    sweep();
}

/* Two channels with a tone and its harmonic stand on one table; one alone is interference. */
static void test_vibration(void **state)
{
    (void)state;
    make_gyros(
        "s = sin(6.2831853 * 2.7 * t) + sin(6.2831853 * 5.4 * t) / 2; $2 += s / 20; $3 += s / "
        "15");
    identify_log("--verbose");
    check_contains(out, "vibrates (a fan, a motor, the building), at 2.", "tones");
    if (check_quick()) {
        sweep();
        return;
    }
    identify_log("");
    check_contains(out, "Vibration of what the sensor stands on, in gyro_x and gyro_y.", "list");
    assert_null(strstr(out, "averages"));
    make_gyros("$2 += sin(6.2831853 * 2.7 * t) / 20");
    identify_log("--verbose");
    assert_null(strstr(out, "what the sensor stands on"));
    check_contains(out, "2.7 Hz", "tone");
    sweep();
}

/* The zeros of a mean of neighbours are at the same frequencies in all channels. */
static void test_averages(void **state)
{
    (void)state;
    make_long_log(11);
    assert_int_equal(run("awk -F, -v OFS=, 'NR == 1 { print; next } { for (c = 2; c <= 4; c++) { v "
                         "= $c; for (k = 4; k > 0; k--) { h[c, k] = h[c, k - 1]; v += h[c, k] } "
                         "h[c, 0] = $c; $c = v / 5 } } NR > 6 && NR < 60007' long.csv > log.csv"),
                     0);
    identify_log("--verbose");
    check_contains(out, "or the logger wrote averages of several samples", out);
    if (check_quick()) {
        sweep();
        return;
    }
    identify_log("");
    check_contains(out, "stands on, or averages of the logger: all channels.", out);
    sweep();
}

static const char limits[] =
    "\nCannot be seen in a log: a wrong unit or rate of the time; a wrong unit "
    "or range of the gyros; accelerometer scales off by up to 5 %.\n";

/* Many things at once: a jump, tones, outliers, gaps. There is no room for all notes, but for what
 * no log can show. */
static void test_length(void **state)
{
    (void)state;
    make_log("for (c = 2; c <= 7; c++) $c += (t > 450) + sin(6.2831853 * 2.7 * t) / 20; if (NR % "
             "4001 == 0) $2 += 10; if (NR % 300 == 0) next");
    identify_log("");
    check_first("Usable with care: ");
    assert_in_range(words_of_verdict(), 20, 140); /* the sentence and 120 */
    check_contains(out, "all channels", "names");
    check_contains(out, limits, "limits");
    sweep();
}

/* A driver that filters, y += a (x - y): N behind it is 0.3 deg/sqrt(h). */
static void test_filter_of_the_driver(void **state)
{
    (void)state;
    make_columns(5, "for (i = 2; i < 5; i++) $i = y[i] += 0.2 * ($i - y[i])");
    identify_log("--verbose");
    check_first("Usable with care: the white noise of the gyros may be larger, behind a low-pass "
                "filter");
    check_contains(out, "behind a filter of", "N behind the filter");
    const char *place = strstr(out, "gyro_x (");
    assert_non_null(place);
    CHECK_CLOSE(strtod(place + strlen("gyro_x ("), NULL), 0.3, 0.015); /* 5 %: four sigma */
    sweep();
}

/* A tenth of the log is one value of one axis; a fiftieth is only left out. */
static void test_standing_still(void **state)
{
    (void)state;
    make_gyros("if (t > 300 && t < 390) $4 = z; else z = $4");
    identify_log("");
    check_first("Usable with care: gyro_z stands still for a part of the log");
    if (check_quick()) {
        sweep();
        return;
    }
    make_gyros("if (t > 300 && t < 390) { $3 = y; $4 = z } else { y = $3; z = $4 }");
    identify_log("");
    check_first("Usable with care: gyro_y and gyro_z stand still for a part of the log");
    make_gyros("if (t > 300 && t < 318) $4 = z; else z = $4");
    identify_log("--strict");
    sweep();
}

/* A column of another unit or another place: its white noise is unlike that of its triad. */
static void test_axis_of_another_unit(void **state)
{
    (void)state;
    make_log("$5 /= 9.80665");
    identify_log("");
    check_first("Usable with care: the white noise of accel_x is 9.");
    check_contains(out, "times smaller than that of the other two axes, as if it were in g.", out);
    if (check_quick()) {
        sweep();
        return;
    }
    make_log("$3 *= 3.141592653589793 / 180");
    identify_log("");
    check_contains(out, "times smaller than that of the other two axes, as if it were in rad/s.",
                   out);
    make_log("z = $4; $4 = $6; $6 = z");
    identify_log("--json");
    check_contains(out, "the white noise of gyro_z is", out);
    check_contains(out, "the white noise of accel_y is", out);
    check_contains(out, "\"axis_differs\"", out);
    make_log("$4 *= 3");
    identify_log("");
    assert_null(strstr(out, "the white noise of"));
    sweep();
}

static void test_numbers_of_no_gyro(void **state)
{
    (void)state;
    if (check_quick()) /* words alone differ */
        return;
    make_columns(5, "for (c = 2; c < 5; c++) $c *= 57.3");
    identify_log("");
    check_first("Usable with care: the numbers of the gyros are no gyro's at rest: a wrong unit");
    if (check_quick()) {
        sweep();
        return;
    }
    make_columns(5, "$3 += 40");
    identify_log("");
    check_first("Usable with care: the numbers of gyro_y are no gyro's at rest");
    make_columns(5, "for (c = 2; c < 5; c++) $c = 9 * $c + 20");
    identify_log("");
    assert_null(strstr(out, "no gyro's"));
    sweep();
}

/* What no log can show is said beside every verdict, and only what applies. */
static void test_what_cannot_be_seen(void **state)
{
    (void)state;
    make_log("");
    identify_log("--strict");
    check_contains(out, limits, "limits");
    identify_log("--json");
    check_contains(out, "\"not_testable\"", "code");
    if (check_quick()) {
        sweep();
        return;
    }
    assert_int_equal(run("cut -d, -f2-5 log.csv > part.csv && $I identify part.csv --rate 20Hz"),
                     0);
    check_contains(out,
                   "a wrong --rate; a wrong unit or range of the gyros; a wrong unit of the "
                   "accelerometers.\n",
                   "of a part");
    assert_int_equal(run("cut -d, -f1,5- log.csv > part.csv && $I identify part.csv"), 0);
    check_contains(out, "time; accelerometer scales", "without gyros");
    sweep();
}

/* The part at rest is that of all channels: the longest ones of both share 20 s here. */
static void test_part_at_rest(void **state)
{
    (void)state;
    make_gyros(
        "a = 40 * sin(t / 2); if (t > 100 && t < 110 || t > 450 && t < 460) $2 += a; if (t > "
        "480 && t < 490 || t > 850) $3 += a");
    assert_int_equal(run("$I identify log.csv"), 0);
    check_contains(out, "Not usable: the sensor was moved", "first line");
    double after = 0, before = 0;
    const char *at = strstr(out, "--after ");
    assert_non_null(at);
    assert_int_equal(sscanf(at, "--after %lfs --before %lf", &after, &before), 2);
    assert_in_range(after, 490, 500); /* the rests are 100, 340, 20 and 360 s */
    assert_in_range(before, 840, 850);
    char line[200];
    snprintf(line, sizeof line, "$I identify log.csv --after %gs --before %gs --strict", after,
             before);
    assert_int_equal(run(line), 0);
    sweep();
}

/* A channel that has no model says why: what the screening saw in it. */
static void test_no_model(void **state)
{
    (void)state;
    static const struct {
        const char *change, *told;
    } logs[] = {
        {"if (NR % 89 == 0) $4 = -32768 + NR / 100",
         "gyro_z: 2022 of 180000 samples are off the others by up to 32767 deg/s, too many"},
        {"$4 = NR % 2", "gyro_z: there is no noise in the record: it is smooth or too regular"},
    };
    make_long_log(30);
    for (size_t k = 0; k < sizeof logs / sizeof logs[0]; k++) {
        if (check_skips(k, 2))
            continue;
        char line[400];
        snprintf(line, sizeof line,
                 CHANGE " long.csv | cut -d, -f1,4 > log.csv && $I identify log.csv",
                 logs[k].change);
        assert_int_equal(run(line), 1);
        check_contains(err, logs[k].told, err);
        check_contains(err, "leave it out with --map (in a log without names with --columns)", err);
        assert_null(strstr(err, "converge"));
    }
    sweep();
}

/* A motion that repeats, but not quite, is a narrow line with skirts far above the noise: these are
 * part of the model, and the noise is what it was. */
static void test_motion_that_wanders(void **state)
{
    (void)state;
    make_long_log(30);
    char line[400];
    snprintf(line, sizeof line, CHANGE " long.csv | cut -d, -f1,4 > log.csv && $I identify log.csv",
             "$4 += 0.03 * sin(6.2832 * (p += (0.25 + 0.1 * sin(NR * NR)) / 100))");
    assert_int_equal(run(line), 0);
    double found = 0;
    const char *row = strstr(out, "angle random walk");
    assert_non_null(row);
    assert_int_equal(sscanf(row, "angle random walk %*s %lf", &found), 1);
    CHECK_CLOSE(found, 0.3, 0.002);
    sweep();
}

/* Codes at a regular distance make lines all over the spectrum, more than can be taken out: what is
 * left is none of the sensor's noise, and the codes are named. */
static void test_lines_everywhere(void **state)
{
    (void)state;
    if (check_quick())
        return;
    make_gyros("if (NR % 97 == 0) $3 = -999 - NR / 1000");
    assert_int_equal(run("$I identify log.csv"), 1);
    check_contains(err, "gyro_y: 185 of 18000 samples are off the others by up to 1016.9 deg/s",
                   err);
    sweep();
}

/* Between the samples of a slower sensor the noise is weaker. */
static void test_one_or_several(void **state)
{
    (void)state;
    if (check_quick()) /* test_interpolated goes the same way */
        return;
    make_gyros("if (NR % 3) $4 *= 0.75");
    identify_log("");
    check_contains(out, "gyro_z looks interpolated from a slower sensor", out);
    if (check_quick()) {
        sweep();
        return;
    }
    make_log("if (NR % 3) { $4 *= 0.75; $5 *= 0.75 }");
    identify_log("");
    check_contains(out, "gyro_z and accel_x look interpolated from a slower sensor", out);
    sweep();
}

/* A unit that the header states already. */
static void test_unit_of_the_header(void **state)
{
    (void)state;
    if (check_quick()) /* words alone differ */
        return;
    make_log("");
    identify_log("--gyro-unit deg/s --time-unit s");
    assert_null(strstr(err, "--gyro-unit"));
    assert_int_equal(run("$I identify log.csv --accel-unit g"), 1);
    check_contains(
        err, "--accel-unit g does not agree with the file, which says accel_x [m/s^2]; leave", err);
    assert_int_equal(run("$I allan log.csv --time-unit ms"), 1);
    check_contains(err, "--time-unit ms does not agree with the file, which says time [s]", err);
    assert_int_equal(run("sed '1s/ .m.s.2.//g' log.csv > none.csv && $I identify none.csv "
                         "--accel-unit m/s^2"),
                     0);
    assert_null(strstr(err, "agree"));
    sweep();
}

/* Stamps that several rows share are no steps of the output. */
static void test_shared_stamps(void **state)
{
    (void)state;
    make_log("$1 = int(t / 0.1) / 10");
    identify_log("");
    check_contains(out, "\nOne stamp for several rows, which are counted.\n", "brief");
    assert_null(strstr(out, "output step"));
    assert_int_equal(run("$I info log.csv"), 0);
    check_contains(out, "rate      20 Hz, as the analyses read the stamps\n", "rate");
    check_contains(out, "\nNote: one stamp of the time column is that of 2 rows", "note");
    assert_null(strstr(out, "jitter"));
    assert_int_equal(run("$I info log.csv --json"), 0);
    check_contains(out, "\"findings\": [", "findings");
    check_contains(out, "\"code\": \"coarse_stamps\"", "findings");
    sweep();
}

/* Codes for lost rows, the same in all columns, make no column one that is computed. */
static void test_codes_in_all_columns(void **state)
{
    (void)state;
    if (check_quick()) /* test_zeros goes the same way */
        return;
    make_log("if (NR % 500 == 0) for (i = 2; i < 8; i++) $i = -9999");
    identify_log("--verbose");
    check_contains(out, "as a logger writes it for a row that was lost; left out", "codes");
    assert_null(strstr(out, "computed from the other"));
    sweep();
}

/* Movement at both ends is not one in between; what comes from the reading is a sentence among the
 * others of the page. */
static void test_ends(void **state)
{
    (void)state;
    make_log("if (t < 10 || t > 892) { $2 += 40 * sin(NR / 3); $3 += 30 * cos(NR / 2) } if (NR == "
             "9000) $1 = t - 0.05");
    identify_log("--report p.html");
    check_contains(out, "Not usable: the sensor was moved, or had not settled, at times between ",
                   out);
    assert_int_equal(run("cat p.html"), 0);
    check_contains(out, "1 row whose time does not increase: left out. ", "page");
    sweep();
}

/* What is suggested next succeeds: white noise alone says nothing of a grade. */
static void next_lines_succeed(void **state)
{
    (void)state;
    put("white.yaml", "imukit: 1\ngyro: {noise: {angle_random_walk: 0.3 deg/sqrt(h)}}\n");
    assert_int_equal(run("$I simulate white.yaml --rate 100Hz --duration 60s --seed 2 -o w.csv && "
                         "$I identify w.csv -o w.yaml"),
                     0);
    assert_null(strstr(out, "imukit grade"));
    check_contains(out, "Next: imukit convert w.yaml filter.yaml --to filter --rate 100Hz", out);
    assert_int_equal(run("$I convert w.yaml filter.yaml --to filter --rate 100Hz"), 0);
    assert_int_equal(run("$I grade w.yaml"), 1);
    /* What a page suggests reads the log as it was read. */
    assert_int_equal(run("sed '1s/ .[^,]*//g' w.csv > bare.csv && $I identify bare.csv "
                         "--time-unit s --gyro-unit=deg/s -o w.yaml --report p.html --json && grep "
                         "-o 'imukit identify .* --into MODEL' p.html"),
                     0);
    check_contains(out, "imukit identify bare.csv --time-unit s --gyro-unit=deg/s --into MODEL",
                   "page");
    sweep();
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(next_lines_succeed),
                                       cmocka_unit_test(test_ends),
                                       cmocka_unit_test(test_sound),
                                       cmocka_unit_test(test_step),
                                       cmocka_unit_test(test_json),
                                       cmocka_unit_test(test_vibration),
                                       cmocka_unit_test(test_length),
                                       cmocka_unit_test(test_filter_of_the_driver),
                                       cmocka_unit_test(test_standing_still),
                                       cmocka_unit_test(test_axis_of_another_unit),
                                       cmocka_unit_test(test_numbers_of_no_gyro),
                                       cmocka_unit_test(test_what_cannot_be_seen),
                                       cmocka_unit_test(test_part_at_rest),
                                       cmocka_unit_test(test_no_model),
                                       cmocka_unit_test(test_motion_that_wanders),
                                       cmocka_unit_test(test_averages),
                                       cmocka_unit_test(test_unit_of_the_header),
                                       cmocka_unit_test(test_one_or_several),
                                       cmocka_unit_test(test_shared_stamps),
                                       cmocka_unit_test(test_codes_in_all_columns),
                                       cmocka_unit_test(test_lines_everywhere)};
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
