/* SPDX-License-Identifier: Apache-2.0 */
/* Logs, models and outputs that are wrong: the message, the exit code, and nothing left behind. */
#include "run_command.h"

#include "imukit/utf8.h"

#include "imukit/memory_limit.h"

#define REMEDY "use --gaps longest (the longest clean stretch) or --gaps bridge (interpolate)\n"

/* How the file is made, and what every verb that analyses a log says about it. */
static const struct bad_log {
    const char *make, *file, *says;
} bad_logs[] = {
    {":", "missing.csv",
     "missing.csv: the file cannot be opened: No such file or directory; check the path\n"},
    {"mkdir dir.csv", "dir.csv",
     "dir.csv: this is a folder, without a metadata.yaml; give a file, or the folder of a bag of "
     "ROS 2 (ros2 bag reindex FOLDER writes that file)\n"},
    {": >empty.csv", "empty.csv", "empty.csv: the file is empty\n"},
    {"head -1 good.csv >b.csv", "b.csv", "b.csv: the log has a header but no rows; expected"},
    {"head -2 good.csv >b.csv", "b.csv",
     "b.csv: there is only one row; record minutes to hours at rest\n"},
    {"sed '1s/ .deg.*//' good.csv >b.csv", "b.csv",
     "add --gyro-unit UNIT (UNIT is the unit of the log: deg/s, rad/s, count, …)\nNext: imukit "},
    {"cut -d, -f2 good.csv >b.csv", "b.csv",
     "add --rate RATE (samples per second, as in --rate 100Hz)\nNext: imukit "},
    {"sed 1d good.csv >b.csv", "b.csv", "add --columns "},
    {"sed '1s/deg.s/g/' good.csv >b.csv", "b.csv", "expected an angular rate, such as deg/h"},
    {"sed '1s/deg.s/dge\\/s/' good.csv >b.csv", "b.csv", "dge"},
    {"sed '2,$s/,.*/,5/' good.csv >b.csv", "b.csv",
     "b.csv: column gyro_x is constant in all 1000 rows: there is no noise to "},
    {"sed '500,$s/,.*/,abc/' good.csv >b.csv", "b.csv",
     "b.csv:500:6: gyro_x: \"abc\" cannot be read; expected "},
    {"sed '500,$s/,.*//' good.csv >b.csv", "b.csv", "b.csv:500: "},
    {"gzip -c good.csv | head -c 3000 >b.csv.gz", "b.csv.gz",
     "b.csv.gz: the gzip data is cut short"},
    {"head -c 9000 /dev/urandom >b.csv", "b.csv", "not a text log"},
    {"truncate -s 1000000000 b.csv", "b.csv", "not a text log"},
    {"head -c 9000000 /dev/zero | tr '\\0' 1 >b.csv", "b.csv", "b.csv:1: "},
};

static void test_bad_logs(void **state)
{
    (void)state;
    static const char *const analyses[] = {"identify", "allan"};
    char line[600], prefix[100];
    for (size_t i = 0; i < sizeof bad_logs / sizeof bad_logs[0]; i++) {
        for (size_t k = 0; k < 2; k++) {
            if (check_skips(i + k, 2))
                continue;
            const struct bad_log *bad = &bad_logs[i];
            write_good();
            assert_int_equal(run(bad->make), 0);
            snprintf(line, sizeof line, "$I %s %s -o result", analyses[k], bad->file);
            int code = run(line);
            snprintf(prefix, sizeof prefix, "imukit %s: error: ", analyses[k]);
            check_contains(err, bad->says, bad->make);
            check_contains(err, prefix, bad->make);
            assert_int_equal(code, 1);
            assert_string_equal(out, "");
            assert_int_equal(access("result", F_OK), -1);
            sweep();
        }
    }
}

/* What --gaps refuse says; what the default does instead is in test_gaps_kept. */
static const struct bad_log refused_logs[] = {
    {"sed '500s/,.*/,nan/' good.csv >b.csv", "b.csv",
     "b.csv: 1 row with a value that is not a finite number or beyond 1e60, first in row 499, "
     "column "
     "gyro_x; " REMEDY},
    {"sed '500s/,.*/,1e160/' good.csv >b.csv", "b.csv",
     "b.csv: 1 row with a value that is not a finite number or beyond 1e60, first in row 499, "
     "column gyro_x; " REMEDY},
    {"sed '500s/,.*/,/' good.csv >b.csv", "b.csv",
     "b.csv: 1 row with a value that is not a finite number or beyond 1e60, first in row 499, "
     "column "
     "gyro_x; " REMEDY},
    {"sed '500{h;d};501G' good.csv >b.csv", "b.csv",
     "b.csv: time runs backwards in 1 row, first in row 500 (by 0.01 s); " REMEDY},
    {"sed '500p' good.csv >b.csv", "b.csv",
     "b.csv: time stands still in 1 row, first in row 500; " REMEDY},
    {"sed '101,300d' good.csv >b.csv", "b.csv",
     "b.csv: 200 samples are missing in 1 gap, first before row 100; " REMEDY},
};

