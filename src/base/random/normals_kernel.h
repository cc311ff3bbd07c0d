/* SPDX-License-Identifier: Apache-2.0 */
/* The arithmetic of the normals, written once for every instruction set. No include guard: each
 * normals_*.c defines the types and the few operations below for its vectors, then includes this.
 *
 *     real, word             LANES doubles and 64-bit integers; + - * & | ^ << >> work on both
 *     multiply_low(a, m)     product of the lower halves of each lane
 *     xor3(a, b, c)          a ^ b ^ c
 *     select_or(a, m, b)     (a & m) | b
 *     toggle(a, b)           a, its sign changed where the top bit of b is set
 *     as_real, as_word       the same bits as the other type (as_word unless the last one is there)
 *     square_root(a)         correctly rounded
 *     lane_numbers()         0, 1, ... LANES - 1
 *     spread(x)              x in every lane
 *     store(out, a)          unaligned
 *
 *     exponent_and_mantissa  as below, where the instruction set has its own: then define
 *                            HAS_EXPONENT_AND_MANTISSA
 *
 * Two words make a 64-bit number n, the first one its upper half, which gives a pair of normals by
 * the transform of [BOX1958]:
 *
 *     bits 23-62  k:  u = (2k + 1)/2^41,                rho = sqrt(-log u)
 *     bits 1-22   j:  d = pi/4 (2j + 1 - 2^22)/2^22
 *     bit 63, bit 0   signs s, t
 *
 *     s rho (cos d - sin d),   t rho (cos d + sin d)
 *
 * With r = sqrt 2 rho these are r cos a and r sin a of the angle a = d + pi/4 in the first
 * quadrant, mirrored by the signs into any of the four: no swap of sine and cosine, and the angle
 * is the centre of one of 2^24 equal cells. Each step rounds once, in the order written, so every
 * kernel makes the same bits. The polynomials are minimax
 * (tests/reference/minimax_coefficients.py); a normal is within 4e-13 of the exact value of its
 * bits, most within 1e-13. */
#include "normals_internal.h"

#define SETS (IMKI_GROUP_BLOCKS / LANES) /* vectors of blocks in a group */

/* Bits of 2^51 and 2^52, where a double has an ulp of 1/2 and 1: or an integer in, subtract the
 * power, and it is a double. */
#define TWO_51 UINT64_C(0x4320000000000000)
#define TWO_52 UINT64_C(0x4330000000000000)

/* What does not change from block to block: the halves of rounds 1 and 2 that depend only on the
 * stream and the upper block number, and the round keys. */
typedef struct philox_plan {
    uint64_t round1_word2; /* to xor in */
    uint64_t round2_word0, round2_word2, round2_word3;
    uint64_t key0[IMKI_PHILOX_ROUNDS], key1[IMKI_PHILOX_ROUNDS];
} philox_plan;

/* The round keys: once for all draws of a call. */
static void plan_seed(philox_plan *plan, uint64_t seed)
{
    uint32_t key0 = (uint32_t)seed, key1 = (uint32_t)(seed >> 32);
    for (int i = 0; i < IMKI_PHILOX_ROUNDS; i++) {
        plan->key0[i] = key0;
        plan->key1[i] = key1;
        key0 += IMKI_PHILOX_W0;
        key1 += IMKI_PHILOX_W1;
    }
}

/* Round i of Philox4x32 [SALMON2011]:
 *
 *     {hi(M1 w2) ^ w1 ^ k0, lo(M1 w2), hi(M0 w0) ^ w3 ^ k1, lo(M0 w0)}
 *
 * With w1 known to be the same in all blocks of a call, and w2, w3 the stream, the first and second
 * word after round 1 are known too, and so is the product of the first one in round 2. */
