/* SPDX-License-Identifier: Apache-2.0 */
/* Noise and the output stage of a triad as sources of error.
 *
 * Sampling changes what noise does at low frequencies, which is all that a navigator sees of it:
 * samples dt apart of a Gauss-Markov process of variance v and correlation time T have the density
 *
 *     v dt coth(dt/2T)   for   2 v T
 *
 * of the process, and those of a sinusoid of frequency f add up to x/sin x, x = pi f dt, of what
 * its integral is. Flicker noise is the sum of the stages that the simulator makes (noise.h), whose
 * samples have the density of their processes. */
#include "drift_covariance_internal.h"

#include "imukit/distort.h"
#include "imukit/elementary.h"
#include "noise/noise_terms_internal.h"

#include <math.h>
#include <string.h>

#define PI 3.14159265358979323846

static const char *const kinds[2] = {"gyro", "accel"};

/* x coth x, x = dt/2T; e^(-2x) is below rounding beyond 20. */
static double sampled_share(double time, double dt)
{
    const double x = 0.5 * dt / time, less = imk_expm1(-2.0 * x);
    return less == 0.0 ? 1.0 : x * (2.0 + less) / -less;
}

/* Density at low frequencies of the samples of a resonance. Its design ends at a million cycles a
 * sample (noise.h), where samples know nothing of one another. */
static double folded_density(imk_resonance resonance, double dt)
{
    const double density = imk_resonance_sampled_spectrum(resonance, dt, 1e-3 / dt);
    return isfinite(density) ? density : resonance.sigma * resonance.sigma * dt;
}

/* The phase is random: two independent amplitudes, of sine and cosine. Above half the sample rate
 * the frequency is folded. */
static void add_sine(imki_drift_plan *plan, const imki_process *p, const imki_drift_column *column,
                     double dt)
{
    const double cycles = p->frequency * dt;
    const double x = PI * fabs(cycles - floor(cycles + 0.5));
    const imki_drift_driver driver = imki_driver_oscillator(2.0 * x / dt);
    const double size = p->size * sqrt(0.5) * (x > 0.0 ? x / imk_sin(x) : 1.0);
    imki_drift_add_constant(plan, IMKI_ELEMENT_SIZE, column, &driver, size, 0.0);
    imki_drift_add_constant(plan, IMKI_ELEMENT_SIZE, column, &driver, 0.0, size);
}

/* Up to a quarter of the sample rate the process itself; above it, where samples fold it, white
 * noise. */
static void add_resonance(imki_drift_plan *plan, const imki_process *p,
                          const imki_drift_column *column, double dt)
{
    const bool folded = p->frequency * dt > 0.25;
    const imki_drift_driver driver =
        folded ? imki_driver_white() : imki_driver_resonance(2.0 * PI * p->frequency, p->q);
    const imk_resonance resonance = {p->size, p->frequency, p->q};
    imki_drift_add_noise(plan, IMKI_ELEMENT_NOISE, column, &driver,
                         folded ? folded_density(resonance, dt) : p->size * p->size);
}

/* Independent errors of the readings of the integral. */
static void add_reading(imki_drift_plan *plan, int sensor, int axis, double size, double dt)
{
    const imki_drift_driver white = imki_driver_white();
    const imki_drift_column column = imki_drift_column_of(IMKI_COLUMN_ROUNDING, sensor, axis, 0);
    imki_drift_add_noise(plan, IMKI_ELEMENT_ROUNDING, &column, &white, size * size * dt);
    if (plan->element)
        plan->element[plan->element_count - 1].state[0] = size;
}

static void add_process(imki_drift_plan *plan, const imki_noise_term *term, const imki_process *p,
                        int sensor, int axis, double dt)
{
    const size_t before = plan->element_count;
    const imki_drift_column one = imki_drift_column_of(IMKI_COLUMN_ONE, sensor, axis, 0);
    const imki_drift_column *column = &one;
    if (p->kind == IMKI_PROCESS_READING) {
        add_reading(plan, sensor, axis, p->size, dt);
    } else if (p->kind == IMKI_PROCESS_SINE) {
        add_sine(plan, p, column, dt);
    } else if (p->kind == IMKI_PROCESS_RESONANCE) {
        add_resonance(plan, p, column, dt);
    } else {
        const bool first_order = p->kind == IMKI_PROCESS_FIRST_ORDER;
        const double share =
            p->share * (first_order && !p->matched ? sampled_share(p->time, dt) : 1);
        const imki_drift_driver driver = first_order ? imki_driver_gauss_markov(p->time)
                                         : p->kind == IMKI_PROCESS_WALK ? imki_driver_walk()
                                                                        : imki_driver_white();
        imki_drift_add_noise(plan, IMKI_ELEMENT_NOISE, column, &driver, share * p->size * p->size);
    }
    for (size_t i = before; plan->element && i < plan->element_count; i++) {
        plan->element[i].term = term;
        plan->element[i].process = *p;
    }
}

/* An element of a term's list on the three axes. */
static void add_element(imki_drift_plan *plan, const imki_noise_term *term, const imk_triad *triad,
                        int sensor, int instance, double dt)
{
    static const char *const suffix[IMK_TERMS_MAX] = {"[0]", "[1]", "[2]", "[3]",
                                                      "[4]", "[5]", "[6]", "[7]"};
    imki_process process[IMKI_PROCESSES_MAX];
    imki_term_place place = {triad, 0, instance};
    double strength[3];
    for (place.axis = 0; place.axis < 3; place.axis++)
        strength[place.axis] = term->strength(place);
    if (!imki_drift_has_any(strength, 3))
        return;
    imki_drift_add_source(plan, kinds[sensor], term->path[sensor],
                          term->count ? suffix[instance] : "", term->text[sensor]);
    for (place.axis = 0; place.axis < 3; place.axis++) {
        const size_t count = strength[place.axis] != 0.0 ? term->processes(place, dt, process) : 0;
        for (size_t i = 0; i < count; i++)
            add_process(plan, term, &process[i], sensor, place.axis, dt);
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
    for (int axis = 0; axis < 3; axis++)
        if (q[axis] != 0.0)
            add_reading(plan, sensor, axis, q[axis], dt);
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
    const double dt = 1.0 / settings->rate;
    for (int t = 0; t < IMKI_NOISE_TERMS; t++) {
        const int count = imki_term_count(imki_noise_terms[t], &triad->noise);
        for (int instance = 0; instance < count; instance++)
            add_element(plan, imki_noise_terms[t], triad, sensor, instance, dt);
    }
    add_quantization(plan, triad, sensor, dt);
    add_rounding(plan, triad, sensor, dt);
    if (settings->motion)
        add_delays(plan, triad, sensor);
    omit_terms(plan, triad, sensor);
}
