/* SPDX-License-Identifier: Apache-2.0 */
/* Between the parts of the thermal analysis (thermal.h). */
#ifndef IMUKIT_THERMAL_INTERNAL_H
#define IMUKIT_THERMAL_INTERNAL_H

#include "imukit/correct.h"
#include "imukit/thermal.h"

enum {
    IMKI_THERMAL_BLOCKS = 96, /* means a log is reduced to */
    IMKI_THERMAL_PARTS = 4,   /* pieces of a block: what is disturbed is looked for in these */
    IMKI_THERMAL_PIECES = IMKI_THERMAL_BLOCKS * IMKI_THERMAL_PARTS,
    /* Columns: 1, z … z^5, dT/dt, state of hysteresis; z = (T - reference)/scale */
    IMKI_THERMAL_RATE = 6,
    IMKI_THERMAL_STATE = 7,
    IMKI_THERMAL_COLUMNS = 8,
    IMKI_THERMAL_AXES = 2 * IMK_AXES_MAX, /* gyros, then accelerometers */
    IMKI_THERMAL_FLICKERS = 10,
    IMKI_THERMAL_WALKS = 7,
    IMKI_THERMAL_GRID = IMKI_THERMAL_FLICKERS * IMKI_THERMAL_WALKS
};

/* ---- thermal_blocks.c: a log as means over blocks of samples -----------------------------------
 */

typedef struct imki_thermal_blocks {
    size_t count, samples, left_out;
    double per_block;                                             /* samples, on average */
    size_t first[IMKI_THERMAL_PIECES], last[IMKI_THERMAL_PIECES]; /* sample */
    double begin[IMKI_THERMAL_PIECES];                            /* [s] */
    double end[IMKI_THERMAL_PIECES];                              /* [s] */
    double size[IMKI_THERMAL_PIECES];                             /* samples */
    double temperature[IMKI_THERMAL_PIECES];                      /* mean [K] */
    double rate[IMKI_THERMAL_PIECES];                             /* slope [K/s] */
    double state[IMKI_THERMAL_PIECES];                            /* of hysteresis */
    double column[IMKI_THERMAL_COLUMNS][IMKI_THERMAL_PIECES];
    int direction[IMKI_THERMAL_PIECES]; /* 1 warming, -1 cooling, 0 neither yet */
    int pass[IMKI_THERMAL_PIECES];      /* number of the pass */
    bool disturbed[IMKI_THERMAL_AXES][IMKI_THERMAL_PIECES]; /* pieces replaced */
    double refused[IMKI_THERMAL_AXES];                      /* share of them */
    bool used[IMKI_THERMAL_AXES];                           /* axis has readings */
    double reading[IMKI_THERMAL_AXES][IMKI_THERMAL_PIECES];
    double mean[IMKI_THERMAL_AXES], scatter[IMKI_THERMAL_AXES];
    double minimum, maximum, reference; /* [K] */
    double scale;                       /* of z [K] */
    double rate_scale;                  /* of the column of rates [K/s] */
} imki_thermal_blocks;

/* A reading in SI, less the reference along its axis. NaN outside the range, or when missing. */
double imki_thermal_reading(const imk_test_record *record, const imk_model *model, int sensor,
                            int axis, size_t sample);
/* Time of a sample [s]. */
static inline double imki_thermal_time(const imk_test_record *record, size_t sample)
{
    return record->time ? record->time[sample] : (double)sample * record->dt;
}
/* True when the sample enters the means: a temperature, and readings on every axis used. */
bool imki_thermal_usable(const imk_test_record *record, const imk_model *model,
                         const imki_thermal_blocks *blocks, size_t sample);
/* Into pieces, IMKI_THERMAL_PARTS times as many as there will be blocks. */
imk_status imki_thermal_divide(const imk_test_record *record, const imk_model *model,
                               double reference, imki_thermal_blocks *blocks, imk_error *error);
/* Pieces become blocks. */
void imki_thermal_merge(imki_thermal_blocks *blocks);
/* First sample at which the unit has another attitude than at the beginning; count: none. */
size_t imki_thermal_turned(const imk_test_record *record, const imk_model *model);

/* ---- thermal_screen.c: knocks, hands, power cuts ------------------------------------------------
 */

/* Replace pieces that stand out of what is beside them. */
void imki_thermal_screen(imki_thermal_blocks *blocks);

/* ---- thermal_noise.c: correlated noise of the means ---------------------------------------------
 */

/* What a weighted fit needs to know, for one make-up of the noise. */
typedef struct imki_thermal_moments {
    double log_determinant;
    double xx[IMKI_THERMAL_COLUMNS * IMKI_THERMAL_COLUMNS];
    double xy[IMKI_THERMAL_AXES][IMKI_THERMAL_COLUMNS];
    double yy[IMKI_THERMAL_AXES];
} imki_thermal_moments;

