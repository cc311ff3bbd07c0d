/* SPDX-License-Identifier: Apache-2.0 */
/* How well a solution fits. With rows J, whitened by sigma and factor, and weights w, the residuals
 * of the item's rows have the variance
 *
 *     (I - w M)(I - w M + M),   M = J Cov J^T
 *
 * I - M for an item of full weight, I + M for one that is left out and only predicted [BAARDA1968].
 * Both are diagonal in the eigenvectors of M; directions in which the item alone determines its
 * unknowns, such as its attitude, have no variance and tell nothing.
 *
 * The variance of a row is factor^2 sigma^2 + (what is known besides, for gyros at rest the Earth's
 * horizontal rate); phi is the share of the first part. What the unknowns leave of a row is its
 * redundancy 1 - M_ii. The factor of a group follows from
 *
 *     factor^2 <- factor^2 [1 + sum of phi (residual^2 - (1 - M_ii))/r],
 *     r = sum of phi^2 (1 - M_ii),  its degrees of freedom,
 *
 * residuals over their sigma, iterated because the factors weigh the rows [FORSTNER1979]. With all
 * phi = 1 that is the sum of squares over the redundancy. Where what is known besides is a bound,
 * as of the Earth's rate at headings that may be alike in all holds, the parameters may take all of
 * it up: nothing of it is expected in the residuals then, and the factor is that of the rest. */
#include "estimator_internal.h"

#include "imukit/linear_algebra.h"

#include <math.h>
#include <string.h>

/* Of a factor^2 that slow noise is taken from; a factor of 0.9. */
static const double least_white = 0.8;

/* A direction that keeps less than this share of its variance tells nothing: the item alone
 * determines what it depends on. Where a placement is known before, little is left of a direction
 * that it explains, but exactly that tells a placement far beyond its sigma. */
static const double least_variance = 0.02, least_variance_placed = 1e-9;

/* Factors with fewer degrees of freedom stay 1: the sigmas are taken as stated. */
static const double least_freedom = 3.0;

/* Of some rows of one group. */
static double distance_of(const imki_estimator *e, const imki_row *row, int count, double w,
                          double least, int *degrees)
{
    double matrix[IMK_AXES_MAX * IMK_AXES_MAX], vector[IMK_AXES_MAX * IMK_AXES_MAX],
        value[IMK_AXES_MAX];
    double sum = 0.0;
    imki_rows_covariance(&e->normal, row, count, matrix, NULL);
    if (imk_symmetric_eigen((size_t)count, matrix, value, vector) != IMK_OK)
        return 0.0;
    for (int k = 0; k < count; k++) {
        const double left = 1.0 - w * value[k];
        const double variance = left * (left + value[k]);
        if (!(variance > least))
            continue;
        double residual = 0.0;
        for (int i = 0; i < count; i++)
            residual += vector[i * count + k] * row[i].residual;
        sum += residual * residual / variance;
        ++*degrees;
    }
    return sum;
}

void imki_item_distances(imki_estimator *e, size_t item, double square[IMKI_GROUPS],
                         int degrees[IMKI_GROUPS])
{
    const int count = imki_whitened_rows(e, item);
    const bool placed = item < e->observations &&
                        e->problem->observation[item].knowledge == IMK_INPUT_PLACED &&
                        e->local_first[item] >= 0;
    memset(square, 0, IMKI_GROUPS * sizeof *square);
    memset(degrees, 0, IMKI_GROUPS * sizeof *degrees);
    for (int first = 0, end; first < count; first = end) { /* rows of a group are neighbours */
        const int group = e->row[first].group;
        for (end = first; end < count && e->row[end].group == group;)
            end++;
        square[group] =
            distance_of(e, e->row + first, end - first, e->weight[item],
                        placed ? least_variance_placed : least_variance, &degrees[group]);
    }
}

imk_status imki_built_covariance(imki_estimator *e)
{
    const imk_status status = imki_normal_factor(&e->normal, 0.0);
    if (status == IMK_OK)
        imki_normal_invert(&e->normal);
    return status;
}

