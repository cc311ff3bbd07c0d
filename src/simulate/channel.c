/* SPDX-License-Identifier: Apache-2.0 */
/* One channel: its response to the motion, its stochastic terms added block by block, and the
 * output stage
 *
 *     x -> bandwidth -> + noise -> dead band -> range -> quantization of the integral
 *       -> resolution -> counts.
 *
 * Samples are made in blocks of 512 counted from sample 0, so it does not matter how many are asked
 * for at a time. */
#include "model/distort_internal.h"
#include "simulate_internal.h"

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

static imk_status start_band_limit(imki_channel *channel, imki_axis axis, double part,
                                   imk_error *error)
{
    imk_low_pass filter = {axis.triad->bandwidth.value[axis.axis],
                           axis.triad->damping.value[axis.axis]};
    if (filter.bandwidth == 0.0)
        return IMK_OK;
    imk_status status = imki_check_low_pass(filter, part);
    if (status != IMK_OK)
        return refused(error, status, axis, "bandwidth", filter.bandwidth);
    imki_dynamics dynamics = imki_filter_dynamics(1.0, filter);
    imki_stretch stretch = imki_stretch_of_time(&dynamics, part);
    imki_band_limit *limit = &channel->band_limit;
    limit->present = true;
    for (int i = 0; i < 2; i++) {
        limit->mean[i] = stretch.g[i] / part;
        for (int j = 0; j < 2; j++)
            limit->phi[i][j] = stretch.phi[i][j];
    }
    return IMK_OK;
}

imk_status imki_channel_start(imki_channel *channel, imki_axis axis, double dt, size_t substeps,
                              imk_random random, uint32_t run, imk_error *error)
{
    channel->sensor = axis.sensor;
    channel->axis = axis.axis;
    channel->random = random;
    channel->kernel = random.kernel;
    channel->dead_band = axis.triad->dead_band.value[axis.axis];
    channel->range = axis.triad->range.value[axis.axis];
    channel->resolution = axis.triad->resolution.value[axis.axis];
    channel->sensitivity = axis.triad->sensitivity.value[axis.axis];
    channel->zero_offset = axis.triad->zero_offset.value[axis.axis];
    imk_status status = start_band_limit(channel, axis, dt / (double)substeps, error);
    if (status == IMK_OK)
        status = start_white(channel, axis, dt, random, run, error);
    if (status == IMK_OK)
        status = start_drifts(channel, axis, dt, random, run, error);
    if (status == IMK_OK)
        status = start_lists(channel, axis, dt, random, run, error);
    return status;
}

/* ---- the deterministic part ---- */

static void limit_band(imki_band_limit *limit, size_t count, double *signal)
{
    if (!limit->started) { /* as if the first input had lasted for ever */
        limit->x = signal[0];
        limit->v = 0.0;
        limit->started = true;
    }
    double x = limit->x, v = limit->v;
    for (size_t i = 0; i < count; i++) {
        double u = signal[i], away = x - u;
        signal[i] = u + (limit->mean[0] * away + limit->mean[1] * v);
        x = u + (limit->phi[0][0] * away + limit->phi[0][1] * v);
        v = limit->phi[1][0] * away + limit->phi[1][1] * v;
    }
    limit->x = x;
    limit->v = v;
}

/* The stimulus from part `first` on. */
static imk_stimulus later(const imk_stimulus *stimulus, size_t first)
{
    imk_stimulus s = *stimulus;
    for (int i = 0; i < 3; i++) {
        s.angular_rate[i] += first;
        s.specific_force[i] += first;
        if (s.angular_acceleration[i])
            s.angular_acceleration[i] += first;
    }
    if (s.temperature) {
        s.temperature += first;
        s.temperature_rate += first;
    }
    for (int i = 0; i < 2; i++) {
        if (s.warm_up[i])
            s.warm_up[i] += first;
        if (s.hysteresis[i])
            s.hysteresis[i] += first;
    }
    return s;
}

/* A unit at rest that warms up. */
static void respond_still(imki_channel *channel, const imk_distortion *distortion,
                          const imki_scene *scene, size_t part, size_t rows, double *out)
{
    imk_stimulus stimulus = scene->stimulus[channel->sensor];
    for (int i = 0; i < 2; i++)
        if (stimulus.warm_up[i])
            stimulus.warm_up[i] += part;
    const imki_exposure exposure = imki_expose(channel->sensor, &stimulus);
    imki_distort_still(distortion->kernel, &distortion->axis[channel->sensor][channel->axis],
                       &exposure, rows / IMKI_CHUNK, out);
    if (channel->band_limit.present)
        limit_band(&channel->band_limit, rows, out);
}

