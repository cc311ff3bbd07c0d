/* SPDX-License-Identifier: Apache-2.0 */
/* Every verb reads and writes through pipes what it reads and writes as files, to the byte. */
#include "cli/run_command.h"

/* A file, and a line that reads it where @ stands. */
static const struct {
    const char *file, *line;
} readings[] = {
    {"one.csv", "$I identify @ -o - --name x"},
    {"one.csv", "$I identify second.csv @ --devices --json"},
    {"log.csv", "$I allan @ --json"},
    {"log.csv", "$I spectrum @ --json"},
    {"log.csv", "$I convert @ -"},
    {"log.csv", "$I compensate @ tactical"},
    {"log.csv", "$I navigate @ -p '48 deg, 11 deg, 500 m' --attitude '0 0 0 deg' -o -"},
    {"log.npy", "$I convert @ - --columns time,gyro_x,gyro_y,gyro_z,accel_x,accel_y,accel_z "
                "--gyro-unit deg/s --accel-unit m/s^2 --time-unit s"},
    {"table.csv", "$I evaluate @ --json"},
    {"table.csv", "$I evaluate other.csv @ --json"},
    {"log.csv", "$I evaluate other.csv --static @ --json"},
    {"turns.csv", "$I evaluate @ --motion turns.yaml --json"},
    {"turns.yaml", "$I evaluate turns.csv again.csv --motion @ --json"},
    {"turns.csv", "$I calibrate @ -p rate-table --motion turns.yaml --no-earth -g 9.81m/s^2"},
    {"turns.yaml", "$I calibrate turns.csv -p rate-table --motion @ --no-earth -g 9.81m/s^2"},
    {"unit.yaml", "$I simulate @ --rate 10Hz --duration 10s"},
    {"turns.yaml", "$I simulate tactical --motion @ --rate 10Hz"},
    {"rates.csv", "$I simulate tactical --motion @ --rate 10Hz"}, /* without time: read twice */
    {"warm.yaml", "$I simulate tactical --temperature @ --rate 10Hz -d 9s"},
    {"warm.csv", "$I simulate tactical --temperature @ --rate 10Hz -d 9s"},
    {"turns.yaml", "$I drift tactical -r 1Hz --motion @ --json"},
    {"turns.yaml", "$I drift tactical -r 1Hz --motion @ -n 3 -o runs.h5 && cat runs.h5"},
    {"unit.yaml", "$I drift @ -d 10s -r 1Hz --json"},
    {"unit.yaml", "$I grade @ --json"},
    {"unit.yaml", "$I convert @ - --to kalibr --rate 100Hz --use-bounds"},
    {"kalibr.yaml", "$I convert @ - --to gazebo --rate 100Hz"},
    {"unit.yaml", "$I convert @ z.json && cat z.json && rm z.json"},
    {"kalibr.yaml", "$I convert @ z.yaml --rate 100Hz && cat z.yaml && rm z.yaml"},
    {"design.yaml", "$I physics @ --reduce"},
};
enum { READINGS = sizeof readings / sizeof readings[0] };

/* A name for it, $F being the file and $LINE the line with that name, and two ways to run the line
 * that must print the same: the first gives it a file, the second a pipe. */
static const struct {
    const char *name, *as_file, *as_pipe;
} ways[] = {
    {NULL, "eval \"$LINE\"",
     "mv $F whole; mkfifo $F; { gzip -c whole >$F; } & eval \"$LINE\"; code=$?; mv whole $F; exit "
     "$code"},
    {"/dev/stdin", "eval \"$LINE\" <$F", "cat $F | eval \"$LINE\""},
    {"-", "eval \"$LINE\" <$F", "cat $F | eval \"$LINE\""},
    {"/dev/fd/7", "eval \"$LINE\" 7<$F", "cat $F | eval \"$LINE\" 7<&0"}, /* as <(cat FILE) */
};
enum { WAYS = sizeof ways / sizeof ways[0], FIRST_WAYS = 2 };

