/* SPDX-License-Identifier: Apache-2.0 */
/* imukit drift --shard and imukit merge: what is said, and that a campaign that was divided, killed
 * and taken up again gives the bytes of an undisturbed one. */
#include "run_command.h"

#include <signal.h>

/* White noise alone: runs are quick. */
static const char model[] =
    "imukit: 1\n"
    "gyro: {bias: {repeatability: 0 deg/h}, " NO_OTHER_GYRO_TERM_THAN(
        "0.3 deg/sqrt(h)") "}\n"
                           "accel: {bias: {repeatability: 0 mg}, " NO_OTHER_ACCEL_TERM_THAN(
                               "0.1 m/s/sqrt(h)") "}\n";

#define DRIFT "$I drift m.yaml --duration 20s --seed 3 --monte-carlo 100 "

static void make_shards(unsigned count)
{
    char line[512];
    put("m.yaml", model);
    for (unsigned i = 1; i <= count; i++) {
        snprintf(line, sizeof line, DRIFT "--shard %u/%u -o s%u.h5", i, count, i);
        assert_int_equal(run(line), 0);
    }
}

static void shards_and_threads_do_not_matter(void **state)
{
    (void)state;
    make_shards(3);
    assert_int_equal(run(DRIFT "-o one.h5 --threads 1"), 0);
    assert_int_equal(run(DRIFT "-o five.h5 --threads 5"), 0);
    assert_int_equal(run("cmp one.h5 five.h5"), 0);
    assert_int_equal(run("$I merge s2.h5 s3.h5 s1.h5 -o all.h5"), 0);
    assert_string_equal(
        out, "Usable: all 100 runs are there.\n\nall.h5: 100 of 100 runs from 3 of 3 files\n");
    assert_string_equal(err, "");
    assert_int_equal(run("cmp one.h5 all.h5"), 0);
    assert_int_equal(run("$I merge s2.h5 s3.h5 s1.h5 -o all.csv.gz && " DRIFT "-o one.csv.gz"), 0);
    assert_int_equal(run("cmp one.csv.gz all.csv.gz"), 0);
    sweep();
}

static void damage(const char *path, long place)
{
    FILE *file = fopen(path, "r+b");
    assert_non_null(file);
    assert_int_equal(fseek(file, place, SEEK_SET), 0);
    const int byte = fgetc(file);
    assert_int_equal(fseek(file, place, SEEK_SET), 0);
    fputc(byte ^ 1, file);
    assert_int_equal(fclose(file), 0);
}

static void what_is_wrong_is_named(void **state)
{
    (void)state;
    make_shards(10);
    damage("s2.h5", 5000);
    assert_int_equal(truncate("s3.h5", 1500), 0);
    assert_int_equal(run("$I drift m.yaml --duration 20s --seed 4 --monte-carlo 100 --shard 7/10 "
                         "-o s7.h5"),
                     0);
    assert_int_equal(run("rm s10.h5 && $I merge s?.h5 -o all.h5"), 1);
    assert_string_equal(out, "");
    check_contains(err,
                   "imukit merge: warning: s2.h5: the file is damaged: its checksum does not agree "
                   "with its content; compute it again\n",
                   "a damaged shard");
    check_contains(err, "imukit merge: warning: s3.h5: the file is cut short: 1500 of ",
                   "a truncated shard");
    check_contains(err,
                   "imukit merge: warning: s7.h5: the seed is 4, not 3; expected a file of "
                   "the same campaign as most others\n",
                   "a shard of another seed");
    check_contains(err,
                   "imukit merge: error: runs 10-29,60-69,90-99 of 100 are missing; compute again "
                   "with --shard i/10 for i = 2-3,7,10 (Slurm: sbatch --array=2-3,7,10), then "
                   "merge again (--partial merges the existing runs)\n",
                   "missing shards");
    assert_int_equal(access("all.h5", F_OK), -1);
    assert_int_equal(run("$I merge s?.h5 -o some.h5 --partial --json"), 0);
    json_t *document = json_loads(out, 0, NULL);
    assert_non_null(document);
    const json_t *result = json_object_get(document, "result");
    assert_int_equal(json_integer_value(json_object_get(result, "runs")), 60);
    assert_string_equal(json_string_value(json_object_get(result, "missing_shards")), "2-3,7,10");
    assert_int_equal(json_array_size(json_object_get(result, "left_out")), 3);
    assert_int_equal(json_array_size(json_object_get(document, "findings")), 4);
    json_decref(document);
    /* The advice, followed. */
    assert_int_equal(run("for i in 2 3 7 10; do " DRIFT "--shard $i/10 -o new$i.h5; done"), 0);
    assert_int_equal(run("$I merge some.h5 new*.h5 -o all.h5 && " DRIFT "-o one.h5"), 0);
    assert_int_equal(run("cmp one.h5 all.h5"), 0);
    sweep();
}

