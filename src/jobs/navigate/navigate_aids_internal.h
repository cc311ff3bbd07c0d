/* SPDX-License-Identifier: Apache-2.0 */
/* Readings of aids on the clock of a log, and their way into the filter. */
#ifndef IMUKI_NAVIGATE_AIDS_INTERNAL_H
#define IMUKI_NAVIGATE_AIDS_INTERNAL_H

#include "navigate_log_internal.h"

/* The readings of one aid in order of time, on the clock of the log. */
typedef struct imki_aid_series {
    size_t count, next;
    imk_aid_reading *reading;
    /* Of positions refused, horizontally, weighted by the predicted sigmas: innovation by velocity,
     * velocity by itself, innovation by itself. A reading that is d late is d v behind. */
    double along, along_square, square;
} imki_aid_series;

typedef struct imki_navigate_aids {
    imki_aid_series series[IMK_AID_KIND_COUNT]; /* of n->aid[] */
} imki_navigate_aids;

/* Read the aids of the settings into n->aid[] and their series, which are the arena's.
 * @return with a finding that says why */
imk_status imki_aids_load(imk_navigate_log *n, const imk_job *job, imki_arena *scratch,
                          imki_navigate_aids *aids, imk_error *error);

/* Time of a row of the log, and of the filter's clock from one of the log [s]. */
static inline double imki_navigate_row_time(const imk_navigate_log *n, size_t row)
{
    return n->first_time + n->record.dt * (double)row;
}

static inline double imki_navigate_filter_time(const imk_navigate_log *n, double time)
{
    return time - n->first_time + n->record.dt;
}

/* A finding about an aid: its name, and that of the record, which is {other} in the message. */
void imki_aid_find(imk_navigate_log *n, imk_finding_level level, const char *code, const char *name,
                   size_t count, const double *numbers);

/* Aids into the settings of the filter, and what they say of the start into its sigmas. */
void imki_aids_describe(const imk_navigate_log *n, const imki_navigate_aids *aids,
                        imk_navigation_filter_settings *settings);
/* Leave out what is before the first sample, and make room for the innovations. */
imk_status imki_aids_start(imk_navigate_log *n, imki_navigate_aids *aids, imk_error *error);
/* The readings up to the row that was just taken. */
void imki_aids_update(imk_navigate_log *n, imki_navigate_aids *aids, imk_navigation_filter *filter,
                      size_t row);
/* Counts and findings behind the last row. */
void imki_aids_finish(imk_navigate_log *n, imki_navigate_aids *aids,
                      const imk_navigation_filter *filter);

#endif
