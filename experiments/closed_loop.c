/* SPDX-License-Identifier: Apache-2.0 */
/* Simulate, identify, compare: coverage and bias over thousands of logs.
 *
 * usage: closed_loop [logs] [seed] [first log]
 *
 * Each log is three hours of three gyro axes at 100 Hz with N = 0.3 deg/sqrt(h), B = 8 deg/h,
 * K = 20 deg/h/sqrt(h), and gives three estimates of each parameter. Prints, per parameter, how
 * often the 95 % profile-likelihood interval covers the truth, the bias in units of the stated
 * sigma and of the scatter, how often the term is called present, and how often something false is
 * found. */
#include "imukit/imukit.h"
#include "imukit/io.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { AXES = 3, SAMPLES = 1080000 };
static const double RATE = 100, DEGREE = 0.017453292519943295;

typedef struct tally {
    double truth;
    size_t trials, covered, present;
    double sum, squares, stated; /* of the squared parameter, and of the stated sigma */
} tally;

typedef struct experiment {
    const imk_identify_settings *settings;
    double *columns[6];
    imk_identification result[AXES];
    imk_status status[AXES];
    void *workspace[AXES];
    size_t workspace_size;
} experiment;

static void identify_item(void *context, size_t axis)
{
    experiment *e = context;
    e->status[axis] = imk_identify_channel(e->settings, SAMPLES, e->columns[axis], &e->result[axis],
                                           e->workspace[axis], e->workspace_size, NULL);
}

static void count(tally *t, const imk_estimate *e)
{
    t->trials++;
    t->covered += e->lower <= t->truth && t->truth <= e->upper;
    t->present += e->present;
    t->sum += e->value * e->value;
    t->squares += pow(e->value, 4);
    t->stated += e->present ? pow(2 * e->value * e->sigma, 2) : 0;
}

static void print(const char *name, const tally *t)
{
    const double n = (double)t->trials, truth = t->truth * t->truth, mean = t->sum / n;
    const double sd = sqrt(fmax(0, t->squares / n - mean * mean));
    const double stated = sqrt(t->stated / fmax(1, (double)t->present));
    printf("%s: %zu estimates, 95 %% intervals cover %.2f %% (+- %.2f), present %.1f %%\n", name,
           t->trials, 100 * (double)t->covered / n, 100 * sqrt(0.05 * 0.95 / n),
           100 * (double)t->present / n);
    printf("   squared: mean/truth %.5f, sd/truth %.5f, stated sd/truth %.5f, bias %.3f stated sd, "
           "%.3f sd\n",
           mean / truth, sd / truth, stated / truth, (mean - truth) / stated, (mean - truth) / sd);
}

int main(int argc, char **argv)
{
    const size_t logs = argc > 1 ? strtoul(argv[1], NULL, 10) : 1000;
    const uint64_t seed = argc > 2 ? strtoull(argv[2], NULL, 10) : 1;
    const size_t first = argc > 3 ? strtoul(argv[3], NULL, 10) : 0;

    tally n = {.truth = 0.3 * DEGREE / 60}, b = {.truth = 8 * DEGREE / 3600},
          k = {.truth = 20 * DEGREE / 3600 / 60};
    imk_model model = imk_model_default();
    model.accel.present = false;
    for (int axis = 0; axis < AXES; axis++) {
        model.gyro.noise.white.value[axis] = n.truth;
        model.gyro.noise.bias_instability.value[axis] = b.truth;
        model.gyro.noise.random_walk.value[axis] = k.truth;
    }
    imk_identify_settings settings = imk_identify_default();
    settings.dt = 1 / RATE;
    experiment e = {.settings = &settings, .workspace_size = imk_identify_workspace_size(SAMPLES)};
    for (int axis = 0; axis < AXES; axis++) {
        e.columns[axis] = malloc(SAMPLES * sizeof(double));
        e.workspace[axis] = malloc(e.workspace_size);
    }
    imk_simulation simulation = imk_simulation_default();
    simulation.rate = RATE;
    simulation.seed = seed;
    const size_t size = (imk_simulator_size(&model, &simulation) + 63) / 64 * 64;
    void *memory = aligned_alloc(64, size);
    imk_thread_pool *pool = imk_thread_pool_create(0);
    const imk_executor executor = imk_thread_pool_executor(pool);
    size_t quantization = 0, ramp = 0, shape = 0, gauss_markov = 0, failed = 0;
    for (size_t log = first; log < first + logs; log++) {
        simulation.run = (uint32_t)log;
        imk_simulator *simulator;
        imk_error error;
        if (imk_simulator_start(memory, size, &model, &simulation, &simulator, &error) != IMK_OK) {
            char text[512];
            imk_error_text(&error, NULL, text, sizeof text);
            fprintf(stderr, "%s\n", text);
            return 1;
        }
        imk_simulator_next(simulator, SAMPLES, e.columns, &executor);
        imk_execute(&executor, AXES, identify_item, &e);
        for (int axis = 0; axis < AXES; axis++) {
            const imk_identification *r = &e.result[axis];
            failed += e.status[axis] != IMK_OK;
            count(&n, &r->term[IMK_NOISE_WHITE]);
            count(&b, &r->term[IMK_NOISE_BIAS_INSTABILITY]);
            count(&k, &r->term[IMK_NOISE_RANDOM_WALK]);
            quantization += r->term[IMK_NOISE_QUANTIZATION].present;
            ramp += r->term[IMK_NOISE_RAMP].present;
            shape += r->filter.bandwidth > 0 || r->sinusoid_count > 0 || r->resonance_count > 0;
            gauss_markov += r->gauss_markov_count > 0;
        }
    }
    print("N", &n);
    print("B", &b);
    print("K", &k);
    printf(
        "false: quantization %zu, ramp %zu, lines or filter %zu, Gauss-Markov %zu of %zu; failed "
        "%zu\n",
        quantization, ramp, shape, gauss_markov, n.trials, failed);
    imk_thread_pool_destroy(pool);
    return failed > 0;
}
