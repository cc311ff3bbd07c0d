/* SPDX-License-Identifier: Apache-2.0 */
/* Regularised incomplete beta function
 *
 *     I_x(a, b) = Gamma(a+b)/(Gamma(a) Gamma(b)) int_0^x t^{a-1} (1-t)^{b-1} dt
 *
 * by its continued fraction [ABRAMOWITZ1964, 26.5.8], on the side of the mean where that falls
 * fast; and what follows from it: the F distribution, and Student's, whose square is F with one
 * degree of freedom above. */
#include "imukit/distributions.h"
#include "imukit/elementary.h"

#include "gamma_internal.h"

#include <float.h>
#include <math.h>
#include <stdbool.h>

/* x^a y^b Gamma(a+b)/(Gamma(a) Gamma(b)). For large a and b Stirling's formula is taken out: with
 * e = x (a+b)/a - 1 and the like of b, a e_a + b e_b = 0, so that the powers are
 * e^{-a (e_a - log(1 + e_a)) - b (…)} and nothing large cancels. */
static double beta_power(double a, double b, double x, double y)
{
    const double two_pi = 6.28318530717958647693;
    if (a < 10.0 || b < 10.0) {
        const double small = a < b ? a : b, large = a < b ? b : a;
        double gammas = imk_log_gamma(large + small) - imk_log_gamma(large);
        if (large >= 10.0) /* the two would cancel */
            gammas = small * imk_ln(large) - (large + small) * imki_log_deficit(small / large) +
                     (large + small) * (small / large) - small - 0.5 * imk_ln1p(small / large) +
                     imki_stirling_error(large + small) - imki_stirling_error(large);
        const double log_x = x < 0.5 ? imk_ln(x) : imk_ln1p(-y),
                     log_y = y < 0.5 ? imk_ln(y) : imk_ln1p(-x);
        return imk_exp(a * log_x + b * log_y + gammas - imk_log_gamma(small));
    }
    const double excess = (x * b - y * a);
    return sqrt(a * b / (two_pi * (a + b))) *
           imk_exp(-a * imki_log_deficit(excess / a) - b * imki_log_deficit(-excess / b) +
                   imki_stirling_error(a + b) - imki_stirling_error(a) - imki_stirling_error(b));
}

/* The even part of the continued fraction,
 *
 *     1/(B1 + A2/(B2 + A3/(B3 + …))),   lambda = a - (a + b) x = a y - b x,
 *     A_m+1 = (a+m-1)(a+b+m-1) m (b-m) x^2/(a+2m-1)^2
 *     B_m+1 = m + m (b-m) x/(a+2m-1) + (a+m) [lambda + 1 + m (1+y)]/(a+2m+1),
 *
 * in which y stands where 1 - x would cancel [DIDONATO1992, eq. 9], by Lentz's forward recursion
 * [LENTZ1976]. */
static double fraction(double a, double b, double x, double y)
{
    const double lambda = a * y - b * x;
    double c = a * (lambda + 1.0) / (a + 1.0), d = 0.0, denominator = c;
    for (double m = 1.0; m < 1e5; m += 1.0) {
        const double odd = a + 2.0 * m - 1.0;
        const double above = (a + m - 1.0) / odd * ((a + b + m - 1.0) / odd) * m * (b - m) * x * x;
        const double below =
            m + m * (b - m) * x / odd + (a + m) / (odd + 2.0) * (lambda + 1.0 + m * (1.0 + y));
        d = 1.0 / (below + above * d);
        c = below + above / c;
        const double factor = c * d;
        denominator *= factor;
        if (fabs(factor - 1.0) < 0.5 * DBL_EPSILON)
            break;
    }
    return 1.0 / denominator;
}

