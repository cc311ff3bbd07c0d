/* SPDX-License-Identifier: Apache-2.0 */
/** @file calibrate_log.h
 *  The job of `imukit calibrate`: logs of bench tests, each of a procedure, and what they say of
 *  the unit together. */
#ifndef IMUKIT_CALIBRATE_LOG_H
#define IMUKIT_CALIBRATE_LOG_H

#include "imukit/calibration_plan.h"
#include "imukit/ferraris.h"
#include "imukit/job.h"
#include "imukit/motion.h"
#include "imukit/procedure.h"
#include "imukit/record.h"
#include "imukit/reference_alignment.h"
#include "imukit/repeatability.h"
#include "imukit/thermal.h"

IMK_BEGIN_C

enum { IMK_CALIBRATE_DIAGNOSTICS_MAX = 16, IMK_CALIBRATE_REFERENCES = 9, IMK_CALIBRATE_POSES = 3 };

/** What is asked; NaN: not given. Start from imk_calibrate_log_default(). */
typedef struct imk_calibrate_log_settings {
    uint32_t cookie;
    double gravity;      /**< [m/s^2] */
    double placement;    /**< 1 sigma of a placement on a face [rad] */
    double minimum;      /**< shortest rest, step or run [s] */
    double trim, settle; /**< left out at both ends; at the beginning besides [s] */
    bool place_known;    /**< the calibration's gravity is that of a place */
    bool model_given;    /**< known before are the axes of a model */
    bool repeatability;  /**< the records are power cycles, nothing is solved */
    bool terms_named;    /**< what is estimated is free in the calibration already */
    bool closed_form;    /**< a ferraris session is solved without iteration */
    bool activity;       /**< say of each sample whether it stands still */
} imk_calibrate_log_settings;

/** Everything as the procedure has it; where a number is asked for, NaN. */
IMK_API imk_calibrate_log_settings imk_calibrate_log_default(void);

/** One log. */
typedef struct imk_calibrate_record {
    const char *path; /**< what it is called */
    imk_log log;      /**< owns the columns */
    imk_test_record record;
    size_t dropped; /**< rows without a time that increases */
    int *section;
    const char **section_name;
    double *reference; /**< IMK_CALIBRATE_REFERENCES columns: rate, force, angular acceleration */
    double motion_offset; /**< the log shows at t what the programme says at t less this [s] */
    imk_procedure procedure;
    imk_procedure_settings settings;
    imk_procedure_findings findings;
    imk_static_findings stationary; /**< window 0: not looked at */
    size_t interval_count;
    imk_static_interval *interval;
    double *activity; /**< per sample; NULL: not asked for */
    size_t diagnostic_count;
    imk_diagnostic_finding diagnostic[IMK_CALIBRATE_DIAGNOSTICS_MAX];
    imk_thermal_findings *thermal; /**< of that procedure */
} imk_calibrate_record;

/** What was found. */
typedef struct imk_calibrate_log {
    imk_calibrate_log_settings settings;
    size_t count;
    imk_calibrate_record *record;
    bool nominal[2]; /**< sensitivities were found, not given: gyro, accel */
    imk_calibration *calibration;
    imk_calibration_result *result;
    imk_ferraris *ferraris; /**< of the closed form */
    imk_repeatability_result *runs;
    size_t run_count;
    size_t diagnostic_count;
    imk_diagnostic_finding diagnostic[IMK_CALIBRATE_DIAGNOSTICS_MAX]; /**< of the solution */
    imk_model model; /**< to be written; its name stays */
    imk_findings findings;
    size_t failed; /**< number of the record that could not be used; count: all of them together */
    imk_job job;
    struct imki_arena *memory;
} imk_calibrate_log;

/** An empty one: the records, and the calibration with what is known before, are the caller's to
 *  fill.
 *  @param job  NULL: as if all zeros
 *  @return IMK_ERROR_RANGE (0 records, or more than IMK_TEST_RECORDS_MAX), _MEMORY */
IMK_API imk_status imk_calibrate_log_create(size_t count,
                                            const imk_calibrate_log_settings *settings,
                                            const imk_job *job, imk_calibrate_log **session,
                                            imk_error *error);
/** Free it; what the caller filled in stays the caller's. */
IMK_API void imk_calibrate_log_free(imk_calibrate_log *session);

/** Observe each record by its procedure, solve all together, make the model.
 *  @return as imk_procedure_observe(), imk_calibration_solve(), imk_ferraris_closed_form(),
 *          imk_repeatability_of_holds(); then session->failed says of what */
IMK_API imk_status imk_calibrate_log_run(imk_calibrate_log *session, imk_error *error);

/** Bias and scale factor of a model with their sigmas, as the calibration of a run; of counts by
 *  the sensitivities and zeros of the first one, since each may have found its own. */
