/* SPDX-License-Identifier: Apache-2.0 */
/* Mean and spread of a population from members each known to its own sigma.
 *
 *     x_i ~ N(mean, spread^2 + sigma_i^2)
 *
 * Restricted likelihood of v = spread^2, with w_i = 1/(v + sigma_i^2) and the weighted mean m:
 *
 *     l = -1/2 [ sum log(v + sigma_i^2) + log sum w_i + sum w_i (x_i - m)^2 ] [VIECHTBAUER2005]
 *
 * Q(v) = sum w_i (x_i - m)^2 falls with v, and is chi-square with n - 1 degrees at the true one:
 * the interval of the spread is where it lies between the quantiles [VIECHTBAUER2007]. */
#include "imukit/distributions.h"
#include "imukit/elementary.h"
#include "imukit/identify_joint.h"

#include <math.h>

typedef struct members {
    size_t count;
    const double *value, *sigma;
} members;

static double weighted_mean(const members *s, double variance, double *weight)
{
    double sum = 0, total = 0;
    for (size_t i = 0; i < s->count; i++) {
        const double w = 1 / (variance + s->sigma[i] * s->sigma[i]);
        sum += w * (s->value[i] - s->value[0]);
        total += w;
    }
    *weight = total;
    return s->value[0] + sum / total;
}

static double scatter(const members *s, double variance)
{
    double weight, sum = 0;
    const double mean = weighted_mean(s, variance, &weight);
    for (size_t i = 0; i < s->count; i++) {
        const double d = s->value[i] - mean;
        sum += d * d / (variance + s->sigma[i] * s->sigma[i]);
    }
    return sum;
}

static double restricted_likelihood(const members *s, double variance)
{
    double weight, sum = 0;
    (void)weighted_mean(s, variance, &weight);
    for (size_t i = 0; i < s->count; i++)
        sum += imk_ln(variance + s->sigma[i] * s->sigma[i]);
    return -0.5 * (sum + imk_ln(weight) + scatter(s, variance));
}

/* The variance at which the scatter has fallen to a value; 0 when it begins below. */
static double variance_at(const members *s, double wanted, double unit)
{
    if (scatter(s, 0) <= wanted)
        return 0;
    double low = 0, high = unit;
    while (scatter(s, high) > wanted && high < 1e300)
        high *= 4;
    for (int i = 0; i < 200 && high - low > 1e-12 * high; i++) {
        const double middle = 0.5 * (low + high);
        *(scatter(s, middle) > wanted ? &low : &high) = middle;
    }
    return 0.5 * (low + high);
}

/* The likelihood has one peak but for freak cases: a ladder of factors of 1.2, then thirds. */
static double likeliest_variance(const members *s, double least, double most)
{
    const double step = 1.2;
    double best = 0, height = restricted_likelihood(s, 0);
    for (double v = least; v < most; v *= step) {
        const double l = restricted_likelihood(s, v);
        if (l > height) {
            height = l;
            best = v;
        }
    }
    double low = best / step, high = best > 0 ? best * step : least;
    for (int i = 0; i < 100; i++) {
        const double a = low + (high - low) / 3, b = high - (high - low) / 3;
        if (restricted_likelihood(s, a) < restricted_likelihood(s, b))
            low = a;
        else
            high = b;
    }
    const double v = 0.5 * (low + high);
    return restricted_likelihood(s, v) > restricted_likelihood(s, 0) ? v : 0;
}

imk_status imk_population_estimate(size_t count, const double *values, const double *sigmas,
                                   double confidence, imk_population *population)
{
    const members s = {count, values, sigmas};
    if (count < 2)
        return IMK_ERROR_TOO_SHORT;
    if (!(confidence > 0 && confidence < 1))
        return IMK_ERROR_RANGE;
    double least = HUGE_VAL, low = HUGE_VAL, high = -HUGE_VAL;
    for (size_t i = 0; i < count; i++) {
        if (!(fabs(values[i]) < HUGE_VAL) || !(sigmas[i] < HUGE_VAL))
            return IMK_ERROR_NOT_FINITE;
        if (!(sigmas[i] > 0))
            return IMK_ERROR_RANGE;
        least = fmin(least, sigmas[i] * sigmas[i]);
        low = fmin(low, values[i]);
        high = fmax(high, values[i]);
    }
    const double degrees = (double)count - 1, tail = 0.5 * (1 - confidence);
    const double range = (high - low) * (high - low) + least;
    imk_population p = {.chi_square = scatter(&s, 0)};
    p.probability = imk_gamma_upper(0.5 * degrees, 0.5 * p.chi_square);
    const double variance = likeliest_variance(&s, 1e-4 * least, 100 * range);
    double weight;
    p.spread = sqrt(variance);
    p.mean = weighted_mean(&s, variance, &weight);
    p.spread_lower = sqrt(variance_at(&s, imk_chi_square_quantile(1 - tail, degrees), range));
    p.spread_upper = sqrt(variance_at(&s, imk_chi_square_quantile(tail, degrees), range));
    /* The scatter found, not less than what the sigmas alone make [KNAPP2003]. */
    const double factor = fmax(1, scatter(&s, variance) / degrees);
    const double reach =
        imk_student_quantile(0.5 * (1 + confidence), degrees) * sqrt(factor / weight);
    p.mean_lower = p.mean - reach;
    p.mean_upper = p.mean + reach;
    *population = p;
    return IMK_OK;
}
