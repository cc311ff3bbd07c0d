/* SPDX-License-Identifier: Apache-2.0 */
/** @file instrument.h
 *  Instruments from first principles: the physics of the parts of a gyro or an accelerometer, from
 *  design parameters to readings.
 *
 *  Each instrument has a header of its own (ring_laser.h, fibre_optic.h, …) with a design struct,
 *  its `_default()`, `_validate()`, `_reduce()` and the closed forms that a designer computes by
 *  hand; and a description, imk_instrument, through which all instruments are run in the same way:
 *
 *      const imk_instrument *instrument = imk_instrument_find("ring_laser");
 *      instrument->set_default(design);              // design_size bytes
 *      imk_instrument_init(instrument, design, &settings, state, &error);  // state_size bytes
 *      instrument->step(state, &exposure, outputs);  // as often as samples are wanted
 *
 *  Three levels describe the same instrument: the full dynamics (every carrier cycle, transit of
 *  light, beat of the laser), a slow map or envelope of it, and the error model of model.h that
 *  `reduce` computes. Each is tested against the one before.
 *
 *  The same design, settings and exposures give the same bits on every machine: only + - * / sqrt
 *  and the functions of elementary.h are used, and random numbers by stream (term
 *  IMK_TERM_PHYSICS). */
#ifndef IMUKIT_INSTRUMENT_H
#define IMUKIT_INSTRUMENT_H

#include "imukit/model.h"
#include "imukit/random.h"

IMK_BEGIN_C

enum { IMK_INSTRUMENT_OUTPUTS_MAX = 8, IMK_INSTRUMENT_SIGNALS_MAX = 16, IMK_VIEW_CURVES_MAX = 4 };

/** Motion and temperature of an instrument, in the axes of its case: x is the input axis of a
 *  single-axis instrument; each header names y and z. It is constant over a step. A step does not
 *  check the ranges: beyond them the readings are meaningless, but a step takes no longer. */
typedef struct imk_exposure {
    double angular_rate[3];         /**< of the case in inertial space, up to 1e6 [rad/s] */
    double angular_acceleration[3]; /**< [rad/s^2] */
    double specific_force[3];       /**< up to 1e6 [m/s^2] */
    double temperature;             /**< above 0, up to 1e4 [K] */
    double temperature_rate;        /**< [K/s] */
} imk_exposure;

/** No motion, no force, 293.15 K. */
IMK_API imk_exposure imk_exposure_default(void);

/** Level of detail of the simulation. */
typedef enum imk_level {
    IMK_LEVEL_FULL = 0, /**< the dynamics of its parts, cycle by cycle */
    IMK_LEVEL_SLOW = 1  /**< a map or envelope that leaves the fast part out */
} imk_level;

/** How to run an instrument. Start from imk_physics_default(), then change fields. */
typedef struct imk_physics_settings {
    uint32_t cookie;
    imk_level level;
    double rate; /**< samples per second [Hz], > 0: a step of the interface is 1/rate */
    double step; /**< internal step [s], shortened to a whole fraction of 1/rate; 0 (default): the
                    longest with the instrument's stated accuracy. A step that would give wrong
                    results is refused */
    double duration;  /**< length of the run that is to come [s]; 0 (default): not known */
    double turning;   /**< largest angular rate in it, the sum of the axes [rad/s]; 0 (default): not
                         known. Of the instruments whose steps are divided when the case turns fast
                         (free_gyro) it counts for steps_max */
    double steps_max; /**< a run of this duration that needs more internal steps is refused by
                         imk_instrument_init() (field "duration"); 0 (default): any number may be.
                         A step takes 10 to 400 ns */
    bool noise; /**< false: no random effects, including the constants of the run; default true */
    uint64_t seed;
    uint32_t run; /**< run number: each run is another random draw of the same instrument */
    uint8_t axis; /**< number of one of several identical instruments, 0 … 255: each has its own
                     draws */
    uint8_t occasion; /**< number of an occasion in one run, 0 … 255: each has other noise, but the
                         constants of the run */
} imk_physics_settings;

/** 100 Hz, full dynamics, noise, seed 0. */
IMK_API imk_physics_settings imk_physics_default(void);

