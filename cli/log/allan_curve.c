/* SPDX-License-Identifier: Apache-2.0 */
/* Allan deviations in portions, so that long work can show its progress. */
#include "allan_curve.h"

#include "shell/progress.h"

#include "imukit/allan_gaps.h"

#include <stdlib.h>

/* Factors evaluated between two looks at the clock. */
enum { PORTION = 128 };

/* Clusters the noise type needs (imk_allan_noise_type); longer ones take the type of the last
 * factor that has them, which therefore leads every later portion. */
enum { CLUSTERS_MINIMUM = 30 };

static size_t last_typed_factor(size_t n, size_t factor_count, const size_t *factors)
{
    size_t last = factors[0];
    for (size_t i = 0; i < factor_count && n / factors[i] >= CLUSTERS_MINIMUM; i++)
        last = factors[i];
    return last;
}

static imk_status compute_portion(const imk_allan_settings *settings, size_t n, const double *sums,
                                  size_t anchor, size_t count, const size_t *factors,
                                  imk_allan_point *point, const imk_executor *executor)
{
    size_t m[PORTION + 1];
    imk_allan_point result[PORTION + 1];
    size_t lead = factors[0] > anchor ? 1 : 0;
    m[0] = anchor;
    for (size_t i = 0; i < count; i++)
        m[lead + i] = factors[i];
    imk_status status = imk_allan_points(settings, n, sums, lead + count, m, result, executor);
    for (size_t i = 0; status == IMK_OK && i < count; i++)
        point[i] = result[lead + i];
    return status;
}

static bool curve_room(size_t factor_count, bool gaps, allan_curve *curve)
{
    *curve = (allan_curve){.count = factor_count};
    curve->point = malloc(factor_count * sizeof *curve->point);
    curve->tau = malloc(4 * factor_count * sizeof *curve->tau);
    curve->used = gaps ? malloc(factor_count * sizeof *curve->used) : NULL;
    if (!curve->point || !curve->tau || (gaps && !curve->used)) {
        allan_curve_free(curve);
        return false;
    }
    curve->deviation = curve->tau + factor_count;
    curve->lower = curve->deviation + factor_count;
    curve->upper = curve->lower + factor_count;
    return true;
}

static void curve_columns(imk_allan_statistic statistic, double dt, allan_curve *curve)
{
    for (size_t i = 0; i < curve->count; i++) {
        imk_allan_point *p = &curve->point[i];
        if (statistic == IMK_ALLAN_TIME) { /* per sample so far */
            p->deviation *= dt;
            p->lower *= dt;
            p->upper *= dt;
        }
        curve->tau[i] = dt * imk_allan_averaging(statistic, p->m);
        curve->deviation[i] = p->deviation;
        curve->lower[i] = p->lower;
        curve->upper[i] = p->upper;
    }
}

imk_status allan_curve_compute(const imk_allan_settings *settings, size_t n, const double *sums,
                               double dt, size_t factor_count, const size_t *factors,
                               const char *label, const imk_executor *executor, allan_curve *curve)
{
    *curve = (allan_curve){.count = factor_count};
    if (factor_count == 0)
        return IMK_ERROR_TOO_SHORT;
    imk_allan_settings with = *settings;
    with.workspace_size = imk_allan_workspace_size(settings->statistic, n, factor_count, factors,
                                                   executor ? executor->threads : 1);
    with.workspace = with.workspace_size > 0 ? malloc(with.workspace_size) : NULL;
    if ((with.workspace_size > 0 && !with.workspace) || !curve_room(factor_count, false, curve)) {
        free(with.workspace);
        return IMK_ERROR_MEMORY;
    }
    size_t anchor = last_typed_factor(n, factor_count, factors);
    progress p = progress_begin(label ? label : "", "points", 1);
    imk_status status = IMK_OK;
    for (size_t done = 0; done < factor_count && status == IMK_OK; done += PORTION) {
        size_t count = factor_count - done < PORTION ? factor_count - done : PORTION;
        status = compute_portion(&with, n, sums, anchor, count, factors + done, curve->point + done,
                                 executor);
        if (label)
            progress_update(&p, done + count, factor_count);
    }
    progress_end(&p);
    free(with.workspace);
    if (status != IMK_OK)
        allan_curve_free(curve);
    else
        curve_columns(settings->statistic, dt, curve);
    return status;
}

imk_status allan_curve_with_gaps(const imk_allan_settings *settings, size_t n, const double *rate,
                                 double dt, size_t factor_count, const size_t *factors,
                                 const imk_executor *executor, allan_curve *curve)
{
    imk_allan_gaps_settings gaps = imk_allan_gaps_default();
    gaps.confidence = settings->confidence;
    const size_t size = imk_allan_gaps_workspace_size(n);
    void *workspace = malloc(size);
    imk_allan_gap_point *point = malloc((factor_count + 1) * sizeof *point);
    imk_status status = IMK_ERROR_MEMORY;
    *curve = (allan_curve){0};
    if (factor_count == 0)
        status = IMK_ERROR_TOO_SHORT;
    else if (workspace && point && curve_room(factor_count, true, curve))
        status = imk_allan_gaps_points(&gaps, n, rate, factor_count, factors, point, workspace,
                                       size, executor);
    for (size_t i = 0; i < factor_count && status == IMK_OK; i++) {
        curve->point[i] = point[i].point;
        curve->used[i] = point[i].used;
    }
    if (status != IMK_OK)
        allan_curve_free(curve);
    else
        curve_columns(IMK_ALLAN_OVERLAPPING, dt, curve);
    free(point);
    free(workspace);
    return status;
}

void allan_curve_free(allan_curve *curve)
{
    free(curve->point);
    free(curve->tau);
    free(curve->used);
    *curve = (allan_curve){0};
}

size_t *allan_factors_of(imk_allan_statistic statistic, imk_allan_grid grid, size_t n,
                         size_t *count)
{
    *count = imk_allan_factors_for(statistic, grid, n, NULL);
    size_t *factors = malloc((*count + 1) * sizeof *factors);
    if (factors)
        imk_allan_factors_for(statistic, grid, n, factors);
    return factors;
}

size_t *allan_factors_of_grid(imk_allan_grid grid, size_t n, size_t *count)
{
    return allan_factors_of(IMK_ALLAN_OVERLAPPING, grid, n, count);
}
