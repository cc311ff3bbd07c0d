/* SPDX-License-Identifier: Apache-2.0 */
/** @file identify_log.h
 *  The job of `imukit identify`: the noise of every channel of a record at rest, with intervals.
 *
 *  A record is loaded and its samples are screened (record_screen.h) and identified (identify.h);
 *  one of more than IMK_IDENTIFY_RECORD_ADVISED rows, from a source that can be rewound, is
 *  identified in one pass without being held (identify_record.h), unless it is not even. */
#ifndef IMUKIT_IDENTIFY_LOG_H
#define IMUKIT_IDENTIFY_LOG_H

#include "imukit/allan_log.h"
#include "imukit/even_record.h"
#include "imukit/identify.h"
#include "imukit/identify_joint.h"
#include "imukit/model.h"
#include "imukit/record_screen.h"

IMK_BEGIN_C

/** Settings of the job. Start from imk_identify_log_default(). */
typedef struct imk_identify_log_settings {
    uint32_t cookie;
    imk_gap_policy gaps; /**< IMK_GAPS_KEEP */
    double confidence;   /**< of intervals and bounds; default 0.95 */
    double
        significance;  /**< chance that a term which is not there is called present; default 0.01 */
    unsigned take_out; /**< IMK_SCREEN_… bits; default IMK_SCREEN_ALL */
    bool from_allan;  /**< terms by generalised least squares on the Allan deviations; default false
                       */
    double tolerance; /**< as of imk_allan_fit_settings; default 0 */
    int gauss_markov_max; /**< the same; default 0 */
    bool summarise;       /**< keep what a joint estimate needs; default false */
} imk_identify_log_settings;

/** 95 % intervals, terms at 1 % significance, missing samples kept, all faults taken out. */
IMK_API imk_identify_log_settings imk_identify_log_default(void);

/** What the figures are of. */
typedef enum imk_identify_origin {
    IMK_IDENTIFY_RECORD = 0,
    IMK_IDENTIFY_RECORDS, /**< several together (identify_several.h): nothing about samples */
    IMK_IDENTIFY_CURVE    /**< a table of Allan deviations (identify_curve.h) */
} imk_identify_origin;

/** What was found. */
typedef struct imk_identify_log {
    imk_identify_log_settings settings;
    imk_identify_origin origin;
    imk_even_record record; /**< without samples where the record was never held */
    double duration;        /**< [s] recorded */
    bool screened;          /**< a record that was never held is not */
    imk_identification result[IMK_LOG_COLUMNS_MAX];
    imk_screen screen[IMK_LOG_COLUMNS_MAX];
    imk_spectral_summary *summary[IMK_LOG_COLUMNS_MAX]; /**< with `summarise` */
    imk_allan_curve curve[IMK_LOG_COLUMNS_MAX];         /**< over octaves */
    imk_findings findings;
} imk_identify_log;

/** Identify every channel of a source.
 *  @param job     NULL: one thread, no progress, the memory of the C library
 *  @param result  free it with imk_identify_log_free(), also after a failure, because it then holds
 *                 the findings; NULL if there was no memory for it
 *  @return as imk_even_record_load(), imk_identify_channel() (error.field: the channel); with a
 *          finding that says why: IMK_ERROR_CONSTANT, _TOO_SHORT, _GAP (from_allan needs every
 *          sample) */
IMK_API imk_status imk_identify_log_run(const imk_record_source *source,
                                        const imk_identify_log_settings *settings,
                                        const imk_job *job, imk_identify_log **result,
                                        imk_error *error);
/** Free it and all it holds; NULL is allowed. */
IMK_API void imk_identify_log_free(imk_identify_log *result);

/** Noise model of what was identified: nothing but noise, output filter and evidence, rounded
 *  to the digits the values have in the units of a model file.
 *  @param source  what the evidence says it is from, such as the name of the file */
IMK_API void imk_identify_log_model(const imk_identify_log *log, const char *source,
                                    imk_model *model);
/** Replace noise, output filter and evidence of a model by those of another, and nothing else.
 *  @return IMK_ERROR_CONFLICT: another number of axes (error.field "gyro" or "accel", error.value
 *          those of the model, error.limit those of the noise); the model stays as it is */
IMK_API imk_status imk_model_take_noise(imk_model *model, const imk_model *noise, imk_error *error);

/** Simulate a noise model over the length of the record and take the Allan deviations of it: what
 *  the deviations of the record would be if the model were the whole truth.
 *  @param curves  one per channel of the record; imk_allan_curve_free() them */
IMK_API imk_status imk_identify_log_twin(const imk_identify_log *log, const imk_model *noise,
                                         uint64_t seed, const imk_job *job, imk_allan_curve *curves,
                                         imk_error *error);

/** How a noise term of a channel is called, and the units of its strength. */
typedef struct imk_term_display {
    char key[40];  /**< as in the model file */
    char name[40]; /**< as people say it */
    imk_unit unit; /**< readable */
    char si[40];   /**< unit of the SI value */
} imk_term_display;
/** By the kind of the column. */
IMK_API imk_term_display imk_channel_term(const imk_log_column *column, imk_noise_term term);

/** Let the samples go, which are the bulk of the memory. */
IMK_API void imk_identify_log_let_samples_go(imk_identify_log *result);

IMK_END_C
#endif