static void test_refused_logs(void **state)
{
    (void)state;
    static const char *const analyses[] = {"identify", "allan"};
    char line[600];
    for (size_t i = 0; i < sizeof refused_logs / sizeof refused_logs[0]; i++) {
        for (size_t k = 0; k < 2; k++) {
            if (check_skips(i + k, 2))
                continue;
            const struct bad_log *bad = &refused_logs[i];
            write_good();
            assert_int_equal(run(bad->make), 0);
            snprintf(line, sizeof line, "$I %s %s --gaps refuse -o result", analyses[k], bad->file);
            assert_int_equal(run(line), 1);
            check_contains(err, bad->says, bad->make);
            assert_string_equal(out, "");
            assert_int_equal(access("result", F_OK), -1);
            sweep();
        }
    }
}

/* The default keeps the places of what is missing, and says what that is. */
static void test_gaps_kept(void **state)
{
    (void)state;
    static const struct {
        const char *make, *says;
        int rows;
    } cases[] = {
        {"cp good.csv b.csv", "", 1000},
        {"sed 500d good.csv >b.csv",
         "imukit allan: warning: 1 of 1000 samples are missing, in 1 gap, the longest of 0.01 s; "
         "the gaps stay empty\n",
         1000},
        {"sed '500s/,.*/,nan/' good.csv >b.csv",
         "imukit allan: warning: 1 row with a value that is not a finite number or beyond 1e60, "
         "first in row 499: "
         "counted as missing\n",
         1000},
        {"sed '500s/,.*/,1e160/' good.csv >b.csv",
         "imukit allan: warning: 1 row with a value that is not a finite number or beyond 1e60, "
         "first in row 499: counted as missing\n",
         1000},
        {"sed '101,300d;500d' good.csv >b.csv",
         "201 of 1000 samples are missing, in 2 gaps, the longest of 2 s", 1000},
        {"sed '500{h;d};501G' good.csv >b.csv", "1 row whose time does not increase: left out",
         1000},
        {"sed '500p' good.csv >b.csv",
         "imukit allan: warning: 1 row whose time does not increase: left out\n", 1000},
        {"awk -F, 'NR > 600 {$1 = \"nan\"} {print $1 \",\" $2}' good.csv >b.csv",
         "401 rows with a value that is not a finite number or beyond 1e60, first in row 600", 599},
    };
    char rows[40];
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        write_good();
        assert_int_equal(run(cases[i].make), 0);
        assert_int_equal(run("$I allan b.csv --tau 0.1s --json"), 0);
        check_contains(err, cases[i].says, cases[i].make);
        assert_true(cases[i].says[0] || !err[0]);
        snprintf(rows, sizeof rows, "\"rows\": %d,", cases[i].rows);
        check_contains(out, rows, cases[i].make);
        check_contains(out, "\"interval\": {\"value\": 0.01, ", cases[i].make);
        sweep();
    }
}

/* A finite number stays one in the unit written, or is refused by column and row. */
static void test_unit_too_small(void **state)
{
    (void)state;
    put("late.csv", "time [s],gyro_x [deg/s]\n0,1\n1e300,2\n2e300,3\n");
    check_message("$I convert late.csv b.csv --to-time-unit ns", 1,
                  "imukit convert: error: time, row 2: \"ns\" is too small a unit: the number "
                  "would be infinite; choose a larger unit\n");
    assert_int_equal(run("$I convert late.csv b.csv --to-time-unit s && cmp late.csv b.csv"), 0);
    assert_int_equal(sweep(), 2);
}

/* A number whose square overflows, and an infinity, are told and left out by identify too, whose
 * results are those of the log where the cell is empty. */
