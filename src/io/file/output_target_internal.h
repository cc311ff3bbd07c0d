/* SPDX-License-Identifier: Apache-2.0 */
/* Where the bytes of an output file go: a temporary file beside its target, or straight to a
 * stream. */
#ifndef IMUKIT_OUTPUT_TARGET_INTERNAL_H
#define IMUKIT_OUTPUT_TARGET_INTERNAL_H

#include "imukit/status.h"

#include <stdbool.h>

typedef struct imki_target {
    int file;
    char *path;      /* as given, for messages; "standard output" */
    char *name;      /* the file to appear, links resolved; NULL when written directly */
    char *temporary; /* NULL when written directly */
    int slot;        /* in the register of temporary files, -1 when it was full */
    bool standard;
} imki_target;

/* @return 0 or an errno value */
int imki_target_open(imki_target *target, const char *path);

/* Why it could not be opened: the folder is told from the file.
 * @param number  from imki_target_open() */
imk_status imki_target_refuse(const char *path, int number, imk_error *error);

/* Can it be opened? Nothing is left behind, and a pipe is not touched: its reader would take the
 * closing for the end. @return as imki_target_open() */
int imki_target_check(const char *path);

/* Close the file and give it its name. @return 0 or an errno value */
int imki_target_publish(imki_target *target);

/* Close and free; what was not published is removed. */
void imki_target_close(imki_target *target);

#endif
