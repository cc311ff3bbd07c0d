/* SPDX-License-Identifier: Apache-2.0 */
/* The least-squares solver on the classical problems of More, Garbow and Hillstrom with their
 * published minima [MORE1981] (sums of squares, twice our cost, six digits), on a reference data
 * set of NIST with certified parameters and standard deviations, with bounds, and on bad input. */
#include "check.h"

#include "imukit/least_squares.h"

#include <stdlib.h>
#include <string.h>

#define COUNT(array) (sizeof(array) / sizeof((array)[0]))

static imk_status solve(imk_least_squares *problem, double *x, double *covariance,
                        imk_least_squares_result *result)
{
    const size_t size = imk_least_squares_workspace_size(problem);
    void *workspace = malloc(size);
    assert_non_null(workspace);
    const imk_status status =
        imk_least_squares_solve(problem, x, covariance, result, workspace, size);
    free(workspace);
    return status;
}

/* ---- the classical problems ------------------------------------------------------------------ */

static imk_status rosenbrock(void *context, const double *x, double *r, double *jacobian)
{
    (void)context;
    r[0] = 10.0 * (x[1] - x[0] * x[0]);
    r[1] = 1.0 - x[0];
    if (jacobian) {
        jacobian[0] = -20.0 * x[0];
        jacobian[1] = 10.0;
        jacobian[2] = -1.0;
        jacobian[3] = 0.0;
    }
    return IMK_OK;
}

static imk_status freudenstein_roth(void *context, const double *x, double *r, double *jacobian)
{
    (void)context, (void)jacobian;
    r[0] = -13.0 + x[0] + ((5.0 - x[1]) * x[1] - 2.0) * x[1];
    r[1] = -29.0 + x[0] + ((x[1] + 1.0) * x[1] - 14.0) * x[1];
    return IMK_OK;
}

static imk_status powell_badly_scaled(void *context, const double *x, double *r, double *jacobian)
{
    (void)context, (void)jacobian;
    r[0] = 1e4 * x[0] * x[1] - 1.0;
    r[1] = exp(-x[0]) + exp(-x[1]) - 1.0001;
    return IMK_OK;
}

static imk_status brown_badly_scaled(void *context, const double *x, double *r, double *jacobian)
{
    (void)context, (void)jacobian;
    r[0] = x[0] - 1e6;
    r[1] = x[1] - 2e-6;
    r[2] = x[0] * x[1] - 2.0;
    return IMK_OK;
}

static imk_status beale(void *context, const double *x, double *r, double *jacobian)
{
    (void)context, (void)jacobian;
    const double y[] = {1.5, 2.25, 2.625};
    for (int i = 0; i < 3; i++)
        r[i] = y[i] - x[0] * (1.0 - pow(x[1], i + 1));
    return IMK_OK;
}

static imk_status jennrich_sampson(void *context, const double *x, double *r, double *jacobian)
{
    (void)context, (void)jacobian;
    for (int i = 0; i < 10; i++)
        r[i] = 2.0 + 2.0 * (i + 1) - (exp((i + 1) * x[0]) + exp((i + 1) * x[1]));
    return IMK_OK;
}

static imk_status helical_valley(void *context, const double *x, double *r, double *jacobian)
{
    (void)context, (void)jacobian;
    const double turn = atan2(x[1], x[0]) / 6.283185307179586;
    r[0] = 10.0 * (x[2] - 10.0 * turn);
    r[1] = 10.0 * (hypot(x[0], x[1]) - 1.0);
    r[2] = x[2];
    return IMK_OK;
}

static imk_status bard(void *context, const double *x, double *r, double *jacobian)
{
    (void)context, (void)jacobian;
    const double y[] = {0.14, 0.18, 0.22, 0.25, 0.29, 0.32, 0.35, 0.39,
                        0.37, 0.58, 0.73, 0.96, 1.34, 2.10, 4.39};
    for (int i = 0; i < 15; i++) {
        const double u = i + 1, v = 15 - i, w = fmin(u, v);
        r[i] = y[i] - (x[0] + u / (v * x[1] + w * x[2]));
    }
    return IMK_OK;
}

static imk_status powell_singular(void *context, const double *x, double *r, double *jacobian)
{
    (void)context, (void)jacobian;
    r[0] = x[0] + 10.0 * x[1];
    r[1] = sqrt(5.0) * (x[2] - x[3]);
    r[2] = (x[1] - 2.0 * x[2]) * (x[1] - 2.0 * x[2]);
    r[3] = sqrt(10.0) * (x[0] - x[3]) * (x[0] - x[3]);
    return IMK_OK;
}

