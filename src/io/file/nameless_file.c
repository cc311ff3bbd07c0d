/* SPDX-License-Identifier: Apache-2.0 */
/* Files without a name: they are gone with the process, however it ends. */
#define _GNU_SOURCE /* mkostemp() */
#include "nameless_file_internal.h"

#include "leftovers_internal.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

int imki_open_nameless(void)
{
    static const char pattern[] = "/imukit-XXXXXX";
    const char *folder = getenv("TMPDIR");
    folder = folder && *folder ? folder : "/tmp";
    const size_t size = strlen(folder) + sizeof pattern;
    char *name = malloc(size);
    if (!name)
        return -1;
    snprintf(name, size, "%s%s", folder, pattern);
    /* As long as it has a name, no signal may end the process. */
    sigset_t before;
    imki_signals_hold(&before);
    const int file = mkostemp(name, O_CLOEXEC);
    const int number = errno;
    if (file >= 0)
        unlink(name);
    imki_signals_release(&before);
    free(name);
    errno = number;
    return file;
}
