/* SPDX-License-Identifier: Apache-2.0 */
/* Parts of the tuning of a filter. In the body axes of a window's start, turned with it in inertial
 * space, the errors x = (psi, dv, dp) of increments integrated from readings go over a sample of
 * length h as
 *
 *     psi <- psi + a
 *     dv  <- dv - V x psi - 1/2 V x a + b
 *     dp  <- dp + h dv - h/2 V x psi - h/4 V x a + h/2 b,     a = C dw h,  b = C df h,
 *
 * V being the increment of velocity and C the attitude in the middle of the sample. */
#ifndef IMUKI_TUNING_INTERNAL_H
#define IMUKI_TUNING_INTERNAL_H

#include "imukit/filter_tuning.h"
#include "navigate/drift/drift_covariance_internal.h"
#include "simulate/simulate_internal.h"

enum {
    IMKI_TUNING_ROWS = 64,   /* of a chunk, at most */
    IMKI_TUNING_LANES = 8,   /* windows at a time */
    IMKI_TUNING_OWN = 3,     /* sources besides those of the drift: see below */
    IMKI_PACKED = 45,        /* lower triangle of a covariance */
    IMKI_KINDS_OF_BASIS = 4, /* white, walk, bias, scale factor */
    IMKI_BASES = 6 * IMKI_KINDS_OF_BASIS,
    IMKI_PARAMETERS_MAX = 12 /* white and walk of each axis */
};

enum { IMKI_BASIS_WHITE = 0, IMKI_BASIS_WALK, IMKI_BASIS_BIAS, IMKI_BASIS_SCALE };

static inline int imki_basis(int kind, int sensor, int axis)
{
    return 6 * kind + 3 * sensor + axis;
}

/* ---- tuning_increments.c: integrals of rate and force ---- */

/* Attitude, velocity and position increments since the start, in its axes. */
typedef struct imki_increments {
    imk_matrix3 c;
    double v[3], p[3];
} imki_increments;

imki_increments imki_increments_start(void);
/* Attitude and velocity over h: rate and force are constant. */
void imki_increments_take(imki_increments *s, double h, const double rate[3],
                          const double force[3]);
/* Over 2 h: straight lines through two means, with their coning and sculling [SAVAGE1998a,
 * SAVAGE1998b]. */
void imki_increments_pair(imki_increments *s, double h, const double rate[2][3],
                          const double force[2][3]);
/* The position over a sample, from the velocities before it and now. */
void imki_increments_sample(imki_increments *s, double h, const double before[3]);
/* Estimate minus truth, as x. */
void imki_increments_error(const imki_increments *estimate, const imki_increments *truth,
                           double x[9]);

/* ---- tuning_settings.c ---- */

/* The windows and times that settings make: grids are in samples. */
typedef struct imki_tuning_grid {
    size_t time_count, short_count, long_count;
    size_t samples[IMK_TUNING_TIMES_MAX];
    size_t bias_samples;                 /* of the mean that is known */
    size_t rows[IMK_TUNING_MOTIONS_MAX]; /* that may be used */
    size_t settle;                       /* rows that an output filter needs */
    size_t lead;                         /* rows before the first window */
} imki_tuning_grid;

void imki_tuning_grid_of(const imk_model *model, const imk_filter_tuning_settings *settings,
                         imki_tuning_grid *grid);
/* The row that ends where a window begins. */
size_t imki_tuning_window(const imk_filter_tuning_settings *settings, const imki_tuning_grid *grid,
                          size_t motion, size_t window);
/* ---- tuning_plan.c ---- */

/* s of sample after sample, driven by w of unit variance:  s = c z + d w,  z <- a z + b w. */
typedef struct imki_sampled {
    int states;
    double a[2][2], b[2], c[2], d, start[2][2];
} imki_sampled;

typedef enum imki_role {
    IMKI_ROLE_NONE = 0, /* known with the bias */
    IMKI_ROLE_MEAN,     /* known value: adds to the vector of its source */
    IMKI_ROLE_SIZE,     /* a vector of its own */
    IMKI_ROLE_NOISE,
    IMKI_ROLE_JITTER
} imki_role;

typedef struct imki_tuning_element {
    imki_role role;
    bool slow;            /* taken against its mean before the window */
    imki_sampled sampled; /* of noise */
    double phi[2][2];     /* of other drivers, over a sample */
} imki_tuning_element;