static imk_status kowalik_osborne(void *context, const double *x, double *r, double *jacobian)
{
    (void)context, (void)jacobian;
    const double y[] = {0.1957, 0.1947, 0.1735, 0.1600, 0.0844, 0.0627,
                        0.0456, 0.0342, 0.0323, 0.0235, 0.0246};
    const double u[] = {4.0, 2.0, 1.0, 0.5, 0.25, 0.167, 0.125, 0.1, 0.0833, 0.0714, 0.0625};
    for (int i = 0; i < 11; i++)
        r[i] = y[i] - x[0] * (u[i] * u[i] + u[i] * x[1]) / (u[i] * u[i] + u[i] * x[2] + x[3]);
    return IMK_OK;
}

static imk_status meyer(void *context, const double *x, double *r, double *jacobian)
{
    (void)context, (void)jacobian;
    const double y[] = {34780, 28610, 23650, 19630, 16370, 13720, 11540, 9744,
                        8261,  7030,  6005,  5147,  4427,  3820,  3307,  2872};
    for (int i = 0; i < 16; i++)
        r[i] = x[0] * exp(x[1] / (45.0 + 5.0 * (i + 1) + x[2])) - y[i];
    return IMK_OK;
}

static imk_status brown_dennis(void *context, const double *x, double *r, double *jacobian)
{
    (void)context, (void)jacobian;
    for (int i = 0; i < 20; i++) {
        const double t = (i + 1) / 5.0;
        const double a = x[0] + t * x[1] - exp(t), b = x[2] + x[3] * sin(t) - cos(t);
        r[i] = a * a + b * b;
    }
    return IMK_OK;
}

static imk_status wood(void *context, const double *x, double *r, double *jacobian)
{
    (void)context, (void)jacobian;
    r[0] = 10.0 * (x[1] - x[0] * x[0]);
    r[1] = 1.0 - x[0];
    r[2] = sqrt(90.0) * (x[3] - x[2] * x[2]);
    r[3] = 1.0 - x[2];
    r[4] = sqrt(10.0) * (x[1] + x[3] - 2.0);
    r[5] = (x[1] - x[3]) / sqrt(10.0);
    return IMK_OK;
}

static void classical_problems_reach_their_published_minima(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        imk_residuals residuals;
        size_t n, m;
        double start[4];
        double minimum; /* sum of squares; 0: below 1e-18 of the start */
    } cases[] = {
        {"Rosenbrock", rosenbrock, 2, 2, {-1.2, 1.0}, 0.0},
        {"Freudenstein-Roth", freudenstein_roth, 2, 2, {0.5, -2.0}, 48.9842},
        {"Powell badly scaled", powell_badly_scaled, 2, 2, {0.0, 1.0}, 0.0},
        {"Brown badly scaled", brown_badly_scaled, 2, 3, {1.0, 1.0}, 0.0},
        {"Beale", beale, 2, 3, {1.0, 1.0}, 0.0},
        {"Jennrich-Sampson", jennrich_sampson, 2, 10, {0.3, 0.4}, 124.362},
        {"helical valley", helical_valley, 3, 3, {-1.0, 0.0, 0.0}, 0.0},
        {"Bard", bard, 3, 15, {1.0, 1.0, 1.0}, 8.21487e-3},
        {"Powell singular", powell_singular, 4, 4, {3.0, -1.0, 0.0, 1.0}, 0.0},
        {"Kowalik-Osborne", kowalik_osborne, 4, 11, {0.25, 0.39, 0.415, 0.39}, 3.07505e-4},
        {"Meyer", meyer, 3, 16, {0.02, 4000.0, 250.0}, 87.9458},
        {"Brown-Dennis", brown_dennis, 4, 20, {25.0, 5.0, -5.0, -1.0}, 85822.2},
        {"Wood", wood, 4, 6, {-3.0, -1.0, -3.0, -1.0}, 0.0},
    };
    for (size_t i = 0; i < COUNT(cases); i++) {
        imk_least_squares problem = imk_least_squares_default();
        imk_least_squares_result result;
        double x[4];
        memcpy(x, cases[i].start, sizeof x);
        problem.parameter_count = cases[i].n;
        problem.residual_count = cases[i].m;
        problem.residuals = cases[i].residuals;
        problem.max_iterations = 400; /* Meyer's valley needs more than a hundred */
        const imk_status status = solve(&problem, x, NULL, &result);
        CHECK_OK(status);
        if (cases[i].minimum > 0.0)
            CHECK_RELATIVE(2.0 * result.cost, cases[i].minimum, 1e-5);
        else
            CHECK_BELOW(result.cost, 1e-18 * result.initial_cost);
    }
}
/* A Jacobian of the caller and one by differences lead to the same place. */
static void a_given_jacobian_is_used(void **state)
{
    (void)state;
    imk_least_squares problem = imk_least_squares_default();
    imk_least_squares_result by_differences, given;
    double x[2] = {-1.2, 1.0}, y[2] = {-1.2, 1.0};
    problem.parameter_count = problem.residual_count = 2;
    problem.residuals = rosenbrock;
    CHECK_OK(solve(&problem, x, NULL, &by_differences));
    problem.has_jacobian = true;
    CHECK_OK(solve(&problem, y, NULL, &given));
    CHECK_CLOSE(y[0], 1.0, 1e-10);
    CHECK_CLOSE(y[1], 1.0, 1e-10);
    assert_true(given.evaluations < by_differences.evaluations);
}

