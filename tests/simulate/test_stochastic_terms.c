/* SPDX-License-Identifier: Apache-2.0 */
/* Every stochastic term by itself, through the simulator: over many runs, the Allan variance of
 * logs with only that term is its closed form for samples, at 10, 100 and 1000 Hz.
 *
 * False alarms: a mean over 900 independent estimates is compared with its expectation within six
 * of its own standard deviations, estimated from their scatter: below 1e-8 each, some 200
 * comparisons in all. */
#include "check.h"
#include "simulated_log.h"

#include "imukit/distributions.h"
#include "imukit/noise.h"

#include <string.h>

enum { RUNS = 300, ROWS = 1024, AXES = 3 };

static const double rates[] = {10.0, 100.0, 1000.0};
static const size_t factors[] = {1, 2, 8, 64};
enum { RATES = 3, FACTORS = 4 };

/* ---- the terms: a unit whose only error is the term, and its Allan variance -------------------
 */

static void set_white(imk_noise *noise)
{
    noise->white = axes(0.3, 0.3, 0.3);
}
static double white(double dt, size_t n)
{
    return imk_white_sampled_allan_variance(0.3, dt, n);
}

static void set_walk(imk_noise *noise)
{
    noise->random_walk = axes(0.2, 0.2, 0.2);
}
/* K^2 tau/3 (1 + 1/(2 n^2)), written out: steps of K sqrt(dt), not of K dt */
static double walk(double dt, size_t n)
{
    double tau = (double)n * dt;
    return 0.2 * 0.2 * tau / 3.0 * (1.0 + 0.5 / ((double)n * (double)n));
}

static void set_flicker(imk_noise *noise)
{
    noise->bias_instability = axes(0.5, 0.5, 0.5);
}
static double flicker(double dt, size_t n)
{
    return imk_flicker_sampled_allan_variance((imk_flicker){0.5, 0}, dt, n);
}

static void set_gauss_markov(imk_noise *noise, double correlation_time)
{
    noise->gauss_markov_count = 1;
    noise->gauss_markov[0].sigma = axes(0.7, 0.7, 0.7);
    noise->gauss_markov[0].correlation_time =
        axes(correlation_time, correlation_time, correlation_time);
}
/* At 10, 100 and 1000 Hz: dt/T = 2, 0.2, 0.02 */
static void set_short_gauss_markov(imk_noise *noise)
{
    set_gauss_markov(noise, 0.05);
}
static double short_gauss_markov(double dt, size_t n)
{
    return imk_gauss_markov_sampled_allan_variance((imk_gauss_markov){0.7, 0.05}, dt, n);
}
/* dt/T = 0.1, 0.01, 0.001 */
static void set_long_gauss_markov(imk_noise *noise)
{
    set_gauss_markov(noise, 1.0);
}
static double long_gauss_markov(double dt, size_t n)
{
    return imk_gauss_markov_sampled_allan_variance((imk_gauss_markov){0.7, 1.0}, dt, n);
}

static void set_resonance(imk_noise *noise)
{
    noise->resonance_count = 1;
    noise->resonance[0].sigma = axes(0.4, 0.4, 0.4);
    noise->resonance[0].frequency = axes(3.0, 3.0, 3.0);
    noise->resonance[0].q = axes(5.0, 5.0, 5.0);
}
static double resonance(double dt, size_t n)
{
    return imk_resonance_sampled_allan_variance((imk_resonance){0.4, 3.0, 5.0}, dt, n);
}

static void set_sinusoid(imk_noise *noise)
{
    noise->sinusoid_count = 1;
    noise->sinusoid[0].amplitude = axes(0.4, 0.4, 0.4);
    noise->sinusoid[0].frequency = axes(1.3, 1.3, 1.3);
}
static double sinusoid(double dt, size_t n)
{
    return imk_sinusoid_sampled_allan_variance((imk_sinusoid){0.4, 1.3}, dt, n);
}

static void set_ramp(imk_noise *noise)
{
    noise->ramp = axes(0.1, -0.1, 0.1);
}
/* R^2 tau^2/2 at every factor */
static double ramp(double dt, size_t n)
{
    double tau = (double)n * dt;
    return 0.1 * 0.1 * tau * tau / 2.0;
}

