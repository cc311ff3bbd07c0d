/* SPDX-License-Identifier: Apache-2.0 */
/* Allan deviations of a record with missing samples: the record as running sums and counts of what
 * is there, and its holes by length; then one averaging factor after another
 * (allan_gaps_point.c). */
#include "allan_gaps_internal.h"
#include "allan_internal.h"
#include "base/workspace_internal.h"
#include "identify/records/screen_internal.h"
#include "imukit/elementary.h"

#include <math.h>

enum { COOKIE = 0x1A6A95, SCRATCH = 8192, BATCH = 512 };
_Static_assert(BATCH * sizeof(imki_gap_estimate) <= SCRATCH * sizeof(double), "in the scratch");

imk_allan_gaps_settings imk_allan_gaps_default(void)
{
    return (imk_allan_gaps_settings){.cookie = COOKIE, .confidence = 0.95};
}

size_t imk_allan_gaps_workspace_size(size_t n)
{
    return IMKI_ALIGNMENT_SLACK + (n + 1 + SCRATCH) * sizeof(double) + (n + 1) * sizeof(uint32_t) +
           n;
}

/* The record less its mean, in place of its samples; the sums carry their rounding error along, so
 * that a large constant (gravity on an accelerometer) costs no digits. */
static void take_sums(imki_gap_record *r)
{
    double *const values = r->sums;
    double shift = 0, mean = 0, sum = 0, error = 0, value = values[0];
    for (size_t i = r->n; i-- > 0;)
        shift = imki_is_there(values[i]) ? values[i] : shift;
    r->counts[0] = 0;
    for (size_t i = 0; i < r->n; i++) {
        const bool present = imki_is_there(values[i]);
        mean += present ? values[i] - shift : 0;
        r->counts[i + 1] = r->counts[i] + present;
    }
    r->present = r->counts[r->n];
    mean /= r->present > 0 ? (double)r->present : 1;
    r->sums[0] = 0;
    for (size_t i = 0; i < r->n; i++) {
        const double step = imki_is_there(value) ? (value - shift) - mean : 0;
        const double after = sum + step, part = after - sum;
        error += (sum - (after - part)) + (step - part);
        sum = after;
        value = i + 1 < r->n ? values[i + 1] : 0; /* before it is overwritten */
        r->sums[i + 1] = sum + error;
    }
}

static unsigned class_of(size_t length)
{
    unsigned c = 2;
    for (; length > 1 && c < IMKI_HOLE_CLASSES - 1; length /= 2)
        c++;
    return c;
}

/* Holes longer than chance makes them where samples are missing one by one: the longest run of n
 * trials with missing fraction p is about log(n)/log(1/p); ten times n for rarity. */
static void take_holes(imki_gap_record *r)
{
    const double missing = (double)(r->n - r->present) / (double)r->n;
    const double chance = missing > 0 ? imk_ln(10.0 * (double)r->n) / -imk_ln(missing) : 0;
    for (size_t i = 0; i < r->n;) {
        size_t end = i;
        while (end < r->n && r->counts[end + 1] == r->counts[end])
            end++;
        const size_t length = end - i;
        const unsigned c = (double)length > chance ? class_of(length) : 1;
        r->squares[c] += (double)length * (double)length;
        r->long_holes = r->long_holes || (c > 1 && length > 0);
        for (; i < end; i++)
            r->holes[i] = (unsigned char)c;
        if (i < r->n)
            r->holes[i++] = 0;
    }
    r->squares[1] = 0;
}

typedef struct gap_work {
    const imki_gap_record *record;
    bool robust;
    const size_t *factors;
    imki_gap_estimate *estimates;
} gap_work;

static void gap_item(void *context, size_t item)
{
    const gap_work *w = context;
    w->estimates[item] = imki_gap_estimate_at(w->record, w->robust, w->factors[item]);
}

/* Without a missing sample: the ordinary deviations, to the last bit, a batch at a time. */
static imk_status complete_record(const imk_allan_gaps_settings *settings, size_t n,
                                  const double *rate, double *sums, size_t factor_count,
                                  const size_t *factors, imk_allan_gap_point *points,
                                  const imk_executor *executor)
{
    enum { TOGETHER = 64 };
    imk_allan_point point[TOGETHER];
    imk_allan_settings ordinary = imk_allan_default();
    ordinary.confidence = settings->confidence;
    imk_allan_sums(n, rate, sums, executor);
    for (size_t i = 0, size; i < factor_count; i += size) {
        size = factor_count - i < TOGETHER ? factor_count - i : TOGETHER;
        ordinary.before = i > 0 ? &points[i - 1].point : NULL;
        const imk_status status =
            imk_allan_points(&ordinary, n, sums, size, factors + i, point, executor);
        if (status != IMK_OK)
            return status;
        for (size_t k = 0; k < size; k++)
            points[i + k] = (imk_allan_gap_point){
                .point = point[k], .used = 1, .fullness = 1, .resolved = true};
    }
    return IMK_OK;
}

