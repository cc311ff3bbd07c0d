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

static void make_noise(imk_sensor *s)
{
    if (s->count == 1) {
        make_noise_of_one(s);
        return;
    }
    for (size_t first = 0; first < s->count; first += IMKI_GROUP) {
        size_t places;
        double *noise = imki_group_noise(s, first, &places);
        for (size_t i = 0; i < places; i += IMKI_INTERLEAVED)
            for (size_t c = 0; c < s->channels; c++)
                make_noise_of_eight(s, first + i, c, noise + c * IMK_NOISE_BLOCK * places + i,
                                    places);
    }
}

/* ---- truth ---- */

/* What a group of sensors is exposed to. */
enum {
    TEMPERATURE = 9,
    TEMPERATURE_RATE,
    WARM_UP,
    HYSTERESIS = WARM_UP + 2,
    ROWS = HYSTERESIS + 2
};
typedef struct exposed {
    imk_stimulus stimulus;
    IMKI_ALIGNED double row[ROWS][IMKI_GROUP];
} exposed;

static const double *repeat(double value, size_t places, double *row)
{
    for (size_t i = 0; i < places; i++)
        row[i] = value;
    return row;
}

static size_t places_of(const imk_sensor *s)
{
    return s->count == 1 ? s->places : IMKI_GROUP;
}

/* One truth for all. */
static void expose_all(const imk_sensor *s, const imk_sensor_truth *truth, exposed *e)
{
    const size_t places = places_of(s);
    for (int i = 0; i < 3; i++) {
        e->stimulus.angular_rate[i] = repeat(truth->angular_rate[i], places, e->row[i]);
        e->stimulus.specific_force[i] = repeat(truth->specific_force[i], places, e->row[3 + i]);
        e->stimulus.angular_acceleration[i] =
            repeat(truth->angular_acceleration[i], places, e->row[6 + i]);
    }
    e->stimulus.temperature = repeat(truth->temperature, places, e->row[TEMPERATURE]);
    e->stimulus.temperature_rate =
        repeat(truth->temperature_rate, places, e->row[TEMPERATURE_RATE]);
}

/* Those of a group: where they stand, or a copy if the group is not full. */
static const double *part_of(const double *truth, size_t first, size_t count, size_t places,
                             double *row)
{
    if (!truth || count == places)
        return truth ? truth + first : NULL;
    memset(row, 0, places * sizeof *row);
    memcpy(row, truth + first, count * sizeof *row);
    return row;
}

static void expose_each(const imk_sensor *s, const imk_stimulus *truth, size_t first, size_t count,
                        exposed *e)
{
    const size_t places = places_of(s);
    for (int i = 0; i < 3; i++) {
        e->stimulus.angular_rate[i] =
            part_of(truth->angular_rate[i], first, count, places, e->row[i]);
        e->stimulus.specific_force[i] =
            part_of(truth->specific_force[i], first, count, places, e->row[3 + i]);
        e->stimulus.angular_acceleration[i] =
            part_of(truth->angular_acceleration[i], first, count, places, e->row[6 + i]);
    }
    e->stimulus.temperature =
        part_of(truth->temperature, first, count, places, e->row[TEMPERATURE]);
    e->stimulus.temperature_rate =
        part_of(truth->temperature_rate, first, count, places, e->row[TEMPERATURE_RATE]);
}

