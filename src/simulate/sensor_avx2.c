/* SPDX-License-Identifier: Apache-2.0 */
/* The output stage of sensors side by side with AVX2. */
#if defined(__x86_64__) && defined(__GNUC__)
#include "sensor_kernel.h"

COMPILE_FOR(avx2, __attribute__((target("avx2"))))
#else
typedef int imki_no_sensor_avx2; /* a translation unit is not empty */
#endif
