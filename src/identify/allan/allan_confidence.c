/* SPDX-License-Identifier: Apache-2.0 */
/* How far to trust a deviation of the Allan family: noise type, degrees of freedom, interval. */
#include "imukit/distributions.h"

#include "allan_internal.h"

#include <math.h>

static bool in_range(imk_allan_statistic statistic, size_t n, size_t m)
{
    size_t lowest, highest, step;
    imk_allan_range(statistic, n, &lowest, &highest, &step);
    return (unsigned)statistic < IMK_ALLAN_STATISTICS && m >= lowest && m <= highest;
}

static double degrees_of_freedom(imk_allan_statistic statistic, imk_power_law type, bool continuous,
                                 size_t n, size_t m)
{
    if (!in_range(statistic, n, m))
        return (double)NAN;
    const imk_power_law lowest = imki_allan_lowest_type(statistic);
    type = type < lowest ? lowest : type;
    switch (statistic) {
    case IMK_ALLAN_TOTAL:
    case IMK_ALLAN_MODIFIED_TOTAL:
    case IMK_ALLAN_HADAMARD_TOTAL:
    case IMK_ALLAN_THEO1:
        return continuous ? imki_allan_edf_published(statistic, type, n, m)
                          : imki_allan_edf_total(statistic, type, n, m);
    default:
        return imki_allan_edf(statistic, type, continuous, n, m);
    }
}

double imk_allan_edf_exact(imk_allan_statistic statistic, imk_power_law type, size_t n, size_t m)
{
    return degrees_of_freedom(statistic, type, false, n, m);
}

void imk_allan_interval(double deviation, double edf, double confidence, double *lower,
                        double *upper)
{
    const double tail = (1 - confidence) / 2;
    *lower = deviation * sqrt(edf / imk_chi_square_quantile(1 - tail, edf));
    *upper = deviation * sqrt(edf / imk_chi_square_quantile(tail, edf));
}

/* Factors whose variances fit on the stack: enough for octaves to share one walk. */
enum { PORTION = 64 };

typedef struct point_work {
    imk_allan_statistic statistic;
    size_t n;
    const double *sums;
    imk_allan_point *points;
} point_work;

/* edf = 0 marks a type that could not be told. */
static void type_item(void *context, size_t item)
{
    const point_work *w = context;
    imk_allan_point *p = &w->points[item];
    p->edf = imk_allan_noise_type_for(w->statistic, w->n, w->sums, p->m, &p->type) == IMK_OK;
}

/* Variances of up to PORTION factors into the points' deviations. */
static imk_status portion(const imk_allan_settings *settings, size_t n, const double *sums,
                          size_t count, const size_t *factors, imk_allan_point *points,
                          const imk_executor *executor)
{
    double variances[PORTION];
    size_t counts[PORTION];
    const imk_status status =
        imk_allan_compute(settings->statistic, n, sums, count, factors, variances, counts, executor,
                          settings->workspace, settings->workspace_size);
    for (size_t i = 0; i < count && status == IMK_OK; i++) {
        if (!(variances[i] < HUGE_VAL))
            return IMK_ERROR_NOT_FINITE;
        points[i] =
            (imk_allan_point){.m = factors[i], .deviation = sqrt(variances[i]), .count = counts[i]};
    }
    return status;
}

/* Take the bias off; HTOT over single samples is not defined but by OHDEV [RILEY2008, 5.2.13]. */
static void unbias(const imk_allan_settings *settings, size_t n, const double *sums,
                   imk_allan_point *p)
{
    const imk_allan_statistic statistic = settings->statistic;
    if (settings->bias == IMK_ALLAN_BIAS_LEFT)
        return;
    if (statistic == IMK_ALLAN_HADAMARD_TOTAL && p->m == 1) {
        double variance;
        imk_allan_variances(IMK_ALLAN_HADAMARD, n, sums, 1, &p->m, &variance, &p->count, NULL);
        p->deviation = sqrt(variance);
    } else {
        p->deviation /= sqrt(settings->bias == IMK_ALLAN_BIAS_PUBLISHED
                                 ? imk_allan_bias_published(statistic, p->type, n, p->m)
                                 : imk_allan_bias(statistic, p->type, n, p->m));
    }
}

imk_status imk_allan_points(const imk_allan_settings *settings, size_t n, const double *sums,
                            size_t factor_count, const size_t *factors, imk_allan_point *points,
                            const imk_executor *executor)
{
    if (settings->cookie != imk_allan_default().cookie)
        return IMK_ERROR_UNINITIALISED;
    if (!(settings->confidence > 0 && settings->confidence < 1))
        return IMK_ERROR_RANGE;
    if ((unsigned)settings->bias > IMK_ALLAN_BIAS_LEFT)
        return IMK_ERROR_ARGUMENT;
    for (size_t i = 0; i < factor_count; i++)
        if (!in_range(settings->statistic, n, factors[i]))
            return n < 2 ? IMK_ERROR_TOO_SHORT : IMK_ERROR_RANGE;
    for (size_t i = 0; i < factor_count; i += PORTION) {
        const size_t count = factor_count - i < PORTION ? factor_count - i : PORTION;
        const imk_status status =
            portion(settings, n, sums, count, factors + i, points + i, executor);
        if (status != IMK_OK)
            return status;
    }
    point_work work = {settings->statistic, n, sums, points};
    imk_execute(executor, factor_count, type_item, &work);

    const imk_power_law *before = settings->before ? &settings->before->type : NULL;
    for (size_t i = 0; i < factor_count; i++) {
        imk_allan_point *p = &points[i];
        const imk_power_law type = imki_allan_type_at(p->edf > 0 ? n / p->m : 0, p->type, before);
        p->type = type;
        before = &p->type;
        p->edf = degrees_of_freedom(settings->statistic, type, settings->greenhall_riley, n, p->m);
        unbias(settings, n, sums, p);
        imk_allan_interval(p->deviation, p->edf, settings->confidence, &p->lower, &p->upper);
    }
    return IMK_OK;
}

imk_allan_settings imk_allan_default(void)
{
    return (imk_allan_settings){.cookie = 0xA11A0001u, .confidence = 0.95};
}
