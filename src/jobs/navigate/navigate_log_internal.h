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
/* The same of a start whose attitude is given. */
void imki_navigate_check_given(imk_navigate_log *n);
/* Mean reading of a sensor, 0 gyro or 1 accelerometer, over `rows` rows. */
imk_vector3 imki_navigate_mean(const imk_navigate_log *n, int sensor, size_t first, size_t rows);
/* 1 sigma of the mean rate over the first rows of a unit that sways. */
double imki_navigate_sway(const imk_navigate_log *n, size_t rows);
/* 1 sigma of a sensor's bias as the model has it, worst axis; 0: no model. */
double imki_navigate_bias_size(const imk_navigate_log *n, int sensor);
/* The first column of a quantity. */
const imk_log_column *imki_navigate_first_column(const imk_navigate_log *n, imk_quantity quantity);
/* The unit, unlike its own, in which the numbers of a column would be gravity, or the Earth's
 * rotation, within a tolerance; NULL: none. @param ratio  to that, in its own unit */
const char *imki_navigate_likely_unit(const imk_log_column *column, double ratio, double tolerance);
/* The texts of a finding with the unit of a column and the one it is likely to be, if any. */
void imki_navigate_unit_names(const imk_log_column *column, const char *likely, char text[96]);
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
