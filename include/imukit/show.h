/* SPDX-License-Identifier: Apache-2.0 */
/** @file show.h
 *  The results of jobs, prepared for display: each function adds data, tables and figures to an
 *  imk_result (result.h). `name` is the name of the record, such as that of its file. */
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
#include "imukit/info_log.h"
#include "imukit/navigate_log.h"
#include "imukit/physics_log.h"
#include "imukit/record_plan.h"
#include "imukit/result.h"
#include "imukit/simulate_log.h"
#include "imukit/spectrum_log.h"
#include "imukit/technology_map.h"
#include "imukit/tune_model.h"

IMK_BEGIN_C

/** Show Allan deviations: a table for each statistic and kind of sensor, and a figure. */
IMK_API void imk_show_allan_log(const imk_allan_log *allan, const char *name, imk_result *result);

/** Logs side by side. */
enum { IMK_ALLAN_LOGS_MAX = 8 };
typedef struct imk_allan_shown {
    size_t count;                                 /**< 1 … IMK_ALLAN_LOGS_MAX */
    const imk_allan_log *log[IMK_ALLAN_LOGS_MAX]; /**< with the same settings */
    const char *name[IMK_ALLAN_LOGS_MAX];         /**< of their files */
    const char *label[IMK_ALLAN_LOGS_MAX];        /**< short, all different */
} imk_allan_shown;
/** Show the deviations of several logs: channels of one name in one table and one panel. One log is
 *  shown as by imk_show_allan_log(). */
IMK_API void imk_show_allan_logs(const imk_allan_shown *shown, imk_result *result);

/** What of a log is not in its rows. */
typedef struct imk_info_file {
    const char *format;           /**< title of its format */
    size_t stream_count;          /**< sensors in it */
    const imk_log_stream *stream; /**< `stream_count` of them */
    const imk_log_stream *chosen; /**< the one whose rows were read; NULL: none was */
} imk_info_file;
/** What to do with a log next, by what is in it. */
typedef enum imk_info_next {
    IMK_INFO_NEXT_NONE = 0, /**< nothing is sure to fit */
    IMK_INFO_NEXT_IDENTIFY,
    IMK_INFO_NEXT_MULTIPOSITION, /**< calibrate with this procedure */
    IMK_INFO_NEXT_SIXPOSITION    /**< calibrate with this one */
} imk_info_next;
/** What to do with a log next. */
IMK_API imk_info_next imk_info_log_next(const imk_info_log *info);
/** Show what is in a log: its sensors, times, columns and motion.
 *  @param info  NULL: no rows were read
 *  @param next  command to run next; NULL: none is suggested */
IMK_API void imk_show_info_log(const imk_info_log *info, const imk_info_file *file,
                               const char *name, const char *next, imk_result *result);

/** Show densities, lines and noise parameters: a table for each kind of sensor, and a figure. */
IMK_API void imk_show_spectrum_log(const imk_spectrum_log *spectrum, const char *name,
                                   imk_result *result);

/** Show the attitude at the start, the track and its end, and a figure. */
IMK_API void imk_show_navigate_log(const imk_navigate_log *n, const char *name, imk_result *result);
/** Show the settings of a simulation. The logs that it wrote are shown by imk_show_written().
 *  @param model,motion,temperature  names of the files; NULL: none
 *  @param runs                      number of runs */
IMK_API void imk_show_simulate_inputs(const imk_simulate_log_settings *settings, const char *model,
                                      const char *motion, const char *temperature, uint64_t runs,
                                      imk_result *result);
/** Show a log that was written, as members of the object of the data that is open.
 *  @param columns  `column_count` of them, with the units of the file */
IMK_API void imk_show_file(const char *file, uint64_t rows, size_t column_count,
                           const imk_log_column *columns, imk_result *result);
/** The same as an object of its own. @param key  NULL in an array */
IMK_API void imk_show_written(const char *key, const char *file, uint64_t rows, size_t column_count,
                              const imk_log_column *columns, imk_result *result);
/** Show the terms taken out, and the counts of the run. @param model  name of the model */
IMK_API void imk_show_compensate_log(const imk_compensate_log *log, const char *name,
                                     const char *model, imk_result *result);
/** Add terms as an array of the data and as a line of text.
 *  @param key,label  key of the array; beginning of the line */
IMK_API void imk_show_terms(const char *key, const char *label, const imk_term_keys *keys,
                            imk_result *result);

/** Three cells of a table: size [mm], mass [g], and supply with its unit; "-" where nothing was
 *  read. @param build  NULL: nothing was read */
IMK_API void imk_show_build_cells(const imk_device_build *build, imk_table *table);
/** Object "build" of a device, null when nothing was read. */
IMK_API void imk_show_build(const imk_device_build *build, imk_result *result);

