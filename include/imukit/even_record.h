/* SPDX-License-Identifier: Apache-2.0 */
/** @file even_record.h
 *  Equally spaced channels out of the rows of a record, which may have gaps, repeats and values
 *  that are no readings: what analysis works on. */
#ifndef IMUKIT_EVEN_RECORD_H
#define IMUKIT_EVEN_RECORD_H

#include "imukit/job.h"
#include "imukit/record.h"

IMK_BEGIN_C

/** What is done about rows that are missing, not finite or out of order. */
typedef enum imk_gap_policy {
    IMK_GAPS_REFUSE = 0, /**< the record is refused; up to 0.1 % are bridged, with a warning */
    IMK_GAPS_BRIDGE,     /**< straight lines over them */
    IMK_GAPS_LONGEST,    /**< the longest clean stretch */
    IMK_GAPS_KEEP        /**< their places stay empty: NaN */
} imk_gap_policy;

/** Equally spaced channels. */
typedef struct imk_even_record {
    imk_log log;                     /**< owns the memory */
    size_t count, rows;              /**< channels analysed; rows of each */
    int column[IMK_LOG_COLUMNS_MAX]; /**< of the log: gyros, then accelerometers, or all others */
    double dt;                       /**< [s] */
    size_t bridged;                  /**< samples that were interpolated */
    /** With IMK_GAPS_KEEP: rows of the grid that no row of the log fills (NaN in all channels), in
     *  how many holes, the longest; rows of the log left out because their time is not later than
     *  that of the row before; rows with a value that is not finite in some channel. */
    size_t missing, holes, longest_hole, unordered, not_finite;
    const double *temperature; /**< of each row; NULL without a column, or after bridging */
} imk_even_record;

/** Read a whole source and make its channels equally spaced: gyros and accelerometers, or every
 *  other column where there are none. Numbers beyond IMK_READING_MAX are no readings. Free with
 *  imk_even_record_free(), also on error.
 *  @return what the source returns; IMK_ERROR_MEMORY, _CANCELLED; and with a finding that says why:
 *          _EMPTY (no row), _COLUMN (no channel), _TOO_SHORT, _RATE_MISSING, _TIME_ORDER
 *          (times that are no grid), _GAP (refused) */
IMK_API imk_status imk_even_record_load(const imk_record_source *source, imk_gap_policy gaps,
                                        const imk_job *job, imk_even_record *record,
                                        imk_findings *findings, imk_error *error);
/** Free its columns. */
IMK_API void imk_even_record_free(imk_even_record *record);

/** Choose the channels among the columns of record->log. */
IMK_API void imk_even_record_choose(imk_even_record *record);
/** Numbers of sensors and temperatures that are no readings become NaN. */
IMK_API void imk_log_forget_faults(imk_log *log);

/** The column that a channel is of. */
IMK_API const imk_log_column *imk_even_record_column(const imk_even_record *record, size_t channel);
/** The samples of a channel; NULL of a record that was never held in memory. */
IMK_API double *imk_even_record_data(const imk_even_record *record, size_t channel);
/** How many rows of the channel are finite numbers. */
IMK_API size_t imk_even_record_finite(const imk_even_record *record, size_t channel);

IMK_END_C
#endif
