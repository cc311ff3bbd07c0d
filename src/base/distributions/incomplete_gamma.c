/* SPDX-License-Identifier: Apache-2.0 */
/* Regularised incomplete gamma functions
 *
 *     P(a, x) = 1/Gamma(a) int_0^x t^{a-1} e^{-t} dt,   Q = 1 - P,
 *
 * whichever is small from its own formula:
 *
 *   a >= 20, x near a   Temme's expansion, uniform in x                        [TEMME1979, GIL2012]
 *   x < a + 1           P by the series  x^a e^-x/Gamma(a+1) sum x^n/((a+1)…(a+n))
 *   small a and x       Q = 1 - x^a/Gamma(a+1) (1 - …) without cancellation    [GAUTSCHI1979]
 *   otherwise           Q by Legendre's continued fraction            [ABRAMOWITZ1964, 6.5.31] */
#include "imukit/distributions.h"
#include "imukit/elementary.h"

#include "gamma_internal.h"

#include <math.h>

/* mu - log(1 + mu), accurate for small mu: with t = mu/(2 + mu),
 * log(1 + mu) = 2 (t + t^3/3 + t^5/5 + …) and mu - 2t = mu t. */
double imki_log_deficit(double mu)
{
    if (!(fabs(mu) < 0.5))
        return mu - imk_ln1p(mu);
    const double t = mu / (2.0 + mu);
    const double square = t * t; /* < 1/9: 17 terms reach 1e-17 */
    double sum = 0.0;
    for (int k = 35; k >= 3; k -= 2)
        sum = sum * square + 1.0 / k;
    return mu * t - 2.0 * t * square * sum;
}

double imki_gamma_power(double a, double x)
{
    const double two_pi = 6.28318530717958647693;
    if (a < 10.0)
        return imk_exp(a * imk_ln(x) - x - imk_log_gamma(a + 1.0));
    /* Without the large logarithms that would cancel: a^a e^-a sqrt(2 pi a)/Gamma(a + 1) is close
     * to 1 and x^a e^{a-x} / a^a is e^{-a (mu - log(1 + mu))}, mu = x/a - 1. */
    return imk_exp(-a * imki_log_deficit((x - a) / a) - imki_stirling_error(a)) / sqrt(two_pi * a);
}

/* P for x < a + 1, by terms that fall from the start. */
static double lower_series(double a, double x)
{
    double term = 1.0, sum = 1.0;
    for (double n = a + 1.0; term > sum * 1e-17; n += 1.0) {
        term *= x / n;
        sum += term;
    }
    return imki_gamma_power(a, x) * sum;
}

/* Q for x > a + 1: 1/(x+1-a - 1(1-a)/(x+3-a - 2(2-a)/(x+5-a - …))), by Lentz's forward recursion
 * [LENTZ1976]. */
static double upper_fraction(double a, double x)
{
    double b = x + 1.0 - a;
    double c = (double)INFINITY;
    double d = 1.0 / b;
    double h = d;
    for (double n = 1.0; n < 10000.0; n += 1.0) {
        const double numerator = -n * (n - a);
        b += 2.0;
        d = 1.0 / (numerator * d + b);
        c = b + numerator / c;
        const double factor = c * d;
        h *= factor;
        if (fabs(factor - 1.0) < 1e-16)
            break;
    }
    return imki_gamma_power(a, x) * a * h;
}

/* Q for small a and x, where P is near 1:
 *     1 - x^a/Gamma(1+a)  +  x^a/Gamma(1+a) (a x/(a+1) - a x^2/(2! (a+2)) + …) */
static double upper_small(double a, double x)
{
    const double exponent = a * imk_ln(x) - imki_log_gamma_one_plus(a);
    double power = x, sum = x / (a + 1.0);
    for (double n = 2.0; fabs(power) > sum * 1e-17; n += 1.0) {
        power *= -x / n;
        sum += power / (a + n);
    }
    return -imk_expm1(exponent) + imk_exp(exponent) * a * sum;
}

