/* SPDX-License-Identifier: Apache-2.0 */
/* The estimator's working state. Unknowns are of two kinds:
 *
 *   globals  parameters, then three angles of each fixture whose mounting is not exact, then what
 *            the gyros of a record are off by together, then the vertical part of the Earth's rate
 *            when the latitude is not known
 *   locals   two angles of each direction of gravity, three of each placement; where turns join
 *            rests and it matters, two components of the Earth's horizontal rate at a rest
 *            (calibration_earth.c); turns tie the locals of two observations, so that their normal
 *            matrix is banded
 *
 * An item is an observation (0 … observations - 1) or a turn (observations …). */
#ifndef IMUKIT_ESTIMATOR_INTERNAL_H
#define IMUKIT_ESTIMATOR_INTERNAL_H

#include "axis_reading_internal.h"
#include "calibration_internal.h"

enum {
    IMKI_GLOBALS_MAX = IMK_CORRELATED_MAX + 3 * IMK_FIXTURES_MAX + IMK_OFFSETS_MAX + 1,
    IMKI_ROWS_MAX = 2 * IMK_AXES_MAX,
    IMKI_LOCALS_OF_ROW = 6
};

/* Groups of rows: those of the result, and apart from the holds of each sensor its blocks where the
 * input moves, which are many and share no error of a hold. */
enum { IMKI_GROUP_MOVING = IMK_GROUPS, IMKI_GROUPS = IMKI_GROUP_MOVING + 2 };

/* What has a variance factor of its own: the groups of observations, or where a group's residuals
 * are enough, each of its axes instead; always each axis where the input moves; and what is assumed
 * before, placements and terms. */
enum {
    IMKI_PART_PLACEMENT = IMK_GROUPS,
    IMKI_PART_TERMS,
    IMKI_PART_MOVING, /* axes of gyros, then of accelerometers */
    IMKI_PART_AXIS = IMKI_PART_MOVING + 2 * IMK_AXES_MAX, /* the same of holds */
    IMKI_PARTS = IMKI_PART_AXIS + 2 * IMK_AXES_MAX
};

/* One scalar: observed less predicted, and the derivatives of the prediction. */
typedef struct imki_row {
    int group, part;
    int sensor, axis;       /* of a reading; axis is the component of a turn */
    double residual, sigma; /* [unit], sigma as stated */
    double known_variance;  /* besides, which no factor multiplies: the Earth's horizontal rate */
    double at_most;         /* of that: a bound, which residuals need not show */
    double share;           /* of the variance that the factor multiplies */
    int locals;
    size_t local[IMKI_LOCALS_OF_ROW];
    double by_local[IMKI_LOCALS_OF_ROW];
    int globals;
    int global[IMKI_GLOBALS_MAX];
    double by_global[IMKI_GLOBALS_MAX];
} imki_row;

/* Normal equations: locals in a band (element j of row i at i (width + 1) + width + j - i), border,
 * globals; with their factors. */
typedef struct imki_normal {
    size_t locals, width, globals;
    double *band, *border, *core; /* locals (width+1); locals x globals; globals^2 */
    double *local_gradient, *global_gradient;
    double *factor; /* Cholesky factor of the band */
    double *half;   /* factor^-1 border, locals x globals */
    double *schur;  /* Cholesky factor of the eliminated core */
    double *local_step, *global_step;
    double *local_inverse; /* inverse of the band's matrix, where the band is */
    double *whole;         /* band^-1 border */
    double *covariance;    /* of the globals */
} imki_normal;

/* A turn, linearised about the parameters it was integrated with. */
typedef struct imki_linear_turn {
    double turn[9], angle, duration;
    double sigma; /* without what the chain of the Earth's horizontal rate tells */
    bool usable;
} imki_linear_turn;

typedef struct imki_point {
    double global[IMKI_GLOBALS_MAX];
    double (*attitude)[3];   /* per observation: vertical, or rotation of a placement */
    double (*horizontal)[3]; /* per observation: the Earth's horizontal rate, body axes [rad/s] */
} imki_point;