static void wrong_usage(void **state)
{
    (void)state;
    check_message(
        "$I merge -o all.h5", 2,
        "imukit merge: error: an operand is missing: imukit merge SHARD...\n" TRY("merge"));
    check_message(
        "$I merge a.h5", 2,
        "imukit merge: error: -o FILE is missing: the results file to write\n" TRY("merge"));
    check_message("$I merge a.h5 -o all.txt", 1,
                  "imukit merge: error: all.txt: the file format is not recognised; expected a "
                  "name ending in .h5, .csv, .csv.gz or .csv.zst\n");
    put("a.h5", "not a results file");
    check_message("$I merge a.h5 b.h5 -o all.h5", 1,
                  "imukit merge: warning: a.h5: the file format is not recognised; expected a "
                  "results file that imukit wrote (.h5)\nimukit merge: warning: b.h5: the file "
                  "cannot be opened: No such file or directory; check the path\nimukit merge: "
                  "error: no file is usable; give results files of one campaign\n");
    sweep();
}

/* A results file that comes through a pipe is named as such, and its runs are not to be computed
 * again. */
static void results_through_a_pipe(void **state)
{
    (void)state;
    make_shards(2);
    check_message("cat s1.h5 | $I drift -", 1,
                  "imukit drift: error: standard input: this is the results file of a campaign; "
                  "give the file itself to imukit drift, with a name ending in .h5\n");
    check_message("mv s1.h5 s1; $I grade s1; mv s1 s1.h5", 0,
                  "imukit grade: error: s1: this is the results file of a campaign; give the file "
                  "itself to imukit drift, with a name ending in .h5\n");
    check_message("cat s1.h5 | $I merge - s2.h5 -o x.h5", 1,
                  "imukit merge: warning: standard input: a results file cannot be read through a "
                  "pipe; give the file itself\nimukit merge: error: runs 0-49 of 100 are missing; "
                  "they may be in a file that could not be read: merge again with readable files "
                  "(--partial merges the existing runs)\n");
    run("cat s1.h5 | $I merge /dev/stdin s2.h5 -o x.h5");
    check_contains(err, "/dev/stdin: a results file cannot be read through a pipe", "merge");
    assert_null(strstr(err, "compute again"));
    assert_int_equal(run("$I merge missing.h5 s2.h5 -o x.h5"), 1);
    check_contains(err, "compute again with --shard", "merge");
    sweep();
}

/* What cannot be written is refused before hours are spent on it, and nothing is left; a pipe is
 * not opened for it, for its reader would take the closing for the end. */
static void unwritable_results(void **state)
{
    (void)state;
    static const struct {
        const char *make, *path, *says;
    } cases[] = {
        {"mkdir d.csv.gz", "d.csv.gz", "cannot be opened: Is a directory"},
        {"ln -s e.csv e.csv", "e.csv", "Too many levels of symbolic links"},
        {"ln -s no/f.csv f.csv", "f.csv", "the folder no does not exist"},
        {"python3 -c 'import socket; socket.socket(socket.AF_UNIX).bind(\"g.csv\")'", "g.csv",
         "No such device or address"},
        {"touch h.csv; chmod a-w h.csv", "h.csv", "cannot be opened: Permission denied"},
    };
    char line[300];
    put("m.yaml", model);
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        if (run(cases[i].make) != 0 || (strstr(cases[i].make, "chmod") && geteuid() == 0))
            continue; /* root may write it */
        snprintf(line, sizeof line,
                 "timeout 10 $I drift m.yaml --duration 1h --monte-carlo 100000 -o %s",
                 cases[i].path);
        assert_int_equal(run(line), 1);
        check_contains(err, cases[i].says, line);
        snprintf(line, sizeof line, "%s.part", cases[i].path);
        assert_int_not_equal(access(line, F_OK), 0);
    }
    snprintf(line, sizeof line, "mkfifo i.csv; cat i.csv >i & %s -o i.csv && wait && head -1 i",
             "$I drift m.yaml --duration 20s --monte-carlo 2");
    assert_int_equal(run(line), 0);
    check_contains(out, "run,time [s],", line);
    sweep();
}

static pid_t start(const char *shard, const char *path)
{
    const pid_t child = fork();
    if (child == 0) {
        if (!freopen("/dev/null", "w", stdout) || !freopen("said", "w", stderr))
            _exit(1);
        execl(command, command, "drift", "m.yaml", "--duration", "1min", "--seed", "3",
              "--monte-carlo", "400", "--shard", shard, "-o", path, "--threads", "1", (char *)NULL);
        _exit(1);
    }
    assert_true(child > 0);
    return child;
}

