/* SPDX-License-Identifier: Apache-2.0 */
/* Variances of the Allan family from running sums of a rate record.
 *
 *     OAVAR(m) = 1/(2 m^2 M) sum_{j=0}^{M-1} (s[j+2m] - 2 s[j+m] + s[j])^2,   M = n - 2m + 1
 *     OHVAR(m) = 1/(6 m^2 M) sum_{j=0}^{M-1} (s[j+3m] - 3 s[j+2m] + 3 s[j+m] - s[j])^2,
 *                M = n - 3m + 1
 *
 * [RILEY2008, (11), (18)] with s the sums (phase/dt); the plain variances take every m-th term
 * only. The Haar wavelet variance at scale 2m is OAVAR/2 [PERCIVAL1994], TVAR is m^2/3 MVAR. The
 * others have files of their own.
 */
#include "allan_internal.h"
#include "base/workspace_internal.h"

#include <math.h>

enum { LANES = IMKI_ALLAN_LANES, BLOCK = IMKI_ALLAN_BLOCK };

/* Sum of squared second differences of `count` (<= BLOCK) consecutive terms. */
IMKI_INLINED double second_differences(const double *s, size_t m, size_t count)
{
    const double *a = s, *b = s + m, *c = s + 2 * m;
    double lane[LANES] = {0};
    size_t j = 0;
    for (; j + LANES <= count; j += LANES)
        for (size_t l = 0; l < LANES; l++) {
            const double middle = b[j + l], d = (c[j + l] - middle) - (middle - a[j + l]);
            lane[l] += d * d;
        }
    for (; j < count; j++) {
        const double middle = b[j], d = (c[j] - middle) - (middle - a[j]);
        lane[0] += d * d;
    }
    return imki_sum_lanes(lane);
}

IMKI_INLINED double third_differences(const double *s, size_t m, size_t count)
{
    const double *a = s, *b = s + m, *c = s + 2 * m, *e = s + 3 * m;
    double lane[LANES] = {0};
    size_t j = 0;
    for (; j + LANES <= count; j += LANES)
        for (size_t l = 0; l < LANES; l++) {
            const double d = (e[j + l] - a[j + l]) - 3 * (c[j + l] - b[j + l]);
            lane[l] += d * d;
        }
    for (; j < count; j++) {
        const double d = (e[j] - a[j]) - 3 * (c[j] - b[j]);
        lane[0] += d * d;
    }
    return imki_sum_lanes(lane);
}

IMKI_INLINED double differences(bool third, const double *s, size_t m, size_t count)
{
    return third ? third_differences(s, m, count) : second_differences(s, m, count);
}

IMKI_ALLAN_VERSIONS(differences, (bool third, const double *s, size_t m, size_t count), third, s, m,
                    count)

/* The plain variances are the overlapping ones at m = 1 of every m-th sum. */
static double plain_sum(bool third, imk_kernel kernel, const double *s, size_t m, size_t count)
{
    double total = 0, every[BLOCK + 3];
    const size_t beyond = third ? 3 : 2;
    for (size_t first = 0; first < count; first += BLOCK) {
        const size_t size = count - first < BLOCK ? count - first : BLOCK;
        for (size_t i = 0; i < size + beyond && m > 1; i++)
            every[i] = s[(first + i) * m];
        total += IMKI_ALLAN_CALL(kernel, differences, third, m > 1 ? every : s + first, 1, size);
    }
    return total;
}

/* Factors in a group share a walk through the record, a block at a time, so that it comes from
 * memory once for all of them. A short list (octaves) is dealt out to as many groups as there are
 * threads, large and small factors alike; a long one is cut into neighbours, whose windows overlap.
 */
enum { DEALT_MAX = 64, NEIGHBOURS = 8 };

typedef struct variance_work {
    imk_allan_statistic statistic;
    imk_kernel kernel;
    size_t n, factor_count, groups;
    const double *sums;
    const size_t *factors;
    double *variances;
    size_t *counts;
    double *scratch; /* of the first group */
    size_t scratch_doubles;
} variance_work;

