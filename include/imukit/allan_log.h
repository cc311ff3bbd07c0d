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
    double *used; /**< share of the record's cluster pairs used for each point, 0 … 1; NULL without
                     gaps */
} imk_allan_curve;

/** Free the arrays of a curve. @param allocator  that of the job that made the curve */
IMK_API void imk_allan_curve_free(imk_allan_curve *curve, const imk_allocator *allocator);

/** Settings of the job. Start from imk_allan_log_default(). */
typedef struct imk_allan_log_settings {
    uint32_t cookie;
    imk_gap_policy gaps; /**< treatment of missing samples; default IMK_GAPS_KEEP */
    bool phase;          /**< the columns hold the integral of the rates; default false */
    size_t statistic_count;
    imk_allan_statistic statistic[IMK_ALLAN_STATISTICS]; /**< statistics to compute; default: the
                                                            overlapping deviation alone */
    double confidence;    /**< of the two-sided intervals; default 0.95 */
    bool greenhall_riley; /**< see imk_allan_settings; default false */
    imk_allan_bias_removal bias;
    imk_allan_grid grid; /**< averaging times where `times` states none; default octaves */
    size_t time_count;   /**< number of `times`; default 0 */
    /** Ascending averaging times [s]; with one statistic all must be within its range, with several
     *  statistics each leaves out those outside its range. */
    const double *times;
} imk_allan_log_settings;

/** OADEV at octave averaging times, 95 % intervals, missing samples kept. */
IMK_API imk_allan_log_settings imk_allan_log_default(void);

/** Result of the job. */
typedef struct imk_allan_log {
    imk_allan_log_settings settings; /**< settings used; the array `times` is still the caller's */
    imk_even_record record;          /**< the record; its samples were replaced by running sums */
    /** [channel][statistic]; count 0: the statistic is not defined for the record. */
    imk_allan_curve curve[IMK_LOG_COLUMNS_MAX][IMK_ALLAN_STATISTICS];
    imk_findings findings;
} imk_allan_log;

/** Deviations of every channel of a source. Memory: the record, the deviations, and workspaces.
 *  @param job     NULL: one thread, no progress, the memory of the C library
 *  @param result  free it with imk_allan_log_free(), also after a failure, because it then holds
 *                 the findings; NULL if there was no memory for it
 *  @return errors of imk_even_record_load(); with a finding that says why: IMK_ERROR_CONSTANT,
 *          _TOO_SHORT, _GAP (a statistic that needs every sample), _RANGE (a time) */
IMK_API imk_status imk_allan_log_run(const imk_record_source *source,
                                     const imk_allan_log_settings *settings, const imk_job *job,
                                     imk_allan_log **result, imk_error *error);
/** Free it and all it holds; NULL is allowed. */
IMK_API void imk_allan_log_free(imk_allan_log *result);

/** Unit in which the deviations of a channel are written: the column's, per second for phase data,
 *  times a second for TDEV. */
IMK_API imk_unit imk_allan_log_unit(const imk_allan_log *allan, size_t channel,
                                    imk_allan_statistic statistic);
/** Name of a noise type: "white-rate", "flicker-rate" … */
IMK_API const char *imk_power_law_name(imk_power_law type);

IMK_END_C
#endif
