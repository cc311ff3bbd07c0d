/* SPDX-License-Identifier: Apache-2.0 */
#include "verdict_concern_internal.h"

#include <stdlib.h>

imk_unit imki_concern_unit(const imk_identify_log *log, size_t channel, double value)
{
    return imk_channel_readable_unit(imk_even_record_column(&log->record, channel), value);
}

void imki_assess_concern(imk_verdict *v, const imk_identify_log *log, const imki_concern *about)
{
    imki_text list = {.bytes = NULL};
    uint64_t channels = 0;
    for (size_t c = 0; c < log->record.count; c++) {
        imki_text detail = {.bytes = NULL};
        imki_text_put(&detail, "");
        if ((log->result[c].verdict & about->bit) == about->bit &&
            (!about->find || about->find(log, c, &detail))) {
            imki_text_add(&list, "%s%s", list.size > 0 ? ", " : "",
                          imk_even_record_column(&log->record, c)->name);
            channels |= (uint64_t)1 << c;
            if (detail.size > 0)
                imki_text_add(&list, " (%s)", detail.bytes);
        }
        list.failed = list.failed || detail.failed;
        free(detail.bytes);
    }
    const bool kept = about->screen && !(log->settings.take_out & about->screen);
    if (list.size > 0)
        imki_text_add(&list, ": %s.", kept ? about->kept : about->text);
    imki_verdict_list(v, about->level, about->code, "", &list, "");
    if (channels)
        imki_verdict_about(v, &log->record, channels);
}
