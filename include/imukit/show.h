/* SPDX-License-Identifier: Apache-2.0 */
/** @file show.h
 *  The results of jobs, made ready to be shown: each function adds data, tables and figures to an
 *  imk_result (result.h). `name` is what the record is called, such as its file. */
#ifndef IMUKIT_SHOW_RESULTS_H
#define IMUKIT_SHOW_RESULTS_H

#include "imukit/allan_log.h"
#include "imukit/calibrate_log.h"
#include "imukit/earth.h"
#include "imukit/identify_several.h"
#include "imukit/record_plan.h"
#include "imukit/result.h"
#include "imukit/spectrum_log.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Deviations: a table for each statistic and kind of sensor, a figure. */
IMK_API void imk_show_allan_log(const imk_allan_log *allan, const char *name, imk_result *result);

/** Densities, lines and parameters: a table for each kind of sensor, a figure. */
IMK_API void imk_show_spectrum_log(const imk_spectrum_log *spectrum, const char *name,
                                   imk_result *result);

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

IMK_API imk_verdict imk_identify_verdict(const imk_identify_log *log, const char *label,
                                         imk_result *result);
/** @param labels  of the records */
IMK_API imk_verdict imk_several_verdict(const imk_identify_several *several,
                                        const char *const *labels, imk_result *result);
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
/** Doubts, findings over temperature and warnings as sentences; FAILURE: of no use.
 *  @param before  `count` messages on the way here */
IMK_API imk_verdict imk_calibrate_verdict(const imk_calibrate_log *bench, size_t count,
                                          const imk_message *before, imk_result *result);
/** The worst there is; good when there is nothing. */
IMK_API imk_finding_level imk_verdict_level(const imk_verdict *verdict);
/** Parameters, fit, remarks, verdict and a figure. @param poses  also on the terminal */
IMK_API void imk_show_calibrate_log(const imk_calibrate_log *bench, const imk_verdict *verdict,
                                    bool poses, imk_result *result);
/** The steps of a programme, and what is reached. @param model  what the unit's is called */
IMK_API void imk_show_calibrate_plan(const imk_calibrate_plan *plan, const char *model,
                                     imk_result *result);
/** A programme as a motion file, or a temperature file. @param place  NULL: not known
 *  @param text  obtained from malloc(), the caller's @return IMK_ERROR_MEMORY */
IMK_API imk_status imk_calibrate_plan_text(const imk_calibrate_plan *plan,
                                           const imk_geodetic *place, char **text, size_t *size);
/** Why imk_calibrate_log_run() failed, with the name of the record: doubts about it say more than
 *  the error. @return length of the text; 0: nothing is to be said beyond the error */
IMK_API size_t imk_calibrate_failure(const imk_calibrate_log *bench, const imk_error *error,
                                     char *text, size_t size);
/** @} */

/** What records of several lengths tell, how long they must be, and, of a curve, a figure. */
IMK_API void imk_show_record_plan(const imk_record_plan *plan, const char *name,
                                  imk_result *result);

#ifdef __cplusplus
}
#endif
#endif
