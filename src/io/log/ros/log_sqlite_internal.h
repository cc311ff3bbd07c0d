/* SPDX-License-Identifier: Apache-2.0 */
/* SQLite databases of strangers, read only. */
#ifndef IMUKIT_LOG_SQLITE_INTERNAL_H
#define IMUKIT_LOG_SQLITE_INTERNAL_H

#include "imukit/status.h"

#include <sqlite3.h>
#include <stdbool.h>

/* The bytes of a database: a file read by pread(), or memory. */
typedef struct imki_sqlite_bytes {
    int file; /* -1: memory */
    const char *memory;
    uint64_t size;
    int system_error; /* errno of a read that failed; 0: none has */
    uint64_t steps;   /* of the library's machine since this was set to 0, in thousands */
    bool ahead;       /* in the mode of a write-ahead log */
    uint64_t claimed; /* size that the head of the database says, or `size` if that is larger */
} imki_sqlite_bytes;

/* A query takes no more steps than all pages of the file are worth: tables whose pages lead to the
 * same pages again and again have no end. It then fails as one of a damaged database does.
 *
 * Open a database, which reads `bytes` until it is closed. Only plain tables can be read: what
 * would run functions, other programs' code or without end is refused by the library. A file that
 * is shorter than its head says is read as far as it goes; what is missing is damaged.
 * @param handle  to be closed by sqlite3_close(), also on error; may be NULL
 * @return IMK_ERROR_FORMAT, IMK_ERROR_MEMORY */
imk_status imki_sqlite_open(imki_sqlite_bytes *bytes, sqlite3 **handle, imk_error *error);

/* Did the last call fail because of the system, not of what the database holds? */
bool imki_sqlite_is_system(sqlite3 *handle, const imki_sqlite_bytes *bytes);
/* Why the last call failed. @return IMK_ERROR_MEMORY, IMK_ERROR_READ, else IMK_ERROR_FORMAT */
imk_status imki_sqlite_refuse(sqlite3 *handle, const imki_sqlite_bytes *bytes, imk_error *error);

/* Is this a table, and no view or the like? */
bool imki_sqlite_has_table(sqlite3 *handle, const char *name);

#endif
