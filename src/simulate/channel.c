/* SPDX-License-Identifier: Apache-2.0 */
/* One channel: its start, its response to the motion, and the output stage
 *
 *     x -> bandwidth -> + noise -> dead band -> range -> quantization of the integral
 *       -> resolution -> counts.
 *
 * Samples are made in blocks of 512 counted from sample 0, so it does not matter how many are asked
 * for at a time. */
#include "base/refuse_internal.h"
#include "model/distort_internal.h"
#include "simulate_internal.h"

#include <string.h>

/* Bytes of the states of a term, a multiple of 64. */
static size_t states_size(const imki_noise_term *term, imki_axis axis)
{
    imki_term_place place = {axis.triad, axis.axis, 0};
    const int count = imki_term_count(term, &axis.triad->noise);
    size_t present = 0;
    for (; place.instance < count; place.instance++)
        present += term->strength(place) != 0.0;
    const size_t size = present * imki_term_generator(term, place)->state_size;
    return imki_aligned(size);
}

size_t imki_channel_memory(imki_axis axis)
{
    size_t size = 0;
    for (int t = 0; t < IMKI_NOISE_TERMS; t++)
        size += states_size(imki_noise_terms[t], axis);
    return size;
}

/* A number of the model that does not fit the sample rate. */
typedef struct misfit {
    const char *field;
    double value;
} misfit;

/* The states of a term; elements of strength 0 on this axis take no part. The instance of a stream
 * is the place in the model's list. */
static imk_status start_term(imki_channel_term *made, const imki_noise_term *term, imki_axis axis,
                             double dt, imk_random random, uint32_t run, misfit *found)
{
    imki_term_place place = {axis.triad, axis.axis, 0};
    const imki_generator *generator = imki_term_generator(term, place);
    const int count = imki_term_count(term, &axis.triad->noise);
    _Alignas(16) unsigned char state[IMKI_STATE_MAX];
    made->generator = generator;
    for (; place.instance < count; place.instance++) {
        if (term->strength(place) == 0.0)
            continue;
        const uint64_t stream =
            imk_stream(run, term->stream, (uint8_t)place.instance, axis.stream_axis);
        const imk_status status = generator->start(state, place, dt, random, stream);
        if (status != IMK_OK) {
            *found = (misfit){generator->field, generator->refused(place)};
            return status;
        }
        memcpy(made->states + made->count++ * generator->state_size, state, generator->state_size);
    }
    return IMK_OK;
}

static imk_status start_terms(imki_channel *channel, imki_axis axis, double dt, imk_random random,
                              uint32_t run, imki_parts *memory, misfit *found)
{
    imk_status status = IMK_OK;
    for (int t = 0; t < IMKI_NOISE_TERMS && status == IMK_OK; t++) {
        const size_t size = states_size(imki_noise_terms[t], axis);
        channel->term[t].states = imki_take(memory, size);
        memset(channel->term[t].states, 0, size);
        status = start_term(&channel->term[t], imki_noise_terms[t], axis, dt, random, run, found);
    }
    if (status != IMK_OK)
        return status;
    const uint64_t stream = imk_stream(run, IMK_TERM_QUANTIZATION, 0, axis.stream_axis);
    const double q = axis.triad->noise.quantization.value[axis.axis];
    channel->ramp = axis.triad->noise.ramp.value[axis.axis] * dt;
    *found = (misfit){"noise.quantization", q};
    return imk_quantization_start(&channel->quantization, q, dt, random, stream);
}

imk_status imki_band_limit_start(imki_band_limit *limit, const imk_triad *triad, int axis,
                                 double part)
{
    imk_low_pass filter = {triad->bandwidth.value[axis], triad->damping.value[axis]};
    imki_stretch stretch;
    *limit = (imki_band_limit){.present = filter.bandwidth != 0.0};
    if (!limit->present)
        return IMK_OK;
    const imk_status status = imki_low_pass_over(filter, part, &stretch);
    if (status != IMK_OK)
        return status;
    for (int i = 0; i < 2; i++) {
        limit->mean[i] = stretch.g[i] / part;
        for (int j = 0; j < 2; j++)
            limit->phi[i][j] = stretch.phi[i][j];
    }
    return IMK_OK;
}

static imk_status refuse(imk_error *error, imk_status status, imki_axis axis, misfit found)
{
    char path[96] = "";
    size_t length = strlen(axis.kind);
    memcpy(path, axis.kind, length);
    path[length++] = '.';
    memcpy(path + length, found.field, strlen(found.field) + 1);
    return imki_refuse_at(error, status, path, (size_t)axis.axis, found.value, 0.0,
                          "a value that fits the sample rate (see noise.h)");
}

