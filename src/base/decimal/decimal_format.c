/* SPDX-License-Identifier: Apache-2.0 */
/* Double to decimal text.
 *
 * Shortest: the interval of decimals that read back to the same double, scaled by a power of ten so
 * that it is about one unit wide, holds one or few integers; the method of [GIULIETTI2020].
 * Fixed and significant: an integer of the wanted digits by exact or interval arithmetic, rounded
 * to even on ties; big integers where 128 bits do not decide. */
#include "imukit/decimal.h"

#include "decimal_internal.h"

#define PAIRS_OF(tens)                                                                             \
    tens "0" tens "1" tens "2" tens "3" tens "4" tens "5" tens "6" tens "7" tens "8" tens "9"
static const char pairs[201] = PAIRS_OF("0") PAIRS_OF("1") PAIRS_OF("2") PAIRS_OF("3") PAIRS_OF("4")
    PAIRS_OF("5") PAIRS_OF("6") PAIRS_OF("7") PAIRS_OF("8") PAIRS_OF("9");

static const uint64_t integer_power[20] = {UINT64_C(1),
                                           UINT64_C(10),
                                           UINT64_C(100),
                                           UINT64_C(1000),
                                           UINT64_C(10000),
                                           UINT64_C(100000),
                                           UINT64_C(1000000),
                                           UINT64_C(10000000),
                                           UINT64_C(100000000),
                                           UINT64_C(1000000000),
                                           UINT64_C(10000000000),
                                           UINT64_C(100000000000),
                                           UINT64_C(1000000000000),
                                           UINT64_C(10000000000000),
                                           UINT64_C(100000000000000),
                                           UINT64_C(1000000000000000),
                                           UINT64_C(10000000000000000),
                                           UINT64_C(100000000000000000),
                                           UINT64_C(1000000000000000000),
                                           UINT64_C(10000000000000000000)};

/* A finite double as significand 2^exponent. */
typedef struct parts {
    uint64_t significand;
    int exponent;
    bool negative;
} parts;

static inline parts take_apart(double value)
{
    const uint64_t bits = imki_bits_from_double(value);
    const int biased = (int)(bits >> 52 & 0x7FF);
    const uint64_t fraction = bits & ((UINT64_C(1) << 52) - 1);
    const uint64_t implied = (uint64_t)(biased > 0) << 52;
    return (parts){fraction | implied, (biased > 0 ? biased : 1) - 1075, bits >> 63 != 0};
}

static inline bool is_finite(double value)
{
    return (imki_bits_from_double(value) >> 52 & 0x7FF) != 0x7FF;
}

static size_t write_not_finite(double value, char *text)
{
    const char *name = value != value ? "nan" : value > 0.0 ? "inf" : "-inf";
    const size_t length = strlen(name);
    memcpy(text, name, length + 1);
    return length;
}

static inline int count_digits(uint64_t value)
{
    /* 1233/4096 is just above log10(2): the guess is right or one too many. */
    const int bits = 64 - __builtin_clzll(value | 1);
    const int guess = bits * 1233 >> 12;
    return guess + (value >= integer_power[guess]) + (guess == 0 && value == 0);
}

static inline void write_pair(char *text, uint32_t value)
{
    memcpy(text, pairs + (size_t)2 * value, 2);
}

/* Exactly `count` digits, zeros in front: eight at a time, whose four pairs do not wait for one
 * another, then the rest. */
static inline char *write_digits(char *text, uint64_t value, int count)
{
    char *p = text + count;
    while (p - text >= 8) {
        const uint32_t eight = (uint32_t)(value % 100000000), upper = eight / 10000;
        const uint32_t lower = eight % 10000;
        value /= 100000000;
        p -= 8;
        write_pair(p, upper / 100);
        write_pair(p + 2, upper % 100);
        write_pair(p + 4, lower / 100);
        write_pair(p + 6, lower % 100);
    }
    uint32_t rest = (uint32_t)value;
    while (p - text >= 2) {
        p -= 2;
        write_pair(p, rest % 100);
        rest /= 100;
    }
    if (p > text)
        *text = (char)('0' + rest % 10);
    return text + count;
}

