/* SPDX-License-Identifier: Apache-2.0 */
/* Do stated intervals hold the truth as often as they say? Counts over simulated bench tests, per
 * parameter; used by the tests (some hundred benches) and by experiments/calibration_coverage.c
 * (thousands). */
#ifndef IMUKIT_TEST_COVERAGE_H
#define IMUKIT_TEST_COVERAGE_H

#include "imukit/calibration.h"

#include <math.h>
#include <stdio.h>

typedef struct coverage_count {
    size_t benches, failed; /* tests done; and refused or not solved */
    size_t parameter_count;
    imk_model_parameter parameter[IMK_CORRELATED_MAX];
    size_t held[IMK_CORRELATED_MAX];   /* interval holds the truth */
    double sum[IMK_CORRELATED_MAX];    /* of (estimate - truth)/sigma */
    double square[IMK_CORRELATED_MAX]; /* of its square */
} coverage_count;

/* Count one result; `truth` is the model the bench was simulated with, run constants included, in
 * the frame of the result. */
static inline void coverage_add(coverage_count *c, const imk_calibration_result *result,
                                const imk_model *truth, double confidence)
{
    c->parameter_count = result->parameter_count;
    c->benches++;
    for (size_t p = 0; p < result->parameter_count; p++) {
        const double error =
            result->value[p] - imk_model_parameter_get(truth, result->parameter[p]);
        c->parameter[p] = result->parameter[p];
        c->held[p] += fabs(error) <= imk_calibration_half_width(result, (int)p, confidence);
        c->sum[p] += error / result->sigma[p];
        c->square[p] += error * error / (result->sigma[p] * result->sigma[p]);
    }
}

/* Per parameter: share held, bias in sigmas, root mean square in sigmas. */
static inline double coverage_share(const coverage_count *c, size_t p)
{
    return (double)c->held[p] / (double)c->benches;
}
static inline double coverage_bias(const coverage_count *c, size_t p)
{
    return c->sum[p] / (double)c->benches;
}
static inline double coverage_rms(const coverage_count *c, size_t p)
{
    return sqrt(c->square[p] / (double)c->benches);
}

/* How many of n intervals must hold the truth, when each does with the probability `share`, for
 * fewer to have a probability below `false_alarm`: sums of the binomial distribution. */
static inline size_t coverage_least_held(size_t n, double share, double false_alarm)
{
    double below = 0.0;
    for (size_t k = 0; k <= n; k++) {
        below +=
            exp(lgamma((double)n + 1.0) - lgamma((double)k + 1.0) - lgamma((double)(n - k) + 1.0) +
                (double)k * log(share) + (double)(n - k) * log1p(-share));
        if (!(below < false_alarm))
            return k;
    }
    return n;
}

/* A line per parameter. */
static inline void coverage_print(const coverage_count *c, FILE *out)
{
    for (size_t p = 0; p < c->parameter_count; p++) {
        char name[IMK_MODEL_PARAMETER_NAME];
        if (imk_model_parameter_name(c->parameter[p], name) == IMK_OK)
            fprintf(out, "  %-40s held %6.2f %%   bias %+.3f sigma   rms %.3f sigma\n", name,
                    100.0 * coverage_share(c, p), coverage_bias(c, p), coverage_rms(c, p));
    }
}

#endif
