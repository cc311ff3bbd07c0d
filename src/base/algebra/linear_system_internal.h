/* SPDX-License-Identifier: Apache-2.0 */
/* Exact discretisation of linear systems with constant coefficients,
 *
 *     x' = A x + B u + w,   u held over the step, w white with the two-sided density W
 *     x[k+1] = phi x[k] + gamma u[k] + e[k],   cov e = integral_0^h e^{A s} W e^{A^T s} ds
 *
 * Matrices are by rows. */
#ifndef IMUKI_LINEAR_SYSTEM_INTERNAL_H
#define IMUKI_LINEAR_SYSTEM_INTERNAL_H

#include "imukit/status.h"

enum { IMKI_SYSTEM_MAX = 12 }; /* states plus inputs */

/* phi = e^{A h}, n x n. Relative error of the order of 1e-15 |A h| after balancing. phi may not be
 * a. A value too large for a double gives infinities. */
void imki_exponential(int n, const double *a, double h, double *phi);

/* phi (n x n) and gamma (n x m) of a step. n + m <= IMKI_SYSTEM_MAX. */
void imki_discretise(int n, int m, const double *a, const double *b, double h, double *phi,
                     double *gamma);

/* Covariance q (n x n) of the noise that a step adds, and its root: q = root root^T, lower
 * triangular with a non-negative diagonal, columns of a singular q zero. w is symmetric positive
 * semidefinite. root may be q. */
void imki_step_covariance(int n, const double *a, const double *w, double h, double *q);
void imki_covariance_root(int n, const double *q, double *root);

#endif
