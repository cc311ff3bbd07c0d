/* SPDX-License-Identifier: Apache-2.0 */
/* Models to be simulated: one term alone, or everything a good sensor has. Include it after
 * bench.h. */
#ifndef IMUKIT_BENCH_COMPLETE_MODEL_H
#define IMUKIT_BENCH_COMPLETE_MODEL_H

#include "imukit/model.h"

static inline imk_axes axes(double value)
{
    return (imk_axes){.value = {value, value, value}};
}

static inline void each_triad(imk_model *model, void (*set)(imk_triad *triad))
{
    set(&model->gyro);
    set(&model->accel);
}

static inline void set_white(imk_triad *triad)
{
    triad->noise.white = axes(1e-3);
}

static inline void set_walk(imk_triad *triad)
{
    triad->noise.random_walk = axes(1e-5);
}

static inline void set_flicker(imk_triad *triad)
{
    triad->noise.bias_instability = axes(1e-4);
}

static inline void set_gauss_markov(imk_triad *triad)
{
    triad->noise.gauss_markov_count = 1;
    triad->noise.gauss_markov[0].sigma = axes(1e-4);
    triad->noise.gauss_markov[0].correlation_time = axes(300.0);
}

static inline void set_quantization(imk_triad *triad)
{
    triad->noise.quantization = axes(1e-6);
}

static inline void set_sinusoid(imk_triad *triad)
{
    triad->noise.sinusoid_count = 1;
    triad->noise.sinusoid[0].amplitude = axes(1e-3);
    triad->noise.sinusoid[0].frequency = axes(20.0);
}

static inline void set_resonance(imk_triad *triad)
{
    triad->noise.resonance_count = 1;
    triad->noise.resonance[0].sigma = axes(1e-3);
    triad->noise.resonance[0].frequency = axes(20.0);
    triad->noise.resonance[0].q = axes(12.0);
}

static inline imk_rows rows(double value)
{
    imk_rows r = {.value = {{0.0}}};
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            r.value[i][j] = i == j ? 0.0 : value * (i + 2 * j + 1);
    return r;
}

static inline imk_temperature_polynomial cubic(double value)
{
    imk_temperature_polynomial t = {
        .order = 3, .reference = 298.0, .minimum = 250.0, .maximum = 350.0};
    for (int i = 0; i < 3; i++)
        t.coefficient[i] = axes(value);
    return t;
}

static inline void set_complete_noise(imk_triad *triad)
{
    set_white(triad);
    set_walk(triad);
    set_flicker(triad);
    set_gauss_markov(triad);
    set_quantization(triad);
    triad->noise.gauss_markov_count = 2;
    triad->noise.gauss_markov[1].sigma = axes(2e-4);
    triad->noise.gauss_markov[1].correlation_time = axes(20.0);
}

static inline void set_deterministic(imk_triad *triad)
{
    triad->bias.fixed = axes(1e-3);
    triad->bias.repeatability = axes(1e-3);
    triad->bias.temperature = cubic(1e-6);
    triad->bias.temperature_rate = axes(1e-3);
    triad->bias.warm_up_amplitude = axes(1e-3);
    triad->bias.warm_up_time.value = 300.0;
    triad->bias.hysteresis = axes(1e-4);
    triad->scale_factor.fixed = axes(1e-4);
    triad->scale_factor.repeatability = axes(1e-4);
    triad->scale_factor.temperature = cubic(1e-7);
    triad->nonlinearity.k2 = triad->nonlinearity.koq = axes(1e-5);
    triad->nonlinearity.k3 = axes(1e-6);
    triad->nonlinearity.asymmetry = axes(1e-4);
    triad->misalignment = rows(1e-4);
    triad->cross_axis = rows(2e-4);
    triad->dead_band = axes(1e-6);
    triad->range = axes(100.0);
}

static inline void set_complete(imk_triad *triad)
{
    set_complete_noise(triad);
    set_deterministic(triad);
}

static inline void set_everything(imk_model *model)
{
    each_triad(model, set_complete);
    model->accel.nonlinearity.cross_products = rows(1e-6);
    model->accel.lever_arm = rows(0.01);
    model->gyro.g_sensitivity = rows(1e-6);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 6; j++)
            model->gyro.g2_sensitivity.value[i][j] = 1e-8 * (i + j + 1);
}

/* Drawn a sample and channel: white noise, walk, two Gauss-Markov, and flicker's 2 + 1/3. */
enum { COMPLETE_NORMALS = 633 }; /* hundredths */

#endif