/** Graded models with their names. */
typedef struct imk_graded_several {
    size_t count;
    const imk_graded *const *graded;
    const char *const *name;
    const imk_unstated *assumed; /**< `count`: what was assumed of each (imk_model_assume_class());
                                    NULL: nothing was */
} imk_graded_several;
/** True when a model states enough for a map; with IMK_GRADE_MAPS, for any map. */
IMK_API bool imk_grade_stands(const imk_graded_several *r, imk_grade_map map);
/** Show classes, position errors, what limits them, and maps. @param map  the one to plot */
IMK_API void imk_show_grade(const imk_graded_several *r, imk_grade_map map, imk_result *result);

/** @name Results of identification
 *  @{ */
/** One message of a verdict. */
typedef struct imk_message {
    imk_finding_level level; /**< good, note, warning, or failure: not usable */
    const char *code, *text;
    const char *brief;  /**< the same in a few words; NULL: the text is short */
    const char *clause; /**< what it does to the estimates, part of a sentence; NULL: nothing */
    uint64_t channels;  /**< channels concerned, bit c for channel c; 0: the record as a whole */
    bool told; /**< a finding of the job, which the caller reports with imk_finding_message() */
} imk_message;

/** Assessment of a record: the uses it is good for, and its faults. The memory belongs to the
 *  result. */
typedef struct imk_verdict {
    imk_result *result;
    const char *label; /**< text before each message; NULL: none */
    size_t count;
    imk_message *message; /**< one or more; NULL when memory is exhausted */
} imk_verdict;

/** Assess one record. @param label  text before each message; NULL: none */
IMK_API imk_verdict imk_identify_verdict(const imk_identify_log *log, const char *label,
                                         imk_result *result);
/** Assess several records together. @param labels  of the records */
IMK_API imk_verdict imk_several_verdict(const imk_identify_several *several,
                                        const char *const *labels, imk_result *result);
/** True when a message of the verdict is a warning or a failure. */
IMK_API bool imk_verdict_warns(const imk_verdict *verdict);
/** The usability that the levels of the messages mean. */
IMK_API imk_usability imk_verdict_usability(const imk_verdict *verdict);
/** One sentence: whether the record of an identification is usable, and what is affected, why. The
 *  memory belongs to the result. */
IMK_API const char *imk_identify_sentence(const imk_verdict *verdict);

/** Results of one record, or of several together, and related data that are shown, too. */
typedef struct imk_identify_shown {
    const imk_identify_log *log;
    const char *name, *label; /**< such as its path and the last part of the path */
    imk_verdict verdict;
    bool verbose;           /**< show the whole messages of the verdict on the terminal, too */
    const imk_model *truth; /**< true model, for comparison; NULL: not known */
    /** Simulated deviations per channel (imk_identify_log_twin()); NULL: none. */
    const imk_allan_curve *twin;
} imk_identify_shown;

/** Show parameters, the true values if known, the verdict and a figure. */
IMK_API void imk_show_identify_log(const imk_identify_shown *shown, imk_result *result);
/** Show several records.
 *  @param joint    results of several->joint; its name stands for all records
 *  @param records  the names, labels and verdicts of several->log */
IMK_API void imk_show_identify_several(const imk_identify_several *several,
                                       const imk_identify_shown *joint,
                                       const imk_identify_shown *records, imk_result *result);
/** @} */

/** @name Calibrations
 *  @{ */
/** Assess a calibration: diagnostics, findings over temperature and warnings as messages. A message
 *  of level IMK_FINDING_FAILURE means that the calibration is of no use.
 *  @param before  `count` earlier messages to include */
IMK_API imk_verdict imk_calibrate_verdict(const imk_calibrate_log *session, size_t count,
                                          const imk_message *before, imk_result *result);
/** The worst level among the messages; good when there are none. The note "not_testable" of a
 *  calibration does not count. */
IMK_API imk_finding_level imk_verdict_level(const imk_verdict *verdict);
/** Show parameters, fit, remarks, verdict and a figure. @param poses  show the poses on the
 *  terminal, too */
IMK_API void imk_show_calibrate_log(const imk_calibrate_log *session, const imk_verdict *verdict,
                                    bool poses, imk_result *result);
/** Show the steps of a test programme and the accuracy reached. @param model  name of the unit's
 *  model */
IMK_API void imk_show_calibrate_plan(const imk_calibrate_plan *plan, const char *model,
                                     imk_result *result);
/** Write a test programme as a motion file, or as a temperature file.
 *  @param place  place of the test; NULL: not known
 *  @param text   obtained from malloc(); the caller frees it
 *  @param size   length of the text [bytes]
 *  @return IMK_ERROR_MEMORY */
IMK_API imk_status imk_calibrate_plan_text(const imk_calibrate_plan *plan,
                                           const imk_geodetic *place, char **text, size_t *size);
/** Write why imk_calibrate_log_run() failed, with the name of the record, if diagnostics of the
 *  record say more than the error.
 *  @return length of the text; 0: the error says all */
