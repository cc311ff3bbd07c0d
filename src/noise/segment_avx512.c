/* SPDX-License-Identifier: Apache-2.0 */
/* The loops over a block in segment order with AVX-512. */
#if defined(__x86_64__) && defined(__GNUC__)
#define LANES 8
#include "segment_kernel.h"

COMPILE_FOR(avx512, __attribute__((target("avx512f,avx512dq"))))
#else
typedef int imki_no_segment_avx512; /* a translation unit is not empty */
#endif