void imki_channel_response(imki_channel *channel, const imk_distortion *distortion,
                           const imki_scene *scene, size_t part, size_t rows, double *out)
{
    if (scene->still) {
        respond_still(channel, distortion, scene, part, rows, out);
        return;
    }
    IMKI_ALIGNED double parts[IMK_NOISE_BLOCK];
    const size_t substeps = scene->substeps;
    const size_t rows_at_once = IMK_NOISE_BLOCK / substeps;
    for (size_t row = 0; row < rows; row += rows_at_once) {
        const size_t now = rows - row < rows_at_once ? rows - row : rows_at_once;
        const size_t count = now * substeps;
        double *signal = substeps == 1 ? out + row : parts;
        imk_stimulus stimulus = later(&scene->stimulus[channel->sensor], part + row * substeps);
        imk_distort(distortion, channel->sensor, channel->axis, &stimulus, count, signal);
        if (channel->band_limit.present)
            limit_band(&channel->band_limit, count, signal);
        for (size_t k = 0; k < now && substeps > 1; k++) {
            double sum = parts[k * substeps];
            for (size_t j = 1; j < substeps; j++)
                sum += parts[k * substeps + j];
            out[row + k] = sum / (double)substeps;
        }
    }
}

static const imk_axis_response *axis_response(const imki_channel *channel,
                                              const imk_distortion *distortion)
{
    return &distortion->axis[channel->sensor][channel->axis];
}

void imki_channel_responses(size_t count, imki_channel *const *channels,
                            const imk_distortion *const *distortions, const imki_scene *scene,
                            size_t rows, double *const *out)
{
    const int sensor = channels[0]->sensor;
    const imk_axis_response *axes[IMKI_SIDE_BY_SIDE] = {axis_response(channels[0], distortions[0])};
    bool alike = scene->substeps == 1 && !scene->temperature && rows % IMKI_CHUNK == 0;
    for (size_t i = 1; alike && i < count; i++) {
        axes[i] = axis_response(channels[i], distortions[i]);
        alike = channels[i]->sensor == sensor && imki_axes_alike(axes[0], axes[i]);
    }
    if (!alike) {
        for (size_t i = 0; i < count; i++)
            imki_channel_response(channels[i], distortions[i], scene, 0, rows, out[i]);
        return;
    }
    const imki_exposure exposure = imki_expose(sensor, &scene->stimulus[sensor]);
    imki_distort_alike(distortions[0]->kernel, count, axes, &exposure, rows / IMKI_CHUNK, out);
    for (size_t i = 0; i < count; i++)
        if (channels[i]->band_limit.present)
            limit_band(&channels[i]->band_limit, rows, out[i]);
}

/* ---- noise and output ---- */

static void output_stage(imki_channel *channel, double *block)
{
    double step = channel->resolution;
    if (channel->dead_band > 0.0 || channel->range > 0.0)
        imki_saturate(channel->kernel, channel->dead_band,
                      channel->range > 0.0 ? channel->range : (double)INFINITY, block);
    imki_quantization_block(&channel->quantization, channel->kernel, block);
    if (step > 0.0)
        for (size_t j = 0; j < IMK_NOISE_BLOCK; j++)
            block[j] = step * imki_round(block[j] / step);
    if (channel->sensitivity != 0.0)
        for (size_t j = 0; j < IMK_NOISE_BLOCK; j++)
            block[j] = imki_round(channel->sensitivity * block[j] + channel->zero_offset);
}

/* Draws of up to IMKI_TOGETHER Gauss-Markov terms from `first` on. @return how many */
static size_t process_draws(const imki_channel *channel, size_t first, double *normals,
                            imki_draw *draws)
{
    const size_t left = (size_t)channel->gauss_markov_count - first;
    const size_t count = left < IMKI_TOGETHER ? left : IMKI_TOGETHER;
    for (size_t i = 0; i < count; i++)
        draws[i] = imki_gauss_markov_draw(&channel->gauss_markov[first + i],
                                          normals + i * IMK_NOISE_BLOCK);
    return count;
}