/* Slow noise that the model states, or that is assumed (calibration_slow_noise.c). */
typedef struct imki_slow_noise {
    bool stated;       /* by the model */
    double assumed[2]; /* flicker of a sensor for which the model states nothing [rad/s], [m/s^2] */
    size_t count;      /* observations that have a time; 0: no slow noise */
    int *order;        /* of these, by record and time */
    double *covariance; /* what it adds to that of the globals */
    double *axis;       /* the same of one axis */
    void *sums;         /* along a record, imki_slow_noise_sums() bytes */
} imki_slow_noise;

typedef struct imki_estimator {
    imk_calibration *problem; /* a copy: the frame solved in, the model at the current point */
    size_t observations, turns, parameters, globals, locals, items;
    double start[IMK_CORRELATED_MAX];  /* of the parameters: where priors pull to */
    double *place[IMK_CORRELATED_MAX]; /* in the model */
    int axis_parameters[2][IMK_AXES_MAX];
    uint8_t axis_parameter[2][IMK_AXES_MAX][IMK_CORRELATED_MAX];
    int fixture_global[IMK_FIXTURES_MAX];    /* first of its angles; -1: exact */
    int offset_global[IMK_TEST_RECORDS_MAX]; /* first of its gyros; -1: none */
    double offset_sigma[IMK_TEST_RECORDS_MAX];
    int vertical_global; /* -1: the latitude is known, or nothing depends on it */
    double vertical_rate, vertical_sigma, horizontal_variance; /* of the Earth at rest */
    int *local_first;                                          /* per observation; -1: none */
    bool *earth; /* per observation: its third and fourth local are the Earth's horizontal rate */
    int *turn_into; /* per observation: the turn that carries that rate to it; -1: none */
    double (*sigma)[2][IMK_AXES_MAX];       /* per observation, SI */
    double (*known_variance)[IMK_AXES_MAX]; /* per observation, of gyros */
    double (*reading)[2][IMK_AXES_MAX];     /* per observation, SI; NaN: not observed */
    double *weight;                         /* per item: 1 … 0 */
    imki_linear_turn *turn;
    double *turn_jacobian; /* per turn 3 x parameters */
    bool turns_known;      /* integrated at least once */
    double turn_reference[IMKI_GLOBALS_MAX];
    double factor[IMKI_PARTS]; /* of sigmas */
    bool by_axis[2];           /* axes of a sensor have factors of their own */
    double added[2]; /* > 0: the factor is of this sigma, added to those stated [rad/s], [m/s^2] */
    bool turns_stated; /* the factor of turns is 1, whatever their residuals */
    imki_point now, trial, best;
    double best_factor[IMKI_PARTS];
    double *best_weight; /* per item */
    imki_normal normal;
    imki_slow_noise slow;
    imki_row *row;       /* 2 IMKI_ROWS_MAX */
    double *seen;        /* of each of them, what the globals see */
    double *moved;       /* ... times their covariance */
    double *squares;     /* IMKI_PARTS globals^2 */
    double *information; /* of the factors: imki_freedoms_room() */
    double *distance;    /* per item and group of three: see statistics */
    double *sorted;
    unsigned char *state; /* per item */
    imk_calibration_result *result;
    double cost;
    int iterations;
} imki_estimator;

/* Weight left to what is refused: enough to let its own attitude follow it. */
#define IMKI_WEIGHT_REFUSED 1e-8

/* ---- calibration_setup.c ---- */
size_t imki_estimator_size(const imk_calibration *calibration);
imk_status imki_estimator_start(imki_estimator *e, const imk_calibration *calibration,
                                bool readings_matter, void *workspace, size_t workspace_size,
                                imk_error *error);

/* ---- calibration_earth.c: the Earth's rate at rest in an unknown attitude ---- */
/* Before the locals are counted. @return whether rests have its horizontal part as unknowns */
bool imki_earth_start(imki_estimator *e);
/* What it adds to the variances of readings and takes from those of turns, at the first attitudes.
 */
void imki_earth_spread(imki_estimator *e);
/* Cost of what is known of the horizontal parts; into the normal equations when `build`. */
double imki_earth_cost(imki_estimator *e, const imki_point *point, bool build);
/* A step of one across the vertical n, which a and b were across before it moved. */
void imki_earth_move(const double n[3], const double a[3], const double b[3], const double step[2],
                     double horizontal[3]);

