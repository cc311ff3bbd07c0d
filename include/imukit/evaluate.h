/* SPDX-License-Identifier: Apache-2.0 */
/** @file evaluate.h
 *  The figures of a test laboratory from a table of references and readings: sensitivity,
 *  accuracy, precision, linearity, hysteresis, asymmetry, resolution, threshold, repeatability,
 *  each with an interval. Definitions and method: docs/evaluate.md.
 *
 *  Words: a *level* is one value of the reference; a *cell* is a level approached from one side
 *  (upwards, downwards, not known). Readings of one cell in one run are replicates: they differ by
 *  noise only, and tell how large it is. A *run* is what lies between switching on and off. */
#ifndef IMUKIT_EVALUATE_H
#define IMUKIT_EVALUATE_H

#include "imukit/repeatability.h"

IMK_BEGIN_C

enum { IMK_EVALUATION_RUNS_MAX = 64 };

/** The caller's arrays, in the order in which the readings were taken. */
typedef struct imk_evaluation_table {
    size_t count;
    const double *reference, *reading; /**< finite */
    const double *sigma; /**< of each reading, > 0, as its own scatter tells; NULL: not known */
    const signed char *direction; /**< 1: the reference rose to it, -1: fell, 0: not known; NULL:
                                       inferred from the order within the run */
    const int *run; /**< number of the run, 0 … IMK_EVALUATION_RUNS_MAX - 1; NULL: one run */
} imk_evaluation_table;

/** Start from imk_evaluation_default(), then change fields. */
typedef struct imk_evaluation_settings {
    uint32_t cookie;
    double confidence;  /**< of the intervals, two-sided; default 0.95 */
    double full_scale;  /**< what % of full scale is of [reference]; 0 (default): the largest
                             |reference| of the table */
    double level_width; /**< references not further apart are one level [reference]; 0 (default):
                             1e-9 of full scale */
    bool same_unit;     /**< reading and reference are one quantity in one unit, so that their
                             difference is an error; true. false: no accuracy */
} imk_evaluation_settings;
/** The values named above. */
IMK_API imk_evaluation_settings imk_evaluation_default(void);

/** A figure and its interval; NaN where the table does not determine it. */
typedef struct imk_evaluation_figure {
    double value, lower, upper;
} imk_evaluation_figure;

/** How large the noise is, was found from */
typedef enum imk_scatter_source {
    IMK_SCATTER_REPLICATES = 0, /**< readings of one cell, runs' own lines taken out */
    IMK_SCATTER_STATED,         /**< table->sigma: less than 3 degrees of freedom in replicates */
    IMK_SCATTER_RESIDUALS,      /**< the least-squares line: contains nonlinearity and hysteresis,
                                     so that these two have no interval and others too wide ones */
    IMK_SCATTER_NONE            /**< nothing: no intervals */
} imk_scatter_source;

/** A line: reading = zero + sensitivity * reference. */
typedef struct imk_evaluation_line {
    double zero, sensitivity;
    double deviation; /**< largest distance of a level's mean from it [reading] */
} imk_evaluation_line;

/** One level. Means have the runs' differences taken out where runs do not share all levels. */
typedef struct imk_evaluation_level {
    double reference;
    double reading;        /**< mean; of both directions' means where there are both */
    double sigma;          /**< of it, by the noise */
    double up, down;       /**< mean of each direction; NaN: none */
    double deviation;      /**< from the least-squares line [reading] */
    double deviation_best; /**< from the minimax line [reading] */
    size_t count;          /**< readings */
} imk_evaluation_level;

/** What was found. Figures named [1] are of full scale: of the reading's change over it. Extremes
 *  (accuracy, linearity, hysteresis) are values of these readings, which noise makes larger on the
 *  average; their interval is that of the figure a noise-free unit would show at the same levels.
 *  All hold for these runs; what another run would do is said by the repeatability. */
typedef struct imk_evaluation {
    size_t levels, cells, runs;
    double full_scale;                 /**< [reference] */
    imk_scatter_source source;         /**< of the noise */
    double freedom;                    /**< its degrees of freedom; infinite: stated */
    imk_evaluation_figure precision;   /**< standard deviation of a reading under repeatability
                                            conditions [reading]; NaN but with replicates */
    imk_evaluation_figure sensitivity; /**< slope of the least-squares line [reading/reference] */
    imk_evaluation_figure zero;        /**< reading of that line at reference 0 [reading] */
    imk_evaluation_figure accuracy;    /**< largest |mean - reference| of a level [reading] */
    imk_evaluation_figure coverage;    /**< half width about the reference that holds the stated
                                            confidence of single readings at the worst level, noise
                                            and mean error together [reading] */
    imk_evaluation_figure linearity;   /**< from the least-squares line [1] */
    imk_evaluation_figure linearity_best; /**< from the minimax line [1] */
    imk_evaluation_figure hysteresis;     /**< largest |up - down| [1] */
    imk_evaluation_figure asymmetry;      /**< (K+ - K-)/mean, with sign, of lines that meet at
                                               reference 0 [1] */
    imk_evaluation_figure resolution;     /**< smallest step between successive levels from which on
                                               every step gives at least half of its change
                                               [reference]; lower: largest step that surely does not,
                                               0: none; upper: from where on all surely do, NaN: none */
    imk_evaluation_figure threshold;      /**< the same from readings at reference 0 */
    double smallest_step, smallest_input; /**< tested, as far as noise lets them be assessed; NaN */
    imk_evaluation_line line, best; /**< by least squares of all readings; minimax of levels */
    int accuracy_level, linearity_level, hysteresis_level; /**< where the largest is; -1: none */
    int alternation[3]; /**< levels at which the minimax line has its largest deviation, with
                             alternating sign: proof that no line does better; -1: none */
    imk_repeatability run_zero;        /**< from run to run [reading]; runs 0: less than two */
    imk_repeatability run_sensitivity; /**< relative [1] */
    double run_line[IMK_EVALUATION_RUNS_MAX][2]; /**< zero and sensitivity of each; NaN: none */
} imk_evaluation;

/** Bytes of workspace. */
IMK_API size_t imk_evaluation_workspace_size(const imk_evaluation_table *table);

/** Evaluate. Some ms for a table of 100 levels: intervals of extremes are found by simulation with
 *  numbers that are always the same.
 *  @param level  room for `capacity` levels, ascending; result->levels also counts those beyond
 *  @return IMK_ERROR_TOO_SHORT (less than two readings), IMK_ERROR_NOT_FINITE (field, index: row),
 *          IMK_ERROR_RANGE (settings; a sigma, direction or run, index: row), IMK_ERROR_WORKSPACE,
 *          IMK_ERROR_UNINITIALISED */
IMK_API imk_status imk_evaluate(const imk_evaluation_table *table,
                                const imk_evaluation_settings *settings,
                                imk_evaluation_level *level, size_t capacity,
                                imk_evaluation *result, void *workspace, size_t workspace_size,
                                imk_error *error);

/** The line whose largest distance from points is smallest, exactly: that of the convex hull's
 *  narrowest strip [CHENEY1966].
 *  @param n            2 or more
 *  @param x            strictly ascending
 *  @param alternation  3 indices at which the distance is largest with alternating sign; -1 with
 *                      two points
 *  @param scratch      2 n ints */
IMK_API imk_evaluation_line imk_minimax_line(size_t n, const double *x, const double *y,
                                             int alternation[3], int *scratch);

IMK_END_C
#endif
