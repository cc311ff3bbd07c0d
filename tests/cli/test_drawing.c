/* SPDX-License-Identifier: Apache-2.0 */
/* --plot, --report and --animate of every verb without gnuplot and temporary folder, which PNG, PDF
 * and the terminal alone need; with names that a shell would take for commands; and a gnuplot that
 * hangs, fails or draws half. */
#include "run_command.h"

#include <signal.h>
#include <time.h>

static const char allan[] = "$I allan one.csv";

/* Every place from which a verb draws; the letters are the options it takes. */
static const struct {
    const char *line, *options;
} drawings[] = {
    {allan, "pr"},
    {"$I spectrum one.csv", "pr"},
    {"$I identify one.csv", "pr"},
    {"$I identify one.csv two.csv --runs", "pr"},
    {"$I identify one.csv two.csv --devices", "r"},
    {"$I calibrate faces.csv -p sixposition -g 9.81m/s^2", "pr"},
    {"$I evaluate table.csv", "pr"},
    {"$I navigate faces.csv -p '48 deg, 11 deg, 500 m' --attitude '0 0 0 deg'", "pr"},
    {"$I drift tactical -d 10s -r 1Hz", "pr"},
    {"$I grade tactical", "pr"},
    {"$I tune tactical turn.yaml -r 20Hz --from 0.1s --to-time 1s --windows 1", "pr"},
    {"$I physics rate_gyro -d 20ms", "pr"},
    {"$I physics shell_gyro --view 1", "p"},
    {"$I physics shell_gyro", "a"},
};
enum { DRAWINGS = sizeof drawings / sizeof drawings[0] };

/* A gyro for ten seconds, a unit for four seconds on each of its faces, a table of readings. */
static int make_inputs(void **state)
{
    if (set_up(state) != 0)
        return -1;
    uint64_t n = 1;
    FILE *one = fopen("one.csv", "w"), *faces = fopen("faces.csv", "w");
    if (!one || !faces)
        return -1;
    fputs("time [s],gyro_x [deg/s]\n", one);
    fputs("time [s],gyro_x [deg/s],gyro_y [deg/s],gyro_z [deg/s],accel_x [g],accel_y [g],accel_z "
          "[g],face\n",
          faces);
    for (int i = 0; i < 480; i++) {
        const int face = i / 80;
        fprintf(faces, "%.2f", i / 20.0);
        for (int k = 0; k < 6; k++, n = 16807 * n % 2147483647)
            fprintf(faces, ",%.6f",
                    (k == 3 + face / 2 ? 1 - 2 * (face % 2) : 0) + 1e-3 * (double)n / 2147483647);
        fprintf(faces, ",%c%c\n", "+-"[face % 2], "xyz"[face / 2]);
        fprintf(one, "%.2f,%.6f\n", i / 20.0, (double)n / 2147483647);
    }
    put("table.csv", "reference [deg/s],reading [deg/s]\n-10,-10.1\n0,0.01\n10,10.02\n10,10.01\n"
                     "0,0\n-10,-10\n");
    put("turn.yaml", "imukit_motion: 1\nsteps: [hold 4 s, turn 90 deg at 30 deg/s]\n");
    put("gnuplot.sh", "#!/bin/sh\nsleep 1000 &\necho $$ $! >\"$PID_FILE\"\nwait\n");
    if (fclose(one) != 0 || fclose(faces) != 0)
        return -1;
    return mkdir("bin", 0700) == 0 && mkdir("tmp", 0700) == 0
               ? run("head -n 470 one.csv >two.csv && mv gnuplot.sh bin/gnuplot && chmod +x "
                     "bin/gnuplot && "
                     "ln bin/gnuplot bin/rsvg-convert")
               : -1;
}

static int remove_inputs(void **state)
{
    run("rm -rf bin tmp one.csv two.csv faces.csv table.csv turn.yaml");
    return tear_down(state);
}

static void check_absent(const char *line, const char *name)
{
    if (access(name, F_OK) == 0) {
        print_error("%s\n  has left %s\n", line, name);
        fail();
    }
}

/* Run a line that must end with this code, and say this. */
static void check_says(const char *line, int code, const char *says)
{
    const int actual = run(line);
    if (actual != code) {
        print_error("%s\n  code %d, expected %d; says: %s\n", line, actual, code, err);
        fail();
    }
    check_contains(err, says, line);
}

/* SVG and pages are complete, also with nothing on PATH and no temporary folder; the rest is
 * refused with code 1 and no file. */
