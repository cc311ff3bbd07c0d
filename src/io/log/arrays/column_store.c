/* SPDX-License-Identifier: Apache-2.0 */
/* The temporary file consists of blocks, in each of which column stands after column. */
#define _POSIX_C_SOURCE 200809L
#include "column_store_internal.h"

#include "base/text_internal.h"
#include "imukit/names.h"
#include "io/file/file_bytes_internal.h"
#include "io/file/nameless_file_internal.h"
#include "io/file/system_error_internal.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { VALUE = 8, BLOCK_ROWS = 4096, PIECE = VALUE * BLOCK_ROWS };

static imk_status refuse(imk_error *error, int number)
{
    imk_error reason;
    char found[96];
    (void)imki_system_error(&reason, IMK_ERROR_WRITE, "", number);
    snprintf(found, sizeof found, "its temporary file cannot be written: %.55s", reason.found);
    return imk_error_set(error, IMK_ERROR_WRITE, "", found, "set TMPDIR to a folder with room");
}

imk_status imki_column_store_create(imki_log_output *log, const char *path, imk_error *error)
{
    if (imk_has_ending(path, ".gz") || imk_has_ending(path, ".zst"))
        return imk_error_set(error, IMK_ERROR_UNSUPPORTED, path,
                             "arrays are not read from a compressed file",
                             "leave the last ending out, or write a .csv");
    imki_column_store *store = calloc(1, sizeof *store);
    if (!store)
        return imk_error_set(error, IMK_ERROR_MEMORY, path, "", "");
    log->state = store;
    store->columns = log->rows.column_count;
    store->file = imki_open_nameless();
    if (store->file < 0)
        return refuse(error, errno);
    store->block = malloc(store->columns * PIECE);
    return store->block ? IMK_OK : imk_error_set(error, IMK_ERROR_MEMORY, path, "", "");
}

void imki_column_store_discard(imki_log_output *log)
{
    imki_column_store *store = log->state;
    if (!store)
        return;
    if (store->file >= 0)
        close(store->file);
    free(store->block);
    free(store);
    log->state = NULL;
}

/* Write the block, whole also where the last one is not full. */
static imk_status write_block(imki_column_store *store)
{
    const unsigned char *at = store->block;
    size_t left = store->columns * PIECE;
    for (size_t i = 0; i < store->columns; i++)
        store->crc[i] = imki_crc(store->crc[i], at + i * PIECE, store->filled * VALUE);
    while (left > 0) {
        const ssize_t count = write(store->file, at, left);
        if (count < 0 && errno != EINTR)
            return refuse(&store->failure, errno);
        if (count > 0) {
            at += count;
            left -= (size_t)count;
        }
    }
    store->filled = 0;
    return IMK_OK;
}

imk_status imki_column_store_write(imki_log_output *log, const char *bytes, size_t size,
                                   size_t rows)
{
    imki_column_store *store = log->state;
    (void)size;
    for (size_t done = 0; done < rows && store->failure.status == IMK_OK;) {
        const size_t room = BLOCK_ROWS - store->filled, left = rows - done;
        const size_t count = left < room ? left : room;
        for (size_t c = 0; c < store->columns; c++) {
            const char *from = bytes + (done * store->columns + c) * VALUE;
            unsigned char *to = store->block + c * PIECE + store->filled * VALUE;
            for (size_t i = 0; i < count; i++)
                memcpy(to + i * VALUE, from + i * store->columns * VALUE, VALUE);
        }
        store->filled += count;
        store->rows += count;
        done += count;
        if (store->filled == BLOCK_ROWS)
            write_block(store);
    }
    return store->failure.status;
}

imk_status imki_column_store_end(imki_log_output *log, imk_error *error)
{
    imki_column_store *store = log->state;
    if (store->failure.status == IMK_OK && store->filled > 0)
        write_block(store);
    if (store->failure.status != IMK_OK && error)
        *error = store->failure;
    return store->failure.status;
}

imk_status imki_column_store_put(imki_log_output *log, size_t column, imk_error *error)
{
    imki_column_store *store = log->state;
    imk_status status = IMK_OK;
    uint64_t block = 0;
    for (uint64_t left = store->rows; left > 0 && status == IMK_OK; block++) {
        const size_t rows = left < BLOCK_ROWS ? (size_t)left : BLOCK_ROWS;
        const uint64_t place = (block * store->columns + column) * PIECE;
        const int number = imki_read_at(store->file, place, store->block, rows * VALUE);
        if (number != 0)
            return imki_system_error(error, IMK_ERROR_READ, "", number > 0 ? number : EIO);
        status = imk_output_file_write(log->file, store->block, rows * VALUE);
        left -= rows;
    }
    return status;
}

static bool is_taken(const imki_column_store *store, size_t column, const char *taken)
{
    bool is = strcmp(store->name[column], taken) == 0;
    for (size_t i = 0; i < column; i++)
        is = is || strcmp(store->name[i], store->name[column]) == 0;
    return is;
}

void imki_column_names(imki_log_output *log, const char *taken)
{
    imki_column_store *store = log->state;
    for (size_t i = 0; i < store->columns; i++) {
        char *name = store->name[i];
        const char *from = log->column[i].name;
        const bool letter = (*from >= 'a' && *from <= 'z') || (*from >= 'A' && *from <= 'Z');
        snprintf(name, 56, "%s%s", letter ? "" : "x", from);
        for (char *c = name; *c; c++)
            if (!((*c >= 'a' && *c <= 'z') || (*c >= 'A' && *c <= 'Z') || (*c >= '0' && *c <= '9')))
                *c = '_';
        const size_t length = strlen(name);
        for (size_t number = 2; is_taken(store, i, taken); number++)
            snprintf(name + length, 8, "_%zu", number);
    }
}
