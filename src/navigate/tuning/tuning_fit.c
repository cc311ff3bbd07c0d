/* SPDX-License-Identifier: Apache-2.0 */
/* The numbers of a filter. Its covariance is linear in the variances theta, P_m = F + sum theta_i
 * M_i at each time.
 *
 * Fit: the least J = sum [tr(P_m^-1 P_t) + ln det P_m], the likelihood of errors of covariance P_t
 * if P_m were theirs. In the logarithms of theta, with W = P_m^-1,
 *
 *     gradient_i = theta_i sum tr(W M_i) - tr(W P_t W M_i)
 *     H_ij = theta_i theta_j sum 2 tr(W M_i W M_j W P_t) - tr(W M_i W M_j), + gradient_i if i = j:
 *
 * steps of Newton, damped by the diagonal of sum tr(W M_i W M_j) where they do not lead down. Where
 * theta_i comes to nothing it makes less than 1e-6 of P_m everywhere, and is left there. At the
 * minimum
 * sum theta_i gradient_i/theta_i = 0: without F, the mean of tr(W P_t) is 9.
 *
 * Safe: the least sum of c_i theta_i, c_i = sum tr(P_fit^-1 M_i), with P_m - P_t/limit >= 0 at each
 * time and no theta_i below its floor, the sensor's own noise: a convex problem with one answer, by
 * an interior path,
 *
 *     c . theta - mu [sum ln det (P_m - P_t/limit) + sum ln (theta_i - floor_i)],  mu -> 0
 *
 * [BOYD2004]. */
#include "tuning_internal.h"

#include "imukit/elementary.h"
#include "imukit/linear_algebra.h"

#include <math.h>
#include <string.h>

enum { STATES = 9, STEPS_MAX = 400 };

void imki_tuning_model(const imki_tuning_problem *problem, const double *theta, size_t time,
                       double p[9][9])
{
    memcpy(p, problem->fixed[time], sizeof problem->fixed[time]);
    for (int k = 0; k < problem->parameters; k++) {
        double(*m)[9] = problem->basis[(size_t)k * problem->times + time];
        for (int i = 0; i < STATES; i++)
            for (int j = 0; j < STATES; j++)
                p[i][j] += theta[k] * m[i][j];
    }
}

static void product(const double a[9][9], const double b[9][9], double c[9][9])
{
    for (int i = 0; i < STATES; i++) {
        double row[9] = {0.0};
        for (int k = 0; k < STATES; k++)
            for (int j = 0; j < STATES; j++)
                row[j] += a[i][k] * b[k][j];
        memcpy(c[i], row, sizeof row);
    }
}

/* tr(a b) */
static double trace_of(const double a[9][9], const double b[9][9])
{
    double sum = 0.0;
    for (int i = 0; i < STATES; i++)
        for (int k = 0; k < STATES; k++)
            sum += a[i][k] * b[k][i];
    return sum;
}

static bool invert(const double p[9][9], double inverse[9][9], double *log_determinant)
{
    double l[9][9];
    memcpy(l, p, sizeof l);
    if (imk_cholesky_factor(STATES, &l[0][0]) != IMK_OK)
        return false;
    imk_cholesky_inverse(STATES, &l[0][0], &inverse[0][0]);
    *log_determinant = imk_cholesky_log_determinant(STATES, &l[0][0]);
    return true;
}

/* ---- what both minimise: value, gradient and curvature ---- */

typedef struct curve {
    double value, gradient[IMKI_PARAMETERS_MAX];
    double bend[IMKI_PARAMETERS_MAX][IMKI_PARAMETERS_MAX];
    double scale[IMKI_PARAMETERS_MAX]; /* of a damping: positive */
} curve;

/* Products of W with the bases, and their traces, of one time. The bend is that of
 * -ln det or, with `truth` = W P_t, of J. */
static void add_bases(const imki_tuning_problem *problem, size_t time, const double w[9][9],
                      const double weight[9][9], const double (*truth)[9], curve *c)
{
    double with[IMKI_PARAMETERS_MAX][9][9], seen[9][9];
    const int n = problem->parameters;
    for (int i = 0; i < n; i++) {
        double(*m)[9] = problem->basis[(size_t)i * problem->times + time];
        product(w, (const double(*)[9])m, with[i]);
        c->gradient[i] += trace_of(weight, (const double(*)[9])m);
        if (truth)
            product((const double(*)[9])with[i], truth, seen);
        for (int j = 0; j <= i; j++) {
            const double plain = trace_of((const double(*)[9])with[i], (const double(*)[9])with[j]);
            c->bend[i][j] +=
                truth
                    ? 2.0 * trace_of((const double(*)[9])with[j], (const double(*)[9])seen) - plain
                    : plain;
            c->scale[i] += i == j ? plain : 0.0;
        }
    }
}