/* The statistic whose terms are summed, and how many there are: TDEV and Haar are scaled. */
static size_t term_count(imk_allan_statistic statistic, size_t n, size_t m)
{
    switch (statistic) {
    case IMK_ALLAN_PLAIN:
        return n / m - 1;
    case IMK_ALLAN_HADAMARD_PLAIN:
        return n / m - 2;
    case IMK_ALLAN_HADAMARD:
        return n - 3 * m + 1;
    case IMK_ALLAN_MODIFIED:
    case IMK_ALLAN_TIME:
        return n - 3 * m + 2;
    case IMK_ALLAN_PARABOLIC:
        return m == 1 ? n - 1 : n - 2 * m + 2;
    default: /* TOTDEV beyond n/2: every term reaches beyond the record */
        return 2 * m > n ? 0 : n - 2 * m + 1;
    }
}

static void add_block(const variance_work *w, imki_allan_cursor *c, size_t first)
{
    const size_t left = c->count - first, size = left < BLOCK ? left : BLOCK;
    if (w->statistic == IMK_ALLAN_MODIFIED || w->statistic == IMK_ALLAN_TIME)
        imki_allan_modified_block(c, w->kernel, w->sums, first, size);
    else if (w->statistic == IMK_ALLAN_PARABOLIC && c->m > 1)
        imki_allan_parabolic_block(c, w->kernel, w->sums, first, size);
    else
        c->total += IMKI_ALLAN_CALL(w->kernel, differences, w->statistic == IMK_ALLAN_HADAMARD,
                                    w->sums + first, c->m, size);
}

/* Mean of the squares, scaled as the statistic is defined. */
static void store(const variance_work *w, size_t place, const imki_allan_cursor *c)
{
    const double m = (double)c->m;
    size_t count = c->count;
    double total = c->total, scale = 2 * m * m;
    switch (w->statistic) {
    case IMK_ALLAN_MODIFIED:
        scale *= m * m;
        break;
    case IMK_ALLAN_TIME:
        scale *= 3;
        break;
    case IMK_ALLAN_HADAMARD:
    case IMK_ALLAN_HADAMARD_PLAIN:
        scale *= 3;
        break;
    case IMK_ALLAN_PARABOLIC:
        scale = c->m == 1 ? 2 : m * m * m * m * m * m / 72;
        break;
    case IMK_ALLAN_HAAR:
        scale *= 2;
        break;
    case IMK_ALLAN_TOTAL:
        total += imki_allan_total_ends(w->n, w->sums, c->m);
        count = w->n - 1;
        break;
    default:
        break;
    }
    w->variances[place] = total / (scale * (double)count);
    if (w->counts)
        w->counts[place] = count;
}

static void difference_group(void *context, size_t item)
{
    const variance_work *w = context;
    const bool dealt = w->factor_count <= DEALT_MAX;
    const size_t first = dealt ? item : item * NEIGHBOURS, stride = dealt ? w->groups : 1;
    const size_t most = dealt ? DEALT_MAX : NEIGHBOURS;
    imki_allan_cursor cursor[DEALT_MAX];
    size_t size = 0, longest = 0;
    for (size_t i = first; i < w->factor_count && size < most; i += stride, size++) {
        const size_t m = w->factors[i];
        cursor[size] = (imki_allan_cursor){.m = m, .count = term_count(w->statistic, w->n, m)};
        longest = cursor[size].count > longest ? cursor[size].count : longest;
    }
    const bool third = w->statistic == IMK_ALLAN_HADAMARD_PLAIN;
    if (third || w->statistic == IMK_ALLAN_PLAIN)
        for (size_t i = 0; i < size; i++)
            cursor[i].total = plain_sum(third, w->kernel, w->sums, cursor[i].m, cursor[i].count);
    else
        for (size_t j = 0; j < longest; j += BLOCK)
            for (size_t i = 0; i < size; i++)
                if (j < cursor[i].count)
                    add_block(w, &cursor[i], j);
    for (size_t i = 0; i < size; i++)
        store(w, first + i * stride, &cursor[i]);
}

/* MTOT, HTOT and Theo1: one scratch a group. */
static void scratch_group(void *context, size_t item)
{
    const variance_work *w = context;
    for (size_t i = item; i < w->factor_count; i += w->groups) {
        const size_t m = w->factors[i];
        double *scratch = w->scratch + item * w->scratch_doubles;
        size_t count;
        w->variances[i] = w->statistic == IMK_ALLAN_THEO1
                              ? imki_allan_theo(w->n, w->sums, m, &count, w->kernel, scratch)
                              : imki_allan_windows(w->statistic == IMK_ALLAN_HADAMARD_TOTAL, w->n,
                                                   w->sums, m, &count, scratch);
        if (w->counts)
            w->counts[i] = count;
    }
}

