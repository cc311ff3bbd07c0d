/* SPDX-License-Identifier: Apache-2.0 */
/* A simulated temperature sweep: a consumer-grade MEMS unit at rest, in a chamber that goes 25,
 * -20, 65, 25 degC at 2 K/min, logged at 5 Hz in counts with a thermometer that has noise. Raw
 * samples come from the simulator: white noise, bias instability, counts, Earth rate. Axis x has
 * thermal hysteresis, y a bias in proportion to the rate of temperature, z neither. Used by
 * test_thermal.c (some hundred benches) and experiments/coverage_thermal.c (thousands). */
#ifndef IMUKIT_TEST_THERMAL_SESSION_H
#define IMUKIT_TEST_THERMAL_SESSION_H

#include "imukit/procedure.h"
#include "imukit/simulate.h"
#include "imukit/thermal.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { THERMAL_RATE = 5, THERMAL_SECONDS = 5100, THERMAL_ROWS = THERMAL_RATE * THERMAL_SECONDS };

static const double thermal_time[] = {0.0, 1350.0, 3900.0, 5100.0}; /* [s] */
static const double thermal_point[] = {298.15, 253.15, 338.15, 298.15};
static const imk_temperature_profile thermal_profile = {
    .point_count = 4, .time = thermal_time, .temperature = thermal_point, .time_constant = 100.0};

typedef struct thermal_session {
    imk_model truth, nominal;
    double *value[6], *temperature, *clean;
    void *simulator, *workspace;
    size_t simulator_size;
    imk_test_record record;
    imk_thermal_findings findings;
    imk_error error;
} thermal_session;

/* 0.3 deg/sqrt(h), 8 deg/h; 100 ug/sqrt(Hz), 20 ug; 131 counts per deg/s, 16384 per g. What
 * temperature does is of the size data sheets of such units state, 0.02 deg/s/K and 0.5 mg/K. */
static inline void thermal_truth(thermal_session *b)
{
    const double degree = 0.017453292519943295, g = 9.80665;
    imk_model *m = &b->truth;
    imk_model_default(&b->nominal);
    for (int i = 0; i < 3; i++) {
        b->nominal.gyro.sensitivity.value[i] = 131.0 / degree;
        b->nominal.accel.sensitivity.value[i] = 16384.0 / g;
    }
    *m = b->nominal;
    imk_triad *const triads[2] = {&m->gyro, &m->accel};
    const double unit[2] = {0.02 * degree, 0.5e-3 * g};
    for (int s = 0; s < 2; s++) {
        imk_temperature_polynomial *p = &triads[s]->bias.temperature;
        p->order = s == IMK_GYRO ? 3 : 2;
        p->reference = 298.15;
        p->minimum = 253.15;
        p->maximum = 338.15;
        for (int i = 0; i < 3; i++) {
            p->coefficient[0].value[i] = unit[s] * (0.7 - i);
            p->coefficient[1].value[i] = unit[s] * 0.01 * (1.3 - i);
            p->coefficient[2].value[i] = s == IMK_GYRO ? unit[s] * 3e-4 * (i - 1.6) : 0.0;
        }
        triads[s]->bias.hysteresis.value[0] = 10.0 * unit[s];
        triads[s]->bias.temperature_rate.value[1] = 200.0 * unit[s];
    }
    for (int i = 0; i < 3; i++) {
        m->gyro.bias.fixed.value[i] = 0.5 * degree * (i - 0.8);
        m->gyro.noise.white.value[i] = 0.005 * degree;
        m->gyro.noise.bias_instability.value[i] = 8.0 / 3600.0 * degree;
        m->accel.bias.fixed.value[i] = 0.02 * g * (1.4 - i);
        m->accel.noise.white.value[i] = 100e-6 * g;
        m->accel.noise.bias_instability.value[i] = 20e-6 * g;
    }
}

