/* SPDX-License-Identifier: Apache-2.0 */
/* The loops over a block in segment order, to be compiled for each instruction set with vectors of
 * LANES lanes, the width of its registers. A step of the 16 segments is a few vectors. Each element
 * sees the same operations in the same order whatever these are. */
#ifndef IMUKIT_SEGMENT_KERNEL_H
#define IMUKIT_SEGMENT_KERNEL_H

#include "base/sine_internal.h"
#include "segment_internal.h"

#define KERNEL static inline __attribute__((always_inline))

enum { STEPS = IMK_NOISE_STEPS, SEGMENTS = IMKI_SEGMENTS, VECTORS = SEGMENTS / LANES };
enum { TOGETHER = 2 }; /* recursions */

/* Blocks are arrays of double of any alignment. */
typedef double lanes __attribute__((vector_size(8 * LANES), aligned(8), may_alias));

#define AT(block, i, v) (*(lanes *)((block) + (i)*SEGMENTS + (v)*LANES))
#define CONST_AT(block, i, v) (*(const lanes *)((block) + (i)*SEGMENTS + (v)*LANES))

KERNEL void add_scaled(double scale, const double *restrict normals, double *restrict block)
{
    for (size_t i = 0; i < STEPS; i++)
        for (size_t v = 0; v < VECTORS; v++)
            AT(block, i, v) += scale * CONST_AT(normals, i, v);
}

KERNEL void add_ramp(double per_sample, uint64_t first, double *restrict block)
{
    double start[SEGMENTS];
    for (size_t s = 0; s < SEGMENTS; s++)
        start[s] = (double)(first + s * STEPS);
    for (size_t i = 0; i < STEPS; i++)
        for (size_t v = 0; v < VECTORS; v++)
            AT(block, i, v) += per_sample * (CONST_AT(start, 0, v) + (double)(int)i);
}

/* The sines of all segments' starts are a plain loop, which the compiler turns into vectors. */
KERNEL void add_sinusoid(const imki_turning *turning, double *restrict block)
{
    IMKI_ALIGNED double angle[SEGMENTS], sine[SEGMENTS], cosine[SEGMENTS];
    for (size_t s = 0; s < SEGMENTS; s++)
        angle[s] = imki_angle(turning->phase + s * STEPS * turning->step);
    for (size_t s = 0; s < SEGMENTS; s++) {
        double at_sine, at_cosine;
        imki_sine_and_cosine(angle[s], &at_sine, &at_cosine);
        sine[s] = turning->amplitude * at_sine;
        cosine[s] = turning->amplitude * at_cosine;
    }
    for (size_t i = 0; i < STEPS; i++)
        for (size_t v = 0; v < VECTORS; v++)
            AT(block, i, v) += CONST_AT(sine, 0, v) * turning->turn_cosine[i] +
                               CONST_AT(cosine, 0, v) * turning->turn_sine[i];
}

/* A recursion of single values, which waits for itself all the time: it is given two steps whenever
 * something else is done. */
typedef struct chain {
    double phi, last;
    double *next;
} chain;

KERNEL void two_links(chain *c)
{
    c->next[0] = c->last = c->phi * c->last + c->next[0];
    c->next[1] = c->last = c->phi * c->last + c->next[1];
    c->next += 2;
}

/* `count` is a constant where this is called. The sums of one recursion wait for each other: those
 * of the others fill the time. */
