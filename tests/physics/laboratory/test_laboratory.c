/* SPDX-License-Identifier: Apache-2.0 */
/* The experiments find what was put into an instrument whose errors are known: a made-up one that
 * does nothing but have them. */
#include "check.h"

#include "imukit/distort.h"
#include "imukit/elementary.h"
#include "imukit/laboratory.h"

#include <stdlib.h>
#include <string.h>

#define G 9.80665

typedef struct errors {
    uint32_t cookie; /* 0 */
    double bias, scale, k2, koq, k3, asymmetry, dead_band, bandwidth, white;
    double bias_temperature, scale_temperature, temperature_rate;
    double linear[3], quadratic[6]; /* in f */
    double repeatability;           /* of the bias */
    double stated;                  /* what the closed forms state, of the truth; 0: nothing */
    bool separate;                  /* inputs change the noise: nothing is common to two readings */
} errors;

typedef struct unit {
    errors e;
    double smoothing, filtered, deviation, constant;
    imk_random random;
    uint64_t stream, next;
} unit;

static void set_default(void *design)
{
    memset(design, 0, sizeof(errors));
}

static imk_status check(const void *design, imk_error *error)
{
    const errors *e = design;
    return e->white >= 0.0 ? IMK_OK
                           : imk_error_set(error, IMK_ERROR_RANGE, "white", NULL, "at least 0");
}

static imk_status start(const void *design, const imk_physics_settings *settings, void *state,
                        imk_error *error)
{
    unit *u = state;
    u->e = *(const errors *)design;
    u->smoothing = u->e.bandwidth > 0.0
                       ? -imk_expm1(-6.283185307179586 * u->e.bandwidth / settings->rate)
                       : 1.0;
    u->deviation = settings->noise ? u->e.white * sqrt(settings->rate) : 0.0;
    u->random = imk_random_seeded(settings->seed);
    u->stream = imk_stream(settings->run, 999, settings->occasion, 0);
    imk_random_normals(u->random, imk_stream(settings->run, 998, 0, 0), 0, 1, &u->constant);
    u->constant *= settings->noise ? u->e.repeatability : 0.0;
    (void)error;
    return IMK_OK;
}

/* Stimulus x: the rate of a gyro, the force of an accelerometer. */
static double reading(unit *u, const imk_exposure *exposure, double x)
{
    const errors *e = &u->e;
    const double *f = exposure->specific_force, warm = exposure->temperature - 293.15;
    double y = fabs(x) < e->dead_band ? 0.0 : x, noise = 0.0;
    y += e->bias + u->constant + e->bias_temperature * warm +
         (e->scale + e->scale_temperature * warm) * x + e->k2 * x * x + e->koq * x * fabs(x) +
         e->k3 * x * x * x + 0.5 * e->asymmetry * fabs(x) +
         e->temperature_rate * exposure->temperature_rate;
    for (int k = 0; k < 3; k++)
        y += e->linear[k] * f[k] + e->quadratic[k] * f[k] * f[k] +
             e->quadratic[3 + k] * f[k] * f[(k + 1) % 3];
    u->filtered += u->smoothing * (y - u->filtered);
    const double *w = exposure->angular_rate;
    const uint64_t other = e->separate
                               ? (uint64_t)(1e3 * fabs(20.0 + w[0] + 2.0 * w[1] + 3.0 * w[2]) +
                                            1e4 * fabs(10.0 + f[0] + 2 * f[1] + 3 * f[2]))
                               : 0;
    imk_random_normals(u->random, u->stream, (other << 32) + u->next++, 1, &noise);
    return u->filtered + u->deviation * noise;
}

static void gyro_step(void *state, const imk_exposure *exposure, double *outputs)
{
    outputs[0] = reading(state, exposure, exposure->angular_rate[0]);
}

static void accel_step(void *state, const imk_exposure *exposure, double *outputs)
{
    outputs[0] = reading(state, exposure, exposure->specific_force[0]);
}

static void gyro_reduce(const void *design, imk_triad *triad)
{
    const errors *e = design;
    triad->bias.repeatability.value[0] = e->repeatability;
    for (int k = 0; k < 3; k++)
        triad->g_sensitivity.value[0][k] = e->stated * e->linear[k];
    triad->bias.fixed.value[0] = e->stated * e->bias;
    triad->bandwidth.value[0] = ((const errors *)design)->bandwidth;
    triad->range.value[0] = 5.0;
}