/* ---- uncertainty ----------------------------------------------------------------------------- */

/* NIST Statistical Reference Datasets, Misra1a: y = b1 (1 - e^{-b2 x}). */
static imk_status misra1a(void *context, const double *b, double *r, double *jacobian)
{
    (void)context, (void)jacobian;
    static const double y[] = {10.07, 14.73, 17.94, 23.93, 29.61, 35.18, 40.02,
                               44.82, 50.76, 55.05, 61.01, 66.40, 75.47, 81.78};
    static const double x[] = {77.6,  114.9, 141.1, 190.8, 239.9, 289.0, 332.8,
                               378.4, 434.8, 477.3, 536.8, 593.1, 689.1, 760.0};
    for (int i = 0; i < 14; i++)
        r[i] = y[i] - b[0] * (1.0 - exp(-b[1] * x[i]));
    return IMK_OK;
}

static void certified_parameters_and_deviations_are_reproduced(void **state)
{
    (void)state;
    const double starts[][2] = {{500.0, 0.0001}, {250.0, 0.0005}};
    for (size_t i = 0; i < COUNT(starts); i++) {
        imk_least_squares problem = imk_least_squares_default();
        imk_least_squares_result result;
        double b[2] = {starts[i][0], starts[i][1]}, covariance[4];
        problem.parameter_count = 2;
        problem.residual_count = 14;
        problem.residuals = misra1a;
        CHECK_OK(solve(&problem, b, covariance, &result));
        /* Forward differences leave the derivatives, and so the deviations, good to about 1e-7; the
         * minimum itself suffers less. */
        CHECK_RELATIVE(b[0], 2.3894212918e+02, 1e-7);
        CHECK_RELATIVE(b[1], 5.5015643181e-04, 1e-7);
        CHECK_RELATIVE(2.0 * result.cost, 1.2455138894e-01, 1e-9);
        const double variance = 2.0 * result.cost / 12.0;
        CHECK_RELATIVE(sqrt(variance * covariance[0]), 2.7070075241e+00, 1e-5);
        CHECK_RELATIVE(sqrt(variance * covariance[3]), 7.2668688436e-06, 1e-5);
        CHECK_RELATIVE(covariance[1], covariance[2], 0.0);
        assert_int_equal(result.free_parameters, 2);
    }
}

/* Straight line through (0 … 9, y): the closed form of its covariance is
 * [ sum t^2, -sum t ; -sum t, n ] / (n sum t^2 - (sum t)^2). */
static imk_status straight_line(void *context, const double *x, double *r, double *jacobian)
{
    const double *y = context;
    for (int t = 0; t < 10; t++) {
        r[t] = x[0] + x[1] * t - y[t];
        if (jacobian) {
            jacobian[2 * t] = 1.0;
            jacobian[2 * t + 1] = t;
        }
    }
    return IMK_OK;
}

