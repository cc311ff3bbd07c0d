/* SPDX-License-Identifier: Apache-2.0 */
/* The head of a .npy file: magic, version, and a Python dictionary that gives type and shape
 * [NPY]. */
#ifndef IMUKIT_NPY_INTERNAL_H
#define IMUKIT_NPY_INTERNAL_H

#include "imukit/status.h"

#include <stdbool.h>

/* What a header says. */
typedef struct imki_npy_array {
    char type[16]; /* as numpy writes it, "<f8"; "": records of several fields */
    bool fortran_order;
    uint64_t shape[2]; /* the first two dimensions */
    size_t dimensions;
    size_t header_size; /* bytes before the first value */
} imki_npy_array;

/* A matrix of samples by columns. */
typedef struct imki_npy {
    uint64_t rows, columns; /* of a one-dimensional array, columns = 1 */
    size_t value_size;      /* 8 (float64) or 4 (float32), little-endian */
    size_t header_size;     /* bytes before the first value */
} imki_npy;

enum {
    IMKI_NPY_PREFIX = 12,      /* bytes imki_npy_header_size() looks at */
    IMKI_NPY_HEADER_SIZE = 128 /* of the headers we write, whatever the shape */
};

/* Size of the whole header, from its first IMKI_NPY_PREFIX bytes; 0 when they do not begin a .npy
 * file of version 1, 2 or 3. */
size_t imki_npy_header_size(const char *prefix);

/* Read a header.
 * @param size  bytes at hand, at least imki_npy_header_size()
 * @return IMK_ERROR_FORMAT (damaged) */
imk_status imki_npy_array_read(const char *header, size_t size, imki_npy_array *array,
                               imk_error *error);
/* The same, for a matrix of floating-point numbers in C order.
 * @param size  bytes at hand, at least imki_npy_header_size()
 * @return IMK_ERROR_FORMAT (damaged), IMK_ERROR_UNSUPPORTED (another type, order or number of
 *         dimensions; the error says what to do) */
imk_status imki_npy_header_read(const char *header, size_t size, imki_npy *npy, imk_error *error);

/* Write the header of a little-endian float64 matrix in C order. */
void imki_npy_header_write(uint64_t rows, uint64_t columns, char header[IMKI_NPY_HEADER_SIZE]);
/* The same of a list of one dimension. @param type  "<f8", "<U12" */
void imki_npy_list_header_write(const char *type, uint64_t count,
                                char header[IMKI_NPY_HEADER_SIZE]);

#endif