static int make_inputs(void **state)
{
    if (set_up(state) != 0)
        return -1;
    put("turns.yaml", "imukit_motion: 1\nsteps:\n  - hold 4 s\n  - turn right 40 deg at 10 deg/s\n"
                      "  - hold 4 s\n  - turn right 80 deg at 20 deg/s\n  - hold 4 s\n");
    put("warm.yaml", "imukit_temperature: 1\nsteps:\n  - start 25 degC\n  - ramp to 40 degC at 100 "
                     "degC/min\n");
    put("warm.csv", "time [s],temperature [degC]\n0,20\n100,40\n");
    put("table.csv", "reference [deg/s],reading [deg/s]\n-10,-10.1\n0,0.01\n10,10.02\n10,10.01\n"
                     "0,0\n-10,-10\n");
    return run("$I simulate tactical --rate 50Hz --duration 12s -o log.csv && "
               "$I simulate tactical --motion turns.yaml --rate 50Hz -o turns.csv && "
               "cp table.csv other.csv && cp turns.csv again.csv && cut -d, -f1,2 log.csv "
               ">second.csv && head -n 600 second.csv >one.csv && $I convert log.csv log.npy && rm "
               "log.npy.columns && "
               "$I identify log.csv -o unit.yaml >/dev/null && "
               "$I convert unit.yaml kalibr.yaml --to kalibr --rate 100Hz --use-bounds && "
               "$I physics rate_gyro --show >design.yaml && "
               "{ echo 'gyro_x [deg/s],gyro_y [deg/s],gyro_z [deg/s],accel_x [m/s^2],accel_y "
               "[m/s^2],accel_z [m/s^2]'; yes 0,0,1,0,0,-9.8 | head -99; } >rates.csv");
}

static int remove_inputs(void **state)
{
    sweep();
    return tear_down(state);
}

/* Put the line with a name for @ into $LINE, and run it. */
static void run_reading(size_t reading, const char *name, const char *way)
{
    const char *line = readings[reading].line, *at = strchr(line, '@');
    char named[400];
    snprintf(named, sizeof named, "%.*s%s%s", (int)(at - line), line, name, at + 1);
    setenv("LINE", named, 1);
    if (run(way) == 0)
        return;
    print_error("%s\n  with %s\n  says: %s\n", named, way, err);
    fail();
}

static void check_reading(size_t reading, size_t way)
{
    static char expected[TEXT_SIZE];
    const char *file = readings[reading].file, *name = ways[way].name ? ways[way].name : file;
    setenv("F", file, 1);
    run_reading(reading, name, ways[way].as_file);
    memcpy(expected, out, sizeof expected);
    run_reading(reading, name, ways[way].as_pipe);
    if (memcmp(out, expected, sizeof expected) == 0)
        return;
    print_error("%s: not the same with %s\n", getenv("LINE"), ways[way].as_pipe);
    fail();
}

/* All readings in two ways, and those of verbs that look into their input first in all ways. */
static void test_same_from_pipes(void **state)
{
    (void)state;
    for (size_t reading = 0; reading < READINGS; reading++) {
        const char *line = readings[reading].line;
        const bool looks = strstr(line, "evaluate @") || strstr(line, "identify @ -o");
        for (size_t way = 0; way < (looks ? WAYS : FIRST_WAYS); way++)
            if (!check_skips(reading + way, 4))
                check_reading(reading, way);
    }
}

/* Formats that are not read in one go are read from the copy. */
static void test_formats_that_need_a_file(void **state)
{
    (void)state;
    static char expected[TEXT_SIZE];
    assert_int_equal(run("$I identify one.csv --name x -o - 2>/dev/null | grep -v source"), 0);
    memcpy(expected, out, sizeof expected);
    static const char *const endings[] = {"h5", "mat", "npz"};
    for (size_t i = 0; i < 3; i++) {
        setenv("E", endings[i], 1);
        assert_int_equal(
            run("$I convert one.csv copied.$E && "
                "cat copied.$E | $I identify - --name x -o - 2>/dev/null | grep -v source"),
            0);
        assert_string_equal(out, expected);
    }
}

/* The copy that identify and evaluate need has no room: a message, and no result of a part. */
static void test_copy_that_fails(void **state)
{
    (void)state;
    static const char *const verbs[] = {"identify", "evaluate"};
    char line[300];
    for (size_t i = 0; i < 2; i++) {
        snprintf(line, sizeof line, "cat log.csv | TMPDIR=/nonexistent $I %s /dev/stdin", verbs[i]);
        assert_int_equal(run(line), 1);
        check_contains(err,
                       "/dev/stdin: its temporary copy cannot be written: No such file or "
                       "directory; set TMPDIR to a folder with room, or give a file instead of a "
                       "pipe\n",
                       line);
        assert_string_equal(out, "");
        snprintf(line, sizeof line, "cat log.csv | ( ulimit -f 100; $I %s - )", verbs[i]);
        assert_int_equal(run(line), 1);
        check_contains(err, "standard input: its temporary copy cannot be written: File too large",
                       line);
        assert_string_equal(out, "");
    }
}

