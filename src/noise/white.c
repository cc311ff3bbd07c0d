/* SPDX-License-Identifier: Apache-2.0 */
/* White noise: the mean of continuous white noise of density N over each sample,
 *
 *     y[k] = N/sqrt(dt) n[k],   Allan variance N^2/tau,   S(f) = N^2   [IEEE952]  */
#include "noise_terms_internal.h"

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

static size_t draws(const void *state, double *normals, imki_draw *draw)
{
    const imk_white_state *white = state;
    draw[0] = imki_draw_of(white->stream, white->next, IMK_NOISE_BLOCK, normals);
    return 1;
}

static void blocks(void *states, size_t count, imk_kernel kernel, double *normals, double *block)
{
    imk_white_state *white = states;
    (void)count;
    imki_add_scaled(kernel, white->sigma, normals, block);
    white->next += IMK_NOISE_BLOCK;
}

static double strength(imki_term_place place)
{
    return place.triad->noise.white.value[place.axis];
}

static imk_status start(void *state, imki_term_place place, double dt, imk_random random,
                        uint64_t stream)
{
    return imk_white_start(state, strength(place), dt, random, stream);
}

static const imki_generator generator = {.state_size = IMKI_STATE_SIZE(imk_white_state),
                                         .start = start,
                                         .field = "noise.white",
                                         .refused = strength,
                                         .normals = IMK_NOISE_BLOCK,
                                         .draws = draws,
                                         .together = 1,
                                         .blocks = blocks};

void imk_white_add(imk_white_state *state, size_t count, double *out)
{
    imki_add_generated(&generator, state, state->random, &state->block, count, out);
}

static size_t processes(imki_term_place place, double dt, imki_process *process)
{
    (void)dt;
    return imki_one_process(process, IMKI_PROCESS_WHITE, strength(place));
}

static double mean_variance(imki_term_place place, double dt, double time)
{
    (void)dt;
    return imk_white_allan_variance(strength(place), time);
}

const imki_noise_term imki_white_term = {
    .path = {"noise.angle_random_walk", "noise.velocity_random_walk"},
    .text = {"gyro angle random walk", "accelerometer velocity random walk"},
    .stream = IMK_TERM_WHITE,
    .strength = strength,
    .generator = &generator,
    .filtered = &imki_filtered_white,
    .processes = processes,
    .mean_variance = mean_variance};
