/* SPDX-License-Identifier: Apache-2.0 */
/* White noise: the mean of continuous white noise of density N over each sample,
 *
 *     y[k] = N/sqrt(dt) n[k],   Allan variance N^2/tau,   S(f) = N^2   [IEEE952]  */
#include "generator_internal.h"

double imk_white_allan_variance(double density, double tau)
{
    return density * density / tau;
}

double imk_white_sampled_allan_variance(double density, double dt, size_t n)
{
    return density * density / ((double)n * dt);
}

double imk_white_sampled_spectrum(double density, double dt, double frequency)
{
    (void)dt;
    (void)frequency;
    return density * density;
}

imk_status imk_white_start(imk_white_state *state, double density, double dt, imk_random random,
                           uint64_t stream)
{
    imk_status status = imki_check_noise(density, dt);
    if (status != IMK_OK)
        return status;
    *state = (imk_white_state){.random = random,
                               .stream = stream,
                               .sigma = density / sqrt(dt),
                               .block.used = IMK_NOISE_BLOCK};
    return IMK_OK;
}

imki_draw imki_white_draw(const imk_white_state *state, double *normals)
{
    return imki_draw_of(state->stream, state->next, IMK_NOISE_BLOCK, normals);
}

void imki_white_block(imk_white_state *state, const double *normals, double *block)
{
    state->next += IMK_NOISE_BLOCK;
    imki_add_scaled(state->random.kernel, state->sigma, normals, block);
}

static void next_block(void *state, double *block)
{
    imk_white_state *white = state;
    double normals[IMK_NOISE_BLOCK];
    const imki_draw draw = imki_white_draw(white, normals);
    imki_random_draws(white->random, &draw, 1);
    imki_white_block(white, normals, block);
}

void imk_white_add(imk_white_state *state, size_t count, double *out)
{
    imki_add_blocks(&state->block, next_block, state, count, out);
}
