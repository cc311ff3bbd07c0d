/* SPDX-License-Identifier: Apache-2.0 */
/* The standard deviation between runs whose values have unequal uncertainties; equations in
 * repeatability.h. With sigmas of few degrees of freedom v_k, at the trial variance t
 *
 *     F = Q/(K - 1) / (1 + 2 (K - 2)/(K^2 - 1) A),   A = sum of (1 - w_k/sum(w))^2 / v'_k
 *
 * is F-distributed with K - 1 and (K^2 - 1)/(3 A) degrees of freedom [WELCH1951], where
 * v'_k = v_k ((sigma_k^2 + t)/sigma_k^2)^2: t is not estimated, only sigma is
 * [SATTERTHWAITE1946]. */
#include "imukit/repeatability.h"

#include "base/refuse_internal.h"
#include "imukit/distributions.h"

#include <math.h>
#include <string.h>

enum { BISECTIONS = 90, DOUBLINGS = 200 };

typedef struct sample {
    size_t runs;
    const double *value, *sigma, *freedom;
    double floor;   /* added to variances, so that no weight is infinite */
    double stretch; /* factor of Q, see chance_agreement() */
} sample;

/* Moments at a trial variance. */
typedef struct moments {
    double mean, weights, ratio, denominator; /* F and its second degrees of freedom */
} moments;

static double variance_of(const sample *s, size_t k, double t)
{
    return s->sigma[k] * s->sigma[k] + s->floor + t;
}

static moments moments_at(const sample *s, double t)
{
    const double runs = (double)s->runs;
    moments m = {0.0, 0.0, 0.0, 0.0};
    double q = 0.0, a = 0.0;
    for (size_t k = 0; k < s->runs; k++) {
        const double w = 1.0 / variance_of(s, k, t);
        m.weights += w;
        m.mean += w * s->value[k];
    }
    m.mean /= m.weights;
    for (size_t k = 0; k < s->runs; k++) {
        const double variance = variance_of(s, k, t), d = s->value[k] - m.mean;
        q += d * d / variance;
        const double own = s->sigma[k] * s->sigma[k] / variance;
        const double rest = 1.0 - 1.0 / (variance * m.weights);
        if (s->freedom && s->freedom[k] < HUGE_VAL)
            a += rest * rest * own * own / s->freedom[k];
    }
    m.ratio = q / (runs - 1.0) / (1.0 + 2.0 * (runs - 2.0) / (runs * runs - 1.0) * a) * s->stretch;
    m.denominator = a > 0.0 ? (runs * runs - 1.0) / (3.0 * a) : HUGE_VAL;
    return m;
}

/* Probability of so large a Q or a larger one, were t the variance. Grows with t. */
static double probability_at(const sample *s, double t)
{
    const moments m = moments_at(s, t);
    return imk_f_upper(m.ratio, (double)s->runs - 1.0, m.denominator);
}

/* The variance at which what `measure` gives has risen to `wanted`, 0 when it has at 0. */
static double solve(const sample *s, double (*measure)(const sample *, double), double wanted)
{
    if (!(measure(s, 0.0) < wanted))
        return 0.0;
    double high = s->floor, low = 0.0;
    for (size_t k = 0; k < s->runs; k++)
        high = fmax(high, s->sigma[k] * s->sigma[k]);
    for (int i = 0; i < DOUBLINGS && measure(s, high) < wanted; i++) {
        low = high;
        high *= 4.0;
    }
    for (int i = 0; i < BISECTIONS && high - low > 1e-14 * high; i++) {
        const double middle = 0.5 * (low + high);
        *(measure(s, middle) < wanted ? &low : &high) = middle;
    }
    return 0.5 * (low + high);
}

static double minus_ratio(const sample *s, double t)
{
    return -moments_at(s, t).ratio;
}

/* Runs may agree by chance far better than their own sigmas let one expect, which tells nothing
 * about the repeatability: a Q that is exceeded with more than `confidence` even without any is
 * raised to that for the upper bound, which else could be 0. */
