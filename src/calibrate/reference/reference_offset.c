/* SPDX-License-Identifier: Apache-2.0 */
/* By how much a log and its reference differ in time.
 *
 * For every shift of the reference, each axis of the readings is fitted by a constant and the three
 * components of the reference. With R^2 the share of the axis' variance that the fit explains, the
 * likelihood of a shift, noises not being known, is
 *
 *     log L = -n/2 sum over the axes of ln(1 - R^2)
 *
 * which weighs the axes by how well they follow at all. The shifts are those of averages over some
 * samples, few enough for the work to stay small; from the chosen one Newton's steps of
 * reference_fit.c go on with every sample. Readings at the ends, which some shifts would compare
 * with nothing, are left out throughout, so that all shifts are assessed by the same readings.
 *
 * A motion that repeats has several shifts that fit alike: a head that turns on by equal angles has
 * one each step, because the fit takes up the angle. Noise alone then says which of them is best.
 * So of all shifts that are not significantly worse than the best, those nearest to zero are taken.
 * For a axes and n independent residuals, a shift is worse if 2 log L is less by more than
 *
 *     28 + 6 a
 *
 * which is, within 2, chi-square of 3 a degrees of freedom, those in which two fits of an axis may
 * differ, at a chance of 5e-7 (a = 1, 3, 6, 8: 32, 46, 62, 71), or 1e-3 for 2000 shifts. Residuals
 * are correlated where a sensor has slow noise or errors that the fit does not have; n is the
 * number of averages divided by the largest factor by which the variance of their means over 2, 4,
 * 8 … exceeds that of independent ones. */
#include "reference_internal.h"

#include "base/refuse_internal.h"
#include "base/workspace_internal.h"
#include "imukit/elementary.h"

#include <math.h>

enum { POINTS_MAX = 65536, SIDE = 3 + IMK_AXES_MAX };
static const double work_max = 1e8; /* products in the search: about a tenth of a second */

typedef struct search {
    const imk_test_record *record;
    bool used[2];
    size_t part, points, shift; /* samples of an average, averages, largest shift of these */
    double *reference[2][3], *reading[2][IMK_AXES_MAX];
    double *merit, *correlation; /* of 2 shift + 1 */
} search;

/* Shifts that are taken together. */
typedef struct region {
    size_t begin, end, best;
} region;

static size_t part_of(const imk_test_record *record, double max_shift)
{
    size_t part = 1;
    for (;; part++) {
        const double points = (double)(record->count / part);
        const double shifts = 2.0 * max_shift / record->dt / (double)part + 1.0;
        if (points <= POINTS_MAX && 18.0 * points * shifts <= work_max)
            return part;
    }
}

size_t imk_reference_offset_workspace_size(const imk_test_record *record, double max_shift)
{
    if (!(record->dt > 0.0) || !(max_shift >= 0.0 && max_shift < 1e9 * record->dt))
        return 0;
    const size_t part = part_of(record, max_shift);
    const size_t shifts = 2 * ((size_t)(max_shift / record->dt / (double)part) + 1) + 1;
    return IMKI_ALIGNMENT_SLACK + (2 * SIDE * (record->count / part) + 2 * shifts) * sizeof(double);
}

/* ---- averages --------------------------------------------------------------------------------
 */

/* Averages of parts of a channel about its mean; a missing value is the mean. @return false when
 * they never change */
static bool average(const search *s, const double *channel, double *out)
{
    double sum = 0.0, first = 0.0, low = HUGE_VAL, high = -HUGE_VAL;
    size_t n = 0;
    for (size_t k = 0; k < s->record->count; k++)
        if (fabs(channel[k]) < HUGE_VAL) {
            first = n++ == 0 ? channel[k] : first;
            sum += channel[k] - first;
        }
    const double mean = n > 0 ? first + sum / (double)n : 0.0;
    for (size_t m = 0; m < s->points; m++) {
        double part = 0.0;
        for (size_t k = m * s->part; k < (m + 1) * s->part; k++)
            part += fabs(channel[k]) < HUGE_VAL ? channel[k] - mean : 0.0;
        out[m] = part / (double)s->part;
        low = fmin(low, out[m]);
        high = fmax(high, out[m]);
    }
    return high > low;
}

