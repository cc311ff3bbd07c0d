/* SPDX-License-Identifier: Apache-2.0 */
/* SQLite reads through functions of ours (a "VFS" [SQLITEVFS]) that show it the descriptor of an
 * input, or memory, and nothing else: no journals, no locks, no other files. So a database can come
 * from anywhere the input can, and nothing in it makes the library touch another file. */
#define _POSIX_C_SOURCE 200809L
#include "log_sqlite_internal.h"

#include "io/file/system_error_internal.h"
#include "ros_bytes_internal.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

enum { HEAD = 100, NAME_SIZE = 64, VALUE_MAX = 64 << 20 };

typedef struct source {
    sqlite3_file base;
    imki_sqlite_bytes *bytes;
} source;

/* Up to `size` bytes. @return how many; -1: the system refuses */
static ssize_t read_bytes(imki_sqlite_bytes *bytes, void *to, size_t size, uint64_t place)
{
    if (place >= bytes->size)
        return 0;
    const uint64_t left = bytes->size - place;
    size = size < left ? size : (size_t)left;
    if (bytes->file < 0) {
        memcpy(to, bytes->memory + place, size);
        return (ssize_t)size;
    }
    size_t done = 0;
    while (done < size) {
        const ssize_t got =
            pread(bytes->file, (char *)to + done, size - done, (off_t)(place + done));
        if (got < 0 && errno != EINTR) {
            bytes->system_error = errno;
            return -1;
        }
        if (got == 0)
            break;
        done += got > 0 ? (size_t)got : 0;
    }
    return (ssize_t)done;
}

static int file_close(sqlite3_file *file)
{
    (void)file;
    return SQLITE_OK;
}

static int file_read(sqlite3_file *file, void *to, int size, sqlite3_int64 place)
{
    imki_sqlite_bytes *bytes = ((source *)file)->bytes;
    const ssize_t got = read_bytes(bytes, to, (size_t)size, (uint64_t)place);
    /* Zeros in the place of a page that is missing would be taken for its content. */
    if (got < 0 || (got < size && bytes->claimed > bytes->size))
        return SQLITE_IOERR_READ;
    memset((char *)to + got, 0, (size_t)size - (size_t)got);
    return got == size ? SQLITE_OK : SQLITE_IOERR_SHORT_READ;
}

static int file_write(sqlite3_file *file, const void *from, int size, sqlite3_int64 place)
{
    (void)file, (void)from, (void)size, (void)place;
    return SQLITE_READONLY;
}

static int file_truncate(sqlite3_file *file, sqlite3_int64 size)
{
    (void)file, (void)size;
    return SQLITE_READONLY;
}

static int file_sync(sqlite3_file *file, int flags)
{
    (void)file, (void)flags;
    return SQLITE_OK;
}

static int file_size(sqlite3_file *file, sqlite3_int64 *size)
{
    *size = (sqlite3_int64)((const source *)file)->bytes->claimed;
    return SQLITE_OK;
}

static int file_lock(sqlite3_file *file, int level)
{
    (void)file, (void)level;
    return SQLITE_OK;
}

static int file_is_reserved(sqlite3_file *file, int *reserved)
{
    (void)file;
    *reserved = 0;
    return SQLITE_OK;
}

static int file_control(sqlite3_file *file, int operation, void *argument)
{
    (void)file, (void)operation, (void)argument;
    return SQLITE_NOTFOUND;
}

static int file_sector(sqlite3_file *file)
{
    (void)file;
    return 4096;
}

/* Without journal and locks. */
static int file_traits(sqlite3_file *file)
{
    (void)file;
    return SQLITE_IOCAP_IMMUTABLE;
}

static const sqlite3_io_methods methods = {1,
                                           file_close,
                                           file_read,
                                           file_write,
                                           file_truncate,
                                           file_sync,
                                           file_size,
                                           file_lock,
                                           file_lock,
                                           file_is_reserved,
                                           file_control,
                                           file_sector,
                                           file_traits,
                                           NULL,
                                           NULL,
                                           NULL,
                                           NULL,
                                           NULL,
                                           NULL};

/* The name is the address of the bytes. */
static int vfs_open(sqlite3_vfs *vfs, const char *name, sqlite3_file *file, int flags, int *given)
{
    (void)vfs;
    void *bytes;
    file->pMethods = NULL;
    if (!name || !(flags & SQLITE_OPEN_MAIN_DB) || sscanf(name, "%p", &bytes) != 1)
        return SQLITE_CANTOPEN;
    ((source *)file)->bytes = bytes;
    file->pMethods = &methods;
    if (given)
        *given = SQLITE_OPEN_READONLY | SQLITE_OPEN_MAIN_DB;
    return SQLITE_OK;
}

static int vfs_delete(sqlite3_vfs *vfs, const char *name, int sync)
{
    (void)vfs, (void)name, (void)sync;
    return SQLITE_READONLY;
}

static int vfs_access(sqlite3_vfs *vfs, const char *name, int flags, int *result)
{
    (void)vfs, (void)name, (void)flags;
    *result = 0;
    return SQLITE_OK;
}

static int vfs_path(sqlite3_vfs *vfs, const char *name, int size, char *full)
{
    (void)vfs;
    snprintf(full, (size_t)size, "%s", name);
    return SQLITE_OK;
}

static int vfs_random(sqlite3_vfs *vfs, int size, char *bytes)
{
    (void)vfs;
    memset(bytes, 0, (size_t)size); /* only for names of temporary files, of which there are none */
    return size;
}

static int vfs_sleep(sqlite3_vfs *vfs, int microseconds)
{
    (void)vfs;
    return microseconds;
}

static int vfs_time(sqlite3_vfs *vfs, double *day)
{
    (void)vfs;
    *day = 0.0;
    return SQLITE_OK;
}

