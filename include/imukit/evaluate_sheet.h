/* SPDX-License-Identifier: Apache-2.0 */
/** @file evaluate_sheet.h
 *  The figures of an evaluation (evaluate.h) as a test report has them: with names, definitions and
 *  units, held against limits. */
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
    IMK_EVALUATE_NONE = 0, /**< no limit */
    IMK_EVALUATE_MET,      /**< the whole interval is within */
    IMK_EVALUATE_DOUBTFUL, /**< the value is, the interval is not, or is not known */
    IMK_EVALUATE_NOT_MET,
    IMK_EVALUATE_UNKNOWN /**< the figure is not determined */
} imk_evaluate_verdict;

/** One figure, as it is shown. */
typedef struct imk_evaluate_row {
    const char *key, *title, *definition;
    imk_evaluation_figure figure; /**< SI */
    imk_unit unit;                /**< to show in */
    char si[80];                  /**< unit of the SI value */
    bool is_signed;               /**< a limit is of its amount */
    int level;                    /**< where it is; -1: no such place */
    imk_evaluate_verdict verdict;
    const char *limit; /**< as it was given; "": none */
} imk_evaluate_row;

/** The figures of a channel in their order. */
typedef struct imk_evaluate_sheet {
    size_t count;
    imk_evaluate_row row[IMK_EVALUATE_ROWS];
} imk_evaluate_sheet;

/** What one axis read, and what it should have. SI, counts as they are. */
typedef struct imk_evaluate_channel {
    char name[IMK_EVALUATE_NAME];
    imk_unit reference_unit, reading_unit; /**< to show in */
    size_t count;
    double *reference, *reading, *sigma; /**< sigma NULL: not known */
    signed char *direction;              /**< NULL: from the order */
    int *run;
    size_t left_out; /**< stretches that turn about other axes */
    bool of_log;     /**< means of stretches: references are measured */
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
    char text[60];                      /**< the quantity as it was given */
    char refused_by[IMK_EVALUATE_NAME]; /**< the channel of whose figure it is no limit */
    imk_error why;
    bool used;
} imk_evaluate_limit;

/** Fill the sheet of a channel from its result. */
IMK_API void imk_evaluate_channel_figures(imk_evaluate_channel *channel);
/** Fill the sheet of a channel at rest from what was identified. */
IMK_API void imk_evaluate_rest_figures(imk_evaluate_rest *rest);
/** The keys of figures that may have a limit. @return how many */
IMK_API size_t imk_evaluate_limit_keys(const char *key[IMK_EVALUATE_ROWS]);
/** Hold a figure of the channel `name` against the limits: of its key and dimension, since gyros
 * and accelerometers may have one each. A limit is surely met when the whole interval is within it,
 * as conformity is decided with measurement uncertainty [JCGM106]. Sets the verdict, and which
 * limits were used. */
IMK_API void imk_evaluate_assess(size_t limit_count, imk_evaluate_limit *limits, const char *name,
                                 imk_evaluate_row *row);
/** "met", "not met"; "" without a limit. */
IMK_API const char *imk_evaluate_verdict_text(imk_evaluate_verdict verdict);

IMK_END_C
#endif
