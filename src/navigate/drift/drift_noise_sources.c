/* SPDX-License-Identifier: Apache-2.0 */
/* Noise and the output stage of a triad as sources of error.
 *
 * Sampling changes what noise does at low frequencies, which is all that a navigator sees of it:
 * samples dt apart of a Gauss-Markov process of variance v and correlation time T have the density
 *
 *     v dt coth(dt/2T)   for   2 v T
 *
 * of the process, and those of a sinusoid of frequency f add up to x/sin x, x = pi f dt, of what
 * its integral is. Flicker noise is the sum of the stages that the simulator makes (noise.h), each
 * of the variance (ln 4/pi) B^2, which is also that of its flat Allan variance. */
#include "drift_covariance_internal.h"

#include "imukit/distort.h"
#include "imukit/elementary.h"
#include "imukit/noise.h"

#include <math.h>
#include <string.h>

#define PI 3.14159265358979323846
#define FASTEST 1.20785 /* variance of the fastest stage, of the others': src/noise/flicker.c */

static const char *const kinds[2] = {"gyro", "accel"};

/* A term that one driver of unit size stands for on every axis. */
static void add_simple_noise(imki_drift_plan *plan, const double *value, int sensor,
                             const char *name, const char *text, const imki_drift_driver *driver)
{
    if (!imki_drift_has_any(value, 3))
        return;
    imki_drift_add_source(plan, kinds[sensor], name, "", text);
    for (int axis = 0; axis < 3; axis++) {
        const imki_drift_column column = imki_drift_column_of(IMKI_COLUMN_ONE, sensor, axis, 0);
        if (value[axis] != 0.0)
            imki_drift_add_noise(plan, IMKI_ELEMENT_NOISE, &column, driver,
                                 value[axis] * value[axis]);
    }
}

/* x coth x, x = dt/2T; e^(-2x) is below rounding beyond 20. */
static double sampled_share(double time, double dt)
{
    const double x = 0.5 * dt / time, less = imk_expm1(-2.0 * x);
    return less == 0.0 ? 1.0 : x * (2.0 + less) / -less;
}

/* Stages 0 and 1 change at every sample. The others hold their values, and are interpolated by it:
 * only half a per cent is between them and their processes. */
static void add_flicker(imki_drift_plan *plan, const double *value, int sensor, double dt)
{
    if (!imki_drift_has_any(value, 3))
        return;
    imki_drift_add_source(plan, kinds[sensor], "noise.bias_instability", "",
                          sensor == IMK_GYRO ? "gyro bias instability"
                                             : "accelerometer bias instability");
    for (int axis = 0; axis < 3; axis++) {
        const imki_drift_column column = imki_drift_column_of(IMKI_COLUMN_ONE, sensor, axis, 0);
        double time = dt;
        for (int stage = 0; stage < IMK_FLICKER_STAGES && value[axis] != 0.0;
             stage++, time *= 4.0) {
            const imki_drift_driver driver = imki_driver_gauss_markov(time);
            const double share = imk_flicker_allan_variance(1.0, time) *
                                 (stage == 0 ? FASTEST : 1.0) *
                                 (stage < 2 ? sampled_share(time, dt) : 1.0);
            imki_drift_add_noise(plan, IMKI_ELEMENT_NOISE, &column, &driver,
                                 share * value[axis] * value[axis]);
        }
    }
}

static const char *const instance[IMK_TERMS_MAX] = {"[0]", "[1]", "[2]", "[3]",
                                                    "[4]", "[5]", "[6]", "[7]"};

static void add_gauss_markov(imki_drift_plan *plan, const imk_noise *noise, int sensor, double dt)
{
    for (int i = 0; i < noise->gauss_markov_count; i++) {
        const struct imk_gauss_markov_term *term = &noise->gauss_markov[i];
        if (!imki_drift_has_any(term->sigma.value, 3))
            continue;
        imki_drift_add_source(plan, kinds[sensor], "noise.gauss_markov", instance[i],
                              sensor == IMK_GYRO ? "gyro Gauss-Markov process"
                                                 : "accelerometer Gauss-Markov process");
        for (int axis = 0; axis < 3; axis++) {
            const double sigma = term->sigma.value[axis], time = term->correlation_time.value[axis];
            const imki_drift_column column = imki_drift_column_of(IMKI_COLUMN_ONE, sensor, axis, 0);
            if (sigma == 0.0)
                continue;
            const imki_drift_driver driver = imki_driver_gauss_markov(time);
            imki_drift_add_noise(plan, IMKI_ELEMENT_NOISE, &column, &driver,
                                 sampled_share(time, dt) * sigma * sigma);
        }
    }
}

/* The phase is random: two independent amplitudes, of sine and cosine. Above half the sample rate
 * the frequency is folded. */
