/* SPDX-License-Identifier: Apache-2.0 */
/* Error function and its complement, from + - * / and imk_exp(), so that estimates have the same
 * bits everywhere:
 *
 *   |x| < 1/2   erf(x) = x P(x^2)
 *   beyond      erfc(|x|) = e^{-x^2} R(t)/(1 + 2 |x|),   t = (|x| - 4)/(|x| + 4)
 *
 * with minimax polynomials P and R (tests/reference/minimax_coefficients.py); R runs from 1.2 at 0
 * to 2/sqrt(pi) at infinity, which is why few powers of t suffice. */
#include "imukit/elementary.h"

#include "gamma_internal.h"

#include <math.h>

#define COUNT(array) ((int)(sizeof(array) / sizeof((array)[0])))

static double polynomial(int count, const double *coefficient, double x)
{
    double sum = 0.0;
    for (int k = count - 1; k >= 0; k--)
        sum = sum * x + coefficient[k];
    return sum;
}

static double central(double x)
{
    static const double coefficient[] = {1.1283791670955126,     -0.3761263890318375,
                                         0.11283791670954864,    -0.026866170644997654,
                                         0.005223977621974562,   -0.0008548326505839159,
                                         0.00012055285871013896, -1.4922990295838226e-05,
                                         1.6370955957084287e-06, -1.4618441321282917e-07};
    return x * polynomial(COUNT(coefficient), coefficient, x * x);
}

/* x >= 1/2. The square is that of the first 24 bits, which is exact, and the rest. */
static double tail(double x)
{
    static const double coefficient[] = {
        1.2329951186255526,     -0.1396211168405625,    0.015379652102619875,
        0.06809705425468865,    -0.10103906603631252,   0.09373283499852648,
        -0.06633036581201734,   0.037167515533934735,   -0.016197734060359275,
        0.0050319700171931134,  -0.0007577732692746032, -0.0001992569574719376,
        0.0001506215856028505,  -2.439808706469846e-05, -1.122176693569195e-05,
        5.706563854240216e-06,  2.9333945684582147e-07, -8.196069988142136e-07,
        7.513167185407228e-08,  1.0333514023830634e-07, -1.8203803693878858e-08,
        -9.678989103174286e-09, 1.9066658070252022e-09};
    if (x > 28.0) /* e^-784 is below the smallest double */
        return 0.0;
    const double first = (double)(float)x, rest = (x - first) * (x + first);
    const double ratio = polynomial(COUNT(coefficient), coefficient, (x - 4.0) / (x + 4.0));
    return imk_exp(-first * first) * (imk_exp(-rest) * ratio / (1.0 + 2.0 * x));
}

double imki_erf(double x)
{
    if (!(fabs(x) >= 0.5))
        return central(x);
    return copysign(1.0 - tail(fabs(x)), x);
}

double imki_erfc(double x)
{
    if (!(fabs(x) >= 0.5))
        return 1.0 - central(x);
    return x > 0.0 ? tail(x) : 2.0 - tail(-x);
}