/* White noise, random walk, flicker and the first Gauss-Markov terms, their normals drawn in one
 * call; then the other Gauss-Markov terms. */
static void add_noise(imki_channel *channel, double *block)
{
    enum { BLOCK = IMK_NOISE_BLOCK, DRAWS = 5 + IMKI_TOGETHER };
    IMKI_ALIGNED double white[BLOCK], walk[BLOCK], flicker[IMKI_FLICKER_NORMALS];
    IMKI_ALIGNED double other[IMKI_TOGETHER * BLOCK];
    imki_draw draws[DRAWS];
    size_t count = 0;
    if (channel->white_present)
        draws[count++] = imki_white_draw(&channel->white, white);
    if (channel->random_walk_present)
        draws[count++] = imki_random_walk_draw(&channel->random_walk, walk);
    if (channel->flicker_present)
        count += imki_flicker_draws(&channel->flicker, flicker, draws + count);
    size_t processes = process_draws(channel, 0, other, draws + count);
    imki_random_draws(channel->random, draws, count + processes);
    if (channel->white_present)
        imki_white_block(&channel->white, white, block);
    if (channel->flicker_present)
        imki_flicker_block(&channel->flicker, flicker, block);
    if (channel->random_walk_present)
        imki_random_walk_block(&channel->random_walk, walk, block);
    imki_gauss_markov_blocks(channel->gauss_markov, processes, other, block);
    for (size_t first = processes; first < (size_t)channel->gauss_markov_count;
         first += processes) {
        processes = process_draws(channel, first, other, draws);
        imki_random_draws(channel->random, draws, processes);
        imki_gauss_markov_blocks(channel->gauss_markov + first, processes, other, block);
    }
}

/* The deterministic part, and the ramp, in segment order. */
static void begin_block(imki_channel *channel, bool constant, double *out)
{
    IMKI_ALIGNED double samples[IMK_NOISE_BLOCK];
    if (constant) {
        for (size_t j = 0; j < IMK_NOISE_BLOCK; j++)
            out[j] = channel->constant;
    } else {
        memcpy(samples, out, sizeof samples);
        imki_to_segment_order(channel->kernel, samples, out);
    }
    if (channel->ramp != 0.0)
        imki_add_ramp(channel->kernel, channel->ramp, channel->next, out);
}

static void end_block(imki_channel *channel, double *out)
{
    IMKI_ALIGNED double block[IMK_NOISE_BLOCK];
    memcpy(block, out, sizeof block);
    output_stage(channel, block);
    imki_to_time_order(channel->kernel, block, out);
    channel->next += IMK_NOISE_BLOCK;
}

/* Filtered white noise (instance -1) or the same resonance of each channel that has it. */
static void add_arma(size_t count, imki_channel *const *channels, int instance, double *const *out)
{
    imk_arma_state *states[IMKI_CHANNELS] = {NULL};
    double *blocks[IMKI_CHANNELS] = {NULL};
    size_t present = 0;
    for (size_t i = 0; i < count; i++) {
        imki_channel *channel = channels[i];
        if (instance < 0 ? !channel->arma_present : instance >= channel->resonance_count)
            continue;
        states[present] = instance < 0 ? &channel->arma : &channel->resonance[instance];
        blocks[present++] = out[i];
    }
    imki_arma_blocks(states, present, blocks);
}

/* Blocks stand in `out` in segment order until they are finished. */
void imki_channel_blocks(size_t count, imki_channel *const *channels, bool constant,
                         double *const *out)
{
    int resonances = 0;
    for (size_t i = 0; i < count; i++) {
        begin_block(channels[i], constant, out[i]);
        if (channels[i]->resonance_count > resonances)
            resonances = channels[i]->resonance_count;
    }
    add_arma(count, channels, -1, out);
    for (size_t i = 0; i < count; i++) {
        imki_channel *channel = channels[i];
        add_noise(channel, out[i]);
        for (int j = 0; j < channel->sinusoid_count; j++)
            imki_sinusoid_block(&channel->sinusoid[j], channel->kernel, out[i]);
    }
    for (int j = 0; j < resonances; j++)
        add_arma(count, channels, j, out);
    for (size_t i = 0; i < count; i++)
        end_block(channels[i], out[i]);
}
