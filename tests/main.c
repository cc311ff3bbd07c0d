/* SPDX-License-Identifier: Apache-2.0 */
/* The program of all tests: imukit-tests NAME runs the main of the test file NAME.c, imukit-tests
 * NAME CASE... these of its cases, and without a name it lists the files. test_programs.inc is
 * written by the build.
 *
 * What the file IMUKIT_TESTS_LEFT_OUT holds, "NAME CASE" in each line, is left out. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define TEST_PROGRAM(name) int main_##name(void);
#include "test_programs.inc"
#undef TEST_PROGRAM

static const struct {
    const char *name;
    int (*run)(void);
} programs[] = {
#define TEST_PROGRAM(name) {#name, main_##name},
#include "test_programs.inc"
};

static char **asked; /* the words of the command line, from NAME */
static FILE *left_out;

static bool is_asked_for(const char *test)
{
    char line[400], file[200], name[200];
    bool asked_for = !asked[1];
    for (char **word = asked + 1; *word; word++)
        asked_for |= strcmp(*word, test) == 0;
    if (!left_out)
        return asked_for;
    rewind(left_out);
    while (asked_for && fgets(line, sizeof line, left_out))
        asked_for = sscanf(line, "%199s %199s", file, name) != 2 || strcmp(file, asked[0]) != 0 ||
                    strcmp(name, test) != 0;
    return asked_for;
}

int run_asked_for(const char *name, const struct CMUnitTest *tests, size_t count,
                  CMFixtureFunction set_up, CMFixtureFunction tear_down);

/** What cmocka_run_group_tests() does, for the cases that are asked for. */
int run_asked_for(const char *name, const struct CMUnitTest *tests, size_t count,
                  CMFixtureFunction set_up, CMFixtureFunction tear_down)
{
    struct CMUnitTest *chosen = calloc(count, sizeof *chosen);
    size_t chosen_count = 0;
    for (size_t i = 0; chosen && i < count; i++)
        if (is_asked_for(tests[i].name))
            chosen[chosen_count++] = tests[i];
    const int failed = chosen_count > 0
                           ? _cmocka_run_group_tests(name, chosen, chosen_count, set_up, tear_down)
                           : !left_out;
    free(chosen);
    return failed;
}

static int run(int (*program)(void))
{
    const char *path = getenv("IMUKIT_TESTS_LEFT_OUT");
    if (path && !(left_out = fopen(path, "r"))) {
        perror(path);
        return EXIT_FAILURE;
    }
    const int failed = program();
    if (left_out)
        fclose(left_out);
    return failed;
}

int main(int argc, char **argv)
{
    asked = argv + 1;
    for (size_t i = 0; i < sizeof programs / sizeof *programs; i++) {
        if (argc < 2)
            puts(programs[i].name);
        else if (strcmp(argv[1], programs[i].name) == 0)
            return run(programs[i].run);
    }
    if (argc < 2)
        return EXIT_SUCCESS;
    fprintf(stderr, "there is no test \"%s\"; without a name, %s lists them\n", argv[1], argv[0]);
    return EXIT_FAILURE;
}
