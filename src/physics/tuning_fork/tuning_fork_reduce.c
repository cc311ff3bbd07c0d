/* SPDX-License-Identifier: Apache-2.0 */
/* From the design of a tuning fork gyro to the error model: what imk_tuning_fork_reading() says of
 * bias and scale factor at all temperatures, and closed forms for the rest. */
#include "tuning_fork_internal.h"

#include <math.h>

enum { ORDER = IMK_TEMPERATURE_ORDER_MAX };

/* Coefficients of the polynomial t (c0 + c1 t + …) through five points (t, value): Newton's
 * divided differences of value/t. */
static void polynomial(const double t[ORDER], const double value[ORDER], double coefficient[ORDER])
{
    double difference[ORDER];
    for (int i = 0; i < ORDER; i++)
        difference[i] = value[i] / t[i];
    for (int level = 1; level < ORDER; level++)
        for (int i = ORDER - 1; i >= level; i--)
            difference[i] = (difference[i] - difference[i - 1]) / (t[i] - t[i - level]);
    for (int i = 0; i < ORDER; i++)
        coefficient[i] = 0.0;
    for (int i = ORDER - 1; i >= 0; i--) {
        for (int k = ORDER - 1; k > 0; k--)
            coefficient[k] = coefficient[k - 1] - t[i] * coefficient[k];
        coefficient[0] = difference[i] - t[i] * coefficient[0];
    }
}

static double slope_at(const imk_tuning_fork *design, double temperature)
{
    return imk_tuning_fork_reading(design, 1.0, 0.0, temperature) -
           imk_tuning_fork_reading(design, 0.0, 0.0, temperature);
}

static void temperature_terms(const imk_tuning_fork *design, imk_triad *gyro)
{
    /* away from 0, where the quotient of polynomial() is */
    const double low = IMKI_FORK_COLDEST - IMKI_DESIGN_TEMPERATURE,
                 high = IMKI_FORK_HOTTEST - IMKI_DESIGN_TEMPERATURE;
    const double t[ORDER] = {low, 0.5 * low, 0.25 * high, 0.6 * high, high};
    const double scale = slope_at(design, IMKI_DESIGN_TEMPERATURE);
    double bias_change[ORDER], scale_change[ORDER], bias[ORDER], slope[ORDER];
    for (int i = 0; i < ORDER; i++) {
        const double temperature = IMKI_DESIGN_TEMPERATURE + t[i];
        bias_change[i] = imk_tuning_fork_reading(design, 0.0, 0.0, temperature) -
                         imk_tuning_fork_reading(design, 0.0, 0.0, IMKI_DESIGN_TEMPERATURE);
        scale_change[i] = slope_at(design, temperature) - scale;
    }
    polynomial(t, bias_change, bias);
    polynomial(t, scale_change, slope);
    imk_temperature_polynomial *const target[] = {&gyro->bias.temperature,
                                                  &gyro->scale_factor.temperature};
    for (int k = 0; k < 2; k++) {
        target[k]->order = ORDER;
        target[k]->reference = IMKI_DESIGN_TEMPERATURE;
        target[k]->minimum = IMKI_FORK_COLDEST;
        target[k]->maximum = IMKI_FORK_HOTTEST;
        for (int i = 0; i < ORDER; i++)
            target[k]->coefficient[i].value[0] = k == 0 ? bias[i] : slope[i];
    }
}

/* |response| of sense element and output filter at a frequency [Hz], relative to 0. */
static double whole_gain(const imk_tuning_fork *design, double frequency)
{
    const double loop = frequency / design->sense.bandwidth;
    const double w = imki_fork_filter_frequency(design), r = 2.0 * IMKI_PI * frequency / w;
    double gain = design->sense.loop == IMK_TUNING_FORK_CLOSED
                      ? 1.0 / sqrt(1.0 + loop * loop)
                      : imk_tuning_fork_gain(design, frequency);
    if (w > 0.0) {
        const double damping = design->output.damping, real = 1.0 - r * r, imag = 2.0 * damping * r;
        gain /= damping > 0.0 ? sqrt(real * real + imag * imag) : sqrt(1.0 + r * r);
    }
    return gain;
}

