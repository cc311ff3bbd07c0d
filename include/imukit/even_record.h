/* SPDX-License-Identifier: Apache-2.0 */
/** @file even_record.h
 *  Equally spaced channels, as analysis needs them, from the rows of a record, which may have gaps,
 *  repeats and values that are not readings. */
#ifndef IMUKIT_EVEN_RECORD_H
#define IMUKIT_EVEN_RECORD_H

#include "imukit/job.h"
#include "imukit/record.h"

IMK_BEGIN_C

/** Treatment of rows that are missing, not finite or out of order. */
typedef enum imk_gap_policy {
    IMK_GAPS_REFUSE = 0, /**< the record is refused; but up to 0.1 % missing samples are
                              interpolated, with a warning, if no row is bad */
    IMK_GAPS_BRIDGE,     /**< they are interpolated linearly */
    IMK_GAPS_LONGEST,    /**< only the longest stretch without faults is used */
    IMK_GAPS_KEEP        /**< the samples are kept as missing: NaN */
} imk_gap_policy;

/** A record with equally spaced channels. */
typedef struct imk_even_record {
    imk_log log;                     /**< columns of the record; owns the memory */
    size_t count, rows;              /**< number of channels analysed; rows of each */
    int column[IMK_LOG_COLUMNS_MAX]; /**< per channel: its column in the log; gyros, then
                                        accelerometers, or all other columns */
    double dt;                       /**< sample interval [s] */
    double first_time;               /**< time of the first row [s]; 0 without a time column */
    size_t bridged;                  /**< samples that were interpolated */
    /** With IMK_GAPS_KEEP. missing: sample times without a row in the log (NaN in all channels);
     *  holes: runs of such samples; longest_hole: samples in the longest; unordered: rows left out
     *  because their time is not later than that of the row before; not_finite: rows with a value
     *  that is not finite in some channel. */
    size_t missing, holes, longest_hole, unordered, not_finite;
    /** Of each row [K]; NULL without such a column, or after interpolation. */
    const double *temperature;
} imk_even_record;

/** Read a whole source and make its channels equally spaced. Channels are gyros and accelerometers;
 *  if there are none, every other column. Numbers beyond IMK_READING_MAX count as missing. Stamps
 *  that are coarse, late or of a clock that jumps are replaced by even times of the rows in their
 *  order (docs/theory/gaps.md); samples of a sensor slower than the log are told. Free the record
 *  with imk_even_record_free(), also after an error.
 *  @return errors of the source; IMK_ERROR_MEMORY, _CANCELLED; with a finding that says why: _EMPTY
 *          (no row), _COLUMN (no channel), _TOO_SHORT, _RATE_MISSING, _TIME_ORDER (the times are
 *          not equally spaced), _GAP (refused) */
IMK_API imk_status imk_even_record_load(const imk_record_source *source, imk_gap_policy gaps,
                                        const imk_job *job, imk_even_record *record,
                                        imk_findings *findings, imk_error *error);
/** Free its columns. */
IMK_API void imk_even_record_free(imk_even_record *record);

/** Set count and column: choose the channels among the columns of record->log. */
IMK_API void imk_even_record_choose(imk_even_record *record);
/** Set readings of sensors and temperatures beyond IMK_READING_MAX to NaN. */
IMK_API void imk_log_forget_faults(imk_log *log);

/** The column of a channel. */
IMK_API const imk_log_column *imk_even_record_column(const imk_even_record *record, size_t channel);
/** The samples of a channel; NULL if the record was not held in memory. */
IMK_API double *imk_even_record_data(const imk_even_record *record, size_t channel);
/** Number of samples of a channel that are finite. */
IMK_API size_t imk_even_record_finite(const imk_even_record *record, size_t channel);

IMK_END_C
#endif
