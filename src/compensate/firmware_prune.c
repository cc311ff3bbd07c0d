/* SPDX-License-Identifier: Apache-2.0 */
/* Operations that no output needs are taken out of a plan: what a step prepared for terms that turn
 * out not to be there. */
#include "firmware_internal.h"

#include <string.h>

static void mark(const imk_firmware *f, bool *needed)
{
    memset(needed, 0, IMK_FIRMWARE_OPERATIONS_MAX * sizeof *needed);
    for (int sensor = 0; sensor < 2; sensor++)
        for (int j = 0; j < f->output_count[sensor]; j++)
            needed[f->output[sensor][j]] = true;
    for (int n = f->operation_count - 1; n >= 0; n--) {
        const imk_firmware_operation *o = &f->operation[n];
        if (!needed[n])
            continue;
        if (o->a >= 0)
            needed[o->a] = true;
        if (o->b >= 0)
            needed[o->b] = true;
        for (int k = o->first; k < o->first + o->count; k++)
            needed[f->term[k].operand] = true;
    }
}

void imki_firmware_prune(imk_firmware *f)
{
    bool needed[IMK_FIRMWARE_OPERATIONS_MAX];
    int place[IMK_FIRMWARE_OPERATIONS_MAX], operations = 0, terms = 0;
    mark(f, needed);
    for (int n = 0; n < f->operation_count; n++) {
        imk_firmware_operation o = f->operation[n];
        if (!needed[n])
            continue;
        /* Terms move to the front, behind those that are kept: never over others still to come. */
        for (int k = 0; k < o.count; k++) {
            imk_firmware_term term = f->term[o.first + k];
            term.operand = place[term.operand];
            f->term[terms + k] = term;
        }
        o.first = o.count > 0 ? terms : 0;
        o.a = o.a >= 0 ? place[o.a] : -1;
        o.b = o.b >= 0 ? place[o.b] : -1;
        terms += o.count;
        place[n] = operations;
        f->operation[operations++] = o;
    }
    for (int sensor = 0; sensor < 2; sensor++)
        for (int j = 0; j < f->output_count[sensor]; j++)
            f->output[sensor][j] = place[f->output[sensor][j]];
    f->operation_count = operations;
    f->term_count = terms;
}