/* Power-on is the same moment for all. */
static void expose_to_warm_up(imk_sensor *s, exposed *e)
{
    const size_t within = (size_t)(s->next % IMK_NOISE_BLOCK);
    for (int kind = 0; kind < 2; kind++) {
        const double time = s->warm_up_time[kind];
        e->stimulus.warm_up[kind] = NULL;
        if (!s->warm_up_present[kind])
            continue;
        if (within == 0)
            s->warm_up_block[kind] = imki_warm_up_block(s->next, 1, s->interval, time);
        const double now = s->warm_up_block[kind] * imki_warm_up_within(within, s->interval, time);
        e->stimulus.warm_up[kind] = repeat(now, places_of(s), e->row[WARM_UP + kind]);
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
static void expose_to_hysteresis(imk_sensor *s, bool shared, size_t first, size_t count, exposed *e)
{
    const double *temperature = e->stimulus.temperature;
    for (int kind = 0; kind < 2; kind++) {
        imk_hysteresis *hysteresis = s->hysteresis[kind];
        double *row = e->row[HYSTERESIS + kind];
        e->stimulus.hysteresis[kind] = s->hysteresis_present[kind] ? row : NULL;
        if (!s->hysteresis_present[kind])
            continue;
        if (shared && s->hysteresis_shared) {
            if (first == 0)
                repeat(next_hysteresis(hysteresis, temperature[0]), places_of(s), row);
            continue;
        }
        for (size_t i = 0; i < count; i++)
            row[i] = next_hysteresis(&hysteresis[first + i], temperature[i]);
    }
}

static void spread_hysteresis(imk_sensor *s)
{
    for (int kind = 0; kind < 2 && s->hysteresis_shared; kind++)
        for (size_t i = 1; i < s->count && s->hysteresis_present[kind]; i++)
            s->hysteresis[kind][i] = s->hysteresis[kind][0];
    s->hysteresis_shared = false;
}

/* ---- a step ---- */

/* The response of one channel of a group becomes its readings. @return true if all are finite */
static bool finish(imk_sensor *s, size_t channel, size_t first, size_t count, const double *noise,
                   double *restrict y)
{
    const imki_channel *form = &s->channel[channel];
    if (form->band_limit.present) {
        double *restrict x = imki_sensor_numbers(s, IMKI_SENSOR_FILTER, channel) + first;
        double *restrict v = imki_sensor_numbers(s, IMKI_SENSOR_FILTER_SPEED, channel) + first;
        for (size_t i = 0; i < count; i++) {
            const bool started = x[i] - x[i] == 0.0;
            x[i] = started ? x[i] : y[i];
            v[i] = started ? v[i] : 0.0;
            y[i] = imki_band_limited(&form->band_limit, y[i], &x[i], &v[i]);
        }
    }
    for (size_t i = 0; i < count; i++)
        y[i] += noise[i];
    if (imki_saturates(form))
        for (size_t i = 0; i < count; i++)
            y[i] = imki_saturated(y[i], form->dead_band, imki_end_of_range(form));
    if (form->quantization.lsb > 0.0) {
        const imki_quantizer quantizer =
            imki_quantizer_of(form->quantization.lsb, form->quantization.dt);
        const bool end = (s->next + 1) % IMK_NOISE_STEPS == 0;
        double *restrict residual = imki_sensor_numbers(s, IMKI_SENSOR_RESIDUAL, channel) + first;
        double *restrict sum = imki_sensor_numbers(s, IMKI_SENSOR_SUM, channel) + first;
        double *restrict counted = imki_sensor_numbers(s, IMKI_SENSOR_COUNTED, channel) + first;
        for (size_t i = 0; i < count; i++)
            y[i] = imki_quantized(&quantizer, end, y[i], &residual[i], &sum[i], &counted[i]);
    }
    if (form->resolution > 0.0)
        for (size_t i = 0; i < count; i++)
            y[i] = imki_to_resolution(form->resolution, y[i]);
    if (form->sensitivity != 0.0)
        for (size_t i = 0; i < count; i++)
            y[i] = imki_to_counts(form, y[i]);
    int64_t lost = 0;
    for (size_t i = 0; i < count; i++)
        lost |= y[i] - y[i] == 0.0 ? 0 : 1;
    return lost == 0;
}

static bool step_group(imk_sensor *s, const imk_stimulus *stimulus, size_t first, size_t count,
                       double *readings)
{
    IMKI_ALIGNED double y[IMKI_GROUP];
    size_t places;
    const size_t within = (size_t)(s->next % IMK_NOISE_BLOCK);
    const double *noise = imki_group_noise(s, first, &places) + within * places;
    bool finite = true;
    for (size_t kind = 0, c = 0; kind < 2; kind++) {
        imki_exposure exposure = imki_expose((int)kind, stimulus);
        for (const size_t end = c + s->of_kind[kind]; c < end; c++) {
            exposure.bias = imki_sensor_numbers(s, IMKI_SENSOR_BIAS, c) + first;
            exposure.scale = imki_sensor_numbers(s, IMKI_SENSOR_SCALE, c) + first;
            if (s->count == 1)
                imki_distort_pair(&s->axis[c], &exposure, y);
            else
                imki_distort_chunks(s->random.kernel, &s->axis[c], &exposure, 1, y);
            finite &= finish(s, c, first, count, noise + c * IMK_NOISE_BLOCK * places, y);
            memcpy(readings + c * s->count + first, y, count * sizeof *y);
        }
    }
    return finite;
}

/* @param all, each  one of them is NULL */
static imk_status step(imk_sensor *s, const imk_sensor_truth *all, const imk_stimulus *each,
                       double *readings)
{
    exposed e;
    bool finite = true;
    if (s->next % IMK_NOISE_BLOCK == 0)
        make_noise(s);
    expose_to_warm_up(s, &e);
    if (all)
        expose_all(s, all, &e);
    else
        spread_hysteresis(s);
    for (size_t first = 0; first < s->count; first += IMKI_GROUP) {
        const size_t left = s->count - first, count = left < IMKI_GROUP ? left : IMKI_GROUP;
        if (each)
            expose_each(s, each, first, count, &e);
        if (s->temperature) {
            expose_to_hysteresis(s, all != NULL, first, count, &e);
        } else {
            e.stimulus.temperature = e.stimulus.temperature_rate = NULL;
            e.stimulus.hysteresis[0] = e.stimulus.hysteresis[1] = NULL;
        }
        finite &= step_group(s, &e.stimulus, first, count, readings);
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
