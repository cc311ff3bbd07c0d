/* SPDX-License-Identifier: Apache-2.0 */
/* The loops over a block in segment order, to be compiled for each instruction set. A step of the
 * 16 segments is two vectors of 8 lanes, which the compiler maps to the registers there are. Each
 * element sees the same operations in the same order whatever these are. */
#ifndef IMUKIT_SEGMENT_KERNEL_H
#define IMUKIT_SEGMENT_KERNEL_H

#include "noise/generator_internal.h"

#define KERNEL static inline __attribute__((always_inline))

enum { STEPS = IMK_NOISE_STEPS, SEGMENTS = IMKI_SEGMENTS, LANES = 8, HALVES = SEGMENTS / LANES };

/* Blocks are arrays of double of any alignment. */
typedef double lanes __attribute__((vector_size(64), aligned(8), may_alias));

#define AT(block, i, half) (*(lanes *)((block) + (i)*SEGMENTS + (half)*LANES))
#define CONST_AT(block, i, half) (*(const lanes *)((block) + (i)*SEGMENTS + (half)*LANES))

KERNEL void add_scaled(double scale, const double *restrict normals, double *restrict block)
{
    for (size_t i = 0; i < STEPS; i++)
        for (size_t h = 0; h < HALVES; h++)
            AT(block, i, h) += scale * CONST_AT(normals, i, h);
}

KERNEL void add_recursion(double gain, const double *restrict power, const double *restrict normals,
                          double *restrict value, double *restrict block)
{
    double local[IMK_NOISE_BLOCK], start[SEGMENTS];
    lanes now[HALVES];
    for (size_t h = 0; h < HALVES; h++)
        AT(local, 0, h) = now[h] = CONST_AT(normals, 0, h);
    for (size_t i = 1; i < STEPS; i++)
        for (size_t h = 0; h < HALVES; h++)
            AT(local, i, h) = now[h] = power[1] * now[h] + CONST_AT(normals, i, h);
    double carried = *value;
    for (size_t s = 0; s < SEGMENTS; s++) {
        start[s] = carried;
        carried = power[STEPS] * carried + local[(STEPS - 1) * SEGMENTS + s];
    }
    *value = carried;
    for (size_t i = 0; i < STEPS; i++)
        for (size_t h = 0; h < HALVES; h++)
            AT(block, i, h) +=
                gain * (CONST_AT(local, i, h) + power[i + 1] * CONST_AT(start, 0, h));
}

KERNEL void add_sums(double gain, const double *restrict normals, double *restrict value,
                     double *restrict block)
{
    double local[IMK_NOISE_BLOCK], total[SEGMENTS], start[SEGMENTS];
    lanes now[HALVES] = {{0.0}};
    for (size_t i = 0; i < STEPS; i++)
        for (size_t h = 0; h < HALVES; h++) {
            AT(local, i, h) = now[h];
            now[h] += CONST_AT(normals, i, h);
        }
    for (size_t h = 0; h < HALVES; h++)
        AT(total, 0, h) = now[h];
    double carried = *value;
    for (size_t s = 0; s < SEGMENTS; s++) {
        start[s] = carried;
        carried += total[s];
    }
    *value = carried;
    for (size_t i = 0; i < STEPS; i++)
        for (size_t h = 0; h < HALVES; h++)
            AT(block, i, h) += gain * (CONST_AT(local, i, h) + CONST_AT(start, 0, h));
}

KERNEL void quantize(double lsb, double dt, double *restrict residual, double *restrict block)
{
    const double per_step = 1.0 / lsb, rate_step = lsb / dt, shift = 0x1.8p52;
    double local[IMK_NOISE_BLOCK], start[SEGMENTS];
    lanes now[HALVES] = {{0.0}}, counted[HALVES] = {{0.0}};
    for (size_t i = 0; i < STEPS; i++)
        for (size_t h = 0; h < HALVES; h++)
            AT(local, i, h) = now[h] = now[h] + CONST_AT(block, i, h) * dt;
    double carried = *residual;
    for (size_t s = 0; s < SEGMENTS; s++) {
        start[s] = carried;
        double integral = carried + local[(STEPS - 1) * SEGMENTS + s];
        carried = integral - imki_round(integral * per_step) * lsb;
    }
    *residual = carried;
    for (size_t i = 0; i < STEPS; i++)
        for (size_t h = 0; h < HALVES; h++) {
            lanes steps = (CONST_AT(start, 0, h) + CONST_AT(local, i, h)) * per_step;
            steps = (steps + shift) - shift; /* imki_round() of all lanes */
            AT(block, i, h) = (steps - counted[h]) * rate_step;
            counted[h] = steps;
        }
}

/* Plain loops: comparisons of vectors are taken apart by the compiler. */
KERNEL void saturate(double dead_band, double range, double *restrict block)
{
    for (size_t j = 0; j < IMK_NOISE_BLOCK; j++) {
        double x = block[j], size = x < 0.0 ? -x : x;
        x = size < dead_band ? 0.0 : x;
        x = x < -range ? -range : x;
        block[j] = x > range ? range : x;
    }
}

KERNEL void add_held(const double *restrict held, size_t offset, double *restrict block)
{
    for (size_t i = 0; i < STEPS; i++)
        for (size_t h = 0; h < HALVES; h++)
            AT(block, i, h) += CONST_AT(held, (i + offset) / 4, h);
}

/* Transpose 8 rows of 8: pairs of elements, then pairs of pairs, then halves change places between
 * vectors. */
KERNEL void transpose_lanes(const double *restrict in, size_t in_stride, double *restrict out,
                            size_t out_stride)
{
    lanes a[LANES], b[LANES];
    for (size_t i = 0; i < LANES; i++)
        a[i] = *(const lanes *)(in + i * in_stride);
    for (size_t i = 0; i < LANES; i += 2) {
        b[i] = __builtin_shufflevector(a[i], a[i + 1], 0, 8, 2, 10, 4, 12, 6, 14);
        b[i + 1] = __builtin_shufflevector(a[i], a[i + 1], 1, 9, 3, 11, 5, 13, 7, 15);
    }
    for (size_t i = 0; i < LANES; i += 4)
        for (size_t j = i; j < i + 2; j++) {
            a[j] = __builtin_shufflevector(b[j], b[j + 2], 0, 1, 8, 9, 4, 5, 12, 13);
            a[j + 2] = __builtin_shufflevector(b[j], b[j + 2], 2, 3, 10, 11, 6, 7, 14, 15);
        }
    for (size_t s = 0; s < 4; s++) {
        *(lanes *)(out + s * out_stride) =
            __builtin_shufflevector(a[s], a[s + 4], 0, 1, 2, 3, 8, 9, 10, 11);
        *(lanes *)(out + (s + 4) * out_stride) =
            __builtin_shufflevector(a[s], a[s + 4], 4, 5, 6, 7, 12, 13, 14, 15);
    }
}

KERNEL void to_time_order(const double *restrict block, double *restrict out)
{
    for (size_t half = 0; half < HALVES; half++)
        for (size_t i = 0; i < STEPS; i += LANES)
            transpose_lanes(block + i * SEGMENTS + half * LANES, SEGMENTS,
                            out + half * LANES * STEPS + i, STEPS);
}

KERNEL void to_segment_order(const double *restrict samples, double *restrict block)
{
    for (size_t half = 0; half < HALVES; half++)
        for (size_t i = 0; i < STEPS; i += LANES)
            transpose_lanes(samples + half * LANES * STEPS + i, STEPS,
                            block + i * SEGMENTS + half * LANES, SEGMENTS);
}

#endif
