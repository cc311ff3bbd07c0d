/* SPDX-License-Identifier: Apache-2.0 */
/* Means over a trajectory with AVX-512 F and DQ: eight intervals at once. Empty on other
 * processors. */
#if defined(__AVX512F__) && defined(__AVX512DQ__)

#include <immintrin.h>
#include <stdint.h>

#define LANES 8

typedef double real __attribute__((vector_size(64)));

static inline real square_root(real a)
{
    return (real)_mm512_sqrt_pd((__m512d)a);
}

#include "trajectory_kernel.h"

void imki_means_of_intervals_avx512(const imk_trajectory *trajectory, size_t count,
                                    imki_intervals *intervals)
{
    means_of_intervals(trajectory, count, intervals);
}

void imki_means_of_samples_avx512(const imk_trajectory *trajectory,
                                  const imk_trajectory_piece *piece, size_t count,
                                  const double *boundary, const imki_means *means)
{
    means_of_samples(trajectory, piece, count, boundary, means);
}

#else
typedef int imki_trajectory_avx512_is_empty; /* a translation unit may not be empty */
#endif
