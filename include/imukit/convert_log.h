/* SPDX-License-Identifier: Apache-2.0 */
/** @file convert_log.h
 *  The job of `imukit convert` for logs: it selects columns of a record, changes their units, moves
 *  the specific force to another point of the body, or takes gravity off the acceleration.
 *  Increments become rates. Rows are converted as they are read, so the memory does not depend on
 *  their number. */
#ifndef IMUKIT_CONVERT_LOG_H
#define IMUKIT_CONVERT_LOG_H

#include "imukit/attitude.h"
#include "imukit/job.h"
#include "imukit/record.h"

IMK_BEGIN_C

/** Settings of the job. Start from imk_convert_log_default(). */
typedef struct imk_convert_log_settings {
    uint32_t cookie;
    const char *select; /**< columns to keep, in this order: "time,gyro_x"; NULL: all */
    /** Units written; scale 0: the unit that was read (for increments, that of the rate) */
    imk_unit time_unit, gyro_unit, accel_unit, temperature_unit;
    bool to_point;           /**< give the specific force at `point`; default false */
    imk_vector3 point;       /**< position of the point in body axes, from the accelerometers [m] */
    bool gravity_free;       /**< give the acceleration relative to the Earth; default false */
    double still;            /**< time at rest at the start, within the record [s]; default 10 */
    double latitude, height; /**< place, for gravity [rad], [m]; default NaN, 0 */
    double yaw;              /**< at the start, from north towards east [rad]; default 0 */
} imk_convert_log_settings;

/** All columns, units as read. */
IMK_API imk_convert_log_settings imk_convert_log_default(void);

/** Convert the rows of a source and write them to a sink.
 *
 *  With to_point or gravity_free the record must have three gyros and three accelerometers, in
 *  units of rate and force. With gravity_free, roll and pitch come from the mean force while the
 *  unit is at rest; afterwards the gyros carry the attitude on. The findings tell how much this
 *  attitude drifts.
 *  @param job       NULL: one thread, no progress, the memory of the C library
 *  @param findings  may be NULL
 *  @return errors of the source; IMK_ERROR_MEMORY, _CANCELLED; _RANGE (still, latitude, height);
 *          _DIMENSION (a unit; error.field is "gyro-unit" or another); _NOT_FINITE (no specific
 *          force while at rest); with a finding that says why: IMK_ERROR_COLUMN, _DIMENSION
 *          (counts), _EMPTY, and errors of the sink ("not_written") */
IMK_API imk_status imk_convert_log_run(const imk_record_source *source,
                                       const imk_convert_log_settings *settings,
                                       const imk_record_sink *sink, const imk_job *job,
                                       imk_findings *findings, imk_error *error);

IMK_END_C
#endif
