/* SPDX-License-Identifier: Apache-2.0 */
/** @file identify_curve.h
 *  The job of `imukit identify --curve`: a noise model from a table of Allan deviations, a data
 *  sheet's, a publication's, another tool's. Only the curve being known, the fit is generalised
 *  least squares over all its tau (imk_allan_fit_table()) instead of the likelihood of the record.
 */
#ifndef IMUKIT_IDENTIFY_CURVE_H
#define IMUKIT_IDENTIFY_CURVE_H

#include "imukit/identify_log.h"

IMK_BEGIN_C

/** What is asked, and what the table does not say. Start from imk_identify_curve_default(). */
typedef struct imk_identify_curve_settings {
    uint32_t cookie;
    double rate, duration;           /**< of the record behind it [Hz], [s]; must be set */
    double confidence, significance; /**< as of imk_identify_log_settings; 0.95, 0.01 */
    double tolerance;                /**< as of imk_allan_fit_settings; default 0 */
    int gauss_markov_max;            /**< the same; default 0 */
    bool plain;                      /**< clusters that do not overlap; default false */
} imk_identify_curve_settings;

/** 95 % intervals, terms at 1 % significance. */
IMK_API imk_identify_curve_settings imk_identify_curve_default(void);

/** Fit the curve of every channel.
 *  @param source  a column tau [s] (OTHER, "tau" or "tau_s"), and deviations under the names of
 *                 their channels. Of tau those are used that are multiples of the sample interval
 *  @param job     NULL: one thread, no progress, the memory of the C library
 *  @param result  free it with imk_identify_log_free(), also after a failure, because it then holds
 *                 the findings; NULL if there was no memory for it
 *  @return what the source returns; IMK_ERROR_MEMORY, IMK_ERROR_RANGE (rate, duration); with a
 *          finding that says why: IMK_ERROR_FORMAT (no such table), IMK_ERROR_TOO_SHORT (fewer than
 *          four tau), and what imk_allan_fit_table() returns */
IMK_API imk_status imk_identify_curve_run(const imk_record_source *source,
                                          const imk_identify_curve_settings *settings,
                                          const imk_job *job, imk_identify_log **result,
                                          imk_error *error);

IMK_END_C
#endif
