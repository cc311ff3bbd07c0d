/* SPDX-License-Identifier: Apache-2.0 */
/* Parts of the covariance analysis. The error of a navigator in Earth-fixed axes,
 *
 *     x = (psi, dv, dr),   C_eb (estimated) = (I + [psi x]) C_eb,
 *     x' = F x + sum of columns g_j(t) s_j(t)
 *
 * is driven by scalars s_j, each of a driver: a small linear system with constant coefficients
 * (constant, decay, walk, oscillator, white noise). A column says how a driver's output enters:
 * along an axis, in proportion to what the motion makes of it. An element is a driver on a column
 * with a size; a source is a set of independent elements with a name. */
#ifndef IMUKI_DRIFT_COVARIANCE_INTERNAL_H
#define IMUKI_DRIFT_COVARIANCE_INTERNAL_H

#include "drift_settings_internal.h"

#include "imukit/drift.h"
#include "noise/noise_terms_internal.h"

enum {
    IMKI_DRIFT_MOMENTS = 6, /* powers of time in a column over a step */
    IMKI_DRIFT_SLOTS = 32,  /* lengths of steps that drivers remember */
    IMKI_DRIFT_BLOCK = 16,  /* steps made ready at a time */
    /* At most 57 of gyros, 48 of accelerometers, 3 of the clock, 2 of gravity, 72 of aids. */
    IMKI_DRIFT_COLUMNS = 192
};

typedef struct imki_matrix9 {
    double m[9][9];
} imki_matrix9;

/* y = a x; y may not be x. */
static inline void imki_matrix9_apply(const imki_matrix9 *a, const double x[9], double y[9])
{
    for (int i = 0; i < 9; i++) {
        double sum = 0.0;
        for (int k = 0; k < 9; k++)
            sum += a->m[i][k] * x[k];
        y[i] = sum;
    }
}

/* Which Earth: WGS84, or for comparison with textbooks a sphere, on which the unit rests. */
typedef struct imki_drift_earth {
    double radius, gravity; /* 0: WGS84 */
} imki_drift_earth;

/* ---- drift_driver.c ---- */

/* s = first state of  z' = A z + w,  w white with the density W. Without states s is white. */
typedef struct imki_drift_driver {
    int states;           /* 0 … 2 */
    double a[2][2], w[2]; /* W is diagonal */
    double start[2];      /* variances of the states at the start, of a random driver */
} imki_drift_driver;

imki_drift_driver imki_driver_white(void); /* of density 1 */
imki_drift_driver imki_driver_constant(void);
imki_drift_driver imki_driver_walk(void);              /* from 0, K = 1 */
imki_drift_driver imki_driver_ramp(void);              /* second state: the slope */
imki_drift_driver imki_driver_decay(double time);      /* of an exponential */
imki_drift_driver imki_driver_gauss_markov(double t);  /* of variance 1 */
imki_drift_driver imki_driver_oscillator(double rate); /* undamped [rad/s] */
imki_drift_driver imki_driver_resonance(double rate, double q);
bool imki_driver_equal(const imki_drift_driver *a, const imki_drift_driver *b);

/* What a driver does over a step of length h. With u the time left in the step,
 *
 *     I_k = integral of u^k/k! s du,   z <- phi z + noise,   I_k = gain_k z(start) + noise_k */
typedef struct imki_driver_step {
    double phi[2][2], gain[IMKI_DRIFT_MOMENTS][2];
    double state_noise[2][2];                                    /* covariances of the noises */
    double cross_noise[IMKI_DRIFT_MOMENTS][2];                   /* I_k with z */
    double moment_noise[IMKI_DRIFT_MOMENTS][IMKI_DRIFT_MOMENTS]; /* I_k with I_l */
} imki_driver_step;

void imki_driver_over(const imki_drift_driver *driver, double h, int moments,
                      imki_driver_step *step);

/* ---- drift_sources.c ---- */

typedef enum imki_column_kind {
    IMKI_COLUMN_ONE,      /* as it is */
    IMKI_COLUMN_RATE,     /* times the rate about body axis `part` */
    IMKI_COLUMN_FORCE,    /* times the force along it */
    IMKI_COLUMN_PRODUCT,  /* times fx^2, fy^2, fz^2, fx fy, fy fz, fz fx */
    IMKI_COLUMN_POWER,    /* times power `part` of imki_input_powers of the axis' own input */
    IMKI_COLUMN_CROSS,    /* input x pendulous, input x output, pendulous x output */
    IMKI_COLUMN_LEVER,    /* what an accelerometer moved along body axis `part` has besides */
    IMKI_COLUMN_ROUNDING, /* enters as its derivative: what is rounded and carried; see below */
    IMKI_COLUMN_DELAY,    /* the derivative of -u: a filter's delay */
    IMKI_COLUMN_SKEW,     /* delay of all accelerometers */
    IMKI_COLUMN_CLOCK,    /* rate error of the sample clock */
    IMKI_COLUMN_GRAVITY,  /* less along north or east: its driver is that of the step */
    IMKI_COLUMN_JITTER,   /* shift of samples in time; its last one stays, like what is rounded */
    IMKI_COLUMN_AID /* enters by updates alone: error `part` of aid `sensor`, an imki_aid_error */
} imki_column_kind;

