/* SPDX-License-Identifier: Apache-2.0 */
/* Rows of a record whose specific force is that of another point of the body, or acceleration
 * without gravity. */
#ifndef IMUKIT_CONVERT_MOTION_INTERNAL_H
#define IMUKIT_CONVERT_MOTION_INTERNAL_H

#include "imukit/convert_log.h"
#include "imukit/navigate.h"

typedef struct imki_convert_motion {
    const imk_convert_log_settings *settings;
    imk_findings *findings;
    double *const *data; /* the rows of the caller, by column */
    int time, gyro[3], accel[3];
    /* Rows at the head of the buffers: read, moved to the point, ready to be given out. */
    size_t stored, moved, ready;
    bool over;
    double interval;
    imk_vector3 before; /* rates of the row before the next to be moved */
    bool has_before;
    uint64_t unknown; /* rows without a neighbour to tell their angular acceleration */
    /* Without gravity. */
    bool aligned;
    imk_strapdown strapdown;
    imk_navigation_state start;
    imk_vector3 gravity;
    double step_time;            /* of the row before [s] */
    double duration, drift_rate; /* [s], [rad/s] */
    uint64_t lost;               /* rows without finite rates: the attitude was held */
} imki_convert_motion;

/* Check the settings and find the columns. */
imk_status imki_convert_motion_start(imki_convert_motion *m, const imk_record_source *source,
                                     imk_error *error);
/* More rows are stored, or, at the end, none: `ready` of them can be given out. */
imk_status imki_convert_motion_rows(imki_convert_motion *m, imk_error *error);
/* What is to be said of the whole. */
void imki_convert_motion_warn(const imki_convert_motion *m);

#endif