imk_status imki_channel_start(imki_channel *channel, imki_axis axis, double dt, size_t substeps,
                              imk_random random, uint32_t run, imki_parts *memory, imk_error *error)
{
    misfit found;
    channel->sensor = axis.sensor;
    channel->stimulus = axis.stimulus;
    channel->axis = axis.axis;
    channel->random = random;
    channel->kernel = random.kernel;
    channel->dead_band = axis.triad->dead_band.value[axis.axis];
    channel->range = axis.triad->range.value[axis.axis];
    channel->resolution = axis.triad->resolution.value[axis.axis];
    channel->sensitivity = axis.triad->sensitivity.value[axis.axis];
    channel->zero_offset = axis.triad->zero_offset.value[axis.axis];
    imk_status status =
        imki_band_limit_start(&channel->band_limit, axis.triad, axis.axis, dt / (double)substeps);
    found = (misfit){"bandwidth", axis.triad->bandwidth.value[axis.axis]};
    if (status == IMK_OK)
        status = start_terms(channel, axis, dt, random, run, memory, &found);
    return status == IMK_OK ? IMK_OK : refuse(error, status, axis, found);
}

/* ---- the deterministic part ---- */

void imki_limit_band(imki_band_limit *limit, size_t count, double *signal)
{
    if (!limit->started) { /* as if the first input had lasted for ever */
        limit->x = signal[0];
        limit->v = 0.0;
        limit->started = true;
    }
    double x = limit->x, v = limit->v;
    for (size_t i = 0; i < count; i++)
        signal[i] = imki_band_limited(limit, signal[i], &x, &v);
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
    imk_stimulus stimulus = scene->stimulus[channel->stimulus];
    for (int i = 0; i < 2; i++)
        if (stimulus.warm_up[i])
            stimulus.warm_up[i] += part;
    const imki_exposure exposure = imki_expose(channel->sensor, &stimulus);
    imki_distort_still(distortion->kernel, &distortion->axis[channel->sensor][channel->axis],
                       &exposure, rows / IMKI_CHUNK, out);
    if (channel->band_limit.present)
        imki_limit_band(&channel->band_limit, rows, out);
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
        imk_stimulus stimulus = later(&scene->stimulus[channel->stimulus], part + row * substeps);
        imk_distort(distortion, channel->sensor, channel->axis, &stimulus, count, signal);
        if (channel->band_limit.present)
            imki_limit_band(&channel->band_limit, count, signal);
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
    const int sensor = channels[0]->sensor, kind = channels[0]->stimulus;
    const imk_axis_response *axes[IMKI_SIDE_BY_SIDE] = {axis_response(channels[0], distortions[0])};
    bool alike = scene->substeps == 1 && !scene->temperature && rows % IMKI_CHUNK == 0;
    for (size_t i = 1; alike && i < count; i++) {
        axes[i] = axis_response(channels[i], distortions[i]);
        alike = channels[i]->stimulus == kind && imki_axes_alike(axes[0], axes[i]);
    }
    if (!alike) {
        for (size_t i = 0; i < count; i++)
            imki_channel_response(channels[i], distortions[i], scene, 0, rows, out[i]);
        return;
    }
    const imki_exposure exposure = imki_expose(sensor, &scene->stimulus[kind]);
    imki_distort_alike(distortions[0]->kernel, count, axes, &exposure, rows / IMKI_CHUNK, out);
    for (size_t i = 0; i < count; i++)
        if (channels[i]->band_limit.present)
            imki_limit_band(&channels[i]->band_limit, rows, out[i]);
}

/* ---- output ---- */

static void output_stage(imki_channel *channel, double *block)
{
    double step = channel->resolution;
    if (imki_saturates(channel))
        imki_saturate(channel->kernel, channel->dead_band, imki_end_of_range(channel), block);
    imki_quantization_block(&channel->quantization, channel->kernel, block);
    if (step > 0.0)
        for (size_t j = 0; j < IMK_NOISE_BLOCK; j++)
            block[j] = imki_to_resolution(step, block[j]);
    if (channel->sensitivity != 0.0)
        for (size_t j = 0; j < IMK_NOISE_BLOCK; j++)
            block[j] = imki_to_counts(channel, block[j]);
}

/* What the channel is exposed to, and its noise, in time order. */
static void finish_block(imki_channel *channel, bool constant, const double *noise, double *out)
{
    IMKI_ALIGNED double block[IMK_NOISE_BLOCK];
    if (constant)
        for (size_t j = 0; j < IMK_NOISE_BLOCK; j++)
            block[j] = channel->constant;
    else
        imki_to_segment_order(channel->kernel, out, block);
    imki_add_scaled(channel->kernel, 1.0, noise, block);
    output_stage(channel, block);
    imki_to_time_order(channel->kernel, block, out);
}

void imki_channel_blocks(size_t count, imki_channel *const *channels, bool constant,
                         double *const *out)
{
    double *noise[IMKI_CHANNELS] = {NULL};
    for (size_t i = 0; i < count; i++)
        noise[i] = channels[i]->noise;
    imki_channel_noise(count, channels, noise);
    for (size_t i = 0; i < count; i++)
        finish_block(channels[i], constant, noise[i], out[i]);
}