static void test_no_readings(void **state)
{
    (void)state;
    static const char *const cells[] = {"", "inf", "1e160", "-1e63"};
    char make[100], *empty = NULL;
    for (size_t i = 0; i < sizeof cells / sizeof cells[0]; i++) {
        write_good();
        snprintf(make, sizeof make, "sed '500s/,.*/,%s/' good.csv >b.csv", cells[i]);
        assert_int_equal(run(make), 0);
        assert_int_equal(run("$I identify b.csv --json"), 0);
        assert_string_equal(err, ""); /* it is allowed for */
        check_contains(out,
                       "1 row with a value that is not a finite number or beyond 1e60, first in "
                       "row 499: counted as missing",
                       make);
        if (empty)
            assert_string_equal(out, empty);
        else
            assert_non_null(empty = strdup(out));
        assert_int_equal(run("$I spectrum b.csv"), 1);
        check_contains(err, "first in row 499, column gyro_x; use --gaps longest", make);
        assert_int_equal(run("$I spectrum b.csv --gaps bridge"), 0);
        assert_null(strstr(out, "inf"));
        sweep();
    }
    free(empty);
}

/* A channel that has too few numbers is named, with how many it has. */
static void test_few_finite(void **state)
{
    (void)state;
    write_good();
    assert_int_equal(run("awk -F, 'NR > 100 {$2 = \"nan\"} {print $1 \",\" $2}' good.csv >b.csv"),
                     0);
    assert_int_equal(run("$I identify b.csv"), 1);
    check_contains(
        err,
        "b.csv: column gyro_x has 99 finite values in 1000 rows: at least 256 are needed "
        "to identify noise; leave it out with --map (in a log without names with --columns), or "
        "check "
        "the log\n",
        "99 numbers");
    assert_int_equal(run("sed '2,$s/,.*/,nan/' good.csv >b.csv"), 0);
    assert_int_equal(run("$I allan b.csv"), 1);
    check_contains(err, "b.csv: column gyro_x has no finite value in 1000 rows; ", "no number");
    sweep();
}

/* A few kilobytes that are rows without end: what loads a log says so before the memory is gone,
 * what passes it on does it in constant memory. The sanitizers need all the address space. */
static void test_rows_without_end(void **state)
{
    (void)state;
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    skip();
#endif
    static const char *const loading[] = {
        "allan b.csv.gz --threads 1", "identify b.csv.gz --threads 1",
        "spectrum b.csv.gz --threads 1", "calibrate b.csv.gz --procedure repeatability",
        "simulate tactical --motion b.csv.gz --threads 1"};
    char line[300];
    assert_int_equal(run("(echo 'time [s],gyro_x [deg/s]'; yes 0,0 | head -n 2200000) | gzip -1 "
                         ">b.csv.gz"),
                     0);
    for (size_t i = 0; i < sizeof loading / sizeof loading[0]; i++) {
        snprintf(line, sizeof line, "ulimit -v 60000; $I %s", loading[i]);
        assert_int_equal(run(line), 1);
        check_contains(err, "b.csv.gz: memory is full: ", line);
        check_contains(err, " rows of 2 columns take ", line);
        check_contains(err, "cut the log into parts", line);
    }
    assert_int_equal(run("ulimit -v 60000; $I convert b.csv.gz --threads 1 - | tail -n 1"), 0);
    assert_string_equal(out, "0,0\n");
    assert_string_equal(err, "");
    sweep();
}

/* Systems that promise more memory than there is would end a program that takes it: its data is
 * limited, as that of its children. */
static void test_memory_is_limited(void **state)
{
    (void)state;
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    skip();
#endif
    write_good();
    put("rsvg-convert", "#!/bin/sh\nulimit -d >limit.txt\n");
    run("chmod +x rsvg-convert; H=$PWD; sed -i \"s,limit.txt,$H/limit.txt,\" rsvg-convert; "
        "PATH=$H:$PATH $I allan good.csv --plot p.png");
    assert_int_equal(run("cat limit.txt"), 0);
    const double kilobytes = strtod(out, NULL); /* 0 when it is unlimited */
    assert_true(kilobytes >= 1e3 && 1024 * kilobytes <= 0.876 * (double)imk_memory_limit());
    sweep();
}

