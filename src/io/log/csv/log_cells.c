/* SPDX-License-Identifier: Apache-2.0 */
/* Plain CSV rows to numbers with any processor, and the choice of instruction set.
 *
 * The 16 bytes before the end of a cell are loaded, what is not the cell's is masked out, the
 * decimal point is found and taken out by shifting what stands before it, and the up to 16 digits
 * become one integer in seven multiplications (pairs, fours and eights of digits side by side in a
 * word):
 *
 *     "-0.00666,"  ->  0000000000000666, 5 decimals  ->  -(666 / 10^5)
 *
 * An integer below 2^53 divided by a power of ten below 10^22 is the nearest double: both are exact
 * and the division rounds once [CLINGER1990]. Longer numbers, exponents and the like go to
 * imk_decimal_parse(). */
#include "imukit/decimal.h"
#include "log_cells_internal.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#ifdef __SSE2__
#include <emmintrin.h>
#endif

enum { WIDE = 16 }; /* bytes of a cell that are loaded */

#define ALL(byte) (UINT64_C(0x0101010101010101) * (byte))

static inline uint64_t load_word(const char *text)
{
    uint64_t word;
    memcpy(&word, text, sizeof word);
#if defined(__BYTE_ORDER__) && __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__
    word = __builtin_bswap64(word);
#endif
    return word;
}

/* A bit for each of 64 bytes that is the separator or a newline. */
static inline uint64_t mark_ends(const char *text, char separator)
{
    uint64_t marks = 0;
#ifdef __SSE2__
    const __m128i wanted = _mm_set1_epi8(separator), newline = _mm_set1_epi8('\n');
    for (int i = 0; i < 4; i++) {
        const __m128i bytes = _mm_loadu_si128((const __m128i *)(const void *)(text + 16 * i));
        const __m128i hit =
            _mm_or_si128(_mm_cmpeq_epi8(bytes, wanted), _mm_cmpeq_epi8(bytes, newline));
        marks |= (uint64_t)(uint32_t)_mm_movemask_epi8(hit) << 16 * i;
    }
#else
    for (int i = 0; i < 8; i++) {
        const uint64_t word = load_word(text + 8 * i);
        const uint64_t a = word ^ ALL((uint64_t)(unsigned char)separator);
        const uint64_t b = word ^ ALL((uint64_t)'\n');
        /* the top bit of each byte that is zero, exactly */
        const uint64_t hit = ~(((a & ALL(0x7FU)) + ALL(0x7FU)) | a | ALL(0x7FU)) |
                             ~(((b & ALL(0x7FU)) + ALL(0x7FU)) | b | ALL(0x7FU));
        marks |= ((hit >> 7) * UINT64_C(0x0102040810204080) >> 56) << 8 * i;
    }
#endif
    return marks;
}

static inline size_t count_bits(uint64_t bits)
{
    bits -= bits >> 1 & ALL(0x55U);
    bits = (bits & ALL(0x33U)) + (bits >> 2 & ALL(0x33U));
    bits = (bits + (bits >> 4)) & ALL(0x0FU);
    return (size_t)(bits * ALL(1U) >> 56);
}

typedef struct wide {
    uint64_t low, high;
} wide;

/* The first i of 16 bytes. */
#define FIRST(i)                                                                                   \
    {                                                                                              \
        (i) >= 8 ? UINT64_MAX : (UINT64_C(1) << 8 * ((i)&7)) - 1,                                  \
            (i) <= 8    ? 0                                                                        \
            : (i) == 16 ? UINT64_MAX                                                               \
                        : (UINT64_C(1) << 8 * ((i)&7)) - 1                                         \
    }
static const wide first_bytes[17] = {
    FIRST(0), FIRST(1),  FIRST(2),  FIRST(3),  FIRST(4),  FIRST(5),  FIRST(6),  FIRST(7), FIRST(8),
    FIRST(9), FIRST(10), FIRST(11), FIRST(12), FIRST(13), FIRST(14), FIRST(15), FIRST(16)};

static const double power_of_ten[16] = {1e0, 1e1, 1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                        1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15};

/* Eight digits 0 … 9, the first in the lowest byte. */
static inline uint64_t join_digits(uint64_t digits)
{
    digits = digits * 10 + (digits >> 8);
    const uint64_t even = (digits & UINT64_C(0x000000FF000000FF)) * UINT64_C(0x000F424000000064);
    const uint64_t odd =
        (digits >> 16 & UINT64_C(0x000000FF000000FF)) * UINT64_C(0x0000271000000001);
    return (even + odd) >> 32;
}

/* Top bit set in the first byte that is zero (and perhaps in later ones). */
static inline uint64_t find_zero(uint64_t word)
{
    return (word - ALL(1U)) & ~word & ALL(0x80U);
}

static inline bool read_number(const char *base, const char *begin, const char *end, double *value)
{
    const bool negative = *begin == '-';
    const char *digits = begin + negative;
    const size_t length = (size_t)(end - digits);
    if (length - 1 >= WIDE || end - base < WIDE)
        return imki_log_cell_read(begin, end, value);
    const wide other = first_bytes[WIDE - length];
    wide x = {(load_word(end - 16) ^ ALL((uint64_t)'0')) & ~other.low,
              (load_word(end - 8) ^ ALL((uint64_t)'0')) & ~other.high};
    const uint64_t point = ALL((uint64_t)('.' ^ '0'));
    const uint64_t point_low = find_zero(x.low ^ point), point_high = find_zero(x.high ^ point);
    int decimals = 0;
    if ((point_low | point_high) != 0) {
        const bool in_low = point_low != 0;
        const int place =
            (__builtin_ctzll(in_low ? point_low : point_high) >> 3) + (in_low ? 0 : 8);
        const wide before = {x.low & first_bytes[place].low, x.high & first_bytes[place].high};
        const wide upto = first_bytes[place + 1];
        x.high = (x.high & ~upto.high) | before.high << 8 | before.low >> 56;
        x.low = (x.low & ~upto.low) | before.low << 8;
        decimals = WIDE - 1 - place;
    }
    /* Any byte above 9, or a point alone? */
    const uint64_t strange =
        ((x.low + ALL(0x76U)) | x.low | (x.high + ALL(0x76U)) | x.high) & ALL(0x80U);
    const uint64_t number = join_digits(x.low) * 100000000 + join_digits(x.high);
    if (strange != 0 || number >> 53 != 0 || (length == 1 && *digits == '.'))
        return imki_log_cell_read(begin, end, value);
    const double size = (double)number / power_of_ten[decimals];
    *value = negative ? -size : size;
    return true;
}

#define KERNEL_TARGET
#include "log_cells_kernel.h"

bool imki_log_cell_read(const char *begin, const char *end, double *value)
{
    return begin < end && imk_decimal_parse(begin, end, value) == end && isfinite(*value);
}

size_t imki_log_cells_read_scalar(const imki_log_cells *cells, const char *base, const char **text,
                                  const char *end, double *const *out, size_t max_rows)
{
    return read_cells(cells, base, text, end, out, max_rows);
}

imki_log_cells_reader *imki_log_cells_choose(void)
{
    const char *requirement = getenv("IMUKIT_ISA");
    if (imki_log_cells_avx2_runs() && !(requirement && strcmp(requirement, "scalar") == 0))
        return imki_log_cells_read_avx2;
    return imki_log_cells_read_scalar;
}
