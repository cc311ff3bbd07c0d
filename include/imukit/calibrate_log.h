/* SPDX-License-Identifier: Apache-2.0 */
/** @file calibrate_log.h
 *  The job of `imukit calibrate`: logs of bench tests, each of a procedure, and what they say of
 *  the unit together. */
#ifndef IMUKIT_CALIBRATE_LOG_H
#define IMUKIT_CALIBRATE_LOG_H

#include "imukit/calibration_plan.h"
#include "imukit/earth.h"
#include "imukit/ferraris.h"
#include "imukit/job.h"
#include "imukit/magnetometer.h"
#include "imukit/motion.h"
#include "imukit/procedure.h"
#include "imukit/record.h"
#include "imukit/reference_alignment.h"
#include "imukit/repeatability.h"
#include "imukit/thermal.h"

IMK_BEGIN_C

enum {
    IMK_CALIBRATE_DIAGNOSTICS_MAX = 16,
    IMK_CALIBRATE_LOST_MAX = 8,
    IMK_CALIBRATE_REFERENCES = 9,
    IMK_CALIBRATE_POSES = 3
};

/** Numbers of a sensor's axes from a data sheet. */
typedef struct imk_calibrate_counts {
    int count; /**< 0: not given, 1: one number for all axes, else one for each axis */
    double value[IMK_AXES_MAX];
} imk_calibrate_counts;

/** Terms that procedures look for or leave alone, as bits. */
enum {
    IMK_CALIBRATE_NONLINEARITY = 1,
    IMK_CALIBRATE_CROSS_PRODUCTS = 2,
    IMK_CALIBRATE_G_SENSITIVITY = 4,
    IMK_CALIBRATE_G2_SENSITIVITY = 8,
    IMK_CALIBRATE_GYRO_TURNS = 16
};

/** Settings of a calibration. Start from imk_calibrate_log_default(). NaN (the default of most
 *  numbers) means "not given". Everything that is pointed to must live as long as the calibration.
 */
