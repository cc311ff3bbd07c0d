/* SPDX-License-Identifier: Apache-2.0 */
/** @file spectrum_log.h
 *  The job of `imukit spectrum`: power spectral densities of every channel of a record, its lines,
 *  and the noise it shows. */
#ifndef IMUKIT_SPECTRUM_LOG_H
#define IMUKIT_SPECTRUM_LOG_H

#include "imukit/even_record.h"
#include "imukit/spectrum.h"

IMK_BEGIN_C

enum {
    IMK_SPECTRUM_LINES_MAX = 64,
    IMK_SPECTRUM_FINE = 100, /**< bands per decade, lines in them */
    IMK_SPECTRUM_COARSE = 4  /**< the same, lines left out */
};

/** Settings of the job. Start from imk_spectrum_log_default(). */
typedef struct imk_spectrum_log_settings {
    uint32_t cookie;
    imk_gap_policy gaps; /**< IMK_GAPS_REFUSE */
    imk_spectrum_method method;
    imk_window window;
    double resolution;  /**< [Hz]; 0: as imk_spectrum_settings */
    bool trend;         /**< a straight line is removed from each segment; default false */
    double from, to;    /**< [Hz] of the fit of noise parameters; 0: the lowest, the highest */
    double confidence;  /**< of the two-sided intervals; default 0.95 */
    double false_alarm; /**< chance that a channel without lines shows any; default 0.001 */
    bool
        one_sided; /**< how densities are shown; those of the result are two-sided; default false */
} imk_spectrum_log_settings;

/** 95 % intervals, lines at 0.1 % false alarm. */
IMK_API imk_spectrum_log_settings imk_spectrum_log_default(void);

/** What was found on one channel. */
typedef struct imk_channel_spectrum {
    imk_spectrum spectrum;
    size_t line_count;
    imk_spectrum_line line[IMK_SPECTRUM_LINES_MAX];
    size_t fine_count, coarse_count;
    imk_spectrum_band *fine, *coarse;
    imk_status fit_status; /**< IMK_OK: `fit` is there */
    imk_spectrum_parameters fit;
    double *memory; /**< the arrays of the spectrum */
} imk_channel_spectrum;

/** What was found. */
typedef struct imk_spectrum_log {
    imk_spectrum_log_settings settings;
    imk_even_record record;
    imk_channel_spectrum channel[IMK_LOG_COLUMNS_MAX];
    imk_findings findings;
} imk_spectrum_log;

/** Spectra of every channel of a source.
 *  @param job     NULL: one thread, no progress, the memory of the C library
 *  @param result  free it with imk_spectrum_log_free(), also after a failure, because it then holds
 *                 the findings; NULL if there was no memory for it
 *  @return as imk_even_record_load(); IMK_ERROR_RANGE (error.field "from" or "resolution"); with a
 *          finding that says why: IMK_ERROR_CONSTANT, _TOO_SHORT, _GAP */
IMK_API imk_status imk_spectrum_log_run(const imk_record_source *source,
                                        const imk_spectrum_log_settings *settings,
                                        const imk_job *job, imk_spectrum_log **result,
                                        imk_error *error);
/** Free it and all it holds; NULL is allowed. */
IMK_API void imk_spectrum_log_free(imk_spectrum_log *result);

IMK_END_C
#endif