/* ---- design files ---------------------------------------------------------------------------- */

typedef enum imk_design_kind {
    IMK_DESIGN_NUMBER = 0, /**< a double with a unit */
    IMK_DESIGN_COUNT,      /**< a whole number: int */
    IMK_DESIGN_CHOICE,     /**< one of the words of `choices`: int, or an enum counting from 0 */
    IMK_DESIGN_SWITCH      /**< yes or no: bool */
} imk_design_kind;

/** One parameter of a design: its place in the file and in the structure, and its valid values.
 *  Reading, writing, checking and help all use the table of these fields. */
typedef struct imk_design_field {
    const char *path; /**< dotted: "dither.frequency" */
    imk_design_kind kind;
    size_t offset;
    const char *unit; /**< unit in which it is written, which also states the dimension; "1" for
                         pure numbers */
    double minimum, maximum; /**< valid range, in SI; also for counts */
    bool open;               /**< the minimum itself is excluded */
    const char *choices;     /**< "open|closed" */
    const char *help;        /**< one line: "peak rate of the dither" */
} imk_design_field;

/* ---- signals --------------------------------------------------------------------------------- */

/** An output of an instrument, or an internal signal. */
typedef struct imk_signal {
    const char *name; /**< "operating_point" */
    const char *si;   /**< SI unit of the value: "rad/s" */
    const char *unit; /**< unit in which it is shown: "deg/h" */
    const char *help;
} imk_signal;

/** A figure of an instrument: signals against time or against each other. */
typedef struct imk_view {
    const char *title, *caption;
    int x; /**< signal on the horizontal axis; -1: time */
    int curve_count;
    int y[IMK_VIEW_CURVES_MAX]; /**< signals on the vertical axis, all of one unit */
    double duration;            /**< [s] */
    double rate;                /**< sampling rate of the figure [Hz] */
    double settle;              /**< time simulated before the figure begins [s] */
    /** Default input of the figure: rate [rad/s] or specific force [m/s^2] along x. */
    double input;
    double force;   /**< default specific force along x of the figure of a gyro [m/s^2] */
    bool points;    /**< drawn as separate points, because the signals jump */
    bool less_ramp; /**< against time: without the straight line from the first point to the last,
                       which the input makes */
    /** Closed form of the curve, drawn behind it, in SI units; NULL: none. */
    double (*law)(const void *design, double x);
    const char *law_name; /**< "fringe" */
} imk_view;

/* ---- derived quantities ---------------------------------------------------------------------- */

/** A quantity that follows from the parts of a design by an equation, without the errors of the
 *  electronics: what a designer computes first. */
typedef struct imk_derived {
    const char *name;     /**< as textbooks call it: "nutation frequency" */
    const char *symbol;   /**< left side of the equation: "f_n" */
    const char *si;       /**< SI unit of the value: "Hz" */
    const char *unit;     /**< unit in which it is shown */
    const char *equation; /**< in the letters of the instrument's header: "f_n = H/(2 pi …)" */
    const char *source;   /**< citation of docs/references.md: "[ARNOLD1961]" */
    /** Value in SI for a valid design; NaN or infinite: this design has none. */
    double (*value)(const void *design);
    const char *absent; /**< why a design has none, "no loop holds the float"; NULL: all have one */
} imk_derived;

/** What happened in a run that its readings do not say by themselves. */
typedef struct imk_instrument_event {
    const char *code; /**< of the message: a finding of job.h */
    const char *name; /**< a word of the message */
    size_t count;     /**< numbers of the message */
    double number[6];
} imk_instrument_event;

/* ---- the interface --------------------------------------------------------------------------- */

