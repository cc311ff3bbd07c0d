/* SPDX-License-Identifier: Apache-2.0 */
/** @file identify_log.h
 *  The job of `imukit identify`: the noise of every channel of a stationary record, with confidence
 *  intervals.
 *
 *  The job loads the record, screens its samples (record_screen.h) and identifies them
 *  (identify.h). A record of more than IMK_IDENTIFY_RECORD_ADVISED rows is not held in memory but
 *  screened and identified in one pass (identify_record.h), if its source can be rewound and its
 *  samples are equally spaced. */
#ifndef IMUKIT_IDENTIFY_LOG_H
#define IMUKIT_IDENTIFY_LOG_H

#include "imukit/allan_log.h"
#include "imukit/even_record.h"
#include "imukit/identify.h"
#include "imukit/identify_joint.h"
#include "imukit/model.h"
#include "imukit/noise_map.h"
#include "imukit/record_screen.h"

IMK_BEGIN_C

/** Settings of the job. Start from imk_identify_log_default(). */
typedef struct imk_identify_log_settings {
    uint32_t cookie;
    imk_gap_policy gaps;  /**< treatment of missing samples; default IMK_GAPS_KEEP */
    double confidence;    /**< of intervals and bounds; default 0.95 */
    double significance;  /**< chance that an absent term is called present; default 0.01 */
    unsigned take_out;    /**< faults taken out, IMK_SCREEN_… bits; default IMK_SCREEN_ALL */
    bool from_allan;      /**< fit the terms to the Allan deviations; default false */
    double tolerance;     /**< see imk_allan_fit_settings; default 0 */
    int gauss_markov_max; /**< see imk_allan_fit_settings; default 0 */
    bool summarise;       /**< keep the summaries for a joint estimate; default false */
} imk_identify_log_settings;

/** 95 % intervals, terms at 1 % significance, gaps kept as gaps, all faults taken out. */
IMK_API imk_identify_log_settings imk_identify_log_default(void);

/** Origin of the figures. */
typedef enum imk_identify_origin {
    IMK_IDENTIFY_RECORD = 0,
    IMK_IDENTIFY_RECORDS, /**< several records together (identify_several.h): samples are not
                             described */
    IMK_IDENTIFY_CURVE    /**< a table of Allan deviations (identify_curve.h) */
} imk_identify_origin;

/** Result of the job; arrays are per channel of the record. */
typedef struct imk_identify_log {
    imk_identify_log_settings settings;
    imk_identify_origin origin;
    imk_even_record record; /**< the record; without samples if it was not held in memory */
    double duration;        /**< length of the record [s] */
    bool screened;          /**< true for one record: `screen` says what was found */
    imk_identification result[IMK_LOG_COLUMNS_MAX];
    imk_screen screen[IMK_LOG_COLUMNS_MAX];
    imk_spectral_summary *summary[IMK_LOG_COLUMNS_MAX]; /**< only with settings.summarise */
    imk_allan_curve curve[IMK_LOG_COLUMNS_MAX];         /**< Allan deviations at octaves */
    imk_noise_map *map[IMK_LOG_COLUMNS_MAX]; /**< noise over time; NULL: of several records, or of a
                                                curve */
    imk_noise_changes changes[IMK_LOG_COLUMNS_MAX]; /**< what these maps say */
    /** Per channel, of several records at several rates (identify_several.h); else NULL. */
    const imk_reading_parts *readings;
    imk_findings findings;
} imk_identify_log;

/** Identify every channel of a source.
 *  @param job     NULL: one thread, no progress, the memory of the C library
 *  @param result  free it with imk_identify_log_free(), also after a failure, because it then holds
 *                 the findings; NULL if there was no memory for it
 *  @return errors of imk_even_record_load(), imk_identify_channel() (error.field: the channel);
 *          with a finding that says why: IMK_ERROR_CONSTANT, _TOO_SHORT, _GAP (from_allan needs
 *          every sample) */
IMK_API imk_status imk_identify_log_run(const imk_record_source *source,
                                        const imk_identify_log_settings *settings,
                                        const imk_job *job, imk_identify_log **result,
                                        imk_error *error);
/** Free it and all it holds; NULL is allowed. */
IMK_API void imk_identify_log_free(imk_identify_log *result);

/** Make a model of the identified noise: noise, output filter and evidence only. Values are rounded
 *  to the digits that a model file shows.
 *  @param source  origin stated in the evidence, such as the name of the file */
IMK_API void imk_identify_log_model(const imk_identify_log *log, const char *source,
                                    imk_model *model);
/** Replace noise, output filter and evidence of a model by those of `noise`; everything else stays.
 *  @return IMK_ERROR_CONFLICT if the numbers of axes differ (error.field "gyro" or "accel",
 *          error.value axes of the model, error.limit axes of the noise); the model is then
 *          unchanged */
IMK_API imk_status imk_model_take_noise(imk_model *model, const imk_model *noise, imk_error *error);

/** Simulate a noise model over the length of the record and compute the Allan deviations of the
 *  simulation: those of the record should look like them if the model describes it fully.
 *  @param curves  one per channel of the record; free each with imk_allan_curve_free() */
IMK_API imk_status imk_identify_log_twin(const imk_identify_log *log, const imk_model *noise,
                                         uint64_t seed, const imk_job *job, imk_allan_curve *curves,
                                         imk_error *error);

/** Names of a noise term of a channel, and the units of its strength. */
typedef struct imk_term_display {
    char key[40];    /**< as in the model file */
    char name[40];   /**< in words: "angle random walk" */
    imk_unit unit;   /**< unit that a person reads */
    char si[40];     /**< unit of the SI value */
    double si_scale; /**< a strength divided by it is in that unit */
} imk_term_display;
/** Names and units of a noise term for the kind of sensor of the column. */
IMK_API imk_term_display imk_channel_term(const imk_log_column *column, imk_noise_term term);
/** The same of a term that was identified: what was not counted (imk_identification_counted()) has
 *  the name of white noise of the integral, and unit.scale and si_scale lead from the strength Q of
 *  its readings to A = Q sqrt(dt). */
IMK_API imk_term_display imk_identified_term(const imk_log_column *column,
                                             const imk_identification *result, imk_noise_term term);
/** The names and units of white noise of the integral A, of samples dt apart; as above. */
IMK_API imk_term_display imk_channel_angle_white(const imk_log_column *column, double dt);
/** The names and units of reading noise. */
IMK_API imk_term_display imk_channel_reading_noise(const imk_log_column *column);

/** Where the sensor was moved, on any channel; times from the first row that was read [s]. */
typedef struct imk_identify_moves {
    bool moved;
    double first, end;             /**< of the movements: the first begins, the last one ends */
    double still_first, still_end; /**< longest part without, to 0.1 s inwards */
} imk_identify_moves;
/** The movements that the screening of the channels found. */
IMK_API imk_identify_moves imk_identify_log_moves(const imk_identify_log *log);

/** Free the samples, which take most of the memory; the results stay. */
IMK_API void imk_identify_log_let_samples_go(imk_identify_log *result);

IMK_END_C
#endif