static void accel_reduce(const void *design, imk_triad *triad)
{
    triad->bandwidth.value[0] = ((const errors *)design)->bandwidth;
    triad->range.value[0] = 50.0;
}

static const imk_instrument gyro = {.name = "gyro",
                                    .title = "gyro",
                                    .source = "",
                                    .sensor = IMK_GYRO,
                                    .design_size = sizeof(errors),
                                    .state_size = sizeof(unit),
                                    .output_count = 1,
                                    .set_default = set_default,
                                    .check = check,
                                    .init = start,
                                    .step = gyro_step,
                                    .reduce = gyro_reduce};
static const imk_instrument accel = {.name = "accel",
                                     .title = "accel",
                                     .source = "",
                                     .sensor = IMK_ACCEL,
                                     .design_size = sizeof(errors),
                                     .state_size = sizeof(unit),
                                     .output_count = 1,
                                     .set_default = set_default,
                                     .check = check,
                                     .init = start,
                                     .step = accel_step,
                                     .reduce = accel_reduce};

static const errors truth = {.bias = 0.01,
                             .scale = 2e-3,
                             .k2 = 3e-4,
                             .koq = -2e-4,
                             .k3 = 5e-5,
                             .asymmetry = 1e-3,
                             .bandwidth = 8.0,
                             .bias_temperature = 1e-4,
                             .scale_temperature = -3e-5,
                             .temperature_rate = 0.2,
                             .linear = {1e-4, -2e-4, 3e-4},
                             .quadratic = {1e-5, 2e-5, -1e-5, 4e-5, -3e-5, 5e-5}};

static imk_laboratory_result *experiment(const imk_laboratory *laboratory)
{
    const size_t size = imk_laboratory_workspace_size(laboratory);
    imk_laboratory_result *result = malloc(sizeof *result);
    void *workspace = malloc(size);
    imk_error error;
    assert_true(result && workspace);
    CHECK_OK(imk_laboratory_run(laboratory, NULL, result, workspace, size, &error));
    free(workspace);
    return result;
}

static void a_gyro_without_noise_is_found_exactly(void **state)
{
    (void)state;
    imk_laboratory laboratory = imk_laboratory_default();
    laboratory.instrument = &gyro;
    laboratory.design = &truth;
    laboratory.record = 0.0;
    laboratory.settle = 1.0;
    imk_laboratory_result *result = experiment(&laboratory);
    const imk_triad *t = &result->model.gyro;
    /* a fit of ten numbers of which the largest is 5: some 1e-15 of it, divided by the input */
    CHECK_CLOSE(t->bias.fixed.value[0], truth.bias, 1e-13);
    CHECK_CLOSE(t->scale_factor.fixed.value[0], truth.scale, 1e-13);
    CHECK_CLOSE(t->nonlinearity.k2.value[0], truth.k2, 1e-13);
    CHECK_CLOSE(t->nonlinearity.koq.value[0], truth.koq, 1e-13);
    CHECK_CLOSE(t->nonlinearity.k3.value[0], truth.k3, 1e-13);
    CHECK_CLOSE(t->nonlinearity.asymmetry.value[0], truth.asymmetry, 1e-13);
    for (int k = 0; k < 3; k++)
        CHECK_CLOSE(t->g_sensitivity.value[0][k], truth.linear[k], 1e-14);
    for (int k = 0; k < 6; k++)
        CHECK_CLOSE(t->g2_sensitivity.value[0][k], truth.quadratic[k], 1e-14);
    CHECK_CLOSE(t->bias.temperature.coefficient[0].value[0], truth.bias_temperature, 1e-14);
    CHECK_CLOSE(t->scale_factor.temperature.coefficient[0].value[0], truth.scale_temperature,
                1e-14);
    CHECK_CLOSE(t->bias.temperature_rate.value[0], truth.temperature_rate, 1e-11);
    assert_int_equal(result->point_count, 21);
    assert_int_equal(result->response_count, 16);
    CHECK_CLOSE(result->threshold, 0.0, 0.0);
    /* gain of a first-order lag of 8 Hz sampled at 100 Hz: 1/|1 - (1 - c) e^{-ia}| c; the lag of
     * samples shifts it by less than 5 % */
    CHECK_RELATIVE(result->bandwidth, 8.0, 0.06);
    imk_error error;
    CHECK_OK(imk_model_validate(&result->model, &error));
    free(result);
}

