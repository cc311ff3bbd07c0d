/* SPDX-License-Identifier: Apache-2.0 */
/* The machine that a page is: its verbs, and what POSIX has and WASI has not, for files that name
 * it and never need it in a page: signals that wait, descriptors that are copied, the size of a
 * terminal. Included before all else. */
#ifndef IMUKIT_MACHINE_H
#define IMUKIT_MACHINE_H

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <sys/types.h>

/* The verbs of a page. */
#define COMMAND_VERBS(VERB)                                                                        \
    VERB(info)                                                                                     \
    VERB(identify)                                                                                 \
    VERB(calibrate)                                                                                \
    VERB(simulate)                                                                                 \
    VERB(allan)                                                                                    \
    VERB(devices)                                                                                  \
    VERB(grade)                                                                                    \
    VERB(convert)                                                                                  \
    VERB(physics)                                                                                  \
    VERB(drift)

#ifndef PATH_MAX
#define PATH_MAX 4096
#endif
#ifndef NAME_MAX
#define NAME_MAX 255
#endif

typedef unsigned sigset_t;

/* fcntl(…, F_DUPFD_CLOEXEC, …) fails: a page has no descriptors that a path names. */
#define F_DUPFD_CLOEXEC (-1)

/* ioctl(…, TIOCGWINSZ, …) fails: a page has no terminal. */
struct winsize {
    unsigned short ws_row, ws_col;
};
#define TIOCGWINSZ 0x5413

/* core/absent.c defines them. */
char *realpath(const char *path, char *resolved);
int fchmod(int file, mode_t mode);

#endif
