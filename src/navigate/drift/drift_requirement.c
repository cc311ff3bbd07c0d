/* SPDX-License-Identifier: Apache-2.0 */
/* The inverse question: how good must each source of error become for a figure to meet a goal?
 *
 * A source made better by the factor c has the mean c m and the covariance c^2 P; what sources with
 * the factors c and d have in common is c d times as large.
 *
 * The least work is counted in factors: to halve one error is as much work as to halve another, so
 * that the sum of ln(1/c) is to be least. For a mean square, the sum of c^2 v over the sources, the
 * condition of Lagrange is 1/c = 2 lambda c v: c^2 v is the same for all sources that are made
 * better at all. A common ceiling u is thus put on what each source contributes by itself,
 * c = min(1, u/f), f being the figure of this source alone, and lowered until the whole meets the
 * goal. */
#include "drift_radius_internal.h"
#include "imukit/drift.h"

#include <math.h>
#include <stdbool.h>

/* Steps of a bisection: the interval ends as narrow as a double can say. */
enum { BISECTIONS = 60 };

static void add(imk_drift_moments *sum, const imk_drift_moments *m, double factor)
{
    for (int i = 0; i < IMK_DRIFT_STATES; i++) {
        sum->mean[i] += factor * m->mean[i];
        for (int j = 0; j < IMK_DRIFT_STATES; j++)
            sum->covariance[i][j] += factor * factor * m->covariance[i][j];
    }
}

static void add_cross(imk_drift_moments *sum, const imk_drift_moments *m, double factor)
{
    for (int i = 0; i < IMK_DRIFT_STATES; i++)
        for (int j = 0; j < IMK_DRIFT_STATES; j++)
            sum->covariance[i][j] += factor * m->covariance[i][j];
}

static double figure_of(const imk_drift_moments *m, imk_drift_requirement requirement)
{
    const imk_drift_figures figures = imk_drift_figures_of(m);
    return imk_drift_required(&figures, requirement);
}

/* True when the figure is at most the goal. Of a radius: when the circle holds as much as it
 * should, which is one integral instead of the search for the radius. */
static bool meets(const imk_drift_moments *m, imk_drift_requirement requirement, double goal)
{
    if (requirement != IMK_REQUIRED_CEP && requirement != IMK_REQUIRED_R95)
        return figure_of(m, requirement) <= goal;
    const imki_ellipse ellipse = imki_ellipse_of(m->mean[0], m->mean[1], m->covariance[0][0],
                                                 m->covariance[0][1], m->covariance[1][1]);
    return imki_ellipse_probability(&ellipse, goal) >=
           (requirement == IMK_REQUIRED_CEP ? 0.5 : 0.95);
}

typedef struct question {
    const imk_drift_analysis *analysis;
    size_t time;
    imk_drift_requirement requirement;
    double goal;
} question;

static const imk_drift_moments *source_of(const question *q, size_t source)
{
    return &q->analysis->contribution[source * q->analysis->time_count + q->time];
}

/* ---- one source alone ---- */

/* What is left without it, with what it has in common with that, and it. */
typedef struct divided {
    imk_drift_moments rest, common;
    const imk_drift_moments *one;
} divided;

static bool meets_with(const question *q, const divided *d, double factor)
{
    imk_drift_moments sum = d->rest;
    add(&sum, d->one, factor);
    add_cross(&sum, &d->common, factor);
    return meets(&sum, q->requirement, q->goal);
}

