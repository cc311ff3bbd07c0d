/* SPDX-License-Identifier: Apache-2.0 */
/* White noise of the integrated output: each reading of the angle is the mean of continuous white
 * noise of density A over its sample, and the rate is the difference of two readings,
 *
 *     y[k] = A/sqrt(dt) (n[k] - n[k-1])/dt,
 *
 * so that sigma_A^2 = 3 A^2/(dt tau^2) exactly and S(f) = 4 A^2 sin^2(pi f dt)/dt^2, which is
 * A^2 (2 pi f)^2 of white phase noise at low frequencies [IEEE952], [RILEY2008]. */
#include "noise_terms_internal.h"

#include <string.h>

double imk_angle_white_allan_variance(double density, double dt, double tau)
{
    const double ratio = density / tau;
    return 3.0 * ratio * ratio / dt;
}

double imk_angle_white_sampled_allan_variance(double density, double dt, size_t n)
{
    return imk_angle_white_allan_variance(density, dt, (double)n * dt);
}

double imk_angle_white_sampled_spectrum(double density, double dt, double frequency)
{
    const double amplitude = 2.0 * density * imki_sin_half_turns(frequency * dt) / dt;
    return amplitude * amplitude;
}

imk_status imk_angle_white_start(imk_angle_white_state *state, double density, double dt,
                                 imk_random random, uint64_t stream)
{
    const imk_status status = imki_check_noise(density, dt);
    if (status != IMK_OK)
        return status;
    *state = (imk_angle_white_state){.random = random,
                                     .stream = stream,
                                     .step = density / (dt * sqrt(dt)),
                                     .block.used = IMK_NOISE_BLOCK};
    imk_random_normals(random, stream, IMKI_START_NORMAL, 1, &state->last);
    return IMK_OK;
}

static size_t draws(const void *state, double *normals, imki_draw *draw)
{
    const imk_angle_white_state *angle = state;
    draw[0] = imki_draw_of(angle->stream, angle->next, IMK_NOISE_BLOCK, normals);
    return 1;
}

/* In segment order the sample before is a row above, and that of the first row the last one of the
 * segment before. */
static void blocks(void *states, size_t count, imk_kernel kernel, double *normals, double *block)
{
    imk_angle_white_state *angle = states;
    double before[IMKI_SEGMENTS];
    const double *ends = normals + (IMK_NOISE_STEPS - 1) * IMKI_SEGMENTS;
    (void)count;
    before[0] = angle->last;
    memcpy(before + 1, ends, sizeof before - sizeof before[0]);
    angle->last = ends[IMKI_SEGMENTS - 1];
    for (size_t j = IMK_NOISE_BLOCK - 1; j >= IMKI_SEGMENTS; j--)
        normals[j] -= normals[j - IMKI_SEGMENTS];
    for (size_t s = 0; s < IMKI_SEGMENTS; s++)
        normals[s] -= before[s];
    imki_add_scaled(kernel, angle->step, normals, block);
    angle->next += IMK_NOISE_BLOCK;
}

static double strength(imki_term_place place)
{
    return place.triad->noise.angle_white.value[place.axis];
}

static imk_status start(void *state, imki_term_place place, double dt, imk_random random,
                        uint64_t stream)
{
    return imk_angle_white_start(state, strength(place), dt, random, stream);
}

static const imki_generator generator = {.state_size = IMKI_STATE_SIZE(imk_angle_white_state),
                                         .start = start,
                                         .field = "noise.angle_white",
                                         .refused = strength,
                                         .normals = IMK_NOISE_BLOCK,
                                         .draws = draws,
                                         .together = 1,
                                         .blocks = blocks};

void imk_angle_white_add(imk_angle_white_state *state, size_t count, double *out)
{
    imki_add_generated(&generator, state, state->random, &state->block, count, out);
}

static size_t processes(imki_term_place place, double dt, imki_process *process)
{
    return imki_one_process(process, IMKI_PROCESS_READING, strength(place) / sqrt(dt));
}

/* Over one stretch only its two ends count. */
static double mean_variance(imki_term_place place, double dt, double time)
{
    const double ratio = strength(place) / time;
    return 2.0 * ratio * ratio / dt;
}

const imki_noise_term imki_angle_white_term = {
    .path = {"noise.angle_white", "noise.velocity_white"},
    .text = {"gyro angle white noise", "accelerometer velocity white noise"},
    .stream = IMK_TERM_ANGLE_WHITE,
    .strength = strength,
    .generator = &generator,
    .processes = processes,
    .mean_variance = mean_variance};

/* ---- errors of readings whatever the rate ---------------------------------------------------- */

static double reading(imki_term_place place)
{
    return place.triad->noise.reading_noise.value[place.axis];
}

static imk_status start_reading(void *state, imki_term_place place, double dt, imk_random random,
                                uint64_t stream)
{
    return imk_angle_white_start(state, reading(place) * sqrt(dt), dt, random, stream);
}

static const imki_generator reading_generator = {.state_size =
                                                     IMKI_STATE_SIZE(imk_angle_white_state),
                                                 .start = start_reading,
                                                 .field = "noise.reading_noise",
                                                 .refused = reading,
                                                 .normals = IMK_NOISE_BLOCK,
                                                 .draws = draws,
                                                 .together = 1,
                                                 .blocks = blocks};

static size_t reading_processes(imki_term_place place, double dt, imki_process *process)
{
    (void)dt;
    return imki_one_process(process, IMKI_PROCESS_READING, reading(place));
}

static double reading_variance(imki_term_place place, double dt, double time)
{
    const double ratio = reading(place) / time;
    (void)dt;
    return 2.0 * ratio * ratio;
}

const imki_noise_term imki_reading_noise_term = {
    .path = {"noise.reading_noise", "noise.reading_noise"},
    .text = {"gyro reading noise", "accelerometer reading noise"},
    .stream = IMK_TERM_READING_NOISE,
    .strength = reading,
    .generator = &reading_generator,
    .processes = reading_processes,
    .mean_variance = reading_variance};
