/* SPDX-License-Identifier: Apache-2.0 */
/* The mechanisation in blocks with AVX2 and FMA: four at once. Empty on other processors. */
#if defined(__AVX2__) && defined(__FMA__)

#include <immintrin.h>
#include <stddef.h>

#define LANES 4

typedef double real __attribute__((vector_size(32)));

static inline real square_root(real a)
{
    return (real)_mm256_sqrt_pd((__m256d)a);
}

static inline real fused(real a, real b, real c)
{
    return (real)_mm256_fmadd_pd((__m256d)a, (__m256d)b, (__m256d)c);
}

static inline real fused_from(real a, real b, real c)
{
    return (real)_mm256_fnmadd_pd((__m256d)a, (__m256d)b, (__m256d)c);
}

static inline real larger(real a, real b)
{
    return (real)_mm256_max_pd((__m256d)a, (__m256d)b);
}

/* Halves of two rows in one register, straight from memory; then neighbours change places. */
static inline void load_across(const double *const (*channel)[6], size_t j, size_t first,
                               real out[LANES])
{
    for (size_t i = 0; i < LANES; i += 2) {
        const size_t at = first + i;
        const __m256d even =
            _mm256_insertf128_pd(_mm256_castpd128_pd256(_mm_loadu_pd(channel[0][j] + at)),
                                 _mm_loadu_pd(channel[2][j] + at), 1);
        const __m256d odd =
            _mm256_insertf128_pd(_mm256_castpd128_pd256(_mm_loadu_pd(channel[1][j] + at)),
                                 _mm_loadu_pd(channel[3][j] + at), 1);
        out[i] = (real)_mm256_unpacklo_pd(even, odd);
        out[i + 1] = (real)_mm256_unpackhi_pd(even, odd);
    }
}

#include "strapdown_block_loop.h"

void imki_block_run_avx2(const imki_block_run *run)
{
    run_blocks(run);
}

#else
typedef int imki_strapdown_block_avx2_is_empty; /* a translation unit may not be empty */
#endif
