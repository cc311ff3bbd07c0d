/* SPDX-License-Identifier: Apache-2.0 */
/* Find the value at a path in the data of a result. */
#include "result_internal.h"

#include <stdlib.h>
#include <string.h>

const char *imk_result_find(const imk_result *result, const char *path)
{
    const imki_data *at = result ? &result->root : NULL;
    while (at && *path) {
        const bool element = *path == '[';
        size_t index = element ? strtoul(path + 1, NULL, 10) : 0;
        const size_t length = element ? strcspn(path, "]") + 1 : strcspn(path, ".[");
        at = at->first; /* of a text there is none */
        while (at && (element ? index-- > 0
                              : !at->key || strncmp(at->key, path, length) != 0 || at->key[length]))
            at = at->next;
        path += length;
        path += *path == '.';
    }
    return at && at->kind == IMKI_DATA_TEXT ? at->value.text : NULL;
}
