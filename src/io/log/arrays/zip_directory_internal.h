/* SPDX-License-Identifier: Apache-2.0 */
/* The members of a zip file [ZIP]. */
#ifndef IMUKIT_ZIP_DIRECTORY_INTERNAL_H
#define IMUKIT_ZIP_DIRECTORY_INTERNAL_H

#include "imukit/status.h"

#include <stdbool.h>

typedef struct imki_zip_member {
    char name[192];
    uint16_t method; /* 0: stored; 8: deflated */
    bool encrypted;
    uint32_t crc;
    uint64_t packed, unpacked; /* bytes */
    uint64_t begin;            /* byte of the file at which its data begins */
} imki_zip_member;

/* Called for each member in the order of the directory; other than IMK_OK ends. */
typedef imk_status (*imki_zip_visit)(void *context, const imki_zip_member *member,
                                     imk_error *error);

/* Go through the directory of an open file. Members lie within the file, before the directory.
 * @return IMK_ERROR_FORMAT (damaged or cut short), IMK_ERROR_READ, IMK_ERROR_MEMORY */
imk_status imki_zip_members(int file, imki_zip_visit visit, void *context, imk_error *error);

#endif
