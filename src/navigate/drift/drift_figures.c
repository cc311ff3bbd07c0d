/* SPDX-License-Identifier: Apache-2.0 */
/* What the nine errors of a navigator amount to: CEP, R95, DRMS and the like, of a normal
 * distribution and of runs.
 *
 * Of runs, radii are quantiles of the order statistics, interpolated so that they are
 * median-unbiased [HYNDMAN1996, definition 8], with the interval between two order statistics whose
 * ranks the binomial distribution gives, free of any assumption. A root mean square r of n values
 * has the interval r exp(-+ z s/(2 r^2)), s^2 = (mean of x^4 - r^4)/n, z of 95 %. */
#include "base/sort_internal.h"
#include "drift_radius_internal.h"
#include "imukit/distributions.h"
#include "imukit/drift.h"

#include "imukit/elementary.h"

#include <math.h>
#include <stdbool.h>

enum { NORTH, EAST, DOWN, VELOCITY_NORTH, VELOCITY_EAST, CLIMB, TILT_NORTH, TILT_EAST, HEADING };

static double square_of(const imk_drift_moments *m, int state)
{
    return m->mean[state] * m->mean[state] + m->covariance[state][state];
}

imk_drift_figures imk_drift_figures_of(const imk_drift_moments *m)
{
    const imki_ellipse ellipse =
        imki_ellipse_of(m->mean[NORTH], m->mean[EAST], m->covariance[NORTH][NORTH],
                        m->covariance[NORTH][EAST], m->covariance[EAST][EAST]);
    return (imk_drift_figures){.cep = imki_ellipse_radius(&ellipse, 0.5),
                               .r95 = imki_ellipse_radius(&ellipse, 0.95),
                               .drms = sqrt(square_of(m, NORTH) + square_of(m, EAST)),
                               .north = sqrt(square_of(m, NORTH)),
                               .east = sqrt(square_of(m, EAST)),
                               .height = sqrt(square_of(m, DOWN)),
                               .velocity =
                                   sqrt(square_of(m, VELOCITY_NORTH) + square_of(m, VELOCITY_EAST)),
                               .climb = sqrt(square_of(m, CLIMB)),
                               .tilt = sqrt(square_of(m, TILT_NORTH) + square_of(m, TILT_EAST)),
                               .heading = sqrt(square_of(m, HEADING))};
}

double imk_drift_required(const imk_drift_figures *figures, imk_drift_requirement requirement)
{
    switch (requirement) {
    case IMK_REQUIRED_CEP:
        return figures->cep;
    case IMK_REQUIRED_R95:
        return figures->r95;
    case IMK_REQUIRED_DRMS:
        return figures->drms;
    case IMK_REQUIRED_HEIGHT:
        return figures->height;
    case IMK_REQUIRED_VELOCITY:
        return figures->velocity;
    case IMK_REQUIRED_TILT:
        return figures->tilt;
    case IMK_REQUIRED_HEADING:
        return figures->heading;
    }
    return (double)NAN;
}

/* ---- runs ---- */

typedef struct runs {
    size_t count, stride, used;
    const double *errors;
    double *scratch;
} runs;

/* The nine errors of a run, or NULL when one is not a number. */
static const double *run_of(const runs *r, size_t run)
{
    const double *e = r->errors + run * r->stride;
    for (int i = 0; i < IMK_DRIFT_STATES; i++)
        if (!isfinite(e[i]))
            return NULL;
    return e;
}

/* Of `count` >= 1 numbers in order; positions beyond the ends are the ends. */
static double quantile(const double *x, size_t count, double probability)
{
    const double position = ((double)count + 1.0 / 3.0) * probability + 1.0 / 3.0;
    if (!(position > 1.0))
        return x[0];
    if (!(position < (double)count))
        return x[count - 1];
    const size_t before = (size_t)position;
    const double share = position - (double)before;
    return x[before - 1] + share * (x[before] - x[before - 1]);
}

/* Ranks l < u, from 1, of the order statistics between which the quantile lies with 95 % at least:
 * the largest l with P(l or more of n below it) >= 97.5 %, and u likewise; l = 0 or u = n + 1 when
 * n is too small to say. The binomial distribution is summed from its mode outwards, unnormalised:
 * terms follow from their neighbours. */
