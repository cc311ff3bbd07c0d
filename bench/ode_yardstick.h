/* SPDX-License-Identifier: Apache-2.0 */
/* Differential equations as anyone would hand them to a solver, and two ways to solve them: CVODE
 * of SUNDIALS, the yardstick; and extrapolation far finer than both, which stands for the truth. */
#ifndef IMUKIT_ODE_YARDSTICK_H
#define IMUKIT_ODE_YARDSTICK_H

#include <stdbool.h>
#include <stddef.h>

enum { ODE_STATES_MAX = 8, ODE_READINGS_MAX = 2 };

/** y' = slope(t, y), watched at the ends of `pieces` pieces of equal length. */
typedef struct ode_problem {
    int states, readings;
    double start[ODE_STATES_MAX];
    double size[ODE_STATES_MAX]; /**< of each state: absolute tolerances are relative to it */
    size_t pieces;
    double piece;          /**< [s] */
    double reference_step; /**< that extrapolation to the 16th order needs [s] */
    void (*slope)(double t, const double *y, double *dy, const void *with);
    /** New inputs for a piece, or a new state: the solver starts anew. NULL: nothing ever jumps. */
    void (*begin)(size_t piece, double *y, void *with);
    void (*read)(double t, const double *y, double *readings, const void *with);
    void *with;
} ode_problem;

typedef enum ode_method { ODE_ADAMS = 0, ODE_BDF = 1 } ode_method;

/** False where the program has been built without SUNDIALS. */
bool ode_has_cvode(void);

/** Solve by CVODE: Adams' formulas with functional iteration, or backward differentiation with
 *  Newton's method and a dense Jacobian by differences.
 *  @param readings  pieces x problem->readings, or NULL
 *  @param most      calls of slope it may take
 *  @param calls     that it took
 *  @return false when it gave up */
bool ode_cvode(const ode_problem *problem, ode_method method, double relative_tolerance, long most,
               double *readings, long *calls);

/** Solve by Gragg's method extrapolated to order 16 (Hairer, Norsett, Wanner, Solving Ordinary
 *  Differential Equations I, II.9), with steps of at most `step`. */
void ode_reference(const ode_problem *problem, double step, double *readings);

/** Largest difference of any reading in two solutions; with `stride`, of every stride-th piece of
 *  the first against each of the second. */
double ode_distance(const ode_problem *problem, size_t stride, const double *first,
                    const double *second);

#endif
