/* SPDX-License-Identifier: Apache-2.0 */
/** @file evaluate_sheet.h
 *  The figures of an evaluation (evaluate.h) as a test report shows them: with names, definitions
 *  and units, and compared with limits. */
#ifndef IMUKIT_EVALUATE_SHEET_H
#define IMUKIT_EVALUATE_SHEET_H

#include "imukit/evaluate.h"
#include "imukit/identify.h"
#include "imukit/units.h"

IMK_BEGIN_C

enum {
    IMK_EVALUATE_CHANNELS = 16,
    IMK_EVALUATE_ROWS = 16,
    IMK_EVALUATE_LIMITS = 24,
    IMK_EVALUATE_NAME = 64
};

typedef enum imk_evaluate_verdict {
    IMK_EVALUATE_NONE = 0, /**< there is no limit */
    IMK_EVALUATE_MET,      /**< the whole interval is within the limit */
    IMK_EVALUATE_DOUBTFUL, /**< the value is within the limit, but the interval is not, or is not
                              known */
    IMK_EVALUATE_NOT_MET,
    IMK_EVALUATE_UNKNOWN /**< the figure is not determined */
} imk_evaluate_verdict;

/** One figure, ready to be shown. */
typedef struct imk_evaluate_row {
    const char *key, *title, *definition;
    imk_evaluation_figure figure; /**< SI */
    imk_unit unit;                /**< to show in */
    char si[80];                  /**< unit of the SI value */
    bool is_signed;               /**< a limit applies to the absolute value */
    int level;                    /**< level at which the figure occurs; -1: none */
    imk_evaluate_verdict verdict;
    const char *limit; /**< limit as it was stated; "": none */
} imk_evaluate_row;

/** The figures of a channel in their order. */
typedef struct imk_evaluate_sheet {
    size_t count;
    imk_evaluate_row row[IMK_EVALUATE_ROWS];
} imk_evaluate_sheet;

/** Readings and references of one axis, in SI, or in counts. */
typedef struct imk_evaluate_channel {
    char name[IMK_EVALUATE_NAME];
    imk_unit reference_unit, reading_unit; /**< to show in */
    size_t count;
    double *reference, *reading, *sigma; /**< sigma NULL: not known */
    signed char *direction;              /**< NULL: inferred from the order */
    int *run;
    size_t left_out; /**< number of stretches left out because the unit turns about other axes */
    bool of_log;     /**< readings are means of stretches of a log, so references are measured */
    imk_evaluation_settings settings;
    imk_evaluation result;
    imk_evaluation_level *level;
    imk_evaluate_sheet sheet;
} imk_evaluate_channel;

/** A channel of the log at rest. */
typedef struct imk_evaluate_rest {
    char name[IMK_EVALUATE_NAME];
    imk_unit unit; /**< to show in */
    bool identified;
    imk_identification result;
    imk_evaluate_sheet sheet;
} imk_evaluate_rest;

typedef struct imk_evaluate_limit {
    char key[40];
    char text[60];                      /**< the limit as it was stated */
    char refused_by[IMK_EVALUATE_NAME]; /**< channel for whose figure the limit is not possible */
    imk_error why;
    bool used;
} imk_evaluate_limit;

/** Fill the sheet of a channel from its result. */
IMK_API void imk_evaluate_channel_figures(imk_evaluate_channel *channel);
/** Fill the sheet of a channel at rest from its identification. */
IMK_API void imk_evaluate_rest_figures(imk_evaluate_rest *rest);
/** Keys of the figures that may have a limit. @return number of keys */
IMK_API size_t imk_evaluate_limit_keys(const char *key[IMK_EVALUATE_ROWS]);
/** Read limits: "linearity 0.05 %, zero 0.2 deg/s".
 *  @param text    NULL: none
 *  @param limits  room for IMK_EVALUATE_LIMITS
 *  @return IMK_ERROR_SYNTAX (error.found: the limit), IMK_ERROR_NAME_UNKNOWN (error.found: the key,
 *          error.expected: the nearest one), IMK_ERROR_WORKSPACE (too many) */
IMK_API imk_status imk_evaluate_limits_parse(const char *text, imk_evaluate_limit *limits,
                                             size_t *count, imk_error *error);
/** Is the figure beyond its limit, or not determined? */
IMK_API bool imk_evaluate_missed(const imk_evaluate_row *row);
/** A sentence that says so of a channel. @return its length, as snprintf() */
IMK_API size_t imk_evaluate_missed_text(const char *name, const imk_evaluate_row *row, char *text,
                                        size_t size);
/** Compare a figure of the channel `name` with the limits of the same key and dimension (gyros and
 *  accelerometers may have different ones). A limit is met when the whole interval is within it:
 *  conformity with measurement uncertainty [JCGM106]. Sets the verdict, and marks the limits used.
 */
IMK_API void imk_evaluate_assess(size_t limit_count, imk_evaluate_limit *limits, const char *name,
                                 imk_evaluate_row *row);
/** Text of a verdict: "met", "not met" …; "" without a limit. */
IMK_API const char *imk_evaluate_verdict_text(imk_evaluate_verdict verdict);

IMK_END_C
#endif
