/* SPDX-License-Identifier: Apache-2.0 */
/* Columns of arrays that lie in a file, read side by side: each strip is bytes in which row follows
 * row, a vector or several columns interleaved, and is read at a place of its own. */
#ifndef IMUKIT_ARRAY_STRIPS_INTERNAL_H
#define IMUKIT_ARRAY_STRIPS_INTERNAL_H

#include "array_rows_internal.h"
#include "packed_part_internal.h"

typedef struct imki_strip {
    size_t source;
    uint64_t begin; /* byte of the first row */
    size_t record;  /* bytes from row to row, all of which are read */
    imki_unpacking part;
    unsigned char *buffer;
} imki_strip;

/* The state of a format whose arrays lie in parts of a file. */
typedef struct imki_array_strips {
    imki_array_rows rows; /* first */
    imki_packed *source;  /* that of imki_array.source; from malloc() */
    char **source_name;   /* NULL, or a name for each; both from malloc() */
    size_t source_count, source_room;
    imki_strip strip[IMK_LOG_COLUMNS_MAX];
    size_t strip_count;
    size_t cell_strip[IMK_LOG_COLUMNS_MAX];  /* the strip of a cell */
    size_t cell_offset[IMK_LOG_COLUMNS_MAX]; /* and where in its record */
    int unpacked;                            /* file with unpacked bytes; -1: none */
    bool packed; /* a strip is inflated as it is read: there is no way back */
} imki_array_strips;

/* Make the state of the reader. @return IMK_ERROR_MEMORY */
imk_status imki_array_strips_make(imk_log_reader *reader, char separator, imk_error *error);
/* Add a source. @param name  for messages; may be NULL */
imk_status imki_array_source_add(imki_array_strips *state, const imki_packed *source,
                                 const char *name, imk_error *error);
/* All arrays are listed: choose, make the layout, begin. */
imk_status imki_array_strips_begin(imk_log_reader *reader, imk_error *error);
/* As imki_log_codec.seek and .close. */
imk_status imki_array_strips_seek(imk_log_reader *reader, double fraction, imk_error *error);
void imki_array_strips_close(imk_log_reader *reader);

#endif
