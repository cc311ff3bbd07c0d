/* SPDX-License-Identifier: Apache-2.0 */
/* Rests that were not taken, in words. */
#include "calibrate_show_internal.h"

#include <stdio.h>
#include <stdlib.h>

static double time_at(const imk_test_record *record, size_t sample)
{
    const size_t last = record->count - 1;
    return record->time ? record->time[sample < last ? sample : last] - record->time[0]
                        : (double)sample * record->dt;
}

static void add_one(const imk_calibrate_record *log, const imk_static_lost *lost, imki_text *to)
{
    const double degrees = 57.29577951308232;
    imki_text_add(to, "%s%.4g s to %.4g s (", to->size > 0 ? "; " : "",
                  time_at(&log->record, lost->begin), time_at(&log->record, lost->end));
    switch (lost->reason) {
    case IMK_LOST_NOISY:
        imki_text_add(to, "the noise of %s_%c is %.2g times that of the rests)",
                      imki_sensor_keys[lost->sensor],
                      imk_axis_letter(log->body_axis[lost->sensor][lost->axis]), lost->value);
        break;
    case IMK_LOST_SLIDES:
        imki_text_add(to, "the unit tilts by more than %.2g deg meanwhile)", lost->value * degrees);
        break;
    case IMK_LOST_SHORT:
        imki_text_put(to, "too short)");
        break;
    default:
        imki_text_put(to, "the gyros read another rate than in the rests)");
    }
}

void imki_lost_text(const imk_calibrate_record *log, char *text, size_t size)
{
    enum { LISTED = 4 };
    imki_text list = {0};
    for (size_t k = 0; k < log->lost_count && k < LISTED; k++)
        add_one(log, &log->lost[k], &list);
    if (log->lost_count > LISTED)
        imki_text_add(&list, "; and %zu more", log->lost_count - LISTED);
    snprintf(text, size, "%s", list.bytes ? list.bytes : "");
    free(list.bytes);
}