/* What streams needs no copy, and takes no end for granted: the first rows come before the last. */
static void test_streams_stay_streams(void **state)
{
    (void)state;
    assert_int_equal(run("cat log.csv | TMPDIR=/nonexistent $I convert - - | cmp - log.csv"), 0);
    assert_int_equal(run("yes 0.01,0.02 | TMPDIR=/nonexistent $I convert - - --rate 100Hz "
                         "--columns gyro_x,gyro_y --gyro-unit deg/s | head -3"),
                     0);
    assert_string_equal(out, "gyro_x [deg/s],gyro_y [deg/s]\n0.01,0.02\n0.01,0.02\n");
}

/* ---- outputs --------------------------------------------------------------------------------- */

/* A line that writes where @ stands, and the ending of the name. */
static const struct {
    const char *ending, *line;
} writings[] = {
    {".csv", "$I simulate tactical --rate 50Hz --duration 12s -o @"},
    {".csv", "$I simulate tactical --rate 10Hz --duration 5s -o /dev/null --truth @"},
    {".csv", "$I compensate log.csv tactical -o @"},
    {".csv", "$I convert log.csv @"},
    {".csv", "$I allan one.csv -o @"},
    {".html", "$I allan one.csv --report @"},
    {".csv", "$I spectrum one.csv -o @"},
    {".yaml", "$I identify one.csv --name x -o @"},
    {".yaml", "$I calibrate turns.csv -p rate-table --motion turns.yaml --no-earth -g 9.81m/s^2 "
              "--name x -o @"},
    {".csv", "$I navigate log.csv -p '48 deg, 11 deg, 500 m' --attitude '0 0 0 deg' -o @"},
    {".csv", "$I drift tactical -d 10s -r 1Hz -o @"},
    {".csv", "$I physics rate_gyro -d 50ms -o @"},
    {".csv", "$I physics rate_gyro -d 50ms -o /dev/null --signals @"},
    {".yaml", "$I physics rate_gyro --reduce -o @"},
    {".yaml", "$I convert kalibr.yaml @ --from kalibr --to gazebo --rate 100Hz"},
};
enum { WRITINGS = sizeof writings / sizeof writings[0] };

static void name_output(const char *line, const char *name)
{
    const char *at = strchr(line, '@');
    char named[400];
    snprintf(named, sizeof named, "%.*s%s%s", (int)(at - line), line, name, at + 1);
    setenv("LINE", named, 1);
}

static void check_run(const char *way)
{
    const int code = run(way);
    if (code != 0) {
        print_error("%s\n  with %s\n  code %d, says: %s\n", getenv("LINE"), way, code, err);
        fail();
    }
}

/* The command's own page says by which line it was made. */
static void test_same_to_pipes(void **state)
{
    (void)state;
    static const char *const streams[] = {"-", "/dev/stdout", "/proc/self/fd/1"};
    char name[40];
    for (size_t i = 0; i < WRITINGS; i++) {
        setenv("SAME", strcmp(writings[i].ending, ".html") == 0 ? "grep -v one.csv" : "cat", 1);
        snprintf(name, sizeof name, "made%s", writings[i].ending);
        setenv("F", name, 1);
        name_output(writings[i].line, name);
        check_run("eval \"$LINE\" >/dev/null; $SAME $F >whole");
        unlink(name);
        check_run("mkfifo $F; $SAME $F >other & eval \"$LINE\" >/dev/null && wait $! && cmp whole "
                  "other && test -p $F");
        unlink(name);
        for (size_t k = 0; k < sizeof streams / sizeof streams[0]; k++) {
            if (check_skips(i + k, 3))
                continue;
            name_output(writings[i].line, streams[k]);
            check_run("eval \"$LINE\" | $SAME | cmp - whole");
        }
        check_run("echo before >log; { eval \"$LINE\"; echo after; } >>log; "
                  "$SAME log >other; { echo before; cat whole; echo after; } | cmp - other");
        name_output(writings[i].line, "/dev/fd/7"); /* as >(cmp - whole) */
        check_run("{ eval \"$LINE\" >/dev/null; } 7>&1 | $SAME | cmp - whole");
        name_output(writings[i].line, "/dev/null");
        check_run("eval \"$LINE\" >/dev/null; test -c /dev/null");
    }
    assert_int_equal(run("rm whole other log"), 0);
}