/* 3 r^2/tau^2 at every rate */
static void set_reading(imk_noise *noise)
{
    noise->reading_noise = axes(0.02, 0.02, 0.02);
}
static double reading(double dt, size_t n)
{
    const double tau = (double)n * dt;
    return 3.0 * 0.02 * 0.02 / (tau * tau);
}

/* 3 A^2/(dt tau^2): ten times as much at a hundred times the rate */
static void set_angle_white(imk_noise *noise)
{
    noise->angle_white = axes(0.02, 0.02, 0.02);
}
static double angle_white(double dt, size_t n)
{
    const double tau = (double)n * dt;
    return 3.0 * 0.02 * 0.02 / (dt * tau * tau);
}

/* Rounding of the integral to 0.007, which white noise moves by 0.0095 in a millisecond: N^2/tau +
 * 3 Q^2/tau^2, of which the second is a ninth at 1000 Hz. */
static void set_quantization(imk_noise *noise)
{
    noise->white = axes(0.3, 0.3, 0.3);
    noise->quantization = axes(0.002, 0.002, 0.002);
}
static double quantization(double dt, size_t n)
{
    const double tau = (double)n * dt;
    return 0.3 * 0.3 / tau + 3.0 * 0.002 * 0.002 / (tau * tau);
}

typedef struct term {
    const char *name;
    void (*set)(imk_noise *noise);
    double (*allan_variance)(double dt, size_t n);
    double rounding; /* relative, for a term that does not scatter */
} term;

static const term terms[] = {
    {"white", set_white, white, 0.0},
    {"random_walk", set_walk, walk, 0.0},
    {"bias_instability", set_flicker, flicker, 0.0},
    {"gauss_markov, 0.05 s", set_short_gauss_markov, short_gauss_markov, 0.0},
    {"gauss_markov, 1 s", set_long_gauss_markov, long_gauss_markov, 0.0},
    {"resonance", set_resonance, resonance, 0.0},
    {"sinusoid", set_sinusoid, sinusoid, 1e-9},
    {"ramp", set_ramp, ramp, 1e-9},
    {"reading_noise", set_reading, reading, 0.0},
    {"angle_white", set_angle_white, angle_white, 0.0},
    {"white, quantization", set_quantization, quantization, 0.0},
};

/* Allan variance of `rows` samples, stretches of n side by side. */
static double allan_variance(const double *y, size_t rows, size_t n)
{
    double sum = 0.0, before = 0.0;
    const size_t stretches = rows / n;
    for (size_t s = 0; s < stretches; s++) {
        double mean = 0.0;
        for (size_t k = 0; k < n; k++)
            mean += y[s * n + k] / (double)n;
        if (s > 0)
            sum += (mean - before) * (mean - before);
        before = mean;
    }
    return 0.5 * sum / (double)(stretches - 1);
}

static void check_rate(const term *t, double rate)
{
    imk_model model;
    imk_model_default(&model);
    t->set(&model.gyro.noise);
    model.accel.present = false;
    imk_simulation simulation = imk_simulation_default();
    simulation.earth = false;
    simulation.rate = rate;
    double sum[FACTORS] = {0.0}, square[FACTORS] = {0.0};
    for (simulation.run = 0; simulation.run < RUNS; simulation.run++) {
        double *log = simulate_rows(&model, &simulation, ROWS);
        for (size_t axis = 0; axis < AXES; axis++)
            for (size_t i = 0; i < FACTORS; i++) {
                double variance = allan_variance(log + axis * ROWS, ROWS, factors[i]);
                sum[i] += variance;
                square[i] += variance * variance;
            }
        free(log);
    }
    for (size_t i = 0; i < FACTORS; i++) {
        const double count = (double)RUNS * AXES, mean = sum[i] / count;
        const double scatter = sqrt(fmax(square[i] / count - mean * mean, 0.0) / count);
        const double expected = t->allan_variance(1.0 / rate, factors[i]);
        CHECK_CLOSE(mean, expected, 6.0 * scatter + t->rounding * expected);
        assert_true(6.0 * scatter < 0.5 * expected); /* it can fail */
    }
}

