/* SPDX-License-Identifier: Apache-2.0 */
/* Sinusoid of random phase, y[k] = a sin(2 pi (p + k f dt)).
 *
 * The phase is an unsigned count of 2^-64 cycles, whose overflow is the wrap to the next cycle: it
 * is exact at any k, and f is off by at most 2^-65/dt. Within a segment of 32 samples the sine
 * turns by the addition theorem from the segment's start, which costs one sine and cosine per
 * segment and an error of 2 ulp of a. */
#include "noise_terms_internal.h"

double imk_sinusoid_allan_variance(imk_sinusoid sinusoid, double tau)
{
    double cycles = sinusoid.frequency * tau;
    double sine = imki_sin_half_turns(cycles);
    double amplitude = sinusoid.amplitude * sine * sine / (IMKI_PI * cycles);
    return cycles > 0.0 ? amplitude * amplitude : 0.0;
}

/* The mean of n samples has the amplitude sin(pi n c)/(n sin(pi c)) a, c = f dt, and the difference
 * of two of them n samples apart 2 sin(pi n c) times that:
 *     sigma_A^2 = a^2 (sin^2(pi n c)/(n sin(pi c)))^2.
 * At whole c every sample is the same and both sines vanish. */
double imk_sinusoid_sampled_allan_variance(imk_sinusoid sinusoid, double dt, size_t n)
{
    double cycles = sinusoid.frequency * dt;
    cycles -= floor(cycles);
    double divisor = (double)n * imki_sin_half_turns(cycles);
    double sine = imki_sin_half_turns((double)n * cycles);
    if (divisor == 0.0)
        return 0.0;
    double amplitude = sinusoid.amplitude * sine * sine / divisor;
    return amplitude * amplitude;
}

imk_status imk_sinusoid_start(imk_sinusoid_state *state, imk_sinusoid sinusoid, double dt,
                              imk_random random, uint64_t stream)
{
    imk_status status = imki_check_noise(sinusoid.amplitude, dt);
    if (status != IMK_OK)
        return status;
    if (!isfinite(sinusoid.frequency))
        return IMK_ERROR_NOT_FINITE;
    double cycles = sinusoid.frequency * dt;
    if (!(sinusoid.frequency > 0.0) || !(cycles < 0x1p52))
        return IMK_ERROR_RANGE;
    cycles -= floor(cycles);
    uint32_t words[2];
    imk_random_words(random, stream, IMKI_START_WORD, 2, words);
    *state = (imk_sinusoid_state){.amplitude = sinusoid.amplitude,
                                  .phase = (uint64_t)words[1] << 32 | words[0],
                                  .step = (uint64_t)(cycles * 0x1p64),
                                  .block.used = IMK_NOISE_BLOCK};
    for (size_t i = 0; i < IMK_NOISE_STEPS; i++) {
        double angle = imki_angle(state->step * i);
        state->turn_sine[i] = imk_sin(angle);
        state->turn_cosine[i] = imk_cos(angle);
    }
    return IMK_OK;
}

static void blocks(void *states, size_t count, imk_kernel kernel, double *normals, double *block)
{
    imk_sinusoid_state *s = states;
    (void)count;
    (void)normals;
    const imki_turning turning = {s->amplitude, s->phase, s->step, s->turn_sine, s->turn_cosine};
    imki_add_sinusoid(kernel, &turning, block);
    s->phase += s->step * IMK_NOISE_BLOCK;
}

static imk_sinusoid sinusoid_at(imki_term_place place)
{
    const struct imk_sinusoid_term *term = &place.triad->noise.sinusoid[place.instance];
    return (imk_sinusoid){term->amplitude.value[place.axis], term->frequency.value[place.axis]};
}

static double strength(imki_term_place place)
{
    return sinusoid_at(place).amplitude;
}

static double frequency(imki_term_place place)
{
    return sinusoid_at(place).frequency;
}

static imk_status start(void *state, imki_term_place place, double dt, imk_random random,
                        uint64_t stream)
{
    return imk_sinusoid_start(state, sinusoid_at(place), dt, random, stream);
}

static const imki_generator generator = {.state_size = IMKI_STATE_SIZE(imk_sinusoid_state),
                                         .start = start,
                                         .field = "noise.sinusoid",
                                         .refused = frequency,
                                         .together = 1,
                                         .blocks = blocks};

/* The state knows no instruction set; a block is short enough for any. */
void imk_sinusoid_add(imk_sinusoid_state *state, size_t count, double *out)
{
    const imk_random any = {.kernel = IMK_KERNEL_SCALAR};
    imki_add_generated(&generator, state, any, &state->block, count, out);
}

static int count(const imk_noise *noise)
{
    return noise->sinusoid_count;
}

static size_t processes(imki_term_place place, double dt, imki_process *process)
{
    (void)dt;
    const size_t one = imki_one_process(process, IMKI_PROCESS_SINE, strength(place));
    process->frequency = frequency(place);
    return one;
}

static double mean_variance(imki_term_place place, double dt, double time)
{
    (void)dt;
    return imk_sinusoid_allan_variance(sinusoid_at(place), time);
}

const imki_noise_term imki_sinusoid_term = {.path = {"noise.sinusoid", "noise.sinusoid"},
                                            .text = {"gyro sinusoid", "accelerometer sinusoid"},
                                            .stream = IMK_TERM_SINUSOID,
                                            .count = count,
                                            .strength = strength,
                                            .generator = &generator,
                                            .processes = processes,
                                            .mean_variance = mean_variance};