static inline imk_simulation thermal_simulation(uint64_t seed)
{
    imk_simulation s = imk_simulation_default();
    s.rate = THERMAL_RATE;
    s.seed = seed;
    s.roll = 0.3;
    s.pitch = 0.2;
    s.temperature = &thermal_profile;
    return s;
}

/* Memory for benches of `truth`; to be freed. */
static inline bool thermal_open(thermal_session *b)
{
    double time[THERMAL_RATE];
    const imk_simulation simulation = thermal_simulation(0);
    b->simulator_size = imk_simulator_size(&b->truth, &simulation);
    b->simulator = aligned_alloc(64, (b->simulator_size + 63) / 64 * 64);
    b->workspace = malloc(imk_thermal_workspace_size());
    b->temperature = malloc(2 * THERMAL_ROWS * sizeof(double));
    b->clean = b->temperature ? b->temperature + THERMAL_ROWS : NULL;
    b->record = (imk_test_record){.name = "sweep",
                                  .count = THERMAL_ROWS,
                                  .dt = 1.0 / THERMAL_RATE,
                                  .axis_count = {3, 3},
                                  .counts = {true, true},
                                  .temperature = b->temperature};
    bool ok = b->simulator && b->workspace && b->temperature;
    for (int i = 0; i < 6; i++) {
        b->value[i] = malloc(THERMAL_ROWS * sizeof(double));
        b->record.reading[i / 3][i % 3] = b->value[i];
        ok = ok && b->value[i];
    }
    /* Row k covers the interval that ends at k/rate; its mean temperature is that of its middle. */
    for (size_t k = 0; ok && k < THERMAL_SECONDS; k++) {
        for (size_t j = 0; j < THERMAL_RATE; j++)
            time[j] = (double)k + ((double)j - 0.5) / THERMAL_RATE;
        imk_temperature_at(&thermal_profile, THERMAL_RATE, time, b->clean + k * THERMAL_RATE, NULL);
    }
    /* The loop of a unit is stated over the range it was seen in. */
    imk_temperature_polynomial *const p[2] = {&b->truth.gyro.bias.temperature,
                                              &b->truth.accel.bias.temperature};
    for (int s = 0; s < 2; s++) {
        p[s]->minimum = p[s]->maximum = p[s]->reference;
        for (size_t k = 0; ok && k < THERMAL_ROWS; k++) {
            p[s]->minimum = fmin(p[s]->minimum, b->clean[k]);
            p[s]->maximum = fmax(p[s]->maximum, b->clean[k]);
        }
    }
    return ok;
}

static inline void thermal_close(thermal_session *b)
{
    for (int i = 0; i < 6; i++)
        free(b->value[i]);
    free(b->temperature);
    free(b->simulator);
    free(b->workspace);
}

/* Simulate one session. `knocks`: a tenth of the log, in stretches of 40 s, is off by a hundred
 * times the white noise of a sample. */
static inline bool thermal_run(thermal_session *b, uint64_t seed, bool knocks)
{
    enum { STRETCH = 40 * THERMAL_RATE };
    const imk_random random = imk_random_seeded(seed);
    const imk_simulation simulation = thermal_simulation(seed);
    const double thermometer = 0.02; /* [K], 1 sigma of a sample */
    imk_simulator *simulator;
    if (imk_simulator_start(&b->truth, &simulation, &simulator, b->simulator, b->simulator_size,
                            &b->error) != IMK_OK)
        return false;
    imk_simulator_next(simulator, THERMAL_ROWS, b->value, NULL);
    imk_random_normals(random, imk_stream(0, 900, 0, 0), 0, THERMAL_ROWS, b->temperature);
    for (size_t k = 0; k < THERMAL_ROWS; k++)
        b->temperature[k] = b->clean[k] + thermometer * b->temperature[k];
    for (size_t k = 0; knocks && k + STRETCH <= THERMAL_ROWS; k += STRETCH) {
        uint32_t word;
        imk_random_words(random, imk_stream(0, 901, 0, 0), k / STRETCH, 1, &word);
        if (word % 10 != 0)
            continue;
        for (int i = 0; i < 6; i++) {
            const imk_triad *triad = i < 3 ? &b->truth.gyro : &b->truth.accel;
            const double off = 100.0 * triad->noise.white.value[i % 3] * sqrt(THERMAL_RATE) *
                               triad->sensitivity.value[i % 3] * ((word >> (8 + i) & 1u) ? 1 : -1);
            for (size_t j = k; j < k + STRETCH; j++)
                b->value[i][j] += off;
        }
    }
    return true;
}

