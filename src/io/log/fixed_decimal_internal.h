/* SPDX-License-Identifier: Apache-2.0 */
/* Numbers with a fixed number of decimals, inlined into the writer's loop: the same text as
 * imk_decimal_fixed(), which takes over for what is not usual (large, not finite, many decimals).
 *
 * The signs and magnitudes of noise cannot be predicted, so the usual way has no branch on them:
 *
 *     n = round(|x| 10^d),  |x| = m 2^-s:  m 10^d < 2^107 is exact in 128 bits, and adding
 *     half - 1 + (the bit that becomes the last) before the shift rounds ties to even;
 *     the digits before the point are those of floor(|x|), plus one if the rest rounds up to 10^d;
 *     the others are 8 or 16 digits made at once, of which d are kept. */
#ifndef IMUKIT_FIXED_DECIMAL_INTERNAL_H
#define IMUKIT_FIXED_DECIMAL_INTERNAL_H

#include "imukit/decimal.h"

#include <stdbool.h>
#include <string.h>

typedef struct imki_fixed_decimal {
    int decimals;
    uint64_t unit;    /* 10^decimals */
    uint64_t padding; /* 10^(8 - decimals), or 10^(16 - decimals) for more than 8 */
    double limit;     /* the usual way is for |x| < limit; 0 when it is not possible */
} imki_fixed_decimal;

/* Bytes that may be written behind the text. */
enum { IMKI_FIXED_SLACK = 16 };

static inline imki_fixed_decimal imki_fixed_decimal_of(int decimals)
{
    imki_fixed_decimal format = {.decimals = decimals, .unit = 1, .padding = 1};
    for (int i = 0; i < decimals; i++)
        format.unit *= 10;
    for (int i = decimals; i < (decimals <= 8 ? 8 : 16); i++)
        format.padding *= 10;
#if defined(__SIZEOF_INT128__) && __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__
    /* floor(|x|) has at most 8 digits, and n < 2^63. */
    if (decimals <= 16)
        format.limit = decimals <= 10 ? 99999999.0 : 9.0e18 / (double)format.unit;
#endif
    return format;
}

#if defined(__SIZEOF_INT128__) && __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__

/* The 8 digits of value < 10^8, one in each byte, the first in the lowest.
 *
 * Halves, quarters and eighths are split in parallel by multiplication: 10486 / 2^20 is 1/100 for
 * numbers < 10000, rounded down rightly, and 103 / 2^10 is 1/10 for numbers < 100. */
static inline uint64_t imki_eight_digits(uint64_t value)
{
    const uint64_t high = value / 10000;
    const uint64_t fours = high | (value - 10000 * high) << 32;
    const uint64_t hundreds = fours * 10486 >> 20 & UINT64_C(0x0000007F0000007F);
    const uint64_t twos = hundreds | (fours - 100 * hundreds) << 16;
    const uint64_t tens = twos * 103 >> 10 & UINT64_C(0x000F000F000F000F);
    return tens | (twos - 10 * tens) << 8;
}

static inline void imki_put_digits(char *text, uint64_t digits)
{
    digits |= UINT64_C(0x3030303030303030);
    memcpy(text, &digits, sizeof digits);
}

/* |x| 10^d rounded to an integer, ties to even. */
static inline uint64_t imki_scale_and_round(uint64_t bits, uint64_t unit)
{
    __extension__ typedef unsigned __int128 wide;
    const int biased = (int)(bits >> 52 & 0x7FF);
    const uint64_t significand = (bits & ((UINT64_C(1) << 52) - 1)) | (uint64_t)(biased > 0) << 52;
    /* |x| = significand 2^-shift; beyond 2^-108 nothing is left, so the shift may stop there */
    int shift = 1075 - biased;
    shift = shift < 120 ? shift : 120;
    const wide product = (wide)significand * unit;
    const wide half_less_one = ((wide)1 << (shift - 1)) - 1;
    return (uint64_t)((product + half_less_one + (product >> shift & 1)) >> shift);
}

#endif

/* Write x; up to IMKI_FIXED_SLACK bytes behind the text may be changed. @return end of the text */
static inline char *imki_fixed_decimal_write(const imki_fixed_decimal *format, double x, char *text)
{
#if defined(__SIZEOF_INT128__) && __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    const bool negative = bits >> 63 != 0;
    const double size = negative ? -x : x;
    if (size < format->limit) {
        uint64_t whole = (uint64_t)(int64_t)size;
        uint64_t rest = imki_scale_and_round(bits, format->unit) - whole * format->unit;
        if (rest == format->unit) {
            whole++;
            rest = 0;
        }
        *text = '-';
        text += negative;
        if (whole < 10) {
            *text++ = (char)('0' + whole);
        } else {
            const uint64_t digits = imki_eight_digits(whole);
            const int zeros = __builtin_ctzll(digits) >> 3;
            imki_put_digits(text, digits >> 8 * zeros);
            text += 8 - zeros;
        }
        if (format->decimals == 0)
            return text;
        *text++ = '.';
        rest *= format->padding;
        if (format->decimals <= 8) {
            imki_put_digits(text, imki_eight_digits(rest));
        } else {
            const uint64_t high = rest / 100000000;
            imki_put_digits(text, imki_eight_digits(high));
            imki_put_digits(text + 8, imki_eight_digits(rest - 100000000 * high));
        }
        return text + format->decimals;
    }
#endif
    return text + imk_decimal_fixed(x, format->decimals, text);
}

#endif
