/* SPDX-License-Identifier: Apache-2.0 */
/* What is wrong about the sigmas stated, of the readings of a sensor. Its residuals scatter by more
 * (or less) than these, and the variance of a reading may be
 *
 *     f^2 sigma^2              noise that is not white, the same share of it on each axis,
 *     f_axis^2 sigma^2         one axis that is worse than the others,
 *     sigma^2 + a^2            what befalls a pose: hands, a table that yields, alike on all axes,
 *     sigma^2 + a_axis^2       the same, unlike.
 *
 * Of these the one is taken that has the least
 *
 *     sum ln V + ln det N + sum residual^2/V + 2 (number of factors),
 *
 * the restricted likelihood [PATTERSON1971] and the price of a parameter [AKAIKE1978]. Axes that
 * have the same sigmas cannot tell the first from the third; it is the same to them, and the first
 * stays. */
#include "estimator_internal.h"

#include "imukit/elementary.h"

#include <math.h>
#include <string.h>

/* A factor that is chosen has so many degrees of freedom, one of an axis a little more. */
static const double least_freedom = 3.0, least_axis_freedom = 4.0, least_added_freedom = 1.0;
/* Errors of poses are looked for where the factor is above this. */
static const double least_excess = 0.9;
/* By how much another form must be better than one factor. */
static const double least_gain = 0.0;

typedef struct form {
    bool by_axis[2];
    double added[2];
    double factor[IMKI_PARTS];
} form;

static form form_of(const imki_estimator *e)
{
    form f;
    memcpy(f.by_axis, e->by_axis, sizeof f.by_axis);
    memcpy(f.added, e->added, sizeof f.added);
    memcpy(f.factor, e->factor, sizeof f.factor);
    return f;
}

static void take_form(imki_estimator *e, const form *f)
{
    memcpy(e->by_axis, f->by_axis, sizeof f->by_axis);
    memcpy(e->added, f->added, sizeof f->added);
    memcpy(e->factor, f->factor, sizeof f->factor);
}

/* -2 ln of the restricted likelihood, but for a constant, at the present solution. */
static double deviance(imki_estimator *e)
{
    double sum = 0.0;
    if (imki_estimator_covariance(e) != IMK_OK)
        return HUGE_VAL;
    for (size_t k = 0; k < imki_things(e); k++) {
        const int count = imki_rows_of(e, k);
        for (int i = 0; i < count; i++) /* whitened: the derivatives are over sqrt(V) */
            sum += imk_ln(imki_row_variance(e, &e->row[i]));
    }
    return sum + e->cost + imki_normal_log_determinant(&e->normal);
}

/* Root mean square of the sigmas stated of a sensor, where the added sigma starts. */
static double typical_sigma(const imki_estimator *e, int sensor)
{
    double square = 0.0, count = 0.0;
    for (size_t i = 0; i < e->observations; i++)
        for (int axis = 0; axis < IMK_AXES_MAX; axis++)
            if (!isnan(e->reading[i][sensor][axis]) && e->weight[i] >= 1.0) {
                square += e->sigma[i][sensor][axis] * e->sigma[i][sensor][axis];
                count += 1.0;
            }
    return sqrt(square / count);
}

/* Whether the residuals are enough for each factor. */
static bool is_rich(const imki_estimator *e, int sensor, const imki_fit *fit)
{
    const double least = e->added[sensor] > 0.0 ? least_added_freedom
                         : e->by_axis[sensor]   ? least_axis_freedom
                                                : least_freedom;
    for (int axis = 0; axis < IMK_AXES_MAX; axis++) {
        const int part = imki_part_of(e, sensor, axis);
        if (fit->scaled[part] != 0.0 && !(fit->freedom[part] >= least))
            return false;
    }
    return true;
}

/* Solve in another form. @return its deviance and price; HUGE_VAL: not possible */
static double try_form(imki_estimator *e, int sensor, bool by_axis, bool added, imki_fit *fit)
{
    const double factor = e->factor[imki_part_of(e, sensor, 0)];
    int factors = 0;
    e->by_axis[sensor] = by_axis;
    e->added[sensor] = added ? typical_sigma(e, sensor) : 0.0;
    for (int axis = 0; axis < IMK_AXES_MAX; axis++)
        e->factor[imki_part_of(e, sensor, axis)] = factor;
    if (imki_estimator_covariance(e) != IMK_OK)
        return HUGE_VAL;
    imki_fit_groups(e, fit);
    if (by_axis && !is_rich(e, sensor, fit))
        return HUGE_VAL;
    if (imki_variance_factors(e, 0.01, fit) != IMK_OK || !is_rich(e, sensor, fit))
        return HUGE_VAL;
    for (int axis = 0; axis < (by_axis ? IMK_AXES_MAX : 1); axis++)
        factors += fit->scaled[imki_part_of(e, sensor, axis)] != 0.0;
    return deviance(e) + 2.0 * factors + (added ? least_gain : 1.0);
}

static imk_status choose(imki_estimator *e, int sensor, imki_fit *fit)
{
    const form common = form_of(e);
    const double factor = e->factor[imki_part_of(e, sensor, 0)];
    form best = common;
    double least = deviance(e) + 2.0;
    for (int way = 1; way < 4; way++) {
        const bool by_axis = way & 1, added = way & 2;
        if (added && !(factor > least_excess))
            continue;
        take_form(e, &common);
        const double reached = try_form(e, sensor, by_axis, added, fit);
        if (reached < least) {
            least = reached;
            best = form_of(e);
        }
    }
    take_form(e, &best);
    return imki_variance_factors(e, 0.01, fit);
}

void imki_common_scatter(imki_estimator *e)
{
    memset(e->by_axis, 0, sizeof e->by_axis);
    memset(e->added, 0, sizeof e->added);
    for (int part = 0; part < IMKI_PARTS; part++)
        e->factor[part] = 1.0;
}

imk_status imki_choose_scatter(imki_estimator *e, imki_fit *fit)
{
    imk_status status = IMK_OK;
    for (int sensor = 0; status == IMK_OK && sensor < 2; sensor++) {
        const int group = sensor == IMK_GYRO ? IMK_GROUP_GYRO : IMK_GROUP_ACCEL;
        if (fit->estimated[group] && fit->freedom[group] >= least_freedom)
            status = choose(e, sensor, fit);
    }
    return status;
}