/* First frequency at which the gain falls through 1/sqrt(2): a walk upwards in steps of 2 %, finer
 * than any feature (the filter's and the resonance's are at least as wide as they are damped, and
 * a resonance lifts the gain), then halving. */
static double cut_off(const imk_tuning_fork *design)
{
    const double half_power = sqrt(0.5);
    double low = 1e-6 * design->drive.frequency, high = low;
    while (whole_gain(design, high) > half_power && high < design->drive.frequency) {
        low = high;
        high *= 1.02;
    }
    for (int i = 0; i < 60; i++) {
        const double middle = 0.5 * (low + high);
        *(whole_gain(design, middle) > half_power ? &low : &high) = middle;
    }
    return 0.5 * (low + high);
}

/* The model's filter: of second order where the output filter is, or where an open loop without one
 * rings at its split; else of first order. */
static void bandwidth(const imk_tuning_fork *design, imk_triad *gyro)
{
    const imki_fork_point point = imki_fork_at(design, IMKI_DESIGN_TEMPERATURE);
    const imki_phasor p = imki_fork_decay(&point);
    const double size = sqrt(p.re * p.re + p.im * p.im), damping = p.re / size;
    const double narrowest = 0.05; /* of the model's filter, noise.h */
    gyro->bandwidth.value[0] = cut_off(design);
    if (design->output.bandwidth > 0.0)
        gyro->damping.value[0] = design->output.damping;
    else if (design->sense.loop == IMK_TUNING_FORK_OPEN && fabs(p.im) > p.re)
        gyro->damping.value[0] = damping > narrowest ? damping : narrowest;
}

void imki_tuning_fork_reduce(const imk_tuning_fork *design, imk_triad *gyro)
{
    const double slope = slope_at(design, IMKI_DESIGN_TEMPERATURE), turn = 1e-6;
    const int leak = design->arrangement == IMK_TUNING_FORK_IN_PLANE ? 1 : 2;
    imk_tuning_fork turned = *design;
    turned.phase.error += turn;
    const double by_phase = (imk_tuning_fork_reading(&turned, 0.0, 0.0, IMKI_DESIGN_TEMPERATURE) -
                             imk_tuning_fork_reading(design, 0.0, 0.0, IMKI_DESIGN_TEMPERATURE)) /
                            turn;
    const double brownian = imk_tuning_fork_brownian_noise(design, IMKI_DESIGN_TEMPERATURE);
    const double pickoff = imk_tuning_fork_pickoff_noise(design);
    const double reference = by_phase * design->drive.pickoff_noise / design->drive.amplitude;
    gyro->bias.fixed.value[0] = imk_tuning_fork_reading(design, 0.0, 0.0, IMKI_DESIGN_TEMPERATURE);
    gyro->bias.repeatability.value[0] = fabs(by_phase) * design->phase.repeatability;
    gyro->scale_factor.fixed.value[0] = slope - 1.0;
    gyro->scale_factor.repeatability.value[0] = design->drive.amplitude_repeatability;
    temperature_terms(design, gyro);
    gyro->g_sensitivity.value[0][leak] =
        imk_tuning_fork_reading(design, 0.0, 1.0, IMKI_DESIGN_TEMPERATURE) -
        gyro->bias.fixed.value[0];
    if (design->sense.loop == IMK_TUNING_FORK_OPEN)
        gyro->nonlinearity.k3.value[0] = imk_tuning_fork_cubic(design);
    gyro->noise.white.value[0] =
        sqrt(brownian * brownian + pickoff * pickoff + reference * reference);
    gyro->noise.bias_instability.value[0] = fabs(by_phase) * design->phase.instability;
    bandwidth(design, gyro);
    gyro->range.value[0] = design->output.range;
    gyro->resolution.value[0] = design->output.resolution;
}