static void covariance_of_a_line_has_its_closed_form(void **state)
{
    (void)state;
    double y[10], x[2] = {100.0, -50.0}, covariance[4];
    for (int t = 0; t < 10; t++)
        y[t] = 3.0 + 0.5 * t + (t % 2 ? 0.1 : -0.1);
    imk_least_squares problem = imk_least_squares_default();
    problem.parameter_count = 2;
    problem.residual_count = 10;
    problem.residuals = straight_line;
    problem.context = y;
    problem.has_jacobian = true;
    CHECK_OK(solve(&problem, x, covariance, NULL));
    /* sum t = 45, sum t^2 = 285, determinant 825. */
    CHECK_RELATIVE(covariance[0], 285.0 / 825.0, 1e-14);
    CHECK_RELATIVE(covariance[1], -45.0 / 825.0, 1e-14);
    CHECK_RELATIVE(covariance[3], 10.0 / 825.0, 1e-14);
    /* The zigzag has sum 0 and sum t = 0.5: slope 0.5 + 10 * 0.5/825. */
    CHECK_CLOSE(x[1], 0.5 + 5.0 / 825.0, 1e-9);
    CHECK_CLOSE(x[0], 3.0 - 0.5 * 45.0 / 825.0, 1e-9);
}

/* ---- bounds ---------------------------------------------------------------------------------- */

/* x0 <= 1/2 makes the minimum (1/2, 1/4), cost 1/8; x1 is then known to 1/10. */
static void an_active_bound_holds_its_parameter(void **state)
{
    (void)state;
    const double lower[] = {-5.0, -5.0}, upper[] = {0.5, 5.0};
    const double starts[][2] = {{-1.2, 1.0}, {0.5, -3.0}, {7.0, 9.0}};
    for (size_t i = 0; i < COUNT(starts); i++) {
        imk_least_squares problem = imk_least_squares_default();
        imk_least_squares_result result;
        double x[2] = {starts[i][0], starts[i][1]}, covariance[4];
        problem.parameter_count = problem.residual_count = 2;
        problem.residuals = rosenbrock;
        problem.has_jacobian = true;
        problem.lower = lower;
        problem.upper = upper;
        CHECK_OK(solve(&problem, x, covariance, &result));
        CHECK_CLOSE(x[0], 0.5, 0.0);
        CHECK_CLOSE(x[1], 0.25, 1e-9);
        CHECK_RELATIVE(result.cost, 0.125, 1e-12);
        assert_int_equal(result.free_parameters, 1);
        CHECK_CLOSE(covariance[0], 0.0, 0.0);
        CHECK_CLOSE(covariance[1], 0.0, 0.0);
        CHECK_CLOSE(covariance[2], 0.0, 0.0);
        CHECK_RELATIVE(covariance[3], 0.01, 1e-12);
    }
}

enum { BOX_PARAMETERS = 7, BOX_RESIDUALS = 12 };
typedef struct box {
    double a[BOX_RESIDUALS][BOX_PARAMETERS], b[BOX_RESIDUALS];
    double lower[BOX_PARAMETERS], upper[BOX_PARAMETERS];
} box;

static imk_status box_residuals(void *context, const double *x, double *r, double *jacobian)
{
    const box *problem = context;
    for (int i = 0; i < BOX_RESIDUALS; i++) {
        r[i] = -problem->b[i];
        for (int j = 0; j < BOX_PARAMETERS; j++) {
            r[i] += problem->a[i][j] * x[j];
            if (jacobian)
                jacobian[i * BOX_PARAMETERS + j] = problem->a[i][j];
            /* Evaluated outside the box is a failure of the solver. */
            if (x[j] < problem->lower[j] || x[j] > problem->upper[j])
                return IMK_ERROR_RANGE;
        }
    }
    return IMK_OK;
}

static double next_number(uint64_t *state)
{
    *state ^= *state << 13;
    *state ^= *state >> 7;
    *state ^= *state << 17;
    return (double)(*state >> 11) * 0x1p-53 - 0.5;
}

/* Strongly correlated linear problems in random boxes are convex: a point is the minimum exactly
 * when the conditions of Karush, Kuhn and Tucker hold, gradient 0 inside, outward at the bounds. */
