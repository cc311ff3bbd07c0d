/* SPDX-License-Identifier: Apache-2.0 */
/* Files that hold named arrays of numbers in groups: HDF5, MATLAB, .npz. Which arrays make a log,
 * what its columns are. */
#ifndef IMUKIT_ARRAY_LIST_INTERNAL_H
#define IMUKIT_ARRAY_LIST_INTERNAL_H

#include "io/log/log_reader_internal.h"

/* Types of numbers. */
typedef enum imki_value_type {
    IMKI_FLOAT64,
    IMKI_FLOAT32,
    IMKI_INT8,
    IMKI_UINT8,
    IMKI_INT16,
    IMKI_UINT16,
    IMKI_INT32,
    IMKI_UINT32,
    IMKI_INT64,
    IMKI_UINT64,
    IMKI_VALUE_TYPES
} imki_value_type;

enum {
    IMKI_ARRAYS_MAX = 1024, /* in a file */
    IMKI_ARRAY_DEPTH = 8,   /* groups within groups */
    IMKI_ARRAY_LABELS = 1024,
    IMKI_MISSING_MAX = 8 /* numbers that stand for no value */
};

/* How numbers stand for values: value = number * factor + offset, and some stand for none. */
typedef struct imki_coding {
    double factor, offset;
    uint64_t missing[IMKI_MISSING_MAX]; /* their bits, in the type of the array */
    uint64_t missing_count;
} imki_coding;

/* A vector or matrix. */
typedef struct imki_array {
    char group[96]; /* where it is: path of the group, name of the struct; "": at the top */
    char name[64];
    char unit[40];                  /* "": not stated */
    char labels[IMKI_ARRAY_LABELS]; /* names of the columns, one a line; "": none */
    imki_value_type type;
    bool swapped; /* the bytes are in the other order than this machine's */
    uint64_t extent[2];
    uint64_t place;   /* byte of the first value in its source */
    uint64_t step[2]; /* bytes from a value to the next along each dimension */
    size_t source;    /* of the format */
    bool coded;
    imki_coding coding;
    /* Set by imki_arrays_choose(): */
    uint64_t rows;
    size_t parts; /* columns */
    int along;    /* dimension of the rows */
} imki_array;

/* What is there and cannot be read as numbers, such as a MATLAB table; its name with its group. */
typedef struct imki_array_other {
    char name[96], kind[64];
} imki_array_other;

/* All arrays of a file. */
typedef struct imki_array_list {
    imki_array *array;
    size_t count, room;
    imki_array_other other[64];
    size_t other_count;
    char separator; /* between the names of groups */
} imki_array_list;

/* A column: part `part` of an array. */
typedef struct imki_array_column {
    size_t array, part;
} imki_array_column;

/* Add an array, whose name may have its unit behind it in brackets.
 * @return IMK_ERROR_MEMORY, IMK_ERROR_UNSUPPORTED (more than IMKI_ARRAYS_MAX) */
imk_status imki_array_add(imki_array_list *list, const imki_array *array, imk_error *error);
void imki_array_note(imki_array_list *list, const char *name, const char *kind);
/* Is the name, without a group, that of a gyro or an accelerometer? */
bool imki_array_is_sensor(const char *name);
/* State the unit of an array by its name, if it has none. */
void imki_array_unit(imki_array_list *list, const char *group, const char *name, const char *unit);
void imki_array_list_free(imki_array_list *list);

/* Bytes of a value. */
size_t imki_value_size(imki_value_type type);

/* Find the sensors among the arrays, choose the one that the settings ask for, and make the layout
 * of the reader of it.
 * @param column  receives what each of the layout's cells is
 * @param rows    how many each has
 * @return as imki_log_stream_choose() and imki_log_layout_make() */
imk_status imki_arrays_choose(imk_log_reader *reader, imki_array_list *list,
                              imki_array_column column[IMK_LOG_COLUMNS_MAX], uint64_t *rows,
                              imk_error *error);

#endif
