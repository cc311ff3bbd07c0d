/* SPDX-License-Identifier: Apache-2.0 */
/* Normals with AVX-512 F and DQ: eight blocks at a time. Empty on other processors. */
#if defined(__AVX512F__) && defined(__AVX512DQ__)

#include <immintrin.h>
#include <stdint.h>

#define LANES 8

typedef double real __attribute__((vector_size(64)));
typedef uint64_t word __attribute__((vector_size(64)));

static inline word multiply_low(word a, word b)
{
    return (word)_mm512_mul_epu32((__m512i)a, (__m512i)b);
}

static inline word xor3(word a, word b, word c)
{
    return (word)_mm512_ternarylogic_epi64((__m512i)a, (__m512i)b, (__m512i)c, 0x96);
}

static inline word select_or(word a, word m, word b)
{
    return (word)_mm512_ternarylogic_epi64((__m512i)a, (__m512i)m, (__m512i)b, 0xea);
}

static inline word spread(uint64_t x)
{
    return (word)_mm512_set1_epi64((long long)x);
}

static inline real toggle(real a, word b)
{
    const __m512i sign = _mm512_set1_epi64(INT64_MIN);
    return (real)_mm512_ternarylogic_epi64((__m512i)a, (__m512i)b, sign, 0x78);
}

static inline real as_real(word a)
{
    return (real)a;
}

#define HAS_EXPONENT_AND_MANTISSA
/* The factor is 2^-40 4/3, rounded up: v has 41 bits, so the product is on the same side of a power
 * of two as v is of 3/4 of one. */
static inline void exponent_and_mantissa(real v, real *e, real *m)
{
    *e = (real)_mm512_getexp_pd((__m512d)(v * 0x1.5555555555556p-40));
    *m = (real)_mm512_getmant_pd((__m512d)v, _MM_MANT_NORM_p75_1p5, _MM_MANT_SIGN_zero);
}

static inline real square_root(real a)
{
    return (real)_mm512_sqrt_pd((__m512d)a);
}

static inline word lane_numbers(void)
{
    return (word){0, 1, 2, 3, 4, 5, 6, 7};
}

static inline void store(double *out, real a)
{
    _mm512_storeu_pd(out, (__m512d)a);
}

#include "normals_kernel.h"

void imki_draw_groups_avx512(uint64_t seed, const imki_draw *draws, size_t count)
{
    draw_groups(seed, draws, count);
}

#else
typedef int imki_normals_avx512_is_empty; /* a translation unit may not be empty */
#endif
