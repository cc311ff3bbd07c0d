/* SPDX-License-Identifier: Apache-2.0 */
/* The sensor that is stepped: what is refused, memory, start. */
#include "sensor_internal.h"

#include "base/refuse_internal.h"

#include <string.h>

enum { COOKIE = 0x5E450121 };

imk_sensor_settings imk_sensor_default(void)
{
    return (imk_sensor_settings){.cookie = COOKIE, .rate = 100.0, .count = 1};
}

/* ---- what is refused ---- */

static imk_status check_settings(const imk_sensor_settings *settings, imk_error *error)
{
    const double rate = settings->rate;
    if (settings->cookie != COOKIE)
        return imk_error_set(error, IMK_ERROR_UNINITIALISED, "settings", "",
                             "start from imk_sensor_default()");
    if (!(rate >= 1e-9 && rate <= 1e12))
        return imki_refuse(error, isfinite(rate) ? IMK_ERROR_RANGE : IMK_ERROR_NOT_FINITE, "rate",
                           rate, 0.0, "a rate between 1e-9 and 1e12 Hz");
    if (settings->count == 0)
        return imki_refuse(error, IMK_ERROR_RANGE, "count", 0.0, 1.0, "at least one sensor");
    if (settings->count - 1 > UINT32_MAX - settings->run)
        return imki_refuse(error, IMK_ERROR_RANGE, "count", (double)settings->count,
                           (double)(UINT32_MAX - settings->run) + 1.0,
                           "run numbers below 2^32: sensor i has the run number run + i");
    return IMK_OK;
}

/* What moves samples in time. */
static imk_status check_timing(const imk_timing *timing, imk_error *error)
{
    static const char *const name[] = {"timing.rate_error", "timing.jitter", "timing.skew"};
    const double value[] = {timing->rate_error.value, timing->jitter.value, timing->skew.value};
    for (int i = 0; i < 3; i++)
        if (value[i] != 0.0)
            return imki_refuse(error, IMK_ERROR_CONFLICT, name[i], value[i], 0.0,
                               "0: the truth of a step is known for its own interval only");
    return IMK_OK;
}

static imk_status check(const imk_model *model, const imk_sensor_settings *settings, bool memory,
                        size_t memory_size, imk_error *error)
{
    if (!model || !settings)
        return imk_error_set(error, IMK_ERROR_ARGUMENT, model ? "settings" : "model", "NULL", "");
    imk_status status = imk_model_validate(model, error);
    if (status == IMK_OK)
        status = check_settings(settings, error);
    if (status == IMK_OK)
        status = check_timing(&model->timing, error);
    if (status != IMK_OK)
        return status;
    if (!memory)
        return imk_error_set(error, IMK_ERROR_ARGUMENT, "memory", "NULL", "memory");
    const size_t size = imk_sensor_size(model, settings);
    if (size == 0)
        return imki_refuse(error, IMK_ERROR_RANGE, "count", (double)settings->count, 0.0,
                           "no more sensors than this machine can address");
    if (memory_size < size)
        return imki_refuse(error, IMK_ERROR_WORKSPACE, "memory", (double)memory_size, (double)size,
                           "imk_sensor_size() bytes");
    return IMK_OK;
}

/* ---- memory ---- */

static bool has_hysteresis(const imk_sensor_settings *settings, const imk_triad *triad)
{
    return settings->temperature && imki_triad_has(triad, &triad->bias.hysteresis);
}

static size_t states_of(const imk_model *model, size_t channels)
{
    size_t size = 0;
    for (size_t c = 0; c < channels; c++)
        size += imki_channel_memory(imki_axis_of(model, c));
    return size;
}

static size_t channels_of(const imk_model *model)
{
    return imki_axes_of(&model->gyro) + imki_axes_of(&model->accel);
}

/* Take all parts; *sensor gets them if there is memory. What begins as 0 comes first.
 * @return bytes that begin as 0 */
