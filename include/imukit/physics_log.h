/* SPDX-License-Identifier: Apache-2.0 */
/** @file physics_log.h
 *  The jobs of `imukit physics`: an instrument from first principles (instrument.h) run into a
 *  record, looked into, and measured as in a laboratory. */
#ifndef IMUKIT_PHYSICS_LOG_H
#define IMUKIT_PHYSICS_LOG_H

#include "imukit/distort.h"
#include "imukit/job.h"
#include "imukit/laboratory.h"
#include "imukit/record.h"

IMK_BEGIN_C

/** What the instrument is exposed to, against time. */
typedef struct imk_physics_input {
    imk_exposure exposure;   /**< angular rate and specific force: the amplitudes of a sine */
    double frequency;        /**< [Hz] of the sine; 0: none, they are steady */
    double temperature_rate; /**< [K/s] */
} imk_physics_input;

/** Exposure of sample `index` at this rate, the mean over it. */
IMK_API imk_exposure imk_physics_input_at(const imk_physics_input *input, double rate,
                                          uint64_t index);

/** An instrument, and what is done with it. Start from imk_physics_log_default(). */
typedef struct imk_physics_log_settings {
    uint32_t cookie;
    const imk_instrument *instrument;
    const void *design;
    imk_physics_settings physics; /**< its rate is that of the rows */
    imk_physics_input input;
    double duration;                 /**< [s] */
    double signal_rate;              /**< of the rows of signals [Hz]; 0: that of the others */
    double view_duration, view_rate; /**< of views [s], [Hz]; 0: their own */
    bool view_input;                 /**< views are of this input; false: of their own */
} imk_physics_log_settings;

/** At rest at 20 degrees, 100 Hz. */
IMK_API imk_physics_log_settings imk_physics_log_default(void);
/** Rows of so many hertz in the duration. */
IMK_API uint64_t imk_physics_rows(const imk_physics_log_settings *settings, double rate);

enum { IMK_PHYSICS_CURVE_POINTS = 4000 };

/** A run: statistics of the outputs, and means for a picture. */
typedef struct imk_physics_log {
    imk_physics_log_settings settings;
    imk_model model;          /**< reduced, one axis */
    uint64_t samples, stride; /**< samples to a point of the picture */
    double mean[IMK_INSTRUMENT_OUTPUTS_MAX];
    double deviation[IMK_INSTRUMENT_OUTPUTS_MAX]; /**< NaN: of one sample */
    double last[IMK_INSTRUMENT_OUTPUTS_MAX]; /**< at the end: mean of the last 1 % of the samples */
    size_t points;
    double *time; /**< [s]; IMK_PHYSICS_CURVE_POINTS + 1, as all of these */
    double *curve[IMK_INSTRUMENT_OUTPUTS_MAX]; /**< in imk_physics_output_unit() */
    double *input;                             /**< in that of output 0 */
    imk_findings findings;
    imk_allocator allocator; /**< allocator of this structure */
} imk_physics_log;

/** Run an instrument for the duration. Row k is at the time (k + 1)/rate: the end of the sample
 *  whose mean it is. Signals of another rate have a run of their own.
 *  @param outputs,signals  where rows go; NULL: nowhere
 *  @param job              NULL: one thread, no progress, the memory of the C library
 *  @param result           free it with imk_physics_log_free(), also after a failure, because it
 *                          then holds the findings; NULL if there was no memory for it
 *  @return what the instrument's init returns; IMK_ERROR_MEMORY, _CANCELLED, _RANGE (error.field
 *          "duration": no sample fits); with a finding that says why: IMK_ERROR_NOT_FINITE
 *          ("output_not_finite") and what the sinks return ("not_written") */
IMK_API imk_status imk_physics_log_run(const imk_physics_log_settings *settings,
                                       const imk_record_sink *outputs,
                                       const imk_record_sink *signals, const imk_job *job,
                                       imk_physics_log **result, imk_error *error);
/** Free it and all it holds; NULL is allowed. */
IMK_API void imk_physics_log_free(imk_physics_log *result);

/** Unit to show an output in: of the measured input, by its size. */
IMK_API imk_unit imk_physics_output_unit(const imk_physics_log *log, size_t output);

enum { IMK_PHYSICS_LABEL = 128 };

/** A view of an instrument (imk_view), run. */
typedef struct imk_physics_view {
    imk_view view; /**< with the duration and rate that were asked for */
    const imk_instrument *instrument;
    size_t points;
    double *data; /**< x, then each curve, in the units of their labels */
    bool empty;   /**< it shows what this design has not, such as the bits of an open loop */
    char x_label[IMK_PHYSICS_LABEL], y_label[IMK_PHYSICS_LABEL], clock[80];
    imk_allocator allocator; /**< of the data */
} imk_physics_view;

/** Run the instrument as its view number `index` says.
 *  @param view  free it with imk_physics_view_free(), also after a failure
 *  @return what the instrument's init returns; IMK_ERROR_MEMORY, _RANGE (error.field "view": too
 *          few points, or too many) */
IMK_API imk_status imk_physics_view_run(const imk_physics_log_settings *settings, size_t index,
                                        const imk_job *job, imk_physics_view *view,
                                        imk_error *error);
/** Free its data. */
IMK_API void imk_physics_view_free(imk_physics_view *view);
/** The view of this number from 1, or whose title begins so; -1: none. */
IMK_API int imk_physics_view_find(const imk_instrument *instrument, const char *text);
/** Whether it shows one signal against another, which can move. */
IMK_API bool imk_physics_view_moves(const imk_view *view);

/** Closed forms beside what a laboratory found. */
typedef struct imk_physics_sweep {
    imk_laboratory_result result;
    size_t count;
    imk_laboratory_figure computed[IMK_LABORATORY_FIGURES_MAX], found[IMK_LABORATORY_FIGURES_MAX];
    imk_allocator allocator; /**< allocator of this structure */
} imk_physics_sweep;

/** Find the error model by experiments (laboratory.h), in the settings' surroundings.
 *  @param sweep  free it with imk_physics_sweep_free(); NULL after a failure
 *  @return as imk_laboratory_run(); IMK_ERROR_MEMORY */
IMK_API imk_status imk_physics_sweep_run(const imk_physics_log_settings *settings,
                                         const imk_job *job, imk_physics_sweep **sweep,
                                         imk_error *error);
/** Free it and all it holds; NULL is allowed. */
IMK_API void imk_physics_sweep_free(imk_physics_sweep *sweep);
/** Figure `index`: "agrees", "close", "differs", "not measured". A figure agrees when the
 * difference is within four 1-sigma values, and is close within the tenth of it that the closed
 * forms may leave out: small terms of higher order. */
IMK_API const char *imk_physics_sweep_verdict(const imk_physics_sweep *sweep, size_t index);

/** Put the numbers of an error that a validate or init filled in SI into the unit of the field it
 *  names, for the message: `"30 kHz" is outside its valid range (limit 10 kHz)`. Fields that are
 *  not of the table, and values that do not stand in the design, are left as they are.
 *  @param design  what was refused */
IMK_API void imk_design_error_in_units(const imk_instrument *instrument, const void *design,
                                       imk_error *error);

/** A field of the table as text with its unit ("400 Hz", "closed", "yes"), at most `digits`
 *  significant digits, or 0 for as many as give the same bits.
 *  @return length, 0 when `size` is too small */
IMK_API size_t imk_design_field_text(const imk_design_field *field, const void *design, int digits,
                                     char *text, size_t size);

IMK_END_C
#endif