/* Only the channel that lacks a value lacks it; times that are no grid are refused. */
static void test_grids(void **state)
{
    (void)state;
    assert_int_equal(
        run("awk 'BEGIN{srand(1); print \"time [s],x,y\"; for (i = 0; i < 900; i++) "
            "print i / 100 \",\" rand() \",\" (i % 9 == 4 ? \"nan\" : rand())}' >b.csv"),
        0);
    assert_int_equal(run("$I allan b.csv --tau 0.1s -o - | cut -d, -f1,2"), 0);
    check_contains(out, "x,0.1\ny,0.1\n", "two channels");
    assert_int_equal(run("awk 'BEGIN{srand(1); print \"time [s],x\"; for (i = 0; i < 900; i++) "
                         "print i / 100 + 0.002 * rand() \",\" rand()}' >b.csv"),
                     0);
    assert_int_equal(run("$I allan b.csv --tau 0.1s"), 0);
    check_contains(err, "the samples are treated as evenly spaced", "jitter");
    assert_int_equal(run("awk 'BEGIN{srand(1); print \"time [s],x\"; for (i = 0; i < 900; i++) "
                         "print t += -log(1 - rand()) / 100, \",\" rand()}' >b.csv"),
                     0);
    assert_int_equal(run("$I allan b.csv --tau 0.1s"), 1);
    check_contains(err, "the timestamps are not evenly spaced", "Poisson times");
    assert_int_equal(run("sed '500,$s/^/1000000/' good.csv >b.csv; "
                         "awk 'BEGIN{print \"time [s],x\"; for (i = 0; i < 900; i++) "
                         "print i / 100 + (i > 500 ? 1e9 : 0) \",\" sin(i)}' >b.csv"),
                     0);
    assert_int_equal(run("$I allan b.csv --tau 0.1s"), 1);
    check_contains(err, "the clock may have jumped", "a leap");
    check_message("$I spectrum b.csv --gaps keep", 2,
                  "imukit spectrum: error: --gaps keep: this verb needs every sample; use --gaps "
                  "bridge or --gaps longest\n" TRY("spectrum"));
    sweep();
}

/* The command the message shows is the one to run. */
static void test_next_command(void **state)
{
    (void)state;
    write_good();
    assert_int_equal(run("cut -d, -f2 good.csv >'b 1.csv'"), 0);
    check_message(
        "$I allan 'b 1.csv' --tau=1s", 1,
        "imukit allan: error: b 1.csv:1: time: the log has no time column; add --rate RATE "
        "(samples per second, as in --rate 100Hz)\nNext: imukit allan 'b 1.csv' --tau=1s --rate "
        "RATE\n");
    assert_int_equal(run("$I allan 'b 1.csv' --tau=1s --rate 100Hz"), 0);
    sweep();
}

/* The promise of the messages: the option they name works. */
static void test_gap_policies(void **state)
{
    (void)state;
    static const struct {
        const char *make, *policy, *says;
        int rows;
    } cases[] = {
        {"cp good.csv b.csv", "refuse", "", 1000},
        {"sed 500d good.csv >b.csv", "refuse", "1 of 1000 samples are missing or bad: bridged",
         1000},
        {"sed '500s/,.*/,nan/' good.csv >b.csv", "bridge", "1 of 1000 samples", 1000},
        {"sed '500s/,.*/,nan/' good.csv >b.csv", "longest", "rows 500 to 1000 of 1000", 501},
        {"sed '101,300d' good.csv >b.csv", "bridge", "200 of 1000 samples", 1000},
        {"sed '101,300d' good.csv >b.csv", "longest", "rows 100 to 800 of 800", 701},
        {"sed '500{h;d};501G' good.csv >b.csv", "bridge", "1 of 1000 samples", 1000},
        {"sed '500{h;d};501G' good.csv >b.csv", "longest", "rows 501 to 1000 of 1000", 500},
        {"sed '500p' good.csv >b.csv", "bridge", "0 of 1000 samples", 1000},
        {"sed '101,900d' good.csv >b.csv", "bridge",
         "too little to interpolate; use --gaps longest", 0},
    };
    char line[300], rows[40];
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        write_good();
        assert_int_equal(run(cases[i].make), 0);
        snprintf(line, sizeof line, "$I allan b.csv --gaps %s --tau 0.1s --json", cases[i].policy);
        assert_int_equal(run(line), cases[i].rows ? 0 : 1);
        check_contains(err, cases[i].says, cases[i].make);
        snprintf(rows, sizeof rows, "\"rows\": %d,", cases[i].rows);
        check_contains(out, cases[i].rows ? rows : "", cases[i].make);
        check_contains(out, cases[i].rows ? "\"interval\": {\"value\": 0.01, " : "", cases[i].make);
        sweep();
    }
}

/* A straight line between good neighbours, value by value: rates of a ramp stay a ramp. */
static void test_bridging_is_linear(void **state)
{
    (void)state;
    assert_int_equal(run("awk 'BEGIN{print \"time [s],x\"; for (i = 0; i < 400; i++) "
                         "if (i % 10 < 7) print i / 8 \",\" i}' >ramp.csv"),
                     0);
    /* sigma(tau) of a ramp R t is R tau/sqrt 2: 8 per second here. */
    assert_int_equal(run("$I allan ramp.csv --gaps bridge --tau 1s -o - | tail -1"), 0);
    double deviation;
    assert_int_equal(sscanf(out, "x,1,%lf", &deviation), 1);
    CHECK_RELATIVE(deviation, 8 / sqrt(2), 1e-9);
    sweep();
}