static int vfs_error(sqlite3_vfs *vfs, int size, char *text)
{
    (void)vfs;
    if (size > 0)
        text[0] = '\0';
    return 0;
}

/* @return false: no memory */
static bool register_vfs(void)
{
    static sqlite3_vfs vfs = {.iVersion = 1,
                              .szOsFile = sizeof(source),
                              .mxPathname = NAME_SIZE,
                              .zName = "imukit",
                              .xOpen = vfs_open,
                              .xDelete = vfs_delete,
                              .xAccess = vfs_access,
                              .xFullPathname = vfs_path,
                              .xRandomness = vfs_random,
                              .xSleep = vfs_sleep,
                              .xCurrentTime = vfs_time,
                              .xGetLastError = vfs_error};
    return sqlite3_vfs_find(vfs.zName) || sqlite3_vfs_register(&vfs, 0) == SQLITE_OK;
}

/* Columns of tables are read, and nothing else is done. */
static int authorise(void *context, int action, const char *a, const char *b, const char *c,
                     const char *d)
{
    (void)context, (void)a, (void)b, (void)c, (void)d;
    return action == SQLITE_SELECT || action == SQLITE_READ ? SQLITE_OK : SQLITE_DENY;
}

/* A row, of 8 bytes at least, takes some twenty steps. */
static int count_steps(void *context)
{
    imki_sqlite_bytes *bytes = context;
    return ++bytes->steps > 10000 + bytes->size / 128;
}

static bool lacks_memory(sqlite3 *handle)
{
    return !handle || sqlite3_errcode(handle) == SQLITE_NOMEM ||
           sqlite3_extended_errcode(handle) == SQLITE_IOERR_NOMEM;
}

bool imki_sqlite_is_system(sqlite3 *handle, const imki_sqlite_bytes *bytes)
{
    return lacks_memory(handle) || bytes->system_error != 0;
}

imk_status imki_sqlite_refuse(sqlite3 *handle, const imki_sqlite_bytes *bytes, imk_error *error)
{
    char found[160];
    if (lacks_memory(handle))
        return imk_error_set(error, IMK_ERROR_MEMORY, "", NULL, NULL);
    if (bytes->system_error != 0)
        return imki_system_error(error, IMK_ERROR_READ, "", bytes->system_error);
    snprintf(found, sizeof found, "SQLite cannot read the file: %s", sqlite3_errmsg(handle));
    return imk_error_set(error, IMK_ERROR_FORMAT, "", found,
                         "copy the file again, or save what is whole: sqlite3 OLD.db3 .recover | "
                         "sqlite3 NEW.db3");
}

/* The head says the size of a page, the mode of writing, and the number of pages. */
static void look_at_head(imki_sqlite_bytes *bytes)
{
    uint8_t head[HEAD];
    bytes->claimed = bytes->size;
    if (read_bytes(bytes, head, HEAD, 0) != HEAD)
        return;
    bytes->ahead = head[18] == 2 || head[19] == 2;
    const uint32_t page = (uint32_t)head[16] << 8 | head[17];
    const uint64_t pages =
        (uint32_t)head[28] << 24 | (uint32_t)head[29] << 16 | (uint32_t)head[30] << 8 | head[31];
    const uint64_t size = pages * (page == 1 ? 65536 : page);
    if (size > bytes->size)
        bytes->claimed = size;
}

imk_status imki_sqlite_open(imki_sqlite_bytes *bytes, sqlite3 **handle, imk_error *error)
{
    char name[NAME_SIZE];
    if (!register_vfs())
        return imk_error_set(error, IMK_ERROR_MEMORY, "", NULL, NULL);
    look_at_head(bytes);
    snprintf(name, sizeof name, "%p", (void *)bytes);
    if (sqlite3_open_v2(name, handle, SQLITE_OPEN_READONLY, "imukit") != SQLITE_OK)
        return imki_sqlite_refuse(*handle, bytes, error);
    sqlite3_db_config(*handle, SQLITE_DBCONFIG_DEFENSIVE, 1, NULL);
    sqlite3_db_config(*handle, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, NULL);
    sqlite3_limit(*handle, SQLITE_LIMIT_LENGTH, VALUE_MAX);
    sqlite3_limit(*handle, SQLITE_LIMIT_ATTACHED, 0);
    sqlite3_limit(*handle, SQLITE_LIMIT_WORKER_THREADS, 0);
    if (sqlite3_exec(*handle, "PRAGMA cell_size_check=ON; PRAGMA temp_store=MEMORY", NULL, NULL,
                     NULL) != SQLITE_OK)
        return imki_sqlite_refuse(*handle, bytes, error);
    sqlite3_progress_handler(*handle, 1000, count_steps, bytes);
    sqlite3_set_authorizer(*handle, authorise, NULL);
    return IMK_OK;
}

bool imki_sqlite_has_table(sqlite3 *handle, const char *name)
{
    static const char begin[] = "CREATE TABLE "; /* as the library itself writes it */
    sqlite3_stmt *query = NULL;
    bool found = false;
    if (sqlite3_prepare_v2(handle, "SELECT type, sql FROM sqlite_master WHERE name = ?1", -1,
                           &query, NULL) != SQLITE_OK)
        return false;
    sqlite3_bind_text(query, 1, name, -1, SQLITE_STATIC);
    while (!found && sqlite3_step(query) == SQLITE_ROW) {
        const char *type = (const char *)sqlite3_column_text(query, 0);
        const char *text = (const char *)sqlite3_column_text(query, 1);
        found = type && text && strcmp(type, "table") == 0 &&
                strncmp(text, begin, sizeof begin - 1) == 0;
    }
    sqlite3_finalize(query);
    return found;
}
