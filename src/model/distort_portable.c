/* SPDX-License-Identifier: Apache-2.0 */
/* The loops of the forward and inverse map with SSE2, NEON, or what the compiler makes of pairs. */
#define LANES 2
#include "distort_kernel.h"

COMPILE_FOR(portable, )
