/* SPDX-License-Identifier: Apache-2.0 */
/* Decimal text to the nearest double, ties to even, exactly:
 *
 *     value = +-w 10^e,  w the first 19 significant digits
 *
 * 1. w < 2^53 and |e| <= 22: w and 10^|e| are doubles, so one correctly rounded operation is exact
 *    [CLINGER1990].
 * 2. Otherwise w times the 128-bit power of ten decides nearly always [LEMIRE2021]; here the
 *    truncated product carries an interval, and rounding is accepted when its ends agree.
 * 3. The rest is compared with the midpoint of two neighbouring doubles by big integers. A midpoint
 *    has at most 767 significant digits, so of more than 800 only "something follows" matters. */
#include "imukit/decimal.h"

#include "decimal_internal.h"

enum { WORD_DIGITS = 19, DIGITS_MAX = 800 };

static const double small_power[23] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                       1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                       1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};

/* The digits of a number as they stand in the text. */
typedef struct digits {
    const char *first, *last; /* first significant digit; behind the last one, a point between */
    int64_t count;            /* significant digits */
    int64_t exponent;         /* of the last digit */
    uint64_t word;            /* the first (at most 19) digits */
} digits;

static inline bool is_digit(char c)
{
    return (unsigned char)(c - '0') <= 9;
}

/* Eight digits at once, side by side in a word; false when they are not all digits. */
static inline bool join_eight(const char *text, uint64_t *joined)
{
    uint64_t x;
    memcpy(&x, text, sizeof x);
#if defined(__BYTE_ORDER__) && __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__
    x = __builtin_bswap64(x);
#endif
    x ^= UINT64_C(0x3030303030303030);
    if (((x + UINT64_C(0x7676767676767676)) | x) & UINT64_C(0x8080808080808080))
        return false;
    x = x * 10 + (x >> 8); /* pairs, in every second byte */
    x = (x & UINT64_C(0x000000FF000000FF)) * UINT64_C(0x000F424000000064) +
        (x >> 16 & UINT64_C(0x000000FF000000FF)) * UINT64_C(0x0000271000000001);
    *joined = x >> 32;
    return true;
}

/* Add the digits at `text` to the word until 19 are in it; count them all. */
static const char *scan_digits(const char *text, const char *end, digits *d)
{
    uint64_t word = d->word, eight;
    int64_t count = d->count;
    if (count == 0) {
        while (text < end && *text == '0')
            text++;
        d->first = text;
    }
    while (end - text >= 8 && count <= WORD_DIGITS - 8 && join_eight(text, &eight)) {
        word = word * 100000000 + eight;
        count += 8;
        text += 8;
    }
    for (; text < end && is_digit(*text); text++) {
        if (count < WORD_DIGITS)
            word = word * 10 + (uint64_t)(*text - '0');
        count++;
    }
    d->word = word;
    d->count = count;
    return text;
}

/* Exponent behind the digits; `text` when there is none. Saturates far outside any double. */
static const char *scan_exponent(const char *text, const char *end, int64_t *exponent)
{
    const char *p = text;
    if (p == end || (*p | 0x20) != 'e')
        return text;
    p++;
    const bool negative = p < end && *p == '-';
    if (p < end && (*p == '-' || *p == '+'))
        p++;
    if (p == end || !is_digit(*p))
        return text;
    int64_t value = 0;
    for (; p < end && is_digit(*p); p++)
        if (value < INT64_C(1000000000000000))
            value = value * 10 + (*p - '0');
    *exponent += negative ? -value : value;
    return p;
}

/* A result of the truncated product: the double's bits when decided, else those of the double
 * below the midpoint it may lie on either side of. */
typedef struct approximation {
    uint64_t bits;
    bool decided;
} approximation;

static const uint64_t infinity_bits = UINT64_C(0x7FF0000000000000);

static approximation approximate(uint64_t word, int exponent)
{
    const int zeros = __builtin_clzll(word);
    const bool exact = imki_power_is_exact(exponent);
    const imki_triple product =
        imki_multiply_power(word << zeros, imki_decimal_powers[exponent - IMKI_POWER_FIRST]);
    /* The product's top bit stands for 2^(biased - 1023). Keep 53 bits, fewer below 2^-1022. */
    const int top = (int)(product.high >> 63);
    int biased = 1023 + 63 + top - zeros + imki_floor_log2_power(exponent);
    int drop = 74 + top;
    if (biased < 1) {
        drop += 1 - biased;
        biased = 1;
    }
    if (biased >= 2047)
        return (approximation){infinity_bits, true};
    if (drop > 128)
        return (approximation){0, true};
    imki_rounding rounding;
    const uint64_t kept = imki_truncate(product, drop, exact, &rounding);
    /* The implied bit adds the missing one to the exponent; a carry out of the significand too. */
    const uint64_t bits = ((uint64_t)(biased - 1) << 52) + kept + (rounding == IMKI_ROUND_UP);
    return (approximation){bits, rounding != IMKI_ROUND_UNKNOWN};
}

