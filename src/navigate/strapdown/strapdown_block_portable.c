/* SPDX-License-Identifier: Apache-2.0 */
/* The mechanisation in blocks in portable C, one at a time: for every processor, and the reference
 * of the other kernels. Where there is no multiply-add, the C library makes up for it, slowly. */
#include "strapdown_block_scalar.h"

void imki_block_run_portable(const imki_block_run *run)
{
    run_blocks(run);
}

void imki_block_end_portable(const imki_block_end *end, double carried[IMKI_ROWS])
{
    end_single(end, carried);
}
