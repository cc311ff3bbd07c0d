/* SPDX-License-Identifier: Apache-2.0 */
/* The operating system's reasons, as text. */
#define _POSIX_C_SOURCE 200809L
#include "system_error_internal.h"

#include <errno.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

/* What to do about it; "" where the reason does not say. */
static const char *remedy_for(imk_status status, int number)
{
    const bool opened = status == IMK_ERROR_OPEN;
    switch (number) {
    case ENOENT:
    case ENOTDIR:
        return opened ? "check the path" : "";
    case ENAMETOOLONG:
        return opened ? "choose a shorter name" : "";
    case EACCES:
    case EPERM:
        return opened ? "check the permissions" : "";
    case EISDIR:
        return "give a file, not a folder";
    case EMFILE:
        return "raise the limit of open files: ulimit -n";
    case ENOSPC:
        return "make room, or choose another disk";
    case EFBIG:
        return "raise the limit of file sizes (ulimit -f), or choose another disk";
    default:
        return "";
    }
}

imk_status imki_system_error(imk_error *error, imk_status status, const char *path, int number)
{
    char reason[96];
    /* strerror() may share a buffer between threads; this is the POSIX strerror_r(), not GNU's. */
    if (strerror_r(number, reason, sizeof reason) != 0)
        snprintf(reason, sizeof reason, "system error %d", number);
    imk_error_set(error, status, path, reason, remedy_for(status, number));
    if (error)
        error->value = number;
    return status;
}
