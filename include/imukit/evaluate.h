/* SPDX-License-Identifier: Apache-2.0 */
/** @file evaluate.h
 *  The figures of a test laboratory from a table of references and readings: sensitivity, accuracy,
 *  precision, linearity, hysteresis, asymmetry, resolution, threshold, repeatability, each with an
 *  interval. Definitions and method: docs/evaluate.md.
 *
 *  Words: a *level* is one value of the reference; a *cell* is a level approached from one side
 *  (upwards, downwards, not known). Readings of one cell in one run are replicates: they differ by
 *  noise only, and show its size. A *run* is the time between switching on and off. */
#ifndef IMUKIT_EVALUATE_H
#define IMUKIT_EVALUATE_H

#include "imukit/repeatability.h"

IMK_BEGIN_C

enum { IMK_EVALUATION_RUNS_MAX = 64 };

/** The caller's arrays, in the order in which the readings were taken. */
typedef struct imk_evaluation_table {
    size_t count;
    const double *reference, *reading; /**< finite */
    const double *sigma; /**< 1 sigma of each reading, > 0, from its own scatter; NULL: not known */
    const signed char *direction; /**< 1: the reference rose to this value, -1: it fell, 0: not
                                     known; NULL: inferred from the order within the run */
    const int *run; /**< number of the run, 0 … IMK_EVALUATION_RUNS_MAX - 1; NULL: one run */
} imk_evaluation_table;

/** Start from imk_evaluation_default(), then change fields. */
typedef struct imk_evaluation_settings {
    uint32_t cookie;
    double confidence;  /**< of the intervals, two-sided; default 0.95 */
    double full_scale;  /**< full scale, to which percentages refer [reference]; 0 (default): the
                           largest |reference| of the table */
    double level_width; /**< references that differ by no more than this are one level [reference];
                           0 (default): 1e-9 of full scale */
    bool same_unit; /**< true (default): reading and reference are the same quantity in one unit, so
                       that their difference is an error. false: accuracy is not computed */
} imk_evaluation_settings;
/** The defaults stated above. */
IMK_API imk_evaluation_settings imk_evaluation_default(void);

/** A figure and its interval; NaN where the table does not determine it. */
typedef struct imk_evaluation_figure {
    double value, lower, upper;
} imk_evaluation_figure;

/** Where the size of the noise comes from. */
typedef enum imk_scatter_source {
    IMK_SCATTER_REPLICATES =
        0, /**< differences of readings within one cell, after the line of each run is removed */
    IMK_SCATTER_STATED, /**< table->sigma, because replicates have less than 3 degrees of freedom */
    IMK_SCATTER_RESIDUALS, /**< residuals of the least-squares line. They include nonlinearity and
                              hysteresis, so these two have no interval, and the other intervals are
                              too wide */
    IMK_SCATTER_NONE       /**< the noise is not known: there are no intervals */
} imk_scatter_source;

/** A line: reading = zero + sensitivity * reference. */
typedef struct imk_evaluation_line {
    double zero, sensitivity;
    double deviation; /**< largest distance of a level's mean from the line [reading] */
} imk_evaluation_line;

/** One level. If runs do not share all levels, the differences between runs are removed from the
 *  means. */
typedef struct imk_evaluation_level {
    double reference;
    double reading;   /**< mean reading; if there are both directions, the mean of their means */
    double sigma;     /**< 1 sigma of the reading, caused by noise */
    double up, down;  /**< mean of each direction; NaN: none */
    double deviation; /**< from the least-squares line [reading] */
    double deviation_best; /**< from the minimax line [reading] */
    size_t count;          /**< number of readings */
} imk_evaluation_level;

/** Result of an evaluation. Figures with unit [1] are relative to full scale, that is, to the
 *  change of the reading over it. Extremes (accuracy, linearity, hysteresis) are values of these
 *  readings, and noise makes them larger on average; their interval is for a noise-free unit at the
 *  same levels. All figures hold for these runs; the repeatability tells how other runs differ. */