/* I and 1 - I, and x^a y^b/B. */
static void both(double a, double b, double x, double y, double *lower, double *upper,
                 double *power)
{
    *power = 0.0;
    if (x <= 0.0 || y <= 0.0) {
        *lower = x <= 0.0 ? 0.0 : 1.0;
        *upper = 1.0 - *lower;
        return;
    }
    *power = beta_power(a, b, x, y);
    if (x < (a + 1.0) / (a + b + 2.0)) {
        *lower = *power * fraction(a, b, x, y);
        *upper = 1.0 - *lower;
    } else {
        *upper = *power * fraction(b, a, y, x);
        *lower = 1.0 - *upper;
    }
}

double imk_beta_lower(double a, double b, double x, double y)
{
    double lower, upper, power;
    if (!(a > 0.0) || !(b > 0.0) || isinf(a) || isinf(b) || !(x >= 0.0) || !(y >= 0.0))
        return (double)NAN;
    both(a, b, x, y, &lower, &upper, &power);
    return lower;
}

/* P and Q of F at f, and d P/d log f = x^a y^b/B. */
static void f_both(double f, double numerator, double denominator, double *lower, double *upper,
                   double *power)
{
    const double sum = denominator + numerator * f;
    both(0.5 * numerator, 0.5 * denominator, numerator * f / sum, denominator / sum, lower, upper,
         power);
}

double imk_f_upper(double f, double numerator, double denominator)
{
    double lower, upper, power;
    if (!(f >= 0.0) || !(numerator > 0.0) || !(denominator > 0.0) || isinf(numerator))
        return (double)NAN;
    if (isinf(denominator) || isinf(f))
        return isinf(f) ? 0.0 : imk_gamma_upper(0.5 * numerator, 0.5 * numerator * f);
    f_both(f, numerator, denominator, &lower, &upper, &power);
    return upper;
}

/* Newton's method for log f on the logarithm of the smaller tail, which is concave in log f: from
 * the first step on it approaches from one side. It starts from chi-square, the limit of many
 * degrees below. */
double imk_f_upper_quantile(double probability, double numerator, double denominator)
{
    if (!(probability > 0.0) || !(probability < 1.0) || !(numerator > 0.0) ||
        !(denominator > 0.0) || isinf(numerator))
        return (double)NAN;
    double f = imk_chi_square_quantile(1.0 - probability, numerator) / numerator;
    if (probability < 1e-3) /* 1 - probability would be rounded */
        f = imk_chi_square_quantile(1.0 - 1e-3, numerator) / numerator;
    if (isinf(denominator) && probability >= 1e-3)
        return f;
    const bool from_above = probability < 0.5;
    const double target = from_above ? probability : 1.0 - probability;
    double last = (double)INFINITY;
    for (int i = 0; i < 200; i++) {
        double lower, upper, power;
        if (isinf(denominator)) {
            imki_gamma_both(0.5 * numerator, 0.5 * numerator * f, &lower, &upper);
            power = imki_gamma_power(0.5 * numerator, 0.5 * numerator * f) * 0.5 * numerator;
        } else {
            f_both(f, numerator, denominator, &lower, &upper, &power);
        }
        const double tail = from_above ? upper : lower;
        double step = imk_ln(tail / target) * tail / power;
        step = from_above ? step : -step;
        if (!(fabs(step) <= 3.0))
            step = copysign(3.0, step);
        if (fabs(step) < 1e-10 && fabs(step) >= 0.5 * last)
            break; /* steps no longer shrink: rounding alone */
        f *= imk_exp(step);
        last = fabs(step);
        if (last < 1e-16)
            break;
    }
    return f;
}

double imk_student_quantile(double probability, double degrees)
{
    if (!(probability > 0.0) || !(probability < 1.0) || !(degrees > 0.0))
        return (double)NAN;
    if (isinf(degrees))
        return imk_normal_quantile(probability);
    if (probability == 0.5)
        return 0.0;
    const double tail = probability < 0.5 ? probability : 1.0 - probability;
    return copysign(sqrt(imk_f_upper_quantile(2.0 * tail, 1.0, degrees)), probability - 0.5);
}
