/* SPDX-License-Identifier: Apache-2.0 */
/* Parts of the evaluation of a table: cells and noise, lines, extremes, steps. */
#ifndef IMUKI_EVALUATE_INTERNAL_H
#define IMUKI_EVALUATE_INTERNAL_H

#include "imukit/evaluate.h"

#include <math.h>

enum { IMKI_CELLS = 3, IMKI_DRAWS_MAX = 999, IMKI_DRAWS_MIN = 199, IMKI_DRAWS_ALL = 2000000 };

/* A level approached from one side: 0 down, 1 not known, 2 up. */
typedef struct imki_cell {
    size_t count;
    double mean, variance; /* of the mean, by the noise */
} imki_cell;

/* The table, divided. Arrays by row, by level, by cell (level * IMKI_CELLS + side), in the
 * workspace. */
typedef struct imki_evaluation {
    const imk_evaluation_table *table;
    const imk_evaluation_settings *settings;
    imk_evaluation *result;
    size_t rows, levels, draws;
    int runs;            /* one more than the largest number */
    double scale, width; /* full scale; of a level [reference] */
    int *level_of;       /* by row */
    signed char *side;   /* by row */
    double *reading;     /* by row, moved along the line to the level's reference */
    double *reference;   /* by level */
    imki_cell *cell;
    double *level_sigma;                       /* by level, of the mean of both sides */
    double *pattern, *noise, *shifted, *trial; /* by level, of a figure */
    double *weight, *moment, *centred;     /* by level: of the least-squares line of a pattern */
    double *draw;                          /* draws x levels normals */
    double *factor, *sorted, *none, *near; /* by draw */
    int *hull;                             /* 2 by level */
    size_t *order;                         /* by row */
    double *matrix;                        /* of the runs; NULL with one */
    double sigma;                          /* of a reading, from replicates or residuals */
    double student;                        /* quantile for the intervals; NaN: none are stated */
} imki_evaluation;

static inline imki_cell *imki_cell_of(const imki_evaluation *e, size_t row)
{
    return &e->cell[(size_t)e->level_of[row] * IMKI_CELLS + (size_t)e->side[row]];
}

static inline int imki_run_of(const imki_evaluation *e, size_t row)
{
    return e->table->run ? e->table->run[row] : 0;
}

/* Variance of one reading by the noise. */
static inline double imki_reading_variance(const imki_evaluation *e, size_t row)
{
    if (e->result->source == IMK_SCATTER_STATED)
        return e->table->sigma[row] * e->table->sigma[row];
    return e->result->source == IMK_SCATTER_NONE ? 0.0 : e->sigma * e->sigma;
}

static inline imk_evaluation_figure imki_unknown(void)
{
    const double none = (double)NAN;
    return (imk_evaluation_figure){none, none, none};
}

/* evaluate_cells.c: levels, sides and cells of the rows; mean readings. */
void imki_divide(imki_evaluation *e);
void imki_cell_means(imki_evaluation *e);
/* Move readings along the line to the reference of their level. */
void imki_to_level_references(imki_evaluation *e);
/* evaluate_scatter.c: how large the noise is; precision; means less what runs differ by. */
void imki_scatter(imki_evaluation *e);

/* evaluate_lines.c: least-squares line with its interval, asymmetry, lines of the runs. */
void imki_least_squares_line(imki_evaluation *e);
void imki_line_intervals(imki_evaluation *e);
void imki_asymmetry(imki_evaluation *e);
void imki_run_lines(imki_evaluation *e);
/* Mean of a level's sides, and the variance of it. */
double imki_level_mean(const imki_evaluation *e, size_t level, double *variance);

/* evaluate_extremes.c: figures that are the largest of something. */
void imki_extremes(imki_evaluation *e);
/* evaluate_steps.c: resolution and threshold. */
void imki_steps(imki_evaluation *e);

#endif