/* @return true when the signal ended it, false when it was done before */
static bool end(pid_t child, int number)
{
    int status;
    kill(child, number);
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFSIGNALED(status) ? WTERMSIG(status) == number : WEXITSTATUS(status) == 0);
    return WIFSIGNALED(status);
}

/* Each shard is killed after ever longer times, so that it ends in the end on any machine. */
static void killed_campaigns_end_in_the_same_bytes(void **state)
{
    (void)state;
    enum { SHARDS = 5 };
    unsigned kills = 0, random = 1;
    put("m.yaml", model);
    for (unsigned i = 1; i <= SHARDS; i++) {
        char shard[16], path[16];
        bool killed = true;
        snprintf(shard, sizeof shard, "%u/%d", i, SHARDS);
        snprintf(path, sizeof path, "s%u.h5", i);
        for (unsigned life = 0; killed; life++) {
            const pid_t child = start(shard, path);
            random = (unsigned)(random * UINT64_C(16807) % 2147483647u);
            usleep(15000 + random % 40000 * (1 + life));
            killed = end(child, SIGKILL);
            kills += killed;
        }
    }
    assert_true(kills > 0);
    assert_int_equal(run("$I merge s*.h5 -o all.h5 && $I drift m.yaml --duration 1min --seed 3 "
                         "--monte-carlo 400 -o one.h5"),
                     0);
    assert_int_equal(run("cmp one.h5 all.h5"), 0);
    sweep();
}

/* The size of a file; 0 when it is not there. */
static long size_of(const char *path)
{
    struct stat about;
    return stat(path, &about) == 0 ? (long)about.st_size : 0;
}

/* Ctrl-C says how to go on, and the process ends by the signal. */
static void an_interrupt_says_how_to_go_on(void **state)
{
    (void)state;
    bool interrupted = false;
    put("m.yaml", model);
    for (int attempt = 0; attempt < 10 && !interrupted; attempt++) {
        remove("x.h5");
        const pid_t child = start("1/1", "x.h5");
        /* The head, and a batch of runs: the campaign has begun. */
        for (int wait = 0; wait < 20000 && size_of("x.h5.part") < 8000; wait++)
            usleep(500);
        interrupted = end(child, SIGINT);
    }
    assert_true(interrupted);
    read_text("said", err);
    check_contains(err,
                   "interrupted: the runs computed so far are kept in x.h5.part, and the same "
                   "command continues from there\n",
                   "SIGINT");
    assert_int_equal(run("$I drift m.yaml --duration 1min --seed 4 --monte-carlo 400 -o x.h5"), 1);
    assert_string_equal(err, "imukit drift: error: x.h5.part: the seed is 3, not 4; remove the "
                             "file to begin anew, or choose another name for the results\n");
    assert_int_equal(run("$I drift m.yaml --duration 1min --seed 3 --monte-carlo 400 -o x.h5"), 0);
    check_contains(err, " of 400 runs exist already\n", "what the interrupt left");
    assert_int_equal(run("$I drift m.yaml --duration 1min --seed 3 --monte-carlo 400 -o x.h5"), 0);
    check_contains(err, "imukit drift: 400 of 400 runs exist already\n", "nothing is left to do");
    sweep();
}

/* The disk is full, as a limit of 8 KiB on files makes believe: nothing appears, what was there
 * stays, and the reason is said. */
static void a_full_disk(void **state)
{
    (void)state;
    put("m.yaml", model);
    assert_int_equal(run("trap '' XFSZ; ulimit -f 16; " DRIFT "-o x.h5"), 1);
    check_contains(err,
                   "imukit drift: error: x.h5.part: the file cannot be written: File too large; "
                   "make room: the runs computed before are kept\n",
                   "a limit on the size of files");
    assert_int_equal(access("x.h5", F_OK), -1);
    assert_int_equal(run(DRIFT "-o x.h5"), 0);
    check_contains(err, " of 100 runs exist already\n", "what the full disk held");
    assert_int_equal(run(DRIFT "-o one.h5 && cmp one.h5 x.h5"), 0);
    sweep();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(shards_and_threads_do_not_matter),
        cmocka_unit_test(what_is_wrong_is_named),
        cmocka_unit_test(wrong_usage),
        cmocka_unit_test(results_through_a_pipe),
        cmocka_unit_test(unwritable_results),
        cmocka_unit_test(killed_campaigns_end_in_the_same_bytes),
        cmocka_unit_test(an_interrupt_says_how_to_go_on),
        cmocka_unit_test(a_full_disk),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
