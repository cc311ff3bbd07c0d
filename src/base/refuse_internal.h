/* SPDX-License-Identifier: Apache-2.0 */
/* Refusals that name a number. */
#ifndef IMUKIT_REFUSE_INTERNAL_H
#define IMUKIT_REFUSE_INTERNAL_H

#include "imukit/status.h"

#include <stddef.h>
#include <stdint.h>

/* imk_error_set() with the number found, the one it had to be or stay within, and of which element
 * of the field it is. */
static inline imk_status imki_refuse_at(imk_error *error, imk_status status, const char *field,
                                        size_t index, double value, double limit,
                                        const char *expected)
{
    imk_error_set(error, status, field, NULL, expected);
    if (error) {
        error->index = index < INT32_MAX ? (int)index : -1;
        error->value = value;
        error->limit = limit;
    }
    return status;
}

/* The same of a field that is one number. */
static inline imk_status imki_refuse(imk_error *error, imk_status status, const char *field,
                                     double value, double limit, const char *expected)
{
    return imki_refuse_at(error, status, field, SIZE_MAX, value, limit, expected);
}

#endif
