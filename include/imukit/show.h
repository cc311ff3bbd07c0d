/* SPDX-License-Identifier: Apache-2.0 */
/** @file show.h
 *  The results of jobs, made ready to be shown: each function adds data, tables and figures to an
 *  imk_result (result.h). `name` is what the record is called, such as its file. */
#ifndef IMUKIT_SHOW_RESULTS_H
#define IMUKIT_SHOW_RESULTS_H

#include "imukit/allan_log.h"
#include "imukit/calibrate_log.h"
#include "imukit/compensate_log.h"
#include "imukit/drift_models.h"
#include "imukit/earth.h"
#include "imukit/evaluate_sheet.h"
#include "imukit/grade_position.h"
#include "imukit/identify_several.h"
#include "imukit/navigate_log.h"
#include "imukit/physics_log.h"
#include "imukit/record_plan.h"
#include "imukit/result.h"
#include "imukit/spectrum_log.h"

IMK_BEGIN_C

/** Deviations: a table for each statistic and kind of sensor, a figure. */
IMK_API void imk_show_allan_log(const imk_allan_log *allan, const char *name, imk_result *result);

/** Densities, lines and parameters: a table for each kind of sensor, a figure. */
IMK_API void imk_show_spectrum_log(const imk_spectrum_log *spectrum, const char *name,
                                   imk_result *result);

/** Attitude at the start, the track and its end, and a figure. */
IMK_API void imk_show_navigate_log(const imk_navigate_log *n, const char *name, imk_result *result);
/** What was taken out, and what was met on the way. @param model  what the model is called */
IMK_API void imk_show_compensate_log(const imk_compensate_log *log, const char *name,
                                     const char *model, imk_result *result);
/** Terms as an array of the data, and as a line. @param key,label  of these */
IMK_API void imk_show_terms(const char *key, const char *label, const imk_term_keys *keys,
                            imk_result *result);

/** Models that are graded, with what each is called. */
typedef struct imk_graded_several {
    size_t count;
    const imk_graded *const *graded;
    const char *const *name;
} imk_graded_several;
/** Maps of models among classes, technologies and applications. */
typedef enum imk_grade_map {
    IMK_GRADE_MAP_GYRO = 0, /**< stability of bias against that of scale factor */
    IMK_GRADE_MAP_ACCEL,
    IMK_GRADE_MAP_COST, /**< cost against performance */
    IMK_GRADE_MAPS      /**< all of them */
} imk_grade_map;
/** Does a model state enough to stand on a map, or on any of IMK_GRADE_MAPS? */
IMK_API bool imk_grade_stands(const imk_graded_several *r, imk_grade_map map);
/** Classes, errors of position and what limits them, and maps. @param map  for the plot */
IMK_API void imk_show_grade(const imk_graded_several *r, imk_grade_map map, imk_result *result);

/** @name What was identified
 *  @{ */
/** A message of a verdict. */
typedef struct imk_message {
    imk_finding_level level; /**< good, note or warning */
    const char *code, *text;
} imk_message;

/** What a record is good for, and what is wrong with it. Its memory is the result's. */
typedef struct imk_verdict {
    imk_result *result;
    const char *label; /**< before each message; NULL: nothing */
    size_t count;
    imk_message *message; /**< NULL when memory is exhausted: there is one at least */
} imk_verdict;

/** Of one record. @param label  before each message; NULL: nothing */
IMK_API imk_verdict imk_identify_verdict(const imk_identify_log *log, const char *label,
                                         imk_result *result);
/** @param labels  of the records */
IMK_API imk_verdict imk_several_verdict(const imk_identify_several *several,
                                        const char *const *labels, imk_result *result);
/** Is there a warning among its messages? */
IMK_API bool imk_verdict_warns(const imk_verdict *verdict);

/** One record, or several together, and what stands beside it. */
typedef struct imk_identify_shown {
    const imk_identify_log *log;
    const char *name, *label; /**< such as its path, and the last part of it */
    imk_verdict verdict;
    const imk_model *truth;      /**< NULL: not known */
    const imk_allan_curve *twin; /**< of each channel (imk_identify_log_twin()); NULL: none */
} imk_identify_shown;

/** Parameters, truth, verdict and a figure. */
IMK_API void imk_show_identify_log(const imk_identify_shown *shown, imk_result *result);
/** @param joint    of several->joint; its name tells of all records
 *  @param records  the names, labels and verdicts of several->log */
IMK_API void imk_show_identify_several(const imk_identify_several *several,
                                       const imk_identify_shown *joint,
                                       const imk_identify_shown *records, imk_result *result);
/** @} */

/** @name Calibrations
 *  @{ */
/** Diagnostics, findings over temperature and warnings as messages; FAILURE: of no use.
 *  @param before  `count` messages on the way here */
