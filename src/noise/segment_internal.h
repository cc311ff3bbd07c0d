/* SPDX-License-Identifier: Apache-2.0 */
/* The loops of generator_internal.h by instruction set. */
#ifndef IMUKIT_SEGMENT_INTERNAL_H
#define IMUKIT_SEGMENT_INTERNAL_H

#include "generator_internal.h"

#define IMKI_SEGMENT_LOOPS(isa)                                                                    \
    void imki_add_scaled_##isa(double scale, const double *normals, double *block);                \
    void imki_add_ramp_##isa(double per_sample, uint64_t first, double *block);                    \
    void imki_add_sinusoid_##isa(const imki_turning *turning, double *block);                      \
    void imki_add_arma_##isa(imki_arma_lanes *lanes_of, size_t half);                              \
    void imki_add_recursions_##isa(const imki_recursion *recursions, size_t count, double *block); \
    void imki_add_flicker_##isa(const imki_recursion *recursions, double held, double *change,     \
                                double *block);                                                    \
    void imki_add_sums_##isa(double gain, const double *normals, double *value, double *block);    \
    void imki_quantize_##isa(double lsb, double dt, double *residual, double *block);              \
    void imki_saturate_##isa(double dead_band, double range, double *block);                       \
    void imki_add_held_##isa(const double *held, size_t offset, double *block);                    \
    void imki_to_time_order_##isa(const double *block, double *out);                               \
    void imki_to_segment_order_##isa(const double *samples, double *block);                        \
    void imki_interleave_##isa(const double *const *blocks, double *out, size_t stride);
IMKI_SEGMENT_LOOPS(portable)
IMKI_SEGMENT_LOOPS(avx2)
IMKI_SEGMENT_LOOPS(avx512)

#endif