static void test_without_gnuplot(void **state)
{
    (void)state;
    static const char nothing[] = "PATH=/nonexistent TMPDIR=/nonexistent";
    char line[600];
    for (size_t i = 0; i < DRAWINGS; i++) {
        const char *verb = drawings[i].line;
        if (strchr(drawings[i].options, 'p')) {
            snprintf(line, sizeof line, "%s %s --plot x.svg", nothing, verb);
            check_says(line, 0, "");
            read_text("x.svg", out);
            check_contains(out, "</svg>\n", line);
            assert_int_equal(unlink("x.svg"), 0);
            snprintf(line, sizeof line, "%s %s --plot x.png", nothing, verb);
            check_says(line, 1,
                       "plot: rsvg-convert is not installed; install it: apt install "
                       "librsvg2-bin; a file ending in .svg needs no other program\n");
            check_absent(line, "x.png");
            snprintf(line, sizeof line, "%s %s --plot term", nothing, verb);
            check_says(line, 1, "gnuplot is not installed; install it: apt install gnuplot-nox\n");
        }
        if (strchr(drawings[i].options, 'r')) {
            snprintf(line, sizeof line, "%s %s --report x.html", nothing, verb);
            check_says(line, 0, "");
            read_text("x.html", out);
            check_contains(out, strstr(line, "--devices") ? "" : "</svg>\n", line);
            check_contains(out, "</html>\n", line);
            unlink("x.html");
        }
        if (strchr(drawings[i].options, 'a')) {
            snprintf(line, sizeof line, "%s %s --animate x.svg", nothing, verb);
            check_says(line, 0, "");
            assert_int_equal(unlink("x.svg"), 0);
        }
    }
}

/* Code 1 and no file. */
static void test_without_temporary_folder(void **state)
{
    (void)state;
    static const char *const options[] = {"--plot x.png", "--plot term"};
    char line[600];
    if (!imk_plot_available("x.png"))
        skip();
    for (size_t i = 0; i < DRAWINGS; i++)
        for (size_t k = 0; k < 2; k++) {
            if (!strchr(drawings[i].options, 'p') || check_skips(i + k, 5))
                continue;
            snprintf(line, sizeof line, "TMPDIR=/nonexistent %s %s", drawings[i].line, options[k]);
            check_says(line, 1,
                       "temporary folder: the file cannot be opened: No such file or directory; "
                       "set TMPDIR to a folder that can be written\n");
            check_absent(line, "x.png");
        }
}

/* A folder that cannot be written, and a name that is too long; relative ones, also those that
 * would be a command to gnuplot, are folders like any other. */
static void test_temporary_folders(void **state)
{
    (void)state;
    char line[6000];
    if (!imk_plot_available("x.png"))
        skip();
    snprintf(line, sizeof line, "TMPDIR=/proc %s --plot x.png", allan); /* not even root may */
    check_says(line, 1, "; set TMPDIR to a folder that can be written\n");
    char name[5000];
    memset(name, 'x', sizeof name);
    name[sizeof name - 1] = '\0';
    snprintf(line, sizeof line, "TMPDIR=/tmp/%s %s --plot x.png", name, allan);
    check_says(line, 1, "File name too long; set TMPDIR to a folder that can be written\n");
    check_absent(line, "x.png");
    static const char *const folders[] = {"tmp", "./tmp",   "|touch stolen;", "<touch stolen;",
                                          "-e",  "a b'c\"d"};
    for (size_t i = 0; i < sizeof folders / sizeof folders[0]; i++) {
        mkdir(folders[i], 0700);
        setenv("F", folders[i], 1);
        snprintf(line, sizeof line, "TMPDIR=\"$F\" %s --plot x.png", allan);
        check_says(line, 0, "");
        check_absent(line, "stolen");
        assert_int_equal(unlink("x.png"), 0);
        assert_int_equal(rmdir(folders[i]), 0); /* nothing was left in it */
    }
    mkdir("tmp", 0700);
}

/* Figures may have any name, whoever draws them. */
static void test_names(void **state)
{
    (void)state;
    static const char *const names[] = {"|touch stolen;",
                                        "<touch stolen;",
                                        "-x",
                                        "~x",
                                        "a\nb",
                                        "a b'c\"d`touch stolen`$(touch stolen)"};
    static const char *const endings[] = {".svg", ".png"};
    char line[600], name[100];
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
        for (size_t k = 0; k < (imk_plot_available("x.png") ? 2 : 1); k++) {
            snprintf(name, sizeof name, "%s%s", names[i], endings[k]);
            setenv("F", name, 1);
            snprintf(line, sizeof line, "%s --plot=\"$F\"", allan);
            check_says(line, 0, "");
            check_absent(name, "stolen");
            assert_int_equal(unlink(name), 0);
        }
}

/* ---- a gnuplot that does not end ------------------------------------------------------------- */