typedef struct imk_calibrate_log_settings {
    uint32_t cookie;
    /* the place */
    bool place_known;   /**< `place` is given; default false */
    imk_geodetic place; /**< of the test: sets gravity and the Earth's rotation */
    double gravity;     /**< [m/s^2], 9.5 to 10.1; replaces that of the place. Default NaN: of the
                             place, or of 45 deg at sea level */
    bool no_earth;      /**< the references do not contain the Earth's rotation; default false */
    int frame;          /**< imk_triad_frame; default -1: chosen by the procedures */
    /* known before */
    const imk_model *model; /**< sensitivities, and terms that are not estimated; default NULL */
    /** Nominal sensitivity of gyros [count/(rad/s)] and accelerometers [count/(m/s^2)]. */
    imk_calibrate_counts sensitivity[2];
    imk_calibrate_counts range[2]; /**< full scale of gyros [rad/s], accelerometers [m/s^2], above
                                      0: readings at it are saturated, and the model states it */
    imk_calibrate_counts zero_offset[2]; /**< readings at zero of gyros, accelerometers [count] */
    /* what is estimated */
    const char *estimate; /**< names of terms as of imk_calibrate_terms(), separated by commas;
                               default NULL: the terms that the procedures determine */
    unsigned with;        /**< terms to estimate in addition, IMK_CALIBRATE_… bits; default 0 */
    unsigned without;     /**< terms not to estimate; default 0. Neither goes with `estimate` */
    bool repeatability;   /**< compare the records, each a power cycle, instead of calibrating */
    bool closed_form;     /**< solve one ferraris record without iteration */
    bool least_squares;   /**< give outliers full weight; default false: robust */
    /* how records are observed; default NaN: of imk_procedure_default() */
    const char *section; /**< name of the column of texts that names holds, turns or runs; default
                              NULL: the only column of texts, if there is one. With multiposition,
                              rests in rows without a text are then no holds */
    /** Records of multiposition, sixposition and tumble are tables: each row has the means of one
     *  pose, in columns as of a log, and how well they are known: gyro_x_std and so on, the
     *  standard deviation of the samples, with their number in `samples`; or gyro_x_std_of_mean.
     *  Without these the scatter of the residuals is the noise. The time is not looked at: the rate
     *  of an array source may be 1. Default false */
    bool pose_means;
    double placement; /**< 1 sigma of the attitude of a face on the plate; of angle and axis of a
                         turn [rad] */
    double g_sensitivity_sigma; /**< 1 sigma of a g-sensitivity that is not estimated [rad/s per
                                   m/s^2] */
    double mounting;     /**< 1 sigma of the attitude of the unit on its fixture or table [rad] */
    double turn_angle;   /**< ferraris: angle of each turn about its axis, with sign; turns: of each
                            turn whose label states none, above 0 [rad] */
    double initial_rest; /**< duration of the rest at the beginning [s] */
    double window;       /**< length of the window in which rest is detected [s] */
    double minimum;      /**< shortest rest, step or run [s] */
    double trim;         /**< time left out at both ends of a stretch [s] */
    double settle;       /**< time left out at the beginning of a stretch in addition [s] */
    double reference_temperature; /**< thermal: temperature at which the polynomials are 0 [K] */
    int temperature_order;        /**< thermal: of the bias, 1 to IMK_TEMPERATURE_ORDER_MAX; default
                                       0: chosen by cross-validation */
    /* reference motion */
    const imk_motion *motion; /**< programme that the table ran; default NULL: columns of the
                                   records */
    double motion_offset;     /**< time of a record at which the programme begins [s]; default 0 */
    bool find_offset;         /**< find the offset of each record instead; default false */
    int table_axis; /**< axis of the unit about which a column table_rate turns it, 0 to 2;
                         default -1: not known */
    /* magnetometers */
    double field, field_sigma; /**< of the Earth at the place, with its 1 sigma [T]; default NaN:
                                  not known, and the scale of the magnetometers is a convention */
    double dip; /**< of this field, positive downwards [rad]; it tells the signs of a magnetometer's
                   axes. Default NaN: by the place, if that is known */
    bool activity; /**< keep for each sample whether it is at rest; default false */
} imk_calibrate_log_settings;

/** The defaults named above. */
IMK_API imk_calibrate_log_settings imk_calibrate_log_default(void);

/** A record of a test, with the findings about it. */
typedef struct imk_calibrate_record {
    const char *path; /**< name of the record in findings and reports; the caller's */
    imk_log log;      /**< owns the columns */
    imk_test_record record;
    int body_axis[2][IMK_AXES_MAX]; /**< of gyros, of accelerometers: the axis that the record names
                                         each of its axes by, 0 x … 2 z, 3 …; differs from its
                                         index where x or y is missing */
    size_t dropped;                 /**< rows left out because their time does not increase */
    int *section;
    const char **section_name;
    double *mean_sigma; /**< of a table of means: a column for each axis, gyros first */
    bool no_sigma[2];   /**< the table does not say how well the means of gyros, accelerometers
                             are known */
    double samples[2];  /**< mean number of samples in a mean, where the deviations in the table of
                             means are those of samples; else 0 */
    double *reference;  /**< IMK_CALIBRATE_REFERENCES columns: rate, force, angular acceleration */
    double motion_offset; /**< time of the record at which the programme begins [s] */
    imk_findings loaded;  /**< findings of imk_calibrate_record_load() */
    imk_procedure procedure;
    imk_procedure_settings settings;
    imk_procedure_findings findings;
    imk_static_findings stationary; /**< window 0: not looked at */
    size_t interval_count;
    imk_static_interval *interval;
    size_t lost_count; /**< stretches that look like rests, but are none; the first are kept */
    imk_static_lost lost[IMK_CALIBRATE_LOST_MAX];
    double *activity; /**< per sample; NULL: not asked for */
    size_t diagnostic_count;
    imk_diagnostic_finding diagnostic[IMK_CALIBRATE_DIAGNOSTICS_MAX];
    uint64_t axes_unseen;          /**< mistakes about the axes that its turns would not show, as
                                      imk_record_axes_unseen() */
    imk_thermal_findings *thermal; /**< of the procedure "thermal", else NULL */
    bool mag_counts;               /**< the magnetometer is in counts, and is not calibrated */
    imk_magnetometer_record mag;   /**< its magnetometer, if record.mag is there */
} imk_calibrate_record;

