/* SPDX-License-Identifier: Apache-2.0 */
#include "ode_yardstick.h"

#include <math.h>
#include <string.h>

#ifdef BENCH_SUNDIALS
#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

typedef struct solver {
    const ode_problem *problem;
    SUNContext context;
    void *memory;
    N_Vector y, tolerance;
    SUNMatrix matrix;
    SUNLinearSolver linear;
    SUNNonlinearSolver fixed_point;
    long calls, most;
} solver;

static int slope(realtype t, N_Vector y, N_Vector dy, void *user)
{
    solver *s = user;
    if (s->calls++ > s->most)
        return -1; /* CVODE gives up */
    s->problem->slope(t, N_VGetArrayPointer(y), N_VGetArrayPointer(dy), s->problem->with);
    return 0;
}

/* An iteration that does not converge shows as a result of CVode(); a printed line for each would
 * only be noise. */
static void be_silent(int code, const char *module, const char *function, char *message, void *user)
{
    (void)code;
    (void)module;
    (void)function;
    (void)message;
    (void)user;
}

static bool start(solver *s, ode_method method, double tolerance)
{
    const ode_problem *problem = s->problem;
    const sunindextype states = problem->states;
    if (SUNContext_Create(NULL, &s->context) != 0)
        return false;
    s->y = N_VNew_Serial(states, s->context);
    s->tolerance = N_VNew_Serial(states, s->context);
    s->memory = CVodeCreate(method == ODE_ADAMS ? CV_ADAMS : CV_BDF, s->context);
    if (!s->y || !s->tolerance || !s->memory)
        return false;
    for (int i = 0; i < problem->states; i++) {
        N_VGetArrayPointer(s->y)[i] = problem->start[i];
        N_VGetArrayPointer(s->tolerance)[i] = tolerance * problem->size[i];
    }
    bool good = CVodeSetErrHandlerFn(s->memory, be_silent, NULL) == CV_SUCCESS &&
                CVodeInit(s->memory, slope, 0.0, s->y) == CV_SUCCESS &&
                CVodeSVtolerances(s->memory, tolerance, s->tolerance) == CV_SUCCESS &&
                CVodeSetUserData(s->memory, s) == CV_SUCCESS &&
                CVodeSetMaxNumSteps(s->memory, -1) == CV_SUCCESS;
    if (method == ODE_ADAMS) {
        s->fixed_point = SUNNonlinSol_FixedPoint(s->y, 0, s->context);
        return good && CVodeSetNonlinearSolver(s->memory, s->fixed_point) == CV_SUCCESS;
    }
    s->matrix = SUNDenseMatrix(states, states, s->context);
    s->linear = SUNLinSol_Dense(s->y, s->matrix, s->context);
    return good && CVodeSetLinearSolver(s->memory, s->linear, s->matrix) == CV_SUCCESS;
}

static bool run(solver *s, double *readings)
{
    const ode_problem *problem = s->problem;
    double *y = N_VGetArrayPointer(s->y), ignored[ODE_READINGS_MAX];
    for (size_t i = 0; i < problem->pieces; i++) {
        const double begin = (double)i * problem->piece, end = (double)(i + 1) * problem->piece;
        realtype reached;
        if (problem->begin) {
            problem->begin(i, y, problem->with);
            if (CVodeReInit(s->memory, begin, s->y) != CV_SUCCESS ||
                CVodeSetStopTime(s->memory, end) != CV_SUCCESS)
                return false;
        }
        if (CVode(s->memory, end, s->y, &reached, CV_NORMAL) < 0)
            return false;
        problem->read(end, y, readings ? readings + i * (size_t)problem->readings : ignored,
                      problem->with);
    }
    return true;
}

bool ode_has_cvode(void)
{
    return true;
}

