/* SPDX-License-Identifier: Apache-2.0 */
/* One channel: its stochastic terms added block by block, and the output stage
 *
 *     x -> range -> quantization of the integral -> resolution -> counts.
 *
 * Samples are made in blocks of 512 counted from sample 0, so it does not matter how many are asked
 * for at a time. */
#include "simulate/simulate_internal.h"

#include <string.h>

/* Dotted path of a parameter that a generator has refused. */
static imk_status refused(imk_error *error, imk_status status, imki_axis axis, const char *field,
                          double value)
{
    char path[96] = "";
    size_t length = strlen(axis.kind);
    memcpy(path, axis.kind, length);
    path[length++] = '.';
    memcpy(path + length, field, strlen(field) + 1);
    imk_error_set(error, status, path, "", "a value that fits the sample rate (see noise.h)");
    if (error) {
        error->index = axis.axis;
        error->value = value;
    }
    return status;
}

static imk_status start_white(imki_channel *channel, imki_axis axis, double dt, imk_random random,
                              uint32_t run, imk_error *error)
{
    int i = axis.axis;
    double density = axis.triad->noise.white.value[i];
    imk_low_pass filter = {axis.triad->bandwidth.value[i], axis.triad->damping.value[i]};
    uint64_t stream = imk_stream(run, IMK_TERM_WHITE, 0, axis.stream_axis);
    if (density == 0.0)
        return IMK_OK;
    imk_status status;
    channel->arma_present = filter.bandwidth > 0.0;
    channel->white_present = !channel->arma_present;
    if (channel->arma_present) {
        status = imk_filtered_white_start(&channel->arma, density, filter, dt, random, stream);
        return status == IMK_OK ? status
                                : refused(error, status, axis, "bandwidth", filter.bandwidth);
    }
    status = imk_white_start(&channel->white, density, dt, random, stream);
    return status == IMK_OK ? status : refused(error, status, axis, "noise.white", density);
}

static imk_status start_drifts(imki_channel *channel, imki_axis axis, double dt, imk_random random,
                               uint32_t run, imk_error *error)
{
    const imk_noise *noise = &axis.triad->noise;
    double instability = noise->bias_instability.value[axis.axis];
    double walk = noise->random_walk.value[axis.axis], q = noise->quantization.value[axis.axis];
    imk_status status;
    channel->flicker_present = instability != 0.0;
    status = imk_flicker_start(&channel->flicker, instability, dt, random,
                               imk_stream(run, IMK_TERM_FLICKER, 0, axis.stream_axis));
    if (status != IMK_OK)
        return refused(error, status, axis, "noise.bias_instability", instability);
    channel->random_walk_present = walk != 0.0;
    status = imk_random_walk_start(&channel->random_walk, walk, dt, random,
                                   imk_stream(run, IMK_TERM_RANDOM_WALK, 0, axis.stream_axis));
    if (status != IMK_OK)
        return refused(error, status, axis, "noise.random_walk", walk);
    status = imk_quantization_start(&channel->quantization, q, dt, random,
                                    imk_stream(run, IMK_TERM_QUANTIZATION, 0, axis.stream_axis));
    if (status != IMK_OK)
        return refused(error, status, axis, "noise.quantization", q);
    channel->ramp = noise->ramp.value[axis.axis] * dt;
    return IMK_OK;
}

/* Terms of strength 0 on this axis take no part; the instance is the place in the model's list. */
static imk_status start_lists(imki_channel *channel, imki_axis axis, double dt, imk_random random,
                              uint32_t run, imk_error *error)
{
    const imk_noise *noise = &axis.triad->noise;
    int i = axis.axis;
    for (int j = 0; j < noise->gauss_markov_count; j++) {
        imk_gauss_markov process = {noise->gauss_markov[j].sigma.value[i],
                                    noise->gauss_markov[j].correlation_time.value[i]};
        if (process.sigma == 0.0)
            continue;
        uint64_t stream = imk_stream(run, IMK_TERM_GAUSS_MARKOV, (uint8_t)j, axis.stream_axis);
        imk_status status = imk_gauss_markov_start(
            &channel->gauss_markov[channel->gauss_markov_count++], process, dt, random, stream);
        if (status != IMK_OK)
            return refused(error, status, axis, "noise.gauss_markov", process.correlation_time);
    }
    for (int j = 0; j < noise->sinusoid_count; j++) {
        imk_sinusoid sinusoid = {noise->sinusoid[j].amplitude.value[i],
                                 noise->sinusoid[j].frequency.value[i]};
        if (sinusoid.amplitude == 0.0)
            continue;
        uint64_t stream = imk_stream(run, IMK_TERM_SINUSOID, (uint8_t)j, axis.stream_axis);
        imk_status status = imk_sinusoid_start(&channel->sinusoid[channel->sinusoid_count++],
                                               sinusoid, dt, random, stream);
        if (status != IMK_OK)
            return refused(error, status, axis, "noise.sinusoid", sinusoid.frequency);
    }
    for (int j = 0; j < noise->resonance_count; j++) {
        imk_resonance resonance = {noise->resonance[j].sigma.value[i],
                                   noise->resonance[j].frequency.value[i],
                                   noise->resonance[j].q.value[i]};
        if (resonance.sigma == 0.0)
            continue;
        uint64_t stream = imk_stream(run, IMK_TERM_RESONANCE, (uint8_t)j, axis.stream_axis);
        imk_status status = imk_resonance_start(&channel->resonance[channel->resonance_count++],
                                                resonance, dt, random, stream);
        if (status != IMK_OK)
            return refused(error, status, axis, "noise.resonance", resonance.frequency);
    }
    return IMK_OK;
}

