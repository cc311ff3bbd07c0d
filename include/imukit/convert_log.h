/* SPDX-License-Identifier: Apache-2.0 */
/** @file convert_log.h
 *  The job of `imukit convert` for logs: some columns of a record, in other units; the specific
 *  force at another point of the body; acceleration without gravity. Increments become rates. Rows
 *  are converted as they are read; the memory does not depend on their number. */
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
    imk_unit time_unit, gyro_unit, accel_unit,
        temperature_unit;    /**< of what is written; scale 0: as read, or of a rate */
    bool to_point;           /**< specific force at `point`; default false */
    imk_vector3 point;       /**< of the body, from the accelerometers [m] */
    bool gravity_free;       /**< acceleration relative to the Earth; default false */
    double still;            /**< how long the unit does not move at first [s]; default 10 */
    double latitude, height; /**< for gravity [rad, m]; NaN, 0 */
    double yaw;              /**< at first, from north to east [rad]; default 0 */
} imk_convert_log_settings;

/** All columns as read. */
IMK_API imk_convert_log_settings imk_convert_log_default(void);

/** Convert a source into a sink.
 *
 *  With to_point or gravity_free the record has three gyros and three accelerometers, in rates and
 *  forces. Without gravity, roll and pitch come from the mean force while the unit is still, and
 *  attitude from there on from the gyros; what they miss is in the findings.
 *  @param job       NULL: one thread, no progress, the memory of the C library
 *  @param findings  may be NULL
 *  @return what the source returns; IMK_ERROR_MEMORY, _CANCELLED; _RANGE (still, latitude, height);
 *          _DIMENSION (a unit; error.field is "gyro-unit" or another); _NOT_FINITE (no force while
 *          still); with a finding that says why: IMK_ERROR_COLUMN, _DIMENSION (counts), _EMPTY, and
 *          what the sink ("not_written") returns */
IMK_API imk_status imk_convert_log_run(const imk_record_source *source,
                                       const imk_convert_log_settings *settings,
                                       const imk_record_sink *sink, const imk_job *job,
                                       imk_findings *findings, imk_error *error);

IMK_END_C
#endif
