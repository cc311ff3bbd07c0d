/* SPDX-License-Identifier: Apache-2.0 */
/** @file compensate_log.h
 *  The job of `imukit compensate`: it takes the errors that a model describes out of a record. Rows
 *  are corrected as they are read, so the memory does not depend on their number. */
#ifndef IMUKIT_COMPENSATE_LOG_H
#define IMUKIT_COMPENSATE_LOG_H

#include "imukit/compensate.h"
#include "imukit/job.h"
#include "imukit/record.h"

IMK_BEGIN_C

/** A list of model terms, each as its key in the model file ("gyro.bias.fixed"). */
enum { IMK_TERM_KEYS_MAX = 64 };
typedef struct imk_term_keys {
    int count;
    char key[IMK_TERM_KEYS_MAX][40];
} imk_term_keys;

/** Settings of the job. Start from imk_compensate_log_default(). */
typedef struct imk_compensate_log_settings {
    uint32_t cookie;
    const imk_model *terms;  /**< the model with only those terms that are to be taken out
                                (imk_model_select()); NULL: all terms */
    double temperature;      /**< temperature of the unit [K]; NaN: from the record */
    double temperature_time; /**< see imk_compensator.temperature_time [s]; default 30 */
    double powered_for;      /**< how long the unit was on before the first row [s]; default 0 */
    double rate_limit, force_limit; /**< see imk_correction_settings; default 0 */
    /** Units written; scale 0: the unit that was read, SI for counts. */
    imk_unit gyro_unit, accel_unit;
    bool flags; /**< add a column of flags (IMK_FLAG_…); default false */
} imk_compensate_log_settings;

/** All terms, the rate of temperature smoothed over 30 s, units as read. */
IMK_API imk_compensate_log_settings imk_compensate_log_default(void);

/** Counts of a run. Row numbers (first_…) count from 1; 0: none. */
typedef struct imk_compensate_counts {
    /** rows: rows read; any_flag: rows with a flag; stretches: parts between gaps in time;
     *  first_gap: first row after a gap; temperatures_held: rows without temperature, for which the
     *  last known one was used. */
    uint64_t rows, any_flag, stretches, first_gap, temperatures_held;
    uint64_t times_missing, first_time_missing; /**< rows whose time is not a number */
    /** Rows with each flag, in the order of IMK_FLAG_…, and the first of them. */
    uint64_t flagged[IMK_FLAG_COUNT], first_flagged[IMK_FLAG_COUNT];
} imk_compensate_counts;

/** Result of the job. */
typedef struct imk_compensate_log {
    imk_compensate_log_settings settings;
    imk_model model; /**< terms taken out, of the sensors that the record has */
    imk_compensator compensator;
    imk_compensate_counts counts;
    imk_term_keys taken_out, left_in;
    imk_findings findings;
    imk_allocator allocator; /**< allocator of this structure */
} imk_compensate_log;

/** Correct the rows of a source and write them to a sink. Readings of gyros and accelerometers
 *  become angular rate and specific force of the body; other columns are copied. After a gap in
 *  time the compensation starts anew.
 *  @param job     NULL: one thread, no progress, the memory of the C library
 *  @param result  free it with imk_compensate_log_free(), also after a failure, because it then
 *                 holds the findings; NULL if there was no memory for it
 *  @return errors of the source; IMK_ERROR_MEMORY, _CANCELLED, _RANGE (a setting, the interval);
 *          with a finding that says why: IMK_ERROR_COLUMN, _UNIT_MISSING, _DIMENSION, _KEY_MISSING,
 *          _EMPTY, _CONFLICT (counts whose axes were turned), and errors of imk_compensator_start()
 *          ("model_refused") and of the sink ("not_written") */
IMK_API imk_status imk_compensate_log_run(const imk_record_source *source, const imk_model *model,
                                          const imk_compensate_log_settings *settings,
                                          const imk_record_sink *sink, const imk_job *job,
                                          imk_compensate_log **result, imk_error *error);
/** Free it and all it holds; NULL is allowed. */
IMK_API void imk_compensate_log_free(imk_compensate_log *result);

/** Complete a model of selected terms for compensation: copies range, resolution and quantization
 *  from the whole model, because they tell which readings are saturated. */
IMK_API void imk_compensation_model(const imk_model *whole, imk_model *selected);

IMK_END_C
#endif
