/* SPDX-License-Identifier: Apache-2.0 */
/** @file spectrum_log.h
 *  The job of `imukit spectrum`: power spectral density, spectral lines and noise parameters of
 *  every channel of a record. */
#ifndef IMUKIT_SPECTRUM_LOG_H
#define IMUKIT_SPECTRUM_LOG_H

#include "imukit/even_record.h"
#include "imukit/spectrum.h"

IMK_BEGIN_C

enum {
    IMK_SPECTRUM_LINES_MAX = 64,
    IMK_SPECTRUM_FINE = 100, /**< bands per decade of the fine curve, spectral lines included */
    IMK_SPECTRUM_COARSE = 4  /**< bands per decade of the coarse curve, spectral lines left out */
};

/** Settings of the job. Start from imk_spectrum_log_default(). */
typedef struct imk_spectrum_log_settings {
    uint32_t cookie;
    imk_gap_policy gaps; /**< treatment of missing samples; default IMK_GAPS_REFUSE */
    imk_spectrum_method method;
    imk_window window;
    double resolution; /**< see imk_spectrum_settings [Hz]; default 0 */
    bool trend;        /**< remove a straight line from each segment; default false */
    double from, to;   /**< range of the fit of noise parameters [Hz]; 0 (default): the lowest, the
                          highest frequency */
    double confidence; /**< of the two-sided intervals; default 0.95 */
    /** Chance that a line is found in a channel without lines; default 0.001. */
    double false_alarm;
    bool one_sided; /**< show one-sided densities (those of the result are always two-sided);
                       default false */
} imk_spectrum_log_settings;

/** 95 % intervals, lines at a false-alarm probability of 0.1 %. */
IMK_API imk_spectrum_log_settings imk_spectrum_log_default(void);

/** Result for one channel. */
typedef struct imk_channel_spectrum {
    imk_spectrum spectrum;
    size_t line_count;
    imk_spectrum_line line[IMK_SPECTRUM_LINES_MAX];
    size_t fine_count, coarse_count;
    imk_spectrum_band *fine, *coarse;
    imk_status fit_status; /**< IMK_OK: `fit` is valid */
    imk_spectrum_parameters fit;
    double *memory; /**< memory of the arrays above */
} imk_channel_spectrum;

/** Result of the job. */
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
 *  @return errors of imk_even_record_load(); IMK_ERROR_RANGE (error.field "confidence",
 *          "false_alarm", "from", "to" or "resolution");
 *          with a finding that says why: IMK_ERROR_CONSTANT, _TOO_SHORT, _GAP */
IMK_API imk_status imk_spectrum_log_run(const imk_record_source *source,
                                        const imk_spectrum_log_settings *settings,
                                        const imk_job *job, imk_spectrum_log **result,
                                        imk_error *error);
/** A band as it is shown: in the convention of the settings, and in the channel's plain unit
 *  (imk_channel_plain_unit()). */
IMK_API imk_spectrum_band imk_spectrum_log_band(const imk_spectrum_log *spectrum, size_t channel,
                                                const imk_spectrum_band *band);
/** Free it and all it holds; NULL is allowed. */
IMK_API void imk_spectrum_log_free(imk_spectrum_log *result);

IMK_END_C
#endif
