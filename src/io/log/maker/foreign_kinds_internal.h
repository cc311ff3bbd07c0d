/* SPDX-License-Identifier: Apache-2.0 */
/* Files that are no logs of a format that is read, but that are known by how they begin. */
#ifndef IMUKIT_FOREIGN_KINDS_INTERNAL_H
#define IMUKIT_FOREIGN_KINDS_INTERNAL_H

#include "imukit/status.h"

#include <stddef.h>

/* @return IMK_OK, or IMK_ERROR_UNSUPPORTED with what the file is and how to export it */
imk_status imki_foreign_kind_refuse(const char *begin, size_t size, imk_error *error);
/* Refuse what is compressed in a way that is not read, before its bytes are taken for anything. */
imk_status imki_foreign_packing_refuse(const char *begin, size_t size, imk_error *error);

#endif