/* Lay the averages out in the workspace. @return IMK_OK, or why there is nothing to compare */
static imk_status prepare(search *s, double *memory, imk_error *error)
{
    bool has_reference = false, varies = false;
    for (int sensor = 0; sensor < 2; sensor++) {
        const double *const *channel = imki_reference_channels(s->record, sensor);
        bool reference = false, reading = false;
        for (int j = 0; j < 3; j++, memory += s->points) {
            s->reference[sensor][j] = memory;
            if (channel && s->record->axis_count[sensor] > 0)
                reference = average(s, channel[j], memory) || reference;
        }
        for (int axis = 0; axis < s->record->axis_count[sensor]; axis++, memory += s->points) {
            s->reading[sensor][axis] = memory;
            reading = average(s, s->record->reading[sensor][axis], memory) || reading;
        }
        has_reference = has_reference || (channel && s->record->axis_count[sensor] > 0);
        s->used[sensor] = channel && reference && reading;
        varies = varies || s->used[sensor];
    }
    s->merit = memory;
    s->correlation = memory + 2 * s->shift + 1;
    if (!has_reference)
        return imk_error_set(error, IMK_ERROR_KEY_MISSING, "reference", NULL,
                             "a reference of rates or forces for the sensors in the log");
    if (!varies)
        return imk_error_set(error, IMK_ERROR_CONSTANT, "reference", NULL,
                             "a motion that both the log and the reference show");
    return IMK_OK;
}

/* ---- search ----------------------------------------------------------------------------------
 */

/* Inner product, in four sums, which compilers keep in one register. */
static double inner(size_t count, const double *a, const double *b)
{
    double sum[4] = {0.0};
    size_t k = 0;
    for (; k + 4 <= count; k += 4)
        for (int j = 0; j < 4; j++)
            sum[j] += a[k + j] * b[k + j];
    for (; k < count; k++)
        sum[0] += a[k] * b[k];
    return (sum[0] + sum[1]) + (sum[2] + sum[3]);
}

static double total(size_t count, const double *a)
{
    double sum = 0.0;
    for (size_t k = 0; k < count; k++)
        sum += a[k];
    return sum;
}

/* Sums of the products of a sensor's reference, `late` averages older. */
static imki_linear_fit reference_sums(const search *s, int sensor, ptrdiff_t late,
                                      const double *r[3])
{
    const size_t count = s->points - 2 * s->shift;
    imki_linear_fit fit = {.count = count};
    for (int j = 0; j < 3; j++) {
        r[j] = s->reference[sensor][j] + ((ptrdiff_t)s->shift - late);
        fit.sum[j] = total(count, r[j]);
    }
    fit.product[0] = inner(count, r[0], r[0]);
    fit.product[1] = inner(count, r[0], r[1]);
    fit.product[2] = inner(count, r[0], r[2]);
    fit.product[4] = inner(count, r[1], r[1]);
    fit.product[5] = inner(count, r[1], r[2]);
    fit.product[7] = inner(count, r[2], r[2]);
    return fit;
}

/* The fit of readings y by a reference of these sums. */
static imki_linear_fit fit_axis(const imki_linear_fit *sums, const double *const r[3],
                                const double *y)
{
    imki_linear_fit own = *sums;
    own.sum[3] = total(own.count, y);
    own.product[3] = inner(own.count, r[0], y);
    own.product[6] = inner(own.count, r[1], y);
    own.product[8] = inner(own.count, r[2], y);
    own.product[9] = inner(own.count, y, y);
    imki_linear_fit_solve(&own);
    return own;
}

/* Merit and best correlation of the readings when the reference is `late` averages older. */
static void assess(const search *s, ptrdiff_t late, double *merit, double *correlation)
{
    *merit = *correlation = 0.0;
    for (int sensor = 0; sensor < 2; sensor++) {
        const double *r[3];
        if (!s->used[sensor])
            continue;
        const imki_linear_fit sums = reference_sums(s, sensor, late, r);
        for (int axis = 0; axis < s->record->axis_count[sensor]; axis++) {
            const imki_linear_fit fit = fit_axis(&sums, r, s->reading[sensor][axis] + s->shift);
            *merit -= imk_ln(fmax(1.0 - fit.share, 1e-12));
            *correlation = fmax(*correlation, sqrt(fmax(fit.share, 0.0)));
        }
    }
}

