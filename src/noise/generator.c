/* SPDX-License-Identifier: Apache-2.0 */
/* What every generator does: check its arguments, and hand out blocks in pieces of any size. */
#include "noise_terms_internal.h"

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

size_t imki_one_process(imki_process *process, imki_process_kind kind, double size)
{
    *process = (imki_process){.kind = kind, .size = size, .share = 1.0};
    return 1;
}

/* What imki_add_blocks() hands on. */
typedef struct generated {
    const imki_generator *generator;
    void *state;
    imk_random random;
} generated;

static void next_block(void *context, double *block)
{
    const generated *g = context;
    double normals[IMKI_FLICKER_NORMALS];
    imki_draw draws[IMKI_DRAWS_MAX];
    if (g->generator->draws) {
        const size_t count = g->generator->draws(g->state, normals, draws);
        imki_random_draws(g->random, draws, count);
    }
    g->generator->blocks(g->state, 1, g->random.kernel, normals, block);
}

void imki_add_generated(const imki_generator *generator, void *state, imk_random random,
                        imk_noise_block *block, size_t count, double *out)
{
    generated g = {generator, state, random};
    imki_add_blocks(block, next_block, &g, count, out);
}
