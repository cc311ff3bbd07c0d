/* SPDX-License-Identifier: Apache-2.0 */
/* The ending of a name. */
#include "imukit/names.h"

#include <string.h>

bool imk_has_ending(const char *name, const char *ending)
{
    const size_t length = name ? strlen(name) : 0, size = strlen(ending);
    return name && length >= size && memcmp(name + length - size, ending, size) == 0;
}
