/* SPDX-License-Identifier: Apache-2.0 */
/* The choice among the instruction sets distort_kernel.h is compiled for. The fastest one is the
 * one that draws the normals, which random.h has found to exist on this machine. */
#include "distort_internal.h"

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

void imki_distort_chunks(imk_kernel kernel, const imk_axis_response *axis,
                         const imki_exposure *exposure, size_t chunks, double *out)
{
    CALL(kernel, imki_distort_chunks, axis, exposure, chunks, out);
}

void imki_residual(imk_kernel kernel, size_t chunks, const double *reading, double *response)
{
    CALL(kernel, imki_residual, chunks, reading, response);
}

void imki_add_residual(imk_kernel kernel, size_t chunks, double gain, const double *residual,
                       double *sum)
{
    CALL(kernel, imki_add_residual, chunks, gain, residual, sum);
}

void imki_limit(imk_kernel kernel, size_t chunks, double limit, double *x)
{
    CALL(kernel, imki_limit, chunks, limit, x);
}
