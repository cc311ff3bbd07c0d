/* SPDX-License-Identifier: Apache-2.0 */
/* The elements of a MAT-file of version 5 [MAT5]. */
#ifndef IMUKIT_MAT_ELEMENTS_INTERNAL_H
#define IMUKIT_MAT_ELEMENTS_INTERNAL_H

#include "array_strips_internal.h"

enum { IMKI_MAT_HEAD = 128 }; /* bytes before the first element */

/* Types of data. */
enum {
    IMKI_MAT_INT8 = 1,
    IMKI_MAT_UINT8 = 2,
    IMKI_MAT_INT16 = 3,
    IMKI_MAT_UINT16 = 4,
    IMKI_MAT_INT32 = 5,
    IMKI_MAT_UINT32 = 6,
    IMKI_MAT_SINGLE = 7,
    IMKI_MAT_DOUBLE = 9,
    IMKI_MAT_INT64 = 12,
    IMKI_MAT_UINT64 = 13,
    IMKI_MAT_MATRIX = 14,
    IMKI_MAT_COMPRESSED = 15,
    IMKI_MAT_UTF8 = 16,
    IMKI_MAT_UTF16 = 17
};

/* Classes of arrays. */
enum {
    IMKI_MAT_CELL = 1,
    IMKI_MAT_STRUCT = 2,
    IMKI_MAT_OBJECT = 3,
    IMKI_MAT_CHAR = 4,
    IMKI_MAT_SPARSE = 5,
    IMKI_MAT_DOUBLE_CLASS = 6,
    IMKI_MAT_UINT64_CLASS = 15,
    IMKI_MAT_FUNCTION = 16,
    IMKI_MAT_OPAQUE = 17
};

/* The bytes that elements are read from: the file, or an element that is inflated. */
typedef struct imki_mat_bytes {
    imki_unpacking part;
    bool swapped; /* the bytes are in the other order than this machine's */
} imki_mat_bytes;

/* A tag. The places are in the bytes. */
typedef struct imki_mat_tag {
    uint32_t type;
    uint64_t size; /* bytes of data */
    uint64_t data, next;
    bool is_short; /* the data are in the tag itself */
    unsigned char head[8];
} imki_mat_tag;

/* What stands before the content of an array. */
typedef struct imki_mat_head {
    uint32_t array_class;
    bool complex;
    size_t dimensions;
    uint64_t extent[2];
    char name[64];
    char type_name[64]; /* of an opaque one: "table" */
    uint64_t content;   /* place of what follows */
} imki_mat_head;

/* A number of 4 bytes. */
uint32_t imki_mat_number(const unsigned char *at, bool swapped);

/* Read a tag. @param end  of what the element is in
 * @return IMK_ERROR_FORMAT (damaged, or its data go beyond the end), IMK_ERROR_READ */
imk_status imki_mat_tag_read(imki_mat_bytes *bytes, uint64_t at, uint64_t end, imki_mat_tag *tag,
                             imk_error *error);
/* The first `size` bytes of the data, all of which are there. */
imk_status imki_mat_data(imki_mat_bytes *bytes, const imki_mat_tag *tag, void *data, size_t size,
                         imk_error *error);
/* The head of an array whose data begin at `at`. */
imk_status imki_mat_head_read(imki_mat_bytes *bytes, uint64_t at, uint64_t end, imki_mat_head *head,
                              imk_error *error);

/* List the arrays of the open file in the state of the reader (imki_array_strips), those of
 * structures too, with the units that texts in a structure `units` state.
 * @return IMK_ERROR_FORMAT (damaged or cut short), _READ, _MEMORY, _UNSUPPORTED (too many) */
imk_status imki_mat_list(imk_log_reader *reader, bool swapped, imk_error *error);

#endif
