/* SPDX-License-Identifier: Apache-2.0 */
/* The angle of a point, from + - * / alone.
 *
 * The smaller coordinate by the larger one is the tangent q + e of an angle below pi/4, e the
 * rounding error of the division. With c = i/16 next to q,
 *
 *     atan(q) = atan(c) + atan(t),   t = (q - c)/(1 + q c),   |t| <= 1/32
 *     atan(t) = t - t^3/3 + t^5/5 - t^7/7 + t^9/9 - t^11/11         (the next term is 2^-63 t)
 *
 * where atan(c) comes from a table and t has its rounding error with it [DEKKER1971]; the quadrant
 * is then put right by exact sums. The error is that of the last addition, 0.5 ulp, and some
 * hundredths. */
#include "imukit/elementary.h"

#include <math.h>
#include <stdbool.h>

/* high + low, |low| below an ulp of high. */
typedef struct double_double {
    double high, low;
} double_double;

/* atan(i/16) to twice the precision, by tests/reference/arc_tangent.py. */
static const double_double angle_of_tangent[] = {
    {0x0.0p+0, 0x0.0p+0},
    {0x1.ff55bb72cfdeap-5, -0x1.c934d86d23f1dp-60},
    {0x1.fd5ba9aac2f6ep-4, -0x1.cd37686760c17p-59},
    {0x1.7b97b4bce5b02p-3, 0x1.347b0b4f881cap-58},
    {0x1.f5b75f92c80ddp-3, 0x1.8ab6e3cf7afbdp-57},
    {0x1.362773707ebccp-2, -0x1.963a544b672d8p-57},
    {0x1.6f61941e4def1p-2, -0x1.c63aae6f6e918p-56},
    {0x1.a64eec3cc23fdp-2, -0x1.24dec1b50b7ffp-56},
    {0x1.dac670561bb4fp-2, 0x1.a2b7f222f65e2p-56},
    {0x1.0657e94db30d0p-1, -0x1.d5b495f6349e6p-56},
    {0x1.1e00babdefeb4p-1, -0x1.928df287a668fp-58},
    {0x1.345f01cce37bbp-1, 0x1.1021137c71102p-55},
    {0x1.4978fa3269ee1p-1, 0x1.2419a87f2a458p-56},
    {0x1.5d58987169b18p-1, 0x1.0028e4bc5e7cap-57},
    {0x1.700a7c5784634p-1, -0x1.8c34d25aadef6p-56},
    {0x1.819d0b7158a4dp-1, -0x1.bf76229d3b917p-56},
    {0x1.921fb54442d18p-1, 0x1.1a62633145c07p-55},
};
static const double_double half_pi = {0x1.921fb54442d18p+0, 0x1.1a62633145c07p-54};

/* a + b exactly, |a| >= |b| or a = 0. */
static double_double exact_sum(double a, double b)
{
    const double high = a + b;
    return (double_double){high, b - (high - a)};
}

/* a b exactly: each factor is cut into halves of 26 bits. */
static double_double exact_product(double a, double b)
{
    const double cut = 0x1p27 + 1.0;
    const double a_cut = cut * a, b_cut = cut * b;
    const double a_high = a_cut - (a_cut - a), b_high = b_cut - (b_cut - b);
    const double a_low = a - a_high, b_low = b - b_high;
    const double high = a * b;
    const double rest = ((a_high * b_high - high) + a_high * b_low) + a_low * b_high;
    return (double_double){high, rest + a_low * b_low};
}

/* (a + a_low)/(b + b_low) to twice the precision. */
static double_double quotient(double a, double a_low, double b, double b_low)
{
    const double high = a / b;
    const double_double product = exact_product(high, b);
    const double rest = ((a - product.high) - product.low) + (a_low - high * b_low);
    return exact_sum(high, rest / b);
}

/* Angle of the point (x, y), 0 < y <= x, x within 2^500 of 1. */
static double_double first_octant(double y, double x)
{
    const double_double q = quotient(y, 0.0, x, 0.0);
    const int i = (int)(16.0 * q.high + 0.5);
    const double c = i * 0.0625;
    double_double t = q;
    if (i > 0) { /* q - c is exact; the product with c of 5 bits nearly so */
        const double_double denominator = exact_sum(1.0, q.high * c);
        const double_double product = exact_product(q.high, c);
        t = quotient(q.high - c, q.low, denominator.high,
                     denominator.low + (product.low + q.low * c));
    }
    const double w = t.high * t.high;
    double p = -1.0 / 11.0;
    p = p * w + 1.0 / 9.0;
    p = p * w - 1.0 / 7.0;
    p = p * w + 1.0 / 5.0;
    p = p * w - 1.0 / 3.0;
    const double tail = t.low + t.high * w * p;
    if (i == 0)
        return exact_sum(t.high, tail);
    const double_double sum = exact_sum(angle_of_tangent[i].high, t.high);
    return exact_sum(sum.high, sum.low + (angle_of_tangent[i].low + tail));
}

/* Angle of (x, y) in the first quadrant, neither zero nor infinite. */
static double_double first_quadrant(double y, double x)
{
    const bool steep = y > x;
    double small = steep ? x : y, large = steep ? y : x;
    double_double angle;
    if (small < 0x1p-500 * large) { /* nothing, or all there is, beside pi/2 */
        angle = (double_double){steep ? 0.0 : small / large, 0.0};
    } else {
        if (large > 0x1p500) {
            small *= 0x1p-600;
            large *= 0x1p-600;
        } else if (large < 0x1p-400) { /* both exact again, were they subnormal */
            small *= 0x1p600;
            large *= 0x1p600;
        }
        angle = first_octant(small, large);
    }
    if (!steep)
        return angle;
    const double_double sum = exact_sum(half_pi.high, -angle.high);
    return exact_sum(sum.high, sum.low + (half_pi.low - angle.low));
}

/* With a coordinate that is zero or infinite. */
static double on_an_axis(double y, double x)
{
    double angle = 0.0; /* in the quarters of a turn */
    if (isinf(x) && isinf(y))
        angle = x > 0.0 ? 0.5 : 1.5;
    else if (isinf(y) || (y != 0.0 && x == 0.0))
        angle = 1.0;
    else if (signbit(x))
        angle = 2.0;
    return copysign(angle * half_pi.high, y);
}

double imk_atan2(double y, double x)
{
    if (isnan(x) || isnan(y))
        return x + y;
    if (x == 0.0 || y == 0.0 || isinf(x) || isinf(y))
        return on_an_axis(y, x);
    double_double angle = first_quadrant(fabs(y), fabs(x));
    if (x < 0.0) {
        const double_double sum = exact_sum(2.0 * half_pi.high, -angle.high);
        angle = exact_sum(sum.high, sum.low + (2.0 * half_pi.low - angle.low));
    }
    return copysign(angle.high, y);
}