/** A calibration: its records and its result. */
typedef struct imk_calibrate_log {
    imk_calibrate_log_settings settings;
    size_t count;
    imk_calibrate_record *record; /**< `count` of them; settings may be changed before the run */
    bool nominal[2];              /**< sensitivities were found, not given: gyro, accel */
    imk_calibration *calibration;
    imk_model *before; /**< the model known before the run, with the axes of the records */
    imk_calibration_result *result;
    imk_ferraris *ferraris;         /**< of the closed form, else NULL */
    imk_repeatability_result *runs; /**< of the repeatability, else NULL */
    size_t run_count;
    size_t diagnostic_count;
    imk_diagnostic_finding diagnostic[IMK_CALIBRATE_DIAGNOSTICS_MAX]; /**< of the solution */
    imk_magnetometer *magnetometer; /**< the problem; NULL: no record has one to calibrate */
    imk_magnetometer_result *mag;   /**< its solution; NULL: there is none that can be used */
    imk_model model; /**< the result, to be written; its name is that of the model known before */
    imk_findings findings;
    size_t failed; /**< number of the record that could not be used; count: all of them together */
    imk_job job;
    struct imki_arena *memory;
} imk_calibrate_log;

/** One record for imk_calibrate_logs(). */
typedef struct imk_calibrate_input {
    const char *name; /**< of the record in findings and reports */
    imk_procedure procedure;
    const imk_record_source *source;
} imk_calibrate_input;

/** Calibrate from records of bench tests: load each, observe it by its procedure, solve all
 *  together, make the model.
 *
 *  The same as imk_calibrate_log_create(), then imk_calibrate_log_load() of each, then
 *  imk_calibrate_log_run().
 *  @param job      NULL: one thread, memory of the C library, no progress
 *  @param session  NULL only if imk_calibrate_log_create() failed: else it tells, also after a
 *                  failure, what was found, and is freed by imk_calibrate_log_free()
 *  @return errors of these three functions */
IMK_API imk_status imk_calibrate_logs(size_t count, const imk_calibrate_input *input,
                                      const imk_calibrate_log_settings *settings,
                                      const imk_job *job, imk_calibrate_log **session,
                                      imk_error *error);

/** A calibration whose records are to be loaded.
 *  @param procedure  of each record
 *  @param job        NULL: one thread, memory of the C library, no progress
 *  @return IMK_ERROR_RANGE ("count": 0, or more than IMK_TEST_RECORDS_MAX; "procedure"; "gravity",
 *          "latitude", "height", "field", "dip": value; "turn_angle": not above 0 with turns),
 *          IMK_ERROR_CONFLICT (a setting that no procedure looks at, or a time where all are
 *          tables of means; "frame": gravity alone does not tell the reference frame;
 *          "closed_form": not one ferraris record, or terms are chosen; "estimate": with or
 *          without beside it, or a record of the procedure magnetometer; "pose_means": no record
 *          is of a procedure that takes them), _MEMORY */
IMK_API imk_status imk_calibrate_log_create(size_t count, const imk_procedure *procedure,
                                            const imk_calibrate_log_settings *settings,
                                            const imk_job *job, imk_calibrate_log **session,
                                            imk_error *error);
/** Free a calibration with its records; NULL is allowed. */
IMK_API void imk_calibrate_log_free(imk_calibrate_log *session);

/** Load record number `index`. Findings are in session->record[index].loaded.
 *  @param name  of the record in findings and reports; must live as long as the calibration
 *  @return IMK_ERROR_RANGE (index); errors of imk_calibrate_record_load() */
IMK_API imk_status imk_calibrate_log_load(imk_calibrate_log *session, size_t index,
                                          const char *name, const imk_record_source *source,
                                          imk_error *error);

