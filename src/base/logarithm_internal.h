/* SPDX-License-Identifier: Apache-2.0 */
/* The logarithm of a positive normal number without a branch or a call, for loops over spectra: the
 * same bits as imk_ln(). */
#ifndef IMUKIT_LOGARITHM_INTERNAL_H
#define IMUKIT_LOGARITHM_INTERNAL_H

#include "sine_internal.h"

#include <stdint.h>
#include <string.h>

/* ln 2: the high part has 32 bits, so that its products with an exponent are exact. */
static const double imki_ln2_high = 0x1.62e42feep-1, imki_ln2_low = 0x1.a39ef35793c76p-33;

/* x = 2^n (1 + f), 1 + f in [sqrt 1/2, sqrt 2), s = f/(2 + f), h = f^2/2:
 *
 *     log(1 + f) = 2 atanh s = 2 s + 2 s^3 P(s^2) = f - (h - s (h + 2 s^2 P(s^2)))
 *
 * The last form holds f, which is exact, apart from what is rounded. `further` is added to n. */
static inline double imki_ln_of_normal(double x, double further)
{
    const uint64_t root_half = UINT64_C(0x3fe6a09e667f3bcd), fraction = (UINT64_C(1) << 52) - 1;
    const uint64_t bias = 1023, integers = UINT64_C(0x4330000000000000); /* bits of 2^52 */
    uint64_t bits, exponent_bits;
    double mantissa, exponent;
    memcpy(&bits, &x, sizeof bits);
    const uint64_t offset = bits - root_half + (bias << 52);
    exponent_bits = (offset >> 52) | integers;
    bits = (offset & fraction) + root_half;
    memcpy(&mantissa, &bits, sizeof mantissa);
    memcpy(&exponent, &exponent_bits, sizeof exponent);
    const double n = exponent - (0x1p52 + 1023) + further;
    const double f = mantissa - 1.0;
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
    const imki_precise sum = imki_ordered_sum_of(n * imki_ln2_high, f);
    return sum.high + (sum.low + (n * imki_ln2_low - tail));
}

#endif