imk_status imki_channel_start(imki_channel *channel, imki_axis axis, double dt, imk_random random,
                              uint32_t run, imk_error *error)
{
    channel->kernel = random.kernel;
    channel->range = axis.triad->range.value[axis.axis];
    channel->resolution = axis.triad->resolution.value[axis.axis];
    channel->sensitivity = axis.triad->sensitivity.value[axis.axis];
    channel->zero_offset = axis.triad->zero_offset.value[axis.axis];
    channel->used = IMK_NOISE_BLOCK;
    imk_status status = start_white(channel, axis, dt, random, run, error);
    if (status == IMK_OK)
        status = start_drifts(channel, axis, dt, random, run, error);
    if (status == IMK_OK)
        status = start_lists(channel, axis, dt, random, run, error);
    return status;
}

static void output_stage(imki_channel *channel, double *block)
{
    double range = channel->range, step = channel->resolution;
    if (range > 0.0)
        for (size_t j = 0; j < IMK_NOISE_BLOCK; j++) {
            double low = block[j] < -range ? -range : block[j];
            block[j] = low > range ? range : low;
        }
    imki_quantization_block(&channel->quantization, channel->kernel, block);
    if (step > 0.0)
        for (size_t j = 0; j < IMK_NOISE_BLOCK; j++)
            block[j] = step * imki_round(block[j] / step);
    if (channel->sensitivity != 0.0)
        for (size_t j = 0; j < IMK_NOISE_BLOCK; j++)
            block[j] = imki_round(channel->sensitivity * block[j] + channel->zero_offset);
}

/* The next 512 samples, in time order. */
static void channel_block(imki_channel *channel, double *out)
{
    double block[IMK_NOISE_BLOCK];
    for (size_t j = 0; j < IMK_NOISE_BLOCK; j++)
        block[j] = channel->constant;
    if (channel->ramp != 0.0)
        for (size_t k = 0; k < IMK_NOISE_BLOCK; k++)
            block[imki_place(k)] += channel->ramp * (double)(channel->next + k);
    if (channel->white_present)
        imki_white_block(&channel->white, block);
    if (channel->arma_present)
        imki_arma_block(&channel->arma, block);
    if (channel->flicker_present)
        imki_flicker_block(&channel->flicker, block);
    if (channel->random_walk_present)
        imki_random_walk_block(&channel->random_walk, block);
    for (int i = 0; i < channel->gauss_markov_count; i++)
        imki_gauss_markov_block(&channel->gauss_markov[i], block);
    for (int i = 0; i < channel->sinusoid_count; i++)
        imki_sinusoid_block(&channel->sinusoid[i], block);
    for (int i = 0; i < channel->resonance_count; i++)
        imki_arma_block(&channel->resonance[i], block);
    output_stage(channel, block);
    imki_to_time_order(channel->kernel, block, out);
    channel->next += IMK_NOISE_BLOCK;
}

void imki_channel_next(imki_channel *channel, size_t count, double *out)
{
    size_t done = 0;
    while (done < count) {
        if (channel->used == IMK_NOISE_BLOCK && count - done >= IMK_NOISE_BLOCK) {
            channel_block(channel, out + done);
            done += IMK_NOISE_BLOCK;
            continue;
        }
        if (channel->used == IMK_NOISE_BLOCK) {
            channel_block(channel, channel->sample);
            channel->used = 0;
        }
        size_t left = IMK_NOISE_BLOCK - channel->used;
        size_t take = count - done < left ? count - done : left;
        memcpy(out + done, channel->sample + channel->used, take * sizeof *out);
        channel->used += take;
        done += take;
    }
}
