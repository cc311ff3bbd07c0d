/* SPDX-License-Identifier: Apache-2.0 */
/* The output stage of sensors side by side with AVX-512. */
#if defined(__x86_64__) && defined(__GNUC__)
#include "sensor_kernel.h"

COMPILE_FOR(avx512, __attribute__((target("avx512f,avx512dq"))))
#else
typedef int imki_no_sensor_avx512; /* a translation unit is not empty */
#endif