static void linear_problems_in_boxes_meet_the_optimality_conditions(void **state)
{
    (void)state;
    uint64_t random = 42;
    int active = 0;
    for (int trial = 0; trial < 300; trial++) {
        box context;
        double x[BOX_PARAMETERS];
        for (int i = 0; i < BOX_RESIDUALS; i++) {
            const double common = next_number(&random);
            context.b[i] = next_number(&random);
            for (int j = 0; j < BOX_PARAMETERS; j++)
                context.a[i][j] = common + 0.3 * next_number(&random);
        }
        for (int j = 0; j < BOX_PARAMETERS; j++) {
            context.lower[j] = 0.5 * next_number(&random) - 0.1;
            context.upper[j] = context.lower[j] + 0.5 + next_number(&random);
            x[j] = context.lower[j];
        }
        imk_least_squares problem = imk_least_squares_default();
        problem.parameter_count = BOX_PARAMETERS;
        problem.residual_count = BOX_RESIDUALS;
        problem.residuals = box_residuals;
        problem.context = &context;
        problem.has_jacobian = trial % 2 == 0;
        problem.lower = context.lower;
        problem.upper = context.upper;
        CHECK_OK(solve(&problem, x, NULL, NULL));
        double r[BOX_RESIDUALS];
        CHECK_OK(box_residuals(&context, x, r, NULL));
        for (int j = 0; j < BOX_PARAMETERS; j++) {
            double gradient = 0.0;
            for (int i = 0; i < BOX_RESIDUALS; i++)
                gradient += context.a[i][j] * r[i];
            const bool at_lower = x[j] == context.lower[j], at_upper = x[j] == context.upper[j];
            active += at_lower || at_upper;
            /* A cost within 1e-12 of the minimum leaves gradients of about its square root. */
            if (!at_upper)
                CHECK_BELOW(-gradient, 3e-6);
            if (!at_lower)
                CHECK_BELOW(gradient, 3e-6);
        }
    }
    assert_true(active > 300); /* the bounds did matter */
}

static void a_parameter_between_equal_bounds_is_fixed(void **state)
{
    (void)state;
    const double lower[] = {-5.0, 0.81}, upper[] = {5.0, 0.81};
    imk_least_squares problem = imk_least_squares_default();
    imk_least_squares_result result;
    double x[2] = {0.3, 0.0}, covariance[4];
    problem.parameter_count = problem.residual_count = 2;
    problem.residuals = rosenbrock;
    problem.lower = lower;
    problem.upper = upper;
    CHECK_OK(solve(&problem, x, covariance, &result));
    CHECK_CLOSE(x[1], 0.81, 0.0);
    /* d/dx [100 (0.81 - x^2)^2 + (1 - x)^2] = 0, by bisection in 50 digits. */
    CHECK_CLOSE(x[0], 0.900307535142032, 1e-8);
    assert_int_equal(result.free_parameters, 1);
    CHECK_CLOSE(covariance[3], 0.0, 0.0);
}

/* ---- bad input ------------------------------------------------------------------------------- */

static imk_status not_a_number_right_of_two(void *context, const double *x, double *r,
                                            double *jacobian)
{
    (void)context, (void)jacobian;
    r[0] = x[0] > 2.0 ? (double)NAN : 1.9 - x[0];
    return IMK_OK;
}

/* A step into NaN is refused and a shorter one tried; a start there is an error. */
static void not_finite_residuals_are_refused(void **state)
{
    (void)state;
    imk_least_squares problem = imk_least_squares_default();
    double x = -1000.0;
    problem.parameter_count = problem.residual_count = 1;
    problem.residuals = not_a_number_right_of_two;
    CHECK_OK(solve(&problem, &x, NULL, NULL));
    CHECK_CLOSE(x, 1.9, 1e-9);
    x = 3.0;
    CHECK_STATUS(solve(&problem, &x, NULL, NULL), IMK_ERROR_NOT_FINITE);
    CHECK_CLOSE(x, 3.0, 0.0);
    x = (double)INFINITY;
    CHECK_STATUS(solve(&problem, &x, NULL, NULL), IMK_ERROR_NOT_FINITE);
}

static imk_status only_the_sum(void *context, const double *x, double *r, double *jacobian)
{
    (void)context, (void)jacobian;
    r[0] = x[0] + x[1] - 3.0;
    r[1] = 2.0 * (x[0] + x[1]) - 5.0;
    r[2] = x[0] + x[1] - 2.0;
    return IMK_OK;
}

/* Parameters that cannot be told apart: a minimum is found, but no covariance. */
static void a_degenerate_problem_has_a_solution_but_no_covariance(void **state)
{
    (void)state;
    imk_least_squares problem = imk_least_squares_default();
    double x[2] = {0.0, 0.0}, covariance[4] = {7.0, 7.0, 7.0, 7.0};
    problem.parameter_count = 2;
    problem.residual_count = 3;
    problem.residuals = only_the_sum;
    CHECK_STATUS(solve(&problem, x, covariance, NULL), IMK_ERROR_SINGULAR);
    CHECK_CLOSE(x[0] + x[1], 15.0 / 6.0, 1e-9); /* (3 + 2*5 + 2)/(1 + 4 + 1) */
    for (int i = 0; i < 4; i++)
        CHECK_CLOSE(covariance[i], 7.0, 0.0);
    CHECK_OK(solve(&problem, x, NULL, NULL));
}