bool ode_cvode(const ode_problem *problem, ode_method method, double relative_tolerance, long most,
               double *readings, long *calls)
{
    solver s = {.problem = problem, .most = most};
    const bool good = start(&s, method, relative_tolerance) && run(&s, readings);
    *calls = s.calls;
    CVodeFree(&s.memory);
    if (s.fixed_point)
        SUNNonlinSolFree(s.fixed_point);
    if (s.linear)
        SUNLinSolFree(s.linear);
    if (s.matrix)
        SUNMatDestroy(s.matrix);
    N_VDestroy(s.y);
    N_VDestroy(s.tolerance);
    SUNContext_Free(&s.context);
    return good;
}

#else

bool ode_has_cvode(void)
{
    return false;
}

bool ode_cvode(const ode_problem *problem, ode_method method, double relative_tolerance, long most,
               double *readings, long *calls)
{
    (void)problem;
    (void)most;
    (void)method;
    (void)relative_tolerance;
    (void)readings;
    *calls = 0;
    return false;
}

#endif

/* ---- the truth ------------------------------------------------------------------------------- */

/* A step of h by the midpoint rule in n parts, smoothed. */
static void midpoints(const ode_problem *problem, double t, double h, int n, const double *y,
                      double *result)
{
    double before[ODE_STATES_MAX], at[ODE_STATES_MAX], dy[ODE_STATES_MAX];
    const double part = h / n;
    problem->slope(t, y, dy, problem->with);
    for (int i = 0; i < problem->states; i++) {
        before[i] = y[i];
        at[i] = y[i] + part * dy[i];
    }
    for (int k = 1; k < n; k++) {
        problem->slope(t + k * part, at, dy, problem->with);
        for (int i = 0; i < problem->states; i++) {
            const double next = before[i] + 2.0 * part * dy[i];
            before[i] = at[i];
            at[i] = next;
        }
    }
    problem->slope(t + h, at, dy, problem->with);
    for (int i = 0; i < problem->states; i++)
        result[i] = 0.5 * (at[i] + before[i] + part * dy[i]);
}

/* Columns of Aitken and Neville for the sequence 2, 4, … 16 parts. */
static void extrapolated_step(const ode_problem *problem, double t, double h, double *y)
{
    enum { COLUMNS = 8 };
    double table[COLUMNS][ODE_STATES_MAX];
    for (int k = 0; k < COLUMNS; k++) {
        midpoints(problem, t, h, 2 * (k + 1), y, table[k]);
        for (int j = k - 1; j >= 0; j--) {
            const double ratio = (double)(k + 1) / (double)(j + 1);
            for (int i = 0; i < problem->states; i++)
                table[j][i] =
                    table[j + 1][i] + (table[j + 1][i] - table[j][i]) / (ratio * ratio - 1.0);
        }
    }
    memcpy(y, table[0], (size_t)problem->states * sizeof *y);
}

void ode_reference(const ode_problem *problem, double step, double *readings)
{
    double y[ODE_STATES_MAX];
    const size_t count = (size_t)ceil(problem->piece / step);
    const double h = problem->piece / (double)count;
    memcpy(y, problem->start, sizeof y);
    for (size_t i = 0; i < problem->pieces; i++) {
        if (problem->begin)
            problem->begin(i, y, problem->with);
        for (size_t k = 0; k < count; k++)
            extrapolated_step(problem, (double)i * problem->piece + (double)k * h, h, y);
        problem->read((double)(i + 1) * problem->piece, y, readings + i * (size_t)problem->readings,
                      problem->with);
    }
}

double ode_distance(const ode_problem *problem, size_t stride, const double *first,
                    const double *second)
{
    const size_t readings = (size_t)problem->readings;
    double worst = 0.0;
    for (size_t i = 0; i < problem->pieces / stride; i++)
        for (size_t k = 0; k < readings; k++) {
            const double error =
                first[((i + 1) * stride - 1) * readings + k] - second[i * readings + k];
            worst = isfinite(error) ? fmax(worst, fabs(error)) : (double)INFINITY;
        }
    return worst;
}
