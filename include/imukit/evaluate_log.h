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

/** Settings of the job. Start from imk_evaluate_log_default(). */
typedef struct imk_evaluate_log_settings {
    uint32_t cookie;
    double confidence;            /**< of intervals; default 0.95 */
    double minimum, trim, settle; /**< of stretches of constant reference [s], see
                                       imk_procedure_settings; default NaN: the default there */
    bool sections;                /**< each section of a record is a run of its own; default
                                       false */
    bool keep_delay;              /**< do not take out the delay of a reference; default false */
} imk_evaluate_log_settings;

/** The defaults named above. */
IMK_API imk_evaluate_log_settings imk_evaluate_log_default(void);

/** Result of the job. */
typedef struct imk_evaluate_log {
    imk_evaluate_log_settings settings;
    size_t run_count, channel_count, rest_count;
    size_t record_count; /**< records of tests that were added; other runs are of tables */
    imk_evaluate_channel channel[IMK_EVALUATE_CHANNELS];
    imk_evaluate_rest rest[IMK_EVALUATE_CHANNELS];
    imk_findings findings;
    double delay, delay_sigma; /**< of the reference of the last record behind its readings [s],
                                  where it is more than a sample and 5 sigma; else 0 */
    void *memory;              /**< of the result; not for the caller */
} imk_evaluate_log;

/** Begin an evaluation, without channels.
 *  @param job  its allocator is used; NULL: memory of the C library
 *  @return IMK_ERROR_UNINITIALISED, _RANGE (minimum, trim, settle), _MEMORY */
IMK_API imk_status imk_evaluate_log_create(const imk_evaluate_log_settings *settings,
                                           const imk_job *job, imk_evaluate_log **result,
                                           imk_error *error);
/** Free an evaluation with its channels; NULL is allowed. */
IMK_API void imk_evaluate_log_free(imk_evaluate_log *result);

/** Is this a table of readings: are there columns reference and reading, or reading_x and so on? */
IMK_API bool imk_evaluate_is_table(size_t column_count, const imk_log_column *columns);
/** Add the readings of a table, and its columns direction (up, down), run and sigma if there are
 *  any. A table without a column run is one run.
 *  @return with a finding in evaluation->findings, IMK_ERROR_COLUMN, _EMPTY, _UNIT_MISSING,
 *          _DIMENSION, _SYNTAX, _RANGE, _NOT_FINITE; IMK_ERROR_MEMORY */
IMK_API imk_status imk_evaluate_table(imk_evaluate_log *evaluation, const imk_log *table,
                                      imk_error *error);
/** Add the readings of a record of a test with a reference: the mean of every stretch in which the
 *  reference is constant. A delay of the reference is taken out, with a finding when it exceeds
 *  what is trimmed.
 *  @param record  from imk_calibrate_record_load()
 *  @return with a finding in evaluation->findings, IMK_ERROR_KEY_MISSING (no reference), _EMPTY
 *          (no reference changes, or none stays constant), _DIMENSION, _RANGE; errors of
 *          imk_reference_stretches() */
IMK_API imk_status imk_evaluate_record(imk_evaluate_log *evaluation,
                                       const imk_calibrate_record *record, imk_error *error);
/** Identify the noise of a record at rest and fill the sheets of its channels. A channel that
 *  cannot be identified gives a finding.
 *  @return IMK_ERROR_MEMORY */
IMK_API imk_status imk_evaluate_at_rest(imk_evaluate_log *evaluation, const imk_even_record *record,
                                        imk_error *error);
/** Add the readings of a source: a table, if its columns are those of one, else a record of a test.
 *  @param name      what it is called in findings; must live as long as the call
 *  @param settings  of a record: section, motion, motion_offset, find_offset, table_axis
 *  @param job       NULL: no progress, memory of the C library
 *  @return with a finding in evaluation->findings, errors of imk_evaluate_table(),
 *          imk_calibrate_record_load() and imk_evaluate_record() */
IMK_API imk_status imk_evaluate_source(imk_evaluate_log *evaluation, const char *name,
                                       const imk_record_source *source,
                                       const imk_calibrate_log_settings *settings,
                                       const imk_job *job, imk_error *error);
/** Identify the noise of a source at rest: imk_even_record_load(), imk_evaluate_at_rest().
 *  @return errors of these, with a finding in evaluation->findings */
IMK_API imk_status imk_evaluate_rest_source(imk_evaluate_log *evaluation,
                                            const imk_record_source *source, imk_gap_policy gaps,
                                            const imk_job *job, imk_error *error);
/** Refuse settings of records where all runs are of tables: section, motion, motion_offset,
 *  find_offset, table_axis.
 *  @return IMK_ERROR_CONFLICT (field) */
IMK_API imk_status imk_evaluate_check_used(const imk_evaluate_log *evaluation,
                                           const imk_calibrate_log_settings *settings,
                                           imk_error *error);
/** Compare all figures with limits (imk_evaluate_assess()).
 *  @param missed  number of figures beyond their limits, or not determined
 *  @return for a limit of no figure (error.index: which) IMK_ERROR_CONFLICT, or why its figure
 *          cannot have it */
IMK_API imk_status imk_evaluate_limits_check(imk_evaluate_log *evaluation, size_t count,
                                             imk_evaluate_limit *limits, size_t *missed,
                                             imk_error *error);
/** Convert the readings of a channel from counts to the unit of its reference.
 *  @param sensitivity  [counts per SI unit of the reference]
 *  @param zero         reading at zero [counts] */
IMK_API void imk_evaluate_scale(imk_evaluate_channel *channel, double sensitivity, double zero);
/** Set channel->settings, which may then be changed. The channel must have all its readings. */
IMK_API void imk_evaluate_channel_settings(const imk_evaluate_log *evaluation,
                                           imk_evaluate_channel *channel);
/** Evaluate a channel and fill its sheet. @return errors of imk_evaluate(), IMK_ERROR_MEMORY */
IMK_API imk_status imk_evaluate_channel_run(imk_evaluate_log *evaluation,
                                            imk_evaluate_channel *channel, imk_error *error);

IMK_END_C
#endif
