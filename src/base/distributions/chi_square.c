/* SPDX-License-Identifier: Apache-2.0 */
/* Chi-square distribution: P(degrees/2, x/2), and its quantile by Newton's method in logarithms. */
#include "imukit/distributions.h"
#include "imukit/elementary.h"

#include "gamma_internal.h"

#include <math.h>
#include <stdbool.h>

double imk_chi_square_probability(double x, double degrees)
{
    return imk_gamma_lower(0.5 * degrees, 0.5 * x);
}

/* Start of the iteration: for small probabilities the first term of the series of P,
 * P ~ x^a/Gamma(a+1); else a cubed normal variable [WILSON1931]. */
static double first_guess(double probability, double a)
{
    const double z = imk_normal_quantile(probability);
    const double ninth = 1.0 / (9.0 * a);
    const double cube_root = 1.0 - ninth + z * sqrt(ninth);
    const double series = imk_exp((imk_ln(probability) + imk_log_gamma(a + 1.0)) / a);
    /* The next term of the series is -x a/(a+1): it may be left out while x is small. */
    if (series < 0.2 * (a + 1.0) || !(cube_root > 0.1))
        return series;
    return a * cube_root * cube_root * cube_root;
}

/* Solves log P(a, x) = log p, or log Q(a, x) = log(1-p) in the upper half, for log x. Both are
 * concave in log x, because the density of log x is log-concave; so Newton's steps approach the
 * root from one side after the first, which is kept from running away. */
double imk_chi_square_quantile(double probability, double degrees)
{
    const double a = 0.5 * degrees;
    if (!(probability > 0.0) || !(probability < 1.0) || !(a > 0.0) || !isfinite(a))
        return (double)NAN;
    const bool upper_half = probability > 0.5;
    const double target = upper_half ? 1.0 - probability : probability;
    const double longest_step = a > 1.0 ? 4.0 / sqrt(a) : 4.0 / a;
    double x = first_guess(probability, a);
    double last = (double)INFINITY;
    for (int i = 0; i < 100 && x > 0.0; i++) {
        double lower, upper;
        imki_gamma_both(a, x, &lower, &upper);
        const double tail = upper_half ? upper : lower;
        /* d log P / d log x = x^a e^-x / (Gamma(a) P), and the negative for Q. */
        const double slope = imki_gamma_power(a, x) * a / tail;
        double step = imk_ln(tail / target) / slope;
        step = upper_half ? step : -step;
        if (!(fabs(step) <= longest_step))
            step = copysign(longest_step, step);
        /* Converged: the steps no longer shrink, being rounding alone. */
        if (fabs(step) < 1e-10 && fabs(step) >= 0.5 * last)
            break;
        x *= imk_exp(step);
        last = fabs(step);
        if (last < 1e-16)
            break;
    }
    return 2.0 * x;
}
