/* SPDX-License-Identifier: Apache-2.0 */
/* Standard normal distribution:  Phi(x) = erfc(-x/sqrt 2)/2, and its inverse. */
#include "imukit/distributions.h"
#include "imukit/elementary.h"

#include "gamma_internal.h"

#include <math.h>

static double normal_density(double x)
{
    const double one_over_root_two_pi = 0.39894228040143267794;
    /* x^2/2 is split so that its rounding does not spoil the tail: the rest is below ulp(x^2/2). */
    const double square = x * x;
    const double rest = fma(x, x, -square);
    return one_over_root_two_pi * imk_exp(-0.5 * square) * (1.0 - 0.5 * rest);
}

double imk_normal_probability(double x)
{
    /* 1/sqrt(2) in two parts. erfc multiplies a relative error of its argument t by 2 t^2, up to
     * 1400 here, so the product's rounding is put back by the derivative:
     * erfc(t + h) = erfc(t) - 2/sqrt(pi) e^{-t^2} h. */
    const double high = 0.70710678118654757, low = -4.8336466567264567e-17;
    const double two_over_root_pi = 1.12837916709551257390;
    if (isnan(x))
        return (double)NAN;
    const double t = -x * high;
    if (!(fabs(t) < 28.0))
        return x > 0.0 ? 1.0 : 0.0;
    const double h = fma(-x, high, -t) - x * low;
    return 0.5 * (imki_erfc(t) - two_over_root_pi * imk_exp(-t * t) * h);
}

/* Phi(x) - 1/2 for moderate x, relative to itself. */
static double central_probability(double x)
{
    return 0.5 * imki_erf(x * 0.70710678118654752440);
}

/* Quantile for 0 < p <= 1/2, by Halley's iteration from the rational approximation
 * [ABRAMOWITZ1964, 26.2.23], whose error of 4.5e-4 the first two steps take below 1e-16. */
static double lower_quantile(double p)
{
    const double t = sqrt(-2.0 * imk_ln(p));
    double x = (2.515517 + t * (0.802853 + t * 0.010328)) /
                   (1.0 + t * (1.432788 + t * (0.189269 + t * 0.001308))) -
               t;
    for (int i = 0; i < 4; i++) {
        const double excess =
            p > 0.2 ? central_probability(x) - (p - 0.5) : imk_normal_probability(x) - p;
        const double u = excess / normal_density(x);
        const double step = u / (1.0 + 0.5 * x * u);
        x -= step;
        if (fabs(step) <= 1e-9 * fabs(x)) /* the error left is about its cube */
            break;
    }
    return x;
}

double imk_normal_quantile(double probability)
{
    if (!(probability > 0.0) || !(probability < 1.0))
        return (double)NAN;
    if (probability == 0.5)
        return 0.0;
    return probability < 0.5 ? lower_quantile(probability) : -lower_quantile(1.0 - probability);
}
