/* SPDX-License-Identifier: Apache-2.0 */
/* The intervals of a model's evidence. */
#include "model_internal.h"

#include <string.h>

imk_interval *imki_evidence_interval(imk_evidence *evidence, const char *key, int instance)
{
    for (int i = 0; i < evidence->interval_count; i++)
        if (evidence->interval[i].instance == instance &&
            strcmp(evidence->interval[i].key, key) == 0)
            return &evidence->interval[i];
    if (evidence->interval_count == IMK_INTERVALS_MAX)
        return NULL;
    imk_interval *added = &evidence->interval[evidence->interval_count++];
    memset(added, 0, sizeof *added);
    strncpy(added->key, key, sizeof added->key - 1);
    added->instance = instance;
    return added;
}
