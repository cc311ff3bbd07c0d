/* SPDX-License-Identifier: Apache-2.0 */
/* Runs the command as a user would and keeps what it printed. The binary under test is
 * IMUKIT_COMMAND, given by the build, or `imukit` beside the test program. Every test program works
 * in an empty directory of its own, so that what a command leaves behind can be seen. */
#ifndef IMUKIT_TESTS_RUN_COMMAND_H
#define IMUKIT_TESTS_RUN_COMMAND_H

#define _DEFAULT_SOURCE
#include "check.h"
#include "imukit/report.h"

#include <dirent.h>
#include <jansson.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

enum { TEXT_SIZE = 1 << 20 };
static char command[4096];
static char directory[] = "/tmp/imukit-cli-XXXXXX";
static char out[TEXT_SIZE], err[TEXT_SIZE];

static inline void locate_command(void)
{
#ifdef IMUKIT_COMMAND
    snprintf(command, sizeof command, "%s", IMUKIT_COMMAND);
#else
    char here[3000];
    ssize_t length = readlink("/proc/self/exe", here, sizeof here - 1);
    here[length > 0 ? length : 0] = '\0';
    char *slash = strrchr(here, '/');
    if (slash)
        *slash = '\0';
    snprintf(command, sizeof command, "%s/imukit", here);
#endif
}

static inline int set_up(void **state)
{
    (void)state;
    locate_command();
    if (access(command, X_OK) != 0) {
        print_error("%s is not there: build the target imukit-command\n", command);
        return -1;
    }
    unsetenv("NO_COLOR");
    return mkdtemp(directory) && chdir(directory) == 0 ? 0 : -1;
}

static inline int tear_down(void **state)
{
    (void)state;
    return chdir("/") == 0 ? rmdir(directory) : -1;
}

static inline void read_text(const char *path, char *text)
{
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    text[fread(text, 1, TEXT_SIZE - 1, file)] = '\0';
    fclose(file);
}

/* Run a shell line in which $I is the command; standard output and error go to out and err. */
static inline int run(const char *line)
{
    char whole[8192];
    setenv("I", command, 1);
    snprintf(whole, sizeof whole, "{ %s ; } >/tmp/imukit-cli-out.%d 2>/tmp/imukit-cli-err.%d", line,
             (int)getpid(), (int)getpid());
    int status = system(whole);
    snprintf(whole, sizeof whole, "/tmp/imukit-cli-out.%d", (int)getpid());
    read_text(whole, out);
    unlink(whole);
    snprintf(whole, sizeof whole, "/tmp/imukit-cli-err.%d", (int)getpid());
    read_text(whole, err);
    unlink(whole);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

static inline void put(const char *path, const char *text)
{
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(text, 1, strlen(text), file), strlen(text));
    assert_int_equal(fclose(file), 0);
}

/* Files in the working directory; they are removed. */
static inline size_t sweep(void)
{
    DIR *listing = opendir(".");
    size_t count = 0;
    assert_non_null(listing);
    for (struct dirent *entry = readdir(listing); entry; entry = readdir(listing)) {
        if (strcmp(entry->d_name, ".") == 0 || strcmp(entry->d_name, "..") == 0)
            continue;
        count++;
        remove(entry->d_name);
    }
    closedir(listing);
    return count;
}

static inline void check_contains(const char *text, const char *part, const char *line)
{
    if (!strstr(text, part)) {
        print_error("%s\n  printed: %s\n  expected in it: %s\n", line, text, part);
        fail();
    }
}

/* A line that must end with this code and say exactly this on standard error. */
static inline void check_message(const char *line, int code, const char *message)
{
    int actual = run(line);
    if (actual != code || strcmp(err, message) != 0) {
        print_error("%s\n  code %d, expected %d\n  says:     %s\n  expected: %s\n", line, actual,
                    code, err, message);
        fail();
    }
}

#define TRY_MAIN "Try: imukit --help\n"
#define TRY(verb) "Try: imukit " verb " --help\n"

/* 1000 rows at 100 Hz of one gyro. */
static inline void write_good(void)
{
    FILE *file = fopen("good.csv", "wb");
    assert_non_null(file);
    uint64_t n = 1;
    fputs("time [s],gyro_x [deg/s]\n", file);
    for (int i = 0; i < 1000; i++, n = 16807 * n % 2147483647)
        fprintf(file, "%.2f,%.6f\n", i / 100.0, (double)n / 2147483647);
    fclose(file);
}

#endif
