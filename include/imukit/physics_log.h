/* SPDX-License-Identifier: Apache-2.0 */
/** @file physics_log.h
 *  The jobs of `imukit physics`: they simulate an instrument from first principles (instrument.h)
 *  into a record, show its inner signals, and measure it as in a laboratory. */
#ifndef IMUKIT_PHYSICS_LOG_H
#define IMUKIT_PHYSICS_LOG_H

#include "imukit/distort.h"
#include "imukit/job.h"
#include "imukit/laboratory.h"
#include "imukit/record.h"

IMK_BEGIN_C

/** Exposure of the instrument as a function of time. */
typedef struct imk_physics_input {
    /** With a frequency, angular rate and specific force are amplitudes of a sine. */
    imk_exposure exposure;
    double frequency;        /**< frequency of the sine [Hz]; 0: rate and force are constant */
    double temperature_rate; /**< [K/s] */
} imk_physics_input;

/** Exposure of the instrument in sample `index`, as the mean over the sample.
 *  @param rate  sampling rate [Hz] */
IMK_API imk_exposure imk_physics_input_at(const imk_physics_input *input, double rate,
                                          uint64_t index);

/** Internal steps of each second of a run (of one second at least): a design that needs more is
 *  refused before it runs, because it would hardly end. */
#define IMK_PHYSICS_STEPS 1e7
/** Internal steps of a view of the length that it states itself. */
#define IMK_PHYSICS_VIEW_STEPS 3e6
/** Internal steps of any run. */
#define IMK_PHYSICS_STEPS_MAX 1e12

/** An instrument, and the settings of its jobs. Start from imk_physics_log_default(). */
typedef struct imk_physics_log_settings {
    uint32_t cookie;
    const imk_instrument *instrument;
    const void *design;
    imk_physics_settings physics; /**< physics.rate is the rate of the rows */
    imk_physics_input input;
    double duration;    /**< length of the run [s]; of a sweep the simulated time that one of its
                             experiments may take, 0: as the laboratory chooses */
    double signal_rate; /**< rate of the rows of signals [Hz]; 0: as the rows of outputs */
    /** Length and sampling rate of views [s], [Hz]; 0: as each view states. */
    double view_duration, view_rate;
    bool quick;      /**< a sweep does what is long at the slow level, if there is one; true */
    bool view_input; /**< true: views use `input`, and gyros also the force that the view states if
                        `input` has none; false: the input that each view states */
} imk_physics_log_settings;

/** Check the input: angular rates and specific forces up to 1e6 [rad/s], [m/s^2]; temperatures
 *  above 0 and up to 1e4 [K], also at the end of `duration`; a sine with at least four samples a
 *  cycle. The jobs do so.
 *  @return IMK_ERROR_RANGE with the field "angular_rate", "specific_force", "frequency",
 *          "temperature" or "temperature_rate" */
IMK_API imk_status imk_physics_input_check(const imk_physics_log_settings *settings,
                                           imk_error *error);
/** At rest at 20 degC, 100 Hz. Instrument, design and duration must be set. */
IMK_API imk_physics_log_settings imk_physics_log_default(void);
/** Number of rows in settings->duration at a rate [Hz]. */
IMK_API uint64_t imk_physics_rows(const imk_physics_log_settings *settings, double rate);

enum { IMK_PHYSICS_CURVE_POINTS = 4000 };

/** Result of a run: statistics of the outputs, and means for a figure. */
typedef struct imk_physics_log {
    imk_physics_log_settings settings;
    imk_model model;          /**< error model of the design, one axis */
    uint64_t samples, stride; /**< number of samples; samples per point of the figure */
    double mean[IMK_INSTRUMENT_OUTPUTS_MAX];
    double deviation[IMK_INSTRUMENT_OUTPUTS_MAX]; /**< standard deviation; NaN for one sample */
    double last[IMK_INSTRUMENT_OUTPUTS_MAX];      /**< mean of the last 1 % of the samples */
    size_t points;
    double *time; /**< of each point [s]; this and the next two hold IMK_PHYSICS_CURVE_POINTS + 1
                     values */
    double *curve[IMK_INSTRUMENT_OUTPUTS_MAX]; /**< mean of the samples of each point, in
                                                  imk_physics_output_unit() */
    /** Least and greatest of these samples. */
    double *least[IMK_INSTRUMENT_OUTPUTS_MAX], *greatest[IMK_INSTRUMENT_OUTPUTS_MAX];
    double *input; /**< in the unit of output 0 */
    imk_findings findings;
    imk_allocator allocator; /**< allocator of this structure */
} imk_physics_log;

/** Run an instrument for the duration. Row k is the mean over a sample that ends at its time (k +
 *  1)/rate. Signals at another rate are simulated in a second run.
 *  @param outputs,signals  receive the rows of outputs and of signals; NULL: not wanted
 *  @param job              NULL: one thread, no progress, the memory of the C library
 *  @param result           free it with imk_physics_log_free(), also after a failure, because it
 *                          then holds the findings; NULL if there was no memory for it
 *  @return errors of the instrument's init, of which IMK_ERROR_CONFLICT (error.field "duration")
 *          is a run of too many steps; IMK_ERROR_MEMORY, _CANCELLED, _RANGE (error.field
 *          "duration": no sample fits); with a finding that says why: IMK_ERROR_NOT_FINITE
 *          ("output_not_finite") and errors of the sinks ("not_written") */
