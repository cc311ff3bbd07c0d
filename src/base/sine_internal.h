/* SPDX-License-Identifier: Apache-2.0 */
/* The pieces of sin and cos (elementary.c), and both at once of a small angle without a branch, for
 * loops that the compiler turns into vectors: the same bits as imk_sin() and imk_cos(). */
#ifndef IMUKIT_SINE_INTERNAL_H
#define IMUKIT_SINE_INTERNAL_H

/* high + low, |low| below an ulp of high. */
typedef struct imki_precise {
    double high, low;
} imki_precise;

/* a + b exactly. */
static inline imki_precise imki_sum_of(double a, double b)
{
    const double high = a + b;
    const double b_part = high - a;
    return (imki_precise){high, (a - (high - b_part)) + (b - b_part)};
}

/* a + b exactly, for |a| >= |b| or a = 0. */
static inline imki_precise imki_ordered_sum_of(double a, double b)
{
    const double high = a + b;
    return (imki_precise){high, b - (high - a)};
}

/* Nearest integer of |x| < 2^51: at 3 2^51 the ulp is 1. */
static inline double imki_nearest_integer(double x)
{
    const double shift = 0x1.8p52;
    return (x + shift) - shift;
}

/* One part of n pi/2 less. */
static inline imki_precise imki_less_part(imki_precise sum, double part)
{
    const imki_precise next = imki_sum_of(sum.high, -part);
    return (imki_precise){next.high, sum.low + next.low};
}

/* sum - n pi/2. pi/2 is cut in parts of 33 bits and the next 53, so that the products of the first
 * three with |n| < 2^20, or a power of two times that, are exact. */
static inline imki_precise imki_less_quarter_turns(imki_precise sum, double n)
{
    sum = imki_less_part(sum, n * 0x1.921fb544p+0);
    sum = imki_less_part(sum, n * 0x1.0b4611a6p-34);
    sum = imki_less_part(sum, n * 0x1.3198a2ep-69);
    sum = imki_less_part(sum, n * 0x1.b839a252049c1p-104);
    return imki_sum_of(sum.high, sum.low);
}

/* sin(r + e) = r + e cos r + r^3 P(r^2), for |r| <= pi/4 and e its rounding error. */
static inline double imki_reduced_sin(imki_precise x)
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
static inline double imki_reduced_cos(imki_precise x)
{
    const double r = x.high;
    const double w = r * r;
    double p = -1.1359669464417574e-11;
    p = p * w + 2.087572367640147e-09;
    p = p * w + -2.75573143551828e-07;
    p = p * w + 2.4801587289491637e-05;
    p = p * w + -0.0013888888888874138;
    p = p * w + 0.0416666666666666;
    const imki_precise sum = imki_ordered_sum_of(1.0, -0.5 * w);
    return sum.high + (sum.low + (w * w * p - r * x.low));
}

/* Both of |x| <= pi: n is -2 … 2 quarter turns. Where the functions take a shorter way, for small
 * x, the longer one leads to the same bits: less_quarter_turns(x, 0) is x, and below 2^-27 the
 * polynomial is less than half an ulp of x. */
static inline void imki_sine_and_cosine(double x, double *sine, double *cosine)
{
    const double n = imki_nearest_integer(x * 0.63661977236758134);
    const imki_precise rest = imki_less_quarter_turns((imki_precise){x, 0.0}, n);
    const double s = imki_reduced_sin(rest), c = imki_reduced_cos(rest);
    const double square = n * n; /* 0, 1 or 4 */
    const double s_turned = square > 1.0 ? -s : s, c_turned = square > 1.0 ? -c : c;
    *sine = square == 1.0 ? n * c : s_turned;
    *cosine = square == 1.0 ? -n * s : c_turned;
}

#endif