/* An estimate becomes a deviation with its interval. `before`: the type of the factor before. */
static imk_allan_gap_point finish(const imk_allan_gaps_settings *settings, size_t n,
                                  const imki_gap_estimate *e, const imk_power_law *before)
{
    const double clusters = e->used * (double)n / (double)e->m;
    const size_t telling =
        clusters > IMKI_ALLAN_CLUSTERS_MIN ? (size_t)clusters : IMKI_ALLAN_CLUSTERS_MIN;
    const bool told = e->told && e->share > 0;
    const imk_power_law type = imki_allan_type_at(told ? telling : 0, e->type, before);
    imk_allan_gap_point p = {.point = {.m = e->m, .count = e->count, .type = type},
                             .used = e->used,
                             .fullness = e->fullness,
                             .correction = e->correction};
    imk_allan_point *q = &p.point;
    if (e->count == 0) {
        q->deviation = q->lower = q->upper = q->edf = (double)NAN;
        return p;
    }
    const double of_all = e->share * imk_allan_edf_exact(IMK_ALLAN_OVERLAPPING, type, n, e->m);
    const double diagnostic =
        e->correction_error * e->correction_error / (e->variance * e->variance);
    const double edf = 2 / (2 / fmax(of_all, 1) + diagnostic);
    const double error = e->variance * sqrt(2 / edf), rest = e->variance - e->correction;
    double lower, upper;
    p.resolved = e->correction == 0 || rest >= error / 2;
    q->deviation = sqrt(p.resolved ? rest : error / 2);
    imk_allan_interval(1, edf, settings->confidence, &lower, &upper);
    const double low = lower * lower * e->variance - e->correction;
    const double high = upper * upper * e->variance - e->correction;
    q->lower = p.resolved && low > 0 ? sqrt(low) : 0;
    q->upper = high > q->deviation * q->deviation ? sqrt(high) : q->deviation;
    const double kept = q->deviation * q->deviation / e->variance;
    q->edf = p.resolved ? edf * kept * kept : 1;
    return p;
}

/* Samples far from the level around them count as missing. */
static void leave_out_outliers(size_t n, double *samples, double *scratch)
{
    const double resolution = imki_record_resolution(n, samples, scratch, SCRATCH);
    const imki_outlier_rule rule =
        imki_outlier_rule_find(n, samples, 1e-3, resolution, SCRATCH / 2, scratch);
    double largest;
    imki_outliers_find(n, samples, &rule, samples, &largest);
}

imk_status imk_allan_gaps_points(const imk_allan_gaps_settings *settings, size_t n,
                                 const double *rate, size_t factor_count, const size_t *factors,
                                 imk_allan_gap_point *points, const imk_executor *executor,
                                 void *workspace, size_t workspace_size)
{
    if (settings->cookie != COOKIE)
        return IMK_ERROR_UNINITIALISED;
    if (!(settings->confidence > 0 && settings->confidence < 1) || n > UINT32_MAX)
        return IMK_ERROR_RANGE;
    for (size_t i = 0; i < factor_count; i++)
        if (factors[i] < 1 || factors[i] > n / 2)
            return n < 2 ? IMK_ERROR_TOO_SHORT : IMK_ERROR_RANGE;
    if (workspace_size < imk_allan_gaps_workspace_size(n))
        return IMK_ERROR_WORKSPACE;
    double *scratch = imki_align(workspace);
    imki_gap_record record = {.n = n, .sums = scratch + SCRATCH};
    record.counts = (uint32_t *)(record.sums + n + 1);
    record.holes = (unsigned char *)(record.counts + n + 1);
    size_t present = 0;
    for (size_t i = 0; i < n; i++) {
        record.sums[i] = rate[i];
        present += imki_is_there(rate[i]);
    }
    if (present < 2)
        return IMK_ERROR_TOO_SHORT;
    if (settings->robust)
        leave_out_outliers(n, record.sums, scratch);
    else if (present == n)
        return complete_record(settings, n, rate, record.sums, factor_count, factors, points,
                               executor);
    take_sums(&record);
    take_holes(&record);
    if (record.long_holes)
        imki_gap_take_lags(&record);
    imki_gap_estimate *estimates = (void *)scratch;
    const imk_power_law *before = NULL;
    for (size_t first = 0; first < factor_count; first += BATCH) {
        const size_t count = factor_count - first < BATCH ? factor_count - first : BATCH;
        gap_work work = {&record, settings->robust, factors + first, estimates};
        imk_execute(executor, count, gap_item, &work);
        for (size_t i = 0; i < count; i++) {
            if (estimates[i].count > 0 && !(estimates[i].variance < HUGE_VAL))
                return IMK_ERROR_NOT_FINITE;
            points[first + i] = finish(settings, n, &estimates[i], before);
            before = &points[first + i].point.type;
        }
    }
    return IMK_OK;
}