/* J by theta; false: P_m is singular. */
static bool likelihood(const imki_tuning_problem *problem, const double *theta, curve *c)
{
    memset(c, 0, sizeof *c);
    for (size_t t = 0; t < problem->times; t++) {
        double p[9][9], w[9][9], both[9][9], weight[9][9], log_determinant;
        imki_tuning_model(problem, theta, t, p);
        if (!invert((const double(*)[9])p, w, &log_determinant))
            return false;
        product((const double(*)[9])w, problem->truth[t], both);
        product((const double(*)[9])both, (const double(*)[9])w, weight);
        c->value += log_determinant;
        for (int i = 0; i < STATES; i++) {
            c->value += both[i][i];
            for (int j = 0; j < STATES; j++)
                weight[i][j] = w[i][j] - weight[i][j];
        }
        add_bases(problem, t, (const double(*)[9])w, (const double(*)[9])weight,
                  (const double(*)[9])both, c);
    }
    return isfinite(c->value);
}

/* step = -(H + damping scale)^-1 g; false: not upward bent. */
static bool newton(int n, const curve *c, double damping, double *step)
{
    double h[IMKI_PARAMETERS_MAX * IMKI_PARAMETERS_MAX];
    for (int i = 0; i < n; i++) {
        step[i] = -c->gradient[i];
        for (int j = 0; j <= i; j++)
            h[i * n + j] = c->bend[i][j] + (i == j ? damping * c->scale[i] : 0.0);
    }
    if (imk_cholesky_factor((size_t)n, h) != IMK_OK)
        return false;
    imk_cholesky_solve((size_t)n, h, step);
    return true;
}

/* ---- fit ---- */

/* theta at which a basis makes this part of P_m, where it makes most. */
static double theta_at(const imki_tuning_problem *problem, const double *theta, int k, double part)
{
    double most = 0.0;
    for (size_t t = 0; t < problem->times; t++) {
        double p[9][9], w[9][9], log_determinant;
        imki_tuning_model(problem, theta, t, p);
        if (invert((const double(*)[9])p, w, &log_determinant))
            most = fmax(
                most, trace_of((const double(*)[9])w,
                               (const double(*)[9])problem->basis[(size_t)k * problem->times + t]));
    }
    return most > 0.0 ? part * STATES / most : 0.0;
}

static void to_logarithms(const imki_tuning_problem *problem, const double *theta, curve *c)
{
    for (int i = 0; i < problem->parameters; i++) {
        c->gradient[i] *= theta[i];
        c->scale[i] *= theta[i] * theta[i];
        for (int j = 0; j <= i; j++)
            c->bend[i][j] *= theta[i] * theta[j];
    }
}

/* Those that come to nothing are held: the rest is decided without them. */
static bool step_of_fit(const imki_tuning_problem *problem, const double *least, double damping,
                        const double *theta, const curve *now, double *trial)
{
    curve c = *now;
    double step[IMKI_PARAMETERS_MAX];
    const int n = problem->parameters;
    for (int i = 0; i < n; i++) {
        c.bend[i][i] += c.gradient[i];
        if (theta[i] > least[i] || c.gradient[i] < 0.0)
            continue;
        c.gradient[i] = 0.0;
        for (int j = 0; j < n; j++)
            c.bend[i > j ? i : j][i > j ? j : i] = 0.0;
        c.bend[i][i] = 1.0;
    }
    if (!newton(n, &c, damping, step))
        return false;
    for (int i = 0; i < n; i++) {
        const double reach = fmax(-3.0, fmin(3.0, step[i]));
        trial[i] = fmax(theta[i] * imk_exp(reach), least[i]);
    }
    return true;
}

/* Largest part of the gradient that may still be followed. */
static double slope_left(const imki_tuning_problem *problem, const double *least,
                         const double *theta, const curve *c)
{
    double most = 0.0;
    for (int i = 0; i < problem->parameters; i++)
        if (theta[i] > least[i] || c->gradient[i] < 0.0)
            most = fmax(most, fabs(c->gradient[i]));
    return most;
}

bool imki_tuning_fit(const imki_tuning_problem *problem, double *theta)
{
    double least[IMKI_PARAMETERS_MAX], damping = 1e-3;
    const int n = problem->parameters;
    curve now, next;
    if (!likelihood(problem, theta, &now))
        return false;
    to_logarithms(problem, theta, &now);
    for (int steps = 0; steps < STEPS_MAX; steps++) {
        double trial[IMKI_PARAMETERS_MAX];
        for (int i = 0; i < n; i++)
            least[i] = theta_at(problem, theta, i, 1e-6);
        if (slope_left(problem, least, theta, &now) < 1e-10 * (double)problem->times)
            return true;
        const bool made = step_of_fit(problem, least, damping, theta, &now, trial);
        if (made && likelihood(problem, trial, &next) && next.value <= now.value) {
            memcpy(theta, trial, (size_t)n * sizeof *theta);
            to_logarithms(problem, theta, &next);
            now = next;
            damping = fmax(0.1 * damping, 1e-12);
        } else if (damping > 1e12) {
            return slope_left(problem, least, theta, &now) < 1e-5 * (double)problem->times;
        } else
            damping *= 10.0;
    }
    return slope_left(problem, least, theta, &now) < 1e-5 * (double)problem->times;
}