/* Temme's uniform expansion, with eta^2/2 = lambda - 1 - log lambda, lambda = x/a:
 *
 *     Q = erfc(eta sqrt(a/2))/2 + R,   P = erfc(-eta sqrt(a/2))/2 - R,
 *     R = e^{-a eta^2/2} / sqrt(2 pi a)  sum_n beta_n eta^n / (1 + beta_1/a),
 *     beta_{n-1} = d_n + (n + 1) beta_{n+1}/a  downwards,   eta/(lambda - 1) = sum d_n eta^n.
 *
 * d_n falls as (2 sqrt(pi))^-n, so that 30 of them give 1e-17 for |eta| <= 1 and a >= 20. */
static void temme(double a, double mu, double *lower, double *upper)
{
    static const double d[] = {1.0,
                               -0.3333333333333333,
                               0.08333333333333333,
                               -0.014814814814814815,
                               0.0011574074074074073,
                               0.0003527336860670194,
                               -0.0001787551440329218,
                               3.919263178522438e-05,
                               -2.185448510679992e-06,
                               -1.85406221071516e-06,
                               8.296711340953087e-07,
                               -1.7665952736826078e-07,
                               6.707853543401498e-09,
                               1.0261809784240309e-08,
                               -4.382036018453353e-09,
                               9.14769958223679e-10,
                               -2.5514193994946248e-11,
                               -5.830772132550426e-11,
                               2.4361948020667415e-11,
                               -5.0276692801141755e-12,
                               1.1004392031956135e-13,
                               3.371763262400985e-13,
                               -1.392388722418162e-13,
                               2.8534893807047445e-14,
                               -5.139111834242572e-16,
                               -1.9752288294349442e-15,
                               8.099521156704561e-16,
                               -1.6522531216398162e-16,
                               2.5305430097478883e-18,
                               1.1686939738559576e-17,
                               -4.770037049820485e-18,
                               9.699126059056237e-19};
    enum { LAST = (int)(sizeof d / sizeof d[0]) - 1 };
    const double two_pi = 6.28318530717958647693;
    const double half_square = imki_log_deficit(mu);
    const double eta = copysign(sqrt(2.0 * half_square), mu);
    double beta[LAST + 2] = {0};
    double sum = 0.0;
    for (int n = LAST; n >= 1; n--) {
        beta[n - 1] = d[n] + (n + 1) * beta[n + 1] / a;
        sum = sum * eta + beta[n - 1];
    }
    const double rest = imk_exp(-a * half_square) / sqrt(two_pi * a) * sum / (1.0 + beta[1] / a);
    const double y = eta * sqrt(0.5 * a);
    *upper = 0.5 * imki_erfc(y) + rest;
    *lower = 0.5 * imki_erfc(-y) - rest;
}

void imki_gamma_both(double a, double x, double *lower, double *upper)
{
    const double mu = (x - a) / a;
    if (x == 0.0 || isinf(x)) {
        *lower = x == 0.0 ? 0.0 : 1.0;
        *upper = 1.0 - *lower;
    } else if (a >= 20.0 && mu > -0.69 && mu < 1.35) { /* |eta| < 1 */
        temme(a, mu, lower, upper);
    } else if (x < a + 1.0 || (a < 1.0 && x < 1.5)) {
        *lower = lower_series(a, x);
        *upper = 1.0 - *lower;
        if (a < 1.0 && *lower > 0.5) {
            *upper = upper_small(a, x);
            *lower = 1.0 - *upper;
        }
    } else {
        *upper = upper_fraction(a, x);
        *lower = 1.0 - *upper;
    }
}

double imk_gamma_lower(double a, double x)
{
    double lower, upper;
    if (!(a > 0.0) || !isfinite(a) || !(x >= 0.0))
        return (double)NAN;
    imki_gamma_both(a, x, &lower, &upper);
    return lower;
}

double imk_gamma_upper(double a, double x)
{
    double lower, upper;
    if (!(a > 0.0) || !isfinite(a) || !(x >= 0.0))
        return (double)NAN;
    imki_gamma_both(a, x, &lower, &upper);
    return upper;
}
