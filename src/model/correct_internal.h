/* SPDX-License-Identifier: Apache-2.0 */
/* The joint solution of correct.h as a problem in bounds. Unknowns and channels are numbered alike:
 * of the gyros from 0, of the accelerometers from IMK_AXES_MAX. A set of sensors that is solved has
 * three unknowns, the body components; one that is not has one for each axis, its input u. */
#ifndef IMUKI_CORRECT_INTERNAL_H
#define IMUKI_CORRECT_INTERNAL_H

#include "distort_internal.h"

#include "imukit/correct.h"

enum { IMKI_UNKNOWNS = 2 * IMK_AXES_MAX, IMKI_ITERATIONS_MAX = 200 };

typedef struct imki_inversion {
    const imk_distortion *distortion;
    bool solves[2];
    bool stays_within[2];                         /* iterates are clipped to the limits */
    int outputs[2];                               /* unknowns of each kind */
    double limit[IMKI_UNKNOWNS];                  /* largest true value of each unknown */
    double input_limit[2][IMK_AXES_MAX];          /* largest true |u| of each axis */
    double along[2][IMK_AXES_MAX][3];             /* direction over its squared length */
    double inverse[IMKI_UNKNOWNS][IMKI_UNKNOWNS]; /* J+: unknown by channel */
} imki_inversion;

/* Centre and half width of an interval. */
typedef struct imki_interval {
    double center, radius;
} imki_interval;

/* Range of the relative slope s + n'(u) of an axis for |u| <= limit, at any temperature. */
imki_interval imki_slope(const imk_axis_response *axis, double limit);

/* Range of the temperature part of s, without temperature (0) included: lower and upper end. */
void imki_scale_range(const imk_axis_response *axis, double *lower, double *upper);

/* Smallest |u| up to `limit` at which a reading no longer grows with the input, with its sign;
 * NaN when there is none. `linear` is what (A + X) adds to the slope. */
double imki_turning_point(const imk_axis_response *axis, double linear, double limit);

/* Derivatives of a channel with respect to all unknowns, wherever the solution and the iteration
 * can be: `error` is the largest distance between them in each unknown; NULL: on the way from 0 to
 * the solution. */
void imki_channel_derivatives(const imki_inversion *inversion, int sensor, int axis,
                              const double *error, double *center, double *radius);

/* J+ from the middle of the derivatives. IMK_ERROR_SINGULAR with *sensor where there is none. */
imk_status imki_invert_middle(imki_inversion *inversion, int *sensor);

/* (J^T J)^-1 J^T of `rows` rows of three: out[3][rows]. */
imk_status imki_pseudo_inverse(int rows, const double (*matrix)[3], double (*out)[IMK_AXES_MAX]);

/* Iterations until the error of every unknown is below tolerance * limit; IMK_ERROR_NO_CONVERGENCE
 * when IMKI_ITERATIONS_MAX are not enough. */
imk_status imki_count_iterations(const imki_inversion *inversion, double tolerance, int *iterations,
                                 double *contraction, double error[IMKI_UNKNOWNS]);

/* Spectral radius of the bound matrix on the way from 0 to the solution. */
double imki_contraction(const imki_inversion *inversion);

/* Fill an error about a key of a sensor; NULL: about none. @return the status */
imk_status imki_correct_refuse(imk_error *error, imk_status status, int sensor, const char *key,
                               const char *found, const char *expected);

/* Fill an error for a model that is not invertible: names the term that matters most.
 * @param distortion  that of the inversion, from which terms are taken for a while */
imk_status imki_refuse_inversion(const imki_inversion *inversion, imk_distortion *distortion,
                                 imk_error *error);

#endif
