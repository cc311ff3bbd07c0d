/* SPDX-License-Identifier: Apache-2.0 */
/* The steps of a sensor. The terms are those of the simulator: deterministic ones by the loops of
 * distort_kernel.h, over sensors instead of samples; noise in blocks of 512 samples, which do not
 * depend on the motion; then the output stage. */
#include "sensor_internal.h"

#include <string.h>

/* ---- noise ---- */

/* The blocks of a single sensor, made where they stay. */
static void make_noise_of_one(imk_sensor *s)
{
    IMKI_ALIGNED double block[IMK_NOISE_BLOCK];
    imki_channel *channels[IMKI_CHANNELS];
    double *noise[IMKI_CHANNELS];
    for (size_t c = 0; c < s->channels; c++) {
        channels[c] = &s->channel[c];
        noise[c] = s->noise + c * IMK_NOISE_BLOCK;
    }
    imki_channel_noise(s->channels, channels, noise);
    for (size_t c = 0; c < s->channels; c++) {
        memcpy(block, noise[c], sizeof block);
        imki_to_time_order(s->random.kernel, block, noise[c]);
    }
}

/* The blocks of a channel of eight sensors, side by side. Those that are not there have the noise
 * of the first one. */
static void make_noise_of_eight(imk_sensor *s, size_t first, size_t channel, double *noise,
                                size_t places)
{
    enum { EIGHT = IMKI_INTERLEAVED };
    const size_t count = s->count - first < EIGHT ? s->count - first : EIGHT;
    imki_channel *channels[EIGHT];
    double *blocks[EIGHT];
    const double *made[EIGHT];
    for (size_t i = 0; i < EIGHT; i++) {
        const size_t at = i < count ? i : 0;
        channels[i] = &s->channel[(first + at) * s->channels + channel];
        made[i] = blocks[i] = s->block + at * IMK_NOISE_BLOCK;
    }
    imki_channel_noise(count, channels, blocks);
    imki_interleave(s->random.kernel, made, noise, places);
}

void imki_sensor_make_noise(imk_sensor *s, size_t first)
{
    if (s->count == 1) {
        make_noise_of_one(s);
        return;
    }
    const size_t places = imki_group_places(s, first);
    double *noise = imki_group_noise(s, first);
    for (size_t i = 0; i < places; i += IMKI_INTERLEAVED)
        for (size_t c = 0; c < s->channels; c++)
            make_noise_of_eight(s, first + i, c, noise + c * IMK_NOISE_BLOCK * places + i, places);
}

/* The next block of a group whose turn it is; what is left of the one before is kept. */
static void refill(imk_sensor *s, size_t first)
{
    const size_t lead = imki_lead(s, first), places = imki_group_places(s, first);
    if (s->next == 0 || (s->next + lead) % IMK_NOISE_BLOCK != 0)
        return;
    const double *left = imki_group_noise(s, first) + (IMK_NOISE_BLOCK - lead) * places;
    for (size_t c = 0; c < s->channels && lead > 0; c++)
        memcpy(imki_group_rest(s, first) + c * IMKI_LEAD * places,
               left + c * IMK_NOISE_BLOCK * places, lead * places * sizeof *left);
    imki_sensor_make_noise(s, first);
}

/* The noise of this step of the first channel of a group. @param stride  to the next channel */
static const double *noise_now(const imk_sensor *s, size_t first, size_t *stride)
{
    const size_t within = (size_t)(s->next % IMK_NOISE_BLOCK), places = imki_group_places(s, first);
    const size_t until = IMK_NOISE_BLOCK - imki_lead(s, first);
    *stride = (within < until ? (size_t)IMK_NOISE_BLOCK : (size_t)IMKI_LEAD) * places;
    return within < until ? imki_group_noise(s, first) + within * places
                          : imki_group_rest(s, first) + (within - until) * places;
}

/* ---- truth ---- */

static void repeat(double value, size_t places, double *row)
{
    for (size_t i = 0; i < places; i++)
        row[i] = value;
}

/* The same number; NaN instead of an infinite one, which the range of the output would hide. */
static double told(double truth)
{
    return truth + 0.0 * truth;
}

/* One truth for all. */
static void expose_all(imk_sensor *s, const imk_sensor_truth *truth)
{
    const size_t places = imki_row_places(s->count);
    for (int i = 0; i < 3; i++) {
        repeat(told(truth->angular_rate[i]), places, imki_sensor_row(s, i));
        repeat(told(truth->specific_force[i]), places, imki_sensor_row(s, IMKI_SENSOR_FORCE + i));
        repeat(told(truth->angular_acceleration[i]), places,
               imki_sensor_row(s, IMKI_SENSOR_ACCELERATION + i));
    }
    repeat(told(truth->temperature), places, imki_sensor_row(s, IMKI_SENSOR_TEMPERATURE));
    repeat(told(truth->temperature_rate), places, imki_sensor_row(s, IMKI_SENSOR_TEMPERATURE_RATE));
}

static void take(const double *truth, size_t first, size_t count, double *row)
{
    for (size_t i = 0; i < count; i++)
        row[i] = truth ? told(truth[first + i]) : 0.0;
}

/* Those of a group. */
static void expose_each(imk_sensor *s, const imk_stimulus *truth, size_t first, size_t count)
{
    for (int i = 0; i < 3; i++) {
        take(truth->angular_rate[i], first, count, imki_sensor_row(s, i));
        take(truth->specific_force[i], first, count, imki_sensor_row(s, IMKI_SENSOR_FORCE + i));
        take(truth->angular_acceleration[i], first, count,
             imki_sensor_row(s, IMKI_SENSOR_ACCELERATION + i));
    }
    if (!s->temperature)
        return;
    take(truth->temperature, first, count, imki_sensor_row(s, IMKI_SENSOR_TEMPERATURE));
    take(truth->temperature_rate, first, count, imki_sensor_row(s, IMKI_SENSOR_TEMPERATURE_RATE));
}

