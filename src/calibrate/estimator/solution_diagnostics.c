/* SPDX-License-Identifier: Apache-2.0 */
/* What looks wrong about a solution, the gravest first. */
#include "calibration_internal.h"
#include "imukit/distributions.h"
#include "imukit/procedure.h"
#include "solution_scale_internal.h"

#include <math.h>

#define DEGREES_PER_RADIAN 57.29577951308232

/* A response this far from 1 is not an error of a sensor but a unit. */
static const double unit_factor = 3.0;
/* Misalignments beyond this are exchanged or reversed axes [rad]. */
static const double exchanged = 0.7;
/* Above this the noise alone tells two parameters apart. */
static const double strong_correlation = 0.98;
/* More refused than this, and it is not a few bad poses. */
static const double many_refused = 0.2;
/* Probability of a chi-square so large when the stated sigmas hold. */
static const double residual_probability = 1e-6;
/* ... and by how much the scatter must exceed them to matter. */
static const double residual_factor = 3.0;

/* Errors of poses that are alike on all axes count most on a quiet one. Where the sigmas differ by
 * so much, and residuals with fewer degrees of freedom leave them as stated, nothing tells of such
 * errors (experiments/coverage_six_position.c). */
static const double unlike_noise = 2.0, least_freedom = 3.0;

typedef struct list {
    imk_diagnostic_finding *diagnostic;
    size_t count, capacity;
} list;

static void add(list *l, imk_diagnostic kind, int sensor, int axis, int other, double value,
                double limit)
{
    if (l->count < l->capacity)
        l->diagnostic[l->count] =
            (imk_diagnostic_finding){kind, sensor, axis, other, value, limit, 0};
    l->count += l->count < l->capacity;
}

/* Largest elements of the estimated responses against the identity. */
static void look_at_responses(const imk_calibration_result *result, list *l)
{
    const imk_triad *triads[2] = {&result->model.gyro, &result->model.accel};
    for (size_t p = 0; p < result->parameter_count; p++) {
        const imk_model_parameter place = result->parameter[p];
        const double value = result->value[p];
        const int sensor = place.sensor, axis = place.axis;
        if (place.term == IMK_MODEL_SCALE_FACTOR) {
            const double factor = 1.0 + value;
            if (factor < 0.0 && sensor == IMK_GYRO)
                add(l, IMK_DIAGNOSTIC_LEFT_HANDED, sensor, axis, -1, factor, 0.0);
            else if (fabs(factor) > unit_factor || fabs(factor) < 1.0 / unit_factor)
                add(l, sensor == IMK_GYRO ? IMK_DIAGNOSTIC_RATE_UNIT : IMK_DIAGNOSTIC_GRAVITY_UNIT,
                    sensor, axis, -1, factor, unit_factor);
        }
        if (place.term == IMK_MODEL_MISALIGNMENT && triads[sensor]->axis_count == 3 &&
            fabs(value) > exchanged)
            add(l, IMK_DIAGNOSTIC_SWAPPED_AXES, sensor, axis, place.element, value, exchanged);
    }
}

/* Share of the items refused. */
static void look_at_refusals(const imk_calibration *calibration,
                             const imk_calibration_result *result, list *l)
{
    const size_t items = calibration->observation_count + calibration->turn_count;
    const size_t refused = result->observations_refused + result->turns_refused;
    const double share = items > 0 ? (double)refused / (double)items : 0.0;
    if (share > many_refused)
        add(l, IMK_DIAGNOSTIC_OUTLIERS, -1, -1, -1, share, many_refused);
}

/* Scatter far beyond the sigmas stated, by group. */
static void look_at_residuals(const imk_calibration_result *result, list *l)
{
    for (int g = 0; g < IMK_GROUPS; g++) {
        const imk_group_fit *group = &result->group[g];
        if (!(group->degrees_of_freedom >= 1.0))
            continue;
        const double ratio = group->chi_square / group->degrees_of_freedom;
        const int sensor = g == IMK_GROUP_ACCEL ? IMK_ACCEL : IMK_GYRO;
        if (ratio > residual_factor * residual_factor &&
            imk_gamma_upper(0.5 * group->degrees_of_freedom, 0.5 * group->chi_square) <
                residual_probability)
            add(l, IMK_DIAGNOSTIC_RESIDUALS, sensor, -1, g, ratio,
                residual_factor * residual_factor);
    }
}

/* Axes of unequal noise, of which no residuals tell more. */
static void look_at_axes(const imk_calibration_result *result, list *l)
{
    for (int sensor = 0; sensor < 2; sensor++) {
        const imk_group_fit *g =
            &result->group[sensor == IMK_GYRO ? IMK_GROUP_GYRO : IMK_GROUP_ACCEL];
        int quiet = -1, noisy = -1;
        for (int axis = 0; axis < IMK_AXES_MAX; axis++) {
            const double noise = g->axis_noise[axis];
            if (noise > 0.0 && (quiet < 0 || noise < g->axis_noise[quiet]))
                quiet = axis;
            if (noise > 0.0 && (noisy < 0 || noise > g->axis_noise[noisy]))
                noisy = axis;
        }
        if (g->degrees_of_freedom < least_freedom && quiet >= 0 &&
            g->axis_noise[noisy] > unlike_noise * g->axis_noise[quiet])
            add(l, IMK_DIAGNOSTIC_UNEQUAL_AXES, sensor, quiet, noisy,
                g->axis_noise[noisy] / g->axis_noise[quiet], unlike_noise);
    }
}

static void look_at_correlations(const imk_calibration_result *result, list *l)
{
    const int p = result->weakest_parameter[0], q = result->weakest_parameter[1];
    if (p < 0 || q < 0)
        return;
    const double r = result->covariance[(size_t)p * result->parameter_count + (size_t)q] /
                     (result->sigma[p] * result->sigma[q]);
    if (fabs(r) > strong_correlation)
        add(l, IMK_DIAGNOSTIC_CORRELATED, result->parameter[p].sensor, p, q, r, strong_correlation);
}

double imk_calibration_placement_probability(const imk_calibration_result *result)
{
    const imk_group_fit *all = &result->placement;
    const double freedom[2] = {all->degrees_of_freedom - result->turn_freedom,
                               result->turn_freedom};
    const double square[2] = {all->chi_square - result->turn_chi_square, result->turn_chi_square};
    double least = (double)NAN, tests = 0.0;
    for (int of = 0; of < 2; of++)
        if (freedom[of] >= 1.0) {
            least = fmin(least, imk_gamma_upper(0.5 * freedom[of], 0.5 * fmax(0.0, square[of])));
            tests += 1.0;
        }
    return tests > 0.0 ? fmin(1.0, tests * least) : least;
}

size_t imk_solution_diagnostics(const imk_calibration *calibration,
                                const imk_calibration_result *result, size_t capacity,
                                imk_diagnostic_finding *diagnostic)
{
    list l = {diagnostic, 0, capacity};
    look_at_responses(result, &l);
    l.count = imki_solution_scales(result, l.count, capacity, diagnostic);
    look_at_refusals(calibration, result, &l);
    look_at_residuals(result, &l);
    look_at_axes(result, &l);
    look_at_correlations(result, &l);
    return l.count;
}