/* What the noise of a block's mean is made of. */
typedef struct imki_thermal_variance {
    double white;         /* of a block of usual size [unit^2] */
    double flicker, walk; /* factors of F and R [unit^2] */
    double freedom;       /* how well they are known: degrees of freedom of their sum */
} imki_thermal_variance;

typedef struct imki_thermal_work {
    imki_thermal_blocks blocks;
    double flicker[IMKI_THERMAL_BLOCKS * IMKI_THERMAL_BLOCKS]; /* F */
    double walk[IMKI_THERMAL_BLOCKS * IMKI_THERMAL_BLOCKS];    /* R */
    double factor[IMKI_THERMAL_BLOCKS * IMKI_THERMAL_BLOCKS];  /* Cholesky factor of V, see below */
    int factor_of; /* point of the grid it belongs to; -1: none */
    imki_thermal_moments moments[IMKI_THERMAL_GRID];
    double square_moment[IMKI_THERMAL_COLUMNS * IMKI_THERMAL_COLUMNS]; /* X^T X */
    double white_moment[IMKI_THERMAL_COLUMNS * IMKI_THERMAL_COLUMNS];  /* X^T D X */
    double flicker_moment[IMKI_THERMAL_COLUMNS * IMKI_THERMAL_COLUMNS];
    double walk_moment[IMKI_THERMAL_COLUMNS * IMKI_THERMAL_COLUMNS];
    double reading_moment[IMKI_THERMAL_AXES][IMKI_THERMAL_COLUMNS]; /* X^T y */
    imki_thermal_variance variance[IMKI_THERMAL_AXES];
    /* What these are means over: weight of each point of the grid, and white variance there. */
    double weight[IMKI_THERMAL_AXES][IMKI_THERMAL_GRID],
        level[IMKI_THERMAL_AXES][IMKI_THERMAL_GRID];
    int best[IMKI_THERMAL_AXES]; /* most likely point of the grid */
    unsigned available;          /* columns that the log tells apart, bit k: column k */
    imk_correction correction;   /* of the readings at the reference: thermal_observe.c */
} imki_thermal_work;

/* Fill everything else of a work whose blocks are filled. */
void imki_thermal_weigh(imki_thermal_work *work, int order_max, bool both_directions);
/* work->factor of V/white at a point, transposed: factor[k n + i] = L_ik, i >= k. */
void imki_thermal_factor(imki_thermal_work *work, int point);
/* x <- L^-1 x */
void imki_thermal_whiten(const imki_thermal_work *work, double *x);
/* Weighted residual sum of squares of a fit with the columns of `mask`, in units of the white
 * variance; logarithm of |X^T V^-1 X| in *information unless NULL. Infinite when singular. */
double imki_thermal_weighted_rss(const imki_thermal_work *work, int axis, unsigned mask, int point,
                                 double *information);

/* Chance of a value as large as the square root of `square` if nothing but noise is there, of which
 * these are the shares of the three kinds in its variance. */
double imki_thermal_chance(const imki_thermal_work *work, int axis, double square, double white,
                           double flicker, double walk);

/* ---- thermal_fit.c: fits ------------------------------------------------------------------------
 */

typedef struct imki_thermal_estimate {
    double value[IMKI_THERMAL_COLUMNS];
    double covariance[IMKI_THERMAL_COLUMNS * IMKI_THERMAL_COLUMNS];
    double chance[IMKI_THERMAL_COLUMNS]; /* that noise alone gives as large a value; else 1 */
} imki_thermal_estimate;

/* Columns of a polynomial. */
static inline unsigned imki_thermal_powers(int order)
{
    return (2u << order) - 1;
}
/* Indices of the bits of a mask. @return how many */
size_t imki_thermal_list(unsigned mask, int index[IMKI_THERMAL_COLUMNS]);
/* Fit of one axis with the columns of `mask`; false: singular. */
bool imki_thermal_fit(const imki_thermal_work *work, int axis, unsigned mask,
                      imki_thermal_estimate *estimate);
/* Cross-validation with the columns of `mask`: mean square error of each fold. */
enum { IMKI_THERMAL_FOLDS = 24 };
void imki_thermal_validate(const imki_thermal_work *work, int axis, unsigned mask,
                           double error[IMKI_THERMAL_FOLDS]);

/* ---- thermal_branches.c: warming against cooling ----------------------------------------------
 */
void imki_thermal_passes(imki_thermal_blocks *blocks, imk_thermal_findings *findings);
/* @return the least chance that noise alone makes a gap as large; 1: there is no gap */
double imki_thermal_gaps(imki_thermal_work *work, int axis, const imk_thermal_findings *findings,
                         imk_thermal_axis *out);
void imki_thermal_lag(imki_thermal_work *work, int axis, int order, imk_thermal_axis *out);

/* ---- thermal.c: what observing needs besides the findings; work stays in the workspace ---- */
imki_thermal_work *imki_thermal_work_of(void *workspace);
unsigned imki_thermal_columns(const imk_thermal_axis *axis);

#endif