typedef struct started {
    int gnuplot, its_child; /* process numbers */
} started;

/* Wait for what bin/gnuplot writes. */
static started wait_for_gnuplot(void)
{
    const struct timespec nap = {.tv_nsec = 5000000};
    for (int i = 0; i < 6000; i++, nanosleep(&nap, NULL)) {
        FILE *file = fopen("pid", "r");
        started s = {0, 0};
        const bool there = file && fscanf(file, "%d %d\n", &s.gnuplot, &s.its_child) == 2;
        if (file)
            fclose(file);
        if (there)
            return s;
    }
    fail_msg("gnuplot was not started");
    return (started){0, 0};
}

/* Does the process run? One that has ended may wait for a parent that does not care. */
static bool runs(int process)
{
    char path[40], state = 'Z';
    snprintf(path, sizeof path, "/proc/%d/stat", process);
    FILE *file = fopen(path, "r");
    if (file && fscanf(file, "%*d (%*[^)]) %c", &state) != 1)
        state = '?';
    if (file)
        fclose(file);
    return state != 'Z';
}

/* Neither gnuplot, nor what it had started, nor its folder. */
static void check_nothing_left(started s)
{
    const struct timespec nap = {.tv_nsec = 5000000};
    for (int i = 0; i < 2000 && (runs(s.gnuplot) || runs(s.its_child)); i++)
        nanosleep(&nap, NULL); /* killed, a process ends when its turn comes */
    assert_false(runs(s.gnuplot));
    assert_false(runs(s.its_child));
    assert_int_equal(rmdir("tmp"), 0);
    check_absent("interrupted", "x.png");
    mkdir("tmp", 0700);
    unlink("pid");
}

static void test_hung_gnuplot(void **state)
{
    (void)state;
    const char *const hung = "PATH=$PWD/bin:$PATH TMPDIR=$PWD/tmp PID_FILE=$PWD/pid "
                             "IMUKIT_DRAWING_SECONDS=0.2 ";
    char line[600];
    snprintf(line, sizeof line, "%s%s --plot x.png", hung, allan);
    check_message(
        line, 1,
        "imukit allan: error: plot: rsvg-convert was stopped: it did not finish in 0.2 s; "
        "check that rsvg-convert works, or give it more time: IMUKIT_DRAWING_SECONDS\n");
    check_nothing_left(wait_for_gnuplot());
    snprintf(line, sizeof line, "%s%s --plot term", hung, allan);
    check_says(line, 1, "gnuplot was stopped");
    check_nothing_left(wait_for_gnuplot());
}

/* Also a gnuplot that fails, or draws nothing, or half: how it ended is said, and what it said
 * last, not that another should be installed. */
static void test_failing_gnuplot(void **state)
{
    (void)state;
    mkdir("bad", 0700);
    static const struct {
        const char *program, *says;
    } bad[] = {
        {"exit 1", "rsvg-convert failed with exit code 1; check that rsvg-convert works: "
                   "rsvg-convert --version\n"},
        {"exit 0", "rsvg-convert failed: there is no drawing; check that rsvg-convert works"},
        {"echo '<svg' >figure.out; echo first >&2; printf ' \\033]0;last\\007 words\n\n' >&2; exit "
         "3",
         "plot: rsvg-convert failed with exit code 3; rsvg-convert printed: ?]0;last? words\n"},
        {"echo '<svg' >figure.out; kill -9 $$",
         "plot: rsvg-convert was ended by signal 9 (Killed); check that rsvg-convert works"},
        {"seq 100000 | tr '\n' ' ' >&2; exit 4",
         "rsvg-convert failed with exit code 4; rsvg-convert printed: "},
    };
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        char text[200], line[600];
        snprintf(text, sizeof text, "#!/bin/sh\n%s\n", bad[i].program);
        put("bad/rsvg-convert", text);
        chmod("bad/rsvg-convert", 0700);
        snprintf(line, sizeof line, "PATH=bad:$PATH TMPDIR=tmp %s --plot x.png", allan);
        check_says(line, 1, bad[i].says);
        assert_true(strlen(err) < 400);
        check_absent(line, "x.png");
        assert_int_equal(rmdir("tmp"), 0);
        mkdir("tmp", 0700);
    }
    assert_int_equal(run("rm -r bad"), 0);
}

