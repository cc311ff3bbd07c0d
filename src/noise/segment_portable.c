/* SPDX-License-Identifier: Apache-2.0 */
/* The loops over a block in segment order with SSE2, NEON, or what the compiler makes of pairs. */
#define LANES 2
#include "segment_kernel.h"

COMPILE_FOR(portable, )
