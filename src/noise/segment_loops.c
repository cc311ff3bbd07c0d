/* SPDX-License-Identifier: Apache-2.0 */
/* The choice among the instruction sets segment_kernel.h is compiled for. The fastest one is the
 * one that draws the normals, which random.h has found to exist on this machine. */
#include "noise/segment_internal.h"

#if defined(__x86_64__) && defined(__GNUC__)
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
    CALL(kernel, imki_add_scaled, scale, normals, block);
}

void imki_add_recursions(imk_kernel kernel, const imki_recursion *recursions, size_t count,
                         double *block)
{
    CALL(kernel, imki_add_recursions, recursions, count, block);
}

void imki_add_flicker(imk_kernel kernel, const imki_recursion recursions[2], double held,
                      double *change, double *block)
{
    CALL(kernel, imki_add_flicker, recursions, held, change, block);
}

void imki_add_sums(imk_kernel kernel, double gain, const double *normals, double *value,
                   double *block)
{
    CALL(kernel, imki_add_sums, gain, normals, value, block);
}

void imki_quantize(imk_kernel kernel, double lsb, double dt, double *residual, double *block)
{
    CALL(kernel, imki_quantize, lsb, dt, residual, block);
}

void imki_saturate(imk_kernel kernel, double dead_band, double range, double *block)
{
    CALL(kernel, imki_saturate, dead_band, range, block);
}

void imki_add_held(imk_kernel kernel, const double *held, size_t offset, double *block)
{
    CALL(kernel, imki_add_held, held, offset, block);
}

void imki_to_time_order(imk_kernel kernel, const double *block, double *out)
{
    CALL(kernel, imki_to_time_order, block, out);
}

void imki_to_segment_order(imk_kernel kernel, const double *samples, double *block)
{
    CALL(kernel, imki_to_segment_order, samples, block);
}
