/* SPDX-License-Identifier: Apache-2.0 */
/* What the child that reads an HDF5 file does with libhdf5. None of this runs in the program
 * itself.
 */
#ifndef IMUKIT_HDF5_READER_INTERNAL_H
#define IMUKIT_HDF5_READER_INTERNAL_H

#include "child_messages_internal.h"

#include <hdf5.h>

enum { IMKI_HDF5_PATH = 512 };

/* Where an array is in the file. */
typedef struct imki_hdf5_array {
    char path[IMKI_HDF5_PATH]; /* of the dataset */
    int member;                /* of records; -1: the values of the dataset */
    int rank;                  /* dimensions of the dataset */
    bool flipped;              /* MATLAB's dimensions are in the other order */
    imki_value_type type;
    uint64_t extent[2]; /* as in the message */
} imki_hdf5_array;

/* Send one; the parent counts them in the same order. */
typedef struct imki_hdf5_list {
    hid_t file;
    int socket;
    imki_hdf5_array *array; /* of IMKI_ARRAYS_MAX */
    size_t count;
} imki_hdf5_list;

/* An imki_child_work: list the arrays, then give the rows that are asked for. */
void imki_hdf5_serve(int file, int socket);

/* List the arrays of the open file. @return false: the parent is gone, or there are too many */
bool imki_hdf5_list_all(imki_hdf5_list *list);
/* Answer requests until the parent hangs up. */
void imki_hdf5_give_rows(const imki_hdf5_list *list);
/* Say why it does not go on. @param found  "": memory is exhausted */
void imki_hdf5_fail(int socket, const char *found, const char *expected);

/* Texts of an attribute, one a line. @return how many; 0: there is none, or it holds none */
size_t imki_hdf5_texts(hid_t object, const char *const *names, size_t size, char *texts);
/* Type of an array of such numbers. @return false: no numbers */
bool imki_hdf5_type(hid_t type, imki_value_type *found);
/* Their type in memory. */
hid_t imki_hdf5_memory_type(imki_value_type type);
/* How the numbers of a dataset are coded. @return false: not at all, or the obstacle says which
 * attribute cannot be read ("": none) */
bool imki_hdf5_coding(hid_t dataset, const imki_hdf5_array *array, imki_coding *coding, size_t size,
                      char *obstacle);
/* What stands in the way of reading the values of a dataset, and what to do; NULL: nothing. */
const char *imki_hdf5_obstacle(hid_t dataset, uint64_t values, uint64_t file_size);

#endif