static size_t divide(const imk_model *model, const imk_sensor_settings *settings, imki_parts *parts,
                     imk_sensor **sensor)
{
    const size_t channels = channels_of(model), count = settings->count;
    const size_t places = imki_sensor_places(count), block = IMK_NOISE_BLOCK * sizeof(double);
    const size_t scratch = count == 1 ? 0 : IMKI_INTERLEAVED * block;
    imk_sensor made = {.count = count, .places = places, .channels = channels};
    *sensor = imki_take(parts, sizeof made);
    made.channel = imki_take(parts, count * channels * sizeof *made.channel);
    made.response = imki_take(parts, imki_row_places(count) * sizeof(double));
    made.number = imki_take(parts, IMKI_SENSOR_NUMBERS * channels * places * sizeof(double));
    made.rows = imki_take(parts, IMKI_SENSOR_ROWS * imki_row_places(count) * sizeof(double));
    const size_t zero = parts->used;
    made.axis = imki_take(parts, channels * sizeof *made.axis);
    made.quantizer = imki_take(parts, channels * sizeof *made.quantizer);
    for (int kind = 0; kind < 2; kind++)
        if (has_hysteresis(settings, kind == IMK_GYRO ? &model->gyro : &model->accel))
            made.hysteresis[kind] = imki_take(parts, count * sizeof(imk_hysteresis));
    made.noise = imki_take(parts, imki_noise_places(count == 1, count) * channels * block);
    if (count > IMKI_GROUP)
        made.rest = imki_take(parts, imki_noise_places(false, count) * channels * IMKI_LEAD *
                                         sizeof(double));
    made.block = imki_take(parts, scratch);
    if (*sensor) {
        memset(*sensor, 0, zero);
        **sensor = made;
    }
    return zero;
}

size_t imk_sensor_size(const imk_model *model, const imk_sensor_settings *settings)
{
    imki_parts group = {NULL, 0}, parts = {NULL, 0};
    imk_sensor_settings of_group = *settings;
    imk_sensor *none;
    of_group.count = 2 * IMKI_GROUP;
    divide(model, &of_group, &group, &none);
    const size_t states = states_of(model, channels_of(model));
    const size_t one = group.used / IMKI_GROUP + 64 + states; /* more than a sensor needs */
    if (settings->count == 0 || settings->count > SIZE_MAX / 2 / one - IMKI_GROUP)
        return 0;
    divide(model, settings, &parts, &none);
    imki_take(&parts, settings->count * states);
    return imki_parts_size(&parts);
}

/* ---- start ---- */

/* The rows of what the sensors see; memory was set to 0. */
static void start_exposure(imk_sensor *s, const imk_model *model,
                           const imk_sensor_settings *settings)
{
    imk_stimulus stimulus = {.temperature = NULL};
    for (int i = 0; i < 3; i++) {
        stimulus.angular_rate[i] = imki_sensor_row(s, i);
        stimulus.specific_force[i] = imki_sensor_row(s, IMKI_SENSOR_FORCE + i);
        stimulus.angular_acceleration[i] = imki_sensor_row(s, IMKI_SENSOR_ACCELERATION + i);
    }
    s->temperature = settings->temperature;
    if (s->temperature) {
        stimulus.temperature = imki_sensor_row(s, IMKI_SENSOR_TEMPERATURE);
        stimulus.temperature_rate = imki_sensor_row(s, IMKI_SENSOR_TEMPERATURE_RATE);
    }
    s->shared_hysteresis = true;
    for (int kind = 0; kind < 2; kind++) {
        const imk_triad *triad = kind == IMK_GYRO ? &model->gyro : &model->accel;
        s->of_kind[kind] = imki_axes_of(triad);
        s->warm_up_time[kind] = triad->bias.warm_up_time.value;
        s->same_warm_up = stimulus.warm_up[0] && s->warm_up_time[0] == s->warm_up_time[1];
        if (imki_triad_has(triad, &triad->bias.warm_up_amplitude))
            stimulus.warm_up[kind] =
                imki_sensor_row(s, IMKI_SENSOR_WARM_UP + (s->same_warm_up ? 0 : kind));
        for (size_t i = 0; i < s->count && s->hysteresis[kind]; i++)
            s->hysteresis[kind][i] = imk_hysteresis_start(triad);
        s->same_hysteresis = s->hysteresis[0] && s->hysteresis[1] &&
                             s->hysteresis[0][0].span == s->hysteresis[1][0].span;
        if (s->hysteresis[kind])
            stimulus.hysteresis[kind] =
                imki_sensor_row(s, IMKI_SENSOR_HYSTERESIS + (s->same_hysteresis ? 0 : kind));
    }
    for (int kind = 0; kind < 2; kind++)
        s->exposure[kind] = imki_expose(kind, &stimulus);
}