IMK_API imk_verdict imk_calibrate_verdict(const imk_calibrate_log *session, size_t count,
                                          const imk_message *before, imk_result *result);
/** The worst there is; good when there is nothing. */
IMK_API imk_finding_level imk_verdict_level(const imk_verdict *verdict);
/** Parameters, fit, remarks, verdict and a figure. @param poses  also on the terminal */
IMK_API void imk_show_calibrate_log(const imk_calibrate_log *session, const imk_verdict *verdict,
                                    bool poses, imk_result *result);
/** The steps of a programme, and what is reached. @param model  what the unit's is called */
IMK_API void imk_show_calibrate_plan(const imk_calibrate_plan *plan, const char *model,
                                     imk_result *result);
/** A programme as a motion file, or a temperature file. @param place  NULL: not known
 *  @param text  obtained from malloc(), the caller's @return IMK_ERROR_MEMORY */
IMK_API imk_status imk_calibrate_plan_text(const imk_calibrate_plan *plan,
                                           const imk_geodetic *place, char **text, size_t *size);
/** Why imk_calibrate_log_run() failed, with the name of the record: diagnostics about it say more
 * than the error. @return length of the text; 0: nothing is to be said beyond the error */
IMK_API size_t imk_calibrate_failure(const imk_calibrate_log *session, const imk_error *error,
                                     char *text, size_t size);
/** @} */

/** @name Drift
 *  @{ */
/** What makes figures doubtful: terms that are left out, errors beyond the linear range, runs that
 *  differ. Warnings alone. */
IMK_API imk_verdict imk_drift_verdict(const imk_drift_models *r, imk_result *result);

/** What stands beside the figures. */
typedef struct imk_drift_shown {
    const char *motion; /**< what it is called; NULL: at rest */
    uint64_t seed;      /**< of the runs */
    imk_verdict verdict;
    const imk_result *model; /**< the last model as data called "model", for values of terms; NULL:
                                  none are told */
} imk_drift_shown;

/** Growth, budgets, runs, the answer to what is wanted, and figures. */
IMK_API void imk_show_drift(const imk_drift_models *r, const imk_drift_shown *shown,
                            imk_result *result);
/** Runs alone. @param words  what they are */
IMK_API void imk_show_drift_runs(const imk_drift_models *r, const char *words, imk_result *result);
/** @} */

/** @name Instruments
 *  @{ */
/** An instrument, and what was done with it. */
typedef struct imk_physics_shown {
    const imk_physics_log_settings *settings;
    const char *source;             /**< as it was asked for */
    const char *name, *description; /**< of the design; NULL or "": none */
    const imk_model *model;         /**< by closed forms, one axis */
    bool reduced;                   /**< which is shown */
    const imk_physics_log *run;     /**< NULL: none */
    const imk_physics_sweep *sweep; /**< NULL: none */
} imk_physics_shown;

/** The instruments there are. */
IMK_API void imk_show_instruments(imk_result *result);
/** A run with its figure, error models, or, without either, the design. What is added after it is
 *  for the page. */
IMK_API void imk_show_physics(const imk_physics_shown *shown, imk_result *result);
/** Design and error model, for the page. */
IMK_API void imk_show_physics_design(const imk_physics_shown *shown, imk_result *result);
/** The sweep for the page, with a figure where something was measured that can be drawn. */
IMK_API void imk_show_physics_sweep(const imk_physics_shown *shown, imk_result *result);
/** A view that shows something: a figure, or an animation. */
IMK_API void imk_show_physics_view(const imk_physics_view *view, imk_result *result);
/** A view as a panel of a figure. */
IMK_API void imk_show_physics_panel(const imk_physics_view *view, imk_figure_builder *figure);
/** A view that can move; its texts and numbers are the view's. */
IMK_API imk_animation imk_physics_animation(const imk_physics_view *view);
/** @} */

/** An evaluation, and what its test report says of the unit; texts may be NULL. */
typedef struct imk_evaluate_shown {
    double confidence;
    size_t path_count;
    const char *const *path; /**< of the readings */
    const char *rest_path;   /**< of the log at rest */
    const char *unit, *serial, *operator_name, *laboratory, *date, *temperature;
    const char *report; /**< where the page goes */
    bool levels;        /**< on the terminal too */
    bool missed;        /**< a limit */
    size_t channel_count, rest_count, limit_count;
    const imk_evaluate_channel *channel;
    const imk_evaluate_rest *rest;
} imk_evaluate_shown;

/** Data, tables and test report. What is added after it is for the page. */
IMK_API void imk_show_evaluate(const imk_evaluate_shown *shown, imk_result *result);

/** What records of several lengths tell, how long they must be, and, of a curve, a figure. */
IMK_API void imk_show_record_plan(const imk_record_plan *plan, const char *name,
                                  imk_result *result);

IMK_END_C
#endif
