/* SPDX-License-Identifier: Apache-2.0 */
/* Parts of imukit navigate: options, the log, the run, and what is shown of it. */
#ifndef IMUKIT_NAVIGATE_PARTS_H
#define IMUKIT_NAVIGATE_PARTS_H

#include "log/log_input.h"
#include "shell/show.h"

#include "imukit/alignment.h"
#include "imukit/model_file.h"
#include "imukit/zero_velocity.h"

typedef struct navigate_options {
    log_input log;
    const char *position, *attitude, *heading, *model, *zero_velocity, *output, *plot, *report;
    /* NaN: not given, of align, stop and still_rotation */
    double align, stop, still_velocity, still_rotation, interval, standard_gravity;
    option_integer samples;
    int method, vertical; /* method -1: not given */
    bool json, strict, gravity_free;
} navigate_options;

typedef enum update_policy { UPDATES_NONE = 0, UPDATES_EVERY, UPDATES_AUTO } update_policy;

/* Columns of the track. */
enum {
    TRACK_TIME = 0,
    TRACK_LATITUDE,
    TRACK_LONGITUDE,
    TRACK_HEIGHT,
    TRACK_NORTH, /* … east, down: from the start */
    TRACK_VELOCITY = TRACK_NORTH + 3,
    TRACK_ROLL = TRACK_VELOCITY + 3,
    TRACK_PITCH,
    TRACK_YAW,
    TRACK_ACCELERATION,                   /* … east, down: mean since the row before */
    TRACK_SIGMA = TRACK_ACCELERATION + 3, /* of position, velocity, attitude; north, east, down */
    TRACK_COLUMNS = TRACK_SIGMA + IMK_NAVIGATION_ERRORS
};

typedef struct navigation {
    const navigate_options *options;
    const char *path;
    log_channels channels;
    const double *reading[6]; /* rate, force */
    size_t rows, first;       /* first: of navigation, after the alignment */
    double dt, first_time;    /* [s] */
    imk_geodetic place;       /* of the start */
    bool has_model;
    imk_model *model;
    update_policy updates;
    double update_every, stop; /* [s] */
    imk_alignment_method method;
    double heading, heading_sigma; /* when given [rad] */
    bool aligned;
    imk_alignment_result alignment;
    double euler[3];            /* roll, pitch, yaw at the start of navigation [rad] */
    double attitude_sigma[3];   /* about north, east, down; of `alignment`, or 0 */
    imk_navigation_state start; /* of navigation */
    imk_zero_velocity_settings settings;
    imk_zero_velocity_estimate end;
    imk_zero_velocity_counts counts;
    size_t windows, still_windows; /* of the detector, when it was used */
    size_t steady_windows;         /* that look still while the velocity is not 0 */
    bool moved;                    /* the velocity changed by more than a standing unit's may */
    double largest;                /* horizontal distance from the start [m] */
    size_t track_rows;
    double *track[TRACK_COLUMNS];
} navigation;

/* Angle (sensor 0) or velocity (1) over one sample. */
static inline imk_vector3 navigate_increment(const navigation *n, int sensor, size_t row)
{
    imk_vector3 out;
    for (int i = 0; i < 3; i++)
        out.v[i] = n->reading[3 * sensor + i][row] * n->dt;
    return out;
}

/* Of all windows these many must be still for a unit to count as one that never moved. */
bool navigate_at_rest(const navigation *n);

/* All return -1 or the exit code, the message printed. */
int navigate_parse(navigation *n);       /* texts among the options; before the log is read */
int navigate_load(navigation *n);        /* the log and what its columns mean */
int navigate_align(navigation *n);       /* attitude at the start */
int navigate_check(const navigation *n); /* is this gravity, is that the Earth's rotation? */
int navigate_run(navigation *n);

int navigate_write_track(const navigation *n, const char *path);
/* @param warned  there are warnings */
void navigate_show(const navigation *n, bool warned, imk_result *result);
void navigate_free(navigation *n);

#endif
