/* SPDX-License-Identifier: Apache-2.0 */
/* segment_kernel.h compiled for each instruction set, and the choice among them. The fastest one is
 * the one that draws the normals, which random.h has found to exist on this machine. */
#include "noise/segment_kernel.h"

/* The loops compiled with one target attribute. */
#define COMPILE_FOR(isa, target)                                                                   \
    target static void add_scaled_##isa(double scale, const double *normals, double *block)        \
    {                                                                                              \
        add_scaled(scale, normals, block);                                                         \
    }                                                                                              \
    target static void add_recursion_##isa(double gain, const double *power,                       \
                                           const double *normals, double *value, double *block)    \
    {                                                                                              \
        add_recursion(gain, power, normals, value, block);                                         \
    }                                                                                              \
    target static void add_sums_##isa(double gain, const double *normals, double *value,           \
                                      double *block)                                               \
    {                                                                                              \
        add_sums(gain, normals, value, block);                                                     \
    }                                                                                              \
    target static void quantize_##isa(double lsb, double dt, double *residual, double *block)      \
    {                                                                                              \
        quantize(lsb, dt, residual, block);                                                        \
    }                                                                                              \
    target static void saturate_##isa(double dead_band, double range, double *block)               \
    {                                                                                              \
        saturate(dead_band, range, block);                                                         \
    }                                                                                              \
    target static void add_held_##isa(const double *held, size_t offset, double *block)            \
    {                                                                                              \
        add_held(held, offset, block);                                                             \
    }                                                                                              \
    target static void to_time_order_##isa(const double *block, double *out)                       \
    {                                                                                              \
        to_time_order(block, out);                                                                 \
    }                                                                                              \
    target static void to_segment_order_##isa(const double *samples, double *block)                \
    {                                                                                              \
        to_segment_order(samples, block);                                                          \
    }

COMPILE_FOR(portable, )

#if defined(__x86_64__) && defined(__GNUC__)
COMPILE_FOR(avx2, __attribute__((target("avx2"))))
COMPILE_FOR(avx512, __attribute__((target("avx512f,avx512dq"))))
#define CALL(kernel, loop, ...)                                                                    \
    do {                                                                                           \
        if ((kernel) == IMK_KERNEL_AVX512)                                                         \
            loop##_avx512(__VA_ARGS__);                                                            \
        else if ((kernel) == IMK_KERNEL_AVX2)                                                      \
            loop##_avx2(__VA_ARGS__);                                                              \
        else                                                                                       \
            loop##_portable(__VA_ARGS__);                                                          \
    } while (0)
#else /* NEON is part of AArch64, so the compiler uses it in the portable loops */
#define CALL(kernel, loop, ...) ((void)(kernel), loop##_portable(__VA_ARGS__))
#endif

void imki_add_scaled(imk_kernel kernel, double scale, const double *normals, double *block)
{
    CALL(kernel, add_scaled, scale, normals, block);
}

void imki_add_recursion(imk_kernel kernel, double gain, const double *power, const double *normals,
                        double *value, double *block)
{
    CALL(kernel, add_recursion, gain, power, normals, value, block);
}

void imki_add_sums(imk_kernel kernel, double gain, const double *normals, double *value,
                   double *block)
{
    CALL(kernel, add_sums, gain, normals, value, block);
}

void imki_quantize(imk_kernel kernel, double lsb, double dt, double *residual, double *block)
{
    CALL(kernel, quantize, lsb, dt, residual, block);
}

void imki_saturate(imk_kernel kernel, double dead_band, double range, double *block)
{
    CALL(kernel, saturate, dead_band, range, block);
}

void imki_add_held(imk_kernel kernel, const double *held, size_t offset, double *block)
{
    CALL(kernel, add_held, held, offset, block);
}

void imki_to_time_order(imk_kernel kernel, const double *block, double *out)
{
    CALL(kernel, to_time_order, block, out);
}

void imki_to_segment_order(imk_kernel kernel, const double *samples, double *block)
{
    CALL(kernel, to_segment_order, samples, block);
}
