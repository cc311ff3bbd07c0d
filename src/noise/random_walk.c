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
#include "noise_terms_internal.h"

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

static size_t draws(const void *state, double *normals, imki_draw *draw)
{
    const imk_random_walk_state *walk = state;
    draw[0] = imki_draw_of(walk->stream, walk->next, IMK_NOISE_BLOCK, normals);
    return 1;
}

static void blocks(void *states, size_t count, imk_kernel kernel, double *normals, double *block)
{
    imk_random_walk_state *walk = states;
    (void)count;
    imki_add_sums(kernel, walk->step, normals, &walk->value, block);
    walk->next += IMK_NOISE_BLOCK;
}

static double strength(imki_term_place place)
{
    return place.triad->noise.random_walk.value[place.axis];
}

static imk_status start(void *state, imki_term_place place, double dt, imk_random random,
                        uint64_t stream)
{
    return imk_random_walk_start(state, strength(place), dt, random, stream);
}

static const imki_generator generator = {.state_size = IMKI_STATE_SIZE(imk_random_walk_state),
                                         .start = start,
                                         .field = "noise.random_walk",
                                         .refused = strength,
                                         .normals = IMK_NOISE_BLOCK,
                                         .draws = draws,
                                         .together = 1,
                                         .blocks = blocks};

void imk_random_walk_add(imk_random_walk_state *state, size_t count, double *out)
{
    imki_add_generated(&generator, state, state->random, &state->block, count, out);
}

static size_t processes(imki_term_place place, double dt, imki_process *process)
{
    (void)dt;
    return imki_one_process(process, IMKI_PROCESS_WALK, strength(place));
}

static double mean_variance(imki_term_place place, double dt, double time)
{
    (void)dt;
    return imk_random_walk_allan_variance(strength(place), time);
}

const imki_noise_term imki_random_walk_term = {
    .path = {"noise.rate_random_walk", "noise.acceleration_random_walk"},
    .text = {"gyro rate random walk", "accelerometer acceleration random walk"},
    .stream = IMK_TERM_RANDOM_WALK,
    .strength = strength,
    .generator = &generator,
    .processes = processes,
    .mean_variance = mean_variance};
