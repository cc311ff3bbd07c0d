/* SPDX-License-Identifier: Apache-2.0 */
/** @file allan_log.h
 *  The job of `imukit allan`: Allan deviations of every channel of a record, with intervals. */
#ifndef IMUKIT_ALLAN_LOG_H
#define IMUKIT_ALLAN_LOG_H

#include "imukit/allan.h"
#include "imukit/even_record.h"

IMK_BEGIN_C

/** Deviations of one channel over the averaging time, as columns ready to be plotted. */
typedef struct imk_allan_curve {
    size_t count;
    imk_allan_point *point;
    double *tau, *deviation, *lower, *upper; /**< [s], [SI] */
    double *used; /**< share of the record's pairs behind each point; NULL without gaps */
} imk_allan_curve;

/** @param allocator  of the job that made it */
IMK_API void imk_allan_curve_free(imk_allan_curve *curve, const imk_allocator *allocator);

/** Settings of the job. Start from imk_allan_log_default(). */
typedef struct imk_allan_log_settings {
    uint32_t cookie;
    imk_gap_policy gaps; /**< IMK_GAPS_KEEP */
    bool phase;          /**< the columns hold the integral of the rates; default false */
    size_t statistic_count;
    imk_allan_statistic statistic[IMK_ALLAN_STATISTICS]; /**< the overlapping deviation */
    double confidence;    /**< of the two-sided intervals; default 0.95 */
    bool greenhall_riley; /**< as of imk_allan_settings; default false */
    imk_allan_bias_removal bias;
    imk_allan_grid grid; /**< octaves; where there are no times */
    size_t time_count;   /**< 0 */
    const double *times; /**< ascending averaging times [s]; with one statistic all of them are
                            within its range, with several those outside are left out */
} imk_allan_log_settings;

/** OADEV at octave averaging times, 95 % intervals, missing samples kept. */
IMK_API imk_allan_log_settings imk_allan_log_default(void);

/** What was found. */
typedef struct imk_allan_log {
    imk_allan_log_settings settings; /**< `times` is the caller's */
    imk_even_record record;          /**< its samples became running sums */
    imk_allan_curve curve[IMK_LOG_COLUMNS_MAX][IMK_ALLAN_STATISTICS]; /**< count 0: not defined */
    imk_findings findings;
} imk_allan_log;

/** Deviations of every channel of a source. Memory: the record, its deviations, and workspaces.
 *  @param job     NULL: one thread, no progress, the memory of the C library
 *  @param result  free it with imk_allan_log_free(), also after a failure, because it then holds
 *                 the findings; NULL if there was no memory for it
 *  @return what imk_even_record_load() returns; with a finding that says why: IMK_ERROR_CONSTANT,
 *          _TOO_SHORT, _GAP (a statistic that needs every sample), _RANGE (a time) */
IMK_API imk_status imk_allan_log_run(const imk_record_source *source,
                                     const imk_allan_log_settings *settings, const imk_job *job,
                                     imk_allan_log **result, imk_error *error);
/** Free it and all it holds; NULL is allowed. */
IMK_API void imk_allan_log_free(imk_allan_log *result);

/** Units in which deviations are written and read: of phase per second, of TDEV times a second. */
IMK_API imk_unit imk_allan_log_unit(const imk_allan_log *allan, size_t channel,
                                    imk_allan_statistic statistic);
/** "white-rate" */
IMK_API const char *imk_power_law_name(imk_power_law type);

IMK_END_C
#endif
