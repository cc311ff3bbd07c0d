/* SPDX-License-Identifier: Apache-2.0 */
/* Do stated intervals hold the truth as often as they say? Counts over simulated bench tests, per
 * parameter; used by the tests (some hundred benches) and by experiments/calibration_coverage.c
 * (thousands). */
#ifndef IMUKIT_TEST_COVERAGE_H
#define IMUKIT_TEST_COVERAGE_H

#include "imukit/calibration.h"
#include "imukit/distributions.h"
#include "imukit/procedure.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

typedef struct coverage_count {
    size_t benches, failed; /* tests done; and refused or not solved */
    size_t doubted;         /* of those done: with a warning about scatter or placements */
    size_t sure_held[IMK_CORRELATED_MAX]; /* interval holds the truth, in the other ones */
    size_t parameter_count;
    imk_model_parameter parameter[IMK_CORRELATED_MAX];
    size_t held[IMK_CORRELATED_MAX];   /* interval holds the truth */
    double sum[IMK_CORRELATED_MAX];    /* of (estimate - truth)/sigma */
    double square[IMK_CORRELATED_MAX]; /* of its square */
} coverage_count;

/* Count one result; `truth` is the model the bench was simulated with, run constants included, in
 * the frame of the result. */
static inline void coverage_add_one(coverage_count *c, const imk_calibration_result *result,
                                    const imk_model *truth, double confidence, bool doubted)
{
    c->parameter_count = result->parameter_count;
    c->benches++;
    c->doubted += doubted;
    for (size_t p = 0; p < result->parameter_count; p++) {
        const double error =
            result->value[p] - imk_model_parameter_get(truth, result->parameter[p]);
        const bool held = fabs(error) <= imk_calibration_half_width(result, (int)p, confidence);
        c->parameter[p] = result->parameter[p];
        c->held[p] += held;
        c->sure_held[p] += held && !doubted;
        c->sum[p] += error / result->sigma[p];
        c->square[p] += error * error / (result->sigma[p] * result->sigma[p]);
    }
}

/* Without a look at doubts. */
static inline void coverage_add(coverage_count *c, const imk_calibration_result *result,
                                const imk_model *truth, double confidence)
{
    coverage_add_one(c, result, truth, confidence, false);
}

/* A warning that `imukit calibrate` prints about the scatter of this result; of residuals below ten
 * times the noise it prints a note. */
static inline bool coverage_doubts(const imk_calibration *calibration,
                                   const imk_calibration_result *result)
{
    imk_diagnostic_finding found[16];
    const size_t count = imk_solution_diagnostics(calibration, result, 16, found);
    bool doubts = imk_calibration_placement_probability(result) < 1e-3;
    for (size_t i = 0; i < count; i++)
        doubts = doubts || (found[i].kind == IMK_DIAGNOSTIC_RESIDUALS && found[i].value > 100.0) ||
                 found[i].kind == IMK_DIAGNOSTIC_UNEQUAL_AXES ||
                 found[i].kind == IMK_DIAGNOSTIC_OUTLIERS;
    return doubts;
}

static inline void coverage_take(coverage_count *c, const imk_calibration *calibration,
                                 const imk_calibration_result *result, const imk_model *truth)
{
    coverage_add_one(c, result, truth, 0.95, coverage_doubts(calibration, result));
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

/* What the share held in the benches without a doubt says of 93 to 97 %: "" where it is within, or
 * outside by chance only (three standard deviations of a true share at the limit). */
static inline const char *coverage_verdict(const coverage_count *c, size_t p)
{
    const double sure = (double)(c->benches - c->doubted);
    const double chance = 3.0 * sqrt(0.95 * 0.05 / fmax(1.0, sure));
    const double share = sure > 0.0 ? (double)c->sure_held[p] / sure : coverage_share(c, p);
    return share < 0.93 - chance   ? "  BELOW"
           : share > 0.97 + chance ? "  ABOVE"
           : share < 0.93          ? "  below, perhaps by chance"
           : share > 0.97          ? "  above, perhaps by chance"
                                   : "";
}

/* A line per parameter. @return parameters outside the band beyond chance, 0 where the results are
 * doubted */
static inline size_t coverage_print(const coverage_count *c, FILE *out)
{
    size_t outside = 0, within = 0;
    for (size_t p = 0; p < c->parameter_count; p++) {
        char name[IMK_MODEL_PARAMETER_NAME];
        const char *verdict = coverage_verdict(c, p);
        outside += strcmp(verdict, "  BELOW") == 0 || strcmp(verdict, "  ABOVE") == 0;
        within += verdict[0] == '\0';
        if (imk_model_parameter_name(c->parameter[p], name) == IMK_OK)
            fprintf(out,
                    "  %-40s held %6.2f %%, without doubt %6.2f %%   bias %+.3f sigma   rms %.3f "
                    "sigma%s\n",
                    name, 100.0 * coverage_share(c, p),
                    100.0 * (double)c->sure_held[p] / fmax(1.0, (double)(c->benches - c->doubted)),
                    coverage_bias(c, p), coverage_rms(c, p), verdict);
    }
    const bool told = c->doubted >= 0.99 * (double)c->benches;
    fprintf(out,
            "  %zu of %zu parameters within 93 to 97 %%, %zu outside beyond chance; %.1f %% of "
            "the benches doubted%s\n",
            within, c->parameter_count, outside, 100.0 * (double)c->doubted / (double)c->benches,
            outside == 0 ? ""
            : told       ? ": told"
                         : ": FAIL");
    return told ? 0 : outside;
}

#endif
