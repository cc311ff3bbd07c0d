/* SPDX-License-Identifier: Apache-2.0 */
/* Concerns: what may hold on some channels of a record, and what it means. */
#ifndef IMUKI_VERDICT_CONCERN_INTERNAL_H
#define IMUKI_VERDICT_CONCERN_INTERNAL_H

#include "identify_show_internal.h"

typedef struct imki_concern {
    unsigned bit; /* IMK_VERDICT_…, which must hold; 0: any */
    /* Does it hold on a channel? The details are added to an empty text. NULL: there is no more to
     * it. */
    bool (*find)(const imk_identify_log *log, size_t channel, imki_text *detail);
    unsigned screen; /* IMK_SCREEN_… bit by which it is taken out; 0: nothing is */
    imk_finding_level level;
    const char *code, *text, *kept; /* kept: when it was not taken out */
} imki_concern;

/* One message, unless it holds on no channel: the channels, each with its details in parentheses.
 */
void imki_assess_concern(imk_verdict *v, const imk_identify_log *log, const imki_concern *about);
/* The unit for a value of a channel in its details. */
imk_unit imki_concern_unit(const imk_identify_log *log, size_t channel, double value);

#endif