static void plan_stream(philox_plan *plan, uint64_t stream, uint64_t block)
{
    const uint64_t product1 = IMKI_PHILOX_M1 * (uint32_t)stream;
    const uint32_t word0 =
        (uint32_t)(product1 >> 32) ^ (uint32_t)(block >> 32) ^ (uint32_t)plan->key0[0];
    const uint64_t product2 = IMKI_PHILOX_M0 * word0;
    plan->round1_word2 = (stream >> 32) ^ plan->key1[0];
    plan->round2_word0 = (uint32_t)product1 ^ plan->key0[1];
    plan->round2_word2 = (product2 >> 32) ^ plan->key1[1];
    plan->round2_word3 = (uint32_t)product2;
}

/* The numbers n of words 0, 1 and of words 2, 3 of LANES blocks.
 *
 * One word is in the lower half of each lane; the upper halves hold rubbish, which the
 * multiplications do not see. In the last round the product holds one word in its lower half and
 * what the other one is made from in its upper half: just what n needs. */
static inline void draw_numbers(const philox_plan *plan, word block, word n[2])
{
    const word m0 = spread(IMKI_PHILOX_M0), m1 = spread(IMKI_PHILOX_M1);
    word product0 = multiply_low(block, m0);
    word w2 = (product0 >> 32) ^ spread(plan->round1_word2);
    word w3 = product0;
    word product1 = multiply_low(w2, m1);
    word w0 = (product1 >> 32) ^ spread(plan->round2_word0);
    word w1 = product1;
    w2 = w3 ^ spread(plan->round2_word2);
    w3 = spread(plan->round2_word3);
    for (int i = 2; i < IMKI_PHILOX_ROUNDS - 1; i++) {
        product0 = multiply_low(w0, m0);
        product1 = multiply_low(w2, m1);
        w0 = xor3(product1 >> 32, w1, spread(plan->key0[i]));
        w2 = xor3(product0 >> 32, w3, spread(plan->key1[i]));
        w1 = product1;
        w3 = product0;
    }
    n[0] = xor3(multiply_low(w2, m1), w1 << 32, spread(plan->key0[IMKI_PHILOX_ROUNDS - 1] << 32));
    n[1] = xor3(multiply_low(w0, m0), w3 << 32, spread(plan->key1[IMKI_PHILOX_ROUNDS - 1] << 32));
}

#ifndef HAS_EXPONENT_AND_MANTISSA
/* v = 2^(e + 40) m with m in [3/4, 3/2), for v in [1/2, 2^40) and so e in [-41, 0]. */
static inline void exponent_and_mantissa(real v, real *e, real *m)
{
    const uint64_t three_quarters = UINT64_C(0x3fe8000000000000);
    const uint64_t fraction = UINT64_C(0x000fffffffffffff);
    const uint64_t bias = UINT64_C(64) << 52; /* keeps t positive */

    const word t = as_word(v) + spread(bias - (UINT64_C(40) << 52) - three_quarters);
    *e = as_real((t >> 52) | spread(TWO_52)) - (0x1p52 + 64.0);
    *m = as_real((t & spread(fraction)) + spread(three_quarters));
}
#endif

/* The logarithm of u = (2k + 1)/2^41 as far as its division.
 *
 *     u = 2^-40 v = 2^e m,   s = (1 - m)/(1 + m),   -log u = -e log 2 + 2 atanh s */
static inline void split(word n, real *e, real *s)
{
    const uint64_t k_bits = UINT64_C(0x1fffffffffe);
    const real v = as_real(select_or(n >> 22, spread(k_bits), spread(TWO_51 | 1))) - 0x1p51;
    real m;
    exponent_and_mantissa(v, e, &m);
    *s = (1.0 - m) / (1.0 + m);
}

/* rho = sqrt(-log u), 2 atanh s = s (2 + 2 s^2 (1/3 + s^2/5 + ...)) with relative error below
 * 2e-13, and so the logarithm, also near u = 1, where e = 0. */
