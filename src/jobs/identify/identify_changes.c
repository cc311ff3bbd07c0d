/* SPDX-License-Identifier: Apache-2.0 */
/* Noise over time of a channel: its map is kept with the result, and tested for changes; all
 * channels together raise a false alarm in a thousandth of sound records. */
#include "identify_log_internal.h"

#include "jobs/arena_internal.h"

#include <string.h>

static size_t present_of(const imk_identify_log *log, size_t channel)
{
    return log->record.rows - log->result[channel].missing;
}

imk_status imki_identify_changes(imk_identify_log *log, size_t channel, const imk_noise_map *map,
                                 const imk_allocator *allocator, imk_error *error)
{
    imk_noise_map *kept = imki_resize(allocator, NULL, sizeof *kept);
    if (!kept)
        return imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
    log->map[channel] = kept;
    if (map) {
        memcpy(kept, map, sizeof *kept);
    } else {
        imk_noise_map_begin(kept);
        imk_noise_map_add(kept, log->record.rows, imk_even_record_data(&log->record, channel));
        imk_noise_map_end(kept);
    }
    imk_noise_changes_settings settings = imk_noise_changes_default();
    settings.dt = log->record.dt;
    settings.confidence = log->settings.confidence;
    settings.significance /= (double)log->record.count;
    const imk_status status = imk_noise_changes_find(&settings, kept, &log->result[channel],
                                                     &log->changes[channel], error);
    if (status == IMK_OK)
        imk_noise_changes_widen(&log->changes[channel], present_of(log, channel),
                                &log->result[channel]);
    return status;
}
