/* SPDX-License-Identifier: Apache-2.0 */
/* Rows of a log that is a set of arrays, read in blocks: what the formats have in common once their
 * columns are known. */
#ifndef IMUKIT_ARRAY_ROWS_INTERNAL_H
#define IMUKIT_ARRAY_ROWS_INTERNAL_H

#include "array_list_internal.h"

/* Where the values of a cell are in the block at hand. */
typedef struct imki_array_cell {
    imki_value_type type;
    bool swapped;
    const imki_coding *coding; /* NULL: the numbers are the values; of values of 8 bytes only */
    const unsigned char *at;   /* of the first row of the block */
    size_t step;               /* bytes from row to row */
} imki_array_cell;

/* The first member of the state of a format. */
typedef struct imki_array_rows {
    imki_array_list list;
    imki_array_column column[IMK_LOG_COLUMNS_MAX];
    imki_array_cell cell[IMK_LOG_COLUMNS_MAX];
    uint64_t rows, next; /* of the log; the one that is given next */
    uint64_t begin;      /* row of the block's first */
    size_t at_hand;      /* rows of the block */
    int64_t origin;      /* of the times, where they are whole numbers */
    /* Have the block that begins at row `begin`: sets at_hand, 1 or more. */
    imk_status (*load)(imk_log_reader *reader, imk_error *error);
} imki_array_rows;

/* What the first rows say about the time. */
imk_status imki_array_rows_begin(imk_log_reader *reader, imk_error *error);
/* As imki_log_codec.read, .seek, .progress. */
imk_status imki_array_rows_read(imk_log_reader *reader, size_t max_rows, double *const *out,
                                size_t *rows, imk_error *error);
imk_status imki_array_rows_seek(imk_log_reader *reader, double fraction, imk_error *error);
void imki_array_rows_progress(const imk_log_reader *reader, uint64_t *done, uint64_t *size);

#endif
