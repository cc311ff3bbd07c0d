/* SPDX-License-Identifier: Apache-2.0 */
/* The steps of navigation by a record. Why one fails is a finding, or the error. */
#ifndef IMUKI_NAVIGATE_LOG_INTERNAL_H
#define IMUKI_NAVIGATE_LOG_INTERNAL_H

#include "imukit/navigate_log.h"

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
/* After an alignment: do the biases of the gyros hide north? The sigma of the heading is made what
 * it is then. */
void imki_navigate_find_north(imk_navigate_log *n);
/* Without a model, how far the readings let the heading be doubted. */
void imki_navigate_doubt_heading(imk_navigate_log *n);
/* Is the heading that which the gyros found? */
bool imki_navigate_north(const imk_navigate_log *n);
/* Of the filter's settings: biases that the readings alone say. */
void imki_navigate_free_biases(const imk_navigate_log *n, imk_navigation_filter_settings *settings);
/* The biases of the gyros of a filter that has just started, from the alignment. */
void imki_navigate_start_biases(imk_navigate_log *n, imk_navigation_filter *filter);
/* Through the record, into the track, which is the allocator's of the record. */
imk_status imki_navigate_follow(imk_navigate_log *n, const imk_job *job, imki_arena *scratch,
                                imk_error *error);

#endif