/* Decide between the double `bits` and the next one by comparing with their midpoint. */
static uint64_t compare_with_midpoint(const digits *d, uint64_t bits)
{
    imki_big decimal, midpoint;
    imki_big_set(&decimal, 0);
    int64_t taken = 0;
    uint32_t group = 0, factor = 1;
    const char *p = d->first;
    for (; taken < d->count && taken < DIGITS_MAX; p++) {
        if (*p == '.')
            continue;
        group = group * 10 + (uint32_t)(*p - '0');
        factor *= 10;
        taken++;
        if (factor == 1000000000) {
            imki_big_multiply_add(&decimal, factor, group);
            group = 0;
            factor = 1;
        }
    }
    imki_big_multiply_add(&decimal, factor, group);
    bool more = false;
    for (; p < d->last && !more; p++)
        more = *p != '0' && *p != '.';
    /* midpoint = (2 m + 1) 2^(q - 1) for the double m 2^q */
    const int biased = (int)(bits >> 52);
    const uint64_t fraction = bits & ((UINT64_C(1) << 52) - 1);
    const uint64_t significand = biased > 0 ? fraction | UINT64_C(1) << 52 : fraction;
    imki_big_set(&midpoint, 2 * significand + 1);
    const int order = imki_big_compare_scaled(&decimal, 0, (int)(d->exponent + d->count - taken),
                                              &midpoint, (biased > 0 ? biased : 1) - 1076);
    const bool up = order > 0 || (order == 0 && (more || (bits & 1) != 0));
    return bits + up;
}

static uint64_t round_digits(const digits *d)
{
    const int64_t word_digits = d->count < WORD_DIGITS ? d->count : WORD_DIGITS;
    const int64_t exponent = d->exponent + d->count - word_digits;
    /* w < 10^19: below 10^-342 it is less than half the smallest double; above 10^308 too large */
    if (d->word == 0 || exponent < IMKI_POWER_FIRST)
        return 0;
    if (exponent > 308)
        return infinity_bits;
    const approximation below = approximate(d->word, (int)exponent);
    if (d->count <= WORD_DIGITS)
        return below.decided ? below.bits : compare_with_midpoint(d, below.bits);
    const approximation above = approximate(d->word + 1, (int)exponent);
    if (below.decided && above.decided && below.bits == above.bits)
        return below.bits;
    return compare_with_midpoint(d, below.decided && !above.decided ? above.bits : below.bits);
}

static bool matches(const char *text, const char *end, const char *word)
{
    for (; *word; word++, text++)
        if (text >= end || (*text | 0x20) != *word)
            return false;
    return true;
}

static const char *parse_name(const char *text, const char *end, bool negative, double *value)
{
    uint64_t bits;
    size_t length;
    if (matches(text, end, "nan")) {
        bits = UINT64_C(0x7FF8000000000000);
        length = 3;
    } else if (matches(text, end, "inf")) {
        bits = infinity_bits;
        length = matches(text, end, "infinity") ? 8 : 3;
    } else {
        return NULL;
    }
    *value = imki_double_from_bits(bits | (uint64_t)negative << 63);
    return text + length;
}

const char *imk_decimal_parse(const char *begin, const char *end, double *value)
{
    const char *p = begin;
    const bool negative = p < end && *p == '-';
    if (p < end && (*p == '-' || *p == '+'))
        p++;
    digits d = {0};
    const char *integer = p;
    p = scan_digits(p, end, &d);
    int64_t read = p - integer;
    if (p < end && *p == '.') {
        const char *fraction = p + 1;
        const char *after = scan_digits(fraction, end, &d);
        d.exponent = -(after - fraction);
        read += after - fraction;
        if (read > 0)
            p = after;
    }
    if (read == 0) {
        const char *name_end = parse_name(p, end, negative, value);
        return name_end ? name_end : begin;
    }
    d.last = p;
    p = scan_exponent(p, end, &d.exponent);
    const uint64_t sign = (uint64_t)negative << 63;
    if (d.count <= WORD_DIGITS && d.word >> 53 == 0 && d.exponent >= -22 && d.exponent <= 22) {
        const double word = (double)d.word;
        const double size =
            d.exponent < 0 ? word / small_power[-d.exponent] : word * small_power[d.exponent];
        *value = negative ? -size : size;
    } else {
        *value = imki_double_from_bits(round_digits(&d) | sign);
    }
    return p;
}
