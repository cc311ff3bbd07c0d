/* SPDX-License-Identifier: Apache-2.0 */
/** @file linear_algebra.h
 *  Small dense linear algebra. Matrices are row-major, a[row * n + column]; nothing allocates. */
#ifndef IMUKIT_LINEAR_ALGEBRA_H
#define IMUKIT_LINEAR_ALGEBRA_H

#include "imukit/status.h"

IMK_BEGIN_C

/** Cholesky factor L of a symmetric positive definite n x n matrix, A = L L^T, in place: the lower
 *  triangle becomes L, the upper is not read and set to zero. IMK_ERROR_SINGULAR when A is not
 *  positive definite to working precision (a pivot below 2e-16 of its diagonal element, or NaN); A
 *  is then partly overwritten. */
IMK_API imk_status imk_cholesky_factor(size_t n, double *a);
/** Solve A x = b in place of b, with the factor of imk_cholesky_factor(). */
IMK_API void imk_cholesky_solve(size_t n, const double *l, double *b);
/** Inverse of A from its factor, full symmetric n x n, into `inverse` (not aliasing l). */
IMK_API void imk_cholesky_inverse(size_t n, const double *l, double *inverse);
/** log det A from its factor. */
IMK_API double imk_cholesky_log_determinant(size_t n, const double *l);

/** Householder QR of a rows x columns matrix (rows >= columns) in place: R in the upper triangle,
 *  the reflectors below it and in `beta` (columns values). [GOLUB2013, alg. 5.2.1]
 *  @return IMK_ERROR_ARGUMENT (rows < columns), IMK_ERROR_NOT_FINITE */
IMK_API imk_status imk_qr_factor(size_t rows, size_t columns, double *a, double *beta);
/** Least-squares solution of A x = b from the factor: b (rows values) becomes Q^T b, x its first
 *  `columns` values solved with R. IMK_ERROR_SINGULAR, with x untouched, when R is singular to
 *  working precision (a diagonal element below rows * 2e-16 of the largest). */
IMK_API imk_status imk_qr_solve(size_t rows, size_t columns, const double *qr, const double *beta,
                                double *b, double *x);
/** (A^T A)^-1 = R^-1 R^-T from the factor: columns x columns. */
IMK_API imk_status imk_qr_covariance(size_t rows, size_t columns, const double *qr,
                                     double *covariance);

/** Eigenvalues (ascending) and eigenvectors (columns of v, may be NULL) of a symmetric n x n matrix
 *  by cyclic Jacobi rotations: relative accuracy also of small eigenvalues. A is destroyed.
 *  @return IMK_ERROR_NOT_FINITE, IMK_ERROR_NO_CONVERGENCE after 60 sweeps */
IMK_API imk_status imk_symmetric_eigen(size_t n, double *a, double *eigenvalues, double *v);

IMK_END_C
#endif