typedef struct imki_drift_column {
    imki_column_kind kind;
    int sensor, axis, part;
    double pendulous[3], output[3]; /* of IMKI_COLUMN_CROSS: body axes */
} imki_drift_column;

/* How an element takes part. */
typedef enum imki_element_use {
    IMKI_ELEMENT_MEAN,    /* known: moves the mean */
    IMKI_ELEMENT_SIZE,    /* a constant (ramp, phase …) of unknown size, 1 sigma given */
    IMKI_ELEMENT_NOISE,   /* driven by noise */
    IMKI_ELEMENT_ROUNDING /* driven by noise, seen with what is being carried: rounding, jitter */
} imki_element_use;

typedef struct imki_drift_element {
    imki_element_use use;
    int column, driver;
    double size;     /* of noise: its variance */
    double state[2]; /* of the driver, when not noise; of rounding: 1 sigma of what is carried
                      */
    double *x;       /* what it has done, when not noise */
    double covariance[2][2]; /* of the driver's states, when noise */
    double *cross[2];        /* of these with x */
    int correlated;          /* place in the model's correlation, from 1; 0: independent */
    /* Of a stochastic term: its row and its process, for who takes it sample by sample; else NULL
     */
    const imki_noise_term *term;
    imki_process process;
} imki_drift_element;

typedef struct imki_drift_part {
    size_t first, count; /* elements */
    double *covariance;  /* what noise elements have done; states x states */
} imki_drift_part;

/* All of it. With `element` NULL sources and elements are counted only. */
typedef struct imki_drift_plan {
    size_t source_count, element_count, column_count, driver_count;
    size_t states;      /* of x: nine, and of an aided navigator its estimates */
    double *vector;     /* of the elements: x and cross of each */
    double *covariance; /* of the sources */
    imk_drift_source *source;
    imki_drift_part *part;
    imki_drift_element *element;
    imki_drift_column *column;
    imki_drift_driver *driver;
    const imk_correlation *correlation; /* of calibrated values; NULL: they are independent */
    size_t omitted_count;
    const char **omitted;
} imki_drift_plan;

/* drift_plan.c */
void imki_drift_add_source(imki_drift_plan *plan, const char *first, const char *second,
                           const char *third, const char *text); /* first.secondthird */
/* Of a column that is there, or is added. */
int imki_drift_column_number(imki_drift_plan *plan, const imki_drift_column *column);
/* The next element of the source added last; NULL when only counting. */
imki_drift_element *imki_drift_add_element(imki_drift_plan *plan, imki_element_use use,
                                           const imki_drift_column *column,
                                           const imki_drift_driver *driver);
/* @param first,second  the driver's states at the start */
void imki_drift_add_constant(imki_drift_plan *plan, imki_element_use use,
                             const imki_drift_column *column, const imki_drift_driver *driver,
                             double first, double second);
void imki_drift_add_noise(imki_drift_plan *plan, imki_element_use use,
                          const imki_drift_column *column, const imki_drift_driver *driver,
                          double variance);
/* A term that the linear theory leaves out. */
void imki_drift_omit(imki_drift_plan *plan, const char *name);
imki_drift_column imki_drift_column_of(imki_column_kind kind, int sensor, int axis, int part);
/* The kind of column that multiplies by the axis' own kind of input. */
imki_column_kind imki_drift_own_input(int sensor);
bool imki_drift_has_any(const double *number, int count); /* that is not 0 */

/* drift_noise_sources.c: of a triad, and its output stage */
void imki_drift_noise_sources(imki_drift_plan *plan, const imk_triad *triad, int sensor,
                              const imk_drift_settings *settings);

/* Drivers at most. */
size_t imki_drift_drivers_max(const imk_model *model, const imk_drift_settings *settings);
/* @param start  where navigation starts; not needed for counting */
void imki_drift_sources(imki_drift_plan *plan, const imk_model *model,
                        const imk_drift_settings *settings, imk_geodetic start);

/* ---- drift_steps.c ---- */

/* The motion at an instant, and what errors do there. */
typedef struct imki_drift_node {
    imk_motion_state state;
    imk_matrix3 c_eb, axes;   /* axes: C_en */
    imk_vector3 rate_of_axes; /* of the body relative to the Earth, body axes */
    imk_vector3 acceleration; /* of the velocity relative to the Earth, Earth-fixed axes */
    imk_vector3 force_slope;  /* df/dt, body axes */
    imki_matrix9 keep;        /* x <- keep x: what a slaved vertical leaves; without it unity */
    imki_matrix9 full;        /* x with the vertical velocity that belongs to it */
    bool slaved;
    double climb[3];   /* this velocity, upward, from dr */
    imki_matrix9 f;    /* F */
    imk_matrix3 level; /* what dr, in `axes`, turns the displayed level by; 0: psi is stated */
} imki_drift_node;