/* A device without end is refused by its first bytes, and nothing of it is kept. */
static void test_without_end(void **state)
{
    (void)state;
    static const char *const lines[] = {
        "$I identify /dev/zero",
        "$I evaluate /dev/zero",
        "$I simulate tactical --rate 10Hz --motion /dev/zero",
        "$I simulate tactical --rate 10Hz -d 10s --temperature /dev/zero",
        "$I convert /dev/zero - --to kalibr --rate 100Hz --use-bounds",
    };
    char line[300];
    for (size_t i = 0; i < sizeof lines / sizeof lines[0]; i++) {
        snprintf(line, sizeof line, "( ulimit -f 2048; %s )", lines[i]);
        assert_int_equal(run(line), 1);
        check_contains(err,
                       "error: /dev/zero: this is neither text nor a log that is read without a "
                       "file, nor packed by gzip or zstd\n",
                       line);
    }
    /* Logs that only a closer look tells, or an option. */
    static const char fixtures[] = SOURCE_DIRECTORY "/tests/io/log/maker/fixtures";
    snprintf(line, sizeof line, "cat %s/novatel.bin | $I identify - -o m.yaml", fixtures);
    assert_int_equal(run(line), 1);
    check_contains(err, "24 rows are too few", line);
    snprintf(line, sizeof line,
             "cat %s/described.bin | $I identify - -o m.yaml --binary 'u32 time us, skip 12, i16 "
             "gyro_x count'",
             fixtures);
    assert_int_equal(run(line), 1);
    check_contains(err, "24 rows are too few", line);
    /* UTF-16 with zeros, too, is a text. */
    assert_int_equal(run("iconv -f UTF-8 -t UTF-16 log.csv | $I convert /dev/stdin - >a && "
                         "$I convert log.csv - | cmp - a"),
                     0);
}

/* A reader that goes away ends the command as other commands end, or with a message. */
static void test_closed_pipe(void **state)
{
    (void)state;
    static const char *const before[] = {"", "trap '' PIPE; "};
    char line[300];
    for (size_t i = 0; i < 2; i++) {
        snprintf(line, sizeof line,
                 "%s{ $I simulate tactical --rate 100Hz --duration 10min -o /dev/stdout; echo $? "
                 ">code; } | head -c 10; cat code; rm code",
                 before[i]);
        assert_int_equal(run(line), 0);
        check_contains(out, i == 0 ? "time [s],g141\n" : "time [s],g1\n", line);
        assert_string_equal(err, i == 0 ? ""
                                        : "imukit simulate: error: standard output: the file "
                                          "cannot be written: Broken pipe\n");
    }
}

/* What cannot be written into a pipe says so, before the work; nothing is left. */
static void test_formats_that_seek(void **state)
{
    (void)state;
    assert_int_equal(run("mkfifo x.npy x.h5"), 0);
    check_message("cat x.npy & $I convert log.csv x.npy", 1,
                  "imukit convert: error: x.npy: a .npy of unknown length cannot be compressed or "
                  "go to a pipe; write a plain .npy file, or a .csv\n");
    check_message("$I drift tactical -d 10s -r 1Hz -n 3 -o x.h5", 2,
                  "imukit drift: error: -o x.h5: the runs are kept in a file beside the results "
                  "while they are computed; give a name ending in .csv or .h5\n" TRY("drift"));
    assert_int_equal(run("$I drift tactical -d 10s -r 1Hz -n 3 -o runs.h5"), 0);
    check_message("$I merge runs.h5 -o x.h5", 1,
                  "imukit merge: error: x.h5: it is not a regular file; expected a regular file, "
                  "because its checksum is written last\n");
    check_message("$I drift tactical -d 10s -r 1Hz -n 3 -o /dev/stdout", 2,
                  "imukit drift: error: -o -: the runs are kept in a file beside the results while "
                  "they are computed; give a name ending in .csv or .h5\n" TRY("drift"));
    check_message(
        "$I drift x.h5", 1,
        "imukit drift: error: x.h5: a results file cannot be read through a pipe; give the file "
        "itself\n");
    assert_int_equal(run("test -p x.npy && test -p x.h5 && rm x.npy x.h5 runs.h5"), 0);
    assert_int_equal(run("ls x.*"), 2);
}

/* Two texts in one stream would be neither. */
static void test_one_stream_one_text(void **state)
{
    (void)state;
    check_message(
        "$I allan one.csv -o - --json", 2,
        "imukit allan: error: --json and --output cannot both go to standard output: give "
        "a file name\n" TRY("allan"));
    check_message(
        "$I identify one.csv -o /dev/stdout --report -", 2,
        "imukit identify: error: --output and --report cannot both go to standard output: "
        "give a file name\n" TRY("identify"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_same_from_pipes),
        cmocka_unit_test(test_copy_that_fails),
        cmocka_unit_test(test_streams_stay_streams),
        cmocka_unit_test(test_same_to_pipes),
        cmocka_unit_test(test_closed_pipe),
        cmocka_unit_test(test_without_end),
        cmocka_unit_test(test_formats_that_need_a_file),
        cmocka_unit_test(test_formats_that_seek),
        cmocka_unit_test(test_one_stream_one_text),
    };
    return cmocka_run_group_tests(tests, make_inputs, remove_inputs);
}