static void add_sinusoids(imki_drift_plan *plan, const imk_noise *noise, int sensor, double dt)
{
    for (int i = 0; i < noise->sinusoid_count; i++) {
        const struct imk_sinusoid_term *term = &noise->sinusoid[i];
        if (!imki_drift_has_any(term->amplitude.value, 3))
            continue;
        imki_drift_add_source(plan, kinds[sensor], "noise.sinusoid", instance[i],
                              sensor == IMK_GYRO ? "gyro sinusoid" : "accelerometer sinusoid");
        for (int axis = 0; axis < 3; axis++) {
            const double amplitude = term->amplitude.value[axis];
            const imki_drift_column column = imki_drift_column_of(IMKI_COLUMN_ONE, sensor, axis, 0);
            if (amplitude == 0.0)
                continue;
            const double cycles = term->frequency.value[axis] * dt;
            const double x = PI * fabs(cycles - floor(cycles + 0.5));
            const imki_drift_driver driver = imki_driver_oscillator(2.0 * x / dt);
            const double size = amplitude * sqrt(0.5) * (x > 0.0 ? x / imk_sin(x) : 1.0);
            imki_drift_add_constant(plan, IMKI_ELEMENT_SIZE, &column, &driver, size, 0.0);
            imki_drift_add_constant(plan, IMKI_ELEMENT_SIZE, &column, &driver, 0.0, size);
        }
    }
}

/* Density at low frequencies of the samples of a resonance. Its design ends at a million cycles a
 * sample (noise.h), where samples know nothing of one another. */
static double folded_density(imk_resonance resonance, double dt)
{
    const double density = imk_resonance_sampled_spectrum(resonance, dt, 1e-3 / dt);
    return isfinite(density) ? density : resonance.sigma * resonance.sigma * dt;
}

/* Up to a quarter of the sample rate the process itself; above it, where samples fold it, white
 * noise. */
static void add_resonances(imki_drift_plan *plan, const imk_noise *noise, int sensor, double dt)
{
    for (int i = 0; i < noise->resonance_count; i++) {
        const struct imk_resonance_term *term = &noise->resonance[i];
        if (!imki_drift_has_any(term->sigma.value, 3))
            continue;
        imki_drift_add_source(plan, kinds[sensor], "noise.resonance", instance[i],
                              sensor == IMK_GYRO ? "gyro resonance" : "accelerometer resonance");
        for (int axis = 0; axis < 3; axis++) {
            const imk_resonance r = {term->sigma.value[axis], term->frequency.value[axis],
                                     term->q.value[axis]};
            const imki_drift_column column = imki_drift_column_of(IMKI_COLUMN_ONE, sensor, axis, 0);
            if (r.sigma == 0.0)
                continue;
            const bool folded = r.frequency * dt > 0.25;
            const imki_drift_driver driver =
                folded ? imki_driver_white() : imki_driver_resonance(2.0 * PI * r.frequency, r.q);
            imki_drift_add_noise(plan, IMKI_ELEMENT_NOISE, &column, &driver,
                                 folded ? folded_density(r, dt) : r.sigma * r.sigma);
        }
    }
}

/* ---- the output stage -------------------------------------------------------------------------
 */

static void add_quantization(imki_drift_plan *plan, const imk_triad *triad, int sensor, double dt)
{
    const double *q = triad->noise.quantization.value;
    if (!imki_drift_has_any(q, 3))
        return;
    imki_drift_add_source(plan, kinds[sensor], "noise.quantization", "",
                          sensor == IMK_GYRO ? "gyro quantization" : "accelerometer quantization");
    const imki_drift_driver white = imki_driver_white();
    for (int axis = 0; axis < 3; axis++) {
        const imki_drift_column column =
            imki_drift_column_of(IMKI_COLUMN_ROUNDING, sensor, axis, 0);
        if (q[axis] == 0.0)
            continue;
        imki_drift_add_noise(plan, IMKI_ELEMENT_ROUNDING, &column, &white, q[axis] * q[axis] * dt);
        if (plan->element)
            plan->element[plan->element_count - 1].state[0] = q[axis];
    }
}

/* Rounding to a step is white noise of a twelfth of its square where noise of half a step at least
 * carries the signal across; then the mean is right to 0.3 % of the step,
 * (1/pi) e^(-2 pi^2/4) [WIDROW2008]. */
