/* SPDX-License-Identifier: Apache-2.0 */
/* exp, expm1, log, log1p, sin and cos from + - * / alone, so that they have the same bits
 * everywhere.
 *
 * Each reduces its argument exactly or to twice the precision, evaluates a minimax polynomial
 * (tests/reference/minimax_coefficients.py) for the small part of the result, and adds the large
 * part last with the rounding error of its own making: so the error is one half ulp of the last
 * addition and a few hundredths of an ulp of the rest. Rounding to nearest and double arithmetic
 * without excess precision are assumed; splitting constants is [CODY1980], exact sums [DEKKER1971].
 */
#include "imukit/elementary.h"

#include "logarithm_internal.h"
#include "sine_internal.h"

#include <float.h>
#include <math.h>
#include <string.h>

#if FLT_EVAL_METHOD != 0
#error                                                                                             \
    "imukit needs double arithmetic without excess precision (on 32-bit x86: -msse2 -mfpmath=sse)"
#endif

#define EXPONENT_BIAS 1023
#define FRACTION_BITS 52

static double double_of(uint64_t bits)
{
    double x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

/* 2^n, -1022 <= n <= 1023. */
static double power_of_two(int n)
{
    return double_of((uint64_t)(n + EXPONENT_BIAS) << FRACTION_BITS);
}

/* e^x = 2^n (high + low) with n returned, |x| < 800:
 *
 *     n = nearest x / ln 2,   r = x - n ln 2,   e^r = 1 + r + r^2 P(r) */
static int reduced_exp(double x, imki_precise *result)
{
    const double n = imki_nearest_integer(x * 1.4426950408889634);
    const double high = x - n * imki_ln2_high;
    const double low = n * imki_ln2_low;
    const double r = high - low;
    const double lost = (high - r) - low;
    double p = 2.092691294858863e-09;
    p = p * r + 2.511222810285032e-08;
    p = p * r + 2.7557233450040125e-07;
    p = p * r + 2.7557234269779137e-06;
    p = p * r + 2.480158737365953e-05;
    p = p * r + 0.00019841269897026716;
    p = p * r + 0.0013888888888858452;
    p = p * r + 0.008333333333316751;
    p = p * r + 0.04166666666666673;
    p = p * r + 0.16666666666666685;
    p = p * r + 0.5;
    *result = imki_ordered_sum_of(1.0, r);
    result->low += r * r * p + lost;
    return (int)n;
}

double imk_exp(double x)
{
    if (isnan(x))
        return x + x;
    if (x > 709.79) /* ln DBL_MAX = 709.7827 */
        return (double)INFINITY;
    if (x < -745.2) /* ln (smallest subnormal / 2) = -745.1332 */
        return 0.0;
    imki_precise reduced;
    const int n = reduced_exp(x, &reduced);
    /* In two steps, as 2^n itself may be out of range; only the second one can round. */
    const int half = n / 2;
    return (reduced.high + reduced.low) * power_of_two(half) * power_of_two(n - half);
}

double imk_expm1(double x)
{
    const double no_change = 0x1p-54; /* below, x^2/2 is less than a quarter ulp of x */
    if (isnan(x))
        return x + x;
    if (fabs(x) < no_change)
        return x;
    if (x > 40.0) /* the 1 is less than a tenth of an ulp */
        return imk_exp(x) - 1.0;
    if (x < -40.0) /* e^x is less than a tenth of an ulp */
        return -1.0;
    imki_precise reduced;
    const int n = reduced_exp(x, &reduced);
    const double scale = power_of_two(n);
    const imki_precise sum = imki_sum_of(-1.0, scale * reduced.high);
    return sum.high + (sum.low + scale * reduced.low);
}

double imk_ln(double x)
{
    if (isnan(x))
        return x + x;
    if (x < 0.0)
        return (double)NAN;
    if (x == 0.0)
        return -(double)INFINITY;
    if (isinf(x))
        return x;
    return x < DBL_MIN ? imki_ln_of_normal(x * 0x1p54, -54.0) : imki_ln_of_normal(x, 0.0);
}

/* With 1 + x = u + e, log(1 + x) = log u + e/u + O(e^2). */
double imk_ln1p(double x)
{
    if (fabs(x) < 0x1p-54) /* x^2/2 is less than a quarter ulp of x */
        return x;
    const imki_precise sum = imki_sum_of(1.0, x);
    const double logarithm = imk_ln(sum.high);
    return fabs(logarithm) < (double)INFINITY ? logarithm + sum.low / sum.high : logarithm;
}

/* x = q pi/2 + rest with |rest| <= pi/4; q mod 4 is returned. |x| <= 1e15. */
static unsigned quadrant_of(double x, imki_precise *rest)
{
    static const double scales[] = {0x1p40, 0x1p20, 1.0}; /* of n; a multiple of 4 or 1 */
    *rest = (imki_precise){x, 0.0};
    if (fabs(x) <= 0.785)
        return 0;
    double n = 0.0;
    for (int i = fabs(x) > 0x1p40 ? 0 : fabs(x) > 0x1p20 ? 1 : 2; i < 3; i++) {
        n = imki_nearest_integer(rest->high * (0.63661977236758134 / scales[i]));
        *rest = imki_less_quarter_turns(*rest, n * scales[i]);
    }
    return (unsigned)(int)n & 3;
}

/* sin of x + quarters pi/2. */
static double shifted_sin(double x, unsigned quarters)
{
    if (!(fabs(x) <= 1e15))
        return (double)NAN;
    imki_precise rest;
    quarters += quadrant_of(x, &rest);
    const double value = quarters & 1 ? imki_reduced_cos(rest) : imki_reduced_sin(rest);
    return quarters & 2 ? -value : value;
}

double imk_sin(double x)
{
    const double no_change = 0x1p-27; /* below, x^3/6 is less than a tenth of an ulp of x */
    return fabs(x) < no_change ? x : shifted_sin(x, 0);
}

double imk_cos(double x)
{
    return shifted_sin(x, 1);
}