static void an_accelerometer_is_tumbled(void **state)
{
    (void)state;
    imk_laboratory laboratory = imk_laboratory_default();
    errors design = truth;
    /* what fx does is the rate table's matter; here the other axes and the products */
    design.linear[0] = design.quadratic[0] = design.quadratic[1] = design.quadratic[2] = 0.0;
    design.k2 = design.koq = design.k3 = design.asymmetry = 0.0;
    laboratory.instrument = &accel;
    laboratory.design = &design;
    laboratory.record = 0.0;
    laboratory.settle = 1.0;
    imk_laboratory_result *result = experiment(&laboratory);
    const imk_triad *t = &result->model.accel;
    CHECK_CLOSE(t->scale_factor.fixed.value[0], design.scale, 1e-13);
    CHECK_CLOSE(t->cross_axis.value[0][1], design.linear[1], 1e-13);
    CHECK_CLOSE(t->cross_axis.value[0][2], design.linear[2], 1e-13);
    /* pendulous axis z, output axis y: fz fx, fx fy, fy fz */
    const double *product = t->nonlinearity.cross_products.value[0];
    CHECK_CLOSE(product[0], design.quadratic[5], 1e-14);
    CHECK_CLOSE(product[1], design.quadratic[3], 1e-14);
    CHECK_CLOSE(product[2], design.quadratic[4], 1e-14);
    free(result);
}

/* A dead band of 0.02 in a full scale of 4: readings below are 0, above they are the input. */
static void a_dead_band_is_found(void **state)
{
    (void)state;
    imk_laboratory laboratory = imk_laboratory_default();
    const errors design = {.dead_band = 0.02};
    laboratory.instrument = &gyro;
    laboratory.design = &design;
    laboratory.points = laboratory.frequencies = 0;
    laboratory.tumble = laboratory.temperature = false;
    laboratory.record = 0.0;
    imk_laboratory_result *result = experiment(&laboratory);
    /* six bisections of a ratio sqrt(10): within 1.8 % */
    CHECK_RELATIVE(result->threshold, 0.02, 0.02);
    CHECK_CLOSE(result->model.gyro.dead_band.value[0], 0.02, result->model.gyro.dead_band.sigma[0]);
    free(result);
}

/* Over 200 runs the errors of the estimates, divided by their sigmas, have unit variance: between
 * 0.55 and 1.6 for each, which Student's t with 15 degrees of freedom (variance 1.15) leaves with a
 * probability below 1e-6 [chi-square with 200 degrees of freedom, 1.15 x (0.60 … 1.55)]. */
static void sigmas_are_honest(void **state)
{
    (void)state;
    enum { RUNS = 200 };
    imk_laboratory laboratory = imk_laboratory_default();
    errors design = truth;
    double bias = 0.0, scale = 0.0, linear = 0.0;
    design.white = 1e-3;
    design.bandwidth = 0.0;
    design.separate = true;
    laboratory.instrument = &gyro;
    laboratory.design = &design;
    laboratory.cycles = 16;
    laboratory.frequencies = 0;
    laboratory.threshold = laboratory.temperature = false;
    laboratory.record = 0.0;
    laboratory.settle = 0.0;
    laboratory.dwell = 0.16;
    for (uint32_t i = 0; i < RUNS; i += check_quick() ? 20 : 1) {
        laboratory.physics.run = i;
        imk_laboratory_result *result = experiment(&laboratory);
        const imk_triad *t = &result->model.gyro;
        const double z[3] = {
            (t->bias.fixed.value[0] - truth.bias) / t->bias.fixed.sigma[0],
            (t->scale_factor.fixed.value[0] - truth.scale) / t->scale_factor.fixed.sigma[0],
            (t->g_sensitivity.value[0][1] - truth.linear[1]) / t->g_sensitivity.sigma[0][1]};
        bias += z[0] * z[0] / RUNS;
        scale += z[1] * z[1] / RUNS;
        linear += z[2] * z[2] / RUNS;
        free(result);
    }
    print_message("variances %.3f %.3f %.3f\n", bias, scale, linear);
    if (check_quick()) /* the statistics are others' */
        return;
    CHECK_BELOW(scale, 1.6);
    CHECK_BELOW(linear, 1.6);
    CHECK_BELOW(bias, 1.6);
    CHECK_BELOW(0.55, scale);
    CHECK_BELOW(0.55, linear);
    CHECK_BELOW(0.55, bias);
}

