/* SPDX-License-Identifier: Apache-2.0 */
/* A command that a signal or a limit of the system ends leaves nothing behind. */
#define _GNU_SOURCE /* F_NOTIFY */
#include "run_command.h"

#include <dirent.h>
#include <fcntl.h>
#include <signal.h>
#include <sys/resource.h>
#include <time.h>

/* The temporary file that a command has begun to write; waits for it. */
static bool has_begun(void)
{
    const struct timespec nap = {.tv_nsec = 5000000};
    for (int i = 0; i < 6000; i++, nanosleep(&nap, NULL)) {
        DIR *listing = opendir(".");
        bool found = false;
        assert_non_null(listing);
        for (struct dirent *entry = readdir(listing); entry; entry = readdir(listing))
            found = found || strstr(entry->d_name, ".part");
        closedir(listing);
        if (found)
            return true;
    }
    return false;
}

/* Ends as the signal would have, without a temporary file. */
static void test_signals(void **state)
{
    (void)state;
    static const int signals[] = {SIGINT,  SIGTERM, SIGHUP,  SIGQUIT,
                                  SIGXCPU, SIGUSR1, SIGUSR2, SIGALRM};
    for (size_t i = 0; i < sizeof signals / sizeof signals[0]; i++) {
        fflush(stdout);
        const pid_t child = fork();
        if (child == 0) {
            const struct rlimit no_core = {0, 0};
            setrlimit(RLIMIT_CORE, &no_core);
            execl(command, command, "simulate", "tactical", "--rate", "100Hz", "--duration",
                  "1000h", "-o", "long.csv", (char *)NULL);
            _exit(98);
        }
        const bool begun = has_begun();
        kill(child, signals[i]);
        int status;
        assert_int_equal(waitpid(child, &status, 0), child);
        assert_true(begun);
        assert_true(WIFSIGNALED(status));
        assert_int_equal(WTERMSIG(status), signals[i]);
        assert_int_equal(sweep(), 0);
    }
}

/* The first new file in the working directory sends this process a signal, within the call that
 * makes it. */
static void ask_for_signal(int number)
{
    const int folder = open(".", O_RDONLY);
    if (folder < 0 || fcntl(folder, F_SETSIG, number) != 0 ||
        fcntl(folder, F_SETOWN, getpid()) != 0 || fcntl(folder, F_NOTIFY, DN_CREATE) != 0)
        _exit(97);
}

/* Also when the signal comes while the temporary file is being made. */
static void test_signal_at_once(void **state)
{
    (void)state;
    static const int signals[] = {SIGINT, SIGTERM, SIGHUP, SIGUSR1, SIGUSR2, SIGALRM};
    for (size_t i = 0; i < sizeof signals / sizeof signals[0]; i++) {
        fflush(stdout);
        const pid_t child = fork();
        if (child == 0) {
            ask_for_signal(signals[i]);
            execl(command, command, "simulate", "tactical", "--rate", "10Hz", "--duration", "10s",
                  "-o", "short.csv", (char *)NULL);
            _exit(98);
        }
        int status;
        assert_int_equal(waitpid(child, &status, 0), child);
        if (WIFEXITED(status) && WEXITSTATUS(status) == 97)
            skip(); /* a kernel that does not tell of new files */
        assert_true(WIFSIGNALED(status));
        assert_int_equal(WTERMSIG(status), signals[i]);
        assert_int_equal(sweep(), 0);
    }
}

/* A file beyond the limit of its size is refused like one on a full disk. */
static void test_file_size(void **state)
{
    (void)state;
    static const char *const lines[] = {
        "$I simulate tactical --rate 100Hz --duration 10min -o long.csv",
        "$I simulate tactical --rate 100Hz --duration 10min -o long.npy",
        "$I simulate tactical --rate 100Hz --duration 10min -o long.csv --truth truth.csv",
    };
    char line[300];
    for (size_t i = 0; i < sizeof lines / sizeof lines[0]; i++) {
        snprintf(line, sizeof line, "( ulimit -f 100; %s )", lines[i]);
        assert_int_equal(run(line), 1);
        check_contains(err, ": the file cannot be written: File too large", line);
        assert_int_equal(sweep(), 0);
    }
    assert_int_equal(run("( ulimit -f 100; $I simulate tactical --rate 100Hz --duration 10min -o - "
                         ">cut.csv )"),
                     1);
    check_contains(err, "standard output: the file cannot be written: File too large", "stdout");
    assert_int_equal(sweep(), 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_signals),
        cmocka_unit_test(test_signal_at_once),
        cmocka_unit_test(test_file_size),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