/* ---- counting -------------------------------------------------------------------------------- */

/* What is counted on each axis: five coefficients, width of the loop, rate. */
enum { THERMAL_COUNTED = 7 };

typedef struct thermal_count {
    size_t benches, failed;
    size_t cause[6][IMK_THERMAL_CAUSES], order[6][IMK_TEMPERATURE_ORDER_MAX + 1];
    size_t counted[6][THERMAL_COUNTED], held[6][THERMAL_COUNTED];
    double sum[6][THERMAL_COUNTED], square[6][THERMAL_COUNTED];
} thermal_count;

/* Half width of a 95 % interval in sigmas. */
static const double thermal_interval = 1.959963984540054;

static inline void thermal_add_one(thermal_count *c, int axis, int what, imk_scalar found,
                                   double truth)
{
    const double error = (found.value - truth) / found.sigma;
    c->counted[axis][what]++;
    c->held[axis][what] += fabs(error) <= thermal_interval;
    c->sum[axis][what] += error;
    c->square[axis][what] += error * error;
}

static inline void thermal_add(thermal_count *c, const thermal_session *b)
{
    c->benches++;
    for (int i = 0; i < 6; i++) {
        const imk_thermal_axis *found = &b->findings.axis[i / 3][i % 3];
        const imk_bias *bias = i < 3 ? &b->truth.gyro.bias : &b->truth.accel.bias;
        c->cause[i][found->cause]++;
        c->order[i][found->order]++;
        for (int k = 0; k < found->order; k++)
            thermal_add_one(c, i, k, found->coefficient[k],
                            bias->temperature.coefficient[k].value[i % 3]);
        if (found->cause == IMK_THERMAL_HYSTERESIS || found->cause == IMK_THERMAL_BOTH)
            thermal_add_one(c, i, 5, found->hysteresis, bias->hysteresis.value[i % 3]);
        if (found->cause == IMK_THERMAL_RATE || found->cause == IMK_THERMAL_BOTH)
            thermal_add_one(c, i, 6, found->temperature_rate, bias->temperature_rate.value[i % 3]);
    }
}

static inline void thermal_print(const thermal_count *c, FILE *out)
{
    static const char *const axes[6] = {"gyro.x",  "gyro.y",  "gyro.z",
                                        "accel.x", "accel.y", "accel.z"};
    static const char *const names[THERMAL_COUNTED] = {
        "order 1", "order 2", "order 3", "order 4", "order 5", "hysteresis", "rate"};
    for (int i = 0; i < 6; i++) {
        fprintf(out, "  %-8s order", axes[i]);
        for (int k = 0; k <= IMK_TEMPERATURE_ORDER_MAX; k++)
            fprintf(out, " %zu", c->order[i][k]);
        fprintf(out, "   cause");
        for (int k = 0; k < IMK_THERMAL_CAUSES; k++)
            fprintf(out, " %zu", c->cause[i][k]);
        fprintf(out, "\n");
        for (int k = 0; k < THERMAL_COUNTED; k++)
            if (c->counted[i][k] > 0) {
                const double n = (double)c->counted[i][k];
                fprintf(out, "    %-12s %6zu  held %6.2f %%   bias %+.3f sigma   rms %.3f sigma\n",
                        names[k], c->counted[i][k], 100.0 * (double)c->held[i][k] / n,
                        c->sum[i][k] / n, sqrt(c->square[i][k] / n));
            }
    }
}

#endif