/* ---- calibration_rows.c ---- */
int imki_item_rows(imki_estimator *e, const imki_point *point, size_t item, imki_row *row);
/* Rows over their sigma and factor. */
void imki_whiten(const imki_estimator *e, int count, imki_row *rows);
/* The same of an item, in e->row. @return their number */
int imki_whitened_rows(imki_estimator *e, size_t item);
/* Two unit vectors across a unit vector. */
void imki_across(const double n[3], double a[3], double b[3]);
/* Put the parameters of a point into the model. */
void imki_point_apply(imki_estimator *e, const imki_point *point);

/* ---- calibration_normal.c ---- */
void imki_normal_clear(imki_normal *n);
void imki_normal_add(imki_normal *n, const imki_row *row, double information);
imk_status imki_normal_factor(imki_normal *n, double damping);
void imki_normal_solve(imki_normal *n);
/* ln of the determinant, after a factor without damping. */
double imki_normal_log_determinant(const imki_normal *n);
/* Covariance of the globals and what imki_rows_covariance() needs, after a factor without damping.
 */
void imki_normal_invert(imki_normal *n);
/* J Cov J^T of some rows, count x count; and, when not NULL, Cov_global J^T, count x globals. */
void imki_rows_covariance(const imki_normal *n, const imki_row *row, int count, double *matrix,
                          double *by_globals);
/* A row as the globals see it when the locals have given way. */
void imki_row_project(const imki_normal *n, const imki_row *row, double *seen);
/* What two rows covary through locals that they share, or that turns tie. */
double imki_through_locals(const imki_normal *n, const imki_row *x, const imki_row *y);

/* ---- calibration_iterate.c ---- */
/* Integrate the turns at the current point, unless the linearisation at hand is good to a tenth of
 * `tolerance`. @return largest change of an end against the linearisation before, in sigmas of the
 * turn */
double imki_turns_linearise(imki_estimator *e, double tolerance);
void imki_point_copy(const imki_estimator *e, const imki_point *from, imki_point *to);
/* Least squares at the present weights and linearised turns. The normal equations then are those of
 * the point it ends at. */
imk_status imki_iterate(imki_estimator *e, int steps, bool *converged);
/* Build the normal equations at a point. @return cost */
double imki_build(imki_estimator *e, const imki_point *point);
double imki_cost(imki_estimator *e, const imki_point *point);

/* ---- calibration_statistics.c ---- */
/* Variance of a row: (factor sigma)^2 + what is known besides. */
static inline double imki_row_variance(const imki_estimator *e, const imki_row *row)
{
    const double sigma = row->sigma * e->factor[row->part];
    return sigma * sigma + row->known_variance;
}

/* Fit of the parts at the present solution, items of full weight. */
typedef struct imki_fit {
    size_t count[IMKI_PARTS];
    double square[IMKI_PARTS];     /* of residuals over their sigma */
    double redundancy[IMKI_PARTS]; /* what the fit left of their number */
    double shared_square[IMKI_PARTS], shared_redundancy[IMKI_PARTS]; /* each row by the share of its
                                      variance that the factor multiplies, and of the redundancy
                                      without what residuals need not show */
    double
        stated[IMKI_PARTS]; /* redundancy, each row by the share of its variance that is stated */
    double freedom[IMKI_PARTS]; /* degrees of freedom of the factor: by the square of the share */
    double excess[IMKI_PARTS], scaled[IMKI_PARTS]; /* for a first factor^2: sums of residual^2 less
                                      what is known of it, and of sigma^2 (1 - M_ii) */
    bool estimated[IMKI_PARTS];                    /* the factor; else it is 1 */
    double turn_square, turn_redundancy;           /* of placements: those of turns */
    double slow_square[IMKI_PARTS]; /* what slow noise is expected to add to shared_square */
} imki_fit;
/* Squared distances of an item's rows, by group, from what the others predict, over their variance:
 * chi-square with so many degrees (0: nothing to tell it by) when sigmas are right. */
void imki_item_distances(imki_estimator *e, size_t item, double square[IMKI_GROUPS],
                         int degrees[IMKI_GROUPS]);