/* Nothing that is given or read reaches the terminal as a command to it. */
static void test_control_characters(void **state)
{
    (void)state;
    static const char *const lines[] = {
        "$I \"$E\"",
        "$I allan --\"$E\"",
        "$I grade \"$E\"",
        "$I devices \"$E\"",
        "$I grade m.yaml",
        "$I grade m.yaml m.yaml",
        "$I convert m.yaml \"$E\"",
        "$I drift m.yaml -d 1min -r 1Hz",
        "$I -\"$E\"",
        "$I allan good.csv --plot \"$E\"",
    };
    setenv("E", "\033[31mx\302\233y\377z", 1);
    put("m.yaml", "imukit: 1\nname: \"\\e[31mevil\\u009b\"\n"
                  "gyro: {bias: {repeatability: 1 deg/h}}\n"
                  "accel: {bias: {repeatability: 1 mg}}\n");
    write_good();
    for (size_t i = 0; i < sizeof lines / sizeof lines[0]; i++) {
        run(lines[i]);
        for (const char *text = out, *end = out + strlen(out); text < end; text++)
            assert_true(*text == '\n' || imk_utf8_printable(text) || (*text & 0xC0) == 0x80);
        for (const char *text = err, *end = err + strlen(err); text < end; text++)
            assert_true(*text == '\n' || imk_utf8_printable(text) || (*text & 0xC0) == 0x80);
    }
    sweep();
}

/* ---- outputs that cannot be written ---------------------------------------------------------- */

static void test_unwritable_outputs(void **state)
{
    (void)state;
    static const char *const lines[] = {"simulate AHRS --rate 100Hz --duration 1s -o",
                                        "allan good.csv -o",
                                        "allan good.csv --report",
                                        "identify good.csv -o",
                                        "identify good.csv --report",
                                        "convert good.csv"};
    static const struct {
        const char *path, *says;
    } places[] = {{"/dev/full", "No space left on device"},
                  {"/nonexistent/x.csv", "the folder /nonexistent does not exist"},
                  {"/proc/x.csv", "the folder /proc cannot be written: "},
                  {"dir.csv", "Is a directory"}};
    char line[300];
    write_good();
    assert_int_equal(run("mkdir dir.csv"), 0);
    for (size_t i = 0; i < sizeof lines / sizeof lines[0]; i++) {
        for (size_t k = 0; k < sizeof places / sizeof places[0]; k++) {
            if (check_skips(i + k, 2))
                continue;
            snprintf(line, sizeof line, "$I %s %s", lines[i], places[k].path);
            assert_int_equal(run(line), 1);
            check_contains(err, places[k].says, line);
        }
    }
    check_message(
        "$I allan good.csv -o nodir/ >/dev/null", 1,
        "imukit allan: error: nodir/: this is the name of a folder; expected a file name\n");
    assert_int_equal(sweep(), 2); /* good.csv and dir.csv: nothing else was left */
    write_good();
    static const char *const to_standard_output[] = {"--help",
                                                     "devices",
                                                     "grade AHRS",
                                                     "grade AHRS --json",
                                                     "allan good.csv",
                                                     "allan good.csv --json",
                                                     "identify good.csv",
                                                     "simulate AHRS --rate 100Hz --duration 1s",
                                                     "convert good.csv -",
                                                     "drift --help",
                                                     "grade AHRS --plot term"};
    for (size_t i = 0; i < sizeof to_standard_output / sizeof to_standard_output[0]; i++) {
        if (strstr(to_standard_output[i], "--plot") && !imk_plot_available("term"))
            continue;
        snprintf(line, sizeof line, "$I %s >/dev/full", to_standard_output[i]);
        assert_int_equal(run(line), 1);
        check_contains(err, "No space left on device", line);
        const char *error = strstr(err, "error: ");
        assert_non_null(error);
        assert_null(strstr(error + 1, "error: ")); /* one message */
    }
    sweep();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_bad_logs),
        cmocka_unit_test(test_refused_logs),
        cmocka_unit_test(test_gaps_kept),
        cmocka_unit_test(test_no_readings),
        cmocka_unit_test(test_few_finite),
        cmocka_unit_test(test_rows_without_end),
        cmocka_unit_test(test_unit_too_small),
        cmocka_unit_test(test_memory_is_limited),
        cmocka_unit_test(test_grids),
        cmocka_unit_test(test_next_command),
        cmocka_unit_test(test_gap_policies),
        cmocka_unit_test(test_bridging_is_linear),
        cmocka_unit_test(test_control_characters),
        cmocka_unit_test(test_unwritable_outputs),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
