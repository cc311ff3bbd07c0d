/* SPDX-License-Identifier: Apache-2.0 */
/* Normals with the vectors of AArch64: two blocks at a time. Empty on other processors. */
#if defined(__aarch64__)

#include <arm_neon.h>
#include <stdint.h>

#define LANES 2

typedef double real __attribute__((vector_size(16)));
typedef uint64_t word __attribute__((vector_size(16)));

static inline word multiply_low(word a, word b)
{
    return (word)vmull_u32(vmovn_u64((uint64x2_t)a), vmovn_u64((uint64x2_t)b));
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
    return (word)vdupq_n_u64(x);
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
    return (real)vsqrtq_f64((float64x2_t)a);
}

static inline word lane_numbers(void)
{
    return (word){0, 1};
}

static inline void store(double *out, real a)
{
    vst1q_f64(out, (float64x2_t)a);
}

#include "normals_kernel.h"

void imki_draw_groups_neon(uint64_t seed, const imki_draw *draws, size_t count)
{
    draw_groups(seed, draws, count);
}

#else
typedef int imki_normals_neon_is_empty; /* a translation unit may not be empty */
#endif
