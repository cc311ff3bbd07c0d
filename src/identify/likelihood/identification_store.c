/* SPDX-License-Identifier: Apache-2.0 */
/* From what was identified on one channel to the terms and the evidence of a sensor model. */
#include "imukit/identify.h"
#include "model/model_internal.h"

#include <math.h>

static void store(const imk_estimate *estimate, imk_axes *axes, imk_evidence *evidence,
                  const char *key, int instance, int axis)
{
    axes->value[axis] = estimate->value;
    axes->sigma[axis] = estimate->present ? estimate->sigma : 0;
    if (!estimate->present && !(estimate->upper > 0))
        return; /* nothing is known of it, such as of a ramp from several records */
    imk_interval *interval = imki_evidence_interval(evidence, key, instance);
    if (interval) {
        interval->lower.value[axis] = estimate->lower;
        interval->upper.value[axis] = estimate->upper;
    }
}

bool imk_identification_counted(const imk_identification *result)
{
    const imk_estimate *q = &result->term[IMK_NOISE_QUANTIZATION];
    const double step = result->resolution * result->dt, size = step / sqrt(12);
    if (!(result->dt > 0))
        return true;
    return step > 0 && ((size >= q->lower && size <= q->upper) ||
                        fabs(sqrt(12) * q->value - step) < 0.2 * step);
}

static imk_estimate scaled(const imk_estimate *e, double factor)
{
    return (imk_estimate){e->present,        e->value * factor, e->sigma * factor,
                          e->lower * factor, e->upper * factor, e->free_value * factor};
}

/* Errors of the readings of the integral. If there are none, what they are less than holds for
 * counts. */
static void store_readings(const imk_identification *result, imk_noise *noise,
                           imk_evidence *evidence, int sensor, int axis)
{
    static const char *const white[2] = {"noise.angle_white", "noise.velocity_white"};
    const imk_estimate *e = &result->term[IMK_NOISE_QUANTIZATION];
    if (e->present && !imk_identification_counted(result)) {
        const imk_estimate a = scaled(e, sqrt(result->dt));
        store(&a, &noise->angle_white, evidence, white[sensor], 0, axis);
    } else {
        store(e, &noise->quantization, evidence, "noise.quantization", 0, axis);
    }
}

void imk_identification_store(const imk_identification *result, imk_model *model, int sensor,
                              int axis)
{
    imk_triad *triad = imk_model_triad_to_set(model, sensor);
    imk_evidence *evidence = sensor == IMK_GYRO ? &model->gyro_evidence : &model->accel_evidence;
    imk_noise *noise = &triad->noise;
    imk_axes *axes[IMK_NOISE_TERMS] = {&noise->quantization, &noise->white,
                                       &noise->bias_instability, &noise->random_walk, &noise->ramp};
    static const char *const keys[2][IMK_NOISE_TERMS] = {
        {"noise.quantization", "noise.angle_random_walk", "noise.bias_instability",
         "noise.rate_random_walk", "noise.rate_ramp"},
        {"noise.quantization", "noise.velocity_random_walk", "noise.bias_instability",
         "noise.acceleration_random_walk", "noise.acceleration_ramp"}};
    triad->present = true;
    store_readings(result, noise, evidence, sensor, axis);
    for (int term = IMK_NOISE_WHITE; term < IMK_NOISE_TERMS; term++)
        store(&result->term[term], axes[term], evidence, keys[sensor][term], 0, axis);

    for (int i = 0; i < result->gauss_markov_count; i++) {
        store(&result->gauss_markov[i].sigma, &noise->gauss_markov[i].sigma, evidence,
              "noise.gauss_markov.sigma", i, axis);
        store(&result->gauss_markov[i].correlation_time, &noise->gauss_markov[i].correlation_time,
              evidence, "noise.gauss_markov.correlation_time", i, axis);
    }
    for (int i = 0; i < result->sinusoid_count; i++) {
        noise->sinusoid[i].amplitude.value[axis] = result->sinusoid[i].amplitude;
        noise->sinusoid[i].frequency.value[axis] = result->sinusoid[i].frequency;
    }
    for (int i = 0; i < result->resonance_count; i++) {
        noise->resonance[i].sigma.value[axis] = result->resonance[i].sigma;
        noise->resonance[i].frequency.value[axis] = result->resonance[i].frequency;
        noise->resonance[i].q.value[axis] = result->resonance[i].q;
    }
    if (noise->gauss_markov_count < result->gauss_markov_count)
        noise->gauss_markov_count = result->gauss_markov_count;
    if (noise->sinusoid_count < result->sinusoid_count)
        noise->sinusoid_count = result->sinusoid_count;
    if (noise->resonance_count < result->resonance_count)
        noise->resonance_count = result->resonance_count;
    triad->bandwidth.value[axis] = result->filter.bandwidth;
    triad->damping.value[axis] = result->filter.damping;
    if (result->rounding > 0)
        triad->resolution.value[axis] = result->resolution;
}