KERNEL void add_together(const imki_recursion *recursions, size_t count, chain *beside,
                         double *restrict block)
{
    IMKI_ALIGNED double start[TOGETHER][SEGMENTS];
    double carried[TOGETHER];
    lanes now[TOGETHER][VECTORS] = {{{0.0}}};
    imki_recursion r[TOGETHER];
    for (size_t c = 0; c < count; c++) {
        r[c] = recursions[c];
        carried[c] = *r[c].value;
    }
    for (size_t i = 0; i < STEPS; i++) {
        for (size_t c = 0; c < count; c++)
            for (size_t v = 0; v < VECTORS; v++)
                AT(r[c].normals, i, v) = now[c][v] =
                    r[c].power[1] * now[c][v] + CONST_AT(r[c].normals, i, v);
        if (beside)
            two_links(beside);
    }
    for (size_t s = 0; s < SEGMENTS; s++)
        for (size_t c = 0; c < count; c++) {
            start[c][s] = carried[c];
            carried[c] = r[c].power[STEPS] * carried[c] + r[c].normals[(STEPS - 1) * SEGMENTS + s];
        }
    for (size_t c = 0; c < count; c++)
        *r[c].value = carried[c];
    for (size_t i = 0; i < STEPS; i++) {
        for (size_t v = 0; v < VECTORS; v++) {
            lanes sum = AT(block, i, v);
            for (size_t c = 0; c < count; c++)
                sum += r[c].gain * (CONST_AT(r[c].normals, i, v) +
                                    r[c].power[i + 1] * CONST_AT(start[c], 0, v));
            AT(block, i, v) = sum;
        }
        if (beside)
            two_links(beside);
    }
}

KERNEL void add_recursions(const imki_recursion *r, size_t count, double *restrict block)
{
    for (; count >= TOGETHER; r += TOGETHER, count -= TOGETHER)
        add_together(r, TOGETHER, NULL, block);
    if (count > 0)
        add_together(r, 1, NULL, block);
}

KERNEL void add_flicker(const imki_recursion *r, double held, double *change,
                        double *restrict block)
{
    chain beside = {r[1].power[1], held, change};
    add_together(r, 2, &beside, block);
}

KERNEL void add_sums(double gain, const double *restrict normals, double *restrict value,
                     double *restrict block)
{
    IMKI_ALIGNED double local[IMK_NOISE_BLOCK], total[SEGMENTS], start[SEGMENTS];
    lanes now[VECTORS] = {{0.0}};
    for (size_t i = 0; i < STEPS; i++)
        for (size_t v = 0; v < VECTORS; v++) {
            AT(local, i, v) = now[v];
            now[v] += CONST_AT(normals, i, v);
        }
    for (size_t v = 0; v < VECTORS; v++)
        AT(total, 0, v) = now[v];
    double carried = *value;
    for (size_t s = 0; s < SEGMENTS; s++) {
        start[s] = carried;
        carried += total[s];
    }
    *value = carried;
    for (size_t i = 0; i < STEPS; i++)
        for (size_t v = 0; v < VECTORS; v++)
            AT(block, i, v) += gain * (CONST_AT(local, i, v) + CONST_AT(start, 0, v));
}

KERNEL void quantize(double lsb, double dt, double *restrict residual, double *restrict block)
{
    const double per_step = 1.0 / lsb, rate_step = lsb / dt, shift = 0x1.8p52;
    IMKI_ALIGNED double local[IMK_NOISE_BLOCK], start[SEGMENTS];
    lanes now[VECTORS] = {{0.0}};
    for (size_t i = 0; i < STEPS; i++)
        for (size_t v = 0; v < VECTORS; v++)
            AT(local, i, v) = now[v] = now[v] + CONST_AT(block, i, v) * dt;
    double carried = *residual;
    for (size_t s = 0; s < SEGMENTS; s++) {
        start[s] = carried;
        double integral = carried + local[(STEPS - 1) * SEGMENTS + s];
        carried = integral - imki_round(integral * per_step) * lsb;
    }
    *residual = carried;
    /* Vector by vector: the first one need not wait for the segments of the others. */
    for (size_t v = 0; v < VECTORS; v++) {
        const lanes before = CONST_AT(start, 0, v);
        lanes counted = {0.0};
        for (size_t i = 0; i < STEPS; i++) {
            lanes steps = (before + CONST_AT(local, i, v)) * per_step;
            steps = (steps + shift) - shift; /* imki_round() of all lanes */
            AT(block, i, v) = (steps - counted) * rate_step;
            counted = steps;
        }
    }
}

/* Plain loops: comparisons of vectors are taken apart by the compiler. */
KERNEL void saturate(double dead_band, double range, double *restrict block)
{
    for (size_t j = 0; j < IMK_NOISE_BLOCK; j++)
        block[j] = imki_saturated(block[j], dead_band, range);
}

enum { ROWS = 8 };
typedef double row __attribute__((vector_size(8 * ROWS), aligned(8), may_alias));

