/* SPDX-License-Identifier: Apache-2.0 */
/* The output stage over sensors side by side, to be compiled for each instruction set: plain loops,
 * which the compiler turns into vectors. */
#ifndef IMUKIT_SENSOR_KERNEL_H
#define IMUKIT_SENSOR_KERNEL_H

#include "sensor_internal.h"

#define KERNEL static inline __attribute__((always_inline))

KERNEL void limit_bands(const imki_band_limit *form, double *restrict x, double *restrict v,
                        size_t count, double *restrict y)
{
    const imki_band_limit limit = *form;
    for (size_t i = 0; i < count; i++) {
        const bool started = x[i] - x[i] == 0.0;
        double at = started ? x[i] : y[i], speed = started ? v[i] : 0.0;
        y[i] = imki_band_limited(&limit, y[i], &at, &speed);
        x[i] = at;
        v[i] = speed;
    }
}

KERNEL void quantize(const imki_quantizer *form, double *restrict residual, double *restrict sum,
                     double *restrict counted, bool end, size_t count, double *restrict y)
{
    const imki_quantizer quantizer = *form;
    for (size_t i = 0; i < count; i++) {
        double r = residual[i], s = sum[i], c = counted[i];
        y[i] = imki_quantized(&quantizer, end, y[i], &r, &s, &c);
        residual[i] = r;
        sum[i] = s;
        counted[i] = c;
    }
}

KERNEL bool finish(const imk_sensor *s, size_t channel, size_t first, const double *restrict noise,
                   size_t count, double *restrict y)
{
#define OF(number) (imki_sensor_numbers(s, number, channel) + first)
    const imki_channel *form = &s->channel[channel];
    const imki_quantizer *quantizer = &s->quantizer[channel];
    int64_t lost = 0;
    if (form->band_limit.present)
        limit_bands(&form->band_limit, OF(IMKI_SENSOR_FILTER), OF(IMKI_SENSOR_FILTER_SPEED), count,
                    y);
    for (size_t i = 0; i < count; i++)
        y[i] += noise[i];
    if (imki_saturates(form)) {
        const double dead_band = form->dead_band, range = imki_end_of_range(form);
        for (size_t i = 0; i < count; i++)
            y[i] = imki_saturated(y[i], dead_band, range);
    }
    if (quantizer->lsb > 0.0) {
        double *residual = OF(IMKI_SENSOR_RESIDUAL), *sum = OF(IMKI_SENSOR_SUM),
               *counted = OF(IMKI_SENSOR_COUNTED);
        if ((s->next + 1) % IMK_NOISE_STEPS == 0) /* the end of a segment */
            quantize(quantizer, residual, sum, counted, true, count, y);
        else
            quantize(quantizer, residual, sum, counted, false, count, y);
    }
    if (form->resolution > 0.0)
        for (size_t i = 0; i < count; i++)
            y[i] = imki_to_resolution(form->resolution, y[i]);
    if (form->sensitivity != 0.0)
        for (size_t i = 0; i < count; i++)
            y[i] = imki_to_counts(form, y[i]);
    for (size_t i = 0; i < count; i++)
        lost |= y[i] - y[i] == 0.0 ? 0 : 1;
    return lost == 0;
#undef OF
}

/* Whole groups, and a single sensor, have a loop of known length. */
#define COMPILE_FOR(isa, target)                                                                   \
    target bool imki_sensor_output_##isa(const imk_sensor *s, size_t channel, size_t first,        \
                                         const double *noise, size_t count, double *y)             \
    {                                                                                              \
        if (count == IMKI_GROUP)                                                                   \
            return finish(s, channel, first, noise, IMKI_GROUP, y);                                \
        return count == 1 ? finish(s, channel, first, noise, 1, y)                                 \
                          : finish(s, channel, first, noise, count, y);                            \
    }

#endif
