/* SPDX-License-Identifier: Apache-2.0 */
/** @file navigate_log.h
 *  The job of `imukit navigate`: the track of a unit, from a record of three gyros and three
 *  accelerometers and the place of its start.
 *
 *  The attitude at the start is either given or found while the unit is stationary (alignment.h). A
 *  strapdown mechanisation (navigate.h) continues from there. If the settings say so, zero-velocity
 *  updates correct it at stops, and readings of other instruments while it moves
 *  (navigation_filter.h). */
#ifndef IMUKIT_NAVIGATE_LOG_H
#define IMUKIT_NAVIGATE_LOG_H

#include "imukit/alignment.h"
#include "imukit/even_record.h"
#include "imukit/navigation_filter.h"

IMK_BEGIN_C

/** When the unit is known to be stationary. */
typedef enum imk_stop_policy {
    IMK_STOPS_NONE = 0,
    IMK_STOPS_TIMETABLE, /**< at the end of each stop_period, for stop_length */
    IMK_STOPS_FOUND      /**< whenever the readings show it */
} imk_stop_policy;

/** Settings of the job. Start from imk_navigate_log_default(). */
typedef struct imk_navigate_log_settings {
    uint32_t cookie;
    imk_gap_policy gaps; /**< treatment of missing samples; default IMK_GAPS_REFUSE */
    imk_geodetic place;  /**< place of the start; default 0, 0, 0 */
    double align; /**< time at the start during which the unit is stationary and finds its attitude
                     [s], 1 or more; 0: `attitude` is given; default 300 */
    bool method_given; /**< true: `method` is used; false: inertial where the gyros of the model
                          find north to 0.2 rad, else means; without a model the readings decide */
    imk_alignment_method method;
    bool heading_given; /**< the heading is attitude[2], and the alignment finds roll and pitch
                           only; default false */
    double attitude[3]; /**< roll, pitch, yaw at the start [rad] */
    double attitude_sigma[3];
    bool
        velocity_given; /**< `velocity` is that of the start; only with align 0; default false: 0 */
    double velocity[3]; /**< north, east, down [m/s]; down 0 while the height is held */
    double velocity_sigma[3], position_sigma[3]; /**< north, east, down [m/s], [m]; default 0 */
    const imk_model *model; /**< errors of the sensors; must outlive the result; NULL: not known */
    const char *model_name; /**< its name in findings; must outlive the result */
    /** Stops used for zero-velocity updates; needs a model; default IMK_STOPS_NONE. The alignment
     *  shows what the readings at rest look like. */
    imk_stop_policy stops;
    double stop_period, stop_length; /**< of the timetable [s] */
    double still_velocity; /**< 1 sigma of the velocity of a stationary unit, such as vibration
                              [m/s]; default 0.01 */
    double still_rotation; /**< 1 sigma of its mean rate [rad/s]; 0: the rotation is not used */
    bool hold_height;      /**< hold the height constant; default true */
    int samples;           /**< samples of the coning and sculling algorithms, 1 … 4; default 3 */
    double interval;       /**< between rows of the track [s]; default 1 */
    double standard_gravity; /**< the value of g in columns in g, mg or ug; default 9.80665 m/s^2 */
    /** The track written as a record includes the acceleration; default false. */
    bool gravity_free;
    /** Readings of aids: a record with a time column on the clock of the log, and columns of
     *  position (latitude, longitude, height; ecef_x …; north, east, down of `place`), velocity
     *  (velocity_north …), heading, baro_height, speed (of an odometer), each with its sigmas or
     *  without (docs/navigate-a-log.md). Needs a model. Read during the call only; NULL: none. */
    const imk_record_source *aids;
    const char *aids_name; /**< its name in findings; must outlive the result */
    /** Kinds of aids whose sigmas are stated, which are used instead of columns of sigmas; kinds
     *  with neither are not used. Each kind once; `interval`, `from` and `until` as by default,
     *  because the times are those of the record. */
    size_t aid_count;
    imk_aid aid[IMK_AIDS_MAX];
    /** Of position, velocity and height, unless an aid above has one of its own [m]. */
    double lever_arm[3], lever_arm_sigma[3];
    double speed_lever_arm[3]; /**< the same of speed [m] */
    double aid_delay;          /**< readings are older by this than their times say [s] */
    double aid_interval;       /**< shortest time between readings that are used [s]; 0: all are */
    double aid_until;          /**< later readings are only compared; from the log's first row [s];
                                  default infinity */
    /** Smooth the track backwards: later readings and stops correct earlier rows. Needs a model;
     *  not with still_rotation. Memory: see navigation_smoother.h; default false. */
    bool smooth;
} imk_navigate_log_settings;

/** Five minutes of alignment, height held. */
IMK_API imk_navigate_log_settings imk_navigate_log_default(void);

