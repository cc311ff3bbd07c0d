/* SPDX-License-Identifier: Apache-2.0 */
/** @file least_squares.h
 *  Bounded nonlinear least squares with covariance, by Levenberg-Marquardt scaled as in [MORE1978]
 *  and damped as in [NIELSEN1999], with a projected active set for the bounds. The residuals are
 *  evaluated inside the bounds only; where they are not finite, a shorter step is taken. */
#ifndef IMUKIT_LEAST_SQUARES_H
#define IMUKIT_LEAST_SQUARES_H

#include "imukit/status.h"

#include <stdbool.h>

IMK_BEGIN_C

/** Residuals r(x) (already divided by their sigmas) and, when jacobian is not NULL, dr/dx
 *  (residual_count x parameter_count, row-major). @return IMK_OK, or an error to stop the solver */
typedef imk_status (*imk_residuals)(void *context, const double *x, double *residuals,
                                    double *jacobian);

typedef struct imk_least_squares {
    uint32_t cookie;
    size_t parameter_count; /**< <= 64 */
    size_t residual_count;  /**< at least as many as parameters with lower < upper */
    imk_residuals residuals;
    void *context;
    bool has_jacobian;   /**< false: forward differences are taken */
    const double *lower; /**< bounds, or NULL */
    const double *upper;
    double tolerance_cost; /**< stop: relative decrease of the cost; default 1e-12 */
    double tolerance_step; /**< stop: relative step; default 1e-10 */
    int max_iterations;    /**< default 100 */
} imk_least_squares;

typedef struct imk_least_squares_result {
    double cost; /**< half the sum of squared residuals */
    double initial_cost;
    int iterations;
    int evaluations;
    int free_parameters; /**< number of parameters not held at a bound */
} imk_least_squares_result;

/** The defaults stated above; the problem itself must be set. */
IMK_API imk_least_squares imk_least_squares_default(void);

/** Bytes of workspace for a problem. */
IMK_API size_t imk_least_squares_workspace_size(const imk_least_squares *problem);

/** Minimise from the start in x.
 *  @param x           parameter_count values: start, then solution (clipped to the bounds)
 *  @param covariance  parameter_count^2 or NULL: (J^T J)^-1 over the free parameters, zero rows and
 *                     columns for those at a bound; for residuals divided by their sigmas
 *  @param result      may be NULL
 *  @return IMK_ERROR_NO_CONVERGENCE (x is then the best point found), IMK_ERROR_SINGULAR (x is the
 *          solution, covariance untouched), IMK_ERROR_ARGUMENT, IMK_ERROR_WORKSPACE,
 *          IMK_ERROR_UNINITIALISED, IMK_ERROR_NOT_FINITE (residuals at the start, or a derivative),
 *          or what the residual function returned (x is the best point found) */
IMK_API imk_status imk_least_squares_solve(const imk_least_squares *problem, double *x,
                                           double *covariance, imk_least_squares_result *result,
                                           void *workspace, size_t workspace_size);

IMK_END_C
#endif
