/* SPDX-License-Identifier: Apache-2.0 */
/* The rows of the stochastic terms. */
#include "noise_terms_internal.h"

const imki_noise_term *const imki_noise_terms[IMKI_NOISE_TERMS] = {
    &imki_white_term,        &imki_flicker_term,  &imki_random_walk_term,
    &imki_gauss_markov_term, &imki_sinusoid_term, &imki_resonance_term,
};

int imki_term_count(const imki_noise_term *term, const imk_noise *noise)
{
    return term->count ? term->count(noise) : 1;
}

const imki_generator *imki_term_generator(const imki_noise_term *term, imki_term_place place)
{
    const bool filtered = place.triad->bandwidth.value[place.axis] > 0.0;
    return filtered && term->filtered ? term->filtered : term->generator;
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
    if (g->generator->draws)
        imki_random_draws(g->random, draws, g->generator->draws(g->state, normals, draws));
    g->generator->blocks(g->state, 1, g->random.kernel, normals, block);
}

void imki_add_generated(const imki_generator *generator, void *state, imk_random random,
                        imk_noise_block *block, size_t count, double *out)
{
    generated g = {generator, state, random};
    imki_add_blocks(block, next_block, &g, count, out);
}
