/* SPDX-License-Identifier: Apache-2.0 */
/* No output replaces what the run reads, or another output, however the two are spelled. */
#include "cli/run_command.h"

static int make_inputs(void **state)
{
    if (set_up(state) != 0)
        return -1;
    put("motion.yaml", "imukit_motion: 1\nsteps: [hold 2 s, turn right 40 deg at 10 deg/s, hold 2 "
                       "s]\n");
    put("heat.csv", "time [s],temperature [degC]\n0,20\n60,30\n");
    mkdir("runs", 0700);
    mkdir("runs/inner", 0700);
    return run("$I simulate tactical --rate 50Hz --duration 12s -o six.csv && "
               "$I convert six.csv six.npy && ln six.csv hard.csv && ln -s six.csv soft.csv && "
               "ln -s to.csv dangling.csv && cp motion.yaml runs/run_000.csv && "
               "cp heat.csv runs/run_001.csv && $I identify six.csv -o unit.yaml && "
               "$I simulate tactical --rate 50Hz --motion motion.yaml -o turns.csv");
}

static int remove_inputs(void **state)
{
    run("rm -rf runs");
    sweep();
    return tear_down(state);
}

/* A run that must be refused as wrong usage, in the words `says`, and change no file. */
static void check_refused(const char *line, const char *says)
{
    char whole[800], *before;
    static const char list[] = "ls -A . runs >../listing && cat ../listing; find . -type f | sort "
                               "| xargs cksum; rm ../listing";
    assert_int_equal(run(list), 0);
    before = strdup(out);
    assert_non_null(before);
    snprintf(whole, sizeof whole, "$I %s", line);
    if (run(whole) != 2)
        fail_msg("%s\nended well, or otherwise than as wrong usage: %s", line, err);
    check_contains(err, says, line);
    assert_int_equal(run(list), 0);
    assert_string_equal(before, out);
    free(before);
}

#define READ " would overwrite what is read: give another name\n"

static void test_what_is_read(void **state)
{
    (void)state;
    static const char *const lines[][2] = {
        {"allan six.csv -o six.csv", "--output six.csv" READ},
        {"allan six.csv -o ./runs/../six.csv", "--output ./runs/../six.csv" READ},
        {"allan six.csv -o hard.csv", "--output hard.csv" READ},
        {"allan soft.csv -o six.csv", "--output six.csv" READ},
        {"allan six.csv -o soft.csv", "--output soft.csv" READ},
        {"convert six.csv six.csv --select time,gyro_x", ": six.csv" READ},
        {"convert six.csv ./six.csv", ": ./six.csv" READ},
        {"convert unit.yaml unit.yaml --to kalibr --rate 50Hz", ": unit.yaml" READ},
        {"simulate tactical --motion motion.yaml --rate 10Hz -o motion.yaml",
         "--output motion.yaml" READ},
        {"simulate tactical --motion motion.yaml --rate 10Hz -o x.csv --truth ./motion.yaml",
         "--truth ./motion.yaml" READ},
        {"simulate tactical -t heat.csv --rate 10Hz -d 9s -o heat.csv", "--output heat.csv" READ},
        {"drift tactical --motion motion.yaml --rate 10Hz --report motion.yaml",
         "--report motion.yaml" READ},
        {"evaluate turns.csv --static six.csv --report six.csv", "--report six.csv" READ},
        {"evaluate turns.csv --motion motion.yaml --report motion.yaml",
         "--report motion.yaml" READ},
        {"navigate six.csv -p '48 deg, 11 deg, 500 m' --model unit.yaml -o unit.yaml",
         "--output unit.yaml" READ},
        {"calibrate turns.csv -p multiposition -m unit.yaml -o unit.yaml",
         "--output unit.yaml" READ},
        {"identify six.csv --into unit.yaml -o x.yaml --report unit.yaml",
         "--report unit.yaml" READ},
        {"identify six.csv --truth unit.yaml -o unit.yaml", "--output unit.yaml" READ},
        {"allan six.npy -o six.npy.columns", "--output six.npy.columns" READ},
        {"simulate tactical --motion six.npy --rate 1Hz --truth ./six.npy.columns -o x.csv",
         "--truth ./six.npy.columns" READ},
    };
    for (size_t i = 0; i < sizeof lines / sizeof lines[0]; i++)
        if (!check_skips(i, 3))
            check_refused(lines[i][0], lines[i][1]);
}