static inline char *write_integer(char *text, uint64_t value)
{
    return write_digits(text, value, count_digits(value));
}

/* ------------------------------------------------------------------------------------ fixed */

/* All digits of significand 2^exponent, an integer of up to 309 digits. */
static char *write_big_integer(char *text, uint64_t significand, int exponent)
{
    imki_big big;
    imki_big_set(&big, significand);
    imki_big_shift_left(&big, exponent);
    uint32_t group[36];
    int count = 0;
    do
        group[count++] = imki_big_divide_by_billion(&big);
    while (big.count > 0);
    text = write_integer(text, group[--count]);
    while (count > 0)
        text = write_digits(text, group[--count], 9);
    return text;
}

/* high 2^64 + low divided by 2^shift, ties to even; needs the result below 2^64 in *low, returns
 * what is above. */
static inline uint64_t shift_and_round(uint64_t high, uint64_t *low, int shift)
{
    uint64_t kept_high, kept, rest, rest_below, half;
    if (shift >= 128) {
        *low = 0; /* the number is below 2^110: less than half */
        return 0;
    }
    if (shift >= 65) {
        kept_high = 0;
        kept = high >> (shift - 64);
        rest = high & ((UINT64_C(1) << (shift - 64)) - 1);
        rest_below = *low;
        half = UINT64_C(1) << (shift - 65);
    } else if (shift == 64) {
        kept_high = 0;
        kept = high;
        rest = *low;
        rest_below = 0;
        half = UINT64_C(1) << 63;
    } else {
        kept_high = high >> shift;
        kept = *low >> shift | high << (64 - shift);
        rest = *low & ((UINT64_C(1) << shift) - 1);
        rest_below = 0;
        half = UINT64_C(1) << (shift - 1);
    }
    const bool up = rest > half || (rest == half && (rest_below != 0 || (kept & 1) != 0));
    kept += up;
    *low = kept;
    return kept_high + (up && kept == 0);
}

/* Digits of high 2^64 + low < 10^38, divided into those before and the `decimals` after the point.
 */
static char *write_wide_fixed(char *text, uint64_t high, uint64_t low, int decimals)
{
    uint32_t limb[4] = {(uint32_t)low, (uint32_t)(low >> 32), (uint32_t)high,
                        (uint32_t)(high >> 32)};
    char digits[45];
    for (int group = 4; group >= 0; group--) {
        uint64_t remainder = 0;
        for (int i = 3; i >= 0; i--) {
            remainder = remainder << 32 | limb[i];
            limb[i] = (uint32_t)(remainder / 1000000000);
            remainder %= 1000000000;
        }
        write_digits(digits + 9 * group, remainder, 9);
    }
    int first = 0;
    while (digits[first] == '0' && first < 44 - decimals)
        first++;
    const int before = 45 - decimals - first;
    memcpy(text, digits + first, (size_t)before);
    text += before;
    if (decimals > 0) {
        *text++ = '.';
        memcpy(text, digits + 45 - decimals, (size_t)decimals);
        text += decimals;
    }
    return text;
}

size_t imk_decimal_fixed(double value, int decimals, char *text)
{
    if (!is_finite(value))
        return write_not_finite(value, text);
    decimals = decimals < 0 ? 0 : decimals > 17 ? 17 : decimals;
    const parts x = take_apart(value);
    char *p = text;
    if (x.negative)
        *p++ = '-';
    if (x.exponent >= 0) {
        p = write_big_integer(p, x.significand, x.exponent);
        if (decimals > 0)
            *p++ = '.';
        for (int i = 0; i < decimals; i++)
            *p++ = '0';
    } else {
        /* |x| 10^decimals = significand 10^decimals 2^exponent < 2^110: exact */
        uint64_t low;
        uint64_t high = imki_multiply(x.significand, integer_power[decimals], &low);
        high = shift_and_round(high, &low, -x.exponent);
        if (high == 0) {
            const uint64_t whole = low / integer_power[decimals];
            p = write_integer(p, whole);
            if (decimals > 0) {
                *p++ = '.';
                p = write_digits(p, low - whole * integer_power[decimals], decimals);
            }
        } else {
            p = write_wide_fixed(p, high, low, decimals);
        }
    }
    *p = '\0';
    return (size_t)(p - text);
}