typedef struct imki_tuning_plan {
    imki_drift_plan drift;        /* with own sources behind: start biases, sampling */
    imki_tuning_element *element; /* [drift.element_count] */
    imki_sampled white, walk;     /* of a filter, unit densities */
    double h;
    size_t bias_samples;
} imki_tuning_plan;

/* Sources and elements at most, for memory. */
void imki_tuning_plan_size(const imk_model *model, const imk_filter_tuning_settings *settings,
                           size_t *sources, size_t *elements);
/* @param plan  its arrays are there */
imk_status imki_tuning_plan_make(imki_tuning_plan *plan, const imk_model *model,
                                 const imk_filter_tuning_settings *settings,
                                 const imki_tuning_grid *grid, imk_error *error);
/* Is the driver constant, an exponential, a ramp, an oscillation? */
bool imki_tuning_is_constant(const imki_drift_driver *driver);
bool imki_tuning_is_ramp(const imki_drift_driver *driver);
/* Elements with a vector whose errors are numbers: not those of the whole unit. */
bool imki_tuning_has_series(const imki_tuning_plan *plan, size_t element);

/* ---- tuning_scene.c: what the unit is exposed to, part after part of a sample ---- */

typedef struct imki_exposed {
    size_t rows, parts;
    const double *rate[3], *force[3]; /* of row 0, part 0; a row before and one behind are there */
    const double *acceleration[3];    /* NULL: not needed */
} imki_exposed;

/* Parts of a sample: an even number, of a recorded motion 1. */
size_t imki_tuning_parts(const imk_model *model, const imk_filter_tuning_settings *settings,
                         size_t motion);
/* @param perfect  scratch: a model without errors; memory IMKI_SCENE_SIZE + slack */
imk_status imki_tuning_scene_start(imki_scene *scene, imk_model *perfect, const imk_model *model,
                                   const imk_filter_tuning_settings *settings, size_t motion,
                                   imki_parts *memory, imk_error *error);
/* Rows first … first + rows - 1, first >= 1; at most imki_tuning_rows_at_once(). */
static inline size_t imki_tuning_rows_at_once(size_t parts)
{
    const size_t rows = IMKI_STRETCH / parts - 2;
    return rows < IMKI_TUNING_ROWS ? rows : IMKI_TUNING_ROWS;
}
void imki_tuning_expose(imki_scene *scene, size_t first, size_t rows, imki_exposed *exposed);

/* ---- tuning_series.c: errors of readings, sample after sample ---- */

/* What one window is computed in. Of vectors each has what it has done to x. */
typedef struct imki_tuning_lane {
    const imki_tuning_plan *plan;
    const imk_filter_tuning_settings *settings;
    const imki_tuning_grid *grid;
    const imk_model *model;
    size_t motion, window;
    imk_status status;
    imk_error error;
    imk_model *perfect; /* scratch */
    void *scene_memory; /* IMKI_SCENE_SIZE and slack */
    imki_scene scene;
    imki_exposed exposed;         /* rows of the chunk */
    imk_motion_state *part_state; /* of the parts of a row: inputs alone */
    imki_increments truth, readings;
    double gravity[3], speed[3]; /* at the window's start, in its axes */
    double peak[2][3];           /* largest inputs seen */
    /* [element] */
    double (*value)[IMKI_TUNING_ROWS], (*driver)[2], *offset, *learned, *sum;
    imki_band_limit *limit;
    double (*size)[9], (*cross)[2][9], (*states)[2][2];
    /* [source] */
    double (*mean)[9];
    imki_matrix9 *covariance;
    /* of the filter, [3 sensor + axis] */
    double bias[6][9], scale[6][9];
    imki_matrix9 white[6], walk[6];
    double walk_cross[6][2][9], walk_states[6][2][2];
    /* results, [time] */
    double (*increments)[15];
    double (*total)[IMKI_PACKED], (*shift)[9]; /* covariance, and mean error */
    double (*part)[IMKI_PACKED];               /* [source * times + time] */
    double (*basis)[IMKI_PACKED];              /* [base * times + time] */
} imki_tuning_lane;

/* Prepare for a window that begins at the end of row `row`. */
imk_status imki_tuning_series_start(imki_tuning_lane *lane, size_t row);
/* Errors of the rows of lane->exposed, of each element that has a vector. */
void imki_tuning_series(imki_tuning_lane *lane);

/* ---- tuning_window.c ---- */

void imki_tuning_window_run(imki_tuning_lane *lane);

