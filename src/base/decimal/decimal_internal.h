/* SPDX-License-Identifier: Apache-2.0 */
/* What reading and writing decimal numbers share: the table of powers of ten, 64 x 128 bit
 * products, and exact comparison by big integers. */
#ifndef IMUKIT_DECIMAL_INTERNAL_H
#define IMUKIT_DECIMAL_INTERNAL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

enum { IMKI_POWER_FIRST = -342, IMKI_POWER_LAST = 341, IMKI_POWER_EXACT_LAST = 55 };

/* 10^e = (high 2^64 + low + r) 2^(floor(log2 10^e) - 127), 0 <= r < 1, the top bit of high set. */
typedef struct imki_decimal_power {
    uint64_t high, low;
} imki_decimal_power;

extern const imki_decimal_power imki_decimal_powers[IMKI_POWER_LAST - IMKI_POWER_FIRST + 1];

static inline bool imki_power_is_exact(int exponent)
{
    return exponent >= 0 && exponent <= IMKI_POWER_EXACT_LAST;
}

/* floor(log2(10^e)) for the exponents of the table (proved by its script). */
static inline int imki_floor_log2_power(int exponent)
{
    return ((exponent * 217706 + (2048 << 16)) >> 16) - 2048;
}

/* high 2^64 + low = a b */
static inline uint64_t imki_multiply(uint64_t a, uint64_t b, uint64_t *low)
{
#ifdef __SIZEOF_INT128__
    __extension__ typedef unsigned __int128 wide;
    const wide product = (wide)a * b;
    *low = (uint64_t)product;
    return (uint64_t)(product >> 64);
#else
    const uint64_t a0 = (uint32_t)a, a1 = a >> 32, b0 = (uint32_t)b, b1 = b >> 32;
    const uint64_t p00 = a0 * b0, p01 = a0 * b1, p10 = a1 * b0, p11 = a1 * b1;
    const uint64_t middle = (p00 >> 32) + (uint32_t)p01 + (uint32_t)p10;
    *low = middle << 32 | (uint32_t)p00;
    return p11 + (p01 >> 32) + (p10 >> 32) + (middle >> 32);
#endif
}

/* A number of 192 bits, most significant word first. */
typedef struct imki_triple {
    uint64_t high, middle, low;
} imki_triple;

static inline imki_triple imki_multiply_power(uint64_t factor, imki_decimal_power power)
{
    imki_triple product;
    uint64_t carry_in;
    product.high = imki_multiply(factor, power.high, &product.middle);
    carry_in = imki_multiply(factor, power.low, &product.low);
    product.middle += carry_in;
    product.high += product.middle < carry_in;
    return product;
}

/* How a truncated product rounds to an integer. */
typedef enum imki_rounding {
    IMKI_ROUND_DOWN,
    IMKI_ROUND_UP,
    IMKI_ROUND_UNKNOWN /* the truncated bits do not tell: compare exactly */
} imki_rounding;

/* Drop the lowest `drop` of the upper 128 bits of a product, 66 <= drop <= 128, and say how the
 * rest rounds, ties to even. `exact`: the factor from the table was exact; otherwise the true
 * product lies strictly above the truncated one, by less than 2 units of `middle`.
 *
 * So when the dropped part is at least one half, the true one is above it; when it is at most one
 * half less two units, the true one is below; between, only an exact comparison can tell. */
static inline uint64_t imki_truncate(imki_triple product, int drop, bool exact,
                                     imki_rounding *rounding)
{
    const int shift = drop - 64;
    const uint64_t kept = shift < 64 ? product.high >> shift : 0;
    const uint64_t rest = shift < 64 ? product.high & ((UINT64_C(1) << shift) - 1) : product.high;
    const uint64_t half = UINT64_C(1) << (shift - 1);
    if (rest >= half) {
        const bool tie = exact && rest == half && product.middle == 0 && product.low == 0;
        *rounding = tie && (kept & 1) == 0 ? IMKI_ROUND_DOWN : IMKI_ROUND_UP;
    } else if (!exact && rest == half - 1 && product.middle == UINT64_MAX) {
        *rounding = IMKI_ROUND_UNKNOWN;
    } else {
        *rounding = IMKI_ROUND_DOWN;
    }
    return kept;
}

static inline double imki_double_from_bits(uint64_t bits)
{
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static inline uint64_t imki_bits_from_double(double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

/* Natural number of up to 3584 bits. The largest used is about 2^2750: 800 digits, or an odd 54-bit
 * number times 5^1142 (800 digits at the smallest double), scaled to equal size. */
enum { IMKI_BIG_LIMBS = 112 };

typedef struct imki_big {
    int count;                     /* limbs in use; 0 for zero */
    uint32_t limb[IMKI_BIG_LIMBS]; /* least significant first */
} imki_big;

void imki_big_set(imki_big *big, uint64_t value);
void imki_big_multiply_add(imki_big *big, uint32_t factor, uint32_t addend);
void imki_big_multiply_power_of_five(imki_big *big, int exponent);
void imki_big_shift_left(imki_big *big, int bits);
/* Divide by 10^9; returns the remainder. */
uint32_t imki_big_divide_by_billion(imki_big *big);

/* Sign of  a 2^a_binary 10^a_decimal - b 2^b_binary;  a and b are overwritten. */
int imki_big_compare_scaled(imki_big *a, int a_binary, int a_decimal, imki_big *b, int b_binary);

#endif
