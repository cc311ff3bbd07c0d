/* SPDX-License-Identifier: Apache-2.0 */
/* exp, expm1, log, sin and cos from + - * / alone, so that they have the same bits everywhere.
 *
 * Each reduces its argument exactly or to twice the precision, evaluates a minimax polynomial
 * (tests/reference/minimax_coefficients.py) for the small part of the result, and adds the large
 * part last with the rounding error of its own making: so the error is one half ulp of the last
 * addition and a few hundredths of an ulp of the rest. Rounding to nearest and double arithmetic
 * without excess precision are assumed; splitting constants is [CODY1980], exact sums [DEKKER1971].
 */
#include "imukit/elementary.h"

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

/* ln 2: the high part has 32 bits, so that its products with an exponent are exact. */
static const double ln2_high = 0x1.62e42feep-1;
static const double ln2_low = 0x1.a39ef35793c76p-33;

static uint64_t bits_of(double x)
{
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

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
    const double high = x - n * ln2_high;
    const double low = n * ln2_low;
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

/* x = 2^n (1 + f), 1 + f in [sqrt 1/2, sqrt 2), s = f/(2 + f), h = f^2/2:
 *
 *     log(1 + f) = 2 atanh s = 2 s + 2 s^3 P(s^2) = f - (h - s (h + 2 s^2 P(s^2)))
 *
 * The last form holds f, which is exact, apart from what is rounded. */
double imk_ln(double x)
{
    const uint64_t root_half = UINT64_C(0x3fe6a09e667f3bcd);
    const uint64_t fraction = (UINT64_C(1) << FRACTION_BITS) - 1;
    if (isnan(x))
        return x + x;
    if (x < 0.0)
        return (double)NAN;
    if (x == 0.0)
        return -(double)INFINITY;
    if (isinf(x))
        return x;
    int n = 0;
    if (x < DBL_MIN) {
        x *= 0x1p54;
        n = -54;
    }
    const uint64_t offset = bits_of(x) - root_half + ((uint64_t)EXPONENT_BIAS << FRACTION_BITS);
    n += (int)(offset >> FRACTION_BITS) - EXPONENT_BIAS;
    const double f = double_of((offset & fraction) + root_half) - 1.0;
    const double s = f / (2.0 + f);
    const double z = s * s;
    const double h = 0.5 * f * f;
    double p = 2 * 0.07397973362269404;
    p = p * z + 2 * 0.07657025427410083;
    p = p * z + 2 * 0.09091782157294406;
    p = p * z + 2 * 0.11111099286693019;
    p = p * z + 2 * 0.1428571437119303;
    p = p * z + 2 * 0.1999999999970734;
    p = p * z + 2 * 0.3333333333333367;
    const double tail = h - s * (h + z * p);
    const imki_precise sum = imki_ordered_sum_of(n * ln2_high, f);
    return sum.high + (sum.low + (n * ln2_low - tail));
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
