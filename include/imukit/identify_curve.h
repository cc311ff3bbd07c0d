/* SPDX-License-Identifier: Apache-2.0 */
/** @file identify_curve.h
 *  The job of `imukit identify --curve`: a noise model from a table of Allan deviations, such as
 *  that of a data sheet, a publication or another tool. As only the curve is known, the fit is
 *  generalised least squares over all its tau (imk_allan_fit_table()) instead of maximum likelihood
 *  on the record. */
#ifndef IMUKIT_IDENTIFY_CURVE_H
#define IMUKIT_IDENTIFY_CURVE_H

#include "imukit/identify_log.h"

IMK_BEGIN_C

/** Settings of the job, and facts that the table does not state. Start from
 *  imk_identify_curve_default(). */
typedef struct imk_identify_curve_settings {
    uint32_t cookie;
    double rate, duration; /**< sampling rate [Hz] and length [s] of the record behind the table;
                              must be set */
    double confidence, significance; /**< see imk_identify_log_settings; default 0.95, 0.01 */
    /** See imk_allan_fit_settings. NaN (default): the smallest of 0 to 20 % with which the terms
     *  explain the curve; a finding states it if it is not 0. */
    double tolerance;
    int gauss_markov_max; /**< see imk_allan_fit_settings; default 0 */
    bool plain;           /**< the table is of non-overlapping clusters; default false */
} imk_identify_curve_settings;

/** 95 % intervals, terms at 1 % significance. */
IMK_API imk_identify_curve_settings imk_identify_curve_default(void);

/** Fit the curve of every channel.
 *  @param source  a column of averaging times [s], named "tau" or "tau_s" (IMK_QUANTITY_OTHER), and
 *                 a column of deviations for each channel, with its name. Only tau that are
 *                 multiples of the sample interval are used
 *  @param job     NULL: one thread, no progress, the memory of the C library
 *  @param result  free it with imk_identify_log_free(), also after a failure, because it then holds
 *                 the findings; NULL if there was no memory for it
 *  @return errors of the source; IMK_ERROR_MEMORY, IMK_ERROR_RANGE (rate, duration); with a finding
 *          that says why: IMK_ERROR_FORMAT (not such a table), IMK_ERROR_TOO_SHORT (fewer than four
 *          tau), and errors of imk_allan_fit_table() */
IMK_API imk_status imk_identify_curve_run(const imk_record_source *source,
                                          const imk_identify_curve_settings *settings,
                                          const imk_job *job, imk_identify_log **result,
                                          imk_error *error);

IMK_END_C
#endif