/* ---- tuning_noise.c: covariances of noise over a sample ---- */

/* The sample: gamma is what an error of a reading of one does. */
typedef struct imki_tuning_sample {
    double h, v[3]; /* V */
    double gamma[2][3][9];
} imki_tuning_sample;

void imki_tuning_move(const imki_tuning_sample *sample, double x[9]);
void imki_tuning_move_matrix(const imki_tuning_sample *sample, imki_matrix9 *p);
/* A noise, p moved already: z enters by `of_states`, w by `of_noise`. */
void imki_tuning_drive(const imki_tuning_sample *sample, const imki_sampled *sampled,
                       const double of_states[9], const double of_noise[9], double cross[2][9],
                       double states[2][2], imki_matrix9 *p);
/* Start: nothing done yet. */
void imki_tuning_start_noise(const imki_sampled *sampled, double cross[2][9], double states[2][2]);
void imki_pack(const imki_matrix9 *p, double packed[IMKI_PACKED]);
void imki_unpack(const double packed[IMKI_PACKED], double p[9][9]);

/* ---- tuning_fit.c ---- */

/* P_m = fixed + sum of parameter times basis, at each time; and P_t. */
typedef struct imki_tuning_problem {
    size_t times;
    int parameters;
    const double (*truth)[9][9];
    double (*fixed)[9][9];
    double (*basis)[9][9]; /* [parameter * times + time] */
    double limit;
    double floor[IMKI_PARAMETERS_MAX]; /* least variances of the safe answer */
} imki_tuning_problem;

/* P_m at a time. */
void imki_tuning_model(const imki_tuning_problem *problem, const double *theta, size_t time,
                       double p[9][9]);
/* What the fit minimises; infinite where P_m is singular. */
double imki_tuning_likelihood(const imki_tuning_problem *problem, const double *theta);
/* @param theta  variances: at first a start, then the answer
 * @return false: no answer */
bool imki_tuning_fit(const imki_tuning_problem *problem, double *theta);
/* From the fit to the safe answer. */
bool imki_tuning_safe(const imki_tuning_problem *problem, const double *fit, double *theta);

/* ---- tuning_consistency.c ---- */

/* L^-1 a L^-T of the factor of p, and its eigenvalues, ascending. @return false: p is singular */
bool imki_tuning_ratio(const double p[9][9], const double a[9][9], double ratio[9][9],
                       double eigenvalue[9]);
bool imki_tuning_compare(const double model[9][9], const double truth[9][9],
                         imk_filter_consistency *consistency);
/* Probability that an error of this covariance and mean is beyond the 95 % ellipsoid of p. */
double imki_tuning_beyond(const double p[9][9], const double covariance[9][9],
                          const double mean[9]);
/* tr(p^-1 a) */
double imki_tuning_trace(const double p[9][9], const double a[9][9]);

/* ---- tuning_answers.c ---- */

/* Sums over the windows, and what is kept of each: bases of a triad, or of each axis. */
typedef struct imki_tuning_totals {
    size_t times, sources, windows, bases;
    double (*truth)[9][9];  /* [time] */
    double (*source)[9][9]; /* [source * times + time] */
    double (*basis)[9][9];  /* [base * times + time], of each axis */
    double (*window_total)[IMKI_PACKED], (*window_shift)[9]; /* [window * times + time] */
    double (*window_basis)[IMKI_PACKED]; /* [(window * bases + base) * times + time] */
    double (*increments)[15];            /* [window * times + time] */
    bool per_axis;
} imki_tuning_totals;

/* Where an axis' basis is among those kept of a window. */
static inline size_t imki_kept_basis(bool per_axis, int kind, int sensor, int axis)
{
    return per_axis ? (size_t)imki_basis(kind, sensor, axis) : (size_t)(2 * kind + sensor);
}

/* Arrays that the answers take. */
typedef struct imki_tuning_arrays {
    imk_filter_consistency *consistency;   /* [answer * times + time] */
    double (*covariance)[9][9];            /* the same */
    double *share;                         /* [(answer * sources + source) * times + time] */
    double (*fixed)[9][9], (*basis)[9][9]; /* of the problem */
} imki_tuning_arrays;

bool imki_tuning_answers(const imki_tuning_totals *totals, const imki_tuning_arrays *arrays,
                         const imk_model *model, const imk_filter_tuning_settings *settings,
                         imk_filter_tuning *tuning);

#endif
