/* SPDX-License-Identifier: Apache-2.0 */
/* Random walk of the output, point-sampled, from 0:
 *
 *     y[k+1] = y[k] + K sqrt(dt) n[k]
 *
 * Continuous: sigma_A^2 = K^2 tau/3 [IEEE952]. The mean of n points has other weights than an
 * integral: with step variance s^2 the difference of two neighbouring means is
 * sum_j w_j n[j] s with w rising 1/n … 1 and falling again, so that
 *
 *     sigma_A^2(n dt) = s^2 (2 n^2 + 1)/(6 n) = K^2 tau/3 (1 + 1/(2 n^2)).
 *
 * The steps are white, and the cosine transform (DCT-II) turns the walk's covariance into a
 * diagonal matrix exactly; its expected square is that of the spectrum K^2 dt^2/(4 sin^2(pi f dt)).
 */
#include "generator_internal.h"

double imk_random_walk_allan_variance(double k, double tau)
{
    return k * k * tau / 3.0;
}

double imk_random_walk_sampled_allan_variance(double k, double dt, size_t n)
{
    double m = (double)n;
    return k * k * dt * (m / 3.0 + 1.0 / (6.0 * m));
}

double imk_random_walk_sampled_spectrum(double k, double dt, double frequency)
{
    double amplitude = k * dt / (2.0 * imki_sin_half_turns(frequency * dt));
    return amplitude * amplitude;
}

imk_status imk_random_walk_start(imk_random_walk_state *state, double k, double dt,
                                 imk_random random, uint64_t stream)
{
    imk_status status = imki_check_noise(k, dt);
    if (status != IMK_OK)
        return status;
    *state = (imk_random_walk_state){
        .random = random, .stream = stream, .step = k * sqrt(dt), .block.used = IMK_NOISE_BLOCK};
    return IMK_OK;
}

imki_draw imki_random_walk_draw(const imk_random_walk_state *state, double *normals)
{
    return imki_draw_of(state->stream, state->next, IMK_NOISE_BLOCK, normals);
}

void imki_random_walk_block(imk_random_walk_state *state, const double *normals, double *block)
{
    state->next += IMK_NOISE_BLOCK;
    imki_add_sums(state->random.kernel, state->step, normals, &state->value, block);
}

static void next_block(void *state, double *block)
{
    imk_random_walk_state *walk = state;
    double normals[IMK_NOISE_BLOCK];
    const imki_draw draw = imki_random_walk_draw(walk, normals);
    imki_random_draws(walk->random, &draw, 1);
    imki_random_walk_block(walk, normals, block);
}

void imk_random_walk_add(imk_random_walk_state *state, size_t count, double *out)
{
    imki_add_blocks(&state->block, next_block, state, count, out);
}