static void test_term(void **state)
{
    for (size_t i = 0; i < RATES; i++)
        check_rate(*state, rates[i]);
}

/* ---- traps ------------------------------------------------------------------------------------
 */

/* Increments of a random walk: K sqrt(dt), at any rate, chi-square of 3069 of them at 1e-7 each
 * side. */
static void test_random_walk_increments(void **state)
{
    (void)state;
    for (size_t i = 0; i < RATES; i++) {
        imk_model model;
        imk_model_default(&model);
        set_walk(&model.gyro.noise);
        imk_simulation simulation = imk_simulation_default();
        simulation.earth = false;
        simulation.rate = rates[i];
        double *log = simulate_rows(&model, &simulation, ROWS), sum = 0.0;
        for (size_t k = 1; k < ROWS; k++)
            for (size_t axis = 0; axis < AXES; axis++) {
                double step = log[axis * ROWS + k] - log[axis * ROWS + k - 1];
                sum += step * step * rates[i] / (0.2 * 0.2);
            }
        double probability = imk_chi_square_probability(sum, AXES * (ROWS - 1.0));
        assert_true(probability > 1e-7 && probability < 1.0 - 1e-7);
        free(log);
    }
}

/* Stationary from the first sample: over runs, sample 0 and sample 1 have the full variance and the
 * correlation e^(-dt/T), for dt/T from 0.01 to 2. */
static void test_gauss_markov_first_sample(void **state)
{
    (void)state;
    static const double ratio[] = {0.01, 0.1, 0.5, 1.0, 2.0};
    enum { DRAWS = 1500 };
    for (size_t i = 0; i < sizeof ratio / sizeof ratio[0]; i++) {
        imk_model model;
        imk_model_default(&model);
        set_gauss_markov(&model.gyro.noise, 0.01 / ratio[i]);
        model.accel.present = false;
        imk_simulation simulation = imk_simulation_default();
        simulation.earth = false;
        double square[2] = {0.0}, difference = 0.0;
        for (simulation.run = 0; simulation.run < DRAWS; simulation.run++) {
            double *log = simulate_rows(&model, &simulation, 2);
            for (size_t axis = 0; axis < AXES; axis++) {
                double a = log[2 * axis] / 0.7, b = log[2 * axis + 1] / 0.7;
                square[0] += a * a;
                square[1] += b * b;
                difference += (b - a) * (b - a);
            }
            free(log);
        }
        const double phi = exp(-ratio[i]), freedom = AXES * (double)DRAWS;
        const double sums[3] = {square[0], square[1], difference / (2.0 * (1.0 - phi))};
        for (size_t j = 0; j < 3; j++) {
            double probability = imk_chi_square_probability(sums[j], freedom);
            assert_true(probability > 1e-7 && probability < 1.0 - 1e-7);
        }
    }
}

/* The generator is flat within 2 % over four decades: its exact Allan deviation, 20 factors. */
static void test_flicker_is_flat(void **state)
{
    (void)state;
    const double flat = sqrt(2.0 * 0.69314718055994531 / 3.14159265358979324);
    for (double n = 2.0; n <= 20000.0; n *= 1.6) {
        double variance =
            imk_flicker_sampled_allan_variance((imk_flicker){1.0, 0}, 0.01, (size_t)n);
        CHECK_RELATIVE(sqrt(variance), flat, 0.02);
    }
}

/* A repeatability is one constant from the first sample to the last, of the stated deviation over
 * runs, and independent of the axis. */