/** Columns of the track [SI]. */
enum {
    IMK_TRACK_TIME = 0,
    IMK_TRACK_LATITUDE,
    IMK_TRACK_LONGITUDE,
    IMK_TRACK_HEIGHT,
    IMK_TRACK_NORTH, /**< position relative to the start; the next two are east and down */
    IMK_TRACK_VELOCITY = IMK_TRACK_NORTH + 3,
    IMK_TRACK_ROLL = IMK_TRACK_VELOCITY + 3,
    IMK_TRACK_PITCH,
    IMK_TRACK_YAW,
    IMK_TRACK_ACCELERATION, /**< north; the next two are east and down. Relative to the Earth, mean
                               since the row before */
    IMK_TRACK_SIGMA = IMK_TRACK_ACCELERATION +
                      3, /**< 1 sigma: position, velocity, attitude; each north, east, down */
    IMK_TRACK_COLUMNS = IMK_TRACK_SIGMA + IMK_NAVIGATION_ERRORS
};

/** What became of the readings of one aid. */
typedef struct imk_navigate_aid {
    imk_aid aid;            /**< as the filter had it */
    bool sigma_columns;     /**< each reading had its own sigmas */
    bool held;              /**< values were repeated between readings, and were used once */
    size_t readings;        /**< in the record */
    size_t outside;         /**< before navigation began or after the log's end */
    size_t disordered;      /**< not later than the reading before: left out */
    size_t skipped;         /**< by aid_interval, or that the filter cannot use */
    size_t compared;        /**< after aid_until */
    double compared_square; /**< sum of the squared normalised innovations of these */
    size_t compared_degrees;
    double first, last;                /**< times of the readings used [s]; NaN: none */
    double last_off[3], last_sigma[3]; /**< innovation of the last one compared, and its 1 sigma
                                          [unit of the aid]; NaN: no such axis */
    imk_navigation_filter_counts counts;
    /** Innovations in order of time, for figures. */
    size_t tested;
    double *time;           /**< [s] */
    double *innovation[3];  /**< per axis, divided by its 1 sigma; NaN: not measured */
    unsigned char *verdict; /**< imk_aid_verdict; IMK_AID_NOT_USED: compared only */
} imk_navigate_aid;

/** Result of the job. */
typedef struct imk_navigate_log {
    imk_navigate_log_settings settings;
    imk_even_record record;
    imk_findings findings;
    const double *reading[6]; /**< columns of the record: three rates, then three forces */
    size_t first;             /**< row where navigation begins, just after the alignment */
    double first_time;        /**< time of that row [s] */
    imk_alignment_method method;
    bool coarse; /**< the biases of the gyros hide the Earth's rotation: north was not found */
    imk_alignment_result alignment;
    double attitude[3];         /**< roll, pitch, yaw at the start of navigation [rad] */
    double attitude_sigma[3];   /**< 1 sigma about north, east, down [rad]; 0: not known */
    imk_navigation_state start; /**< state at the start of navigation */
    imk_navigation_filter_estimate end;
    imk_navigation_filter_counts counts; /**< of zero-velocity updates */
    size_t aid_count;
    imk_navigate_aid aid[IMK_AID_KIND_COUNT];
    bool at_rest;   /**< the unit never moved, so the distance from the start is the error */
    double largest; /**< largest horizontal distance from the start [m] */
    size_t track_rows;
    double *track[IMK_TRACK_COLUMNS];    /**< smoothed, if the settings say so, but for the
                                            acceleration */
    double *filtered[IMK_TRACK_COLUMNS]; /**< then the track as filtered; else NULL */
} imk_navigate_log;

/** Navigate through the rows of a source.
 *  @param job     NULL: one thread, no progress, the memory of the C library
 *  @param result  free it with imk_navigate_log_free(), also after a failure, because it then holds
 *                 the findings; NULL if there was no memory for it
 *  @return errors of imk_even_record_load(); IMK_ERROR_RANGE (error.field: the setting); with a
 *          finding that says why: _COLUMN, _UNIT_UNKNOWN (the readings contradict the stated unit,
 *          or standard_gravity is set and no column is in g), _TOO_SHORT, _CONFLICT (near a pole),
 *          _UNSUPPORTED (the model), _NOT_FINITE; of the aids _COLUMN, _UNIT_MISSING, _DIMENSION,
 *          _EMPTY (no reading within the log) */
IMK_API imk_status imk_navigate_log_run(const imk_record_source *source,
                                        const imk_navigate_log_settings *settings,
                                        const imk_job *job, imk_navigate_log **result,
                                        imk_error *error);
/** Free it and all it holds; NULL is allowed. */
IMK_API void imk_navigate_log_free(imk_navigate_log *result);

/** Write the track as a record, with as many decimals as make sense. @return errors of the sink */
IMK_API imk_status imk_navigate_log_track(const imk_navigate_log *log, const imk_record_sink *sink,
                                          imk_error *error);

IMK_END_C
#endif