typedef struct imki_drift_walk {
    const imk_drift_settings *settings;
    imki_drift_motion_of motion;
    imki_drift_earth earth;
    bool rests, needs_slope; /* of the force */
    double peak[2][3];       /* largest inputs seen */
    int level;               /* of the last step on a motion: 2^level s */
} imki_drift_walk;

typedef struct imki_drift_step {
    double h;
    int moments, slot;
    size_t repeat;
    struct imki_aided_step *aided; /* drift_aided_internal.h; NULL: no aids */
    imki_drift_node node[5];       /* at its quarters; at rest the first alone */
    imki_matrix9 phi;
    double (*column)[IMKI_DRIFT_MOMENTS][9]; /* [plan column]: coefficients of u^k/k! */
    imki_driver_step gravity; /* of the deflection of gravity, which depends on the speed */
} imki_drift_step;

void imki_drift_node_at(imki_drift_walk *walk, double time, imki_drift_node *node);
/* drift_columns.c: what a driver is multiplied by in the reading of the column's axis, given rate,
 * force and angular acceleration; 1 for columns that enter otherwise. */
double imki_drift_factor(const imki_drift_column *column, const imk_motion_state *state);
/* A column at an instant. */
void imki_drift_column_at(const imki_drift_column *column, const imki_drift_node *node,
                          double g[9]);
/* The vector c of a column that enters as the derivative of c s: then x - c s is propagated, with
 * the column F c - dc/dt at constant s, and c s added to the result. @return false: there is none
 */
bool imki_drift_carried_at(const imki_drift_column *column, const imki_drift_node *node,
                           double c[9]);
/* Choose the next step from `time` towards `goal`, and look at the motion on it.
 * @return its end, `goal` exactly when it gets there */
double imki_drift_next_step(imki_drift_walk *walk, double time, double goal, imki_drift_step *step);
/* phi and columns of a step that has been chosen. */
void imki_drift_fill_step(const imki_drift_walk *walk, const imki_drift_plan *plan,
                          imki_drift_step *step);
/* Self-alignment as a step that ends at the start: means of the readings make the attitude. */
void imki_drift_alignment_step(const imki_drift_walk *walk, const imki_drift_plan *plan,
                               imki_drift_step *step);

/* ---- drift_gravity.c ---- */

/* What gravity's deflection decays with in time [1/s]. */
double imki_gravity_decay(const imk_drift_settings *settings, const imk_motion_state *state);
void imki_drift_gravity_source(imki_drift_plan *plan, const imk_drift_settings *settings);
/* step->gravity, of a step whose nodes are there; with `rests` the unit stands. */
void imki_drift_gravity_step(const imk_drift_settings *settings, bool rests, imki_drift_step *step);

/* ---- drift_axes.c ---- */

/* Set node->level. */
void imki_drift_level(imki_drift_earth earth, imk_attitude_errors stated, imki_drift_node *node);
/* T: the nine errors that are stated from x. */
void imki_drift_result_axes(const imki_drift_node *node, imki_matrix9 *t);

/* ---- drift_propagate.c ---- */

/* What a source does before the first step: of self-alignment, a step that ends at the node, or
 * NULL for a given attitude. */
void imki_drift_begin(const imki_drift_plan *plan, imki_drift_part *part,
                      const imki_drift_node *node, const imki_drift_step *alignment,
                      imki_driver_step (*over)[IMKI_DRIFT_SLOTS]);
/* Move a source over a step, repeat times. @param over  [driver][slot] */
void imki_drift_propagate(const imki_drift_plan *plan, imki_drift_part *part,
                          const imki_drift_step *step, imki_driver_step (*over)[IMKI_DRIFT_SLOTS]);
/* x of an element that is not noise, with what it carries. */
void imki_drift_element_at(const imki_drift_plan *plan, const imki_drift_element *element,
                           const imki_drift_node *node, double x[9]);
/* p <- t p t^T */
void imki_drift_turn_covariance(double *p, size_t n, const imki_matrix9 *phi);
/* Mean and covariance of a source at an instant, in north-east-down axes. */
void imki_drift_moments_at(const imki_drift_plan *plan, const imki_drift_part *part,
                           const imki_drift_node *node, imk_drift_moments *moments);

/* ---- drift_covariance.c ---- */

/* imk_drift_covariance() on another Earth, for comparison with closed forms. */
imk_status imki_drift_covariance_on(imki_drift_earth earth, const imk_model *model,
                                    const imk_drift_settings *settings, void *memory, size_t size,
                                    const imk_executor *executor, imk_drift_analysis **analysis,
                                    imk_error *error);

#endif