/** Observe each record by its procedure, solve all together, make the model.
 *  @return with a finding in session->findings, IMK_ERROR_ARGUMENT (settings that do not fit the
 *          records), _COLUMN, _CONFLICT, _TOO_SHORT, _EMPTY; as imk_calibrate_terms() with the name
 *          in error->field, imk_procedure_observe(), imk_calibration_solve(),
 *          imk_ferraris_closed_form(), imk_repeatability_of_holds(). session->failed tells whether
 *          one record failed, or all together */
IMK_API imk_status imk_calibrate_log_run(imk_calibrate_log *session, imk_error *error);

/** Compare models, each the calibration of a power cycle of one unit, instead of records: how much
 *  bias and scale factor differ.
 *  @param model  one for each record that the calibration was created for, none of which is loaded
 *  @param name   what findings and reports call them
 *  @return with a finding, IMK_ERROR_TOO_SHORT, _EMPTY, _CONFLICT (not of one unit, or of several
 *          frames); as imk_repeatability_of_calibrations() */
IMK_API imk_status imk_calibrate_log_compare(imk_calibrate_log *session,
                                             const imk_model *const *model, const char *const *name,
                                             imk_error *error);

/** The numbers of the model that a name of terms means, appended to a list: "bias",
 *  "scale_factor", "nonlinearity", "nonlinearity.k2", "bias.temperature" and so on of both sensors,
 *  with "gyro." or "accel." before it of one; or one number, such as "accel.bias.fixed.x".
 *  @param temperature_order  of polynomials, 0: 3
 *  @param parameter,count    room for `capacity`; `count` are there before
 *  @return IMK_ERROR_KEY_UNKNOWN (error->expected: the names that there are), IMK_ERROR_RANGE (no
 *          such axis), IMK_ERROR_WORKSPACE (more than `capacity`); error->field is the name */
IMK_API imk_status imk_calibrate_terms(const imk_calibration *calibration, int temperature_order,
                                       const char *name, size_t capacity,
                                       imk_model_parameter *parameter, size_t *count,
                                       imk_error *error);

/** Name of a term without sensor and axis: "nonlinearity.k2". @return false: it has none */
IMK_API bool imk_calibrate_term_path(int sensor, int term, char path[IMK_MODEL_PARAMETER_NAME]);

/** Does the procedure know what the unit is exposed to? */
IMK_API bool imk_procedure_is_known(imk_procedure procedure);

/** Index of a parameter in session->result, or -1. */
IMK_API int imk_calibrate_find(const imk_calibrate_log *session, imk_model_parameter parameter);

/** Find the poses that would improve the accelerometers' parameters most, given the rests found.
 *  @return false if they cannot be computed, or memory is exhausted */
IMK_API bool imk_calibrate_advise(const imk_calibrate_log *session, const imk_calibrate_record *log,
                                  const imk_allocator *allocator,
                                  imk_pose_advice advice[IMK_CALIBRATE_POSES]);

/** @name Programmes of tests
 *  @{ */
/** The settings of a plan for the procedure of a calibration's first record: its terms, placement,
 *  mounting, turns, order of the temperature; sampling rate, soak and the rest are the defaults.
 *  @param session  of imk_calibrate_log_create(); its calibration gives frame, gravity and place,
 *                  and imk_calibrate_plan_run() takes it with the unit's model in it
 *  @return IMK_ERROR_UNSUPPORTED (repeatability or magnetometer: error->found says that it needs no
 *          programme, error->expected what to do) */
IMK_API imk_status imk_calibrate_plan_settings(const imk_calibrate_log *session,
                                               imk_plan_settings *settings, imk_error *error);

/** Read requirements as they are written: "accel.scale_factor 50 ppm, gyro.bias 5 deg/h", each a
 *  name of imk_calibrate_terms() and the 1 sigma of all its numbers.
 *  @param temperature_order  as for imk_calibrate_terms()
 *  @param text               NULL or "": none
 *  @param requirement,count  room for `capacity`; receive sigma and parameter
 *  @return IMK_ERROR_SYNTAX (error->field is "want", found what stood there), IMK_ERROR_WORKSPACE
 *          (more than `capacity`), errors of imk_calibrate_terms() */