static double chance_agreement(const sample *s, double confidence)
{
    const moments m = moments_at(s, 0.0);
    const double least = imk_f_upper_quantile(confidence, (double)s->runs - 1.0, m.denominator);
    return m.ratio < least ? least / fmax(m.ratio, 1e-300) : 1.0;
}

/* Standard deviation of the estimated variance, from the restricted likelihood's information
 *     (1/2) [sum w^2 - 2 sum w^3/sum w + (sum w^2/sum w)^2]. */
static double variance_sigma(const sample *s, double t)
{
    double one = 0.0, two = 0.0, three = 0.0;
    for (size_t k = 0; k < s->runs; k++) {
        const double w = 1.0 / variance_of(s, k, t);
        one += w;
        two += w * w;
        three += w * w * w;
    }
    const double information = 0.5 * (two - 2.0 * three / one + two / one * (two / one));
    return 1.0 / sqrt(information);
}

static imk_status check(size_t runs, const double *value, const double *sigma,
                        const double *freedom, double confidence, imk_error *error)
{
    if (runs < 2 || runs > IMK_RUNS_MAX) {
        const bool few = runs < 2;
        imk_error_set(error, few ? IMK_ERROR_TOO_SHORT : IMK_ERROR_RANGE, "runs", NULL,
                      few ? "at least two runs; five or more make a useful interval"
                          : "at most 1024 runs");
        if (error) {
            error->value = (double)runs;
            error->limit = few ? 2 : IMK_RUNS_MAX;
        }
        return few ? IMK_ERROR_TOO_SHORT : IMK_ERROR_RANGE;
    }
    if (!(confidence > 0.0 && confidence < 1.0))
        return imk_error_set(error, IMK_ERROR_RANGE, "confidence", NULL, "between 0 and 1");
    for (size_t k = 0; k < runs; k++) {
        if (!isfinite(value[k]))
            return imki_refuse_at(error, IMK_ERROR_NOT_FINITE, "run", k, 0.0, 0.0,
                                  "a finite value of every run");
        if (!(sigma[k] >= 0.0 && sigma[k] < HUGE_VAL))
            return imki_refuse_at(error, IMK_ERROR_RANGE, "sigma", k, 0.0, 0.0, "0 or more");
        if (freedom && !(freedom[k] > 0.0))
            return imki_refuse_at(error, IMK_ERROR_RANGE, "freedom", k, 0.0, 0.0, "above 0");
    }
    return IMK_OK;
}

imk_status imk_repeatability_estimate(size_t runs, const double *value, const double *sigma,
                                      const double *freedom, double confidence,
                                      imk_repeatability *result, imk_error *error)
{
    const imk_status status = check(runs, value, sigma, freedom, confidence, error);
    if (status != IMK_OK)
        return status;
    double low = value[0], high = value[0], within = 0.0;
    for (size_t k = 0; k < runs; k++) {
        low = fmin(low, value[k]);
        high = fmax(high, value[k]);
        within += sigma[k] * sigma[k];
    }
    memset(result, 0, sizeof *result);
    result->runs = runs;
    result->within = sqrt(within / (double)runs);
    if (high - low == 0.0 && within == 0.0) {
        result->mean = low;
        result->probability = 1.0;
        return IMK_OK;
    }
    /* 1e-9 of the spread: far below what any number of runs can tell. */
    const double tiny = 1e-9 * ((high - low) + result->within);
    sample s = {runs, value, sigma, freedom, tiny * tiny, 1.0};
    const double t = solve(&s, minus_ratio, -1.0), spread = variance_sigma(&s, t);
    const moments m = moments_at(&s, t);
    result->mean = m.mean;
    result->mean_sigma = 1.0 / sqrt(m.weights);
    result->value = sqrt(t);
    result->sigma = t > 0.0 ? fmin(0.5 * spread / sqrt(t), sqrt(spread)) : sqrt(spread);
    result->probability = probability_at(&s, 0.0);
    result->lower = sqrt(solve(&s, probability_at, 0.5 - 0.5 * confidence));
    s.stretch = chance_agreement(&s, confidence);
    result->upper = sqrt(solve(&s, probability_at, 0.5 + 0.5 * confidence));
    return IMK_OK;
}
