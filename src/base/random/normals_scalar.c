/* SPDX-License-Identifier: Apache-2.0 */
/* Normals in portable C, one block at a time: for every processor, and the reference of the
 * others. */
#include <math.h>
#include <stdint.h>
#include <string.h>

#define LANES 1

typedef double real;
typedef uint64_t word;

static inline word multiply_low(word a, word b)
{
    return (word)(uint32_t)a * (uint32_t)b;
}

static inline word xor3(word a, word b, word c)
{
    return a ^ b ^ c;
}

static inline word select_or(word a, word m, word b)
{
    return (a & m) | b;
}

static inline word spread(uint64_t x)
{
    return x;
}

static inline real as_real(word a)
{
    real bits;
    memcpy(&bits, &a, sizeof bits);
    return bits;
}

static inline word as_word(real a)
{
    word bits;
    memcpy(&bits, &a, sizeof bits);
    return bits;
}

static inline real toggle(real a, word b)
{
    return as_real(as_word(a) ^ (b & (UINT64_C(1) << 63)));
}

static inline real square_root(real a)
{
    return sqrt(a);
}

static inline word lane_numbers(void)
{
    return 0;
}

static inline void store(double *out, real a)
{
    *out = a;
}

#include "normals_kernel.h"

void imki_draw_groups_scalar(uint64_t seed, const imki_draw *draws, size_t count)
{
    draw_groups(seed, draws, count);
}
