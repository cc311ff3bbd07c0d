/* SPDX-License-Identifier: Apache-2.0 */
/** @file random.h
 *  Counter-based random numbers: a pure function of (seed, stream, index), the same bits on every
 *  compiler, instruction set, thread count and machine.
 *
 *  The generator is Philox4x32-10 [SALMON2011]. Any number of a stream can be drawn without the
 *  ones before it, so work can be divided in any way without changing a result. */
#ifndef IMUKIT_RANDOM_H
#define IMUKIT_RANDOM_H

#include "imukit/status.h"

IMK_BEGIN_C

/** Instruction set used to generate normals. All give the same bits. */
typedef enum imk_kernel {
    IMK_KERNEL_SCALAR = 0, /**< portable C, vectorised by the compiler where it can */
    IMK_KERNEL_AVX2 = 1,
    IMK_KERNEL_AVX512 = 2, /**< AVX-512 F and DQ */
    IMK_KERNEL_NEON = 3    /**< AArch64 */
} imk_kernel;

/** A source of random numbers. A value: copy it freely; it has no state. */
typedef struct imk_random {
    uint64_t seed;
    imk_kernel kernel; /**< must be supported by this machine: use imk_random_seeded() */
} imk_random;

/** Source with this seed and the fastest kernel of this machine. On hosted systems the environment
 *  variable IMUKIT_ISA (scalar, avx2, avx512, neon) forces a kernel; one the machine lacks is
 *  ignored. */
IMK_API imk_random imk_random_seeded(uint64_t seed);

/** Name of a kernel: "scalar", "avx2", "avx512", "neon". */
IMK_API const char *imk_kernel_name(imk_kernel kernel);

/** Stream number of one noise process. Numbers are fixed for ever: bits 0-7 axis, 8-15 instance,
 *  16-31 term, 32-63 run. */
IMK_API uint64_t imk_stream(uint32_t run, uint16_t term, uint8_t instance, uint8_t axis);

/** One Philox4x32-10 block: out = philox(counter, key). It reproduces the published test vectors.
 */
IMK_API void imk_philox4x32(const uint32_t counter[4], const uint32_t key[2], uint32_t out[4]);

/** Random words number first … first + count - 1 of a stream. Word w is word w mod 4 of block w/4,
 *  whose counter is {block low, block high, stream low, stream high} and key {seed low, seed high}.
 */
IMK_API void imk_random_words(imk_random source, uint64_t stream, uint64_t first, size_t count,
                              uint32_t *words);

/** Standard normals number first … first + count - 1 of a stream, by Box-Muller.
 *
 *  The layout is fixed for ever: normal i belongs to group i/32; lane l = i mod 8 and part
 *  p = (i/8) mod 4 of that group come from Philox block 8*(i/32) + l: parts 0 and 1 from its words
 *  0 and 1, parts 2 and 3 from its words 2 and 3. The 64-bit number made of two words (the first
 *  one is its upper half) gives a pair of normals, parts 0 and 1 (2 and 3):
 *
 *      bits 23-62  k, 40 bits:  u = (2k + 1)/2^41,  r = sqrt(-2 log u)
 *      bits 1-22   j, 22 bits:  a = pi/2 (2j + 1)/2^23, in the first quadrant
 *      bits 63, 0  signs, 1 is minus:  +- r cos a,  +- r sin a
 *
 *  |normal| < 7.54; each is within 4e-13 of the exact value of its bits (2.2e-13 seen). With 2^40
 *  radii and 2^24 angles the probability of a tail is exact to 6e-9 of itself at 5 sigma, 3e-6 at 6
 *  and 0.3 % at 7.
 *
 *  Cost at 2.7 GHz: 1.4 ns a normal with AVX-512, 2 with AVX2, 7 scalar, and 0.2 us a call (0.4
 *  scalar), as much again for each end that is not at a multiple of 32: draw some hundred at a
 *  time.
 *
 *  @param first  any; no alignment needed, multiples of 32 are fastest
 *  @param out    count doubles */
IMK_API void imk_random_normals(imk_random source, uint64_t stream, uint64_t first, size_t count,
                                double *out);

IMK_END_C
#endif