/* ---- verdicts -------------------------------------------------------------------------------- */

/* Verdicts on a truth of 1, measured in six cycles with an error of 1 sigma `noise`. */
static void count_verdicts(double computed, double noise, int counts[5])
{
    enum { TRIALS = 8000, CYCLES = 6 };
    const imk_laboratory_effort effort = {CYCLES - 1, 1.0, 1.0, NULL};
    const imk_random random = imk_random_seeded(7);
    memset(counts, 0, 5 * sizeof *counts);
    for (uint64_t i = 0; i < TRIALS; i++) {
        double draw[CYCLES], mean = 0.0, square = 0.0;
        imk_random_normals(random, 1, i * CYCLES, CYCLES, draw);
        for (int k = 0; k < CYCLES; k++)
            mean += draw[k] / CYCLES;
        for (int k = 0; k < CYCLES; k++)
            square += (draw[k] - mean) * (draw[k] - mean);
        const double scale = noise * sqrt(CYCLES);
        const imk_laboratory_figure stated = {.value = computed};
        const imk_laboratory_figure found = {
            .value = 1.0 + scale * mean, .sigma = scale * sqrt(square / (CYCLES * (CYCLES - 1.0)))};
        counts[imk_laboratory_compare(&stated, &found, computed, &effort)]++;
    }
}

/* Of 8000 trials: false alarms 0.8 expected, more than 8 in one of 5e6 [Poisson]; a closed form
 * that is wrong by half is said to agree in less than 1 %, whatever the noise, and if the
 * experiment is as good as it is made, it differs or is untold. */
static void verdicts_have_the_stated_rates(void **state)
{
    (void)state;
    static const double noises[] = {0.005, 0.01, 0.02, 0.04, 0.06, 0.1, 0.2, 0.5};
    int counts[5];
    for (size_t i = 0; i < sizeof noises / sizeof noises[0]; i++) {
        if (check_skips(i, 4))
            continue;
        count_verdicts(1.0, noises[i], counts);
        CHECK_BELOW(counts[IMK_LABORATORY_DIFFERS] + counts[IMK_LABORATORY_CLOSE], 8);
        if (noises[i] <= 0.04)
            CHECK_BELOW(7600, counts[IMK_LABORATORY_AGREES]);
        if (noises[i] >= 0.5) /* nothing was measured */
            CHECK_BELOW(counts[IMK_LABORATORY_AGREES], 80);
        count_verdicts(1.5, noises[i], counts);
        CHECK_BELOW(counts[IMK_LABORATORY_AGREES], 80);
        if (noises[i] <= 0.02) /* a third of the closed form is 25 sigma or more */
            CHECK_BELOW(7600, counts[IMK_LABORATORY_DIFFERS]);
        count_verdicts(0.5, noises[i], counts);
        CHECK_BELOW(counts[IMK_LABORATORY_AGREES], 80);
    }
}

static imk_laboratory_verdict verdict_on(const char *key, const imk_laboratory *laboratory,
                                         imk_laboratory_effort *effort)
{
    imk_laboratory_figure a[IMK_LABORATORY_FIGURES_MAX], b[IMK_LABORATORY_FIGURES_MAX];
    imk_laboratory_result *result = experiment(laboratory);
    imk_model *stated = malloc(sizeof *stated);
    size_t i = 0;
    assert_non_null(stated);
    imk_instrument_reduce(laboratory->instrument, laboratory->design, stated);
    const size_t count = imk_laboratory_figures(stated, IMK_GYRO, a);
    (void)imk_laboratory_figures(&result->model, IMK_GYRO, b);
    while (i < count && strcmp(a[i].key, key) != 0)
        i++;
    assert_true(i < count);
    const imk_laboratory_verdict verdict =
        imk_laboratory_compare(&a[i], &b[i], result->matters[i], &result->effort[i]);
    *effort = result->effort[i];
    free(stated);
    free(result);
    return verdict;
}