/* Power-on is the same moment for all. */
static void expose_to_warm_up(imk_sensor *s)
{
    const size_t within = (size_t)(s->next % IMK_NOISE_BLOCK);
    for (int kind = 0; kind < 2; kind++) {
        const double time = s->warm_up_time[kind];
        if (!s->exposure[kind].warm_up || (kind == IMK_ACCEL && s->same_warm_up))
            continue;
        if (within == 0)
            s->warm_up_block[kind] = imki_warm_up_block(s->next, 1, s->interval, time);
        repeat(s->warm_up_block[kind] * imki_warm_up_within(within, s->interval, time),
               imki_row_places(s->count), imki_sensor_row(s, IMKI_SENSOR_WARM_UP + kind));
    }
}

static double next_hysteresis(imk_hysteresis *hysteresis, double temperature)
{
    const double known = isfinite(temperature) ? temperature : (double)NAN;
    double state;
    imk_hysteresis_next(hysteresis, 1, &known, &state);
    return state;
}

/* As long as all have seen the same temperatures, there is one state. */
static void expose_to_hysteresis(imk_sensor *s, size_t first, size_t count)
{
    const double *temperature = imki_sensor_row(s, IMKI_SENSOR_TEMPERATURE);
    for (int kind = 0; kind < 2; kind++) {
        imk_hysteresis *hysteresis = s->hysteresis[kind];
        double *row = imki_sensor_row(s, IMKI_SENSOR_HYSTERESIS + kind);
        if (!hysteresis || (kind == IMK_ACCEL && s->same_hysteresis))
            continue;
        if (s->shared_hysteresis && first == 0)
            repeat(next_hysteresis(hysteresis, temperature[0]), imki_row_places(s->count), row);
        for (size_t i = 0; i < count && !s->shared_hysteresis; i++)
            row[i] = next_hysteresis(&hysteresis[first + i], temperature[i]);
    }
}

static void spread_hysteresis(imk_sensor *s)
{
    for (int kind = 0; kind < 2 && s->shared_hysteresis; kind++)
        for (size_t i = 1; i < s->count && s->hysteresis[kind]; i++)
            s->hysteresis[kind][i] = s->hysteresis[kind][0];
    s->shared_hysteresis = s->count == 1;
}

/* ---- a step ---- */

/* What is needed of the noise of the next group, sooner than the processor sees. */
static void fetch_noise(const imk_sensor *s, size_t first)
{
    size_t stride;
    if (first >= s->count)
        return;
    const size_t places = imki_group_places(s, first);
    const double *noise = noise_now(s, first, &stride);
    for (size_t c = 0; c < s->channels; c++)
        for (size_t i = 0; i < places; i += 8)
            __builtin_prefetch(noise + c * stride + i);
}

static bool step_group(imk_sensor *s, size_t first, size_t count, double *readings)
{
    size_t stride;
    const double *noise = noise_now(s, first, &stride);
    bool finite = true;
    fetch_noise(s, first + IMKI_GROUP);
    for (size_t kind = 0, c = 0; kind < 2; kind++) {
        imki_exposure *exposure = &s->exposure[kind];
        for (const size_t end = c + s->of_kind[kind]; c < end; c++) {
            double *place = readings + c * s->count + first;
            double *y = count < IMKI_GROUP ? s->response : place;
            exposure->bias = imki_sensor_numbers(s, IMKI_SENSOR_BIAS, c) + first;
            exposure->scale = imki_sensor_numbers(s, IMKI_SENSOR_SCALE, c) + first;
            if (s->count == 1)
                imki_distort_pair(&s->axis[c], exposure, y);
            else
                imki_distort_chunks(s->random.kernel, &s->axis[c], exposure, 1, y);
            finite &= imki_sensor_output(s, c, first, noise + c * stride, count, y);
            if (y != place)
                memcpy(place, y, count * sizeof *y);
        }
    }
    return finite;
}

/* @param all, each  one of them is NULL */
static imk_status step(imk_sensor *s, const imk_sensor_truth *all, const imk_stimulus *each,
                       double *readings)
{
    bool finite = true;
    expose_to_warm_up(s);
    if (all)
        expose_all(s, all);
    else
        spread_hysteresis(s);
    for (size_t first = 0; first < s->count; first += IMKI_GROUP) {
        const size_t left = s->count - first, count = left < IMKI_GROUP ? left : IMKI_GROUP;
        refill(s, first);
        if (each)
            expose_each(s, each, first, count);
        expose_to_hysteresis(s, first, count);
        finite &= step_group(s, first, count, readings);
    }
    s->next++;
    return finite ? IMK_OK : IMK_ERROR_NOT_FINITE;
}

imk_status imk_sensor_step(imk_sensor *sensor, const imk_sensor_truth *truth, double *readings)
{
    return sensor && truth && readings ? step(sensor, truth, NULL, readings) : IMK_ERROR_ARGUMENT;
}

imk_status imk_sensor_step_each(imk_sensor *sensor, const imk_stimulus *truth, double *readings)
{
    if (!sensor || !truth || !readings || (sensor->temperature && !truth->temperature))
        return IMK_ERROR_ARGUMENT;
    return step(sensor, NULL, truth, readings);
}