static void ranks_of_interval(size_t n, double p, size_t *lower, size_t *upper)
{
    const double negligible = 1e-20, count = (double)n, odds = p / (1.0 - p);
    const double mode = floor((count + 1.0) * p);
    double first = mode, first_term = 1.0, last = mode, last_term = 1.0, sum = 1.0;
    while (first > 0.0 && first_term > negligible) {
        first_term *= first / ((count - first + 1.0) * odds);
        first -= 1.0;
        sum += first_term;
    }
    while (last < count && last_term > negligible) {
        last_term *= (count - last) * odds / (last + 1.0);
        last += 1.0;
        sum += last_term;
    }
    double k = first, below = first_term; /* below: of k or less */
    for (double term = first_term; below <= 0.025 * sum && k < count;) {
        term *= (count - k) * odds / (k + 1.0);
        k += 1.0;
        below += term;
    }
    *lower = (size_t)k; /* P(k - 1 or less) <= 2.5 % */
    double above = last_term;
    k = last;
    for (double term = last_term; above <= 0.025 * sum && k > 0.0;) {
        term *= k / ((count - k + 1.0) * odds);
        k -= 1.0;
        above += term;
    }
    *upper = (size_t)k + 1; /* P(k + 1 or more) <= 2.5 % */
}

static double radius_of(const double *x, size_t count, double probability, double *low,
                        double *high)
{
    size_t lower, upper;
    ranks_of_interval(count, probability, &lower, &upper);
    *low = lower > 0 ? x[lower - 1] : 0.0;
    *high = upper <= count ? x[upper - 1] : (double)INFINITY;
    return quantile(x, count, probability);
}

/* Root mean square of one state, or of two together (b < 0: of one). */
static double rms_of(const runs *r, int a, int b, double *low, double *high)
{
    const double z = 1.95996398454005423552, n = (double)r->used;
    double second = 0.0, fourth = 0.0;
    for (size_t i = 0; i < r->count; i++) {
        const double *e = run_of(r, i);
        if (!e)
            continue;
        const double square = e[a] * e[a] + (b >= 0 ? e[b] * e[b] : 0.0);
        second += square;
        fourth += square * square;
    }
    second /= n;
    fourth /= n;
    const double rms = sqrt(second);
    const double spread = fourth > second * second ? sqrt((fourth - second * second) / n) : 0.0;
    double factor = rms > 0.0 ? imk_exp(0.5 * z * spread / second) : 1.0;
    if (r->used < 2) /* one run says nothing of the scatter */
        factor = (double)INFINITY;
    *low = rms / factor;
    *high = rms * factor;
    return rms;
}

static imk_drift_figures nothing(void)
{
    const double none = (double)NAN;
    return (imk_drift_figures){none, none, none, none, none, none, none, none, none, none};
}

imk_drift_figures imk_drift_figures_of_runs(size_t count, size_t stride, const double *errors,
                                            double *scratch, imk_drift_figures *low,
                                            imk_drift_figures *high, size_t *used)
{
    imk_drift_figures f = nothing(), least = f, most = f;
    runs r = {count, stride, 0, errors, scratch};
    for (size_t i = 0; i < count; i++) {
        const double *e = run_of(&r, i);
        if (e)
            scratch[r.used++] = sqrt(e[NORTH] * e[NORTH] + e[EAST] * e[EAST]);
    }
    if (r.used > 0) {
        imki_sort(scratch, r.used);
        f.cep = radius_of(scratch, r.used, 0.5, &least.cep, &most.cep);
        f.r95 = radius_of(scratch, r.used, 0.95, &least.r95, &most.r95);
        f.drms = rms_of(&r, NORTH, EAST, &least.drms, &most.drms);
        f.north = rms_of(&r, NORTH, -1, &least.north, &most.north);
        f.east = rms_of(&r, EAST, -1, &least.east, &most.east);
        f.height = rms_of(&r, DOWN, -1, &least.height, &most.height);
        f.velocity = rms_of(&r, VELOCITY_NORTH, VELOCITY_EAST, &least.velocity, &most.velocity);
        f.climb = rms_of(&r, CLIMB, -1, &least.climb, &most.climb);
        f.tilt = rms_of(&r, TILT_NORTH, TILT_EAST, &least.tilt, &most.tilt);
        f.heading = rms_of(&r, HEADING, -1, &least.heading, &most.heading);
    }
    if (low)
        *low = least;
    if (high)
        *high = most;
    if (used)
        *used = r.used;
    return f;
}

imk_drift_validity imk_drift_validity_of(const imk_drift_figures *f)
{
    /* Beyond a tenth of a radian the square of an angle, which the linear theory drops, is a
     * twentieth of it [rad]. */
    const double largest_angle = 0.1;
    if (!(f->drms <= IMK_DRIFT_DISTANCE_MAX))
        return IMK_DRIFT_LOST;
    return f->tilt <= largest_angle && f->heading <= largest_angle ? IMK_DRIFT_LINEAR
                                                                   : IMK_DRIFT_ROUGH;
}

const char *imk_drift_requirement_name(imk_drift_requirement requirement)
{
    static const char *const names[] = {"CEP",      "R95",  "DRMS",   "height",
                                        "velocity", "tilt", "heading"};
    return names[requirement];
}

const char *imk_drift_requirement_unit(imk_drift_requirement requirement)
{
    static const char *const units[] = {"m", "m", "m", "m", "m/s", "rad", "rad"};
    return units[requirement];
}
