/* SPDX-License-Identifier: Apache-2.0 */
/* The mechanisation in blocks with the multiply-add of x86-64, one at a time. Empty on other
 * processors. */
#if defined(__x86_64__) && defined(__FMA__)
#include "strapdown_block_scalar.h"

void imki_block_run_fma(const imki_block_run *run)
{
    run_blocks(run);
}

void imki_block_end_fma(const imki_block_end *end, double carried[IMKI_ROWS])
{
    end_single(end, carried);
}

#else
typedef int imki_strapdown_block_fma_is_empty; /* a translation unit may not be empty */
#endif
