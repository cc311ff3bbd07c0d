/* SPDX-License-Identifier: Apache-2.0 */
/* What the child that reads a file says, and what it is asked. The child may have been taken over
 * by a damaged file, so nothing that it says is believed. */
#ifndef IMUKIT_CHILD_MESSAGES_INTERNAL_H
#define IMUKIT_CHILD_MESSAGES_INTERNAL_H

#include "array_list_internal.h"

/* Each message begins with its kind and the number of bytes that follow. */
typedef struct imki_message {
    uint32_t kind, size;
} imki_message;

enum {
    IMKI_MESSAGE_ARRAY = 1, /* an imki_array_message */
    IMKI_MESSAGE_UNIT,      /* an imki_array_message, of a unit */
    IMKI_MESSAGE_OTHER,     /* an imki_array_other */
    IMKI_MESSAGE_LISTED,    /* that was all */
    IMKI_MESSAGE_ROWS,      /* values of 8 bytes, column after column */
    IMKI_MESSAGE_FAILED,    /* an imki_array_other: what was found, what to do; "": no memory */
    IMKI_MESSAGE_CODING     /* an imki_coding, of the array before */
};

typedef struct imki_array_message {
    char group[96], name[64], unit[40], labels[IMKI_ARRAY_LABELS];
    uint32_t type; /* IMKI_FLOAT64, IMKI_INT64 or IMKI_UINT64 */
    uint64_t extent[2];
} imki_array_message;

/* The rows that are asked for; 4 bytes of number and 8 for each column come before the first. */
typedef struct imki_rows_request {
    uint64_t first;
    uint32_t count;
} imki_rows_request;

/* Receive the list of arrays.
 * @return false: what came is no such list, or the child is gone; IMK_ERROR_FORMAT and others in
 *         *status when it says so itself */
bool imki_child_list(int socket, imki_array_list *list, imk_status *status, imk_error *error);
/* Receive rows. @param size  bytes of all of them */
bool imki_child_rows(int socket, unsigned char *values, size_t size, imk_status *status,
                     imk_error *error);

#endif