IMK_API imk_status imk_calibrate_requirements(const imk_calibration *calibration,
                                              int temperature_order, const char *text,
                                              size_t capacity, imk_sigma_requirement *requirement,
                                              size_t *count, imk_error *error);

typedef struct imk_calibrate_plan {
    imk_plan_settings settings; /**< with requirements of its own, which say what is expected */
    imk_plan_step *step;
    imk_plan_result result;
    double duration;          /**< of all, with ramps of the temperature of 1 K/min [s] */
    imk_motion_script script; /**< as a motion; without steps where it is none */
    imk_error unscripted;     /**< why not; status IMK_OK: it is one, or temperatures */
    struct imki_arena *memory;
} imk_calibrate_plan;

/** Plan a test (calibration_plan.h).
 *  @param calibration  its model states the noise of the unit
 *  @param job          NULL: one thread, memory of the C library, no progress
 *  @return errors of imk_plan_make(); IMK_ERROR_MEMORY */
IMK_API imk_status imk_calibrate_plan_run(imk_calibration *calibration,
                                          const imk_plan_settings *settings, const imk_job *job,
                                          imk_calibrate_plan **plan, imk_error *error);
/** Free a plan; NULL is allowed. */
IMK_API void imk_calibrate_plan_free(imk_calibrate_plan *plan);
/** @} */

/** @name Records of tests
 *  Memory is of the job's allocator.
 *  @{ */
/** Load a record of a test: rows whose time does not increase are left out, numbers of sensors that
 *  are no readings become NaN, and the references are taken from its columns or the programme.
 *  @param settings  section, motion, motion_offset, find_offset and table_axis are looked at, and
 *                   whether the record is long enough for initial_rest, window and minimum
 *  @param name      what it is called in findings; must live as long as the record
 *  @param job       NULL: one thread, memory of the C library, no progress
 *  @param record    zeroed, or one of a calibration; filled. Free it also after a failure;
 *                   record->loaded says what was found
 *  @return with a finding, IMK_ERROR_ARGUMENT (settings that do not fit it), _EMPTY, _TOO_SHORT,
 *          _COLUMN, _UNIT_MISSING, _DIMENSION, _CONFLICT (does not follow the programme); else as
 *          the source, as imk_reference_offset(), _MEMORY */
IMK_API imk_status imk_calibrate_record_load(const imk_calibrate_log_settings *settings,
                                             const char *name, const imk_record_source *source,
                                             const imk_job *job, imk_calibrate_record *record,
                                             imk_error *error);
/** Does a record that was loaded as a log look like a table of pose means: few rows, most of them
 * in another attitude than the row before? */
IMK_API bool imk_calibrate_looks_like_means(const imk_calibrate_record *log);
/** Free columns, sections and references of a record that is none of a calibration. */
IMK_API void imk_calibrate_record_free(imk_calibrate_record *log);
/** Time of a row [s]. */
IMK_API double imk_test_record_time(const imk_test_record *record, size_t row);
/** Count the rows in which a reading or the temperature is not a number.
 *  @param first  index of the first such row; untouched if there is none */
IMK_API size_t imk_test_record_missing(const imk_test_record *record, size_t *first);
/** @} */

/** @name Names and units of parameters
 *  @{ */
/** Letter of an axis: x, y, z, 3 … 7; ? below 0. */
IMK_API char imk_axis_letter(int axis);
/** The unit in which a number of this size is easy to read. */
IMK_API imk_unit imk_parameter_unit(imk_model_parameter parameter, double magnitude);
/** The unit of a parameter in the model file. */
IMK_API const char *imk_parameter_file_unit(imk_model_parameter parameter);
/** Title of a parameter without sensor and axis: "scale factor error", "misalignment, y". */
IMK_API void imk_parameter_title(imk_model_parameter parameter, char *text, size_t size);
/** @} */

IMK_END_C
#endif