IMK_API void imk_calibration_of_model(const imk_model *model, const imk_model *first,
                                      imk_calibration_result *result);
/** Compare runs, the calibration of each given, and make the model.
 *  @return with a finding, IMK_ERROR_TOO_SHORT, _EMPTY; as imk_repeatability_of_calibrations() */
IMK_API imk_status imk_calibrate_log_compare(imk_calibrate_log *session,
                                             const imk_calibration_result *const *run,
                                             imk_error *error);

/** What the unit is exposed to is known. */
IMK_API bool imk_procedure_is_known(imk_procedure procedure);

/** Index of a parameter of the solution, or -1. */
IMK_API int imk_calibrate_find(const imk_calibrate_log *session, imk_model_parameter parameter);

/** The poses that would tell most about the accelerometers, given the rests that were found.
 *  @return false where they are not known, or memory is exhausted */
IMK_API bool imk_calibrate_advise(const imk_calibrate_log *session, const imk_calibrate_record *log,
                                  const imk_allocator *allocator,
                                  imk_pose_advice advice[IMK_CALIBRATE_POSES]);

/** @name Programmes of tests
 *  @{ */
typedef struct imk_calibrate_plan {
    imk_plan_settings settings; /**< with requirements of its own, which say what is expected */
    imk_plan_step *step;
    imk_plan_result result;
    double duration;          /**< of all, with ramps of the temperature of 1 K/min [s] */
    imk_motion_script script; /**< as a motion; without steps where it is none */
    imk_error unscripted;     /**< why not; status IMK_OK: it is one, or temperatures */
    struct imki_arena *memory;
} imk_calibrate_plan;

/** Plan a test (calibration_plan.h). @param job  NULL: as if all zeros
 *  @return as imk_plan_make(); IMK_ERROR_MEMORY */
IMK_API imk_status imk_calibrate_plan_run(imk_calibration *calibration,
                                          const imk_plan_settings *settings, const imk_job *job,
                                          imk_calibrate_plan **plan, imk_error *error);
/** Free it and all it holds; NULL is allowed. */
IMK_API void imk_calibrate_plan_free(imk_calibrate_plan *plan);
/** @} */

/** @name Records of tests
 *  Memory is of the log's allocator.
 *  @{ */
/** Fill log->record from log->log, which is loaded, and log->path: rows whose time does not
 *  increase are left out, and numbers of sensors that are no readings become NaN.
 *  @param section  column of texts that names holds, turns or runs; NULL: the only one
 *  @return with a finding, IMK_ERROR_EMPTY, _COLUMN; IMK_ERROR_MEMORY */
IMK_API imk_status imk_calibrate_record_make(imk_calibrate_record *log, const char *section,
                                             imk_findings *findings, imk_error *error);
/** One of its columns of references, zeros at first: rate, force, angular acceleration, x to z.
 *  @return NULL when memory is exhausted */
IMK_API double *imk_calibrate_record_column(imk_calibrate_record *log, int column);
/** References by a motion that begins at log->motion_offset; NaN outside a recorded one.
 *  @return IMK_ERROR_MEMORY */
IMK_API imk_status imk_calibrate_record_expose(imk_calibrate_record *log, const imk_motion *motion,
                                               imk_error *error);
/** Where readings follow the references best. @param largest  looked at on both sides [s]; a
 *  quarter of the log at most @return as imk_reference_offset(); IMK_ERROR_MEMORY */
IMK_API imk_status imk_calibrate_record_shift(const imk_calibrate_record *log, double largest,
                                              imk_reference_shift *shift, imk_error *error);
/** Free columns, sections and references. */
IMK_API void imk_calibrate_record_free(imk_calibrate_record *log);
/** When a row was taken [s]. */
IMK_API double imk_test_record_time(const imk_test_record *record, size_t row);
/** Rows with a reading or a temperature that is no number. @param first  set when there are some */
IMK_API size_t imk_test_record_missing(const imk_test_record *record, size_t *first);
/** @} */

/** @name Words and units
 *  In which sensors and parameters are shown and written.
 *  @{ */
/** x, y, z, 3 … 7; ? below 0 */
IMK_API char imk_axis_letter(int axis);
/** The unit a person reads a number of this size in. */
IMK_API imk_unit imk_parameter_unit(imk_model_parameter parameter, double magnitude);
/** As in the model file, whatever the size. */
IMK_API const char *imk_parameter_file_unit(imk_model_parameter parameter);
/** "scale factor error", "misalignment, y": without sensor and axis. */
IMK_API void imk_parameter_title(imk_model_parameter parameter, char *text, size_t size);
/** @} */

IMK_END_C
#endif