/* Transpose 8 rows of 8: pairs of elements, then pairs of pairs, then halves change places between
 * vectors. */
KERNEL void transpose_rows(row a[ROWS])
{
    row b[ROWS];
    for (size_t i = 0; i < ROWS; i += 2) {
        b[i] = __builtin_shufflevector(a[i], a[i + 1], 0, 8, 2, 10, 4, 12, 6, 14);
        b[i + 1] = __builtin_shufflevector(a[i], a[i + 1], 1, 9, 3, 11, 5, 13, 7, 15);
    }
    for (size_t i = 0; i < ROWS; i += 4)
        for (size_t j = i; j < i + 2; j++) {
            a[j] = __builtin_shufflevector(b[j], b[j + 2], 0, 1, 8, 9, 4, 5, 12, 13);
            a[j + 2] = __builtin_shufflevector(b[j], b[j + 2], 2, 3, 10, 11, 6, 7, 14, 15);
        }
    for (size_t s = 0; s < 4; s++) {
        b[s] = __builtin_shufflevector(a[s], a[s + 4], 0, 1, 2, 3, 8, 9, 10, 11);
        b[s + 4] = __builtin_shufflevector(a[s], a[s + 4], 4, 5, 6, 7, 12, 13, 14, 15);
    }
    for (size_t s = 0; s < ROWS; s++)
        a[s] = b[s];
}

KERNEL void transpose(const double *restrict in, size_t in_stride, double *restrict out,
                      size_t out_stride)
{
    row a[ROWS];
    for (size_t i = 0; i < ROWS; i++)
        a[i] = *(const row *)(in + i * in_stride);
    transpose_rows(a);
    for (size_t i = 0; i < ROWS; i++)
        *(row *)(out + i * out_stride) = a[i];
}

/* Eight sequences side by side, in lanes: transposed 8 samples at a time, advanced sample by
 * sample, and transposed again into the segments of each block. y[k-1] comes last: only one
 * multiplication and addition wait for the sample before. */
KERNEL void add_arma(imki_arma_lanes *l, size_t half)
{
    enum { HALF = IMK_NOISE_BLOCK / 2 };
    IMKI_ALIGNED row y[HALF];
    row e[ROWS], y1 = *(row *)l->y1, y2 = *(row *)l->y2;
    row e1 = *(row *)l->e1, e2 = *(row *)l->e2;
    const row a1 = *(row *)l->a1, a2 = *(row *)l->a2;
    const row b0 = *(row *)l->b0, b1 = *(row *)l->b1, b2 = *(row *)l->b2;
    for (size_t k = 0; k < HALF; k += ROWS) {
        for (size_t lane = 0; lane < ROWS; lane++)
            e[lane] = *(const row *)(l->normals[lane] + k);
        transpose_rows(e);
        for (size_t i = 0; i < ROWS; i++) {
            row now = (b0 * e[i] + b1 * e1 + b2 * e2) + a2 * y2;
            now += a1 * y1;
            y[k + i] = now;
            y2 = y1;
            y1 = now;
            e2 = e1;
            e1 = e[i];
        }
    }
    *(row *)l->y1 = y1;
    *(row *)l->y2 = y2;
    *(row *)l->e1 = e1;
    *(row *)l->e2 = e2;
    for (size_t i = 0; i < STEPS; i++) {
        for (size_t s = 0; s < ROWS; s++)
            e[s] = y[s * STEPS + i];
        transpose_rows(e);
        for (size_t lane = 0; lane < l->count; lane++)
            *(row *)(l->block[lane] + i * SEGMENTS + half * ROWS) += e[lane];
    }
}

enum { HOLDS = STEPS / 4 }; /* in a segment */

/* The last hold of a segment is also the first one of the next when the offset is not 0. */
KERNEL void add_held(const double *restrict held, size_t offset, double *restrict block)
{
    IMKI_ALIGNED double parts[(HOLDS + 1) * SEGMENTS];
    for (size_t s = 0; s < SEGMENTS; s += ROWS)
        transpose(held + s * HOLDS, HOLDS, parts + s, SEGMENTS);
    for (size_t s = 0; s < SEGMENTS && offset > 0; s++)
        parts[HOLDS * SEGMENTS + s] = held[HOLDS * (s + 1)];
    for (size_t i = 0; i < STEPS; i++)
        for (size_t v = 0; v < VECTORS; v++)
            AT(block, i, v) += CONST_AT(parts, (i + offset) / 4, v);
}