/* ------------------------------------------------------------------------------ decimal form */

/* floor(log10(2^exponent) - less / 2^22). 1262611/2^22 is log10(2) and 524031/2^22 is -log10(3/4),
 * near enough for |exponent| <= 1500 [GIULIETTI2020]. The offset 512 avoids shifting negatives. */
static inline int floor_log10(int exponent, int less)
{
    return (int)((exponent * INT64_C(1262611) - less + (INT64_C(512) << 22)) >> 22) - 512;
}

/* value = digits 10^exponent */
typedef struct decimal {
    uint64_t digits;
    int exponent;
} decimal;

static inline decimal without_trailing_zeros(decimal d)
{
    if (d.digits % 10 != 0) /* nearly always */
        return d;
    while (d.digits % 10000 == 0) {
        d.digits /= 10000;
        d.exponent += 4;
    }
    while (d.digits % 10 == 0) {
        d.digits /= 10;
        d.exponent++;
    }
    return d;
}

/* Digits with a point and no exponent; d has no trailing zeros. */
static char *write_positional(char *text, decimal d)
{
    const int count = count_digits(d.digits);
    const int whole = count + d.exponent; /* digits before the point */
    if (d.exponent >= 0) {
        text = write_digits(text, d.digits, count);
        memset(text, '0', (size_t)d.exponent);
        return text + d.exponent;
    }
    if (whole > 0) {
        write_digits(text + 1, d.digits, count);
        text[0] = text[1]; /* most numbers have one digit there: no call for it */
        if (whole > 1)
            memmove(text + 1, text + 2, (size_t)whole - 1);
        text[whole] = '.';
        return text + count + 1;
    }
    memcpy(text, "0.0000000", 8); /* whole >= -5: the zeros in front, and room for more digits */
    return write_digits(text + 2 - whole, d.digits, count);
}

/* d.ddde-7; `style` as printf: a sign always, two digits at least. d has no trailing zeros. */
static char *write_scientific(char *text, decimal d, bool printf_style)
{
    const int count = count_digits(d.digits);
    write_digits(text + 1, d.digits, count);
    text[0] = text[1];
    text[1] = '.';
    text += count > 1 ? count + 1 : 1;
    const int exponent = d.exponent + count - 1;
    const uint32_t size = (uint32_t)(exponent < 0 ? -exponent : exponent);
    *text++ = 'e';
    if (exponent < 0 || printf_style)
        *text++ = exponent < 0 ? '-' : '+';
    const int exponent_digits = count_digits(size);
    return write_digits(text, size, printf_style && exponent_digits < 2 ? 2 : exponent_digits);
}

/* --------------------------------------------------------------------------------- shortest */

/* Upper bits of factor 10^e, with the lowest bit set when something but rounding error follows. */
static inline uint64_t round_to_odd(uint64_t factor, imki_decimal_power power)
{
    uint64_t low_low, middle;
    const uint64_t carry = imki_multiply(factor, power.low, &low_low);
    uint64_t high = imki_multiply(factor, power.high, &middle);
    middle += carry;
    high += middle < carry;
    return high | (middle > 1);
}

/* The shortest decimal in the rounding interval of significand 2^exponent, and the nearest of
 * those.
 *
 * All bounds are held times four as integers with a sticky bit: the interval reaches from the
 * midpoint below (a quarter unit nearer at a power of two) to the one above, ends included when the
 * significand is even, since reading rounds ties to even. */
