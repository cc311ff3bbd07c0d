/* SPDX-License-Identifier: Apache-2.0 */
/** @file evaluate_log.h
 *  The job of `imukit evaluate`: tables of references and readings, and records of bench tests,
 *  as channels with their figures; and what a record at rest says of the noise. */
#ifndef IMUKIT_EVALUATE_LOG_H
#define IMUKIT_EVALUATE_LOG_H

#include "imukit/calibrate_log.h"
#include "imukit/evaluate_sheet.h"
#include "imukit/even_record.h"

IMK_BEGIN_C

/** What is asked. Start from imk_evaluate_log_default(). */
typedef struct imk_evaluate_log_settings {
    uint32_t cookie;
    double confidence;            /**< of intervals, 0.95 */
    double minimum, trim, settle; /**< of stretches of constant reference, as of
                                     imk_procedure_settings [s]; NaN: as there */
    bool sections;                /**< each section of a record is a run of its own; false */
} imk_evaluate_log_settings;

/** As the comments above say. */
IMK_API imk_evaluate_log_settings imk_evaluate_log_default(void);

typedef struct imk_evaluate_log {
    imk_evaluate_log_settings settings;
    size_t run_count, channel_count, rest_count;
    imk_evaluate_channel channel[IMK_EVALUATE_CHANNELS];
    imk_evaluate_rest rest[IMK_EVALUATE_CHANNELS];
    imk_findings findings;
    void *memory; /**< its own */
} imk_evaluate_log;

/** An evaluation without channels. @param job  its allocator is used; NULL: as if all zeros
 *  @return IMK_ERROR_UNINITIALISED, _MEMORY */
IMK_API imk_status imk_evaluate_log_create(const imk_evaluate_log_settings *settings,
                                           const imk_job *job, imk_evaluate_log **result,
                                           imk_error *error);
/** Free it and its channels; NULL is allowed. */
IMK_API void imk_evaluate_log_free(imk_evaluate_log *result);

/** A table has the columns reference and reading, or reading_x and so on. */
IMK_API bool imk_evaluate_is_table(size_t column_count, const imk_log_column *columns);
/** Add the readings of a table, with the columns direction (up, down), run and sigma where it has
 *  them: one run, or those of its column.
 *  @return with a finding, IMK_ERROR_COLUMN, _EMPTY, _UNIT_MISSING, _DIMENSION, _SYNTAX, _RANGE,
 *          _NOT_FINITE; IMK_ERROR_MEMORY */
IMK_API imk_status imk_evaluate_table(imk_evaluate_log *evaluation, const imk_log *table,
                                      imk_error *error);
/** Add the readings of a record with a reference, as the mean of every stretch in which it is
 *  constant.
 *  @return with a finding, IMK_ERROR_KEY_MISSING (no reference), _EMPTY (none that changes, or that
 *          stays), _DIMENSION, _RANGE; else what imk_reference_stretches() returns */
IMK_API imk_status imk_evaluate_record(imk_evaluate_log *evaluation,
                                       const imk_calibrate_record *record, imk_error *error);
/** Identify the channels of a record at rest, and fill their sheets. One that fails is a finding.
 */
IMK_API imk_status imk_evaluate_at_rest(imk_evaluate_log *evaluation, const imk_even_record *record,
                                        imk_error *error);
/** Readings in counts as what they stand for [counts per SI unit of the reference, counts]. */
IMK_API void imk_evaluate_scale(imk_evaluate_channel *channel, double sensitivity, double zero);
/** Settings of a channel that has all its readings: those of the figures, which may be changed. */
IMK_API void imk_evaluate_channel_settings(const imk_evaluate_log *evaluation,
                                           imk_evaluate_channel *channel);
/** Evaluate a channel and fill its sheet. @return as imk_evaluate() */
IMK_API imk_status imk_evaluate_channel_run(imk_evaluate_log *evaluation,
                                            imk_evaluate_channel *channel, imk_error *error);

IMK_END_C
#endif
