/* SPDX-License-Identifier: Apache-2.0 */
/* The loops of the forward and inverse map with AVX2. */
#if defined(__x86_64__) && defined(__GNUC__)
#define LANES 4
#include "distort_kernel.h"

COMPILE_FOR(avx2, __attribute__((target("avx2"))))
#else
typedef int imki_no_avx2; /* a translation unit is not empty */
#endif
