/* SPDX-License-Identifier: Apache-2.0 */
/* Allan deviations in portions, so that long work can show its progress. */
#include "allan_curve.h"

#include "progress.h"

#include <stdlib.h>

/* Factors evaluated between two looks at the clock. */
enum { PORTION = 128 };

/* Clusters the noise type needs (imk_allan_noise_type); longer ones take the type of the last
 * factor that has them, which therefore leads every later portion. */
enum { CLUSTERS_MINIMUM = 30 };

static size_t last_typed_factor(size_t n, size_t factor_count, const size_t *factors)
{
    size_t last = factors[0];
    for (size_t i = 0; i < factor_count && (n + 1) / factors[i] >= CLUSTERS_MINIMUM; i++)
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

imk_status allan_curve_compute(const imk_allan_settings *settings, size_t n, const double *sums,
                               double dt, size_t factor_count, const size_t *factors,
                               const char *label, const imk_executor *executor, allan_curve *curve)
{
    *curve = (allan_curve){.count = factor_count};
    if (factor_count == 0)
        return IMK_ERROR_TOO_SHORT;
    curve->point = malloc(factor_count * sizeof *curve->point);
    curve->tau = malloc(4 * factor_count * sizeof *curve->tau);
    if (!curve->point || !curve->tau) {
        allan_curve_free(curve);
        return IMK_ERROR_MEMORY;
    }
    curve->deviation = curve->tau + factor_count;
    curve->lower = curve->deviation + factor_count;
    curve->upper = curve->lower + factor_count;
    size_t anchor = last_typed_factor(n, factor_count, factors);
    progress p = progress_begin(label ? label : "", "points", 1);
    imk_status status = IMK_OK;
    for (size_t done = 0; done < factor_count && status == IMK_OK; done += PORTION) {
        size_t count = factor_count - done < PORTION ? factor_count - done : PORTION;
        status = compute_portion(settings, n, sums, anchor, count, factors + done,
                                 curve->point + done, executor);
        if (label)
            progress_update(&p, done + count, factor_count);
    }
    progress_end(&p);
    for (size_t i = 0; i < factor_count && status == IMK_OK; i++) {
        curve->tau[i] = dt * (double)curve->point[i].m;
        curve->deviation[i] = curve->point[i].deviation;
        curve->lower[i] = curve->point[i].lower;
        curve->upper[i] = curve->point[i].upper;
    }
    if (status != IMK_OK)
        allan_curve_free(curve);
    return status;
}

void allan_curve_free(allan_curve *curve)
{
    free(curve->point);
    free(curve->tau);
    *curve = (allan_curve){0};
}

size_t *allan_factors_of_grid(imk_allan_grid grid, size_t n, size_t *count)
{
    *count = imk_allan_factors(grid, n, NULL);
    size_t *factors = malloc((*count + 1) * sizeof *factors);
    if (factors)
        imk_allan_factors(grid, n, factors);
    return factors;
}