/* ---- choice ----------------------------------------------------------------------------------
 */

/* Variance of the means over `length` residuals, times the length. */
static double scaled_variance(const imki_linear_fit *fit, const double *const r[3], const double *y,
                              size_t length)
{
    const size_t blocks = fit->count / length;
    double sum = 0.0, square = 0.0;
    for (size_t block = 0; block < blocks; block++) {
        double e = 0.0;
        for (size_t k = block * length; k < (block + 1) * length; k++)
            e += y[k] - fit->intercept - fit->slope[0] * r[0][k] - fit->slope[1] * r[1][k] -
                 fit->slope[2] * r[2][k];
        sum += e;
        square += e * e;
    }
    const double n = (double)blocks;
    return (square - sum * sum / n) / ((n - 1.0) * (double)length);
}

/* As many independent residuals tell as much as those of this shift. */
static double independent_residuals(const search *s, ptrdiff_t late)
{
    enum { BLOCKS_MIN = 16 };
    double factor = 1.0;
    for (int sensor = 0; sensor < 2; sensor++) {
        const double *r[3];
        if (!s->used[sensor])
            continue;
        const imki_linear_fit sums = reference_sums(s, sensor, late, r);
        for (int axis = 0; axis < s->record->axis_count[sensor]; axis++) {
            const double *y = s->reading[sensor][axis] + s->shift;
            const imki_linear_fit fit = fit_axis(&sums, r, y);
            const double one = scaled_variance(&fit, r, y, 1);
            for (size_t length = 2; one > 0.0 && length * BLOCKS_MIN <= fit.count; length *= 2)
                factor = fmax(factor, scaled_variance(&fit, r, y, length) / one);
        }
    }
    return (double)(s->points - 2 * s->shift) / factor;
}

/* The merit from which on a shift is not worse than the best one. That may lie between two shifts
 * of the search: half a step from it the variance that is left has grown by half of what it grows
 * by in a step, at most. */
static double merit_of_equals(const search *s, size_t best)
{
    double axes = 0.0, neighbour = s->merit[best];
    for (int sensor = 0; sensor < 2; sensor++)
        axes += s->used[sensor] ? (double)s->record->axis_count[sensor] : 0.0;
    if (best > 0)
        neighbour = fmin(neighbour, s->merit[best - 1]);
    if (best < 2 * s->shift)
        neighbour = fmin(neighbour, s->merit[best + 1]);
    const double growth = imk_exp((s->merit[best] - neighbour) / axes);
    const double n = independent_residuals(s, (ptrdiff_t)best - (ptrdiff_t)s->shift);
    return s->merit[best] - axes * imk_ln(0.5 * (1.0 + growth)) - (28.0 + 6.0 * axes) / n;
}

static size_t distance(const search *s, size_t k)
{
    return k < s->shift ? s->shift - k : k - s->shift;
}

/* The shifts next to zero of those with this merit, as far as they are one behind the other. */
static region nearest_region(const search *s, double merit)
{
    const size_t count = 2 * s->shift + 1;
    size_t nearest = count;
    for (size_t k = 0; k < count; k++)
        if (s->merit[k] >= merit && (nearest == count || distance(s, k) < distance(s, nearest)))
            nearest = k;
    region found = {nearest, nearest + 1, nearest};
    while (found.begin > 0 && s->merit[found.begin - 1] >= merit)
        found.begin--;
    while (found.end < count && s->merit[found.end] >= merit)
        found.end++;
    for (size_t k = found.begin; k < found.end; k++)
        found.best = s->merit[k] > s->merit[found.best] ? k : found.best;
    return found;
}

