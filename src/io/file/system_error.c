/* SPDX-License-Identifier: Apache-2.0 */
/* The operating system's reasons, as text. */
#define _POSIX_C_SOURCE 200809L
#include "system_error_internal.h"

#include <stdio.h>
#include <string.h>

imk_status imki_system_error(imk_error *error, imk_status status, const char *path, int number)
{
    char reason[96];
    /* strerror() may share a buffer between threads; this is the POSIX strerror_r(), not GNU's. */
    if (strerror_r(number, reason, sizeof reason) != 0)
        snprintf(reason, sizeof reason, "system error %d", number);
    return imk_error_set(error, status, path, reason, "");
}
