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
 * samples, few enough for the work to stay small; from the best of them Newton's steps of
 * reference_fit.c go on with every sample. Readings at the ends, which some shifts would compare
 * with nothing, are left out throughout, so that all shifts are assessed by the same readings. */
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

/* Merit and best correlation of the readings when the reference is `late` averages older. */
static void assess(const search *s, ptrdiff_t late, double *merit, double *correlation)
{
    const size_t count = s->points - 2 * s->shift;
    *merit = *correlation = 0.0;
    for (int sensor = 0; sensor < 2; sensor++) {
        const double *r[3];
        imki_linear_fit fit = {.count = count};
        if (!s->used[sensor])
            continue;
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
        for (int axis = 0; axis < s->record->axis_count[sensor]; axis++) {
            const double *y = s->reading[sensor][axis] + s->shift;
            imki_linear_fit own = fit;
            own.sum[3] = total(count, y);
            own.product[3] = inner(count, r[0], y);
            own.product[6] = inner(count, r[1], y);
            own.product[8] = inner(count, r[2], y);
            own.product[9] = inner(count, y, y);
            imki_linear_fit_solve(&own);
            *merit -= imk_ln(fmax(1.0 - own.share, 1e-12));
            *correlation = fmax(*correlation, sqrt(fmax(own.share, 0.0)));
        }
    }
}

/* The largest correlation at a peak that a valley separates from the best one. */
static void find_rival(const search *s, size_t best, imk_reference_shift *shift)
{
    const size_t count = 2 * s->shift + 1;
    shift->rival = 0.0;
    shift->rival_offset = (double)NAN;
    for (int direction = -1; direction <= 1; direction += 2) {
        double valley = s->correlation[best];
        for (size_t k = best; direction < 0 ? k > 0 : k + 1 < count;) {
            k = (size_t)((ptrdiff_t)k + direction);
            const double here = s->correlation[k];
            valley = fmin(valley, here);
            if (!(valley <= 0.9 * here) || !(here > shift->rival))
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
    double lag = ((double)best - (double)s.shift) * (double)s.part;
    const double limit = 4.0 * (double)s.part + 4.0;
    if (!imki_reference_lag(record, s.used[0] + 2 * s.used[1], limit, &lag, &found.sigma))
        return imki_refuse(error, IMK_ERROR_NO_CONVERGENCE, "max_shift", lag * record->dt,
                           max_shift,
                           "check that the readings follow the reference, or allow a larger shift");
    find_rival(&s, best, &found);
    find_axis(&s, lag, &found);
    found.offset = lag * record->dt;
    found.sigma *= record->dt;
    *shift = found;
    return IMK_OK;
}