/* The largest correlation at another peak: of shifts that fit as well, or behind a valley. */
static void find_rival(const search *s, const region *chosen, double merit,
                       imk_reference_shift *shift)
{
    const size_t count = 2 * s->shift + 1;
    shift->rival = 0.0;
    shift->rival_offset = (double)NAN;
    for (int direction = -1; direction <= 1; direction += 2) {
        double valley = s->correlation[chosen->best];
        for (size_t k = chosen->best; direction < 0 ? k > 0 : k + 1 < count;) {
            k = (size_t)((ptrdiff_t)k + direction);
            const double here = s->correlation[k];
            const bool equal = s->merit[k] >= merit && (k < chosen->begin || k >= chosen->end);
            valley = fmin(valley, here);
            if (!(equal || valley <= 0.9 * here) || !(here > shift->rival))
                continue;
            shift->rival = here;
            shift->rival_offset = ((double)k - (double)s->shift) * (double)s->part * s->record->dt;
        }
    }
}

/* The axis that follows best once the shift is known. */
static void find_axis(const search *s, double lag, imk_reference_shift *shift)
{
    shift->correlation = -1.0;
    for (int sensor = 0; sensor < 2; sensor++)
        for (int axis = 0; s->used[sensor] && axis < s->record->axis_count[sensor]; axis++) {
            const imki_linear_fit fit =
                imki_reference_fit(s->record, sensor, axis, lag, 0, s->record->count, 1);
            const double correlation = sqrt(fmax(fit.share, 0.0));
            if (correlation > shift->correlation) {
                shift->correlation = correlation;
                shift->sensor = sensor;
                shift->axis = axis;
            }
        }
}

static imk_status check(const imk_test_record *record, double max_shift, size_t workspace_size,
                        imk_error *error)
{
    const double length = (double)record->count * record->dt;
    if (!(record->dt > 0.0) || !(max_shift > 0.0 && max_shift < HUGE_VAL))
        return imki_refuse(error, IMK_ERROR_RANGE, "max_shift", max_shift, 0.0, "a time above 0");
    if (!(length >= 3.0 * max_shift) || record->count < 16)
        return imki_refuse(
            error, IMK_ERROR_TOO_SHORT, "record", length, 3.0 * max_shift,
            "a log at least three times as long as the largest shift, or a smaller shift");
    if (workspace_size < imk_reference_offset_workspace_size(record, max_shift))
        return imki_refuse(error, IMK_ERROR_WORKSPACE, "workspace", (double)workspace_size, 0.0,
                           "imk_reference_offset_workspace_size() bytes");
    return IMK_OK;
}

imk_status imk_reference_offset(const imk_test_record *record, double max_shift,
                                imk_reference_shift *shift, void *workspace, size_t workspace_size,
                                imk_error *error)
{
    search s = {.record = record};
    imk_status status = check(record, max_shift, workspace_size, error);
    if (status != IMK_OK)
        return status;
    s.part = part_of(record, max_shift);
    s.points = record->count / s.part;
    s.shift = (size_t)(max_shift / record->dt / (double)s.part) + 1;
    status = prepare(&s, imki_align(workspace), error);
    if (status != IMK_OK)
        return status;
    size_t best = 0;
    for (size_t k = 0; k <= 2 * s.shift; k++) {
        assess(&s, (ptrdiff_t)k - (ptrdiff_t)s.shift, &s.merit[k], &s.correlation[k]);
        best = s.merit[k] > s.merit[best] ? k : best;
    }
    imk_reference_shift found;
    const double merit = merit_of_equals(&s, best);
    const region chosen = nearest_region(&s, merit);
    double lag = ((double)chosen.best - (double)s.shift) * (double)s.part;
    const double limit = 4.0 * (double)s.part + 4.0;
    if (!imki_reference_lag(record, s.used[0] + 2 * s.used[1], limit, &lag, &found.sigma))
        return imki_refuse(error, IMK_ERROR_NO_CONVERGENCE, "max_shift", lag * record->dt,
                           max_shift,
                           "check that the readings follow the reference, or allow a larger shift");
    find_rival(&s, &chosen, merit, &found);
    find_axis(&s, lag, &found);
    found.offset = lag * record->dt;
    found.sigma *= record->dt;
    *shift = found;
    return IMK_OK;
}