static void test_repeatability_stays(void **state)
{
    (void)state;
    enum { LONG = 40000, DRAWS = 400 };
    imk_model model;
    imk_model_default(&model);
    model.gyro.bias.repeatability = axes(0.5, 1.0, 0.0);
    imk_simulation simulation = imk_simulation_default();
    simulation.earth = false;
    double *log = simulate_rows(&model, &simulation, LONG);
    for (size_t axis = 0; axis < AXES; axis++)
        for (size_t k = 0; k < LONG; k++)
            CHECK_CLOSE(log[axis * LONG + k], log[axis * LONG], 0.0);
    assert_true(log[0] != 0.0 && log[LONG] != 0.0 && log[2 * LONG] == 0.0);
    free(log);
    double sum = 0.0;
    for (simulation.run = 0; simulation.run < DRAWS; simulation.run++) {
        log = simulate_rows(&model, &simulation, 1);
        sum += log[0] * log[0] / 0.25 + log[1] * log[1];
        free(log);
    }
    double probability = imk_chi_square_probability(sum, 2.0 * DRAWS);
    assert_true(probability > 1e-7 && probability < 1.0 - 1e-7);
}

/* Runs, seeds and axes are uncorrelated: |r| of 1024 samples below 6/sqrt(1024). */
static void test_runs_are_independent(void **state)
{
    (void)state;
    imk_model model;
    imk_model_default(&model);
    set_white(&model.gyro.noise);
    imk_simulation simulation = imk_simulation_default();
    simulation.earth = false;
    double *log[3];
    log[0] = simulate_rows(&model, &simulation, ROWS);
    simulation.run = 1;
    log[1] = simulate_rows(&model, &simulation, ROWS);
    simulation.run = 0;
    simulation.seed = 1;
    log[2] = simulate_rows(&model, &simulation, ROWS);
    for (size_t a = 0; a < 3 * AXES; a++)
        for (size_t b = 0; b < a; b++) {
            const double *x = log[a / AXES] + a % AXES * ROWS, *y = log[b / AXES] + b % AXES * ROWS;
            double xy = 0.0, xx = 0.0, yy = 0.0;
            for (size_t k = 0; k < ROWS; k++) {
                xy += x[k] * y[k];
                xx += x[k] * x[k];
                yy += y[k] * y[k];
            }
            CHECK_BELOW(fabs(xy / sqrt(xx * yy)), 6.0 / sqrt(ROWS));
        }
    for (size_t i = 0; i < 3; i++)
        free(log[i]);
}

/* A zero on one axis silences no other. */
static void test_zero_axis(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof terms / sizeof terms[0]; i++) {
        imk_model model;
        imk_model_default(&model);
        imk_noise *noise = &model.gyro.noise;
        terms[i].set(noise);
        noise->white.value[0] = noise->random_walk.value[0] = noise->bias_instability.value[0] =
            0.0;
        noise->ramp.value[0] = noise->gauss_markov[0].sigma.value[0] = 0.0;
        noise->resonance[0].sigma.value[0] = noise->sinusoid[0].amplitude.value[0] = 0.0;
        noise->reading_noise.value[0] = noise->angle_white.value[0] = 0.0;
        noise->quantization.value[0] = 0.0;
        imk_simulation simulation = imk_simulation_default();
        simulation.earth = false;
        double *log = simulate_rows(&model, &simulation, ROWS);
        for (size_t axis = 0; axis < AXES; axis++) {
            double sum = 0.0;
            for (size_t k = 0; k < ROWS; k++)
                sum += fabs(log[axis * ROWS + k]);
            assert_true(axis == 0 ? sum == 0.0 : sum > 1.0);
        }
        free(log);
    }
}

int main(void)
{
    enum { TERMS = sizeof terms / sizeof terms[0], OTHERS = 6 };
    const struct CMUnitTest others[OTHERS] = {
        cmocka_unit_test(test_random_walk_increments),
        cmocka_unit_test(test_gauss_markov_first_sample),
        cmocka_unit_test(test_flicker_is_flat),
        cmocka_unit_test(test_repeatability_stays),
        cmocka_unit_test(test_runs_are_independent),
        cmocka_unit_test(test_zero_axis),
    };
    struct CMUnitTest tests[TERMS + OTHERS];
    for (size_t i = 0; i < TERMS; i++)
        tests[i] = (struct CMUnitTest){
            .name = terms[i].name, .test_func = test_term, .initial_state = (void *)&terms[i]};
    memcpy(tests + TERMS, others, sizeof others);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
