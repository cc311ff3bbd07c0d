/* SPDX-License-Identifier: Apache-2.0 */
/* The private temporary folder in which a program draws. */
#ifndef IMUKIT_SCRATCH_FOLDER_INTERNAL_H
#define IMUKIT_SCRATCH_FOLDER_INTERNAL_H

#include "imukit/status.h"

#include <stdbool.h>

/* The files in it, whose names are the same for every figure. */
typedef enum imki_scratch_file {
    IMKI_SCRATCH_INPUT = 0,
    IMKI_SCRATCH_DATA,
    IMKI_SCRATCH_OUTPUT,
    IMKI_SCRATCH_SAID,
    IMKI_SCRATCH_FILES
} imki_scratch_file;
extern const char *const imki_scratch_names[IMKI_SCRATCH_FILES];

typedef struct imki_scratch {
    char *folder;
    char *file[IMKI_SCRATCH_FILES];
    int slot[IMKI_SCRATCH_FILES +
             1]; /* of the files and the folder, in the register of leftovers */
} imki_scratch;

/* Make the folder, in $TMPDIR or /tmp. */
imk_status imki_scratch_make(imki_scratch *s, imk_error *error);

/* Remove it with all that is in it, and free. */
void imki_scratch_remove(imki_scratch *s);

imk_status imki_scratch_save(const imki_scratch *s, imki_scratch_file which, const char *text,
                             size_t size, imk_error *error);

/* A whole file that is not empty, with a terminating zero, from malloc().
 * @return 0 or an errno value */
int imki_scratch_load(const imki_scratch *s, imki_scratch_file which, char **text, size_t *size);

/* The last line of a file that is not empty, shortened; "" when there is none. */
void imki_scratch_last_line(const imki_scratch *s, imki_scratch_file which, char *line,
                            size_t size);

/* Is the disk full, so that the output may be cut short? It is not to be used afterwards. */
bool imki_scratch_is_full(const imki_scratch *s);

/* The message for that. */
imk_status imki_scratch_refuse_full(imk_error *error);

#endif