static void add_rounding(imki_drift_plan *plan, const imk_triad *triad, int sensor, double dt)
{
    static const char *const names[2] = {"resolution", "sensitivity"};
    static const char *const omitted[2][2] = {{"gyro.resolution", "gyro.sensitivity"},
                                              {"accel.resolution", "accel.sensitivity"}};
    static const char *const texts[2][2] = {{"gyro resolution", "gyro counts"},
                                            {"accelerometer resolution", "accelerometer counts"}};
    for (int which = 0; which < 2; which++) {
        double step[3];
        bool dithered = true;
        for (int axis = 0; axis < 3; axis++) {
            const double sensitivity = fabs(triad->sensitivity.value[axis]);
            step[axis] = which == 0          ? triad->resolution.value[axis]
                         : sensitivity > 0.0 ? 1.0 / sensitivity
                                             : 0.0;
            dithered = dithered && triad->noise.white.value[axis] >= 0.5 * step[axis] * sqrt(dt);
        }
        if (!imki_drift_has_any(step, 3))
            continue;
        if (!dithered) {
            imki_drift_omit(plan, omitted[sensor][which]);
            continue;
        }
        imki_drift_add_source(plan, kinds[sensor], names[which], "", texts[sensor][which]);
        const imki_drift_driver white = imki_driver_white();
        for (int axis = 0; axis < 3; axis++) {
            const imki_drift_column column = imki_drift_column_of(IMKI_COLUMN_ONE, sensor, axis, 0);
            if (step[axis] > 0.0)
                imki_drift_add_noise(plan, IMKI_ELEMENT_NOISE, &column, &white,
                                     step[axis] * step[axis] / 12.0 * dt);
        }
    }
}

/* Delay of the filter for what is slow: 1/w of first order, 2 zeta/w of second, w from the -3 dB
 * point as in noise.h. */
static double delay_of(double bandwidth, double damping)
{
    const double cutoff = 2.0 * PI * bandwidth;
    if (damping == 0.0)
        return 1.0 / cutoff;
    const double m = 1.0 - 2.0 * damping * damping;
    return 2.0 * damping * sqrt(m + sqrt(m * m + 1.0)) / cutoff;
}

static void add_delays(imki_drift_plan *plan, const imk_triad *triad, int sensor)
{
    if (!imki_drift_has_any(triad->bandwidth.value, 3))
        return;
    imki_drift_add_source(plan, kinds[sensor], "bandwidth", "",
                          sensor == IMK_GYRO ? "gyro bandwidth (delay)"
                                             : "accelerometer bandwidth (delay)");
    const imki_drift_driver driver = imki_driver_constant();
    for (int axis = 0; axis < 3; axis++) {
        const imki_drift_column column = imki_drift_column_of(IMKI_COLUMN_DELAY, sensor, axis, 0);
        if (triad->bandwidth.value[axis] > 0.0)
            imki_drift_add_constant(
                plan, IMKI_ELEMENT_MEAN, &column, &driver,
                delay_of(triad->bandwidth.value[axis], triad->damping.value[axis]), 0.0);
    }
}

static bool has_temperature(const imk_temperature_polynomial *polynomial)
{
    for (int i = 0; i < polynomial->order; i++)
        if (imki_drift_has_any(polynomial->coefficient[i].value, 3))
            return true;
    return false;
}

static void omit_terms(imki_drift_plan *plan, const imk_triad *triad, int sensor)
{
    static const char *const names[2][5] = {
        {"gyro.dead_band", "gyro.bias.temperature", "gyro.bias.temperature_rate",
         "gyro.bias.hysteresis", "gyro.scale_factor.temperature"},
        {"accel.dead_band", "accel.bias.temperature", "accel.bias.temperature_rate",
         "accel.bias.hysteresis", "accel.scale_factor.temperature"}};
    const bool present[5] = {imki_drift_has_any(triad->dead_band.value, 3),
                             has_temperature(&triad->bias.temperature),
                             imki_drift_has_any(triad->bias.temperature_rate.value, 3),
                             imki_drift_has_any(triad->bias.hysteresis.value, 3),
                             has_temperature(&triad->scale_factor.temperature)};
    for (int i = 0; i < 5; i++)
        if (present[i])
            imki_drift_omit(plan, names[sensor][i]);
}

void imki_drift_noise_sources(imki_drift_plan *plan, const imk_triad *triad, int sensor,
                              const imk_drift_settings *settings)
{
    static const char *const white[2] = {"noise.angle_random_walk", "noise.velocity_random_walk"};
    static const char *const white_text[2] = {"gyro angle random walk",
                                              "accelerometer velocity random walk"};
    static const char *const walk[2] = {"noise.rate_random_walk", "noise.acceleration_random_walk"};
    static const char *const walk_text[2] = {"gyro rate random walk",
                                             "accelerometer acceleration random walk"};
    const double dt = 1.0 / settings->rate;
    const imki_drift_driver white_driver = imki_driver_white(), walk_driver = imki_driver_walk();
    add_simple_noise(plan, triad->noise.white.value, sensor, white[sensor], white_text[sensor],
                     &white_driver);
    add_flicker(plan, triad->noise.bias_instability.value, sensor, dt);
    add_simple_noise(plan, triad->noise.random_walk.value, sensor, walk[sensor], walk_text[sensor],
                     &walk_driver);
    add_gauss_markov(plan, &triad->noise, sensor, dt);
    add_sinusoids(plan, &triad->noise, sensor, dt);
    add_resonances(plan, &triad->noise, sensor, dt);
    add_quantization(plan, triad, sensor, dt);
    add_rounding(plan, triad, sensor, dt);
    if (settings->motion)
        add_delays(plan, triad, sensor);
    omit_terms(plan, triad, sensor);
}