double imki_tuning_likelihood(const imki_tuning_problem *problem, const double *theta)
{
    curve c;
    return likelihood(problem, theta, &c) ? c.value : (double)INFINITY;
}

/* ---- safe ---- */

typedef struct path {
    const imki_tuning_problem *problem;
    double cost[IMKI_PARAMETERS_MAX], unit[IMKI_PARAMETERS_MAX]; /* theta = floor + unit u */
    double mu;
} path;

static double theta_of(const path *p, const double *u, int i)
{
    return p->problem->floor[i] + u[i] * p->unit[i];
}

static double cost_of(const path *p, const double *u)
{
    double total = 0.0;
    for (int i = 0; i < p->problem->parameters; i++)
        total += p->cost[i] * theta_of(p, u, i);
    return total;
}

/* The function of the path at u; false: outside. */
static bool barrier(const path *p, const double *u, curve *c)
{
    const imki_tuning_problem *problem = p->problem;
    double theta[IMKI_PARAMETERS_MAX];
    memset(c, 0, sizeof *c);
    for (int i = 0; i < problem->parameters; i++) {
        if (!(u[i] > 0.0))
            return false;
        theta[i] = theta_of(p, u, i);
    }
    for (size_t t = 0; t < problem->times; t++) {
        double s[9][9], w[9][9], log_determinant;
        imki_tuning_model(problem, theta, t, s);
        for (int i = 0; i < STATES; i++)
            for (int j = 0; j < STATES; j++)
                s[i][j] -= problem->truth[t][i][j] / problem->limit;
        if (!invert((const double(*)[9])s, w, &log_determinant))
            return false;
        c->value -= log_determinant;
        for (int i = 0; i < 81; i++)
            s[i / 9][i % 9] = -w[i / 9][i % 9];
        add_bases(problem, t, (const double(*)[9])w, (const double(*)[9])s, NULL, c);
    }
    to_logarithms(problem, p->unit, c);
    c->value = cost_of(p, u) + p->mu * c->value;
    for (int i = 0; i < problem->parameters; i++) {
        c->value -= p->mu * imk_ln(u[i]);
        c->gradient[i] = p->cost[i] * p->unit[i] + p->mu * (c->gradient[i] - 1.0 / u[i]);
        for (int j = 0; j <= i; j++)
            c->bend[i][j] *= p->mu;
        c->bend[i][i] += p->mu / (u[i] * u[i]);
        c->scale[i] = c->bend[i][i];
    }
    return isfinite(c->value);
}

/* Newton with steps halved until they lead down, inside. */
static bool follow(const path *p, double *u)
{
    const int n = p->problem->parameters;
    curve now, next;
    if (!barrier(p, u, &now))
        return false;
    for (int steps = 0; steps < 100; steps++) {
        double step[IMKI_PARAMETERS_MAX], trial[IMKI_PARAMETERS_MAX], fall = 0.0, part = 1.0;
        if (!newton(n, &now, 1e-13, step))
            return true;
        for (int i = 0; i < n; i++)
            fall -= now.gradient[i] * step[i];
        if (!(fall > 1e-9 * p->mu))
            return true;
        for (; part > 1e-12; part *= 0.5) {
            for (int i = 0; i < n; i++)
                trial[i] = u[i] + part * step[i];
            if (barrier(p, trial, &next) && next.value <= now.value - 1e-4 * part * fall)
                break;
        }
        if (!(part > 1e-12))
            return true; /* as far as rounding lets it */
        memcpy(u, trial, (size_t)n * sizeof *u);
        now = next;
    }
    return true;
}

bool imki_tuning_safe(const imki_tuning_problem *problem, const double *fit, double *theta)
{
    path p = {.problem = problem};
    double u[IMKI_PARAMETERS_MAX] = {0.0};
    const int n = problem->parameters;
    for (int i = 0; i < n; i++) {
        p.unit[i] = fmax(fit[i], theta_at(problem, fit, i, 1e-3));
        for (size_t t = 0; t < problem->times; t++) {
            double model[9][9];
            imki_tuning_model(problem, fit, t, model);
            p.cost[i] += imki_tuning_trace(
                (const double(*)[9])model,
                (const double(*)[9])problem->basis[(size_t)i * problem->times + t]);
        }
        u[i] = 1.0;
    }
    curve c;
    p.mu = 1.0;
    for (int grow = 0; !barrier(&p, u, &c); grow++) {
        if (grow == 200)
            return false;
        for (int i = 0; i < n; i++)
            u[i] *= 2.0;
    }
    double total = cost_of(&p, u);
    const double conditions = (double)(problem->times * STATES) + n;
    for (p.mu = total / conditions; p.mu * conditions > 1e-8 * total; p.mu *= 0.3) {
        if (!follow(&p, u))
            return false;
        total = cost_of(&p, u);
    }
    for (int i = 0; i < n; i++)
        theta[i] = theta_of(&p, u, i);
    return true;
}