imk_status imki_estimator_covariance(imki_estimator *e)
{
    e->cost = imki_build(e, &e->now);
    return imki_built_covariance(e);
}

/* Rows of one item, or of one thing assumed, whitened. */
static void add_to_fit(imki_estimator *e, int count, imki_fit *fit)
{
    double matrix[IMKI_ROWS_MAX * IMKI_ROWS_MAX];
    imki_rows_covariance(&e->normal, e->row, count, matrix, NULL);
    for (int i = 0; i < count; i++) {
        const int part = e->row[i].part;
        const double square = e->row[i].residual * e->row[i].residual;
        const double left = 1.0 - matrix[i * count + i], share = e->row[i].share;
        const double variance = imki_row_variance(e, &e->row[i]), at_most = e->row[i].at_most;
        fit->count[part]++;
        fit->square[part] += square;
        fit->redundancy[part] += left;
        fit->shared_square[part] += share * square;
        fit->shared_redundancy[part] += share * left * (1.0 - at_most / variance);
        fit->freedom[part] += share * share * left;
        fit->stated[part] += left * imki_stated_variance(e, &e->row[i]) / variance;
        fit->excess[part] += variance * square - (e->row[i].known_variance - at_most) * left;
        fit->scaled[part] += e->row[i].sigma * e->row[i].sigma * left;
    }
}

int imki_rows_of(imki_estimator *e, size_t k)
{
    int count;
    if (k < e->items)
        return e->weight[k] < 1.0 ? 0 : imki_whitened_rows(e, k);
    k -= e->items;
    if (k < e->observations)
        count = e->weight[k] < 1.0 ? 0 : imki_placement_rows(e, &e->now, k, e->row);
    else
        count = imki_term_row(e, &e->now, k - e->observations, e->row);
    imki_whiten(e, count, e->row);
    return count;
}

int imki_group_parts(const imki_estimator *e, int group, int part[IMK_AXES_MAX])
{
    const bool moving = group >= IMKI_GROUP_MOVING;
    const int sensor = moving                    ? group - IMKI_GROUP_MOVING
                       : group == IMK_GROUP_GYRO ? IMK_GYRO
                                                 : IMK_ACCEL;
    if (!moving && (group == IMK_GROUP_TURN || !e->by_axis[sensor])) {
        part[0] = group;
        return 1;
    }
    for (int axis = 0; axis < IMK_AXES_MAX; axis++)
        part[axis] = moving ? imki_moving_part(sensor, axis) : imki_part_of(e, sensor, axis);
    return IMK_AXES_MAX;
}

imki_group_sum imki_sum_group(const imki_estimator *e, const imki_fit *fit, int group)
{
    imki_group_sum sum = {0.0, 0.0, 0.0, false};
    int part[IMK_AXES_MAX];
    const int parts = imki_group_parts(e, group, part);
    double stated = 0.0;
    for (int i = 0; i < parts; i++) {
        sum.square += fit->square[part[i]];
        sum.redundancy += fit->redundancy[part[i]];
        stated += fit->stated[part[i]];
        sum.estimated = sum.estimated || fit->estimated[part[i]];
    }
    sum.stated = sum.redundancy > 0.0 ? stated / sum.redundancy : 1.0;
    return sum;
}

void imki_fit_groups(imki_estimator *e, imki_fit *fit)
{
    memset(fit, 0, sizeof *fit);
    for (size_t k = 0; k < imki_things(e); k++) {
        const double square = fit->square[IMKI_PART_PLACEMENT],
                     redundancy = fit->redundancy[IMKI_PART_PLACEMENT];
        const bool placed = k >= e->items && k < e->items + e->observations;
        add_to_fit(e, imki_rows_of(e, k), fit);
        if (placed && e->problem->observation[k - e->items].turn_time > 0.0) {
            fit->turn_square += fit->square[IMKI_PART_PLACEMENT] - square;
            fit->turn_redundancy += fit->redundancy[IMKI_PART_PLACEMENT] - redundancy;
        }
    }
    imki_slow_noise_fit(e, fit);
}

/* The next factor of a group, squared. The first is by moments, from where the iteration, which
 * has little to go by while the share is small, does not go astray. */