/* Neither is a drawing whose end is missing, in any form. */
static void test_cut_drawing(void **state)
{
    (void)state;
    static const char *const plots[] = {"x.png", "x.pdf", "term"};
    mkdir("bad", 0700);
    put("bad/gnuplot", "#!/bin/sh\n/usr/bin/$(basename $0) \"$@\" && truncate -s -40 figure.out\n");
    chmod("bad/gnuplot", 0700);
    assert_int_equal(link("bad/gnuplot", "bad/rsvg-convert"), 0);
    if (imk_plot_available("x.png") && imk_plot_available("term")) {
        for (size_t i = 0; i < sizeof plots / sizeof plots[0]; i++) {
            if (check_skips(i, 3))
                continue;
            char line[600];
            snprintf(line, sizeof line, "PATH=bad:$PATH TMPDIR=tmp %s --plot %s", allan, plots[i]);
            check_says(line, 1, " failed: the end of its drawing is missing");
            check_absent(line, plots[i]);
            assert_null(strchr(out, '\f')); /* which dumb begins with */
        }
    }
    assert_int_equal(run("rm -r bad"), 0);
}

/* Of a full disk programs say nothing: the message names the folder. */
static void test_full_temporary_folder(void **state)
{
    (void)state;
    static const char *const options[] = {"--plot x.png", "--plot x.pdf"};
    if (!imk_plot_available("x.png") || run("unshare -rm mount -t tmpfs tmpfs tmp") != 0)
        skip();
    for (int i = 0; i < 2; i++) {
        char line[600];
        snprintf(line, sizeof line,
                 "unshare -rm sh -c 'mount -t tmpfs -o size=12k tmpfs tmp && "
                 "TMPDIR=tmp \"$I\" allan one.csv %s; code=$?; rmdir tmp/*; exit $code'",
                 options[i]);
        check_says(line, 1,
                   "error: temporary folder tmp: its disk is full; set TMPDIR to a folder with "
                   "room\nrmdir: "); /* for nothing was left in it */
        check_absent(line, strrchr(options[i], ' ') + 1);
    }
}

/* What gnuplot leaves beside its drawing goes with the folder, and nothing else. */
static void test_untidy_gnuplot(void **state)
{
    (void)state;
    char line[600];
    mkdir("bad", 0700);
    put("bad/rsvg-convert",
        "#!/bin/sh\nmkdir -p a/b '*'; echo >a/b/c; echo >.d; mkfifo e; ln -s a f\n"
        "ln -s \"$KEPT\" g; ln -s \"$KEPT/h\" a/i; printf "
        "'\\0\\0\\0\\0IEND\\256B`\\202' >figure.out\n");
    chmod("bad/rsvg-convert", 0700);
    snprintf(line, sizeof line,
             "mkdir kept; echo >kept/h; KEPT=$PWD/kept PATH=bad:$PATH TMPDIR=tmp %s --plot x.png",
             allan);
    check_says(line, 0, "");
    assert_int_equal(run("rmdir tmp && rm kept/h && rmdir kept && rm -r bad x.png"), 0);
    mkdir("tmp", 0700);
}

static void test_signals(void **state)
{
    (void)state;
    static const int signals[] = {SIGINT,  SIGTERM, SIGHUP,  SIGQUIT,
                                  SIGXCPU, SIGUSR1, SIGUSR2, SIGALRM};
    for (size_t i = 0; i < sizeof signals / sizeof signals[0]; i++) {
        if (check_skips(i, 3))
            continue;
        fflush(stdout);
        const pid_t child = fork();
        if (child == 0) {
            char path[5000];
            snprintf(path, sizeof path, "%s/bin:%s", directory, getenv("PATH"));
            setenv("PATH", path, 1);
            setenv("TMPDIR", "tmp", 1);
            snprintf(path, sizeof path, "%s/pid", directory);
            setenv("PID_FILE", path, 1);
            if (!freopen("/dev/null", "w", stdout))
                _exit(99);
            execl(command, command, "allan", "one.csv", "--plot", "x.png", (char *)NULL);
            _exit(98);
        }
        const started gnuplot = wait_for_gnuplot();
        kill(child, signals[i]);
        int status;
        assert_int_equal(waitpid(child, &status, 0), child);
        assert_true(WIFSIGNALED(status));
        assert_int_equal(WTERMSIG(status), signals[i]);
        check_nothing_left(gnuplot);
    }
    unlink("core");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_without_gnuplot),
        cmocka_unit_test(test_without_temporary_folder),
        cmocka_unit_test(test_temporary_folders),
        cmocka_unit_test(test_names),
        cmocka_unit_test(test_hung_gnuplot),
        cmocka_unit_test(test_failing_gnuplot),
        cmocka_unit_test(test_untidy_gnuplot),
        cmocka_unit_test(test_cut_drawing),
        cmocka_unit_test(test_full_temporary_folder),
        cmocka_unit_test(test_signals),
    };
    return cmocka_run_group_tests(tests, make_inputs, remove_inputs);
}