KERNEL void to_time_order(const double *restrict block, double *restrict out)
{
    for (size_t s = 0; s < SEGMENTS; s += ROWS)
        for (size_t i = 0; i < STEPS; i += ROWS)
            transpose(block + i * SEGMENTS + s, SEGMENTS, out + s * STEPS + i, STEPS);
}

KERNEL void to_segment_order(const double *restrict samples, double *restrict block)
{
    for (size_t s = 0; s < SEGMENTS; s += ROWS)
        for (size_t i = 0; i < STEPS; i += ROWS)
            transpose(samples + s * STEPS + i, STEPS, block + i * SEGMENTS + s, SEGMENTS);
}

KERNEL void interleave(const double *const *blocks, double *restrict out, size_t stride)
{
    row a[ROWS];
    for (size_t s = 0; s < SEGMENTS; s += ROWS)
        for (size_t i = 0; i < STEPS; i++) {
            for (size_t k = 0; k < ROWS; k++)
                a[k] = *(const row *)(blocks[k] + i * SEGMENTS + s);
            transpose_rows(a);
            for (size_t k = 0; k < ROWS; k++)
                *(row *)(out + ((s + k) * STEPS + i) * stride) = a[k];
        }
}

/* The loops as functions of one instruction set. */
#define COMPILE_FOR(isa, target)                                                                   \
    target void imki_add_scaled_##isa(double scale, const double *normals, double *block)          \
    {                                                                                              \
        add_scaled(scale, normals, block);                                                         \
    }                                                                                              \
    target void imki_add_ramp_##isa(double per_sample, uint64_t first, double *block)              \
    {                                                                                              \
        add_ramp(per_sample, first, block);                                                        \
    }                                                                                              \
    target void imki_add_sinusoid_##isa(const imki_turning *turning, double *block)                \
    {                                                                                              \
        add_sinusoid(turning, block);                                                              \
    }                                                                                              \
    target void imki_add_arma_##isa(imki_arma_lanes *lanes_of, size_t half)                        \
    {                                                                                              \
        add_arma(lanes_of, half);                                                                  \
    }                                                                                              \
    target void imki_add_recursions_##isa(const imki_recursion *recursions, size_t count,          \
                                          double *block)                                           \
    {                                                                                              \
        add_recursions(recursions, count, block);                                                  \
    }                                                                                              \
    target void imki_add_flicker_##isa(const imki_recursion *recursions, double held,              \
                                       double *change, double *block)                              \
    {                                                                                              \
        add_flicker(recursions, held, change, block);                                              \
    }                                                                                              \
    target void imki_add_sums_##isa(double gain, const double *normals, double *value,             \
                                    double *block)                                                 \
    {                                                                                              \
        add_sums(gain, normals, value, block);                                                     \
    }                                                                                              \
    target void imki_quantize_##isa(double lsb, double dt, double *residual, double *block)        \
    {                                                                                              \
        quantize(lsb, dt, residual, block);                                                        \
    }                                                                                              \
    target void imki_saturate_##isa(double dead_band, double range, double *block)                 \
    {                                                                                              \
        saturate(dead_band, range, block);                                                         \
    }                                                                                              \
    target void imki_add_held_##isa(const double *held, size_t offset, double *block)              \
    {                                                                                              \
        add_held(held, offset, block);                                                             \
    }                                                                                              \
    target void imki_to_time_order_##isa(const double *block, double *out)                         \
    {                                                                                              \
        to_time_order(block, out);                                                                 \
    }                                                                                              \
    target void imki_to_segment_order_##isa(const double *samples, double *block)                  \
    {                                                                                              \
        to_segment_order(samples, block);                                                          \
    }                                                                                              \
    target void imki_interleave_##isa(const double *const *blocks, double *out, size_t stride)     \
    {                                                                                              \
        interleave(blocks, out, stride);                                                           \
    }

#endif
