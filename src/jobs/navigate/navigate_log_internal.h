/* SPDX-License-Identifier: Apache-2.0 */
/* The steps of navigation by a record. Why one fails is a finding, or the error. */
#ifndef IMUKI_NAVIGATE_LOG_INTERNAL_H
#define IMUKI_NAVIGATE_LOG_INTERNAL_H

#include "imukit/navigate_log.h"
#include "imukit/navigation_smoother.h"

#include "jobs/arena_internal.h"
#include "jobs/job_internal.h"

/* Angle (sensor 0) or velocity (1) over one sample. */
static inline imk_vector3 imki_navigate_increment(const imk_navigate_log *n, int sensor, size_t row)
{
    imk_vector3 out;
    for (int i = 0; i < 3; i++)
        out.v[i] = n->reading[3 * sensor + i][row] * n->record.dt;
    return out;
}

/* Is the attitude found by the unit itself? */
static inline bool imki_navigate_aligns(const imk_navigate_log *n)
{
    return n->settings.align > 0;
}

/* What the columns are, and where navigation begins. */
imk_status imki_navigate_channels(imk_navigate_log *n, imk_error *error);
/* Is this gravity, is that the Earth's rotation? */
imk_status imki_navigate_check(imk_navigate_log *n, imk_error *error);
/* The attitude at the start. */
imk_status imki_navigate_align(imk_navigate_log *n, imki_arena *scratch, imk_error *error);
/* Through the record, into the track, which is the allocator's of the record. */
imk_status imki_navigate_follow(imk_navigate_log *n, const imk_job *job, imki_arena *scratch,
                                imk_error *error);

/* The columns of a row of the track but for time and acceleration; notes the largest distance. */
void imki_navigate_track_row(imk_navigate_log *n, const imk_navigation_filter_estimate *estimate,
                             double row[IMK_TRACK_COLUMNS]);

/* Smoothing: begin to record, record a row of the track (a smoother of NULL does nothing), and put
 * the smoothed rows into the track. */
imk_status imki_navigate_record(imk_navigation_filter *filter, imki_arena *scratch,
                                imk_navigation_smoother **smoother, imk_error *error);
imk_status imki_navigate_mark(imk_navigation_smoother *smoother, imk_error *error);
imk_status imki_navigate_smooth(imk_navigate_log *n, imk_navigation_smoother *smoother,
                                imk_error *error);

#endif