static bool takes_scratch(imk_allan_statistic statistic)
{
    return statistic == IMK_ALLAN_MODIFIED_TOTAL || statistic == IMK_ALLAN_HADAMARD_TOTAL ||
           statistic == IMK_ALLAN_THEO1;
}

/* Doubles of one thread's scratch, a whole number of cache lines. */
static size_t scratch_doubles(imk_allan_statistic statistic, size_t n, size_t factor_count,
                              const size_t *factors)
{
    size_t most = 0;
    for (size_t i = 0; i < factor_count && takes_scratch(statistic); i++) {
        const size_t doubles = statistic == IMK_ALLAN_THEO1
                                   ? imki_allan_theo_doubles(n, factors[i])
                                   : imki_allan_windows_doubles(n, factors[i]);
        most = doubles > most ? doubles : most;
    }
    return (most + 7) / 8 * 8;
}

/* Factors for which the variance is defined: for TOTDEV and Theo1 more than are good for use. */
static imk_status check_factors(imk_allan_statistic statistic, size_t n, size_t factor_count,
                                const size_t *factors)
{
    size_t lowest, highest, step;
    if ((unsigned)statistic >= IMK_ALLAN_STATISTICS)
        return IMK_ERROR_ARGUMENT;
    imk_allan_range(statistic, n, &lowest, &highest, &step);
    if (statistic == IMK_ALLAN_TOTAL && n >= 2)
        highest = n;
    if (statistic == IMK_ALLAN_THEO1)
        lowest = step;
    for (size_t i = 0; i < factor_count; i++)
        if (factors[i] < lowest || factors[i] > highest || factors[i] % step != 0)
            return highest < lowest ? IMK_ERROR_TOO_SHORT : IMK_ERROR_RANGE;
    return IMK_OK;
}

static size_t threads_of(const imk_executor *executor)
{
    return executor && executor->threads > 0 ? executor->threads : 1;
}

size_t imk_allan_workspace_size(imk_allan_statistic statistic, size_t n, size_t factor_count,
                                const size_t *factors, size_t threads)
{
    if (check_factors(statistic, n, factor_count, factors) != IMK_OK)
        return 0;
    const size_t slices = threads < factor_count ? threads : factor_count;
    const size_t doubles = slices * scratch_doubles(statistic, n, factor_count, factors);
    return doubles > 0 ? doubles * sizeof(double) + IMKI_ALIGNMENT_SLACK : 0;
}

imk_status imk_allan_compute(imk_allan_statistic statistic, size_t n, const double *sums,
                             size_t factor_count, const size_t *factors, double *variances,
                             size_t *counts, const imk_executor *executor, void *workspace,
                             size_t workspace_size)
{
    const imk_status status = check_factors(statistic, n, factor_count, factors);
    if (status != IMK_OK || factor_count == 0)
        return status;
    const size_t threads = threads_of(executor);
    variance_work work = {.statistic = statistic,
                          .kernel = imk_random_seeded(0).kernel,
                          .n = n,
                          .factor_count = factor_count,
                          .groups = threads < factor_count ? threads : factor_count,
                          .sums = sums,
                          .factors = factors,
                          .variances = variances,
                          .counts = counts};
    if (takes_scratch(statistic)) {
        const size_t wanted =
            imk_allan_workspace_size(statistic, n, factor_count, factors, threads);
        if (wanted > 0 && (!workspace || workspace_size < wanted))
            return IMK_ERROR_WORKSPACE;
        work.scratch = wanted > 0 ? imki_align(workspace) : NULL;
        work.scratch_doubles = scratch_doubles(statistic, n, factor_count, factors);
        imk_execute(executor, work.groups, scratch_group, &work);
    } else {
        if (factor_count > DEALT_MAX)
            work.groups = (factor_count + NEIGHBOURS - 1) / NEIGHBOURS;
        imk_execute(executor, work.groups, difference_group, &work);
    }
    return IMK_OK;
}

imk_status imk_allan_variances(imk_allan_statistic statistic, size_t n, const double *sums,
                               size_t factor_count, const size_t *factors, double *variances,
                               size_t *counts, const imk_executor *executor)
{
    return imk_allan_compute(statistic, n, sums, factor_count, factors, variances, counts, executor,
                             NULL, 0);
}
