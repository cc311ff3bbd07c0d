/* SPDX-License-Identifier: Apache-2.0 */
/* The kernels that draw normals, one per instruction set, and the constants of Philox4x32-10. */
#ifndef IMUKIT_NORMALS_INTERNAL_H
#define IMUKIT_NORMALS_INTERNAL_H

#include "imukit/random.h"

#define IMKI_PHILOX_ROUNDS 10
#define IMKI_PHILOX_BLOCK 4 /* words */

/* Multipliers and key increments (golden ratio, sqrt 3 - 1) of Philox4x32 [SALMON2011]. */
#define IMKI_PHILOX_M0 UINT64_C(0xD2511F53)
#define IMKI_PHILOX_M1 UINT64_C(0xCD9E8D57)
#define IMKI_PHILOX_W0 UINT32_C(0x9E3779B9)
#define IMKI_PHILOX_W1 UINT32_C(0xBB67AE85)

/* A group is what one step of any kernel can draw without a neighbour. */
#define IMKI_GROUP_BLOCKS 8
#define IMKI_GROUP_NORMALS 32

/* Whole groups of a stream. All have the same block number >> 32, which the kernels use to do half
 * of the first two rounds once only. */
typedef struct imki_draw {
    uint64_t stream; /* upper half of Philox's counter */
    uint64_t group;  /* the first one */
    size_t groups;
    double *out; /* 32 * groups doubles in the layout of random.h, no alignment needed */
} imki_draw;

/* Normals first … first + count of a stream: whole groups. */
static inline imki_draw imki_draw_of(uint64_t stream, uint64_t first, size_t count, double *out)
{
    return (imki_draw){stream, first / IMKI_GROUP_NORMALS, count / IMKI_GROUP_NORMALS, out};
}

/* Several draws in a row: the kernels work on what comes next before the last one is finished, so
 * one call for all costs less than one for each. `seed` is the key of Philox. */
typedef void imki_draw_groups(uint64_t seed, const imki_draw *draws, size_t count);

/* The same with the kernel of the source. */
void imki_random_draws(imk_random source, const imki_draw *draws, size_t count);

imki_draw_groups imki_draw_groups_scalar;
imki_draw_groups imki_draw_groups_avx2;
imki_draw_groups imki_draw_groups_avx512;
imki_draw_groups imki_draw_groups_neon;

#endif