IMK_API size_t imk_calibrate_failure(const imk_calibrate_log *session, const imk_error *error,
                                     char *text, size_t size);
/** @} */

/** @name Drift
 *  @{ */
/** Reasons not to trust the figures: terms not stated, terms left out, errors beyond the linear
 * range, Monte Carlo runs that differ. All are warnings. */
IMK_API imk_verdict imk_drift_verdict(const imk_drift_models *r, imk_result *result);

/** Data shown with the figures. */
typedef struct imk_drift_shown {
    const char *motion; /**< name of the motion; NULL: at rest */
    uint64_t seed;      /**< seed of the Monte Carlo runs */
    imk_verdict verdict;
    const imk_result *model; /**< data of the last model under the key "model", from which values of
                                terms are shown; NULL: they are not shown */
    const imk_unstated *assumed; /**< one for each model: what was assumed of it
                                    (imk_model_assume_class()); NULL: nothing was */
    const char *filter_model; /**< file or name of the model that the filter is made for; NULL: that
                                 of the unit */
} imk_drift_shown;

/** Show the growth of errors, budgets, runs, the answer to the requirement, and figures. */
IMK_API void imk_show_drift(const imk_drift_models *r, const imk_drift_shown *shown,
                            imk_result *result);
/** Show the noise of a filter, how consistent it is, what makes the errors, and a figure.
 *  @param assumed  what was assumed of the model (imk_model_assume_class()); NULL: nothing was */
IMK_API void imk_show_tune(const imk_tune_model *r, const imk_unstated *assumed,
                           imk_result *result);
/** Write why no constant noise describes the errors; "" where one does.
 *  @param size  of `text` [bytes] */
IMK_API void imk_tune_verdict(const imk_tune_model *r, char *text, size_t size);
/** Show Monte Carlo runs alone. @param words  a description of the runs */
IMK_API void imk_show_drift_runs(const imk_drift_models *r, const char *words, imk_result *result);
/** @} */

/** @name Instruments
 *  @{ */
/** An instrument and its results. */
typedef struct imk_physics_shown {
    const imk_physics_log_settings *settings;
    const char *source;             /**< the instrument or file as the user named it */
    const char *name, *description; /**< those of the design; NULL or "": none */
    const imk_model *model;         /**< error model by closed forms, one axis */
    bool reduced;                   /**< show this model */
    const imk_physics_log *run;     /**< NULL: none */
    const imk_physics_sweep *sweep; /**< NULL: none */
} imk_physics_shown;

/** Show the list of all instruments. */
IMK_API void imk_show_instruments(imk_result *result);
/** Show a run with its figure and the error models; if there is neither, the design. Derived
 *  quantities are shown with the design and with the reduced model. Anything added afterwards goes
 *  to the page only. */
IMK_API void imk_show_physics(const imk_physics_shown *shown, imk_result *result);
/** Show design, derived quantities and error model on the page. */
IMK_API void imk_show_physics_design(const imk_physics_shown *shown, imk_result *result);
/** Show the experiments on the page, with a figure if their results can be drawn. */
IMK_API void imk_show_physics_sweep(const imk_physics_shown *shown, imk_result *result);
/** Show a view that is not empty, as a figure or an animation. */
IMK_API void imk_show_physics_view(const imk_physics_view *view, imk_result *result);
/** Add a view as a panel of a figure. */
IMK_API void imk_show_physics_panel(const imk_physics_view *view, imk_figure_builder *figure);
/** Make the animation of a view (imk_physics_view_moves()). Its texts and numbers belong to the
 *  view. */
IMK_API imk_animation imk_physics_animation(const imk_physics_view *view);
/** @} */

/** An evaluation, and what its test report states about the unit. Texts may be NULL. */
typedef struct imk_evaluate_shown {
    double confidence;
    size_t path_count;
    const char *const *path; /**< files of the readings */
    const char *rest_path;   /**< file of the log at rest */
    const char *unit, *serial, *operator_name, *laboratory, *date, *temperature;
    const char *report; /**< file of the page */
    bool levels;        /**< show the levels on the terminal, too */
    bool missed;        /**< a limit is exceeded */
    size_t channel_count, rest_count, limit_count;
    const imk_evaluate_channel *channel;
    const imk_evaluate_rest *rest;
    const imk_findings *findings; /**< of the job; NULL: none */
} imk_evaluate_shown;

/** Show data, tables and test report. Anything added afterwards goes to the page only. */
IMK_API void imk_show_evaluate(const imk_evaluate_shown *shown, imk_result *result);

/** Show the accuracy reached by records of several lengths, the lengths needed, and, if a curve was
 *  computed, a figure. */
IMK_API void imk_show_record_plan(const imk_record_plan *plan, const char *name,
                                  imk_result *result);

IMK_END_C
#endif
