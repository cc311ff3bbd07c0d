/* SPDX-License-Identifier: Apache-2.0 */
#include "run_command.h"

#include "enter_folder.h"

#include <dirent.h>
#include <stdlib.h>

char command[4096];
char directory[] = "/tmp/imukit-cli-XXXXXX";
char out[TEXT_SIZE], err[TEXT_SIZE];

static void locate_command(void)
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

int set_up(void **state)
{
    (void)state;
    locate_command();
    if (access(command, X_OK) != 0) {
        print_error("%s is not there: build the target imukit-command\n", command);
        exit(EXIT_FAILURE); /* see enter_folder.h */
    }
    unsetenv("NO_COLOR");
    enter_folder(directory);
    return 0;
}

int tear_down(void **state)
{
    (void)state;
    return chdir("/") == 0 ? rmdir(directory) : -1;
}

void read_text(const char *path, char *text)
{
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    text[fread(text, 1, TEXT_SIZE - 1, file)] = '\0';
    fclose(file);
}

/* Where statistics are others' (check.h), the sanitizers look for leaks, which takes half the time
 * of a start, after each fifth line only. */
static void look_for_leaks_at_times(void)
{
    static unsigned lines;
    static char options[400];
    if (!check_quick())
        return;
    if (lines == 0)
        snprintf(options, sizeof options, "%s",
                 getenv("ASAN_OPTIONS") ? getenv("ASAN_OPTIONS") : "");
    char all[440];
    snprintf(all, sizeof all, "%s:detect_leaks=%d", options, lines++ % 5 == 0);
    setenv("ASAN_OPTIONS", all, 1);
}

int run(const char *line)
{
    char whole[8192];
    look_for_leaks_at_times();
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

void put(const char *path, const char *text)
{
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(text, 1, strlen(text), file), strlen(text));
    assert_int_equal(fclose(file), 0);
}

size_t sweep(void)
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

void check_contains(const char *text, const char *part, const char *line)
{
    if (!strstr(text, part)) {
        print_error("%s\n  printed: %s\n  expected in it: %s\n", line, text, part);
        fail();
    }
}

void check_message(const char *line, int code, const char *message)
{
    int actual = run(line);
    if (actual != code || strcmp(err, message) != 0) {
        print_error("%s\n  code %d, expected %d\n  says:     %s\n  expected: %s\n", line, actual,
                    code, err, message);
        fail();
    }
}

void write_good(void)
{
    FILE *file = fopen("good.csv", "wb");
    assert_non_null(file);
    uint64_t n = 1;
    fputs("time [s],gyro_x [deg/s]\n", file);
    for (int i = 0; i < 1000; i++, n = 16807 * n % 2147483647)
        fprintf(file, "%.2f,%.6f\n", i / 100.0, (double)n / 2147483647);
    fclose(file);
}
