/* SPDX-License-Identifier: Apache-2.0 */
/* Rows turned into columns, for formats in which the whole of a column stands before the next: in a
 * temporary file, whatever the length of the log. */
#ifndef IMUKIT_COLUMN_STORE_INTERNAL_H
#define IMUKIT_COLUMN_STORE_INTERNAL_H

#include "io/log/log_formats_internal.h"

/* The state of a writer. */
typedef struct imki_column_store {
    int file;
    size_t columns, filled; /* rows in the block */
    uint64_t rows;
    unsigned char *block;               /* column after column */
    uint32_t crc[IMK_LOG_COLUMNS_MAX];  /* CRC-32 of the bytes of each column */
    char name[IMK_LOG_COLUMNS_MAX][64]; /* as the format can have it, all different */
    imk_error failure;
} imki_column_store;

/* As imki_log_codec.create, .write, .discard; rows are those of imki_log_format_matrix().
 * @return IMK_ERROR_UNSUPPORTED (a name in .gz or .zst), IMK_ERROR_WRITE (no temporary file) */
imk_status imki_column_store_create(imki_log_output *log, const char *path, imk_error *error);
imk_status imki_column_store_write(imki_log_output *log, const char *bytes, size_t size,
                                   size_t rows);
void imki_column_store_discard(imki_log_output *log);

/* All rows were written: what failed before, if anything. */
imk_status imki_column_store_end(imki_log_output *log, imk_error *error);
/* Put a whole column into the file of the log. @return IMK_ERROR_READ, IMK_ERROR_WRITE */
imk_status imki_column_store_put(imki_log_output *log, size_t column, imk_error *error);

/* Names as variables: letters, digits and "_", a letter first, up to 63 bytes, all different, none
 * `taken`. */
void imki_column_names(imki_log_output *log, const char *taken);

#endif
