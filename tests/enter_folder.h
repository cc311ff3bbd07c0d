/* SPDX-License-Identifier: Apache-2.0 */
/* A folder of its own for a test program that removes what it finds in its folder. */
#ifndef IMUKIT_TESTS_ENTER_FOLDER_H
#define IMUKIT_TESTS_ENTER_FOLDER_H

#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

/* Make the folder (a pattern of mkdtemp) and work in it. Where that fails the program ends at once:
 * after a set-up that failed, cmocka runs the tear-down all the same, in the folder the program was
 * started in. */
static inline void enter_folder(char *pattern)
{
    if (mkdtemp(pattern) && chdir(pattern) == 0)
        return;
    perror(pattern);
    exit(EXIT_FAILURE);
}

#endif
