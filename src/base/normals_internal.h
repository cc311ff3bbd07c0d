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

/* Draws whole groups of a stream, in the layout of random.h.
 *
 * seed    key of Philox
 * stream  upper half of its counter
 * group   first group; all groups have the same block number >> 32, which the kernels use to do
 *         half of the first two rounds once only
 * out     32 * groups doubles, no alignment needed */
typedef void imki_draw_groups(uint64_t seed, uint64_t stream, uint64_t group, size_t groups,
                              double *out);

imki_draw_groups imki_draw_groups_scalar;
imki_draw_groups imki_draw_groups_avx2;
imki_draw_groups imki_draw_groups_avx512;
imki_draw_groups imki_draw_groups_neon;

#endif