IMK_API imk_status imk_physics_log_run(const imk_physics_log_settings *settings,
                                       const imk_record_sink *outputs,
                                       const imk_record_sink *signals, const imk_job *job,
                                       imk_physics_log **result, imk_error *error);
/** Free it and all it holds; NULL is allowed. */
IMK_API void imk_physics_log_free(imk_physics_log *result);

/** Unit in which a person reads an output: a unit of the measured input, chosen by the size of the
 *  output. */
IMK_API imk_unit imk_physics_output_unit(const imk_physics_log *log, size_t output);

enum { IMK_PHYSICS_LABEL = 128 };

/** A view of an instrument (imk_view) with its data. */
typedef struct imk_physics_view {
    imk_view view; /**< the view with the duration and rate used */
    const imk_instrument *instrument;
    size_t points;
    double *data; /**< `points` values of x, then of each curve, in the units of the labels. Against
                     time, two points are the least and the greatest value of a stretch where there
                     are more samples than points */
    size_t law_points; /**< as many values of x and then of the view's law follow in `data` */
    bool empty;        /**< the design has nothing to show here, such as the bits of an open loop */
    char x_label[IMK_PHYSICS_LABEL], y_label[IMK_PHYSICS_LABEL], clock[80];
    imk_allocator allocator; /**< allocator of the data */
} imk_physics_view;

/** Run the instrument as its view `index` (from 0) states.
 *  @param view  free it with imk_physics_view_free(), also after a failure
 *  @return errors of the instrument's init; IMK_ERROR_MEMORY, _RANGE (error.field "view": too few
 *          points, or too many) */
IMK_API imk_status imk_physics_view_run(const imk_physics_log_settings *settings, size_t index,
                                        const imk_job *job, imk_physics_view *view,
                                        imk_error *error);
/** Free its data. */
IMK_API void imk_physics_view_free(imk_physics_view *view);
/** Find a view by its number (from 1) or by the beginning of its title. @return index from 0; -1:
 *  no such view */
IMK_API int imk_physics_view_find(const imk_instrument *instrument, const char *text);
/** True when a view shows one signal against another, which can be animated. */
IMK_API bool imk_physics_view_moves(const imk_view *view);

/** Error model by closed forms beside the one that experiments found. */
typedef struct imk_physics_sweep {
    imk_laboratory_result result;
    size_t count;
    /** Figures by closed forms, and by experiments. */
    imk_laboratory_figure computed[IMK_LABORATORY_FIGURES_MAX], found[IMK_LABORATORY_FIGURES_MAX];
    imk_laboratory_verdict verdict[IMK_LABORATORY_FIGURES_MAX];
    double gain_bandwidth, gain_damping; /**< of the response by the closed forms [Hz], [1] */
    imk_findings findings; /**< what happens in the instrument at 1 g and is in no closed form: then
                              there is no tumble */
    imk_allocator allocator; /**< allocator of this structure */
} imk_physics_sweep;

/** Find the error model by experiments (laboratory.h), at the reference temperature of the error
 *  model. The input of the settings is not used, except for its temperature where the error model
 *  does not depend on it.
 *  @param sweep  free it with imk_physics_sweep_free(); NULL after a failure
 *  @return errors of imk_laboratory_run(); IMK_ERROR_MEMORY */
IMK_API imk_status imk_physics_sweep_run(const imk_physics_log_settings *settings,
                                         const imk_job *job, imk_physics_sweep **sweep,
                                         imk_error *error);
/** Free it and all it holds; NULL is allowed. */
IMK_API void imk_physics_sweep_free(imk_physics_sweep *sweep);
/** Verdict on figure `index` in words: "agrees", "cannot tell: needs 3 h", "cannot tell: higher
 *  orders of the input".
 *  @param size  of `text` [bytes]; 100 are enough
 *  @return text */
IMK_API const char *imk_physics_sweep_verdict(const imk_physics_sweep *sweep, size_t index,
                                              char *text, size_t size);

/** Convert the numbers of an error of a validate or init function from SI to the unit of the field
 *  that the error names, for the message: `"30 kHz" is outside its valid range (limit 10 kHz)`.
 *  Also "step" and "rate" of the settings. Fields that are not in the table, and values that are
 *  not in the design, stay as they are.
 *  @param design  the design that was refused */
IMK_API void imk_design_error_in_units(const imk_instrument *instrument, const void *design,
                                       imk_error *error);

/** Write the value of a design field as text with its unit: "400 Hz", "closed", "yes".
 *  @param digits  largest number of significant digits; 0: as many as give the same bits
 *  @return length, 0 when `size` is too small */
IMK_API size_t imk_design_field_text(const imk_design_field *field, const void *design, int digits,
                                     char *text, size_t size);

IMK_END_C
#endif
