/* SPDX-License-Identifier: Apache-2.0 */
/* Texts of programs whose names and units are those of the program: what its header does not say,
 * and its definition does. */
#ifndef IMUKIT_LOG_DIALECTS_INTERNAL_H
#define IMUKIT_LOG_DIALECTS_INTERNAL_H

#include "imukit/record.h"

/* A name in the file, and what it stands for; "-": not read. */
typedef struct imki_log_rename {
    const char *from, *to;
} imki_log_rename;

typedef struct imki_log_dialect {
    const char *title;  /* in messages */
    const char *format; /* for --format, of texts without header; NULL: told by the header */
    const char *has[3]; /* names that its header has, all of them */
    imki_log_rename name[9];
    const char *columns; /* without header: the names of all columns */
} imki_log_dialect;

/* The dialect of a header, NULL: none. @param names  in the file, without units */
const imki_log_dialect *imki_log_dialect_of(size_t count, const char *const *names);
/* That of texts without header. */
const imki_log_dialect *imki_log_dialect_named(const char *format);
/* Row `index` of the table; NULL beyond the last. */
const imki_log_dialect *imki_log_dialect_get(size_t index);

#endif
