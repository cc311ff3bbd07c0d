/* SPDX-License-Identifier: Apache-2.0 */
/* What every generator does: check its arguments, and hand out blocks in pieces of any size. */
#include "generator_internal.h"

imk_status imki_check_noise(double strength, double dt)
{
    if (!isfinite(strength) || !isfinite(dt))
        return IMK_ERROR_NOT_FINITE;
    return strength >= 0.0 && dt > 0.0 ? IMK_OK : IMK_ERROR_RANGE;
}

void imki_powers(double phi, double *power)
{
    power[0] = 1.0;
    for (size_t i = 1; i <= IMK_NOISE_STEPS; i++)
        power[i] = power[i - 1] * phi;
}

void imki_add_blocks(imk_noise_block *block, void (*next)(void *state, double *block), void *state,
                     size_t count, double *out)
{
    for (size_t i = 0; i < count; i++) {
        if (block->used == IMK_NOISE_BLOCK) {
            for (size_t j = 0; j < IMK_NOISE_BLOCK; j++)
                block->sample[j] = 0.0;
            next(state, block->sample);
            block->used = 0;
        }
        out[i] += block->sample[imki_place(block->used++)];
    }
}
