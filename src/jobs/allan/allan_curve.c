/* SPDX-License-Identifier: Apache-2.0 */
/* Allan deviations in portions, so that long work can show its progress. */
#include "allan_curve_internal.h"

#include "jobs/arena_internal.h"
#include "jobs/job_internal.h"

#include "imukit/allan_gaps.h"

/* Factors evaluated between two looks at the clock. */
enum { PORTION = 128 };

static bool curve_room(size_t count, bool gaps, const imk_allocator *allocator,
                       imk_allan_curve *curve)
{
    *curve = (imk_allan_curve){.count = count};
    curve->point = imki_resize(allocator, NULL, count * sizeof *curve->point);
    curve->tau = imki_resize(allocator, NULL, (gaps ? 5 : 4) * count * sizeof *curve->tau);
    if (!curve->point || !curve->tau) {
        imk_allan_curve_free(curve, allocator);
        return false;
    }
    curve->deviation = curve->tau + count;
    curve->lower = curve->deviation + count;
    curve->upper = curve->lower + count;
    curve->used = gaps ? curve->upper + count : NULL;
    return true;
}

void imk_allan_curve_free(imk_allan_curve *curve, const imk_allocator *allocator)
{
    imki_resize(allocator, curve->point, 0);
    imki_resize(allocator, curve->tau, 0);
    *curve = (imk_allan_curve){0};
}

static void fill_columns(imk_allan_statistic statistic, double dt, imk_allan_curve *curve)
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

/* Portion by portion into curve->point. */
static imk_status compute_points(const imk_allan_settings *settings, size_t n, const double *sums,
                                 size_t factor_count, const size_t *factors, const char *stage,
                                 const imk_job *job, imk_allan_point *point)
{
    imk_allan_settings with = *settings;
    imk_status status = IMK_OK;
    for (size_t done = 0; done < factor_count && status == IMK_OK; done += PORTION) {
        const size_t count = factor_count - done < PORTION ? factor_count - done : PORTION;
        with.before = done > 0 ? &point[done - 1] : NULL;
        status =
            imk_allan_points(&with, n, sums, count, factors + done, point + done, job->executor);
        if (status == IMK_OK && stage)
            status = imki_job_progress(job, stage, "points", done + count, factor_count, NULL);
    }
    return status;
}

imk_status imki_allan_curve_compute(const imk_allan_settings *settings, size_t n,
                                    const double *sums, double dt, size_t factor_count,
                                    const size_t *factors, const char *stage, const imk_job *job,
                                    imk_allan_curve *curve)
{
    const size_t threads = job->executor ? job->executor->threads : 1;
    imk_allan_settings with = *settings;
    *curve = (imk_allan_curve){0};
    if (factor_count == 0)
        return IMK_ERROR_TOO_SHORT;
    with.workspace_size =
        imk_allan_workspace_size(settings->statistic, n, factor_count, factors, threads);
    with.workspace =
        with.workspace_size > 0 ? imki_resize(&job->allocator, NULL, with.workspace_size) : NULL;
    imk_status status = IMK_ERROR_MEMORY;
    if ((with.workspace_size == 0 || with.workspace) &&
        curve_room(factor_count, false, &job->allocator, curve))
        status = compute_points(&with, n, sums, factor_count, factors, stage, job, curve->point);
    imki_resize(&job->allocator, with.workspace, 0);
    if (status != IMK_OK)
        imk_allan_curve_free(curve, &job->allocator);
    else
        fill_columns(settings->statistic, dt, curve);
    return status;
}

imk_status imki_allan_curve_with_gaps(const imk_allan_settings *settings, size_t n,
                                      const double *rate, double dt, size_t factor_count,
                                      const size_t *factors, const imk_job *job,
                                      imk_allan_curve *curve)
{
    imk_allan_gaps_settings gaps = imk_allan_gaps_default();
    gaps.confidence = settings->confidence;
    const size_t size = imk_allan_gaps_workspace_size(n);
    imki_arena scratch = {.allocator = job->allocator};
    void *workspace = imki_arena_room(&scratch, size);
    imk_allan_gap_point *point = imki_arena_take(&scratch, (factor_count + 1) * sizeof *point);
    imk_status status = IMK_ERROR_MEMORY;
    *curve = (imk_allan_curve){0};
    if (factor_count == 0)
        status = IMK_ERROR_TOO_SHORT;
    else if (workspace && point && curve_room(factor_count, true, &job->allocator, curve))
        status = imk_allan_gaps_points(&gaps, n, rate, factor_count, factors, point, job->executor,
                                       workspace, size);
    for (size_t i = 0; i < factor_count && status == IMK_OK; i++) {
        curve->point[i] = point[i].point;
        curve->used[i] = point[i].used;
    }
    if (status != IMK_OK)
        imk_allan_curve_free(curve, &job->allocator);
    else
        fill_columns(IMK_ALLAN_OVERLAPPING, dt, curve);
    imki_arena_free(&scratch);
    return status;
}

imk_status imki_allan_curve_of(size_t count, const imk_allan_point *points, double dt,
                               const imk_allocator *allocator, imk_allan_curve *curve)
{
    if (!curve_room(count, false, allocator, curve))
        return IMK_ERROR_MEMORY;
    for (size_t i = 0; i < count; i++)
        curve->point[i] = points[i];
    fill_columns(IMK_ALLAN_OVERLAPPING, dt, curve);
    return IMK_OK;
}

size_t *imki_allan_factors(imk_allan_statistic statistic, imk_allan_grid grid, size_t n,
                           const imk_allocator *allocator, size_t *count)
{
    *count = imk_allan_factors_for(statistic, grid, n, NULL);
    size_t *factors = imki_resize(allocator, NULL, (*count + 1) * sizeof *factors);
    if (factors)
        imk_allan_factors_for(statistic, grid, n, factors);
    return factors;
}
