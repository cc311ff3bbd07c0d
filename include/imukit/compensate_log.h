/* SPDX-License-Identifier: Apache-2.0 */
/** @file compensate_log.h
 *  The job of `imukit compensate`: a record and a model into the record without the errors that the
 *  model describes. Rows are corrected as they are read; the memory does not depend on their
 *  number. */
#ifndef IMUKIT_COMPENSATE_LOG_H
#define IMUKIT_COMPENSATE_LOG_H

#include "imukit/compensate.h"
#include "imukit/job.h"
#include "imukit/record.h"

IMK_BEGIN_C

/** A list of terms, as their keys in the model file ("gyro.bias.fixed"). */
enum { IMK_TERM_KEYS_MAX = 64 };
typedef struct imk_term_keys {
    int count;
    char key[IMK_TERM_KEYS_MAX][40];
} imk_term_keys;

/** Settings of the job. Start from imk_compensate_log_default(). */
typedef struct imk_compensate_log_settings {
    uint32_t cookie;
    const imk_model *terms;  /**< the model with the terms alone that are to be taken out
                                  (imk_model_select()); NULL: all */
    double temperature;      /**< of the unit [K]; NaN: that of the record */
    double temperature_time; /**< imk_compensator.temperature_time [s]; default 30 */
    double powered_for;      /**< how long the unit was on before the first row [s]; default 0 */
    double rate_limit, force_limit; /**< as of imk_correction_settings; default 0 */
    imk_unit gyro_unit, accel_unit; /**< of what is written; scale 0: as read, SI for counts */
    bool flags;                     /**< a column of flags is added; default false */
} imk_compensate_log_settings;

/** Whole compensation, a temperature smoothed over 30 s, units as read. */
IMK_API imk_compensate_log_settings imk_compensate_log_default(void);

/** What was met on the way; rows count from 1. */
typedef struct imk_compensate_counts {
    uint64_t rows, any_flag, stretches, first_gap, temperatures_held;
    uint64_t times_missing, first_time_missing; /**< whose time is no number */
    uint64_t flagged[IMK_FLAG_COUNT], first_flagged[IMK_FLAG_COUNT];
} imk_compensate_counts;

/** What was done. */
typedef struct imk_compensate_log {
    imk_compensate_log_settings settings;
    imk_model model; /**< what is taken out, of the sensors that the record has */
    imk_compensator compensator;
    imk_compensate_counts counts;
    imk_term_keys taken_out, left_in;
    imk_findings findings;
    imk_allocator allocator; /**< allocator of this structure */
} imk_compensate_log;

/** Correct a source into a sink: gyros and accelerometers become angular rate and specific force of
 *  the body, other columns are copied. A gap in time begins anew.
 *  @param job     NULL: one thread, no progress, the memory of the C library
 *  @param result  free it with imk_compensate_log_free(), also after a failure, because it then
 *                 holds the findings; NULL if there was no memory for it
 *  @return what the source returns; IMK_ERROR_MEMORY, _CANCELLED, _RANGE (the interval); with a
 *          finding that says why: IMK_ERROR_COLUMN, _UNIT_MISSING, _DIMENSION, _KEY_MISSING,
 *          _EMPTY, and what imk_compensator_start() ("model_refused") and the sink ("not_written")
 *          return */
IMK_API imk_status imk_compensate_log_run(const imk_record_source *source, const imk_model *model,
                                          const imk_compensate_log_settings *settings,
                                          const imk_record_sink *sink, const imk_job *job,
                                          imk_compensate_log **result, imk_error *error);
/** Free it and all it holds; NULL is allowed. */
IMK_API void imk_compensate_log_free(imk_compensate_log *result);

/** The terms to be taken out of a unit: those selected, with the output stage (range, resolution,
 *  quantization) of the whole model, which tells what readings are saturated. */
IMK_API void imk_compensation_model(const imk_model *whole, imk_model *selected);

IMK_END_C
#endif