imk_status imki_estimator_covariance(imki_estimator *e);
/* The same from normal equations built for the present point. */
imk_status imki_built_covariance(imki_estimator *e);
void imki_fit_groups(imki_estimator *e, imki_fit *fit);
/* Group and parts of the readings of a sensor where the input moves. */
static inline int imki_moving_group(int sensor)
{
    return IMKI_GROUP_MOVING + sensor;
}
static inline int imki_moving_part(int sensor, int axis)
{
    return IMKI_PART_MOVING + sensor * IMK_AXES_MAX + axis;
}
/* Part of the readings of an axis in holds. */
static inline int imki_part_of(const imki_estimator *e, int sensor, int axis)
{
    const int group = sensor == IMK_GYRO ? IMK_GROUP_GYRO : IMK_GROUP_ACCEL;
    return e->by_axis[sensor] ? IMKI_PART_AXIS + sensor * IMK_AXES_MAX + axis : group;
}
/* Things that have rows: items, placements, what is known of parameters. */
static inline size_t imki_things(const imki_estimator *e)
{
    return e->items + e->observations + e->parameters;
}
/* Rows of the k-th of them, whitened, in e->row. @return their number, 0 where refused */
int imki_rows_of(imki_estimator *e, size_t k);
/* The three rows of a placement, not whitened. @return their number; 0: not placed */
int imki_placement_rows(const imki_estimator *e, const imki_point *point, size_t index,
                        imki_row *row);
/* The row of a guessed prior. @return 0: there is none */
int imki_term_row(const imki_estimator *e, const imki_point *point, size_t p, imki_row *row);
/* Variance of a row by what was stated of it. */
static inline double imki_stated_variance(const imki_estimator *e, const imki_row *row)
{
    const bool added =
        row->sensor >= 0 && row->group < IMKI_GROUP_MOVING && e->added[row->sensor] > 0.0;
    return row->known_variance + (added ? 0.0 : row->sigma * row->sigma);
}
/* The parts of a group. @return their number */
int imki_group_parts(const imki_estimator *e, int group, int part[IMK_AXES_MAX]);
/* The same as one. */
typedef struct imki_group_sum {
    double square, redundancy;
    double stated; /* variance stated over variance, on the average */
    bool estimated;
} imki_group_sum;
imki_group_sum imki_sum_group(const imki_estimator *e, const imki_fit *fit, int group);
/* Variance factors until they stay; the solution follows. */
imk_status imki_variance_factors(imki_estimator *e, double tolerance, imki_fit *fit);

/* ---- calibration_freedom.c: variances of the parameters, with what the factors' errors add, and
 * their degrees of freedom ---- */
void imki_freedoms(imki_estimator *e, const imki_fit *fit, double *variance, double *freedom);
/* Doubles that it needs. */
size_t imki_freedoms_room(void);

/* ---- calibration_slow_noise.c: noise that observations of one record share; does nothing when the
 * model states none ---- */
size_t imki_slow_noise_sums(void);
void imki_slow_noise_start(imki_estimator *e);
/* What it adds to the covariance and to the squares of a fit, at the present solution. */
void imki_slow_noise_fit(imki_estimator *e, imki_fit *fit);
/* Add it to the covariance of the globals; it counts as known exactly. */
void imki_slow_noise_add(imki_estimator *e, double *freedom);
/* imki_fit_groups() with flicker of 1 rad/s or m/s^2 in the readings of a sensor; what it adds to
 * the covariance is in e->slow.covariance.
 * @return false: the model states slow noise, or not all of the readings are at rest */
bool imki_slow_noise_assume(imki_estimator *e, int sensor, imki_fit *fit);

/* ---- calibration_scatter.c: what is wrong about the sigmas stated ---- */
/* From the solution with one factor a group: choose by the restricted likelihood, and solve so. */
imk_status imki_choose_scatter(imki_estimator *e, imki_fit *fit);
/* Degrees of freedom of the parameters' intervals, by all forms, each by its likelihood. */
imk_status imki_scatter_freedoms(imki_estimator *e, imki_fit *fit, double *freedom);
/* Back to one factor a group. */
void imki_common_scatter(imki_estimator *e);

/* ---- calibration_robust.c ---- */
imk_status imki_refuse_outliers(imki_estimator *e);

/* ---- calibration_determined.c: what the observations do not determine ---- */
imk_status imki_check_determined(imki_estimator *e, double *weakest, imk_error *error);

#endif
