/* SPDX-License-Identifier: Apache-2.0 */
/* The output stage over sensors side by side, to be compiled for each instruction set: plain loops,
 * which the compiler turns into vectors. */
#ifndef IMUKIT_SENSOR_KERNEL_H
#define IMUKIT_SENSOR_KERNEL_H

#include "sensor_internal.h"

#define KERNEL static inline __attribute__((always_inline))

KERNEL void limit_bands(const imki_output *o, size_t count, double *restrict y)
{
    double *restrict x = o->filter, *restrict v = o->filter_speed;
    const imki_band_limit limit = o->form->band_limit;
    for (size_t i = 0; i < count; i++) {
        const bool started = x[i] - x[i] == 0.0;
        double at = started ? x[i] : y[i], speed = started ? v[i] : 0.0;
        y[i] = imki_band_limited(&limit, y[i], &at, &speed);
        x[i] = at;
        v[i] = speed;
    }
}

KERNEL void quantize(const imki_output *o, bool end, size_t count, double *restrict y)
{
    double *restrict residual = o->residual, *restrict sum = o->sum, *restrict counted = o->counted;
    const imki_quantizer quantizer = o->quantizer;
    for (size_t i = 0; i < count; i++) {
        double r = residual[i], s = sum[i], c = counted[i];
        y[i] = imki_quantized(&quantizer, end, y[i], &r, &s, &c);
        residual[i] = r;
        sum[i] = s;
        counted[i] = c;
    }
}

KERNEL bool finish(const imki_output *o, size_t count, double *restrict y)
{
    const imki_channel *form = o->form;
    const double *restrict noise = o->noise;
    int64_t lost = 0;
    if (form->band_limit.present)
        limit_bands(o, count, y);
    for (size_t i = 0; i < count; i++)
        y[i] += noise[i];
    if (imki_saturates(form)) {
        const double dead_band = form->dead_band, range = imki_end_of_range(form);
        for (size_t i = 0; i < count; i++)
            y[i] = imki_saturated(y[i], dead_band, range);
    }
    if (form->quantization.lsb > 0.0 && o->end)
        quantize(o, true, count, y);
    else if (form->quantization.lsb > 0.0)
        quantize(o, false, count, y);
    if (form->resolution > 0.0)
        for (size_t i = 0; i < count; i++)
            y[i] = imki_to_resolution(form->resolution, y[i]);
    if (form->sensitivity != 0.0)
        for (size_t i = 0; i < count; i++)
            y[i] = imki_to_counts(form, y[i]);
    for (size_t i = 0; i < count; i++)
        lost |= y[i] - y[i] == 0.0 ? 0 : 1;
    return lost == 0;
}

/* Whole groups, and a single sensor, have a loop of known length. */
#define COMPILE_FOR(isa, target)                                                                   \
    target bool imki_sensor_output_##isa(const imki_output *output, size_t count, double *y)       \
    {                                                                                              \
        if (count == IMKI_GROUP)                                                                   \
            return finish(output, IMKI_GROUP, y);                                                  \
        return count == 1 ? finish(output, 1, y) : finish(output, count, y);                       \
    }

#endif
