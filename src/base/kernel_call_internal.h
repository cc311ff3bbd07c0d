/* SPDX-License-Identifier: Apache-2.0 */
/* The choice among the instruction sets a loop is compiled for, one file each: loop_portable,
 * loop_avx2, loop_avx512. The fastest one is the one that draws the normals, which random.h has
 * found to exist on this machine. */
#ifndef IMUKIT_KERNEL_CALL_INTERNAL_H
#define IMUKIT_KERNEL_CALL_INTERNAL_H

#include "imukit/random.h"

#if defined(__x86_64__) && defined(__GNUC__)
#define IMKI_CALL(kernel, loop, ...)                                                               \
    do {                                                                                           \
        if ((kernel) == IMK_KERNEL_AVX512)                                                         \
            loop##_avx512(__VA_ARGS__);                                                            \
        else if ((kernel) == IMK_KERNEL_AVX2)                                                      \
            loop##_avx2(__VA_ARGS__);                                                              \
        else                                                                                       \
            loop##_portable(__VA_ARGS__);                                                          \
    } while (0)
#else /* NEON is part of AArch64, so the compiler uses it in the portable loops */
#define IMKI_CALL(kernel, loop, ...) ((void)(kernel), loop##_portable(__VA_ARGS__))
#endif

#endif
