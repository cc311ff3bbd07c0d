/* SPDX-License-Identifier: Apache-2.0 */
/* Names that mean a stream this process has open. */
#include "descriptor_name_internal.h"

#include <limits.h>
#include <stdbool.h>
#include <stddef.h>
#include <string.h>

int imki_descriptor_named(const char *path)
{
    static const char *const streams[] = {"/dev/stdin", "/dev/stdout", "/dev/stderr"};
    static const char *const folders[] = {"/dev/fd/", "/proc/self/fd/"};
    for (int stream = 0; stream < 3; stream++)
        if (strcmp(path, streams[stream]) == 0)
            return stream;
    const char *digits = NULL;
    for (size_t i = 0; i < sizeof folders / sizeof folders[0]; i++)
        if (strncmp(path, folders[i], strlen(folders[i])) == 0)
            digits = path + strlen(folders[i]);
    int number = digits && *digits ? 0 : -1;
    for (; number >= 0 && *digits; digits++) {
        const int digit = *digits - '0';
        const bool good = digit >= 0 && digit <= 9 && number <= (INT_MAX - digit) / 10;
        number = good ? 10 * number + digit : -1;
    }
    return number;
}
