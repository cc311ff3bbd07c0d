/* SPDX-License-Identifier: Apache-2.0 */
/* The loops over a block in segment order with AVX2. */
#if defined(__x86_64__) && defined(__GNUC__)
#define LANES 4
#include "segment_kernel.h"

COMPILE_FOR(avx2, __attribute__((target("avx2"))))
#else
typedef int imki_no_segment_avx2; /* a translation unit is not empty */
#endif