static void test_two_outputs(void **state)
{
    (void)state;
    static const char *const lines[][2] = {
        {"simulate AHRS --rate 10Hz -d 10s -o x.csv --truth x.csv", "both write x.csv"},
        {"simulate AHRS --rate 10Hz -d 10s -o x.csv --truth ./x.csv", "both write x.csv"},
        {"simulate AHRS --rate 10Hz -d 10s -o to.csv --truth dangling.csv", "both write to.csv"},
        {"simulate AHRS --rate 10Hz -d 10s -o runs//x.csv --truth runs/inner/../x.csv",
         "both write runs//x.csv"},
        {"simulate AHRS --rate 10Hz -d 10s -o new/x.csv --truth ./new/x.csv",
         "both write new/x.csv"},
        {"simulate AHRS --rate 10Hz -d 10s -o x.npy --truth x.npy.columns",
         "both write x.npy.columns"},
        {"allan six.csv -o y.html --report \"$PWD/y.html\"", "both write y.html"},
        {"physics rate_gyro -d 1s -o q.svg --plot q.svg", "both write q.svg"},
    };
    for (size_t i = 0; i < sizeof lines / sizeof lines[0]; i++)
        if (!check_skips(i, 3))
            check_refused(lines[i][0], lines[i][1]);
}

/* Nothing lies where the log of a run goes; a folder inside, and other names, are free. */
static void test_folder_of_runs(void **state)
{
    (void)state;
    static const char simulate[] = "simulate AHRS --rate 10Hz -d 10s --runs 2 -o runs/";
    static const char *const options[][2] = {
        {"--truth runs/run_000.csv", "--truth runs/run_000.csv has the name of a run in -o runs/"},
        {"--truth ./runs/run_001.csv", "has the name of a run"},
        {"--motion runs/run_000.csv", "--motion runs/run_000.csv has the name of a run"},
        {"-t runs/inner/../run_001.csv", "--temperature runs/inner/../run_001.csv has the name"},
    };
    char line[200];
    for (size_t i = 0; i < sizeof options / sizeof options[0]; i++) {
        if (check_skips(i, 3))
            continue;
        snprintf(line, sizeof line, "%s %s", simulate, options[i][0]);
        check_refused(line, options[i][1]);
    }
    snprintf(line, sizeof line, "$I %s --truth runs/truth.csv && rm runs/run_*.csv runs/truth.csv",
             simulate);
    assert_int_equal(run(line), 0);
    snprintf(line, sizeof line, "$I %s --truth runs/inner/run_000.csv", simulate);
    assert_int_equal(run(line), 0);
}

/* What is given twice is not evidence twice. */
static void test_given_twice(void **state)
{
    (void)state;
    static const char *const lines[] = {
        "identify six.csv six.csv --runs",
        "identify ./six.csv six.csv --devices",
        "identify soft.csv turns.csv six.csv --runs",
        "identify hard.csv six.csv --runs",
        "calibrate six.csv six.csv -p multiposition",
        "evaluate six.csv six.csv",
    };
    for (size_t i = 0; i < sizeof lines / sizeof lines[0]; i++)
        if (!check_skips(i, 3))
            check_refused(lines[i], "six.csv is given twice: its readings would count as those");
    assert_int_equal(run("$I grade tactical tactical"), 0);
}

/* Devices and standard streams may serve twice, and what is only alike is not the same. */
static void test_no_clash(void **state)
{
    (void)state;
    assert_int_equal(run("$I allan six.csv -o /dev/null --report /dev/null"), 0);
    assert_int_equal(run("$I allan - -o - <six.csv"), 0);
    assert_int_equal(run("$I identify six.csv --into unit.yaml -o ./unit.yaml"), 0);
    assert_int_equal(run("$I convert six.csv six2.csv && cmp six.csv six2.csv && rm six2.csv"), 0);
    assert_int_equal(run("$I convert six.npy six2.npy && rm six2.npy six2.npy.columns"), 0);
    assert_int_equal(run("$I simulate AHRS --rate 10Hz -d 10s -o x.csv --truth runs/x.csv && rm "
                         "x.csv runs/x.csv"),
                     0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_what_is_read),   cmocka_unit_test(test_two_outputs),
        cmocka_unit_test(test_folder_of_runs), cmocka_unit_test(test_given_twice),
        cmocka_unit_test(test_no_clash),
    };
    return cmocka_run_group_tests(tests, make_inputs, remove_inputs);
}
