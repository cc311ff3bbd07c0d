/* SPDX-License-Identifier: Apache-2.0 */
/* The mechanisation in blocks with AVX-512 F and DQ: eight at once. Empty on other processors. */
#if defined(__AVX512F__) && defined(__AVX512DQ__)

#include <immintrin.h>
#include <stddef.h>

#define LANES 8

typedef double real __attribute__((vector_size(64)));

static inline real square_root(real a)
{
    return (real)_mm512_sqrt_pd((__m512d)a);
}

static inline real fused(real a, real b, real c)
{
    return (real)_mm512_fmadd_pd((__m512d)a, (__m512d)b, (__m512d)c);
}

static inline real fused_from(real a, real b, real c)
{
    return (real)_mm512_fnmadd_pd((__m512d)a, (__m512d)b, (__m512d)c);
}

static inline real larger(real a, real b)
{
    return (real)_mm512_max_pd((__m512d)a, (__m512d)b);
}

static inline __m512d halves(const double *low, const double *high)
{
    return _mm512_insertf64x4(_mm512_castpd256_pd512(_mm256_loadu_pd(low)), _mm256_loadu_pd(high),
                              1);
}

/* Halves of two rows in one register, straight from memory; then neighbours change places, then
 * quarters. */
static inline void load_across(const double *const (*channel)[6], size_t j, size_t first,
                               real out[LANES])
{
    for (size_t i = 0; i < LANES; i += 4) {
        const size_t at = first + i;
        const __m512d a = halves(channel[0][j] + at, channel[2][j] + at),
                      b = halves(channel[1][j] + at, channel[3][j] + at);
        const __m512d c = halves(channel[4][j] + at, channel[6][j] + at),
                      d = halves(channel[5][j] + at, channel[7][j] + at);
        const __m512d ab0 = _mm512_unpacklo_pd(a, b), ab1 = _mm512_unpackhi_pd(a, b);
        const __m512d cd0 = _mm512_unpacklo_pd(c, d), cd1 = _mm512_unpackhi_pd(c, d);
        out[i] = (real)_mm512_shuffle_f64x2(ab0, cd0, 0x88);
        out[i + 1] = (real)_mm512_shuffle_f64x2(ab1, cd1, 0x88);
        out[i + 2] = (real)_mm512_shuffle_f64x2(ab0, cd0, 0xdd);
        out[i + 3] = (real)_mm512_shuffle_f64x2(ab1, cd1, 0xdd);
    }
}

#include "strapdown_block_loop.h"

void imki_block_run_avx512(const imki_block_run *run)
{
    run_blocks(run);
}

#else
typedef int imki_strapdown_block_avx512_is_empty; /* a translation unit may not be empty */
#endif
