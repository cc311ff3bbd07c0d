/* SPDX-License-Identifier: Apache-2.0 */
/* Plain CSV rows to numbers with AVX2: as log_cells.c, but the decimal point is taken out by one
 * byte shuffle, and the 16 digits are joined by three multiply-add instructions. */
#include "log_cells_internal.h"

#if defined(__x86_64__) && defined(__GNUC__)
#include <immintrin.h>
#include <stdint.h>

#define KERNEL_TARGET __attribute__((target("avx2,bmi,popcnt")))

enum { WIDE = 16 };

/* Sixteen bytes from place n on: n bytes to keep at the end. */
static const uint8_t keep_last[32] = {
    0,    0,    0,    0,    0,    0,    0,    0,    0,    0,    0,    0,    0,    0,    0,    0,
    0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF};

/* Takes out byte `place`: those before it move up by one, a zero (128) comes first. 16: as it is.
 */
/* clang-format off */
static const uint8_t take_out[17][16] = {
    {128, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15},
    {128, 0, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15},
    {128, 0, 1, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15},
    {128, 0, 1, 2, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15},
    {128, 0, 1, 2, 3, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15},
    {128, 0, 1, 2, 3, 4, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15},
    {128, 0, 1, 2, 3, 4, 5, 7, 8, 9, 10, 11, 12, 13, 14, 15},
    {128, 0, 1, 2, 3, 4, 5, 6, 8, 9, 10, 11, 12, 13, 14, 15},
    {128, 0, 1, 2, 3, 4, 5, 6, 7, 9, 10, 11, 12, 13, 14, 15},
    {128, 0, 1, 2, 3, 4, 5, 6, 7, 8, 10, 11, 12, 13, 14, 15},
    {128, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 11, 12, 13, 14, 15},
    {128, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 12, 13, 14, 15},
    {128, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 13, 14, 15},
    {128, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 14, 15},
    {128, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 15},
    {128, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14},
    {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15},
};
/* clang-format on */

/* 10^decimals for the point at each place; 16: no point. */
static const double power_of_place[17] = {1e15, 1e14, 1e13, 1e12, 1e11, 1e10, 1e9, 1e8, 1e7,
                                          1e6,  1e5,  1e4,  1e3,  1e2,  1e1,  1e0, 1e0};

KERNEL_TARGET static inline uint64_t mark_ends(const char *text, char separator)
{
    const __m256i wanted = _mm256_set1_epi8(separator), newline = _mm256_set1_epi8('\n');
    uint64_t marks = 0;
    for (int i = 0; i < 2; i++) {
        const __m256i bytes = _mm256_loadu_si256((const __m256i *)(const void *)(text + 32 * i));
        const __m256i hit =
            _mm256_or_si256(_mm256_cmpeq_epi8(bytes, wanted), _mm256_cmpeq_epi8(bytes, newline));
        marks |= (uint64_t)(uint32_t)_mm256_movemask_epi8(hit) << 32 * i;
    }
    return marks;
}

KERNEL_TARGET static inline size_t count_bits(uint64_t bits)
{
    return (size_t)__builtin_popcountll(bits);
}

KERNEL_TARGET static inline bool read_number(const char *base, const char *begin, const char *end,
                                             double *value)
{
    const uint64_t negative = *begin == '-';
    const char *text = begin + negative;
    const size_t length = (size_t)(end - text);
    if (length - 1 >= WIDE || end - base < WIDE)
        return imki_log_cell_read(begin, end, value);
    const __m128i keep = _mm_loadu_si128((const __m128i *)(const void *)(keep_last + length));
    const __m128i loaded = _mm_loadu_si128((const __m128i *)(const void *)(end - WIDE));
    const __m128i cell = _mm_and_si128(_mm_sub_epi8(loaded, _mm_set1_epi8('0')), keep);
    const __m128i point = _mm_cmpeq_epi8(cell, _mm_set1_epi8('.' - '0'));
    const unsigned place = (unsigned)__builtin_ctz((unsigned)_mm_movemask_epi8(point) | 1u << WIDE);
    const __m128i order = _mm_loadu_si128((const __m128i *)(const void *)take_out[place]);
    const __m128i digits = _mm_shuffle_epi8(cell, order);
    const __m128i above_nine = _mm_subs_epu8(digits, _mm_set1_epi8(9));
    const __m128i pairs = _mm_maddubs_epi16(
        digits, _mm_setr_epi8(10, 1, 10, 1, 10, 1, 10, 1, 10, 1, 10, 1, 10, 1, 10, 1));
    const __m128i fours = _mm_madd_epi16(pairs, _mm_setr_epi16(100, 1, 100, 1, 100, 1, 100, 1));
    const __m128i eights = _mm_madd_epi16(_mm_packus_epi32(fours, fours),
                                          _mm_setr_epi16(10000, 1, 10000, 1, 10000, 1, 10000, 1));
    const uint64_t halves = (uint64_t)_mm_cvtsi128_si64(eights);
    const uint64_t number = (halves & UINT32_MAX) * 100000000 + (halves >> 32);
    /* Not only digits, more than 53 bits, or a point alone? */
    if (!_mm_testz_si128(above_nine, above_nine) || number >> 53 != 0 ||
        (length == 1 && *text == '.'))
        return imki_log_cell_read(begin, end, value);
    const double size = (double)(int64_t)number / power_of_place[place];
    /* The sign cannot be predicted: set its bit without a branch. */
    const __m128i sign = _mm_cvtsi64_si128((int64_t)(negative << 63));
    *value = _mm_cvtsd_f64(_mm_xor_pd(_mm_set_sd(size), _mm_castsi128_pd(sign)));
    return true;
}

#include "log_cells_kernel.h"

KERNEL_TARGET size_t imki_log_cells_read_avx2(const imki_log_cells *cells, const char *base,
                                              const char **text, const char *end,
                                              double *const *out, size_t max_rows)
{
    return read_cells(cells, base, text, end, out, max_rows);
}

bool imki_log_cells_avx2_runs(void)
{
    return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("bmi") &&
           __builtin_cpu_supports("popcnt");
}

#else

size_t imki_log_cells_read_avx2(const imki_log_cells *cells, const char *base, const char **text,
                                const char *end, double *const *out, size_t max_rows)
{
    return imki_log_cells_read_scalar(cells, base, text, end, out, max_rows);
}

bool imki_log_cells_avx2_runs(void)
{
    return false;
}

#endif