static imk_laboratory tumble_only(const errors *design)
{
    imk_laboratory laboratory = imk_laboratory_default();
    laboratory.instrument = &gyro;
    laboratory.design = design;
    laboratory.points = laboratory.frequencies = 0;
    laboratory.threshold = laboratory.temperature = false;
    laboratory.record = 0.0;
    laboratory.settle = 0.0;
    laboratory.dwell = 0.01; /* one sample */
    return laboratory;
}

/* G = 2e-4 at 9.8 m/s^2 is 2e-3, a sample's noise as much, and other noise in each pose: the cycles
 * are as many as tell G to 0.06 of it, some 50. */
static void an_experiment_is_as_long_as_it_has_to_be(void **state)
{
    (void)state;
    const uint64_t runs = check_quick() ? 2 : 20;
    static const double stated[] = {1.0, 1.5, 0.5};
    errors design = {.white = 2e-4, .linear = {0.0, -2e-4, 0.0}, .separate = true};
    int counts[3][5] = {{0}};
    imk_laboratory_effort effort;
    imk_laboratory laboratory = tumble_only(&design);
    laboratory.longest = 1000.0;
    for (int k = 0; k < 3; k++)
        for (uint64_t seed = 0; seed < runs; seed++) {
            design.stated = stated[k];
            laboratory.physics.seed = seed;
            counts[k][verdict_on("g_sensitivity.y", &laboratory, &effort)]++;
            CHECK_BELOW(effort.seconds, 1000.0);
        }
    if (check_quick()) /* the statistics are others' */
        return;
    /* 95 % agree, false alarms 1e-4: of 20 fewer than 15 in one of 2500 [binomial] */
    CHECK_BELOW(14, counts[0][IMK_LABORATORY_AGREES]);
    CHECK_BELOW(counts[0][IMK_LABORATORY_DIFFERS], 2);
    for (int k = 1; k < 3; k++) {
        assert_int_equal(counts[k][IMK_LABORATORY_AGREES], 0);
        CHECK_BELOW(14, counts[k][IMK_LABORATORY_DIFFERS]);
    }
}

/* In a hundredth of the time nothing can be told; the time that is then said to be needed is
 * enough, and an experiment without noise needs none. */
static void the_time_that_is_needed_is_enough(void **state)
{
    (void)state;
    errors design = {.white = 1e-3, .linear = {0.0, -2e-4, 0.0}, .separate = true, .stated = 1.0};
    imk_laboratory_effort effort;
    imk_laboratory laboratory = tumble_only(&design);
    laboratory.longest = 1e-3;
    assert_int_equal(verdict_on("g_sensitivity.y", &laboratory, &effort),
                     IMK_LABORATORY_CANNOT_TELL);
    assert_null(effort.limit);
    CHECK_BELOW(2.0 * effort.seconds, effort.needs);
    laboratory.longest = 2.0 * effort.needs;
    assert_int_equal(verdict_on("g_sensitivity.y", &laboratory, &effort), IMK_LABORATORY_AGREES);
    design.separate = false; /* the same noise in all poses */
    laboratory.longest = 1e-3;
    assert_int_equal(verdict_on("g_sensitivity.y", &laboratory, &effort), IMK_LABORATORY_AGREES);
}

/* The mean of a bias that differs from run to run needs power cycles: of 1 sigma 0.004 and a closed
 * form of 0.01, to 0.06 of it, some 45. */
static void a_bias_is_averaged_over_power_cycles(void **state)
{
    (void)state;
    errors design = {.bias = 0.01, .repeatability = 4e-3, .stated = 1.0};
    imk_laboratory_effort effort;
    imk_laboratory laboratory = tumble_only(&design);
    laboratory.tumble = false;
    laboratory.longest = 100.0;
    assert_int_equal(verdict_on("bias.fixed", &laboratory, &effort), IMK_LABORATORY_AGREES);
    CHECK_BELOW(10.0, effort.freedom);
    CHECK_BELOW(effort.freedom, 200.0);
    design.stated = 1.5;
    assert_int_equal(verdict_on("bias.fixed", &laboratory, &effort), IMK_LABORATORY_DIFFERS);
}

