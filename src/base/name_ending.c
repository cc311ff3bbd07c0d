/* SPDX-License-Identifier: Apache-2.0 */
/* The ending of a name. */
#include "imukit/names.h"

#include <string.h>

bool imk_has_ending(const char *name, const char *ending)
{
    const size_t length = name ? strlen(name) : 0, size = strlen(ending);
    return name && length >= size && memcmp(name + length - size, ending, size) == 0;
}

bool imk_is_script_name(const char *path)
{
    return imk_has_ending(path, ".yaml") || imk_has_ending(path, ".yml") ||
           imk_has_ending(path, ".json");
}