static double next_square(const imki_estimator *e, const imki_fit *fit, int g, bool first)
{
    const double square = e->factor[g] * e->factor[g];
    if (first && fit->freedom[g] < 0.99 * fit->redundancy[g])
        return fmax(0.05, fit->excess[g] / fit->scaled[g]);
    const double excess = fit->shared_square[g] - fit->shared_redundancy[g];
    const double whole = square * fmax(0.01, 1.0 + excess / fit->freedom[g]);
    /* Slow noise explains what the residuals have beyond the sigmas stated, and little more: the
     * scatter of rounded samples makes sigmas a tenth too large at most. */
    return fmax(fmin(whole, least_white),
                square * fmax(0.01, 1.0 + (excess - fit->slow_square[g]) / fit->freedom[g]));
}

static bool is_of_gyro(int part)
{
    return part >= IMKI_PART_AXIS ? part < IMKI_PART_AXIS + IMK_AXES_MAX : part == IMK_GROUP_GYRO;
}

/* What is assumed may have reasons that repeats do not show, such as a cube that is not square or
 * coarse steps: it is never taken for better than stated. */
static bool is_assumed(const imki_estimator *e, int part)
{
    return part == IMKI_PART_PLACEMENT ||
           (e->problem->gyro_coarse && (is_of_gyro(part) || part == IMK_GROUP_TURN));
}

/* An added sigma that few axes show: its interval says how little that is. */
static double least_freedom_of(const imki_estimator *e, int part)
{
    const bool gyro = is_of_gyro(part);
    const bool accel = part >= IMKI_PART_AXIS ? !gyro : part == IMK_GROUP_ACCEL;
    return (gyro && e->added[IMK_GYRO] > 0.0) || (accel && e->added[IMK_ACCEL] > 0.0)
               ? 1.0
               : least_freedom;
}

/* `held`: parts that are not estimated. A group that loses its redundancy to the others while its
 * factor falls joins them: with the sigmas stated it would have it again, and so on without end. */
static imk_status find_factors(imki_estimator *e, double tolerance, bool held[IMKI_PARTS],
                               imki_fit *fit)
{
    /* Where the sigmas stated are thousand times too large something else is wrong. */
    const double least_factor = 1e-3;
    enum { ROUNDS = 40 }; /* a dozen on the way to no redundancy, as many after it is held */
    for (int round = 0; round < ROUNDS; round++) {
        bool converged, same = true;
        imk_status status = imki_iterate(e, 30, &converged);
        if (status == IMK_OK)
            status = imki_built_covariance(e);
        if (status != IMK_OK)
            return status;
        imki_fit_groups(e, fit);
        for (int g = 0; g < IMKI_PARTS; g++) {
            double factor = 1.0;
            if (round > 0 && e->factor[g] < 1.0 && fit->redundancy[g] < least_freedom_of(e, g))
                held[g] = true;
            if (!held[g] && fit->redundancy[g] >= least_freedom_of(e, g) && fit->freedom[g] > 0.0)
                factor = fmax(is_assumed(e, g) ? 1.0 : least_factor,
                              sqrt(next_square(e, fit, g, round == 0)));
            same = same && fabs(factor - e->factor[g]) <= tolerance * e->factor[g];
            e->factor[g] = factor;
        }
        if (same)
            break;
    }
    return IMK_OK;
}

imk_status imki_variance_factors(imki_estimator *e, double tolerance, imki_fit *fit)
{
    bool held[IMKI_PARTS] = {[IMK_GROUP_TURN] = e->turns_stated}, again = false;
    imk_status status = find_factors(e, tolerance, held, fit);
    for (int g = 0; g < IMKI_PARTS; g++) {
        held[g] = held[g] || !(fit->freedom[g] >= least_freedom_of(e, g));
        again = again || (held[g] && e->factor[g] != 1.0);
    }
    if (status == IMK_OK && again)
        status = find_factors(e, tolerance, held, fit);
    for (int g = 0; g < IMKI_PARTS; g++)
        fit->estimated[g] = !held[g] && !(is_assumed(e, g) && e->factor[g] <= 1.0);
    return status;
}
