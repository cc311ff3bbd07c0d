/* SPDX-License-Identifier: Apache-2.0 */
/* Errors about a number. */
#ifndef IMUKI_ERROR_INTERNAL_H
#define IMUKI_ERROR_INTERNAL_H

#include "imukit/status.h"

/* The index of what is none of several. */
#define IMKI_NO_INDEX SIZE_MAX

/* imk_error_set(), with the number, the limit that it passes, and its place. @return the status */
imk_status imki_error_number(imk_error *error, imk_status status, const char *field, size_t index,
                             double value, double limit, const char *expected);

#endif
