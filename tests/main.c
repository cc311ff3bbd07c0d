/* SPDX-License-Identifier: Apache-2.0 */
/* The program of all tests: imukit-tests NAME runs the main of the test file NAME.c, and without a
 * name it lists them. test_programs.inc is written by the build. */
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

int main(int argc, char **argv)
{
    for (size_t i = 0; i < sizeof programs / sizeof *programs; i++) {
        if (argc < 2)
            puts(programs[i].name);
        else if (strcmp(argv[1], programs[i].name) == 0)
            return programs[i].run();
    }
    if (argc < 2)
        return EXIT_SUCCESS;
    fprintf(stderr, "there is no test \"%s\"; without a name, %s lists them\n", argv[1], argv[0]);
    return EXIT_FAILURE;
}