static inline real radius(real e, real s)
{
    const real z = s * s;
    real p = z * (2 * 0.10060920112616606) + 2 * 0.11067584924138978;
    p = p * z + 2 * 0.1428659147603789;
    p = p * z + 2 * 0.19999992315963658;
    p = p * z + 2 * 0.33333333355155004;
    p = p * z + 2.0;
    return square_root(e * -0.69314718055994531 + s * p);
}

/* The pair of normals of n. The angle d = pi x, |x| < 1/4, is kept as the odd integer a = 2^24 x;
 * the scale is in the coefficients, where a power of two changes no digit.
 *
 *     sin(pi x) = pi x (1 - (pi x)^2/6 + ...)    relative error below 5e-15
 *     cos(pi x) = 1 - (pi x)^2/2 + ...           absolute error below 6e-14 */
static inline void rotate(word n, real rho, real *first, real *second)
{
    const uint64_t j_bits = UINT64_C(0x7ffffe);
    const real a = as_real(select_or(n, spread(j_bits), spread(TWO_52 | 1))) - (0x1p52 + 0x1p22);
    const real w = a * a;
    real q = w * (-0.007283489666125991 * 0x1p-264) + 0.08213978536001738 * 0x1p-216;
    q = q * w + -0.599264331797251 * 0x1p-168;
    q = q * w + 2.550164036985896 * 0x1p-120;
    q = q * w + -5.167712780034488 * 0x1p-72;
    q = q * w + 3.14159265358978 * 0x1p-24;
    const real sine = a * q;
    real c = w * (-0.025447437048472386 * 0x1p-240) + 0.23530541256229043 * 0x1p-192;
    c = c * w + -1.3352619525757259 * 0x1p-144;
    c = c * w + 4.058712114468916 * 0x1p-96;
    c = c * w + -4.934802200480712 * 0x1p-48;
    const real cosine = c * w + 0.9999999999999445;
    *first = toggle(rho * (cosine - sine), n);
    *second = toggle(rho * (cosine + sine), n << 63);
}

/* Each pass draws the numbers of one vector of blocks, splits those of the vector before, and
 * finishes the one before that: three independent strands, so that no division or root is waited
 * for. The first STRANDS - 1 passes finish nothing of use, and as many at the end draw nothing. */
static void draw_groups(uint64_t seed, const imki_draw *draws, size_t count)
{
    enum { STRANDS = 3, PARTS = 4 };
    word drawn[2] = {spread(0), spread(0)}, halved[2] = {spread(0), spread(0)};
    real e[2] = {as_real(spread(0)), as_real(spread(0))}, s[2] = {e[0], e[0]};
    double unused[IMKI_GROUP_NORMALS];
    double *lanes = unused, *lanes_next = unused; /* of what is finished now, and next */
    philox_plan plan;
    plan_seed(&plan, seed);
    for (size_t d = 0; d <= count; d++) {
        const imki_draw draw = d < count ? draws[d] : (imki_draw){.out = unused};
        const size_t passes = d < count ? draw.groups * SETS : STRANDS - 1;
        plan_stream(&plan, draw.stream, draw.group * IMKI_GROUP_BLOCKS);
        word block = lane_numbers() + spread(draw.group * IMKI_GROUP_BLOCKS);
        for (size_t pass = 0; pass < passes; pass++) {
            word next[2];
            real normals[PARTS];
            draw_numbers(&plan, block, next);
            block = block + spread(LANES);
            for (int i = 0; i < 2; i++) {
                const real rho = radius(e[i], s[i]);
                rotate(halved[i], rho, &normals[2 * i], &normals[2 * i + 1]);
                split(drawn[i], &e[i], &s[i]);
                halved[i] = drawn[i];
                drawn[i] = next[i];
            }
            for (int part = 0; part < PARTS; part++)
                store(lanes + part * IMKI_GROUP_BLOCKS, normals[part]);
            lanes = lanes_next;
            lanes_next = d < count
                             ? draw.out + pass / SETS * IMKI_GROUP_NORMALS + pass % SETS * LANES
                             : unused;
        }
    }
}