static imk_status stops_after_five(void *context, const double *x, double *r, double *jacobian)
{
    int *calls = context;
    (void)rosenbrock(NULL, x, r, jacobian);
    return ++*calls > 5 ? IMK_ERROR_UNSUPPORTED : IMK_OK;
}

static void iterations_end_at_the_limit_or_by_the_caller(void **state)
{
    (void)state;
    imk_least_squares problem = imk_least_squares_default();
    imk_least_squares_result result;
    int calls = 0;
    double x[2] = {-1.2, 1.0}, r[2];
    problem.parameter_count = problem.residual_count = 2;
    problem.residuals = rosenbrock;
    problem.max_iterations = 5;
    CHECK_STATUS(solve(&problem, x, NULL, &result), IMK_ERROR_NO_CONVERGENCE);
    assert_true(result.cost < result.initial_cost);
    CHECK_OK(rosenbrock(NULL, x, r, NULL));
    CHECK_RELATIVE(0.5 * (r[0] * r[0] + r[1] * r[1]), result.cost, 1e-14); /* the best point */
    x[0] = -1.2, x[1] = 1.0;
    problem.residuals = stops_after_five;
    problem.context = &calls;
    problem.has_jacobian = true;
    CHECK_STATUS(solve(&problem, x, NULL, NULL), IMK_ERROR_UNSUPPORTED);
    assert_int_equal(calls, 6);
}

static void bad_problems_are_refused(void **state)
{
    (void)state;
    const double lower[] = {1.0, 0.0}, upper[] = {0.0, 1.0};
    double x[2] = {0.5, 0.5};
    double workspace[256];
    imk_least_squares good = imk_least_squares_default();
    good.parameter_count = good.residual_count = 2;
    good.residuals = rosenbrock;
    const size_t size = imk_least_squares_workspace_size(&good);
    assert_true(size <= sizeof workspace);
    CHECK_STATUS(imk_least_squares_solve(&good, x, NULL, NULL, workspace, size - 1),
                 IMK_ERROR_WORKSPACE);
    CHECK_STATUS(imk_least_squares_solve(&good, x, NULL, NULL, NULL, size), IMK_ERROR_ARGUMENT);
    CHECK_STATUS(imk_least_squares_solve(NULL, x, NULL, NULL, workspace, size), IMK_ERROR_ARGUMENT);
    imk_least_squares bad = good;
    bad.cookie = 0;
    CHECK_STATUS(solve(&bad, x, NULL, NULL), IMK_ERROR_UNINITIALISED);
    bad = good;
    bad.residuals = NULL;
    CHECK_STATUS(solve(&bad, x, NULL, NULL), IMK_ERROR_ARGUMENT);
    bad = good;
    bad.residual_count = 1;
    CHECK_STATUS(solve(&bad, x, NULL, NULL), IMK_ERROR_ARGUMENT);
    bad = good;
    bad.lower = lower;
    bad.upper = upper;
    CHECK_STATUS(solve(&bad, x, NULL, NULL), IMK_ERROR_ARGUMENT);
    bad = good;
    bad.parameter_count = 65;
    assert_int_equal(imk_least_squares_workspace_size(&bad), 0);
    CHECK_CLOSE(x[0], 0.5, 0.0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(classical_problems_reach_their_published_minima),
        cmocka_unit_test(a_given_jacobian_is_used),
        cmocka_unit_test(certified_parameters_and_deviations_are_reproduced),
        cmocka_unit_test(covariance_of_a_line_has_its_closed_form),
        cmocka_unit_test(an_active_bound_holds_its_parameter),
        cmocka_unit_test(linear_problems_in_boxes_meet_the_optimality_conditions),
        cmocka_unit_test(a_parameter_between_equal_bounds_is_fixed),
        cmocka_unit_test(not_finite_residuals_are_refused),
        cmocka_unit_test(a_degenerate_problem_has_a_solution_but_no_covariance),
        cmocka_unit_test(iterations_end_at_the_limit_or_by_the_caller),
        cmocka_unit_test(bad_problems_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