static decimal shortest(parts x)
{
    const bool even = (x.significand & 1) == 0;
    const bool irregular = x.significand == UINT64_C(1) << 52 && x.exponent > -1074;
    const uint64_t centre = 4 * x.significand;
    /* k = floor(log10(2^q)), or of 3/4 2^q: then the interval is at least one unit 10^k wide. */
    const int k = floor_log10(x.exponent, irregular ? 524031 : 0);
    const int shift = x.exponent + imki_floor_log2_power(-k) + 1;
    imki_decimal_power power = imki_decimal_powers[-k - IMKI_POWER_FIRST];
    if (!imki_power_is_exact(-k)) {
        power.low++;
        power.high += power.low == 0;
    }
    const uint64_t value = round_to_odd(centre << shift, power);
    const uint64_t lower =
        round_to_odd((centre - (irregular ? 1 : 2)) << shift, power) + (even ? 0 : 1);
    const uint64_t upper = round_to_odd((centre + 2) << shift, power) - (even ? 0 : 1);
    const uint64_t unit = value / 4;
    if (unit >= 10) {
        const uint64_t ten = unit / 10;
        const bool down = lower <= 40 * ten, up = 40 * ten + 40 <= upper;
        if (down != up)
            return (decimal){ten + up, k + 1};
    }
    const bool down = lower <= 4 * unit, up = 4 * unit + 4 <= upper;
    if (down != up)
        return (decimal){unit + up, k};
    const uint64_t middle = 4 * unit + 2;
    const bool round_up = value > middle || (value == middle && (unit & 1) != 0);
    return (decimal){unit + round_up, k};
}

size_t imk_decimal_shortest(double value, char *text)
{
    if (!is_finite(value))
        return write_not_finite(value, text);
    const parts x = take_apart(value);
    char *p = text;
    if (x.negative)
        *p++ = '-';
    if (x.significand == 0) {
        *p++ = '0';
    } else {
        const decimal d = without_trailing_zeros(shortest(x));
        const int leading = d.exponent + count_digits(d.digits); /* 10^(leading-1) <= |x| */
        p = leading >= -4 && leading <= 16 ? write_positional(p, d) : write_scientific(p, d, false);
    }
    *p = '\0';
    return (size_t)(p - text);
}

/* ------------------------------------------------------------------------------ significant */

/* Is significand 2^exponent above (digits + 1/2) 10^power, or equal to it with digits odd? */
static bool rounds_up_exactly(parts x, uint64_t digits, int power)
{
    imki_big number, midpoint;
    imki_big_set(&number, x.significand);
    imki_big_set(&midpoint, 2 * digits + 1);
    /* number 2^exponent 10^-power against midpoint / 2 */
    const int order = imki_big_compare_scaled(&number, x.exponent, -power, &midpoint, -1);
    return order > 0 || (order == 0 && (digits & 1) != 0);
}

/* x rounded to `count` significant digits, ties to even. */
static decimal significant(parts x, int count)
{
    const int zeros = __builtin_clzll(x.significand);
    const int binary = 63 - zeros + x.exponent; /* 2^binary <= x */
    /* The exponent of the first digit is that of 2^binary or one more. */
    int power = floor_log10(binary, 0) - (count - 1);
    for (;; power++) {
        /* x 10^-power as a 192-bit product of which the lowest `drop` + 64 are below the point */
        const imki_triple product = imki_multiply_power(
            x.significand << zeros, imki_decimal_powers[-power - IMKI_POWER_FIRST]);
        const int drop = 63 - (x.exponent - zeros + imki_floor_log2_power(-power));
        imki_rounding rounding;
        uint64_t digits = imki_truncate(product, drop, imki_power_is_exact(-power), &rounding);
        if (digits >= integer_power[count])
            continue;
        if (rounding == IMKI_ROUND_UNKNOWN)
            digits += rounds_up_exactly(x, digits, power);
        else
            digits += rounding == IMKI_ROUND_UP;
        return (decimal){digits, power};
    }
}

size_t imk_decimal_significant(double value, int digits, char *text)
{
    if (!is_finite(value))
        return write_not_finite(value, text);
    digits = digits < 1 ? 1 : digits > 17 ? 17 : digits;
    const parts x = take_apart(value);
    char *p = text;
    if (x.negative)
        *p++ = '-';
    if (x.significand == 0) {
        *p++ = '0';
    } else {
        const decimal d = without_trailing_zeros(significant(x, digits));
        const int leading = d.exponent + count_digits(d.digits) - 1;
        p = leading >= -4 && leading < digits ? write_positional(p, d)
                                              : write_scientific(p, d, true);
    }
    *p = '\0';
    return (size_t)(p - text);
}
