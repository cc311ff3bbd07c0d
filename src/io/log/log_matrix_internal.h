/* SPDX-License-Identifier: Apache-2.0 */
/* Rows of a matrix of float64 or float32, little-endian, and the file of names beside it: what
 * formats that differ in their heads have in common. */
#ifndef IMUKIT_LOG_MATRIX_INTERNAL_H
#define IMUKIT_LOG_MATRIX_INTERNAL_H

#include "log_formats_internal.h"

/* The state of a reader. */
typedef struct imki_matrix {
    size_t value_size;
    uint64_t begin, rows; /* byte of the first row; their number */
    uint64_t rows_left;
} imki_matrix;

/* Open the rows, at which the text stands: names, layout, first times.
 * @param columns     0: as many as there are names
 * @param value_size  8 (float64) or 4 (float32)
 * @return IMK_ERROR_COLUMN (not as many names as columns), or what the names are refused for */
imk_status imki_log_matrix_open(imk_log_reader *reader, uint64_t columns, uint64_t rows,
                                size_t value_size, imk_error *error);

/* As imki_log_codec.seek, .read, and .create: the file of names. Rows are those of
 * imki_log_format_matrix(). */
imk_status imki_log_matrix_seek(imk_log_reader *reader, double fraction, imk_error *error);
imk_status imki_log_matrix_read(imk_log_reader *reader, size_t max_rows, double *const *out,
                                size_t *rows, imk_error *error);
imk_status imki_log_matrix_create(imki_log_output *log, const char *path, imk_error *error);

#endif
