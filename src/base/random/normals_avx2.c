/* SPDX-License-Identifier: Apache-2.0 */
/* Normals with AVX2: four blocks at a time. Empty on other processors. */
#if defined(__AVX2__)

#include <immintrin.h>
#include <stdint.h>

#define LANES 4

typedef double real __attribute__((vector_size(32)));
typedef uint64_t word __attribute__((vector_size(32)));

static inline word multiply_low(word a, word b)
{
    return (word)_mm256_mul_epu32((__m256i)a, (__m256i)b);
}

static inline word xor3(word a, word b, word c)
{
    return a ^ (b ^ c);
}

static inline word select_or(word a, word m, word b)
{
    return (a & m) | b;
}

static inline word spread(uint64_t x)
{
    return (word)_mm256_set1_epi64x((long long)x);
}

static inline real toggle(real a, word b)
{
    return (real)((word)a ^ (b & spread(UINT64_C(1) << 63)));
}

static inline real as_real(word a)
{
    return (real)a;
}

static inline word as_word(real a)
{
    return (word)a;
}

static inline real square_root(real a)
{
    return (real)_mm256_sqrt_pd((__m256d)a);
}

static inline word lane_numbers(void)
{
    return (word){0, 1, 2, 3};
}

static inline void store(double *out, real a)
{
    _mm256_storeu_pd(out, (__m256d)a);
}

#include "normals_kernel.h"

void imki_draw_groups_avx2(uint64_t seed, const imki_draw *draws, size_t count)
{
    draw_groups(seed, draws, count);
}

#else
typedef int imki_normals_avx2_is_empty; /* a translation unit may not be empty */
#endif
