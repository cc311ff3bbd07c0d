/* SPDX-License-Identifier: Apache-2.0 */
/** @file navigate_log.h
 *  The job of `imukit navigate`: where a unit went, from a record of three gyros and three
 *  accelerometers and the place where it began.
 *
 *  The attitude at the start is found while the unit stands (alignment.h), or given; a strapdown
 *  mechanisation (navigate.h) goes on from there, corrected by standing still where that is asked
 *  for (zero_velocity.h). */
#ifndef IMUKIT_NAVIGATE_LOG_H
#define IMUKIT_NAVIGATE_LOG_H

#include "imukit/alignment.h"
#include "imukit/even_record.h"
#include "imukit/zero_velocity.h"

IMK_BEGIN_C

/** When the unit is known to stand. */
typedef enum imk_stop_policy {
    IMK_STOPS_NONE = 0,
    IMK_STOPS_TIMETABLE, /**< at the end of each period */
    IMK_STOPS_FOUND      /**< whenever it is seen to */
} imk_stop_policy;

/** Settings of the job. Start from imk_navigate_log_default(). */
typedef struct imk_navigate_log_settings {
    uint32_t cookie;
    imk_gap_policy gaps; /**< IMK_GAPS_REFUSE */
    imk_geodetic place;  /**< of the start; 0, 0, 0 */
    double align; /**< how long the unit stands at the start, to find its attitude by itself [s], 1
                     or more; 0: the attitude is given; default 300 */
    bool method_given; /**< false: by what the gyros read */
    imk_alignment_method method;
    bool heading_given; /**< by attitude[2]: the alignment finds roll and pitch alone; default false
                         */
    double attitude[3]; /**< roll, pitch, yaw at the start [rad] */
    double attitude_sigma[3];
    const imk_model *model; /**< errors of the sensors, outlives the result; NULL: not known */
    const char *model_name; /**< in findings, outlives the result */
    imk_stop_policy stops;  /**< those corrected by, with a model; IMK_STOPS_NONE. What rest looks
                                 like is learnt from the alignment */
    double stop_period, stop_length; /**< of the timetable [s] */
    double still_velocity;   /**< 1 sigma of what moves in a unit that stands [m/s]; default 0.01 */
    double still_rotation;   /**< and of its mean rate [rad/s]; 0: the rotation is not used */
    bool hold_height;        /**< true */
    int samples;             /**< of coning and sculling, 1 … 4; default 3 */
    double interval;         /**< between rows of the track [s]; default 1 */
    double standard_gravity; /**< what g stands for in the columns in g, mg, ug; default 9.80665
                                m/s^2 */
    bool gravity_free;       /**< the track as a record has the acceleration too; default false */
} imk_navigate_log_settings;

/** Five minutes of alignment over inertial space, the height held. */
IMK_API imk_navigate_log_settings imk_navigate_log_default(void);

/** Columns of the track [SI]. */
enum {
    IMK_TRACK_TIME = 0,
    IMK_TRACK_LATITUDE,
    IMK_TRACK_LONGITUDE,
    IMK_TRACK_HEIGHT,
    IMK_TRACK_NORTH, /**< … east, down: from the start */
    IMK_TRACK_VELOCITY = IMK_TRACK_NORTH + 3,
    IMK_TRACK_ROLL = IMK_TRACK_VELOCITY + 3,
    IMK_TRACK_PITCH,
    IMK_TRACK_YAW,
    IMK_TRACK_ACCELERATION, /**< … east, down: relative to the Earth, mean since the row before */
    IMK_TRACK_SIGMA = IMK_TRACK_ACCELERATION + 3, /**< of position, velocity, attitude; north,
                                                       east, down */
    IMK_TRACK_COLUMNS = IMK_TRACK_SIGMA + IMK_NAVIGATION_ERRORS
};

/** What was found. */
typedef struct imk_navigate_log {
    imk_navigate_log_settings settings;
    imk_even_record record;
    imk_findings findings;
    const double *reading[6]; /**< of the record: rate, then force */
    size_t first;             /**< row where navigation begins, after the alignment */
    double first_time;        /**< [s] */
    imk_alignment_method method;
    imk_alignment_result alignment;
    double attitude[3];         /**< roll, pitch, yaw at the start of navigation [rad] */
    double attitude_sigma[3];   /**< about north, east, down; 0: not known */
    imk_navigation_state start; /**< of navigation */
    imk_zero_velocity_estimate end;
    imk_zero_velocity_counts counts;
    bool at_rest;   /**< it never moved: the way from the start is the error */
    double largest; /**< horizontal distance from the start [m] */
    size_t track_rows;
    double *track[IMK_TRACK_COLUMNS];
} imk_navigate_log;

/** Navigate by a source.
 *  @param job     NULL: one thread, no progress, the memory of the C library
 *  @param result  free it with imk_navigate_log_free(), also after a failure, because it then holds
 *                 the findings; NULL if there was no memory for it
 *  @return as imk_even_record_load(); IMK_ERROR_RANGE (a setting: error.field); with a finding that
 *          says why: _COLUMN, _UNIT_UNKNOWN (a unit can not be what it is said to be, no column is
 *          in g), _TOO_SHORT, _CONFLICT (near a pole), _UNSUPPORTED (the model), _NOT_FINITE */
IMK_API imk_status imk_navigate_log_run(const imk_record_source *source,
                                        const imk_navigate_log_settings *settings,
                                        const imk_job *job, imk_navigate_log **result,
                                        imk_error *error);
/** Free it and all it holds; NULL is allowed. */
IMK_API void imk_navigate_log_free(imk_navigate_log *result);

/** The track as a record, with the decimals that are worth writing. @return as the sink */
IMK_API imk_status imk_navigate_log_track(const imk_navigate_log *log, const imk_record_sink *sink,
                                          imk_error *error);

IMK_END_C
#endif
