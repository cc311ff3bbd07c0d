/* SPDX-License-Identifier: Apache-2.0 */
/* The stamps of the first place: where they are no sample times (coarse, bunched, late), the rate
 * and the gaps are those that the analyses read from them. */
#include "info_log_internal.h"

#include "jobs/arena_internal.h"
#include "jobs/record/record_times_internal.h"

#include <math.h>

enum { STAMPS_MOST = 1 << 20 };

void imki_info_stamps_add(imki_info_stamps *s, size_t rows, double *const *column)
{
    if (s->failed || s->stamps.rows >= STAMPS_MOST)
        return;
    s->failed = !imki_stamps_add(&s->stamps, rows, column);
}

/* Gaps of the times that became even. */
static imk_log_findings gaps_of(const imki_stamps *stamps, double interval,
                                imki_record_times *times)
{
    *times = (imki_record_times){.pending = 0};
    imki_record_times_start(times, interval);
    imki_record_times_add(times, 1, stamps->rows, stamps->time);
    return imki_record_times_findings(times);
}

void imki_info_stamps_settle(imki_info_stamps *s, imk_info_log *info, const imk_log_findings *found)
{
    imk_log_findings settled = *found;
    imk_error error;
    if (s->failed || s->stamps.rows < 2)
        return;
    if (!imki_stamps_uneven(0, found)) {
        imki_tell_steps(found, &info->findings);
        return;
    }
    imki_record_times *times = imki_resize(&info->allocator, NULL, sizeof *times);
    if (!times)
        return;
    const size_t before = info->findings.count;
    s->settled = true;
    if (imki_stamps_settle(&s->stamps, 0, &settled, &info->findings, &error) == IMK_OK) {
        const imk_log_findings even = gaps_of(&s->stamps, settled.interval, times);
        s->interval = settled.interval;
        info->gaps = even.gaps;
        info->missing = even.missing;
    } else {
        info->times_refused = true;
        for (size_t k = before; k < info->findings.count; k++)
            info->findings.item[k].level = IMK_FINDING_WARNING;
    }
    imki_resize(&info->allocator, times, 0);
}