static bool stop(void *context, const char *stage, uint64_t done, uint64_t total)
{
    assert_true(stage && done <= total);
    return ++*(int *)context < 3;
}

static void the_experiments_can_be_stopped(void **state)
{
    (void)state;
    errors design = {.white = 1e-3};
    int calls = 0;
    imk_laboratory laboratory = tumble_only(&design);
    laboratory.temperature = true;
    laboratory.progress = stop;
    laboratory.progress_context = &calls;
    const size_t size = imk_laboratory_workspace_size(&laboratory);
    imk_laboratory_result *result = malloc(sizeof *result);
    void *workspace = malloc(size);
    imk_error error;
    assert_true(result && workspace);
    CHECK_STATUS(imk_laboratory_run(&laboratory, NULL, result, workspace, size, &error),
                 IMK_ERROR_CANCELLED);
    assert_int_equal(calls, 3);
    free(workspace);
    free(result);
}

static void the_record_is_identified(void **state)
{
    (void)state;
    imk_laboratory laboratory = imk_laboratory_default();
    const errors design = {.white = 1e-3};
    laboratory.instrument = &gyro;
    laboratory.design = &design;
    laboratory.points = laboratory.frequencies = 0;
    laboratory.threshold = laboratory.tumble = laboratory.temperature = false;
    imk_laboratory_result *result = experiment(&laboratory);
    assert_true(result->has_noise);
    /* 6000 samples: 0.9 % of itself, times 5 */
    CHECK_RELATIVE(result->model.gyro.noise.white.value[0], 1e-3, 0.05);
    free(result);
}

static void settings_out_of_range_are_named(void **state)
{
    (void)state;
    const errors design = {.white = 0.0}, broken = {.white = -1.0};
    imk_laboratory_result *result = malloc(sizeof *result);
    const struct {
        const char *field;
        int points, frequencies;
        double dwell, record, full_scale;
        const errors *design;
    } cases[] = {{"points", 8, 16, 1.0, 60.0, 0.0, &design},
                 {"points", 103, 16, 1.0, 60.0, 0.0, &design},
                 {"frequencies", 21, 49, 1.0, 60.0, 0.0, &design},
                 {"dwell", 21, 16, 0.0, 60.0, 0.0, &design},
                 {"dwell", 21, 16, (double)NAN, 60.0, 0.0, &design},
                 {"record", 21, 16, 1.0, 2.0, 0.0, &design},
                 {"full_scale", 21, 16, 1.0, 60.0, -1.0, &design},
                 {"white", 21, 16, 1.0, 60.0, 0.0, &broken}};
    assert_non_null(result);
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        imk_laboratory laboratory = imk_laboratory_default();
        imk_error error = {0};
        laboratory.instrument = &gyro;
        laboratory.design = cases[i].design;
        laboratory.points = cases[i].points;
        laboratory.frequencies = cases[i].frequencies;
        laboratory.dwell = cases[i].dwell;
        laboratory.record = cases[i].record;
        laboratory.full_scale = cases[i].full_scale;
        const size_t size = imk_laboratory_workspace_size(&laboratory);
        void *workspace = malloc(size);
        CHECK_STATUS(imk_laboratory_run(&laboratory, NULL, result, workspace, size, &error),
                     IMK_ERROR_RANGE);
        assert_string_equal(error.field, cases[i].field);
        CHECK_STATUS(imk_laboratory_run(&laboratory, NULL, result, workspace, 100, &error),
                     IMK_ERROR_WORKSPACE);
        free(workspace);
    }
    free(result);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_gyro_without_noise_is_found_exactly),
        cmocka_unit_test(an_accelerometer_is_tumbled),
        cmocka_unit_test(a_dead_band_is_found),
        cmocka_unit_test(sigmas_are_honest),
        cmocka_unit_test(verdicts_have_the_stated_rates),
        cmocka_unit_test(an_experiment_is_as_long_as_it_has_to_be),
        cmocka_unit_test(the_time_that_is_needed_is_enough),
        cmocka_unit_test(a_bias_is_averaged_over_power_cycles),
        cmocka_unit_test(the_experiments_can_be_stopped),
        cmocka_unit_test(the_record_is_identified),
        cmocka_unit_test(settings_out_of_range_are_named),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