typedef struct imk_evaluation {
    size_t levels, cells, runs;
    double full_scale;         /**< [reference] */
    imk_scatter_source source; /**< where the size of the noise comes from */
    double freedom; /**< degrees of freedom of the noise; infinite: stated by table->sigma */
    imk_evaluation_figure precision;   /**< standard deviation of a reading under repeatability
                                          conditions [reading]; NaN without replicates */
    imk_evaluation_figure sensitivity; /**< slope of the least-squares line [reading/reference] */
    imk_evaluation_figure zero;        /**< reading of that line at reference 0 [reading] */
    imk_evaluation_figure accuracy;    /**< largest |mean - reference| of a level [reading] */
    imk_evaluation_figure coverage;    /**< half width of the interval about the reference that
                                          contains single readings at the worst level with the stated
                                          confidence, noise and mean error included [reading] */
    imk_evaluation_figure linearity;   /**< from the least-squares line [1] */
    imk_evaluation_figure linearity_best; /**< from the minimax line [1] */
    imk_evaluation_figure hysteresis;     /**< largest |up - down| [1] */
    imk_evaluation_figure asymmetry;      /**< (K+ - K-)/mean, with sign, of lines that meet at
                                               reference 0 [1] */
    /** Smallest step between successive levels such that it and all larger steps give at least half
     *  of their change [reference]; NaN: all do, and it is finer than was tested; infinite:
     *  the largest does not. lower: largest step that certainly does not, 0: none; upper: smallest
     *  from which all certainly do, NaN: none. */
    imk_evaluation_figure resolution;
    imk_evaluation_figure threshold; /**< the same for steps from reference 0 */
    /** Smallest ones tested that the noise allows to assess; NaN: none. */
    double smallest_step, smallest_input;
    /** Least-squares line of all readings; minimax line of levels. */
    imk_evaluation_line line, best;
    /** Level with the largest deviation; -1: none. */
    int accuracy_level, linearity_level, hysteresis_level;
    int alternation[3]; /**< levels at which the minimax line has its largest deviation with
                           alternating sign, which proves that no line is better; -1: none */
    /** Zero from run to run [reading]; its `runs` is 0 with fewer than two runs. */
    imk_repeatability run_zero;
    imk_repeatability run_sensitivity;           /**< sensitivity from run to run, relative [1] */
    double run_line[IMK_EVALUATION_RUNS_MAX][2]; /**< zero and sensitivity of each; NaN: none */
} imk_evaluation;

/** Bytes of workspace. */
IMK_API size_t imk_evaluation_workspace_size(const imk_evaluation_table *table);

/** Evaluate a table. Takes some ms for 100 levels, because intervals of extremes are found by
 *  simulation, always with the same random numbers.
 *  @param level  room for `capacity` levels, in ascending order; result->levels also counts levels
 *                beyond the capacity
 *  @return IMK_ERROR_TOO_SHORT (less than two readings), IMK_ERROR_NOT_FINITE (field, index: row),
 *          IMK_ERROR_RANGE (settings; a sigma, direction or run, index: row), IMK_ERROR_WORKSPACE,
 *          IMK_ERROR_UNINITIALISED */
IMK_API imk_status imk_evaluate(const imk_evaluation_table *table,
                                const imk_evaluation_settings *settings,
                                imk_evaluation_level *level, size_t capacity,
                                imk_evaluation *result, void *workspace, size_t workspace_size,
                                imk_error *error);

/** The line whose largest distance from points is smallest. It is exact, by the narrowest strip
 *  about the convex hull [CHENEY1966].
 *  @param n            2 or more
 *  @param x            strictly ascending
 *  @param alternation  3 indices at which the distance is largest with alternating sign; -1 with
 *                      two points
 *  @param scratch      2 n ints */
IMK_API imk_evaluation_line imk_minimax_line(size_t n, const double *x, const double *y,
                                             int alternation[3], int *scratch);

IMK_END_C
#endif