/** A kind of instrument. */
typedef struct imk_instrument {
    const char *name;       /**< name in design files: "ring_laser" */
    const char *title;      /**< "ring laser gyro" */
    const char *technology; /**< name in the table of grades: "RLG" */
    const char *source;     /**< where the default design's figures come from */
    int sensor;             /**< IMK_GYRO or IMK_ACCEL */
    uint32_t cookie;        /**< value of the first member of a valid design */
    size_t design_size, state_size;
    size_t field_count;
    const imk_design_field *fields;
    size_t output_count; /**< 1 … IMK_INSTRUMENT_OUTPUTS_MAX. Output 0 is the measured input:
                            [rad/s] or [m/s^2], the mean over the step */
    const imk_signal *outputs;
    size_t signal_count; /**< internal signals, 0 … IMK_INSTRUMENT_SIGNALS_MAX */
    const imk_signal *signals;
    size_t view_count;
    const imk_view *views;
    const imk_derived *derived; /**< its last row has no name (NULL) */

    /** A realistic design, cookie included. */
    void (*set_default)(void *design);
    /** Called by imk_design_check() for a design whose fields are in their ranges: checks that the
     *  design is possible as a whole. NULL: it always is.
     *  @return IMK_ERROR_RANGE, _CONFLICT; error.field the path */
    imk_status (*check)(const void *design, imk_error *error);
    /** Called by imk_instrument_init() with valid design and settings and a state of zeros.
     *  @return IMK_ERROR_RANGE, _UNSUPPORTED */
    imk_status (*init)(const void *design, const imk_physics_settings *settings, void *state,
                       imk_error *error);
    /** Advance by 1/rate under a constant exposure. */
    void (*step)(void *state, const imk_exposure *exposure, double *outputs);
    /** Get the present internal signals. */
    void (*observe)(const void *state, double *signals);
    /** Get what happened since the start. NULL: nothing ever does. @return false: nothing did */
    bool (*happened)(const void *state, imk_instrument_event *event);
    /** Called by imk_instrument_reduce() with a triad of one axis along x without errors, to fill
     *  in the errors. */
    void (*reduce)(const void *design, imk_triad *triad);
    /** Internal step for settings.step 0 [s]; the design must be valid. */
    double (*step_length)(const void *design, const imk_physics_settings *settings);
} imk_instrument;

/** Number of kinds of instruments. */
IMK_API size_t imk_instrument_count(void);
/** Kind `index`; NULL beyond the end. */
IMK_API const imk_instrument *imk_instrument_get(size_t index);
/** Kind by name ("ring_laser", case, blanks, - and _ ignored); NULL when there is none. */
IMK_API const imk_instrument *imk_instrument_find(const char *name);

/** Derived quantity by name ("nutation frequency") or symbol ("f_n"); NULL when there is none. */
IMK_API const imk_derived *imk_instrument_derived(const imk_instrument *instrument,
                                                  const char *name);
/** Value of a derived quantity in SI, NaN when this design has none (derived->absent says why). The
 *  design must be valid. */
IMK_API double imk_derived_value(const imk_derived *derived, const void *design);

/** Check that a design belongs to this instrument, that every field is finite and in its range,
 *  that the design is possible as a whole, and that every number of its error model
 *  (imk_instrument_reduce()) is finite. If one is not, error.field is the parameter that makes the
 *  difference to the default design.
 *  @return IMK_ERROR_UNINITIALISED, _NOT_FINITE, _RANGE, _CONFLICT; error.field the path */
IMK_API imk_status imk_design_check(const imk_instrument *instrument, const void *design,
                                    imk_error *error);

/** Check design and settings, and start the instrument in its state at power-on.
 *  @param state  state_size bytes, 64-byte aligned; plain data that may be copied; of no use after
 *                an error
 *  @return errors of imk_design_check(); IMK_ERROR_RANGE for a step (field "step") or rate that
 *          would give wrong results; IMK_ERROR_UNSUPPORTED for a level that the instrument does not
 *          have; IMK_ERROR_CONFLICT (field "duration") for a run of too many steps */
IMK_API imk_status imk_instrument_init(const imk_instrument *instrument, const void *design,
                                       const imk_physics_settings *settings, void *state,
                                       imk_error *error);

/** The error model of one instrument by closed forms: one axis, direction x, case axes as body
 *  axes. The design must be valid. Fills the whole model. */
IMK_API void imk_instrument_reduce(const imk_instrument *instrument, const void *design,
                                   imk_model *model);

/** Change a model of one axis, from imk_instrument_reduce(), into a model of three such instruments
 *  along body x, y and z. The case axes y and z of each are the next body axes in cyclic order.
 *  Evidence is kept for axis x only. */
IMK_API void imk_model_three_axes(imk_model *model);

IMK_END_C
#endif
