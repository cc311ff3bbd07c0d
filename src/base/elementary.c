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

/* high + low, |low| below an ulp of high. */
typedef struct precise {
    double high, low;
} precise;

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

/* a + b exactly. */
static precise sum_of(double a, double b)
{
    const double high = a + b;
    const double b_part = high - a;
    return (precise){high, (a - (high - b_part)) + (b - b_part)};
}

/* a + b exactly, for |a| >= |b| or a = 0. */
static precise ordered_sum_of(double a, double b)
{
    const double high = a + b;
    return (precise){high, b - (high - a)};
}

/* Nearest integer of |x| < 2^51: at 3 2^51 the ulp is 1. */
static double nearest_integer(double x)
{
    const double shift = 0x1.8p52;
    return (x + shift) - shift;
}

/* 2^n, -1022 <= n <= 1023. */
static double power_of_two(int n)
{
    return double_of((uint64_t)(n + EXPONENT_BIAS) << FRACTION_BITS);
}

/* e^x = 2^n (high + low) with n returned, |x| < 800:
 *
 *     n = nearest x / ln 2,   r = x - n ln 2,   e^r = 1 + r + r^2 P(r) */
static int reduced_exp(double x, precise *result)
{
    const double n = nearest_integer(x * 1.4426950408889634);
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
    *result = ordered_sum_of(1.0, r);
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
    precise reduced;
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
    precise reduced;
    const int n = reduced_exp(x, &reduced);
    const double scale = power_of_two(n);
    const precise sum = sum_of(-1.0, scale * reduced.high);
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
    const precise sum = ordered_sum_of(n * ln2_high, f);
    return sum.high + (sum.low + (n * ln2_low - tail));
}

/* sum - n pi/2. pi/2 is cut in parts of 33 bits and the next 53, so that the products of the first
 * three with |n| < 2^20, or a power of two times that, are exact. */
static precise less_quarter_turns(precise sum, double n)
{
    static const double half_pi[] = {0x1.921fb544p+0, 0x1.0b4611a6p-34, 0x1.3198a2ep-69,
                                     0x1.b839a252049c1p-104};
    for (int i = 0; i < 4; i++) {
        const precise next = sum_of(sum.high, -(n * half_pi[i]));
        sum = (precise){next.high, sum.low + next.low};
    }
    return sum_of(sum.high, sum.low);
}

/* x = q pi/2 + rest with |rest| <= pi/4; q mod 4 is returned. |x| <= 1e15. */
static unsigned quadrant_of(double x, precise *rest)
{
    static const double scales[] = {0x1p40, 0x1p20, 1.0}; /* of n; a multiple of 4 or 1 */
    static const double reach[] = {1e15, 0x1p40, 0x1p20}; /* of each and the smaller ones */
    *rest = (precise){x, 0.0};
    if (fabs(x) <= 0.785)
        return 0;
    int i = 2;
    while (fabs(x) > reach[i])
        i--;
    double n = 0.0;
    for (; i < 3; i++) {
        n = nearest_integer(rest->high * (0.63661977236758134 / scales[i]));
        *rest = less_quarter_turns(*rest, n * scales[i]);
    }
    return (unsigned)(int)n & 3;
}

/* sin(r + e) = r + e cos r + r^3 P(r^2), for |r| <= pi/4 and e its rounding error. */
static double reduced_sin(precise x)
{
    const double r = x.high;
    const double w = r * r;
    double p = 1.58968283229245e-10;
    p = p * w + -2.5050758660138353e-08;
    p = p * w + 2.755731369527243e-06;
    p = p * w + -0.00019841269829817102;
    p = p * w + 0.008333333333322425;
    p = p * w + -0.16666666666666632;
    return r + (x.low * (1.0 - 0.5 * w) + r * w * p);
}

/* cos(r + e) = 1 - r^2/2 - e sin r + r^4 P(r^2) */
static double reduced_cos(precise x)
{
    const double r = x.high;
    const double w = r * r;
    double p = -1.1359669464417574e-11;
    p = p * w + 2.087572367640147e-09;
    p = p * w + -2.75573143551828e-07;
    p = p * w + 2.4801587289491637e-05;
    p = p * w + -0.0013888888888874138;
    p = p * w + 0.0416666666666666;
    const precise sum = ordered_sum_of(1.0, -0.5 * w);
    return sum.high + (sum.low + (w * w * p - r * x.low));
}

/* sin of x + quarters pi/2. */
static double shifted_sin(double x, unsigned quarters)
{
    if (!(fabs(x) <= 1e15))
        return (double)NAN;
    precise rest;
    quarters += quadrant_of(x, &rest);
    const double value = quarters & 1 ? reduced_cos(rest) : reduced_sin(rest);
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