/* Largest factor of one source with which the goal is met. */
static double alone(const question *q, size_t source)
{
    divided d = {.one = source_of(q, source)};
    for (size_t k = 0; k < q->analysis->source_count; k++)
        if (k != source)
            add(&d.rest, source_of(q, k), 1.0);
    for (size_t k = 0; k < q->analysis->cross_count; k++) {
        const imk_drift_cross *cross = &q->analysis->cross[k];
        const bool common = cross->first == source || cross->second == source;
        add_cross(common ? &d.common : &d.rest, &cross->moments[q->time], 1.0);
    }
    double good = 0.0, bad = 1.0;
    if (meets_with(q, &d, 1.0)) {
        good = 1.0;
        bad = 2.0;
        while (bad < 1e12 && meets_with(q, &d, bad)) {
            good = bad;
            bad *= 2.0;
        }
        if (bad >= 1e12)
            return (double)INFINITY; /* it does not matter for this figure */
    } else if (!meets_with(q, &d, 0.0)) {
        return 0.0;
    }
    for (int i = 0; i < BISECTIONS && bad - good > 1e-12 * bad; i++) {
        const double middle = 0.5 * (good + bad);
        if (meets_with(q, &d, middle))
            good = middle;
        else
            bad = middle;
    }
    return good;
}

/* ---- the common ceiling ---- */

static double under_ceiling(double figure, double ceiling)
{
    return figure > ceiling ? ceiling / figure : 1.0;
}

static bool meets_under(const question *q, const double *figure, double ceiling)
{
    imk_drift_moments sum = {{0}, {{0}}};
    for (size_t k = 0; k < q->analysis->source_count; k++)
        add(&sum, source_of(q, k), under_ceiling(figure[k], ceiling));
    for (size_t k = 0; k < q->analysis->cross_count; k++) {
        const imk_drift_cross *cross = &q->analysis->cross[k];
        add_cross(&sum, &cross->moments[q->time],
                  under_ceiling(figure[cross->first], ceiling) *
                      under_ceiling(figure[cross->second], ceiling));
    }
    return meets(&sum, q->requirement, q->goal);
}

/* factor[k] from the figures of the sources alone. */
static void least_work(const question *q, const double *figure, double *factor)
{
    double low = 0.0, high = 0.0;
    for (size_t k = 0; k < q->analysis->source_count; k++)
        high = figure[k] > high ? figure[k] : high;
    if (meets_under(q, figure, high))
        low = high;
    for (int i = 0; i < BISECTIONS && high - low > 1e-12 * high; i++) {
        const double middle = 0.5 * (low + high);
        if (meets_under(q, figure, middle))
            low = middle;
        else
            high = middle;
    }
    for (size_t k = 0; k < q->analysis->source_count; k++)
        factor[k] = under_ceiling(figure[k], low);
}

imk_status imk_drift_require(const imk_drift_analysis *analysis, size_t time,
                             imk_drift_requirement requirement, double goal,
                             imk_drift_allocation *allocation, imk_error *error)
{
    const question q = {analysis, time, requirement, goal};
    double figure[IMK_DRIFT_SOURCES_MAX];
    if (time >= analysis->time_count)
        return imk_error_set(error, IMK_ERROR_RANGE, "time", "", "an index of the analysis' times");
    if ((unsigned)requirement > (unsigned)IMK_REQUIRED_HEADING)
        return imk_error_set(error, IMK_ERROR_RANGE, "requirement", "",
                             "one of imk_drift_requirement");
    if (!(goal > 0.0 && goal < (double)INFINITY)) {
        const imk_status status =
            imk_error_set(error, IMK_ERROR_RANGE, "goal", "", "a positive number");
        if (error)
            error->value = goal;
        return status;
    }
    const double present = figure_of(&analysis->total[time], requirement);
    if (!(present < (double)INFINITY))
        return imk_error_set(error, IMK_ERROR_RANGE, "total", "", "finite moments");
    allocation->present = present;
    /* Every figure is of the first degree in the errors. */
    allocation->all = goal / present;
    for (size_t k = 0; k < analysis->source_count; k++)
        figure[k] = figure_of(source_of(&q, k), requirement);
    least_work(&q, figure, allocation->source);
    for (size_t k = 0; k < analysis->source_count; k++)
        allocation->alone[k] = alone(&q, k);
    return IMK_OK;
}
