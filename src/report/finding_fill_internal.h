/* SPDX-License-Identifier: Apache-2.0 */
#ifndef IMUKI_FINDING_FILL_INTERNAL_H
#define IMUKI_FINDING_FILL_INTERNAL_H

#include "imukit/job.h"

/* A text of at most `size` bytes, its end included; `length` is that of the whole. */
typedef struct imki_finding_writing {
    char *text;
    size_t size, length;
    const char *record, *model; /* what these are called */
} imki_finding_writing;

void imki_finding_put(imki_finding_writing *writing, const char *text, size_t length);
/* A message with its braces filled in, and the end of the text. @return the length of the whole */
size_t imki_finding_fill(imki_finding_writing *writing, const char *message,
                         const imk_finding *finding);

#endif