/* What differs between the sensors of a channel. */
static void start_numbers(imk_sensor *s, imki_axis axis, size_t channel, size_t i)
{
    const imk_axis_response *response = &s->axis[channel];
    double bias, scale;
    imki_draw_constants(axis, s->random, s->run + (uint32_t)i, &bias, &scale);
    imki_sensor_numbers(s, IMKI_SENSOR_BIAS, channel)[i] = response->bias + bias;
    imki_sensor_numbers(s, IMKI_SENSOR_SCALE, channel)[i] = response->scale + scale + 0.0;
    imki_sensor_numbers(s, IMKI_SENSOR_FILTER, channel)[i] = (double)NAN;
    imki_sensor_numbers(s, IMKI_SENSOR_RESIDUAL, channel)[i] =
        s->channel[i * s->channels + channel].quantization.residual;
}

static imk_status start_channels(imk_sensor *s, const imk_model *model, imki_parts *memory,
                                 imk_error *error)
{
    for (size_t i = 0; i < s->count; i++)
        for (size_t c = 0; c < s->channels; c++) {
            const imki_axis axis = imki_axis_of(model, c);
            const imk_status status =
                imki_channel_start(&s->channel[i * s->channels + c], axis, s->interval, 1,
                                   s->random, s->run + (uint32_t)i, memory, error);
            if (status != IMK_OK)
                return status;
            start_numbers(s, axis, c, i);
        }
    for (size_t c = 0; c < s->channels; c++)
        s->quantizer[c] =
            imki_quantizer_of(s->channel[c].quantization.lsb, s->channel[c].quantization.dt);
    return IMK_OK;
}

static imk_status start_responses(imk_sensor *s, const imk_model *model, imk_error *error)
{
    imk_distortion distortion;
    const imk_status status =
        imk_distortion_start(&distortion, model, NULL, s->random.kernel, error);
    for (size_t c = 0; c < s->channels && status == IMK_OK; c++) {
        const imki_axis axis = imki_axis_of(model, c);
        s->axis[c] = distortion.axis[axis.sensor][axis.axis];
    }
    return status;
}

imk_status imk_sensor_start(const imk_model *model, const imk_sensor_settings *settings,
                            imk_sensor **sensor, void *memory, size_t memory_size, imk_error *error)
{
    imk_status status = check(model, settings, memory != NULL, memory_size, error);
    if (status != IMK_OK)
        return status;
    if (!sensor)
        return imk_error_set(error, IMK_ERROR_ARGUMENT, "sensor", "NULL", "");
    imki_parts parts = imki_parts_of(memory);
    imk_sensor *made;
    divide(model, settings, &parts, &made);
    made->random = imk_random_seeded(settings->seed);
    made->run = settings->run;
    made->drops = model->timing.drops.value;
    made->interval = 1.0 / settings->rate;
    start_exposure(made, model, settings);
    status = start_responses(made, model, error);
    if (status == IMK_OK)
        status = start_channels(made, model, &parts, error);
    if (status != IMK_OK)
        return status;
    for (size_t first = 0; first < made->count; first += IMKI_GROUP)
        imki_sensor_make_noise(made, first);
    *sensor = made;
    return IMK_OK;
}

size_t imk_sensor_channels(const imk_sensor *sensor)
{
    return sensor->channels;
}

bool imk_sensor_dropped(const imk_sensor *sensor, size_t number, uint64_t row)
{
    return imki_row_dropped(sensor->random, sensor->run + (uint32_t)number, sensor->drops, row);
}
